#include <fmt/format.h>

#include "fields.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
constexpr double percent_unit = 0.01;
constexpr std::array thing_words{"machine", "modes", "record"};
constexpr std::array verdict_words{"cannot_say", "not_significant", "significant", "calculated"};

}  // namespace

template <class Fields>
void describe(Fields& f, ComparedThing::Mode& mode) {
  f("omega_rad_s", mode.omega);
  f.derived("frequency_hz", mode.omega / two_pi);
  f("damping_ratio", mode.damping_ratio);
  f("omega_deviation_rad_s", mode.omega_deviation);
  f("damping_deviation", mode.damping_deviation);
  f("label", mode.label);
}

template <class Fields>
void describe(Fields& f, ComparedThing::Response& response) {
  f("name", response.name);
  f("unit", response.unit);
  f("frequency_hz", response.frequency);
  std::vector<double> re, im;
  if constexpr (!Fields::reads)
    for (const auto& value : response.H) {
      re.push_back(value.real());
      im.push_back(value.imag());
    }
  f("re", re);
  f("im", im);
  if constexpr (Fields::reads) {
    if (re.size() != response.frequency.size() || im.size() != re.size())
      f.bad("re", "expected as many numbers as frequency_hz and im have");
    for (std::size_t k = 0; k < re.size(); ++k) response.H.emplace_back(re[k], im[k]);
  }
}

template <class Fields>
void describe(Fields& f, ComparedThing& thing) {
  f.word("what", thing.kind, thing_words);
  f("name", thing.name);
  f("description", thing.description);
  f("modes", thing.modes);
  f("responses", thing.responses);
}

template <class Fields>
void describe(Fields& f, TestedDifference& d) {
  f("difference", d.value);
  f("deviation", d.deviation);
  f("p", d.p);
  f.word("verdict", d.verdict, verdict_words);
}

template <class Fields>
void describe(Fields& f, ThingComparison::Pair& pair) {
  f.counted("first", pair.first);
  f.counted("second", pair.second);
  f("mac", pair.mac);
  f("omega_rad_s", pair.frequency);
  f("damping_ratio", pair.damping);
}

template <class Fields>
void describe(Fields& f, ThingComparison& comparison) {
  f.counted("thing", comparison.thing);
  f("shapes", comparison.shapes);
  f("pairs", comparison.pairs);
  for (const auto& [key, list] : {std::pair{"first_left", &comparison.first_left},
                                  {"second_left", &comparison.second_left}}) {
    std::vector<int> numbers;
    if constexpr (!Fields::reads)
      for (const int k : *list) numbers.push_back(k + 1);
    f(key, numbers);
    if constexpr (Fields::reads)
      for (const int k : numbers) list->push_back(k - 1);
  }
}

template <class Fields>
void describe(Fields& f, SideBySide& result) {
  f.percent("level_percent", result.level);
  f.derived("test", test_text(result));
  f("things", result.things);
  f("comparisons", result.comparisons);
}

namespace {

/// The numbers of modes and things must be there: pictures and tables take them as indices.
void require_numbers(const SideBySide& result, const std::string& file) {
  const auto bad = [&](const std::string& key) {
    throw base::InputError({{.file = file, .key = key, .message = "there is no such number"}});
  };
  const auto count = [](const ComparedThing& thing) {
    return static_cast<int>(thing.modes.size());
  };
  if (result.things.empty() && !result.comparisons.empty()) bad("comparisons");
  for (const auto& c : result.comparisons) {
    if (c.thing < 1 || c.thing >= static_cast<int>(result.things.size())) bad("comparisons.thing");
    const int first = count(result.things.front()),
              second = count(result.things[static_cast<std::size_t>(c.thing)]);
    for (const auto& pair : c.pairs)
      if (pair.first >= first || pair.second >= second) bad("comparisons.pairs");
    for (const int k : c.first_left)
      if (k < 0 || k >= first) bad("comparisons.first_left");
    for (const int k : c.second_left)
      if (k < 0 || k >= second) bad("comparisons.second_left");
  }
}

std::string cell_of(const std::optional<double>& value, double unit = 1.0) {
  return value ? fmt::format("{:.17g}", *value / unit) : "";
}

std::string mode_cells(const ComparedThing::Mode& mode) {
  return fmt::format("{:.17g},{},{:.17g},{}", mode.omega / two_pi,
                     cell_of(mode.omega_deviation, two_pi), mode.damping_ratio,
                     cell_of(mode.damping_deviation));
}

}  // namespace

const char* name(TestedDifference::Verdict verdict) {
  return verdict_words.at(static_cast<std::size_t>(verdict));
}

std::string test_text(const SideBySide& result) {
  return fmt::format(
      "two-sided z test with the uncertainties of the measurements; {:.3g} % for all differences "
      "of "
      "one comparison together (Holm)",
      result.level / percent_unit);
}

Json side_by_side_json(const SideBySide& result) { return written(result); }

SideBySide side_by_side_from_json(const Json& json, const std::string& file) {
  auto result = read<SideBySide>(json, file);
  require_numbers(result, file);
  return result;
}

std::string side_by_side_csv(const SideBySide& result) {
  std::string text =
      "thing,mode_first,mode_second,frequency_first_hz,deviation_first_hz,damping_first,"
      "damping_deviation_first,frequency_second_hz,deviation_second_hz,damping_second,"
      "damping_deviation_second,mac,frequency_difference_hz,frequency_difference_deviation_hz,"
      "frequency_p,frequency_verdict,damping_difference,damping_difference_deviation,damping_p,"
      "damping_verdict\n";
  for (const auto& c : result.comparisons) {
    const auto& first = result.things.front().modes;
    const auto& thing = result.things[static_cast<std::size_t>(c.thing)];
    const auto name_cell = base::quoted_cell(thing.name);
    for (const auto& pair : c.pairs) {
      const auto &f = pair.frequency, &d = pair.damping;
      text += fmt::format(
          "{},{},{},{},{},{},{:.17g},{},{},{},{:.17g},{},{},{}\n", name_cell, pair.first + 1,
          pair.second + 1, mode_cells(first[static_cast<std::size_t>(pair.first)]),
          mode_cells(thing.modes[static_cast<std::size_t>(pair.second)]), cell_of(pair.mac),
          f.value / two_pi, cell_of(f.deviation, two_pi), cell_of(f.p), name(f.verdict), d.value,
          cell_of(d.deviation), cell_of(d.p), name(d.verdict));
    }
    for (const int k : c.first_left)
      text += fmt::format("{},{},,{},,,,,,,,,,,,,\n", name_cell, k + 1,
                          mode_cells(first[static_cast<std::size_t>(k)]));
    for (const int k : c.second_left)
      text += fmt::format("{},,{},,,,,{},,,,,,,,,\n", name_cell, k + 1,
                          mode_cells(thing.modes[static_cast<std::size_t>(k)]));
  }
  return text;
}

}  // namespace hydrapod::report
