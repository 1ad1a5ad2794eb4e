/// The linear controller against differences of the controller itself, sample by sample.

#include "hydrapod/control/controller.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>

#include "example_parameters.hpp"
#include "support/random.hpp"

namespace hydrapod::control {
namespace {

using Inputs = ControllerInputs;

struct Case {
  model::ControlSpace space;
  model::DampingFeedback feedback;
  model::Compensation compensation;
  double overlap;
};

class LinearControllerOf : public testing::TestWithParam<Case> {};

/// The real controller's drives for a sequence of small inputs, less those for none.
std::vector<Vector6> answers(const model::Machine& machine, const ControllerParameters& parameters,
                             const Pose& X_BP, const std::vector<Eigen::VectorXd>& inputs,
                             const Vector6* held = nullptr) {
  const auto rest = test::exact_measurement(machine, parameters, X_BP);
  Controller controller(machine, parameters);
  controller.reset(X_BP, rest);
  if (held != nullptr) controller.take_over(*held);
  std::vector<Vector6> drives;
  for (const auto& u : inputs) {
    auto measured = rest;
    measured.length += u.segment<6>(Inputs::length);
    measured.cap_pressure += u.segment<6>(Inputs::cap_pressure);
    measured.rod_pressure += u.segment<6>(Inputs::rod_pressure);
    measured.acceleration += u.segment<6>(Inputs::acceleration);
    const Command command{spatial::displaced(X_BP, u.segment<6>(Inputs::command)),
                          u.segment<6>(Inputs::velocity)};
    drives.push_back(controller.step(measured, command) -
                     (held != nullptr ? *held : parameters.output.offset));
  }
  return drives;
}

TEST_P(LinearControllerOf, AnswersAsTheControllerDoes) {
  const auto [space, feedback, compensation, overlap] = GetParam();
  const auto machine = test::published_machine();
  auto parameters = test::example_parameters();
  parameters.space = space;
  parameters.feedback = feedback;
  parameters.compensation = compensation;
  parameters.overlap_compensation = 0.9;
  parameters.output.scale.setConstant(1.07);
  parameters.output.offset[2] = 0.011;
  for (auto& axis : parameters.axes) axis.overlap = overlap;
  const Pose X_BP = spatial::displaced(
      machine.neutral(), (Vector6() << 0.02, 0.03, -0.01, 0.06, 0.02, -0.05).finished());
  Vector6 loads;
  for (int i = 0; i < 6; ++i) loads[i] = parameters.axes[i].load;

  // One-sided: all drives positive (or on the ramp over the overlap), else the cylinder's asymmetry
  // gives two slopes. A growing commanded displacement along the rows of J extends all legs.
  Eigen::VectorXd scales(Inputs::count);
  scales << Vector6::Constant(1e-9), Vector6::Constant(3.0), Vector6::Constant(3.0),
      Vector6::Constant(1e-6), Vector6::Constant(1e-9), Vector6::Constant(1e-8);
  const auto legs = kinematics::inverse_kinematics(machine, X_BP);
  const Matrix6 J = kinematics::leg_jacobian(legs, X_BP.p_BP);
  const Vector6 upward = J.inverse() * Vector6::Constant(1e-4);
  test::Random random(20261120);
  std::vector<Eigen::VectorXd> inputs;
  for (int k = 0; k < 7; ++k) {
    Eigen::VectorXd u(Inputs::count);
    for (int i = 0; i < Inputs::count; ++i) u[i] = scales[i] * random.uniform(-1.0, 1.0);
    u.segment<6>(Inputs::velocity) += upward;
    inputs.push_back(u);
  }

  const Vector6 up = Vector6::Constant(1e-9) + parameters.output.offset;
  const auto linear = linear_controller(machine, parameters, X_BP, up, loads);
  const auto real = answers(machine, parameters, X_BP, inputs);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(linear.A_d.rows());
  for (size_t k = 0; k < inputs.size(); ++k) {
    const Eigen::VectorXd drives = linear.C * state + linear.D * inputs[k];
    // 1e-9 m of forward kinematics times the gains; curvature of pose and load on 1e-4 of the speed
    EXPECT_LT((drives - real[k]).norm(), 2e-4 * real[k].norm()) << k;
    state = (linear.A_d * state + linear.B_d * inputs[k]).eval();
  }
  EXPECT_EQ(linear.states.size(), static_cast<size_t>(linear.A.rows()));
}

INSTANTIATE_TEST_SUITE_P(
    Laws, LinearControllerOf,
    testing::Values(Case{model::ControlSpace::pose, model::DampingFeedback::pressure,
                         model::Compensation::load, 0.0},
                    Case{model::ControlSpace::pose, model::DampingFeedback::acceleration,
                         model::Compensation::asymmetry, 0.0},
                    Case{model::ControlSpace::leg, model::DampingFeedback::pressure,
                         model::Compensation::none, 0.0},
                    Case{model::ControlSpace::leg, model::DampingFeedback::none,
                         model::Compensation::load, 0.03}));

/// A machine that leaks is held by drives, which change with the pose and with the slow load.
TEST(LinearController, OfAMachineHeldByDrivesAnswersAsTheControllerDoes) {
  const auto machine = test::published_machine();
  for (const auto space : {model::ControlSpace::pose, model::ControlSpace::leg})
    for (const auto feedback : {model::DampingFeedback::pressure, model::DampingFeedback::none}) {
      auto parameters = test::example_parameters();
      parameters.space = space;
      parameters.feedback = feedback;
      parameters.compensation = model::Compensation::load;
      parameters.output.resolution = 0.0;
      const Pose X_BP = spatial::displaced(
          machine.neutral(), (Vector6() << 0.02, 0.03, -0.01, 0.06, 0.02, -0.05).finished());
      Vector6 loads;
      for (int i = 0; i < 6; ++i) loads[i] = parameters.axes[i].load;
      const Vector6 held = (Vector6() << 0.21, -0.34, 0.17, 0.28, -0.31, 0.19).finished();
      // one input moves the lengths, the other pressures alone, for long enough to become slow
      for (const bool lengths : {true, false}) {
        std::vector<Eigen::VectorXd> inputs(9, Eigen::VectorXd::Zero(Inputs::count));
        test::Random random(77);
        for (int i = 0; i < 6; ++i) {
          const double size = random.uniform(-1.0, 1.0);
          for (auto& u : inputs)
            u[(lengths ? Inputs::length : Inputs::cap_pressure) + i] =
                (lengths ? 1e-5 : 2e3) * size;
        }
        const auto linear = linear_controller(machine, parameters, X_BP, held, loads);
        const auto real = answers(machine, parameters, X_BP, inputs, &held);
        Eigen::VectorXd state = Eigen::VectorXd::Zero(linear.A_d.rows());
        for (size_t k = 0; k < inputs.size(); ++k) {
          const Vector6 drives = linear.C * state + linear.D * inputs[k];
          // curvature over 1e-5 m, tolerance of the forward pose; rounding of drives near 0.3
          // where nothing answers yet
          EXPECT_LT((drives - real[k]).norm(), 1e-3 * real[k].norm() + 1e-15)
              << k << " " << lengths << " " << static_cast<int>(space);
          state = (linear.A_d * state + linear.B_d * inputs[k]).eval();
        }
      }
    }
}

/// With ever faster sampling the sampled system becomes the continuous one: (A_d − 1)/T → A.
TEST(LinearController, SampledFastIsTheContinuousOne) {
  const auto machine = test::published_machine();
  auto parameters = test::example_parameters();
  parameters.sample_time = 1e-7;
  const auto linear =
      linear_controller(machine, parameters, machine.neutral(), Vector6::Zero(), Vector6::Zero());
  const auto identity = Eigen::MatrixXd::Identity(linear.A.rows(), linear.A.cols());
  const double half_step = 0.5 * parameters.feedback_corner * parameters.sample_time;
  EXPECT_LT(((linear.A_d - identity) / parameters.sample_time - linear.A).norm(),
            1.1 * half_step * linear.A.norm());
  EXPECT_LT((linear.B_d / parameters.sample_time - linear.B).norm(),
            1.1 * half_step * linear.B.norm());
}

}  // namespace
}  // namespace hydrapod::control
