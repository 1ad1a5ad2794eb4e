/// The plant's joints that stick before they slide (docs/theory/nonlinear.md, "Joints that stick").

#include <algorithm>
#include <limits>

#include "joint_bristles.hpp"
#include "plant_work.hpp"

namespace hydrapod::simulation {

using dynamics::Vector2;
using model::leg_count;

struct Plant::Joint {
  int leg{};
  bool platform{};  ///< else the base joint
  JointBristles law{};
  Vector2 turning{}, bend{};  ///< w, z
  double spin{};              ///< of the directions of both, see LegJoints
};

template <class Each>
void Plant::for_joints(const double* x, const dynamics::Motion& motion, const Each& each) const {
  const auto joints = dynamics::leg_joints(mechanics_, motion);
  for (int i = 0; i < leg_count; ++i) {
    const auto leg = static_cast<size_t>(i);
    auto law = joint_bristles(machine_.legs[leg].hydraulics.joint_friction);
    if (!law.stick()) continue;
    Joint base{i, false, law, joints.base[leg], {}, joints.base_spin[i]};
    Joint platform{i, true, law, joints.platform[leg], {}, joints.platform_spin[i]};
    if (stuck_joints_.any) {
      base.law.coulomb = platform.law.coulomb = std::numeric_limits<double>::infinity();
      const spatial::Matrix3 &axes = joints.case_axes[leg], &rod = joints.rod_axes[leg];
      // From n at rest to n, and the rotation from the rod to where the platform takes it.
      base.bend = -axes.leftCols<2>().transpose() * stuck_joints_.axis[leg];
      platform.bend = rod.leftCols<2>().transpose() *
                      rod.col(2).cross(motion.X_BP.R_BP * stuck_joints_.rod[leg]);
    } else {
      for (auto* joint : {&base, &platform}) {
        const int at = layout_.joint(i, joint->platform);
        joint->bend = Vector2(x[at], x[at + 1]);
      }
    }
    each(base);
    each(platform);
  }
}

/// After the lines in the state. Where one leg has bristles all have states, as with seals.
void Plant::set_joints(const Pose& X_reference) {
  if (options_.friction == Friction::none) return;
  const auto& legs = machine_.legs;
  if (std::none_of(legs.begin(), legs.end(), [](const auto& leg) {
        return joint_bristles(leg.hydraulics.joint_friction).stick();
      }))
    return;
  if (options_.friction == Friction::all) {
    layout_.joints = layout_.size;
    layout_.size += 4 * leg_count;
    return;
  }
  const auto rest = motion_at_rest(X_reference);
  const auto joints = dynamics::leg_joints(mechanics_, rest);
  stuck_joints_.any = true;
  for (size_t leg = 0; leg < leg_count; ++leg) {
    stuck_joints_.axis[leg] = joints.case_axes[leg].col(2);
    stuck_joints_.rod[leg] = rest.X_BP.R_BP.transpose() * joints.rod_axes[leg].col(2);
  }
}

void Plant::joints_side(const double* x, double* rate, dynamics::Loads& loads,
                        const Work& work) const {
  if (layout_.joints < 0 && !stuck_joints_.any) return;
  loads.joints_stick = true;
  if (layout_.joints >= 0) std::fill_n(rate + layout_.joints, 4 * leg_count, 0.0);
  for_joints(x, work.motion, [&](const Joint& joint) {
    const auto bent = joint.law.bend(joint.turning, joint.bend);
    auto& torques = joint.platform ? loads.platform_joint : loads.base_joint;
    torques[static_cast<size_t>(joint.leg)] = bent.torque;
    if (layout_.joints < 0) return;
    // What bristles stand in turns with case and rod, their components with the directions.
    double* rates = rate + layout_.joint(joint.leg, joint.platform);
    rates[0] = bent.rate[0] + joint.spin * joint.bend[1];
    rates[1] = bent.rate[1] - joint.spin * joint.bend[0];
  });
}

void Plant::joints_outputs(const double* x, const Work& work, PlantOutput& out) const {
  if (layout_.joints < 0 && !stuck_joints_.any) return;
  for_joints(x, work.motion, [&](const Joint& joint) {
    const auto bent = joint.law.bend(joint.turning, joint.bend);
    out.joint_bristles_energy += joint.law.energy(joint.bend);
    out.dissipation +=
        bent.torque.dot(joint.turning) - joint.law.stiffness * joint.bend.dot(bent.rate);
  });
}

}  // namespace hydrapod::simulation
