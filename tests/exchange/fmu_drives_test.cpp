/// FMUs of electric cylinders: motors, screws and speed loops inside.

#include <gtest/gtest.h>

#include <cmath>

#include "exchange/fmu_subject.hpp"
#include "support/electric_platform.hpp"

namespace hydrapod::test {
namespace {

class ElectricFmu : public testing::TestWithParam<Case> {};

TEST_P(ElectricFmu, HasDrivesInPlaceOfValves) {
  const Subject subject(GetParam(), electric_platform());
  const auto count = [&](const char* name) { return subject.fmu.references.count(name); };
  for (const char* name :
       {"leg2.nut", "leg5.torque_integral", "leg1.drive_command", "leg3.torque", "leg6.motor_speed",
        "leg4.screw_force", "leg4.screw.speed_bandwidth", "leg5.screw.speed_integral_time"})
    EXPECT_EQ(count(name), 1U) << name;
  for (const char* name : {"leg1.p_cap", "leg1.spool", "leg1.valve_command", "leg1.oil_force",
                           "supply.pressure", "leg1.screw.speed_integral_time"})
    EXPECT_EQ(count(name), 0U) << name;
  const Slave slave(subject.fmu, true);
  EXPECT_EQ(slave.get("leg1.drive_command"), 0.0);
  const auto torques = subject.plant.motor_torques(subject.rest.x.data(), spatial::Vector6::Zero());
  EXPECT_GT(std::abs(torques[2]), 1.0);
  EXPECT_NEAR(slave.get("leg3.torque"), torques[2], 1e-9 * std::abs(torques[2]));
}

TEST_P(ElectricFmu, FollowsThePlant) {
  const Subject subject(GetParam(), electric_platform());
  expect_same_motion(subject, 100);
}

TEST_P(ElectricFmu, DerivativesAreThoseOfDifferences) {
  Random random(17);
  expect_derivatives_of_differences(Subject(GetParam(), electric_platform()), random);
}

TEST_P(ElectricFmu, SavedStatesContinueBitByBit) {
  expect_saved_states_continue(Subject(GetParam(), electric_platform()));
}

/// The state stays, and the torque is that of the other gain.
TEST_P(ElectricFmu, SpeedLoopsCanBeTuned) {
  const Subject subject(GetParam(), electric_platform());
  const Slave slave(subject.fmu, true);
  ASSERT_EQ(ok, slave.set("leg3.drive_command", 0.05));
  for (int k = 0; k < 5; ++k) ASSERT_EQ(ok, slave.step(sample * k, sample));
  const auto x = slave.get(subject.states);
  const double speed = slave.get("leg3.motor_speed"), torque = slave.get("leg3.torque");
  ASSERT_EQ(ok, slave.set("leg3.screw.speed_bandwidth", 73.0));
  EXPECT_EQ(x, slave.get(subject.states));
  const double gained = 2.0 * M_PI * 23.0 * 0.043 * (0.05 * 303.7 - speed);
  EXPECT_NEAR(slave.get("leg3.torque") - torque, gained, 1e-9 * std::abs(torque));
  EXPECT_EQ(error, slave.set("leg3.screw.lead", 0.01));
}

INSTANTIATE_TEST_SUITE_P(
    Fmu, ElectricFmu, testing::Values(Case{FmuVersion::fmi2, true}, Case{FmuVersion::fmi3, true}),
    [](const auto& of) {
      return std::string(of.param.version == FmuVersion::fmi2 ? "Fmi2" : "Fmi3");
    });

/// A swing of 6 mm in heave, with drives that come between two samples.
signals::Sample heave_at(double time) {
  constexpr double size = 3e-3, omega = 23.0;
  signals::Sample command;
  command.value[2] = size * (1.0 - std::cos(omega * time));
  command.rate[2] = size * omega * std::sin(omega * time);
  return command;
}

TEST(ElectricFmuInTheLoop, MovesAsSimulateDoes) {
  auto machine = electric_platform();
  machine.controller.delay = 1.37;
  constexpr int samples = 200;
  simulation::ClosedLoop loop(
      machine, machine.neutral(),
      {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10},
       .until = sample * samples,
       .ideal_sensors = true});
  std::vector<Eigen::Vector4d> expected;
  loop.run([](double time, simulation::Excitation& given) { given.command = heave_at(time); },
           [&](const simulation::LoopSample& at) {
             expected.emplace_back(at.plant.X_BP.p_BP.z(), at.applied[3], at.plant.legs[2].torque,
                                   at.plant.legs[5].motor_speed);
           });
  ASSERT_EQ(expected.size(), samples + 1U);
  const Unpacked fmu(archive_of(machine, {.version = FmuVersion::fmi3, .controlled = true}));
  const Slave slave(fmu, true, true, 1e-10);
  Eigen::Vector4d low = expected[0], high = low, worst = Eigen::Vector4d::Zero();
  for (int k = 0; k < samples; ++k) {
    const auto command = heave_at(sample * k);
    ASSERT_EQ(ok, slave.set("command.z", command.value[2]));
    ASSERT_EQ(ok, slave.set("command_rate.z", command.rate[2]));
    ASSERT_EQ(ok, slave.step(sample * k, sample * (k + 1) - sample * k));
    const Eigen::Vector4d found(slave.get("pose.z"), slave.get("leg4.drive_command"),
                                slave.get("leg3.torque"), slave.get("leg6.motor_speed"));
    const auto& wanted = expected[static_cast<std::size_t>(k) + 1];
    worst = worst.cwiseMax((found - wanted).cwiseAbs());
    low = low.cwiseMin(wanted);
    high = high.cwiseMax(wanted);
  }
  EXPECT_GT((high - low).minCoeff(), 0.0);
  EXPECT_LT(worst.cwiseQuotient(high - low).maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace hydrapod::test
