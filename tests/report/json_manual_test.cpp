/// The manual of the JSON names every field that the program writes.

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "hydrapod/report/bode.hpp"
#include "hydrapod/report/check.hpp"
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

/// Field names of all that can be printed, complex shapes and strokes included.
std::set<std::string> all_names() {
  auto machine = symmetric_machine(9.81);
  machine.legs[0].guide_sleeve.damping = 50.0;
  for (auto& leg : machine.legs) leg.stroke = model::Stroke{0.3, 0.3};
  const report::PoseChoice pose{"neutral", machine.neutral()};
  const auto bode = report::bode(machine, pose, dynamics::ModelKind::guide, {.points = 3});
  std::set<std::string> names{"kind", "poses"};
  add_names(report::machine_json({.machine = machine}, "m.toml"), names);
  add_names(report::assumptions_json(machine), names);
  add_names(report::modes_json(bode.table), names);
  add_names({{"matrices", report::matrices_json(bode.table)}}, names);
  add_names(report::bode_json(bode), names);
  add_names(report::check_json(report::check(machine, pose, dynamics::ModelKind::guide)), names);
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
