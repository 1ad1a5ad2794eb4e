/// The plant's seals that are elastomers: arms beside their springs, softening under large
/// amplitudes (docs/theory/elastomers.md).

#include "hydrapod/dynamics/linear_model.hpp"
#include "plant_work.hpp"
#include "softened_seal.hpp"

namespace hydrapod::simulation {

using dynamics::arms_per_seal;
using dynamics::Vector2;
using model::leg_count;

namespace {

/// each(arm, place of its two states in x).
template <class Each>
void for_arms(const dynamics::SealArms& arms, int first, const Each& each) {
  for (size_t j = 0; j < arms_per_seal; ++j) each(arms[j], first + 2 * static_cast<int>(j));
}

/// Compliance of rods and cases that bend, in series with guide sleeves, at the reference pose.
Vector6 bending_of(const dynamics::NonlinearModel& mechanics, const Pose& X_reference) {
  Vector6 bending = Vector6::Zero();
  const auto& machine = mechanics.machine();
  const auto rest = mechanics.equilibrium(X_reference);
  for (size_t i = 0; i < leg_count; ++i) {
    const auto& leg = machine.legs[i];
    if (!leg.guide_sleeve.elastomer || mechanics.kind() == ModelKind::rigid) continue;
    const auto bent = bent_leg(leg, X_reference * leg.platform_joint, machine.flexible_axes,
                               machine.gravity, rest.legs[i]);
    if (bent.exists) bending[static_cast<Eigen::Index>(i)] = bent.element.bending;
  }
  return bending;
}

}  // namespace

/// As it stands in a motion.
struct Plant::Seal {
  size_t leg{};
  bool sleeve{};  ///< else the piston ring
  Vector2 offset{Vector2::Zero()};
  const dynamics::SealArms& arms;
  int first{};  ///< state of the arms
  const Softening& softening;
  int softened{};  ///< state of the softening, −1: none
};

template <class Each>
void Plant::for_seals(const dynamics::Motion& motion, const Each& each) const {
  for (size_t i = 0; i < leg_count; ++i) {
    const auto& leg = motion.legs[i];
    if (const int first = layout_.sleeve_arms[i]; first >= 0)
      each(Seal{i, true, leg.sleeve_offset, sleeve_arms_[i], first, sleeve_softening_[i],
                layout_.sleeve_softening[i]});
    if (const int first = layout_.ring_arms[i]; first >= 0)
      each(Seal{i, false, leg.flexible.tail<2>(), ring_arms_[i], first, ring_softening_[i],
                layout_.ring_softening[i]});
  }
}

/// After everything else in the state. The mechanics' machine is that with pressed seals.
void Plant::set_arms(const Pose& X_reference) {
  const auto& legs = mechanics_.machine().legs;
  const auto add = [&](const auto& seal, dynamics::SealArms& arms, int& first) {
    if (!seal.elastomer) return;
    arms = dynamics::seal_arms(seal.stiffness, *seal.elastomer);
    first = layout_.size;
    layout_.size += StateLayout::arm_states;
    if (layout_.arms < 0) layout_.arms = first;
  };
  for (size_t i = 0; i < leg_count && kind() != ModelKind::rigid; ++i)
    add(legs[i].guide_sleeve, sleeve_arms_[i], layout_.sleeve_arms[i]);
  for (size_t i = 0; i < leg_count && kind() == ModelKind::full; ++i)
    add(*legs[i].piston_ring, ring_arms_[i], layout_.ring_arms[i]);
  if (layout_.arms < 0) return;
  const Vector6 bending = model::has_elastic_legs(machine_) ? bending_of(mechanics_, X_reference)
                                                            : Vector6(Vector6::Zero());
  set_softening(X_reference, bending);
  for (size_t i = 0; i < leg_count; ++i)
    if (const double f = bending[static_cast<Eigen::Index>(i)];
        f > 0.0 && layout_.sleeve_softening[i] < 0)
      sleeve_arms_[i] = arms_in_series(sleeve_arms_[i], legs[i].guide_sleeve.stiffness, f);
}

/// After the arms. Softening depends on the seal's own amplitude, so that its arms stay those of
/// the seal where it is in series with what bends.
void Plant::set_softening(const Pose& X_reference, const Vector6& bending) {
  if (!options_.softening) return;
  const auto& legs = mechanics_.machine().legs;
  bool any = false;
  const auto add = [&](const auto& seal, double f, Softening& softening, int& first) {
    if (!seal.elastomer || seal.elastomer->softening == 0.0) return;
    const auto& given = *seal.elastomer;
    softening = {.share = given.softening,
                 .amplitude = given.softening_amplitude,
                 .time = given.softening_time,
                 .stiffness = seal.stiffness,
                 .series = f / (1.0 + f * seal.stiffness)};
    first = layout_.size;
    layout_.size += StateLayout::softening_states;
    any = true;
  };
  for (size_t i = 0; i < leg_count && kind() != ModelKind::rigid; ++i)
    add(legs[i].guide_sleeve, bending[static_cast<Eigen::Index>(i)], sleeve_softening_[i],
        layout_.sleeve_softening[i]);
  for (size_t i = 0; i < leg_count && kind() == ModelKind::full; ++i)
    add(*legs[i].piston_ring, 0.0, ring_softening_[i], layout_.ring_softening[i]);
  if (!any) return;
  for_seals(motion_at_rest(X_reference), [&](const Seal& seal) {
    auto& of = seal.sleeve ? sleeve_softening_ : ring_softening_;
    of[seal.leg].rest = seal.offset;
  });
}

void Plant::arms_side(const double* x, double* rate, dynamics::Loads& loads,
                      const Work& work) const {
  if (layout_.arms < 0) return;
  loads.seals_press = true;
  // What the states are of turns with the case, their components with the frame.
  const Vector6 spins = dynamics::frame_spins(mechanics_, work.motion);
  for_seals(work.motion, [&](const Seal& seal) {
    Vector2& force = seal.sleeve ? loads.sleeve[seal.leg] : loads.ring[seal.leg];
    const auto leg = static_cast<Eigen::Index>(seal.leg);
    const double spin = spins[leg];
    const auto turned = [&](int at, const Vector2& rates) {
      rate[at] = rates[0] + spin * x[at + 1];
      rate[at + 1] = rates[1] - spin * x[at];
    };
    if (seal.softened < 0) {
      for_arms(seal.arms, seal.first, [&](const dynamics::SealArm& arm, int at) {
        const Vector2 stretch = seal.offset - Vector2(x[at], x[at + 1]);
        force += arm.stiffness * stretch;
        turned(at, arm.rate * stretch);
      });
      return;
    }
    const SoftenedSeal soft(seal.softening, seal.arms, seal.offset, x + seal.first,
                            x + seal.softened);
    force = soft.force;
    loads.frame_moment[leg] += soft.frame_moment(seal.softening);
    for_arms(seal.arms, seal.first, [&](const dynamics::SealArm& arm, int at) {
      turned(at, arm.rate * (soft.offset - Vector2(x[at], x[at + 1])));
    });
    rate[seal.softened] = soft.square_rate(seal.softening);
    turned(seal.softened + 1, (soft.offset - soft.mean) / seal.softening.time);
  });
}

void Plant::arms_outputs(const double* x, const Work& work, PlantOutput& out) const {
  for_seals(work.motion, [&](const Seal& seal) {
    const auto add_arms = [&](const Vector2& offset, double& stored, double& dissipated) {
      for_arms(seal.arms, seal.first, [&](const dynamics::SealArm& arm, int at) {
        const double square = (offset - Vector2(x[at], x[at + 1])).squaredNorm();
        stored += 0.5 * arm.stiffness * square;
        dissipated += arm.stiffness * arm.rate * square;
      });
    };
    if (seal.softened < 0) return add_arms(seal.offset, out.seal_arms_energy, out.dissipation);
    const SoftenedSeal soft(seal.softening, seal.arms, seal.offset, x + seal.first,
                            x + seal.softened);
    double stored = 0.0, dissipated = 0.0;
    add_arms(soft.offset, stored, dissipated);
    soft.account(seal.softening, stored, dissipated);
    out.seal_arms_energy += stored;
    out.dissipation += dissipated;
  });
}

/// Relaxed, where the mechanics of `x` stand.
void Plant::arms_at_rest(Eigen::VectorXd& x) const {
  if (layout_.arms < 0) return;
  for_seals(motion(x.data()), [&](const Seal& seal) {
    for_arms(seal.arms, seal.first,
             [&](const dynamics::SealArm&, int at) { x.segment<2>(at) = seal.offset; });
    if (seal.softened >= 0) x.segment<2>(seal.softened + 1) = seal.offset;
  });
}

}  // namespace hydrapod::simulation
