#pragma once
/// Machines with planted faults, and whether the diagnosis finds them.

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/binomial.hpp"
#include "support/calibration_machine.hpp"
#include "support/noisy_modes.hpp"
#include "support/round_trip.hpp"
#include "support/run_program.hpp"
#include "vibration_table.hpp"

namespace hydrapod::test {

struct BlindCase {
  /// File in models/, "vibration table", "starter" (what `hydrapod init` writes), or "random N".
  std::string machine{};
  std::vector<std::string> design{};   ///< overrides of the machine as its owner believes it to be
  std::vector<std::string> fault{};    ///< overrides on top: what is wrong with it
  std::vector<std::string> planted{};  ///< names of the causes; none: nothing is wrong
  std::vector<std::string> poses{"neutral"};
  double noise{1e-3};  ///< of frequencies; that of shapes is 30 times as large, at most 5 %
  dynamics::ModelKind kind{dynamics::ModelKind::guide};  ///< of the machine with the fault
  int repetition{};
  std::string size{};  ///< of what was planted, in words

  [[nodiscard]] std::string text() const {
    if (machine == "vibration table") return vibration_table;
    if (machine == "starter") return model::starter_machine_file();
    if (!machine.starts_with("random")) return read_text(source_file("models/" + machine));
    Random random(static_cast<std::uint64_t>(std::stoi(machine.substr(7))));
    return random_machine_text(random, true);
  }
  [[nodiscard]] std::string planted_name() const {
    std::string name;
    for (const auto& one : planted) name += (name.empty() ? "" : " and ") + one;
    return name.empty() ? "nothing" : name;
  }
};

struct BlindResult {
  diagnosis::Diagnosis diagnosis{};
  bool found{};              ///< first or alike; where nothing is wrong: nothing blamed
  bool first{};              ///< has the lowest BIC, alone or with others
  double parameter_error{};  ///< (recovered − true)/deviation of a single cause's first number
};

/// Hypotheses that change the same stiffness (oil and gimbals are springs in series) have one BIC
/// but for the rounding of their fits.
constexpr double rounding = 1e-3;

/// Modes "measured" on the machine with its fault: what a test of records replaces.
using Measure = std::function<observation::Targets(const BlindCase&, const model::MachineFile&)>;

inline observation::Targets by_noise(const BlindCase& test, const model::MachineFile& truth) {
  Random random(7919u * static_cast<std::uint64_t>(test.repetition) + 17u);
  return noisy_modes(truth.machine, test.poses, test.kind,
                     {.frequency = test.noise, .shape = std::min(0.05, 30.0 * test.noise)}, random);
}

inline BlindResult run_blind(const BlindCase& test, const Measure& measure = by_noise) {
  auto overrides = test.design;
  const auto design = machine_file(test.text(), overrides);
  overrides.insert(overrides.end(), test.fault.begin(), test.fault.end());
  const auto truth = machine_file(test.text(), overrides);
  const auto measured = measure(test, truth);
  BlindResult result{
      diagnosis::diagnose(design, measured, dynamics::ModelKind::guide, design.machine.poses)};
  const auto& d = result.diagnosis;
  if (test.planted.empty()) {
    result.found = d.finding == diagnosis::Finding::nothing_to_blame ||
                   d.finding == diagnosis::Finding::nominal;
    result.first = result.found;
    return result;
  }
  const auto is_planted = [&](const diagnosis::Hypothesis& e) {
    if (e.causes.size() != test.planted.size()) return false;
    return std::ranges::all_of(e.causes, [&](std::size_t k) {
      return std::ranges::count(test.planted, report::cause_name(d.causes[k])) == 1;
    });
  };
  for (const auto k : d.equivalent)
    if (is_planted(d.hypotheses[k])) {
      result.found = true;
      result.first =
          result.first || d.hypotheses[k].bic < d.hypotheses[d.equivalent.front()].bic + rounding;
    }
  return result;
}

/// The hypothesis of that name; null where it was not tried.
inline const diagnosis::Hypothesis* find(const diagnosis::Diagnosis& d, const std::string& name) {
  const auto found = std::ranges::find(
      d.hypotheses, name, [&](const auto& e) { return report::hypothesis_name(d, e); });
  return found == d.hypotheses.end() ? nullptr : &*found;
}

/// Of the hypotheses that explain the measurement equally well.
inline std::vector<std::string> names_of(const diagnosis::Diagnosis& d) {
  std::vector<std::string> names;
  for (const auto k : d.equivalent) names.push_back(report::hypothesis_name(d, d.hypotheses[k]));
  return names;
}

/// What is written of a diagnosis is read.
inline void expect_round_trip_of(const diagnosis::CaseFile& file) {
  expect_round_trip(report::diagnosis_json(file), report::diagnosis_from_json,
                    report::diagnosis_json);
}

/// What the table shows of a result.
inline std::string verdict(const diagnosis::Diagnosis& d) {
  std::string text = report::finding_word(d.finding);
  if (d.finding == diagnosis::Finding::identified || d.finding == diagnosis::Finding::undecided) {
    text.clear();
    for (const auto k : d.equivalent)
      text += (text.empty() ? "" : "; or ") + report::hypothesis_name(d, d.hypotheses[k]);
  }
  return text;
}

/// "alone": the planted fault is the one that is identified. Several that explain the data equally
/// well are a tie, and no success, though the planted fault be among them.
inline std::string outcome(const BlindCase& test, const BlindResult& result) {
  if (!result.found) return "MISSED";
  const auto count = result.diagnosis.equivalent.size();
  if (test.planted.empty() || count == 1) return "alone";
  return fmt::format("tie of {}{}", count, result.first ? ", first" : "");
}

/// What a series comes to.
struct Tally {
  int faults{}, alone{}, ties{}, sound{}, wrong{};
  void add(const BlindCase& test, const BlindResult& result) {
    if (test.planted.empty()) {
      ++sound;
      wrong += !result.found;
      return;
    }
    ++faults;
    const bool one = result.diagnosis.equivalent.size() == 1;
    alone += result.found && one;
    ties += result.found && !one;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "\nidentified alone: {}\nin a tie with others: {}\nmissed: {}\n"
        "a cause named in machines without fault: {}\n",
        rate_text(alone, faults), rate_text(ties, faults), rate_text(faults - alone - ties, faults),
        rate_text(wrong, sound));
  }
};

}  // namespace hydrapod::test
