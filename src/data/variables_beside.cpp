#include "variables_beside.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "axis_units.hpp"
#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::data {

namespace {

constexpr std::array<std::string_view, 10> time_words{
    "t", "time", "times", "zeit", "tout", "x_time", "time_s", "timestamp", "tvec", "time_vector"};
constexpr std::array<std::string_view, 14> rate_words{"fs",
                                                      "sample_rate",
                                                      "samplerate",
                                                      "sample_rate_hz",
                                                      "sampling_rate",
                                                      "samplingrate",
                                                      "srate",
                                                      "rate",
                                                      "f_s",
                                                      "fsample",
                                                      "sfreq",
                                                      "samplingfrequency",
                                                      "sampling_frequency",
                                                      "samplefrequency"};
constexpr std::array<std::string_view, 10> step_words{
    "dt",      "ts",     "t_s",         "step",       "increment",
    "delta_t", "deltat", "sample_time", "sampletime", "sampling_interval"};
constexpr std::array<std::string_view, 4> start_words{"start_value", "x_start", "t0", "start_time"};
/// What analysers put beside the samples of a channel, by the ending of the samples' name: "Signal"
/// of Simcenter Testlab has its samples in Signal.y_values.values and their unit in
/// Signal.y_values.quantity.label, "Channel_1" of PULSE in Channel_1_Data and
/// Channel_1_Header.Unit.
struct Companions {
  std::string_view samples;
  std::array<std::string_view, 3> names;
  std::array<std::string_view, 3> units;
};
constexpr std::array companions{
    Companions{".y_values.values",
               {".function_record.name", ".name", ".label"},
               {".y_values.quantity.label", ".y_values.unit", ".unit"}},
    Companions{"_data",
               {"_header.signalname", "_header.title", "_name"},
               {"_header.unit", "_unit", "_units"}},
    Companions{".data", {".name", ".label", ".title"}, {".unit", ".units", ".y_unit"}},
    Companions{".values", {".name", ".label", ".title"}, {".unit", ".units", ".y_unit"}},
    Companions{".y", {".name", ".label", ".title"}, {".unit", ".units", ".y_unit"}},
    Companions{"_values", {"_items", "_names", "_name"}, {"_units", "_unit", "_unit"}}};

/// Endings of what stands beside samples and states their sampling.
constexpr std::array<std::string_view, 3> sampling_groups{".x_values", "_header", ".x"};

constexpr double no_rate = std::numeric_limits<double>::quiet_NaN();

/// Does a variable with this name state something of `samples`?
bool is_beside(const std::string& name, const std::vector<std::string>& samples) {
  const std::size_t at = name.find_last_of("/.");
  if (at == name.npos) return true;
  std::string group = base::lower_case(name.substr(0, at));
  for (const std::string_view ending : sampling_groups)
    if (group.ends_with(ending)) group.resize(group.size() - ending.size());
  return std::ranges::any_of(samples, [&](const std::string& sample) {
    return base::lower_case(sample).starts_with(group);
  });
}

/// The texts called `stem` and one of `endings`: a list of `count`, or one text.
std::vector<std::string> texts_called(const std::vector<Variable>& variables,
                                      const std::string& stem,
                                      std::span<const std::string_view> endings,
                                      std::size_t count) {
  for (const std::string_view ending : endings)
    for (const Variable& v : variables) {
      if (base::lower_case(v.name) != stem + std::string(ending)) continue;
      if (v.kind == VariableKind::text) return std::vector<std::string>(count, v.text);
      if (v.kind == VariableKind::texts && v.texts.size() == count) return v.texts;
    }
  return {};
}

/// By an attribute, by its name, or by the label of its axis (Simcenter Testlab).
bool has_unit(const Variable& v, const std::vector<Variable>& variables) {
  if (!base::trimmed(v.unit).empty() || base::lower_case(v.name).ends_with("_hz")) return true;
  const std::size_t at = v.name.find_last_of("/.");
  if (at == std::string::npos) return false;
  const std::string label = base::lower_case(v.name.substr(0, at)) + ".quantity.label";
  return std::ranges::any_of(variables, [&](const Variable& other) {
    return other.kind == VariableKind::text && !other.text.empty() &&
           base::lower_case(other.name) == label;
  });
}

}  // namespace

bool is_one_of(std::span<const std::string_view> words, const std::string& name) {
  const std::size_t at = name.find_last_of("/.");
  const std::string last = base::lower_case(at == name.npos ? name : name.substr(at + 1));
  return std::ranges::find(words, last) != words.end();
}

bool is_time_variable(const std::string& name) { return is_one_of(time_words, name); }
bool are_times(const Variable& v) {
  return v.kind == VariableKind::numbers && !v.is_complex && is_time_variable(v.name) &&
         std::min(v.fast, v.slow) == 1 && std::max(v.fast, v.slow) > 1;
}

bool read_list(VariableFile& file, std::size_t variable, std::uint64_t first,
               std::span<double> out) {
  const bool lies = file.variables()[variable].slow == 1;
  const std::uint64_t n = out.size();
  return file.read(variable, lies ? 0 : first, lies ? 1 : n, lies ? first : 0, lies ? n : 1,
                   out.data());
}

bool is_start_name(const std::string& name) { return is_one_of(start_words, name); }

