/// The manual of the JSON names every field that the program writes.

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "exact/modal_system.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "support/run_program.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using report::Json;

void add_names(const Json& json, std::set<std::string>& names) {
  if (json.is_array()) {
    for (const auto& item : json) add_names(item, names);
  } else if (json.is_object()) {
    for (const auto& [name, value] : json.items()) {
      names.insert(name);
      add_names(value, names);
    }
  }
}

/// Those of `frf` and `identified_modes`: of a chain of three masses, beside a machine.
void add_identification_names(std::set<std::string>& names) {
  const auto record = record_of(
      chain(3, 1.13, 1733.0, 0.021),
      {.sample_rate = 50.0, .samples = 1 << 14, .output_noise = Eigen::Vector3d::Constant(1e-3)});
  identification::SpectrumEstimator estimator(record.header, {.block_length = 512});
  estimator.add(record.samples);
  const auto responses = identification::estimate_responses(
      estimator.result(), {.inputs = {0, 1, 2}, .outputs = {3, 4, 5}, .instruments = {}},
      identification::Estimator::h1);
  const auto found = identification::identify_modes(responses);
  ASSERT_EQ(found.modes.size(), 3U);
  auto machine = symmetric_machine(0.0);
  const auto compared =
      report::compared_with(found, {machine, machine.neutral(), spatial::Vector3::Zero()},
                            dynamics::ModelKind::rigid, observation::Observed::mechanics);
  Json json = report::identification_json(found);
  report::add_cross_checks(identification::cross_check(found, responses), json);
  report::add_bootstrap({Eigen::Vector3d::Ones(), Eigen::Vector3d::Ones(), 2, 4}, json);
  add_names(json, names);
  add_names({{"comparison", report::comparison_json(compared, found)}}, names);
  add_names(report::responses_json(responses), names);
  add_names({{"record", report::record_origin_json(record.header)}}, names);
  const Json section = report::identification_section(found, compared, {});
  for (const auto& [name, value] : section.items()) names.insert(name);
  add_names(section["responses"], names);
}

/// Field names of all that can be printed, complex shapes and strokes included.
std::set<std::string> all_names() {
  auto machine = symmetric_machine(9.81);
  machine.legs[0].guide_sleeve.damping = 50.0;
  for (auto& leg : machine.legs) leg.stroke = model::Stroke{0.3, 0.3};
  const tasks::Machine subject{.file = {.machine = machine},
                               .path = "m.toml",
                               .pose = {"neutral", machine.neutral()},
                               .kind = dynamics::ModelKind::guide};
  const auto bode = tasks::bode(subject, {.points = 3});
  std::set<std::string> names{"kind", "poses"};
  add_names(report::head_json("modes", subject), names);
  add_names(report::modes_json(bode.table), names);
  add_names({{"matrices", report::matrices_json(bode.table)}}, names);
  add_names(report::bode_json(bode), names);
  add_names(report::check_json(tasks::check(subject), machine), names);
  add_names(report::serve_json({.lateness = {.bins = {{1e-6, 3}}}}), names);
  add_identification_names(names);
  return names;
}

TEST(JsonManual, NamesEveryField) {
  const std::string manual = read_text(source_file("docs/howto/json.md"));
  const std::set<std::string> directions{"x", "y", "z", "rx", "ry", "rz"};
  const auto names = all_names();
  EXPECT_GT(names.size(), 50U);
  for (const std::string& name : names) {
    if (directions.contains(name)) continue;
    const bool named = manual.find('`' + name + '`') != std::string::npos ||
                       manual.find('`' + name + "[]`") != std::string::npos;
    EXPECT_TRUE(named) << name;
  }
}

}  // namespace
}  // namespace hydrapod::test
