#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace hydrapod::report {

namespace {

using Eigen::Index;
using identification::FrequencyResponses;

constexpr std::size_t most_lines = 1000;
constexpr double confidence = 0.95;

/// To seven digits: what a picture needs, at half the size.
Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);
}

template <class Number>
Json list_of(const std::vector<std::size_t>& lines, const Number& number) {
  Json list = Json::array();
  for (const std::size_t k : lines) list.push_back(rounded(number(k)));
  return list;
}

/// Every line, or every second, … so that few enough are left.
std::vector<std::size_t> shown_lines(std::size_t count) {
  const std::size_t every = (count + most_lines - 1) / most_lines;
  std::vector<std::size_t> lines;
  for (std::size_t k = 0; k < count; k += every) lines.push_back(k);
  return lines;
}

Json entry_json(const FrequencyResponses& r, const std::vector<std::size_t>& lines, Index o,
                Index i) {
  Json entry{{"re", list_of(lines, [&](auto k) { return r.H[k](o, i).real(); })},
             {"im", list_of(lines, [&](auto k) { return r.H[k](o, i).imag(); })}};
  if (r.has_errors())
    entry["deviation"] = list_of(lines, [&](auto k) { return std::sqrt(r.variance(k, o, i)); });
  return entry;
}

/// What errors of responses to two inputs have in common, Q_ij/√(Q_ii Q_jj), of all pairs i < j;
/// null where that is nothing. Five decimals: weights of a fit follow from it.
Json input_correlation(const FrequencyResponses& r, const std::vector<std::size_t>& lines) {
  if (!r.has_errors()) return nullptr;
  const auto decimals = [](double value) { return std::round(1e5 * value) / 1e5; };
  Json pairs = Json::array();
  bool any = false;
  for (Index i = 0; i < static_cast<Index>(r.inputs.size()); ++i)
    for (Index j = i + 1; j < static_cast<Index>(r.inputs.size()); ++j) {
      Json re = Json::array(), im = Json::array();
      for (const std::size_t k : lines) {
        const auto& Q = r.input_factor[k];
        const double own = std::sqrt(Q(i, i).real() * Q(j, j).real());
        const std::complex<double> shared = own > 0.0 ? Q(i, j) / own : 0.0;
        re.push_back(decimals(shared.real()));
        im.push_back(decimals(shared.imag()));
        any = any || re.back() != 0.0 || im.back() != 0.0;
      }
      pairs.push_back({{"re", std::move(re)}, {"im", std::move(im)}});
    }
  return any ? pairs : Json(nullptr);
}

Json shown_responses(const FrequencyResponses& r) {
  const auto lines = shown_lines(r.lines());
  Json response = Json::array(), coherence = Json::array();
  for (Index o = 0; o < static_cast<Index>(r.outputs.size()); ++o) {
    Json row = Json::array();
    for (Index i = 0; i < static_cast<Index>(r.inputs.size()); ++i)
      row.push_back(entry_json(r, lines, o, i));
    response.push_back(std::move(row));
    if (!r.multiple_coherence.empty())
      coherence.push_back(list_of(lines, [&](auto k) { return r.multiple_coherence[k][o]; }));
  }
  Json shown{
      {"frequency_hz", Json::array()},
      {"response", std::move(response)},
      {"radius_95", r.has_errors() ? Json(identification::confidence_radius(confidence, r.degrees))
                                   : Json(nullptr)}};
  shown["shift_per_s"] = r.shift;
  shown["input_correlation"] = input_correlation(r, lines);
  for (const std::size_t k : lines) shown["frequency_hz"].push_back(r.frequency[k]);
  if (!coherence.empty()) shown["multiple_coherence"] = std::move(coherence);
  return shown;
}

