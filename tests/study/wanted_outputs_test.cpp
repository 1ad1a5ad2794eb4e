/// Studies of some outputs alone: their numbers are those of studies of all outputs, bit for bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/study/study.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::study {
namespace {

using dynamics::ModelKind;
using testing::ElementsAre;
using testing::IsEmpty;
using Names = std::vector<std::string>;

model::MachineFile file_of(const std::string& name, const std::string& gravity) {
  return model::read_machine_file(
      test::source_file("models/" + name).string(),
      {"environment.gravity=" + gravity, "legs.piston_ring.stiffness=2.1e7"},
      kinematics::check_machine);
}

/// Some common to all legs, so that symmetric machines stay symmetric, or one for each leg.
std::vector<Input> scatter(const model::MachineFile& file, const std::string& stiffness) {
  auto inputs = read_variation(file, "legs.guide_sleeve.stiffness", stiffness, "");
  for (auto& one : read_variation(file, "platform.mass", "uniform ± 7 %", ""))
    inputs.push_back(std::move(one));
  return inputs;
}

std::vector<Names> rows_by_name(const Problem& problem,
                                const std::vector<std::vector<double>>& rows, Names& names) {
  names.clear();
  for (const auto& column : problem.outputs) names.push_back(column.name);
  const auto batch = problem.batch();
  std::vector<std::vector<double>> outputs(rows.size(), std::vector<double>(names.size()));
  std::vector<Row> asked;
  for (std::size_t k = 0; k < rows.size(); ++k) asked.push_back({rows[k], outputs[k]});
  batch(asked);
  std::vector<Names> bits;  // as text: NaN are equal to themselves
  for (const auto& row : outputs) {
    auto& texts = bits.emplace_back();
    for (const double number : row) {
      std::string text(sizeof number, '\0');
      std::memcpy(text.data(), &number, sizeof number);
      texts.push_back(std::isnan(number) ? "missing" : text);
    }
  }
  return bits;
}

struct Case {
  const char* file;
  const char* gravity;
  ModelKind kind;
  const char* stiffness;
  Names only;
};

class WantedOutputs : public testing::TestWithParam<Case> {};

TEST_P(WantedOutputs, AreThoseOfAllOutputs) {
  const auto& [file, gravity, kind, stiffness, only] = GetParam();
  const auto machine = file_of(file, gravity);
  const auto inputs = scatter(machine, stiffness);
  MachineOptions options{.kind = kind, .X_BP = machine.machine.neutral(), .modes = 5};
  const auto whole = machine_problem(machine.machine, inputs, options);
  options.only = only;
  const auto some = machine_problem(machine.machine, inputs, options);

  test::Random random(20261201);
  std::vector<std::vector<double>> rows;
  for (int k = 0; k < 37; ++k) {
    auto& row = rows.emplace_back();
    for (const auto& input : inputs)
      row.push_back(quantile(input.distribution, random.uniform(0.01, 0.99)));
  }
  rows[11][0] = -1.0;  // not allowed
  Names of_whole, of_some;
  const auto all = rows_by_name(whole, rows, of_whole), few = rows_by_name(some, rows, of_some);
  Names expected{"status"};
  for (const auto& name : of_whole)
    if (std::ranges::count(only, name) > 0) expected.push_back(name);
  ASSERT_EQ(of_some, expected);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t c = 0; c < of_some.size(); ++c) {
      const auto from = std::ranges::find(of_whole, of_some[c]) - of_whole.begin();
      EXPECT_EQ(few[k][c], all[k][static_cast<std::size_t>(from)]) << of_some[c] << ", row " << k;
    }
}

constexpr const char* common = "uniform ± 23 %";
constexpr const char* per_leg = "uniform ± 23 % per leg";
const Names frequencies{"lowest", "direction", "x", "y", "z", "rx", "ry", "rz"};

INSTANTIATE_TEST_SUITE_P(
    All, WantedOutputs,
    testing::Values(
        Case{"zhang-jiang-2021.toml", "0", ModelKind::guide, common, frequencies},
        Case{"zhang-jiang-2021.toml", "0", ModelKind::guide, per_leg, frequencies},
        Case{"zhang-jiang-2021-transverse.toml", "9.81", ModelKind::guide, per_leg, frequencies},
        Case{"heavy-platform.toml", "9.81", ModelKind::guide, common, frequencies},
        Case{"heavy-platform.toml", "9.81", ModelKind::full, per_leg, {"mac", "mode2", "stroke"}},
        Case{"heavy-platform.toml", "0", ModelKind::guide, per_leg, {"x", "drop_x"}},
        Case{"heavy-platform.toml", "0", ModelKind::rigid, per_leg, {"lowest", "condition"}},
        Case{"heavy-platform.toml", "0", ModelKind::guide, per_leg, {}}));

TEST(Words, StandForWhatIsSaidTogether) {
  std::vector<Column> columns;
  for (const char* name :
       {"status", "lowest", "direction", "drop", "share", "peak", "x", "rx", "drop_x", "drop_rx",
        "share_x", "share_rx", "peak_x", "peak_rx", "condition", "mac", "mode1", "mode2", "sag"})
    columns.push_back({.name = name});
  const auto of = [&](const char* word) { return columns_of_word(columns, word); };
  EXPECT_THAT(of("frequencies"), ElementsAre("lowest", "direction", "x", "rx"));
  EXPECT_THAT(of("modes"), ElementsAre("mac", "mode1", "mode2"));
  EXPECT_THAT(of("drops"), ElementsAre("lowest", "drop", "share", "peak", "x", "rx", "drop_x",
                                       "drop_rx", "share_x", "share_rx", "peak_x", "peak_rx"));
  EXPECT_THAT(of("x"), ElementsAre("x"));
  EXPECT_THAT(of("direction"), ElementsAre("lowest", "direction"));
  EXPECT_THAT(of("drop"), ElementsAre("lowest", "drop", "share", "peak"));
  EXPECT_THAT(of("peak_rx"), ElementsAre("rx", "drop_rx", "share_rx", "peak_rx"));
  EXPECT_THAT(of("mode2"), ElementsAre("mac", "mode2"));
  EXPECT_THAT(of("mac"), ElementsAre("mac"));
  EXPECT_THAT(of("sag"), ElementsAre("sag"));
  for (const char* unknown : {"mode3", "drop_q", "drop_y", "", "frequency", "dropx"})
    EXPECT_THAT(of(unknown), IsEmpty()) << unknown;
}

}  // namespace
}  // namespace hydrapod::study
