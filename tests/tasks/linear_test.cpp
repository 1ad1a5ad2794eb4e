/// Tasks near rest: what they compute, and that their JSON is read back.

#include "hydrapod/tasks/linear.hpp"

#include <fmt/format.h>
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

TEST(RootLocus, HasBothEndsAndTheLimitOfStability) {
  const auto published = [](double gain) {
    return tasks::read_machine({.file = source_file("models/zhang-jiang-2021.toml").string(),
                                .overrides = {fmt::format("controller.gain={:.17g}", gain)},
                                .model = dynamics::ModelKind::rigid});
  };
  const auto locus = tasks::root_locus(
      published(20.0), {.key = "controller.gain", .from = 20.0, .to = 61.0, .count = 3});
  EXPECT_EQ(locus.values, (std::vector<double>{20.0, 40.5, 61.0}));
  ASSERT_EQ(locus.limits.size(), 1U);
  const double limit = locus.limits.front(), found_to = 2e-4 * 20.5;
  EXPECT_TRUE(tasks::system(published(limit - found_to)).poles.sampled_stable);
  EXPECT_FALSE(tasks::system(published(limit + found_to)).poles.sampled_stable);
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

/// A base and modes of the payload add to the 30 modes of legs with piston rings.
TEST(ReadBode, TakesEveryModeThatAModelMayHave) {
  auto json = report::bode_json(tasks::bode(heavy(), {.points = 500}));
  ASSERT_FALSE(json["peaks"].empty());
  auto& mode = json["peaks"][0]["mode"];
  mode = dynamics::max_dof;
  EXPECT_EQ(report::bode_from_json(json, "bode.json").real_peaks[0].mode, dynamics::max_dof - 1);
  mode = dynamics::max_dof + 1;
  EXPECT_THROW(report::bode_from_json(json, "bode.json"), base::InputError);
}

TEST(RoundTrip, System) {
  for (const bool closed : {true, false})
    expect_round_trip(report::system_json(tasks::system(heavy(), {.closed = closed})),
                      report::system_from_json, report::system_json);
}

/// What nothing damps has a real part of rounding, of either sign.
TEST(RoundTrip, SystemOfAnUndampedOscillationIsStable) {
  auto system = tasks::system(heavy(), {.closed = true});
  ASSERT_TRUE(system.poles.stable);
  system.poles.sampled.clear();  // they would decide
  for (const double rounding : {-3e-11, 3e-11}) {
    system.poles.poles.front().pole = {rounding, 271.3};
    simulation::mark_growing(system.poles);
    const auto json = report::system_json(system);
    EXPECT_EQ(json["poles"][0]["stable"], true);
    EXPECT_TRUE(report::system_from_json(json, "system.json").poles.stable);
  }
  system.poles.poles.front().pole = {1e-3, 271.3};
  simulation::mark_growing(system.poles);
  EXPECT_EQ(report::system_json(system)["poles"][0]["stable"], false);
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

/// What a reader says of the modes of a machine after `change`; empty: nothing.
template <class Change>
std::string refusal_of_modes(const Change& change) {
  static const auto sound = report::modes_json(tasks::modes(heavy()));
  auto json = sound;
  change(json);
  try {
    report::modes_from_json(json, "modes.json");
  } catch (const base::InputError& error) {
    return error.diagnostics().at(0).text();
  }
  return {};
}

TEST(Readers, TakeNoShapeThatIsNotOfTheModel) {
  EXPECT_EQ(refusal_of_modes([](Json&) {}), "");
  EXPECT_EQ(refusal_of_modes([](Json& json) { json["modes"][2]["shape"] = Json::array({0.3}); }),
            "modes.json: error: modes[2].shape: expected 18 numbers");
  EXPECT_EQ(refusal_of_modes([](Json& json) {
              auto& shape = json["rigid_modes"][5]["shape"];
              while (shape.size() < 43) shape.push_back(0.7);
            }),
            "modes.json: error: rigid_modes[5].shape: expected at most 42 numbers");
  EXPECT_EQ(refusal_of_modes([](Json& json) {
              json["modes"][1]["shape_imaginary"] = {1.0, 2.0};
            }),
            "modes.json: error: modes[1].shape_imaginary: expected 18 numbers");
  EXPECT_EQ(refusal_of_modes([](Json& json) { json["modes"][0]["leg_energy"].erase(5); }),
            "modes.json: error: modes[0].leg_energy: expected 6 numbers");
}

const std::vector<std::string> on_a_base{
    "base.mount.mass=1.31 t", "base.mount.stiffness.z=0.41 kN/um", "base.mount.stiffness.ry=7.1e8"};

TEST(Readers, TakeShapesWithTheBaseInThem) {
  const auto table = tasks::modes(heavy("neutral", on_a_base));
  const auto json = report::modes_json(table);
  ASSERT_EQ(json["modes"].size(), 20U);
  EXPECT_EQ(json["coordinates"][18], "base.z");
  EXPECT_EQ(json["coordinates"][19], "base.ry");
  EXPECT_EQ(json["rigid_modes"][0]["shape"].size(), 8U);
  expect_round_trip(json, report::modes_from_json, report::modes_json);
  auto other = json;
  other["coordinates"].erase(19);
  EXPECT_THROW(report::modes_from_json(other, "modes.json"), base::InputError);
}

TEST(Readers, TakeNoNumberOfAModeThatIsNotThere) {
  EXPECT_EQ(refusal_of_modes([](Json& json) { json["modes"][0]["rigid"]["mode"] = 7; }),
            "modes.json: error: modes[0].rigid.mode: there are 6 rigid modes");
  EXPECT_EQ(refusal_of_modes([](Json& json) { json["modes"][0]["rigid"]["mode"] = 4294967298; }),
            "modes.json: error: modes[0].rigid.mode: is 4294967298, which does not fit");
  EXPECT_EQ(refusal_of_modes(
                [](Json& json) { json["modes"][0]["rigid"]["mode"] = -9223372036854775807 - 1; }),
            "modes.json: error: modes[0].rigid.mode: is -9223372036854775808, which does not fit");
}

/// A thousand inputs by a thousand outputs at a thousand lines, of which the file has none, would
/// be 16 GB.
TEST(Readers, BelieveNoSizeOfResponsesThatAreNotThere) {
  const auto many = [](const report::Json& item) { return report::Json(std::vector(1000, item)); };
  report::Json json{{"inputs", many(report::Json::object())},
                    {"outputs", many(report::Json::object())},
                    {"frequency_hz", report::Json::array()},
                    {"response", many(report::Json::array())}};
  for (int k = 0; k < 1000; ++k) json["frequency_hz"].push_back(0.25 * k);
  try {
    report::responses_from_json(json, "frf.json");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().at(0).text(),
              "frf.json: error: response: row 1 must have 1000 entries");
  }
}

TEST(Readers, NameAColumnThatIsNotUtf8) {
  const TemporaryFolder folder;
  write_text(folder / "m.csv",
             "frequency_hz,frequency_95_hz,damping_ratio,damping_95,significance,re y\x96\n"
             "4.1,0.02,0.03,0.002,40,1\n");
  try {
    report::identified_modes_from_csv(folder / "m.csv");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().at(0).key, "im y?");
  }
}

}  // namespace
}  // namespace hydrapod::test
