/// Tasks near rest: what they compute, and that their JSON is read back.

#include "hydrapod/tasks/linear.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/report/measured_results.hpp"
#include "support/round_trip.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using report::Json;

tasks::Machine heavy(const std::string& pose = "neutral",
                     const std::vector<std::string>& overrides = {}) {
  return tasks::read_machine({.file = source_file("models/heavy-platform.toml").string(),
                              .overrides = overrides,
                              .pose = pose});
}

TEST(ReadMachine, TakesTextInsteadOfAFile) {
  const auto text = read_text(source_file("models/heavy-platform.toml"));
  const auto machine = tasks::read_machine(
      {.file = "heavy", .text = text, .pose = "z=10 mm", .model = dynamics::ModelKind::rigid});
  EXPECT_EQ(machine.file.machine.name, heavy().file.machine.name);
  EXPECT_EQ(machine.kind, dynamics::ModelKind::rigid);
  EXPECT_NEAR(machine.pose.X_BP.p_BP.z(), heavy().pose.X_BP.p_BP.z() + 0.01, 1e-15);
}

TEST(ReadMachine, CallsAMistakeAsTheCommandLineDoes) {
  try {
    heavy("nutral");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().at(0).text(),
              "--pose nutral: error: unknown pose; did you mean 'neutral'?");
  }
}

TEST(Modes, WithoutOverridesAreThoseOfTheFile) {
  EXPECT_FALSE(tasks::modes_without_overrides(heavy()));
  const auto before = tasks::modes_without_overrides(heavy("neutral", {"platform.mass=9000"}));
  ASSERT_TRUE(before);
  EXPECT_EQ(before->real.modes[0].mode.omega, tasks::modes(heavy()).real.modes[0].mode.omega);
}

TEST(RootLocus, StopsWhenAskedTo) {
  int calls = 0;
  const auto locus =
      tasks::root_locus(heavy(), {.key = "controller.gain", .from = 1.0, .to = 5.0, .count = 5},
                        [&](double) { return ++calls == 2; });
  EXPECT_EQ(locus.values.size(), 2U);
  EXPECT_THROW(tasks::root_locus(heavy(), {.key = "controller.gain", .from = 1.0, .to = 1.0}),
               std::invalid_argument);
}

TEST(Bode, FindsABandThatHoldsWhatThePlatformFeels) {
  const auto machine = heavy();
  const auto bode = tasks::bode(machine, {.points = 11});
  EXPECT_EQ(bode.omega.size(), 11U);
  double lowest = 1e300, highest = 0.0;
  for (const auto* modes : {&bode.table.real.modes, &bode.table.rigid.modes})
    for (const auto& entry : *modes) {
      if (!entry.moves_platform) continue;
      lowest = std::min(lowest, entry.mode.omega);
      highest = std::max(highest, entry.mode.omega);
    }
  EXPECT_NEAR(bode.omega.front(), lowest / 3.0, 1e-9);
  EXPECT_NEAR(bode.omega.back(), 2.0 * highest, 1e-9 * highest);
  EXPECT_EQ(*bode.options.p_PQ, machine.file.machine.platform.mass_center);
}

TEST(Sensitivity, RefusesNumbersThatAreNotThere) {
  EXPECT_THROW(tasks::sensitivity(heavy(), {.parameters = {"platform.mas"}}), base::InputError);
  try {
    tasks::sensitivity(heavy(),
                       {.parameters = {"legs.rod.mass", "platform.mass", "legs.rod.mass"}});
    FAIL() << "the same parameter twice";
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().at(0).text(), "--parameter legs.rod.mass: error: is given twice");
  }
}

TEST(RoundTrip, Modes) {
  for (const auto& changes : {std::vector<std::string>{}, {"legs.guide_sleeve.damping=6e4"}})
    expect_round_trip(report::modes_json(tasks::modes(heavy("neutral", changes))),
                      report::modes_from_json, report::modes_json);
}

TEST(RoundTrip, Bode) {
  expect_round_trip(report::bode_json(tasks::bode(heavy(), {.points = 5})), report::bode_from_json,
                    report::bode_json);
}

TEST(RoundTrip, System) {
  for (const bool closed : {true, false})
    expect_round_trip(report::system_json(tasks::system(heavy(), {.closed = closed})),
                      report::system_from_json, report::system_json);
}

TEST(RoundTrip, RootLocus) {
  const auto locus =
      tasks::root_locus(heavy(), {.key = "controller.gain", .from = 1.0, .to = 2.0, .count = 2});
  expect_round_trip(report::root_locus_json(locus), report::root_locus_from_json,
                    report::root_locus_json);
}

TEST(RoundTrip, CommandResponse) {
  const auto result = tasks::command_response(heavy(), {.points = 4});
  expect_round_trip(report::command_response_json(result.response),
                    report::command_response_from_json, report::command_response_json);
}

TEST(RoundTrip, Check) {
  const auto machine = heavy("neutral", {"platform.mass=60000"});
  const auto json =
      report::check_json(tasks::check(machine, machine.file.machine.poses), machine.file.machine);
  expect_round_trip(json, report::checks_from_json, [&](const auto& checks) {
    return report::check_json(checks, machine.file.machine);
  });
}

TEST(RoundTrip, Sensitivity) {
  const auto result = tasks::sensitivity(heavy(), {.parameters = {"platform.mass"}});
  expect_round_trip(report::sensitivity_json(result), report::sensitivity_from_json,
                    report::sensitivity_json);
}

TEST(Readers, NameFileAndKey) {
  auto json = report::modes_json(tasks::modes(heavy()));
  json["modes"][3]["pole"]["im"] = "x";
  try {
    report::modes_from_json(json, "modes.json");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().at(0).text(),
              "modes.json: error: modes[3].pole.im: expected a number");
  }
}

}  // namespace
}  // namespace hydrapod::test
