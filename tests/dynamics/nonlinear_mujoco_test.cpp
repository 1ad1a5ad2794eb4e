/// Accelerations in large, fast motions against the same mechanism in MuJoCo, whose accelerations
/// are projected on its constraints, velocity products of the constraints included.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "hydrapod/dynamics/nonlinear.hpp"
#include "support/jet.hpp"
#include "support/kinds.hpp"
#include "support/mujoco_equilibrium.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::LegState;
using dynamics::Loads;
using dynamics::NonlinearModel;
using model::FlexibleAxes;
using model::Machine;

/// Seen: 1e-14 with rigid legs, 7e-12 with bent ones, whose transverse axes MuJoCo approaches with
/// an axial inertia of 1e-13 kg m².
constexpr double motion_tolerance = 1e-10;
constexpr int moving_machines = 50;
constexpr int states_per_machine = 20;

/// The flexible coordinates of a leg as seen in MuJoCo's motion of its bodies, in a frame on
/// `axis`.
std::array<Jet, 4> flexible_jets(const MujocoHexapod::LegBodies& bodies, const Vector3& n,
                                 const Vector3& e, const Vector3& axis) {
  const auto along = fixed_in_body(n, bodies.cylinder_case.omega, bodies.cylinder_case.alpha);
  const auto rod = fixed_in_body(e, bodies.rod.omega, bodies.rod.alpha);
  const VectorJet a1{axis, Vector3::Zero(), Vector3::Zero()};
  const VectorJet piston{bodies.rod.position - bodies.cylinder_case.position, bodies.rod.velocity,
                         bodies.rod.acceleration};
  const auto a2 = unit(cross(along, a1));
  const auto t = cross(a2, along);
  return {atan2(-dot(a2, rod), dot(along, rod)), asin(dot(t, rod)), dot(t, piston),
          dot(a2, piston)};
}

/// MuJoCo's hexapod in a motion that its constraints allow.
class MovingHexapod {
 public:
  MovingHexapod(const Machine& machine, ModelKind kind, const PistonAxes& piston_axes)
      : hexapod_(machine, machine.neutral(), kind, &piston_axes), start_(hexapod_.qpos()) {}

  MujocoHexapod& hexapod() { return hexapod_; }
  [[nodiscard]] const VectorXd& velocity() const { return velocity_; }

  /// False when the legs do not close.
  bool draw(Random& random) {
    const int nv = hexapod_.nv(), flexible = dynamics::flexible_per_leg(hexapod_.kind());
    VectorXd displacement = VectorXd::Zero(nv);
    const double size = hexapod_.machine().neutral().p_BP.z();
    displacement.head<6>() = random.displacement(0.15 * size, 0.6);
    for (int i = 0; i < model::leg_count; ++i)
      displacement.segment(hexapod_.flexible_of(i), flexible) = bend(random, 0.3, 0.02 * size);
    if (!close(displacement)) return false;
    VectorXd y(hexapod_.dof());
    y.head<6>() << random.vector(2.0 * size), random.vector(4.0);
    for (int i = 0; i < model::leg_count; ++i)
      y.segment(6 + i * flexible, flexible) = bend(random, 8.0, 0.5 * size);
    velocity_ = hexapod_.allowed_motions() * y;
    hexapod_.set_velocity(velocity_);
    return true;
  }

  /// q̈ under generalised forces (gravity and velocity products in them).
  VectorXd acceleration(const VectorXd& force) {
    const MatrixXd N = hexapod_.allowed_motions(), M = hexapod_.mass(),
                   J = hexapod_.constraint_jacobian();
    const VectorXd bias = hexapod_.constraint_bias();
    VectorXd particular = VectorXd::Zero(hexapod_.nv());
    for (int i = 0; i < model::leg_count; ++i) {
      const int theta = hexapod_.theta_of(i);
      particular.segment<3>(theta) =
          -J.block<3, 3>(3 * i, theta).partialPivLu().solve(Vector3(bias.segment<3>(3 * i)));
    }
    const VectorXd y =
        (N.transpose() * M * N).llt().solve(N.transpose() * (force - M * particular));
    return particular + N * y;
  }

