/// What one task writes every task that can use it reads. What a task cannot use it refuses, and
/// says what it would accept.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/base/file.hpp"
#include "hydrapod/hydrapod.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/round_trip.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using report::Json;

/// Every producer once, on a record of the heavy platform.
struct Exchange {
  static void make() {
    folder = std::make_unique<TemporaryFolder>();
    machine = tasks::read_machine({.file = source_file("models/heavy-platform.toml").string()});
    const signals::Signal white{.size = spatial::Vector6::Constant(2e-4), .form = signals::White{}};
    tasks::rig(machine, {.test = {.signals = {white}, .duration = 100.0, .seed = 31},
                         .record = path("run.h5")});
    tasks::simulate(machine, {.until = 0.02, .record = path("simulated.h5")});
    found = tasks::identify({.measure = {.files = {path("run.h5")}}, .cross_check = true});
    ASSERT_FALSE(found.modes.modes.empty());
    write_measurement();
    write_json("modes.json", "modes", report::modes_json(tasks::modes(machine)));
    write_json("bode.json", "bode", report::bode_json(tasks::bode(machine, {.points = 20})));
    write_json("system.json", "system", report::system_json(tasks::system(machine)));
    write_json("check.json", "check",
               report::check_json(tasks::check(machine), machine.file.machine));
    calibrated =
        tasks::calibrate(machine, {.targets = path("modes.json"),
                                   .plan = {.free = {{.paths = {"legs.guide_sleeve.stiffness"}}}},
                                   .starts = 1});
    write_json("calibration.json", "calibration",
               report::calibration_json(calibrated.result, calibrated.targets));
    base::write_file_whole(
        path("calibrated.toml"),
        calibration::calibrated_text(machine.file, calibrated.result.best(), calibrated.targets));
  }

  static void write_measurement() {
    const auto responses = tasks::shared_responses(found.measured);
    Json frf{{"kind", "frf"}, {"record", report::record_origin_json(*found.measured.header)}};
    frf.update(report::responses_json(responses));
    base::write_file_whole(path("frf.json"), frf.dump());
    data::write_frequency_responses(path("frf.uff"), responses);
    base::write_file_whole(path("frf.csv"), data::response_table(responses));
    Json modes{{"kind", "identified_modes"},
               {"record", report::record_origin_json(*found.measured.header)}};
    modes.update(report::identification_json(found.modes));
    base::write_file_whole(path("identified.json"), modes.dump());
    base::write_file_whole(
        path("identified.csv"),
        report::identified_modes_csv(found.modes, tasks::observed_in(found.measured),
                                     found.measured.experiment()));
    report::write_modes_uff(path("identified.uff"), found.modes, "modes", "");
    report::write_modes_mat(path("identified.mat"), found.modes);
  }

  static void write_json(const std::string& name, const char* kind, const Json& result) {
    auto json = report::head_json(kind, machine);
    json.update(result);
    base::write_file_whole(path(name), json.dump());
  }

  static std::string path(const std::string& name) { return *folder / name; }

  static void every_reader_takes_what_it_can_use();
  static void files_of_one_measurement_give_the_same_targets();
  static void calibration_to_its_own_modes_changes_nothing();
  static void round_trip_of_a_calibration();
  static void round_trip_of_responses();
  static void round_trip_of_identified_modes();
  static void round_trip_of_a_simulation();

  static inline std::unique_ptr<TemporaryFolder> folder;
  static inline tasks::Machine machine;
  static inline tasks::Identified found;
  static inline tasks::Calibrated calibrated;
};

/// "read", or how it is refused.
template <class Use>
std::string outcome(const Use& use) {
  try {
    use();
  } catch (const base::InputError& error) {
    return error.what();
  } catch (const base::ComputationError& error) {
    return std::string("computation: ") + error.what();
  }
  return "read";
}

