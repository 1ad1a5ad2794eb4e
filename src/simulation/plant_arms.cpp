/// The plant's seals that are elastomers: arms beside their springs (docs/theory/elastomers.md).

#include "hydrapod/dynamics/linear_model.hpp"
#include "plant_work.hpp"

namespace hydrapod::simulation {

using dynamics::arms_per_seal;
using dynamics::Vector2;
using model::leg_count;

namespace {

constexpr int per_seal = 2 * static_cast<int>(arms_per_seal);  // states: each arm along t and a2

/// each(arm, place of its two states in x), where the seal has any.
template <class Each>
void for_arms(const dynamics::SealArms& arms, int first, const Each& each) {
  if (first < 0) return;
  for (size_t j = 0; j < arms_per_seal; ++j) each(arms[j], first + 2 * static_cast<int>(j));
}

}  // namespace

void bend_arms(const dynamics::NonlinearModel& mechanics, const Pose& X_reference,
               std::array<dynamics::SealArms, leg_count>& arms) {
  const auto& machine = mechanics.machine();
  const auto rest = mechanics.equilibrium(X_reference);
  for (size_t i = 0; i < leg_count; ++i) {
    const auto& leg = machine.legs[i];
    if (!leg.guide_sleeve.elastomer || mechanics.kind() == ModelKind::rigid) continue;
    const auto bent = bent_leg(leg, X_reference * leg.platform_joint, machine.flexible_axes,
                               machine.gravity, rest.legs[i]);
    if (bent.exists && bent.element.bending > 0.0)
      arms[i] = arms_in_series(arms[i], leg.guide_sleeve.stiffness, bent.element.bending);
  }
}

/// After everything else in the state. The mechanics' machine is that with pressed seals.
void Plant::set_arms() {
  const auto& legs = mechanics_.machine().legs;
  const auto add = [&](const auto& seal, dynamics::SealArms& arms, int& first) {
    if (!seal.elastomer) return;
    arms = dynamics::seal_arms(seal.stiffness, *seal.elastomer);
    first = layout_.size;
    layout_.size += per_seal;
    if (layout_.arms < 0) layout_.arms = first;
  };
  for (size_t i = 0; i < leg_count && kind() != ModelKind::rigid; ++i)
    add(legs[i].guide_sleeve, sleeve_arms_[i], layout_.sleeve_arms[i]);
  for (size_t i = 0; i < leg_count && kind() == ModelKind::full; ++i)
    add(*legs[i].piston_ring, ring_arms_[i], layout_.ring_arms[i]);
}

template <class Each>
void Plant::for_seals(const dynamics::Motion& motion, const Each& each) const {
  for (size_t i = 0; i < leg_count; ++i) {
    const auto& leg = motion.legs[i];
    each(i, true, leg.sleeve_offset, sleeve_arms_[i], layout_.sleeve_arms[i]);
    each(i, false, Vector2(leg.flexible.tail<2>()), ring_arms_[i], layout_.ring_arms[i]);
  }
}

void Plant::arms_side(const double* x, double* rate, dynamics::Loads& loads,
                      const Work& work) const {
  if (layout_.arms < 0) return;
  loads.seals_press = true;
  // What the states are of turns with the case, their components with the frame.
  const Vector6 spins = dynamics::frame_spins(mechanics_, work.motion);
  for_seals(work.motion, [&](size_t leg, bool sleeve, const Vector2& offset,
                             const dynamics::SealArms& arms, int first) {
    Vector2& force = sleeve ? loads.sleeve[leg] : loads.ring[leg];
    const double spin = spins[static_cast<Eigen::Index>(leg)];
    for_arms(arms, first, [&](const dynamics::SealArm& arm, int at) {
      const Vector2 eta(x[at], x[at + 1]), stretch = offset - eta;
      force += arm.stiffness * stretch;
      rate[at] = arm.rate * stretch[0] + spin * eta[1];
      rate[at + 1] = arm.rate * stretch[1] - spin * eta[0];
    });
  });
}

void Plant::arms_outputs(const double* x, const Work& work, PlantOutput& out) const {
  for_seals(work.motion,
            [&](size_t, bool, const Vector2& offset, const dynamics::SealArms& arms, int first) {
              for_arms(arms, first, [&](const dynamics::SealArm& arm, int at) {
                const double square = (offset - Vector2(x[at], x[at + 1])).squaredNorm();
                out.seal_arms_energy += 0.5 * arm.stiffness * square;
                out.dissipation += arm.stiffness * arm.rate * square;
              });
            });
}

/// Relaxed, where the mechanics of `x` stand.
void Plant::arms_at_rest(Eigen::VectorXd& x) const {
  if (layout_.arms < 0) return;
  for_seals(motion(x.data()), [&](size_t, bool, const Vector2& offset,
                                  const dynamics::SealArms& arms, int first) {
    for_arms(arms, first, [&](const dynamics::SealArm&, int at) { x.segment<2>(at) = offset; });
  });
}

}  // namespace hydrapod::simulation
