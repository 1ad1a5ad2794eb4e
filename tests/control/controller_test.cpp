/// The control law against its statement, every part by itself.

#include "hydrapod/control/controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "example_parameters.hpp"

namespace hydrapod::control {
namespace {

using test::exact_measurement;
using test::example_parameters;
using test::published_machine;

const Vector6 small_motion =
    (Vector6() << 2.1e-6, -1.3e-6, 1.7e-6, 3.1e-6, 2.3e-6, -1.9e-6).finished();

Pose some_pose(const model::Machine& machine) {
  return spatial::displaced(machine.neutral(),
                            (Vector6() << 0.03, -0.02, 0.04, 0.05, -0.04, 0.07).finished());
}

/// l̇ along the twist `rate` of P's origin, by central differences of the leg lengths.
Vector6 leg_rates(const model::Machine& machine, const Pose& X_BP, const Vector6& rate) {
  constexpr double h = 1e-5;
  return (kinematics::leg_lengths(machine, spatial::displaced(X_BP, h * rate)) -
          kinematics::leg_lengths(machine, spatial::displaced(X_BP, -h * rate))) /
         (2.0 * h);
}
constexpr double difference_tolerance = 1e-9;  // of central differences with that step

TEST(Controller, MovesThePlatformAgainstItsErrorInEveryDirection) {
  const auto machine = published_machine();
  auto parameters = example_parameters();
  const Pose X_BP = some_pose(machine);
  Controller controller(machine, parameters);
  const auto measured = exact_measurement(machine, parameters, X_BP);
  for (int direction = 0; direction < 6; ++direction) {
    controller.reset(X_BP, measured);
    Vector6 motion = Vector6::Zero();
    motion[direction] = 1e-3;
    controller.step(measured, {.X_BP = spatial::displaced(X_BP, motion)});
    const Vector6 expected = leg_rates(machine, X_BP, parameters.gain.cwiseProduct(motion));
    EXPECT_LT((controller.state().wanted_speed - expected).norm(), 1e-8) << direction;
  }
}

TEST(Controller, FeedsTheCommandedVelocityForward) {
  const auto machine = published_machine();
  for (const auto space : {model::ControlSpace::pose, model::ControlSpace::leg}) {
    auto parameters = example_parameters();
    parameters.space = space;
    const Pose X_BP = some_pose(machine);
    Controller controller(machine, parameters);
    const auto measured = exact_measurement(machine, parameters, X_BP);
    controller.reset(X_BP, measured);
    const Vector6 velocity = (Vector6() << 0.11, -0.07, 0.13, 0.2, -0.3, 0.17).finished();
    controller.step(measured, {.X_BP = X_BP, .velocity = velocity});
    EXPECT_LT((controller.state().wanted_speed - 0.87 * leg_rates(machine, X_BP, velocity)).norm(),
              difference_tolerance);
  }
}

TEST(Controller, InLegSpaceEachLegAnswersToItsOwnErrorAlone) {
  const auto machine = published_machine();
  auto parameters = example_parameters();
  parameters.space = model::ControlSpace::leg;
  const Pose X_BP = some_pose(machine);
  Controller controller(machine, parameters);
  auto measured = exact_measurement(machine, parameters, X_BP);
  controller.reset(X_BP, measured);
  measured.length[3] -= 7e-4;
  controller.step(measured, {.X_BP = X_BP});
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(controller.state().wanted_speed[i], i == 3 ? 7e-4 * parameters.gain[3] : 0.0,
                1e-14);
}

TEST(Controller, IntegratesTheErrorAndStandsStillAtTheLimit) {
  const auto machine = published_machine();
  auto parameters = example_parameters();
  parameters.feedback = model::DampingFeedback::none;
  const Pose X_BP = some_pose(machine);
  const auto measured = exact_measurement(machine, parameters, X_BP);
  const Command command{.X_BP = spatial::displaced(X_BP, small_motion)};
  Controller controller(machine, parameters);
  controller.reset(X_BP, measured);
  constexpr int samples = 1000;
  Vector6 first;
  for (int k = 0; k <= samples; ++k) {
    controller.step(measured, command);
    if (k == 0) first = controller.state().wanted_speed;
  }
  const double time = samples * parameters.sample_time;
  EXPECT_LT(
      (controller.state().wanted_speed - first * (1.0 + time / parameters.integral_time)).norm(),
      1e-11 * first.norm());

  const Command far{.X_BP = spatial::displaced(X_BP, 1e5 * small_motion)};
  controller.reset(X_BP, measured);
  const Vector6 drives = controller.step(measured, far);
  EXPECT_EQ(drives.cwiseAbs().maxCoeff(), 1.0);
  EXPECT_EQ(controller.state().integral.norm(), 0.0);
}

/// A machine held by drives is taken over without a bump.
TEST(Controller, BeginsWithTheDrivesThatHoldTheMachine) {
  const auto machine = published_machine();
  const Vector6 holding = (Vector6() << 0.011, -0.004, 0.06, -0.013, 0.0, 0.021).finished();
  for (const auto space : {model::ControlSpace::pose, model::ControlSpace::leg}) {
    auto parameters = example_parameters();
    parameters.space = space;
    parameters.overlap_compensation = 0.9;
    parameters.output.scale.setConstant(1.2);
    parameters.output.offset[1] = 0.003;
    for (auto& axis : parameters.axes) axis.overlap = 0.02;
    const Pose X_BP = some_pose(machine);
    const auto measured = exact_measurement(machine, parameters, X_BP);
    Controller controller(machine, parameters);
    controller.reset(X_BP, measured);
    controller.take_over(holding);
    const Vector6 drives = controller.step(measured, {.X_BP = X_BP});
    EXPECT_LT((drives - holding).norm(), 1e-6);  // forward kinematics to 1e-9 m
  }
}

TEST(Controller, FeedsBackForceThatChangesButNoneThatStays) {
  const auto machine = published_machine();
  const auto parameters = example_parameters();
  const Pose X_BP = some_pose(machine);
  auto measured = exact_measurement(machine, parameters, X_BP);
  Controller controller(machine, parameters);
  controller.reset(X_BP, measured);
  controller.step(measured, {.X_BP = X_BP});
  EXPECT_LT(controller.state().wanted_speed.norm(), 1e-9);  // forward kinematics to 1e-9 m

  constexpr double rise = 2.3e5;
  measured.cap_pressure[1] += rise;
  const double force = rise * parameters.axes[1].piston_area;
  for (int k = 0; k < 600; ++k) {
    controller.step(measured, {.X_BP = X_BP});
    const double time = k * parameters.sample_time;
    const double expected =
        -parameters.feedback_gain[1] * force * std::exp(-parameters.feedback_corner * time);
    ASSERT_NEAR(controller.state().wanted_speed[1], expected, 1e-8) << k;
  }
}

TEST(Controller, CanFeedBackTheAccelerationInstead) {
  const auto machine = published_machine();
  auto parameters = example_parameters();
  parameters.feedback = model::DampingFeedback::acceleration;
  parameters.feedback_gain.setConstant(8.3e-3);
  const Pose X_BP = some_pose(machine);
  auto measured = exact_measurement(machine, parameters, X_BP);
  Controller controller(machine, parameters);
  controller.reset(X_BP, measured);
  measured.acceleration[4] = 1.9;
  measured.cap_pressure[4] *= 1.3;
  controller.step(measured, {.X_BP = X_BP});
  EXPECT_NEAR(controller.state().wanted_speed[4], -8.3e-3 * 1.9, 1e-8);
}

/// At the speed that is promised for full drive, the pressures behind both edges carry the load.
TEST(Conditioning, SpeedsAtFullDriveBalanceFlowsAndForces) {
  for (const auto& axis : example_parameters().axes) {
    const double A_1 = axis.piston_area, A_2 = axis.annulus_area, K = axis.flow_coefficient;
    for (const double load : {-3100.0, 0.0, 2700.0}) {
      const auto speeds = full_drive_speeds(axis, load);
      const auto drop = [&](double flow) { return flow * flow / (K * K); };
      const double p_1 = axis.supply_pressure - drop(A_1 * speeds.extending);
      const double p_2 = axis.return_pressure + drop(A_2 * speeds.extending);
      EXPECT_NEAR(p_1 * A_1 - p_2 * A_2, load, 1e-7);
      const double q_1 = axis.return_pressure + drop(A_1 * speeds.retracting);
      const double q_2 = axis.supply_pressure - drop(A_2 * speeds.retracting);
      EXPECT_NEAR(q_1 * A_1 - q_2 * A_2, load, 1e-7);
    }
  }
}

TEST(Conditioning, ALoadBeyondTheSupplyStillHasASpeed) {
  const auto axis = example_parameters().axes[0];
  const auto speeds = full_drive_speeds(axis, 1e6);
  EXPECT_GT(speeds.extending, 0.0);
  EXPECT_LT(speeds.extending, speeds.retracting);
}

/// Drives for the same wanted speed up and down, from a controller with one leg's error.
std::pair<double, double> up_and_down(const ControllerParameters& parameters, double load) {
  const auto machine = published_machine();
  const Pose X_BP = machine.neutral();
  auto with_load = parameters;
  with_load.space = model::ControlSpace::leg;
  with_load.axes[0].load = load;
  auto measured = exact_measurement(machine, with_load, X_BP);
  const auto drive = [&](double error) {
    Controller controller(machine, with_load);
    controller.reset(X_BP, measured);
    auto moved = measured;
    moved.length[0] -= error;
    return controller.step(moved, {.X_BP = X_BP})[0];
  };
  return {drive(1e-3), drive(-1e-3)};
}

TEST(Conditioning, CompensationMakesTheDriveFitTheDirection) {
  auto parameters = example_parameters();
  const double speed = 1e-3 * parameters.gain[0];
  const double load = 2345.0;
  const auto speeds = full_drive_speeds(parameters.axes[0], load);
  for (const auto compensation : {model::Compensation::load, model::Compensation::asymmetry}) {
    parameters.compensation = compensation;
    const auto [up, down] = up_and_down(parameters, load);
    EXPECT_NEAR(up, speed / speeds.extending, 1e-12);
    EXPECT_NEAR(down, -speed / speeds.retracting, 1e-12);
  }
  parameters.compensation = model::Compensation::none;
  const auto [up, down] = up_and_down(parameters, load);
  EXPECT_NEAR(up, 2.0 * speed / (speeds.extending + speeds.retracting), 1e-12);
  EXPECT_NEAR(down, -up, 1e-12);
}

TEST(Conditioning, JumpsOverTheOverlap) {
  auto parameters = example_parameters();
  const auto [up, down] = up_and_down(parameters, 0.0);
  parameters.axes[0].overlap = 0.05;
  parameters.overlap_compensation = 0.8;
  const auto [up_over, down_over] = up_and_down(parameters, 0.0);
  EXPECT_NEAR(up_over - up, 0.04, 1e-12);
  EXPECT_NEAR(down_over - down, -0.04, 1e-12);
}

TEST(Conditioning, ScalesOffsetsLimitsAndRounds) {
  auto parameters = example_parameters();
  const auto [up, down] = up_and_down(parameters, 0.0);
  parameters.output.scale[0] = 1.25;
  parameters.output.offset[0] = -0.013;
  EXPECT_NEAR(up_and_down(parameters, 0.0).first, 1.25 * up - 0.013, 1e-12);
  parameters.output.resolution = 1.0 / 512;
  const double steps = up_and_down(parameters, 0.0).first * 512;
  EXPECT_NEAR(steps, std::round((1.25 * up - 0.013) * 512), 1e-9);
  parameters.output.limit = 0.5 * std::abs(down);
  parameters.output.resolution = 0.0;
  EXPECT_EQ(up_and_down(parameters, 0.0).second, -parameters.output.limit);
}

TEST(Controller, StopsTheValvesWhereTheLengthsFitNoPose) {
  const auto machine = published_machine();
  const auto parameters = example_parameters();
  const Pose X_BP = machine.neutral();
  auto measured = exact_measurement(machine, parameters, X_BP);
  Controller controller(machine, parameters);
  controller.reset(X_BP, measured);
  measured.length[2] = 3.0;  // no platform is that wide
  const Vector6 drives = controller.step(measured, {.X_BP = X_BP});
  EXPECT_NE(controller.state().forward, kinematics::ForwardStatus::converged);
  EXPECT_EQ(drives, Vector6::Zero());
  measured.length[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(controller.step(measured, {.X_BP = X_BP}), Vector6::Zero());
  EXPECT_EQ(controller.state().integral, Vector6::Zero());
}

TEST(ControllerParameters, ThatDoNotHoldAreNamed) {
  const auto complaint = [](auto spoil) -> std::string {
    auto parameters = example_parameters();
    spoil(parameters);
    try {
      Controller controller(published_machine(), parameters);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint([](auto& p) { p.gain[2] = -1.0; }),
            "ControllerParameters::gain is -1, expected 0 or more");
  EXPECT_EQ(complaint([](auto& p) { p.sample_time = 0.0; }),
            "ControllerParameters::sample_time is 0, expected more than 0");
  EXPECT_EQ(complaint([](auto& p) { p.output.limit = 1.1; }),
            "ControllerParameters::output.limit is 1.1, expected more than 0, no more than 1");
  EXPECT_EQ(complaint([](auto& p) { p.axes[5].annulus_area = 0.0; }),
            "ControllerParameters::axes.annulus_area is 0, expected more than 0");
  EXPECT_EQ(
      complaint([](auto& p) { p.axes[0].return_pressure = 2e7; }),
      "ControllerParameters::axes.return_pressure is 2e+07, expected 0 to less than the supply "
      "pressure");
}

}  // namespace
}  // namespace hydrapod::control