void Exchange::every_reader_takes_what_it_can_use() {
  struct Row {
    const char* file;
    const char* responses;  ///< of identify, frf, report --measured; a part of the outcome
    const char* targets;    ///< of diagnose --measured, report --diagnose, calibrate --targets
    const char* machine;
  };
  const std::vector<Row> table{
      {"run.h5", "read", "read", "run.h5"},
      {"frf.json", "read", "read", "frf.json"},
      {"frf.uff", "read", "read", "frf.uff"},
      {"frf.csv", "read", "read", "frf.csv"},
      {"identified.json", "is \"identified_modes\"; accepted here are \"frf\"", "read",
       "identified.json"},
      {"identified.csv", "holds a table of frequencies", "read", "identified.csv"},
      {"identified.uff", "holds modes (dataset 55 or 2414)", "holds modes (dataset 55 or 2414)",
       "identified.uff"},
      {"identified.mat", "read", "read", "identified.mat"},
      {"modes.json", "is \"modes\"; accepted here are \"frf\"", "read", "modes.json"},
      {"bode.json", "is \"bode\"; accepted here are \"frf\"",
       "is \"bode\"; accepted here are \"identified_modes\", \"modes\", \"frf\"", "bode.json"},
      {"system.json", "is \"system\"", "is \"system\"", "system.json"},
      {"check.json", "is \"check\"", "is \"check\"", "check.json"},
      {"calibration.json", "is \"calibration\"", "is \"calibration\"", "calibration.json"},
      {"calibrated.toml", "holds no measurement", "calibrated.toml", "read"}};
  for (const auto& row : table) {
    SCOPED_TRACE(row.file);
    const auto file = path(row.file);
    EXPECT_THAT(outcome([&] { tasks::frf({.files = {file}}); }), testing::HasSubstr(row.responses));
    EXPECT_THAT(
        outcome([&] {
          EXPECT_FALSE(tasks::read_measured(machine, {.files = {file}}).targets.modes.empty());
        }),
        testing::HasSubstr(row.targets));
    EXPECT_THAT(outcome([&] { tasks::read_machine({.file = file}); }),
                testing::HasSubstr(row.machine));
  }
}

/// The way does not matter: a record, its responses and its modes give the same targets.
void Exchange::files_of_one_measurement_give_the_same_targets() {
  const auto of = [&](const char* file) {
    return tasks::read_measured(machine, {.files = {path(file)}}).targets;
  };
  const auto record = of("run.h5");
  EXPECT_EQ(record.observed, observation::Observed::plant);
  for (const char* file : {"frf.json", "identified.json", "identified.csv"}) {
    SCOPED_TRACE(file);
    const auto targets = of(file);
    EXPECT_EQ(targets.observed, record.observed);
    ASSERT_EQ(targets.modes.size(), record.modes.size());
    for (std::size_t k = 0; k < record.modes.size(); ++k) {
      EXPECT_NEAR(targets.modes[k].omega, record.modes[k].omega, 1e-9 * record.modes[k].omega);
      EXPECT_NEAR(targets.modes[k].deviation, record.modes[k].deviation,
                  1e-4 * record.modes[k].deviation);
      EXPECT_EQ(targets.modes[k].direction, record.modes[k].direction);
      EXPECT_EQ(targets.modes[k].shape_against, record.modes[k].shape_against);
      EXPECT_EQ(targets.modes[k].shape.has_value(), record.modes[k].shape.has_value());
    }
  }
}

void Exchange::calibration_to_its_own_modes_changes_nothing() {
  const auto& best = calibrated.result.best();
  EXPECT_NEAR(best.parameters.at(0).value, best.parameters.at(0).start,
              1e-3 * best.parameters.at(0).start);
}

void Exchange::round_trip_of_a_calibration() {
  expect_round_trip(report::calibration_json(calibrated.result, calibrated.targets),
                    report::calibration_from_json, [](const report::ReadCalibration& read) {
                      return report::calibration_json(read.result, read.targets);
                    });
}