std::vector<RateVariable> rates_beside(const std::vector<Variable>& variables,
                                       const std::vector<std::string>& samples, bool needed,
                                       Notes& notes) {
  std::vector<RateVariable> beside, others, of_else;
  const auto take = [&](const RateVariable& rate) {
    auto& list = is_beside(rate.name, samples) ? beside : others;
    (std::isnan(rate.hertz) ? of_else : list).push_back(rate);
  };
  for (const Variable& v : variables) {
    if (v.kind != VariableKind::numbers || v.fast * v.slow != 1) continue;
    if (!std::isfinite(v.number) || v.number <= 0.0) continue;
    constexpr double near = 1e-9;  // 1/0.01 is 100
    if (is_one_of(rate_words, v.name))
      take({v.number * rate_of(v.unit).value_or(no_rate), v.name, v.unit, "Hz, kHz", false,
            has_unit(v, variables)});
    if (is_one_of(step_words, v.name)) {
      const double step = v.number * seconds_of(v.unit).value_or(no_rate);
      take({rounded_rate(1.0 / step, near), v.name, v.unit, "s, ms", true, has_unit(v, variables)});
    }
  }
  auto& chosen = beside.empty() ? others : beside;
  for (const RateVariable& rate : of_else) {
    const auto said = fmt::format("'{}' states the sampling in the unit \"{}\"",
                                  base::printable(rate.name), base::printable(rate.unit, 30));
    if (needed && chosen.empty()) notes.fail(said + "; accepted are " + rate.accepted);
    notes.add(said + ": left aside");
  }
  return std::move(chosen);
}

ChannelTexts texts_beside(const std::vector<Variable>& variables, const std::string& samples,
                          std::size_t channels) {
  const std::string name = base::lower_case(samples);
  const auto known = std::ranges::find_if(
      companions, [&](const Companions& c) { return name.ends_with(c.samples); });
  if (known == companions.end()) return {};
  const std::string stem = name.substr(0, name.size() - known->samples.size());
  return {texts_called(variables, stem, known->names, channels),
          texts_called(variables, stem, known->units, channels)};
}

void require_time_axes(const std::vector<Variable>& variables, const Notes& notes) {
  for (const Variable& v : variables) {
    const std::string name = base::lower_case(v.name);
    if (v.kind != VariableKind::text || !name.ends_with(".x_values.quantity.label")) continue;
    if (v.text.empty() || channel_unit(v.text).unit == "s") continue;
    notes.fail(
        fmt::format("{} is \"{}\": these are no samples over time. Frequency responses are "
                    "read from Universal Files, tables of text, and arrays beside a list of "
                    "frequencies",
                    base::printable(v.name), base::printable(v.text)));
  }
}

namespace {

std::string_view part_of(const Variable& v) {
  const auto at = v.name.find_last_of("/.");
  return at == v.name.npos ? std::string_view() : std::string_view(v.name).substr(0, at);
}

/// The first times and the last ones [s]: another rate, and another start, show in them.
std::vector<double> ends_of(VariableFile& file, std::size_t variable) {
  constexpr std::uint64_t most = 1024;
  const Variable& v = file.variables()[variable];
  const std::uint64_t length = std::max(v.fast, v.slow), n = std::min(most, length);
  std::vector<double> ends(2 * n);
  if (!read_list(file, variable, 0, std::span(ends).first(n)) ||
      !read_list(file, variable, length - n, std::span(ends).last(n)))
    return {};
  for (double& time : ends) time *= seconds_of(v.unit).value_or(1.0);
  return ends;
}

/// Numbers of times have many digits, but not all.
bool differ(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double digits = 1e-6;
  double span = 0.0, most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    span = std::max(span, std::abs(a[k] - a[0]));
    most = std::max(most, std::abs(a[k] - b[k]));
  }
  return most > digits * span;
}

}  // namespace

void require_one_record(VariableFile& file, const Notes& notes) {
  const auto& all = file.variables();
  constexpr auto advice = "these are several records; write one file for each";
  std::optional<std::size_t> first, start;
  std::vector<double> ends;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Variable& v = all[k];
    if (v.kind == VariableKind::numbers && v.fast * v.slow == 1 && std::isfinite(v.number) &&
        is_start_name(v.name)) {
      const auto in_seconds = [](const Variable& one) {
        return one.number * seconds_of(one.unit).value_or(1.0);
      };
      if (start && part_of(all[*start]) != part_of(v) && in_seconds(all[*start]) != in_seconds(v))
        notes.fail(fmt::format("'{}' is {:.9g} s and '{}' is {:.9g} s: {}",
                               base::printable(all[*start].name), in_seconds(all[*start]),
                               base::printable(v.name), in_seconds(v), advice));
      if (!start) start = k;
    }
    if (!are_times(v)) continue;
    if (!first) {
      first = k;
      ends = ends_of(file, k);
      continue;
    }
    const Variable& one = all[*first];
    if (part_of(one) == part_of(v) || std::max(v.fast, v.slow) != std::max(one.fast, one.slow))
      continue;
    const auto others = ends_of(file, k);
    if (others.size() == ends.size() && differ(ends, others))
      notes.fail(fmt::format("the times '{}' are not those of '{}': {}", base::printable(v.name),
                             base::printable(one.name), advice));
  }
}

}  // namespace hydrapod::data
