/// Studies of machines against `modes`, one machine at a time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/study/study.hpp"
#include "support/run_program.hpp"

namespace hydrapod::study {
namespace {

using base::two_pi;
using testing::HasSubstr;

model::MachineFile published(const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(
      test::source_file("models/zhang-jiang-2021-transverse.toml").string(), overrides,
      kinematics::check_machine);
}

std::size_t column(const Problem& problem, const std::string& name) {
  for (std::size_t k = 0; k < problem.outputs.size(); ++k)
    if (problem.outputs[k].name == name) return k;
  ADD_FAILURE() << name;
  return 0;
}

/// The static equilibrium is found from elsewhere: its tolerance is 1e-11 of the weight.
constexpr double same = 1e-8;

TEST(MachineStudy, RowsAreThoseOfModes) {
  const auto file = published({"environment.gravity=9.81"});
  const auto kind = dynamics::ModelKind::guide;
  auto inputs = read_variation(file, "legs.guide_sleeve.stiffness", "uniform ± 13 % per leg", "");
  const auto mass = read_variation(file, "platform.mass", "normal ± 2 %", "");
  inputs.push_back(mass.front());
  ASSERT_EQ(inputs.size(), 7U);
  const auto X_BP = file.machine.neutral();
  const auto problem = machine_problem(file.machine, inputs, {.kind = kind, .X_BP = X_BP});
  const auto model = problem.model();
  const Plan plan{.samples = 100, .seed = 31};
  std::vector<double> x(inputs.size()), y(problem.outputs.size());
  for (std::uint64_t row = 0; row < plan.samples; ++row) {
    place(plan, row, x);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = quantile(inputs[k].distribution, x[k]);
    model(x, y);
    ASSERT_EQ(y[0], 0.0);
    auto machine = file.machine;
    machine.platform.mass = x[6];
    for (std::size_t leg = 0; leg < 6; ++leg) machine.legs[leg].guide_sleeve.stiffness = x[leg];
    const auto table = modal::mode_table(machine, X_BP, kind);
    const int lowest = modal::lowest_platform_mode(table.real.modes);
    const double f = table.real.modes[static_cast<std::size_t>(lowest)].mode.omega / two_pi;
    EXPECT_NEAR(y[column(problem, "lowest")], f, same * f);
    const auto drop = table.real.modes[static_cast<std::size_t>(lowest)].rigid;
    ASSERT_TRUE(drop.has_value());
    EXPECT_NEAR(y[column(problem, "drop")], -drop->shift, 1e2 * same);
  }
}

/// One by one, in lanes, and frequencies alone: all at the pose that the numbers give.
TEST(MachineStudy, NumbersOfThePoseMoveThePlatform) {
  const auto file = published({"environment.gravity=9.81"});
  const auto kind = dynamics::ModelKind::guide;
  const std::string pose = "neutral";
  auto inputs = read_variation(file, "poses.neutral.position[2]", "uniform ± 2 %", "");
  inputs.push_back(read_variation(file, "poses.neutral.rotation[0]", "uniform ± 0.02", "").front());
  EXPECT_EQ(file.machine.poses.at(pose_of(inputs.front().id).value()).name, pose);
  const auto problem = machine_problem(
      file.machine, inputs, {.kind = kind, .X_BP = file.machine.neutral(), .pose = pose});
  const auto one = problem.model();
  DesignFrequencies frequencies(file.machine, file.machine.neutral(), kind,
                                {inputs[0].id, inputs[1].id}, pose);
  const double z = file.machine.neutral().p_BP.z();
  const std::vector<double> x{0.993 * z, 0.0013, 0.9971 * z, -0.0017, z, 0.0019};
  const std::size_t width = problem.outputs.size();
  std::vector<double> together(3 * width), y(width);
  std::vector<Row> rows;
  for (std::size_t k = 0; k < 3; ++k)
    rows.push_back({std::span(x).subspan(2 * k, 2), std::span(together).subspan(k * width, width)});
  problem.batch()(rows);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto own = std::span(x).subspan(2 * k, 2);
    const auto moved = machine_of(file.machine, inputs, own);
    EXPECT_NEAR(moved.neutral().p_BP.z(), own[0], 1e-12);
    const auto table = modal::mode_table(moved, moved.neutral(), kind);
    const int lowest = modal::lowest_platform_mode(table.real.modes);
    const double f = table.real.modes[static_cast<std::size_t>(lowest)].mode.omega / two_pi;
    one(own, y);
    ASSERT_EQ(y[0], 0.0);
    EXPECT_NEAR(y[column(problem, "lowest")], f, same * f);
    EXPECT_NEAR(together[k * width + column(problem, "lowest")], f, same * f);
    std::vector<double> omega(static_cast<std::size_t>(table.real.normal.size()));
    frequencies(own, omega);
    EXPECT_NEAR(omega[0], table.real.normal.omega(0), same * omega[0]);
    EXPECT_NE(y[column(problem, "condition")],
              together[((k + 1) % 3) * width + column(problem, "condition")]);
  }
}

/// Of elastomers too: each mode with the stiffness that the seals have at its frequency.
TEST(MachineStudy, RowsOfElastomersAreThoseOfModes) {
  auto machine = published({"environment.gravity=9.81"}).machine;
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer =
        model::Elastomer{.dynamic_ratio = 1.83, .loss_factor = 0.26, .frequency = 7.7};
  const auto X_BP = machine.neutral();
  const auto kind = dynamics::ModelKind::guide;
  model::MachineFile file;
  file.machine = machine;
  const auto inputs = read_variation(file, "platform.mass", "uniform ± 9 %", "");
  const auto problem = machine_problem(machine, inputs, {.kind = kind, .X_BP = X_BP});
  std::vector<double> y(problem.outputs.size());
  const auto model = problem.model();
  DesignFrequencies frequencies(machine, X_BP, kind, {inputs.front().id});
  for (const double share : {0.93, 1.0, 1.071}) {
    const std::vector<double> x{share * machine.platform.mass};
    model(x, y);
    ASSERT_EQ(y[0], 0.0);
    auto changed = machine;
    changed.platform.mass = x[0];
    const auto table = modal::mode_table(changed, X_BP, kind);
    const int lowest = modal::lowest_platform_mode(table.real.modes);
    const auto& mode = table.real.modes[static_cast<std::size_t>(lowest)];
    const double f = mode.mode.omega / two_pi;
    EXPECT_NEAR(y[column(problem, "lowest")], f, same * f);
    ASSERT_TRUE(mode.rigid.has_value());
    EXPECT_NEAR(y[column(problem, "drop")], -mode.rigid->shift, 1e2 * same);
    std::vector<double> omega(static_cast<std::size_t>(table.real.normal.size()));
    frequencies(x, omega);
    for (std::size_t k = 0; k < omega.size(); ++k)
      EXPECT_NEAR(omega[k], table.real.modes[k].mode.omega, same * omega[k]);
    const auto quick = modal::normal_modes(table.real.linear);
    EXPECT_GT(quick.omega(0) / two_pi, 1.005 * f) << "the seals are not the stiff ones";
  }
}

/// SIMD lanes have no modes of the payload, no elastomers and no beams: a batch of such machines
/// has the bits of the same machines computed one by one.
TEST(MachineStudy, MachinesWithPartsThatTheLanesLackAreComputedOneByOne) {
  const auto file = published({"environment.gravity=9.81"});
  const auto inputs = read_variation(file, "platform.mass", "normal ± 2 %", "");
  constexpr std::size_t count = 20;
  const auto run_alone = [&](const model::Machine& machine) {
    const auto problem = machine_problem(
        machine, inputs, {.kind = dynamics::ModelKind::guide, .X_BP = machine.neutral()});
    const auto one = problem.model();
    std::vector<double> x(count), together(count * problem.outputs.size()), y(together.size());
    std::vector<Row> rows;
    for (std::size_t k = 0; k < count; ++k) {
      x[k] = machine.platform.mass * (0.97 + 0.0031 * static_cast<double>(k));
      const std::span<const double> in(&x[k], 1);
      const std::size_t at = k * problem.outputs.size();
      rows.push_back({in, std::span(together).subspan(at, problem.outputs.size())});
      one(in, std::span(y).subspan(at, problem.outputs.size()));
    }
    const std::size_t alone = problem.batch()(rows);
    if (alone == count) {
      EXPECT_THAT(together, testing::Pointwise(testing::NanSensitiveDoubleEq(), y));
    }
    EXPECT_EQ(y[0], 0.0);
    return alone;
  };
  EXPECT_EQ(run_alone(file.machine), 0U);
  auto swinging = file.machine;
  swinging.payload_modes.push_back({.name = "cabin",
                                    .frequency = 7.3,
                                    .mass = 0.11 * swinging.platform.mass,
                                    .direction = {0.9, 0.3, 0.1}});
  EXPECT_EQ(run_alone(swinging), count);
  auto soft = file.machine;
  for (auto& leg : soft.legs)
    leg.guide_sleeve.elastomer =
        model::Elastomer{.dynamic_ratio = 1.7, .loss_factor = 0.23, .frequency = 11.0};
  EXPECT_EQ(run_alone(soft), count);
  auto bending = file.machine;
  for (auto& leg : bending.legs) {
    leg.bending = model::LegBending::elastic;
    leg.rod.diameter = 0.061;
    leg.rod.wall = 0.011;
  }
  EXPECT_EQ(run_alone(bending), count);
}

/// README: under gravity the seals lower x and y from 7.438 to 4.991 Hz.
TEST(MachineStudy, KnowsThePublishedDrop) {
  const auto file = published({"environment.gravity=9.81"});
  const auto inputs = read_variation(file, "platform.mass", "normal ± 0.001 %", "");
  const auto problem = machine_problem(
      file.machine, inputs,
      {.kind = dynamics::ModelKind::guide, .X_BP = file.machine.neutral(), .also = {"buckling"}});
  std::vector<double> x{file.machine.platform.mass}, y(problem.outputs.size());
  problem.model()(x, y);
  constexpr double printed = 5e-4;
  EXPECT_NEAR(y[column(problem, "x")], 4.991, printed);
  EXPECT_NEAR(y[column(problem, "drop_x")], 0.329, printed);
  EXPECT_NEAR(y[column(problem, "mac")], 1.0, 1e-9);
  EXPECT_NEAR(y[column(problem, "buckling")], 457.0, 0.5);
}

TEST(MachineStudy, BuckledMachinesHaveNoFrequencies) {
  const auto file = published({"environment.gravity=9.81"});
  const auto inputs = read_variation(file, "platform.mass", "normal ± 1 %", "");
  const auto problem = machine_problem(
      file.machine, inputs, {.kind = dynamics::ModelKind::guide, .X_BP = file.machine.neutral()});
  std::vector<double> x{file.machine.platform.mass + 600.0}, y(problem.outputs.size());
  problem.model()(x, y);
  EXPECT_GE(y[0], static_cast<double>(Status::no_equilibrium));
  EXPECT_TRUE(std::isnan(y[column(problem, "lowest")]));
  x[0] = -3.0;
  problem.model()(x, y);
  EXPECT_EQ(y[0], static_cast<double>(Status::not_allowed));
  x[0] = 901.0;  // what went before leaves nothing behind
  problem.model()(x, y);
  EXPECT_EQ(y[0], 0.0);
}

TEST(Maps, AreModesAtEachPose) {
  const auto file = published();
  std::vector<Input> inputs;
  for (const char* name : {"x", "z", "ry"})
    inputs.push_back({.name = name, .unit = name[0] == 'r' ? "rad" : "m"});
  const auto neutral = file.machine.neutral();
  const auto problem = machine_problem(
      file.machine, inputs, {.kind = dynamics::ModelKind::guide, .X_BP = neutral, .poses = true});
  const auto model = problem.model();
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  std::vector<double> x(3), y(problem.outputs.size());
  int computed = 0;
  for (int k = 0; k < 1000; ++k) {
    x = {0.05 * part(random), 0.04 * part(random), 0.1 * part(random)};
    model(x, y);
    spatial::Pose X_BP = neutral;
    X_BP.p_BP += spatial::Vector3(x[0], 0.0, x[1]);
    X_BP.R_BP = spatial::rotation_from_rpy({0.0, x[2], 0.0}) * X_BP.R_BP;
    const bool reached = kinematics::check_pose(file.machine, X_BP, "").empty();
    ASSERT_EQ(y[0] == 0.0, reached);
    if (!reached) continue;
    ++computed;
    const auto table = modal::mode_table(file.machine, X_BP, dynamics::ModelKind::guide);
    const int lowest = modal::lowest_platform_mode(table.real.modes);
    const double f = table.real.modes[static_cast<std::size_t>(lowest)].mode.omega / two_pi;
    ASSERT_NEAR(y[column(problem, "lowest")], f, same * f);
  }
  EXPECT_GT(computed, 500);
}

/// How far beyond its stroke a leg would have to go, from the lengths of the legs.
TEST(Maps, SayWhatStrokeIsLackingOutOfReach) {
  const auto file = model::read_machine_file(
      test::source_file("models/heavy-platform.toml").string(), {}, kinematics::check_machine);
  const auto& machine = file.machine;
  const auto problem = machine_problem(
      machine, {{.name = "x", .unit = "m"}, {.name = "z", .unit = "m"}},
      {.kind = dynamics::ModelKind::guide, .X_BP = machine.neutral(), .poses = true});
  const auto model = problem.model();
  std::vector<double> y(problem.outputs.size());
  int beyond = 0;
  for (const double x : {-0.83, -0.31, 0.0, 0.47})
    for (const double z : {-0.91, -0.2, 0.07, 0.33}) {
      model(std::vector{x, z}, y);
      auto X_BP = machine.neutral();
      X_BP.p_BP += spatial::Vector3(x, 0.0, z);
      const auto lengths = kinematics::leg_lengths(machine, X_BP);
      double left = std::numeric_limits<double>::infinity();
      for (int i = 0; i < model::leg_count; ++i) {
        const auto& leg = machine.legs[static_cast<std::size_t>(i)];
        const double in = lengths[i] - leg.rod.length - leg.stroke->retracted;
        left = std::min({left, in, leg.stroke->length - in});
      }
      EXPECT_NEAR(y[column(problem, "stroke")], left, 1e-12) << x << ' ' << z;
      if (left >= 0.0) continue;
      ++beyond;
      EXPECT_EQ(y[0], static_cast<double>(Status::out_of_reach));
      EXPECT_TRUE(std::isnan(y[column(problem, "lowest")]));
    }
  EXPECT_GT(beyond, 4);
  EXPECT_LT(beyond, 14);
}

TEST(WorstSamples, AreReadBackFromTheirFile) {
  const auto file = published();
  const auto inputs =
      read_variation(file, "legs.guide_sleeve.stiffness", "uniform ± 13 % per leg", "");
  std::vector<double> values;
  for (int leg = 0; leg < 6; ++leg) values.push_back(1.234567890123e5 * (1.0 + 0.1 * leg));
  const auto text = machine_text(file, inputs, values, "worst sample");
  const auto machine = model::parse_machine(text, "worst").machine;
  for (std::size_t leg = 0; leg < 6; ++leg)
    EXPECT_NEAR(machine.legs[leg].guide_sleeve.stiffness, values[leg], 1e-12 * values[leg]);
}

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const base::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(WrongUse, IsRefusedWithWhatWouldBeAccepted) {
  const auto file = published();
  EXPECT_THAT(message_of([&] {
                read_variation(file, "legs.guide_sleeve.stifness", "normal ± 1 %", "--vary");
              }),
              HasSubstr("did you mean `legs.guide_sleeve.stiffness`"));
  EXPECT_THAT(message_of([&] { read_variation(file, "platform.mass", "normal ± 60 %", "--vary"); }),
              HasSubstr("lognormal"));
  EXPECT_THAT(
      message_of([&] { read_variation(file, "platform.mass", "normal ± 1 % per leg", "--vary"); }),
      HasSubstr("per leg"));
  const std::vector<Column> outputs{{"x", "Hz", ""}, {"drop", "1", ""}};
  EXPECT_THAT(message_of([&] { read_requirement("xx >= 6 Hz", outputs, "--want"); }),
              HasSubstr("did you mean 'x'"));
  EXPECT_THAT(message_of([&] { read_requirement("x >= 6 kg", outputs, "--want"); }),
              HasSubstr("6 kg"));
  EXPECT_THAT(message_of([&] { read_requirement("x = 6 Hz", outputs, "--want"); }),
              HasSubstr(">="));
  EXPECT_THAT(message_of([&] { read_requirement("x <= 0 Hz", outputs, "--want"); }),
              HasSubstr("no machine meets"));
  EXPECT_NEAR(read_requirement("drop <= 2 %", outputs, "").bound, 0.02, 1e-15);
}

}  // namespace
}  // namespace hydrapod::study
