/// The plant's seals that are elastomers: arms beside their springs (docs/theory/elastomers.md).

#include "hydrapod/dynamics/linear_model.hpp"
#include "plant_work.hpp"

namespace hydrapod::simulation {

using dynamics::arms_per_seal;
using dynamics::Vector2;
using model::leg_count;

namespace {

constexpr int per_leg = 2 * static_cast<int>(arms_per_seal);  // states: each arm along t and a2

/// Forces of the arms of leg `i` at the offset, [N]; the rates of their states into `rate`.
template <class Each>
void for_arms(const std::array<dynamics::SealArms, leg_count>& of, int first, int leg,
              const Each& each) {
  const auto& arms = of[static_cast<size_t>(leg)];
  for (size_t j = 0; j < arms_per_seal; ++j)
    each(arms[j], first + leg * per_leg + 2 * static_cast<int>(j));
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
  const auto add = [&](auto elastomer_of, Arms& arms, bool& there) {
    for (size_t i = 0; i < leg_count; ++i)
      if (const auto [stiffness, elastomer] = elastomer_of(legs[i]); elastomer != nullptr) {
        arms.of[i] = dynamics::seal_arms(stiffness, *elastomer);
        there = true;
      }
    if (!there) return;
    arms.first = layout_.size;
    layout_.size += leg_count * per_leg;
    if (layout_.arms < 0) layout_.arms = arms.first;
  };
  using Seal = std::pair<double, const model::Elastomer*>;
  const auto elastomer = [](const auto& seal) -> Seal {
    return {seal.stiffness, seal.elastomer ? &*seal.elastomer : nullptr};
  };
  if (kind() != ModelKind::rigid)
    add([&](const model::Leg& leg) { return elastomer(leg.guide_sleeve); }, sleeve_arms_,
        layout_.sleeve_arms);
  if (kind() == ModelKind::full)
    add([&](const model::Leg& leg) { return elastomer(*leg.piston_ring); }, ring_arms_,
        layout_.ring_arms);
}

void Plant::arms_side(const double* x, double* rate, dynamics::Loads& loads,
                      const Work& work) const {
  if (layout_.arms < 0) return;
  loads.seals_press = true;
  // What the states are of turns with the case, their components with the frame.
  const Vector6 spins = dynamics::frame_spins(mechanics_, work.motion);
  const auto press = [&](const Arms& arms, int leg, const Vector2& offset, Vector2& force) {
    if (arms.first < 0) return;
    for_arms(arms.of, arms.first, leg, [&](const dynamics::SealArm& arm, int at) {
      for (int k = 0; k < 2; ++k) {
        const double stretch = offset[k] - x[at + k];
        force[k] += arm.stiffness * stretch;
        rate[at + k] = arm.rate * stretch + (k == 0 ? spins[leg] * x[at + 1] : -spins[leg] * x[at]);
      }
    });
  };
  for (int i = 0; i < leg_count; ++i) {
    const auto& leg = work.motion.legs[static_cast<size_t>(i)];
    press(sleeve_arms_, i, leg.sleeve_offset, loads.sleeve[static_cast<size_t>(i)]);
    press(ring_arms_, i, leg.flexible.tail<2>(), loads.ring[static_cast<size_t>(i)]);
  }
}

void Plant::arms_outputs(const double* x, const Work& work, PlantOutput& out) const {
  for (const Arms* arms : {&sleeve_arms_, &ring_arms_}) {
    if (arms->first < 0) continue;
    for (int i = 0; i < leg_count; ++i) {
      const auto& leg = work.motion.legs[static_cast<size_t>(i)];
      const Vector2 offset = arms == &sleeve_arms_ ? leg.sleeve_offset : leg.flexible.tail<2>();
      for_arms(arms->of, arms->first, i, [&](const dynamics::SealArm& arm, int at) {
        const double square = (offset - Vector2(x[at], x[at + 1])).squaredNorm();
        out.seal_arms_energy += 0.5 * arm.stiffness * square;
        out.dissipation += arm.stiffness * arm.rate * square;
      });
    }
  }
}

/// Relaxed, where the mechanics of `x` stand.
void Plant::arms_at_rest(Eigen::VectorXd& x) const {
  if (layout_.arms < 0) return;
  const auto now = motion(x.data());
  for (const Arms* arms : {&sleeve_arms_, &ring_arms_}) {
    if (arms->first < 0) continue;
    for (int i = 0; i < leg_count; ++i) {
      const auto& leg = now.legs[static_cast<size_t>(i)];
      const Vector2 offset = arms == &sleeve_arms_ ? leg.sleeve_offset : leg.flexible.tail<2>();
      for_arms(arms->of, arms->first, i,
               [&](const dynamics::SealArm&, int at) { x.segment<2>(at) = offset; });
    }
  }
}

}  // namespace hydrapod::simulation