/// ρ − 1 at as few lags as the highest line allows: the page transforms it by the trapezoidal rule,
/// whose first alias must lie far beyond.
Json taper_json(const FrequencyResponses& r) {
  const auto n = r.taper.size();
  if (n == 0 || r.lines() == 0) return nullptr;
  const double duration = static_cast<double>(n) / r.sample_rate;
  constexpr double room = 8.0;  // lags per highest line
  const auto wanted =
      std::bit_ceil(static_cast<unsigned>(std::max(64.0, room * r.frequency.back() * duration)));
  const Index count = static_cast<Index>(wanted);
  Json list = Json::array();
  for (Index k = 0; k < count; ++k) {
    const double at = static_cast<double>(k) * static_cast<double>(n) / static_cast<double>(count);
    const auto low = static_cast<Index>(at);
    const double next = low + 1 < n ? r.taper[low + 1] : 0.0;
    const double share = at - static_cast<double>(low);
    list.push_back(rounded((1.0 - share) * r.taper[low] + share * next - 1.0));
  }
  return {{"duration_s", duration}, {"values", std::move(list)}};
}

Json vector_json(const Eigen::VectorXcd& v) {
  Json re = Json::array(), im = Json::array();
  for (const auto& value : v) {
    re.push_back(rounded(value.real()));
    im.push_back(rounded(value.imag()));
  }
  return {{"re", std::move(re)}, {"im", std::move(im)}};
}

/// Motions of the model's modes against what the outputs are against: the page draws both modes.
void add_motions(const ComparedModes& compared, const identification::Identification& result,
                 Json& pairs) {
  const auto against = observation::motion_against(result.responses.outputs);
  for (std::size_t k = 0; k < compared.result.pairs.size(); ++k) {
    const auto model = static_cast<std::size_t>(compared.result.pairs[k].model);
    pairs[k]["model"]["motion"] = vector_json(compared.result.model[model].motion(against));
  }
}

}  // namespace

std::string measurement_text(const identification::FrequencyResponses& r) {
  const auto counted = [](std::size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  std::string text = fmt::format(
      "{}, {}, {} lines from {:.4g} Hz to {:.4g} Hz",
      counted(r.inputs.size(),
              r.estimator == data::Estimator::half_spectra ? "reference" : "input"),
      counted(r.outputs.size(), "output"), r.lines(), r.frequency.front(), r.frequency.back());
  if (r.averages > 0.0)
    text += fmt::format(", {} with {:.1f} independent averages", data::estimator_text(r.estimator),
                        r.averages);
  return text;
}

const char* frame_text(bool from_legs, bool from_accelerometers) {
  return from_accelerometers ? "accelerometers transformed to platform directions"
         : from_legs         ? "leg lengths transformed to platform directions"
                             : "outputs as measured";
}

Json identification_section(const identification::Identification& result,
                            const std::optional<ComparedModes>& compared,
                            const MeasuredText& text) {
  Json json = identification_json(result);
  json["records"] = text.records;
  json["measured"] = text.measured;
  json["frame"] = text.frame;
  json["comparison"] = compared ? comparison_json(*compared, result) : Json(nullptr);
  if (compared) add_motions(*compared, result, json["comparison"]["pairs"]);
  for (std::size_t o = 0; o < result.responses.outputs.size(); ++o)
    json["outputs"][o]["time_derivatives"] =
        data::time_derivatives(result.responses.outputs[o].unit);
  const auto motions = motion_words(result);
  for (std::size_t r = 0; r < motions.size(); ++r) json["modes"][r]["motion"] = motions[r];
  json["responses"] = shown_responses(result.responses);
  json["taper"] = taper_json(result.responses);
  for (std::size_t n = 0; n < result.chart.size(); ++n)
    for (std::size_t i = 0; i < result.chart[n].poles.size(); ++i) {
      const auto& e = result.chart[n].poles[i];
      auto& pole = json["stabilisation"][n]["poles"][i];
      pole["pole"] = {{"re", e.pole.real()}, {"im", e.pole.imag()}};
      pole["participation"] = vector_json(e.participation);
    }
  Json& values = json["indicator"]["values"];
  const auto lines = shown_lines(result.responses.lines());
  for (Json& row : values)
    row = list_of(lines, [&](std::size_t k) { return row[k].get<double>(); });
  json["indicator"]["frequency_hz"] = json["responses"]["frequency_hz"];
  return json;
}

}  // namespace hydrapod::report