void Exchange::round_trip_of_responses() {
  auto responses = tasks::shared_responses(found.measured);
  // what tells how good the measurement is follows from the record alone
  responses.coherence.clear();
  responses.multiple_coherence.clear();
  responses.warnings = {{.kind = data::ResponseWarning::Kind::clipped,
                         .channel = "a 1",
                         .share = 0.013,
                         .lowest = -4.7,
                         .highest = 5.1},
                        {.kind = data::ResponseWarning::Kind::biased,
                         .channel = "drive 2",
                         .value = 0.21,
                         .share = 0.37,
                         .estimator = data::Estimator::h2}};
  expect_round_trip(report::responses_json(responses), report::responses_from_json,
                    report::responses_json);
}

/// Of what is read: modes, heavily damped and rejected poles, warnings, channels.
void Exchange::round_trip_of_identified_modes() {
  using identification::ModeWarning;
  auto written = found.modes;
  written.left_out.push_back({{-0.31, 27.4}, identification::Objection::open_damping});
  written.warnings = {{.kind = ModeWarning::Kind::few_samples, .value = 5.3},
                      {.kind = ModeWarning::Kind::no_mode, .from = 1.7, .to = 23.0}};
  written.responses.warnings = {
      {.kind = data::ResponseWarning::Kind::single_block, .share = 0.17, .count = 2, .total = 7}};
  written.needed_duration = 412.75;
  const auto expected = report::identification_json(written);
  ASSERT_EQ(expected["findings"].size(), 3U);
  EXPECT_EQ(expected["findings"][0]["kind"], "single_block");
  EXPECT_EQ(expected["findings"][1]["kind"], "few_samples");
  EXPECT_EQ(expected["warnings"][0], report::warning_text(written.responses.warnings[0]));
  const auto read = report::identification_from_json(Json::parse(expected.dump()), "modes.json");
  ASSERT_EQ(read.modes.size(), found.modes.modes.size());
  for (std::size_t k = 0; k < read.modes.size(); ++k) {
    const auto& mode = read.modes[k];
    const auto& original = found.modes.modes[k];
    EXPECT_EQ(mode.fit.pole, original.fit.pole);
    EXPECT_EQ(mode.displacement, original.displacement);
    EXPECT_EQ(mode.fit.shape_deviation, original.fit.shape_deviation);
    EXPECT_DOUBLE_EQ(mode.fit.omega_deviation, original.fit.omega_deviation);
    EXPECT_DOUBLE_EQ(mode.fit.damping_deviation, original.fit.damping_deviation);
  }
  EXPECT_EQ(read.responses.outputs.size(), found.modes.responses.outputs.size());
  EXPECT_EQ(read.heavily_damped.size(), found.modes.heavily_damped.size());
  ASSERT_EQ(read.responses.warnings.size(), 1U);
  EXPECT_EQ(read.warnings.size(), 2U);
  EXPECT_EQ(read.needed_duration, 412.75);
  const auto again = report::identification_json(read);
  for (const char* key : {"rejected", "warnings", "findings"})
    expect_same_json(again[key], expected[key], key);
}

void Exchange::round_trip_of_a_simulation() {
  const auto run = tasks::simulate(machine, {.commands = {"step z=1 mm, at=0.01"}, .until = 0.1});
  expect_round_trip(report::simulation_json(run), report::simulation_from_json,
                    report::simulation_json);
}

/// One test, so that the record is made once.
TEST(Exchange, WhatOneTaskWritesTheOthersRead) {
  Exchange::make();
  if (HasFatalFailure()) return;
  Exchange::every_reader_takes_what_it_can_use();
  Exchange::files_of_one_measurement_give_the_same_targets();
  Exchange::calibration_to_its_own_modes_changes_nothing();
  Exchange::round_trip_of_a_calibration();
  Exchange::round_trip_of_responses();
  Exchange::round_trip_of_identified_modes();
  Exchange::round_trip_of_a_simulation();
  Exchange::folder.reset();
}

}  // namespace
}  // namespace hydrapod::test
