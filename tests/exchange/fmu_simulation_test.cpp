/// FMUs against the plant that they hold, integrated by another method.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <thread>

#include "exchange/fmu_subject.hpp"
#include "hydrapod/model/parameters.hpp"

namespace hydrapod::test {
namespace {

class CoSimulation : public testing::TestWithParam<Case> {};

/// Ten seconds of each combination are in fmu_long_test.cpp. Without oil springs nothing brings the
/// platform back: it is followed for as long as it is near.
TEST_P(CoSimulation, FollowsThePlantUnderNoise) {
  const auto of = GetParam();
  const bool two = of.version == FmuVersion::fmi2;
  expect_same_motion(Subject(of), !of.hydraulics ? 300 : two ? 1000 : 10000);
}

TEST_P(CoSimulation, OutputsAreThoseOfThePlant) {
  const Subject subject(GetParam());
  const Slave slave(subject.fmu, true);
  Random random(2);
  const auto values = subject.noise(random);
  ASSERT_EQ(ok, slave.set(subject.inputs, values));
  for (int k = 0; k < 20; ++k) ASSERT_EQ(ok, slave.step(sample * k, sample));
  const auto x = slave.get(subject.states);
  const auto out = subject.plant.outputs(x.data(), subject.input(values));
  const auto expect = [&](const std::string& name, double value, double scale) {
    EXPECT_NEAR(slave.get(name), value, 1e-10 * scale) << name;
  };
  const auto angles = spatial::rpy_from_rotation(out.X_BP.R_BP);
  expect("pose.x", out.X_BP.p_BP.x(), 1.0);
  expect("pose.z", out.X_BP.p_BP.z(), 1.0);
  expect("pose.ry", angles.y(), 1.0);
  expect("vx", out.twist[0], 1.0);
  expect("acceleration.z", out.acceleration[2], 1e2);
  expect("acceleration.rx", out.acceleration[3], 1e2);
  for (int i = 0; i < 6; ++i) {
    const auto leg = "leg" + std::to_string(i + 1) + '.';
    const auto& of = out.legs[static_cast<std::size_t>(i)];
    expect(leg + "length", of.length, 1.0);
    expect(leg + "length_rate", of.length_rate, 1.0);
    expect(leg + "piston", of.piston, 1.0);
    expect(leg + "stop_force", of.stop_force, 1.0);
    if (!subject.hydraulics) continue;
    expect(leg + "p_rod", of.rod_pressure, 1e6);
    expect(leg + "spool", of.spool, 1.0);
    expect(leg + "oil_force", of.oil_force, 1e5);
    expect(leg + "friction_force", of.friction_force, 1e5);
  }
}

spatial::Matrix3 orientation(const Slave& slave) {
  using spatial::Vector3;
  return (Eigen::AngleAxisd(slave.get("pose.rz"), Vector3::UnitZ()) *
          Eigen::AngleAxisd(slave.get("pose.ry"), Vector3::UnitY()) *
          Eigen::AngleAxisd(slave.get("pose.rx"), Vector3::UnitX()))
      .toRotationMatrix();
}

/// Speed of the platform at the joint of a leg, from the FMU's velocities and pose.
spatial::Vector3 speed_of_joint(const Subject& subject, const Slave& slave, std::size_t leg) {
  const auto three = [&](const char* a, const char* b, const char* c) {
    return spatial::Vector3(slave.get(a), slave.get(b), slave.get(c));
  };
  const spatial::Vector3 arm = orientation(slave) * (subject.machine.legs[leg].platform_joint -
                                                     subject.machine.platform.mass_center);
  return three("vx", "vy", "vz") + three("wx", "wy", "wz").cross(arm);
}

TEST_P(CoSimulation, AccelerometersFeelTheAccelerationOfTheirPlaceLessGravity) {
  const Subject subject(GetParam());
  const Slave slave(subject.fmu, true, true, 1e-11);
  EXPECT_NEAR(slave.get("accelerometer3.z"), 0.0, 1e-6);  // at rest
  Random random(11);
  ASSERT_EQ(ok, slave.set(subject.inputs, subject.noise(random)));
  double time = 0.0;
  const auto step = [&](double h) {
    ASSERT_EQ(ok, slave.step(time, h));
    time += h;
  };
  for (int k = 0; k < 20; ++k) step(sample);
  constexpr double h = 1e-5;
  for (const std::size_t leg : {0U, 2U, 4U}) {
    const auto before = speed_of_joint(subject, slave, leg);
    step(h);
    const auto R = orientation(slave);
    std::array<double, 3> shown{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      shown[axis] = slave.get("accelerometer" + std::to_string(leg + 1) + '.' + "xyz"[axis]);
    step(h);
    const spatial::Vector3 a = (speed_of_joint(subject, slave, leg) - before) / (2.0 * h);
    const auto& rest = subject.machine.neutral().R_BP;
    const spatial::Vector3 expected =
        R.transpose() * (a - subject.machine.gravity) + rest.transpose() * subject.machine.gravity;
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(shown[axis], expected[static_cast<Eigen::Index>(axis)], 2e-5 * (1.0 + a.norm()))
          << leg << "xyz"[axis];
  }
}

TEST_P(CoSimulation, DerivativesAreThoseOfDifferences) {
  Random random(3);
  expect_derivatives_of_differences(Subject(GetParam()), random);
}

TEST_P(CoSimulation, ModelExchangeUnderCvodeFollowsThePlant) {
  const auto of = GetParam();
  const bool two = of.version == FmuVersion::fmi2;
  expect_same_motion_in_model_exchange(Subject(of), of.hydraulics && two ? 10000 : 200);
}

TEST_P(CoSimulation, SavedStatesContinueBitByBit) {
  expect_saved_states_continue(Subject(GetParam()));
}

TEST_P(CoSimulation, InstancesInThreadsGiveTheSameBits) {
  const Subject subject(GetParam());
  std::vector<std::vector<double>> found(4);
  std::vector<std::thread> threads;
  for (auto& result : found)
    threads.emplace_back([&] {
      const Slave slave(subject.fmu, true);
      Random random(6);
      for (int k = 0; k < 100; ++k) {
        slave.set(subject.inputs, subject.noise(random));
        slave.step(sample * k, sample);
      }
      result = slave.get(subject.states);
    });
  for (auto& thread : threads) thread.join();
  for (const auto& result : found) EXPECT_EQ(found[0], result);
}

INSTANTIATE_TEST_SUITE_P(
    Fmu, CoSimulation,
    testing::Values(Case{FmuVersion::fmi2, true}, Case{FmuVersion::fmi2, false},
                    Case{FmuVersion::fmi3, true}, Case{FmuVersion::fmi3, false}),
    [](const auto& of) {
      return std::string(of.param.version == FmuVersion::fmi2 ? "Fmi2" : "Fmi3") +
             (of.param.hydraulics ? "Plant" : "Mechanics");
    });

TEST(FmuParameters, AreNumbersOfTheMachine) {
  const Subject subject({FmuVersion::fmi2, true});
  auto machine = subject.machine;
  const std::vector<std::pair<std::string, std::string>> changes{
      {"platform.mass", "platform.mass"},
      {"leg3.valve.damping_ratio", "leg.3.valve.damping_ratio"},
      {"supply.pressure", "supply.pressure"},
      {"leg2.base_joint[1]", "leg.2.base_joint[1]"}};
  Slave slave(subject.fmu, true, false);
  std::vector<model::Assignment> assignments;
  for (const auto& [name, path] : changes) {
    const auto id = *model::find_parameter(machine, path);
    assignments.push_back({id, 1.01 * *model::value(machine, id)});
    EXPECT_EQ(ok, slave.set(name, assignments.back().value));
  }
  slave.begin(1e-6);
  const Plant changed(model::with(machine, assignments), dynamics::ModelKind::guide);
  const auto rest = changed.equilibrium(machine.neutral());
  const auto x = slave.get(subject.states);
  for (int k = 0; k < rest.x.size(); ++k)
    EXPECT_NEAR(rest.x[k], x[static_cast<std::size_t>(k)],
                1e-9 * std::max(1.0, std::abs(rest.x[k])));
  EXPECT_EQ(1.01 * machine.platform.mass, slave.get("platform.mass"));
  EXPECT_EQ(error, slave.set("leg1.rod.length", 1.0));  // fixed, and this is too late
}

TEST(FmuParameters, ThatNoMachineCanHaveAreRefused) {
  const Subject subject({FmuVersion::fmi3, true});
  const Slave negative(subject.fmu, true, false);
  EXPECT_EQ(discard, negative.set("platform.mass", -1.0));
  const Slave impossible(subject.fmu, true, false);  // an inertia that no body has
  EXPECT_EQ(ok, impossible.set("platform.inertia.xx", 1e6));
  EXPECT_EQ(ok, impossible.call("fmi3EnterInitializationMode", false, 0.0, 0.0, false, 0.0));
  EXPECT_EQ(error, impossible.call("fmi3ExitInitializationMode"));
}

TEST(FmuInstances, AThousandLeaveNothingBehind) {
  const Subject subject({FmuVersion::fmi2, true});
  const auto use = [&] {
    const Slave slave(subject.fmu, true);
    EXPECT_EQ(ok, slave.step(0.0, sample));
    void* state = nullptr;
    EXPECT_EQ(ok, slave.call("fmi2GetFMUstate", &state));
    EXPECT_EQ(ok, slave.call("fmi2FreeFMUstate", &state));
  };
  for (int k = 0; k < 10; ++k) use();  // what is made once
  const auto before = mallinfo2().uordblks;
  for (int k = 0; k < 1000; ++k) use();
  // blocks that malloc keeps at hand count as well; the smallest block has 32 bytes
  EXPECT_LE(mallinfo2().uordblks, before + 16 * 1000);
}

}  // namespace
}  // namespace hydrapod::test
