/// Numbers that only modes at amplitudes show come back from these.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "hydrapod/base/error.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "support/calibration_machine.hpp"
#include "support/modes_at_amplitude.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using dynamics::ModelKind;
using testing::HasSubstr;

/// The lowest six modes at two amplitudes, by following their branches.
observation::Targets at_both_amplitudes(const model::MachineFile& truth,
                                        std::array<double, 2> amplitudes) {
  observation::Targets targets;
  const auto& pose = truth.machine.poses.at(2);
  for (const auto& curve :
       modal::modes_at_amplitudes(truth.machine, pose.X_BP, ModelKind::guide, amplitudes)) {
    if (curve.from_long_swings || curve.mode > 5) continue;
    for (const auto& point : curve.points)
      if (point.converged)
        targets.modes.push_back({.name = fmt::format("{} at {:g} m", curve.mode, point.amplitude),
                                 .pose = pose.name,
                                 .omega = point.omega,
                                 .deviation = 1e-4 * point.omega,
                                 .amplitude = point.amplitude,
                                 .damping = point.damping_ratio,
                                 .damping_deviation = 1e-3 * point.damping_ratio});
  }
  return targets;
}

/// From a start that is off by a third: value to 1e-6, by derivatives that lead there in few steps.
void comes_back(const std::vector<std::string>& design, const std::string& path, double value,
                std::array<double, 2> amplitudes) {
  const auto text = test::read_text(test::source_file("models/heavy-platform.toml"));
  auto with = design;
  with.push_back(fmt::format("{}={}", path, value));
  const auto targets = at_both_amplitudes(test::machine_file(text, with), amplitudes);
  ASSERT_GE(targets.modes.size(), 8U);
  with.back() = fmt::format("{}={}", path, 0.67 * value);
  const auto start = test::machine_file(text, with);
  Plan plan{.free = test::free_paths({path})};
  plan.options = {.starts = 1, .loss = Loss::squares, .max_iterations = 20};
  const auto best = calibrate(start, targets, plan, ModelKind::guide).best();
  EXPECT_NEAR(best.parameters.at(0).value, value, 1e-6 * value) << path;
  EXPECT_EQ(best.parameters.at(0).verdict, Verdict::determined);
  EXPECT_LT(best.misfit, 1e-6);
  // small motions say nothing of it
  auto small = targets;
  for (auto& mode : small.modes) mode.amplitude = 0.0;
  small.modes.resize(6);
  bool unknown = false;
  try {
    unknown = calibrate(start, small, plan, ModelKind::guide).best().parameters.at(0).verdict ==
              Verdict::undetermined;
  } catch (const base::InputError& error) {
    unknown =
        error.diagnostics().front().message == "has no effect on the modes; it cannot be fitted";
  }
  EXPECT_TRUE(unknown) << path;
}

TEST(Amplitudes, GiveTheSofteningOfElastomers) {
  comes_back({"legs.guide_sleeve.elastomer.dynamic_ratio=1.73",
              "legs.guide_sleeve.elastomer.loss_factor=0.17",
              "legs.guide_sleeve.elastomer.frequency=7.3 Hz",
              "legs.guide_sleeve.elastomer.softening_amplitude=0.13 mm"},
             "legs.guide_sleeve.elastomer.softening", 0.33, {3.1e-5, 9.7e-5});
}

TEST(Amplitudes, GiveTheBristlesOfSeals) {
  comes_back({"legs.guide_sleeve.stiffness=8.7e6", "legs.friction.coulomb=310 N"},
             "legs.friction.bristles.stiffness", 2.3e7, {3.1e-6, 2.3e-5});
}

TEST(Amplitudes, GiveTheBristlesOfJoints) {
  comes_back({"legs.guide_sleeve.stiffness=8.7e6", "legs.joint_friction.coulomb=31 N m"},
             "legs.joint_friction.bristle_stiffness", 2.1e5, {7.1e-6, 4.3e-5});
}

TEST(Amplitudes, AreOfMechanicsAlone) {
  const auto file =
      test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
  observation::Targets targets{.observed = observation::Observed::plant};
  targets.modes.push_back({.name = "one", .omega = 31.0, .deviation = 0.1, .amplitude = 1e-3});
  try {
    compare(file, targets, ModelKind::guide);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().key, "amplitude");
    EXPECT_THAT(error.diagnostics().front().message, HasSubstr("--against mechanics"));
  }
}

TEST(Amplitudes, AreReadFromBothKindsOfTargets) {
  const auto toml =
      parse_targets("[[mode]]\nfrequency = \"7.1 Hz\"\namplitude = \"0.31 mm\"\n", "t.toml");
  EXPECT_DOUBLE_EQ(toml.targets.modes.at(0).amplitude, 3.1e-4);
  const auto csv = parse_targets("frequency [Hz],amplitude [mm]\n7.1,0.47\n7.3,\n", "t.csv");
  EXPECT_DOUBLE_EQ(csv.targets.modes.at(0).amplitude, 4.7e-4);
  EXPECT_EQ(csv.targets.modes.at(1).amplitude, 0.0);
  for (const auto* amplitude : {"\"-1 mm\"", "\"70 m\""}) try {
      parse_targets(fmt::format("[[mode]]\nfrequency = \"7.1 Hz\"\namplitude = {}\n", amplitude),
                    "t.toml");
      ADD_FAILURE() << amplitude;
    } catch (const base::InputError& error) {
      EXPECT_THAT(error.diagnostics().front().message, HasSubstr("expected 1e-09 to 10 m"));
    }
}

}  // namespace
}  // namespace hydrapod::calibration