 private:
  [[nodiscard]] VectorXd bend(Random& random, double tilt, double offset) const {
    VectorXd flexible(4);
    flexible << random.uniform(-tilt, tilt), random.uniform(-tilt, tilt),
        random.uniform(-offset, offset), random.uniform(-offset, offset);
    if (hexapod_.kind() == ModelKind::full) {  // MuJoCo's order: slides, then hinges
      const Eigen::Vector2d tilts = flexible.head<2>();
      flexible.head<2>() = flexible.tail<2>().eval();
      flexible.tail<2>() = tilts;
    }
    return flexible.head(dynamics::flexible_per_leg(hexapod_.kind()));
  }

  bool close(VectorXd& displacement) {
    constexpr int most_steps = 30;
    for (int step = 0; step < most_steps; ++step) {
      hexapod_.move(start_, displacement);
      const VectorXd error = hexapod_.constraint_error();
      if (error.lpNorm<Eigen::Infinity>() < 1e-14) return true;
      const MatrixXd J = hexapod_.constraint_jacobian();
      for (int i = 0; i < model::leg_count; ++i) {
        const int theta = hexapod_.theta_of(i);
        displacement.segment<3>(theta) -=
            J.block<3, 3>(3 * i, theta).partialPivLu().solve(Vector3(error.segment<3>(3 * i)));
      }
    }
    return hexapod_.constraint_error().lpNorm<Eigen::Infinity>() < 1e-12;
  }

  MujocoHexapod hexapod_;
  VectorXd start_, velocity_;
};

/// One state in both programs.
struct Comparison {
  double platform{}, flexible{};  ///< relative errors of the accelerations
  double momentum{}, inertia{};   ///< of what a base that moves would feel
  bool closed{};
};

/// Axial inertia of the legs, which MuJoCo's transverse axes do not have (1e-13 kg m²).
spatial::Matrix6 axial_inertia(const MujocoHexapod& hexapod) {
  spatial::Matrix6 sum = spatial::Matrix6::Zero();
  if (hexapod.machine().flexible_axes == FlexibleAxes::gimbal) return sum;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = hexapod.machine().legs[i];
    const Vector3 n = hexapod.case_axes(i).col(2), e = hexapod.rod_direction(i);
    sum.bottomRightCorner<3, 3>() += leg.cylinder_case.axial_inertia * n * n.transpose() +
                                     leg.rod.axial_inertia * e * e.transpose();
  }
  return sum;
}

/// Momentum and inertia of the lower gimbals' crosses, which are armatures of MuJoCo's hinges and
/// so in its equations of motion, but not in its momenta. The case rotates with ω = α̇ a1 + β̇ a2,
/// and a2 is normal to a1: α̇ = ω·a1.
struct Crosses {
  spatial::Vector6 momentum{spatial::Vector6::Zero()};
  spatial::Matrix6 inertia{spatial::Matrix6::Zero()};
};
Crosses crosses(const MujocoHexapod& hexapod,
                const std::array<MujocoHexapod::LegBodies, model::leg_count>& bodies) {
  Crosses sum;
  if (hexapod.machine().flexible_axes != FlexibleAxes::gimbal) return sum;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = hexapod.machine().legs[i];
    const double rate = bodies[i].cylinder_case.omega.dot(leg.gimbal_axis);
    sum.momentum.tail<3>() += leg.gimbal_cross_inertia * rate * leg.gimbal_axis;
    sum.inertia.bottomRightCorner<3, 3>() +=
        leg.gimbal_cross_inertia * leg.gimbal_axis * leg.gimbal_axis.transpose();
  }
  return sum;
}

Comparison compare(const NonlinearModel& model, MovingHexapod& moving, Random& random) {
  auto& hexapod = moving.hexapod();
  const auto& machine = hexapod.machine();
  Comparison result;
  if (!moving.draw(random)) return result;
  result.closed = true;

  Loads loads;
  loads.wrench << random.vector(9.0 * machine.platform.mass),
      random.vector(3.0 * machine.platform.inertia.trace());
  for (int i = 0; i < model::leg_count; ++i)
    loads.axial[i] = random.uniform(-3.0, 3.0) * machine.platform.mass;

  const VectorXd q = hexapod.qpos();
  const Eigen::Quaterniond orientation(q[3], q[4], q[5], q[6]);
  const Matrix3 R = orientation.toRotationMatrix();
  const Vector3 arm = R * machine.platform.mass_center;
  VectorXd force = applied_force(hexapod, -loads.axial) - hexapod.damping() * moving.velocity();
  force.head<3>() += loads.wrench.head<3>();
  force.segment<3>(3) +=
      R.transpose() * (loads.wrench.tail<3>() + arm.cross(Vector3(loads.wrench.head<3>())));
  const VectorXd acceleration = moving.acceleration(force);
  const Vector3 omega = R * moving.velocity().segment<3>(3);
  const Vector3 alpha = R * acceleration.segment<3>(3);

  // The same state and its accelerations in the coordinates of the model.
  VectorXd y(model.positions()), v(model.velocities()), expected(model.velocities());
  y.head<7>() = q.head<7>();
  y.head<3>() += arm;
  v.head<6>() << moving.velocity().head<3>() + omega.cross(arm), omega;
  expected.head<6>() << acceleration.head<3>() + alpha.cross(arm) + omega.cross(omega.cross(arm)),
      alpha;
  const int n = model.flexible();
  const auto bodies = hexapod.leg_bodies(acceleration);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto jets = flexible_jets(bodies[i], hexapod.case_axes(i).col(2),
                                    hexapod.rod_direction(i), model.axis(i));
    for (int k = 0; k < n; ++k) {
      y[7 + n * i + k] = jets[k].x;
      v[6 + n * i + k] = jets[k].v;
      expected[6 + n * i + k] = jets[k].a;
    }
  }
  dynamics::Motion motion;
  model.motion(y.data(), v.data(), motion);
  EXPECT_TRUE(motion.exists());
  for (int i = 0; i < model::leg_count; ++i)  // axial dampers are loads there, forces here
    loads.axial[i] -= machine.legs[i].oil_spring.damping * motion.legs[i].s_rate;
  VectorXd found(model.velocities());
  model.accelerations(motion, loads, found.data());
  const VectorXd error = found - expected;
  result.platform = error.head<6>().norm() / expected.head<6>().norm();
  if (n > 0) result.flexible = error.tail(6 * n).norm() / expected.tail(6 * n).norm();
  const auto of_crosses = crosses(hexapod, bodies);
  const spatial::Vector6 momentum = hexapod.momentum() + of_crosses.momentum;
  result.momentum = (model.momentum(motion) - momentum).norm() / momentum.norm();
  const auto coupling = model.base_coupling(y.data());
  EXPECT_LE((coupling.momentum * v - momentum).norm(), 1e-10 * momentum.norm());
  const spatial::Matrix6 inertia =
      hexapod.locked_inertia() + axial_inertia(hexapod) + of_crosses.inertia;
  result.inertia = (coupling.inertia - inertia).norm() / inertia.norm();
  return result;
}

class LargeMotion : public testing::TestWithParam<AxesAndKind> {};

TEST_P(LargeMotion, AccelerationsAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(20261120);
  double worst = 0.0;
  int closed = 0;
  for (int k = 0; k < moving_machines; ++k) {
    const auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
    const NonlinearModel model(machine, kind);
    PistonAxes piston_axes;
    for (int i = 0; i < model::leg_count; ++i) piston_axes[i] = model.piston_axis(i);
    MovingHexapod moving(machine, kind, piston_axes);
    for (int state = 0; state < states_per_machine; ++state) {
      const auto result = compare(model, moving, random);
      if (!result.closed) continue;
      ++closed;
      EXPECT_LE(result.platform, motion_tolerance) << "machine " << k << ", state " << state;
      EXPECT_LE(result.flexible, motion_tolerance) << "machine " << k << ", state " << state;
      EXPECT_LE(result.momentum, motion_tolerance) << "machine " << k << ", state " << state;
      EXPECT_LE(result.inertia, motion_tolerance) << "machine " << k << ", state " << state;
      worst = std::max({worst, result.platform, result.flexible});
    }
  }
  EXPECT_GE(closed, 9 * moving_machines * states_per_machine / 10);
  RecordProperty("states", closed);
  RecordProperty("worst_relative_error", fmt::format("{:.1e}", worst));
}

INSTANTIATE_TEST_SUITE_P(, LargeMotion,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
