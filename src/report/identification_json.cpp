#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fields.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/statistics.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using Eigen::Index;
using Eigen::MatrixXcd;
using identification::FrequencyResponses;

/// `[row][column]` with re[] and im[] over the lines.
Json lines_json(const std::vector<MatrixXcd>& lines) {
  Json rows = Json::array();
  if (lines.empty()) return rows;
  for (Index i = 0; i < lines[0].rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < lines[0].cols(); ++j) {
      Eigen::VectorXcd values(static_cast<Index>(lines.size()));
      for (std::size_t k = 0; k < lines.size(); ++k) values[static_cast<Index>(k)] = lines[k](i, j);
      row.push_back(written(values));
    }
    rows.push_back(row);
  }
  return rows;
}

/// And back.
std::vector<MatrixXcd> read_lines(const Reader& fields, const char* key, std::size_t rows,
                                  std::size_t columns, std::size_t lines) {
  std::vector<std::vector<Eigen::VectorXcd>> all;
  fields(key, all);
  if (all.size() != rows) fields.bad(key, fmt::format("must have {} rows, one per output", rows));
  std::vector<MatrixXcd> result(lines,
                                MatrixXcd(static_cast<Index>(rows), static_cast<Index>(columns)));
  for (std::size_t i = 0; i < rows; ++i) {
    if (all[i].size() != columns)
      fields.bad(key, fmt::format("row {} must have {} entries", i + 1, columns));
    for (std::size_t j = 0; j < columns; ++j) {
      const auto& values = all[i][j];
      if (static_cast<std::size_t>(values.size()) != lines)
        fields.bad(
            fmt::format("{}[{}][{}]", key, i, j),
            fmt::format("has {} numbers, but there are {} frequencies", values.size(), lines));
      for (std::size_t k = 0; k < lines; ++k)
        result[k](static_cast<Index>(i), static_cast<Index>(j)) = values[static_cast<Index>(k)];
    }
  }
  return result;
}

template <class Number>
Json over_lines(std::size_t lines, const Number& number) {
  Json list = Json::array();
  for (std::size_t k = 0; k < lines; ++k) list.push_back(number(k));
  return list;
}

Json entry_json(const FrequencyResponses& r, const std::vector<MatrixXcd>& H, Index o, Index i) {
  Json entry{{"re", over_lines(r.lines(), [&](auto k) { return H[k](o, i).real(); })},
             {"im", over_lines(r.lines(), [&](auto k) { return H[k](o, i).imag(); })}};
  if (r.has_errors())
    entry["deviation"] =
        over_lines(r.lines(), [&](auto k) { return std::sqrt(r.variance(k, o, i)); });
  if (!r.coherence.empty())
    entry["coherence"] = over_lines(r.lines(), [&](auto k) { return r.coherence[k](o, i); });
  return entry;
}

template <class Warning>
std::vector<std::string> texts(const std::vector<Warning>& warnings) {
  std::vector<std::string> all;
  for (const auto& warning : warnings) all.push_back(warning_text(warning));
  return all;
}

/// Which of `poles` (from 1) a cluster became; null for none of them.
template <class Poles, class PoleOf>
Json number_of_cluster(const identification::ModalModel& model, std::size_t cluster,
                       const Poles& poles, const PoleOf& pole_of) {
  if (cluster >= model.modes.size()) return nullptr;
  const auto found = std::ranges::find(poles, model.modes[cluster].pole, pole_of);
  return found == poles.end() ? Json() : Json(found - poles.begin() + 1);
}

/// Lower and upper residuals C_k, k = −2 … 1, of (iω/scale)^k.
Json residuals_json(const identification::ModalModel& model) {
  Json terms = Json::array();
  for (const auto& C : model.residuals) terms.push_back(written(C));
  return {{"omega_scale_rad_s", model.omega_scale}, {"terms", terms}};
}

Json stabilisation_json(const identification::Identification& result) {
  const auto stability = identification::pole_stability(result.chart);
  std::vector<std::vector<Json>> cluster;
  for (const auto& order : result.chart) cluster.emplace_back(order.poles.size(), nullptr);
  for (std::size_t c = 0; c < result.clusters.size(); ++c)
    for (const auto& [n, i] : result.clusters[c].members) cluster[n][i] = c + 1;
  Json chart = Json::array();
  for (std::size_t n = 0; n < result.chart.size(); ++n) {
    Json poles = Json::array();
    for (std::size_t i = 0; i < result.chart[n].poles.size(); ++i) {
      const auto& e = result.chart[n].poles[i];
      poles.push_back({{"frequency_hz", e.omega() / two_pi},
                       {"damping_ratio", e.damping_ratio()},
                       {"stable", e.pole.real() < 0.0},
                       {"agrees", words(stability[n][i])},
                       {"cluster", cluster[n][i]}});
    }
    chart.push_back({{"order", result.chart[n].order}, {"poles", poles}});
  }
  return chart;
}

Json clusters_json(const identification::Identification& result) {
  Json list = Json::array();
  for (std::size_t c = 0; c < result.clusters.size(); ++c) {
    const auto& cluster = result.clusters[c];
    const auto fitted = [](const auto& mode) { return mode.fit.pole; };
    list.push_back({{"mode", number_of_cluster(result.model, c, result.modes, fitted)},
                    {"heavily_damped", number_of_cluster(result.model, c, result.heavily_damped,
                                                         &identification::FittedMode::pole)},
                    {"orders", cluster.members.size()},
                    {"persistence", cluster.persistence},
                    {"frequency_scatter", cluster.frequency_scatter},
                    {"damping_scatter", cluster.damping_scatter},
                    {"vector_consistency", cluster.vector_consistency}});
  }
  return list;
}

}  // namespace

template <class Fields>
void describe(Fields& f, data::Channel& channel) {
  std::string direction(data::direction_text(channel.direction)),
      role(data::role_text(channel.role));
  f.maybe("name", channel.name);
  f.maybe("unit", channel.unit);
  f.maybe("direction", direction);
  f.maybe("role", role);
  f.maybe("point", channel.point);
  if constexpr (Fields::reads) {
    channel.direction = data::direction_from_text(direction).value_or(data::Direction::none);
    channel.role = data::role_from_text(role).value_or(data::Role::other);
  }
}

template <class Fields>
void describe(Fields& f, identification::FittedMode& mode) {
  constexpr double band = numerics::normal_half_width;
  double omega = mode.omega(), ratio = mode.damping_ratio();
  f.scaled("frequency_hz", omega, two_pi);
  f.scaled("frequency_95_hz", mode.omega_deviation, two_pi / band);
  f("damping_ratio", ratio);
  f.scaled("damping_95", mode.damping_deviation, 1.0 / band);
  if constexpr (Fields::reads) {
    if (!(omega > 0.0)) f.bad("frequency_hz", "expected a number above 0");
    mode.pole = omega * std::complex<double>(-ratio, std::sqrt(std::max(0.0, 1.0 - ratio * ratio)));
  }
  f.maybe("pole", mode.pole);
  f.maybe("shape", mode.shape);
  f.maybe("shape_deviation", mode.shape_deviation);
  f.maybe("participation", mode.participation);
  f.maybe("significance", mode.significance);
}

template <class Fields>
void describe(Fields& f, identification::IdentifiedMode& mode) {
  describe(f, mode.fit);
  f.maybe("displacement_shape", mode.displacement);
  f.unless(1, "repeated", mode.repeated);
  f.maybe("mpc", mode.mpc);
  f.maybe("mpd_rad", mode.mpd);
  f.maybe("persistence", mode.persistence);
  f.maybe("vector_consistency", mode.vector_consistency);
  f.unless(1.0, "explained", mode.explained);
  f.unless(1.0, "steadiness", mode.steadiness);
  f.derived("quality", mode.quality());
}

template <class Fields>
void describe(Fields& f, identification::LeftOut& left) {
  f("pole", left.pole);
  f.word("reason", left.reason, words_of<identification::Objection, 7>(words));
}

namespace {

/// Null beyond the last kind.
const char* code(identification::ModeWarning::Kind kind) {
  constexpr std::array all{"no_mode", "few_samples", "misfit", "unexplained", "wanders"};
  const auto at = static_cast<std::size_t>(kind);
  return at < all.size() ? all[at] : nullptr;
}

const char* code(data::ResponseWarning::Kind kind) {
  using Kind = data::ResponseWarning::Kind;
  switch (kind) {
    case Kind::dead_output:
      return "dead_output";
    case Kind::dead_input:
      return "dead_input";
    case Kind::repeated_input:
      return "repeated_input";
    case Kind::clipped:
      return "clipped";
    case Kind::blocks_left_out:
      return "blocks_left_out";
    case Kind::correlated_inputs:
      return "correlated_inputs";
    case Kind::biased:
      return "biased";
    case Kind::excited_band:
      return "excited_band";
    case Kind::interrupted:
      return "interrupted";
    case Kind::lines_not_finite:
      return "lines_not_finite";
    case Kind::missing_samples:
      return "missing_samples";
    case Kind::single_block:
      return "single_block";
  }
  return nullptr;
}

template <class Enum>
std::vector<const char*> all_codes() {
  std::vector<const char*> all;
  for (int k = 0; code(static_cast<Enum>(k)) != nullptr; ++k)
    all.push_back(code(static_cast<Enum>(k)));
  return all;
}

}  // namespace

template <class Fields>
void describe(Fields& f, identification::ModeWarning& warning) {
  f.word("kind", warning.kind, all_codes<identification::ModeWarning::Kind>());
  f("value", warning.value);
  f("from_hz", warning.from);
  f("to_hz", warning.to);
  f.unless(0.0, "smooth", warning.smooth);
  f.unless(0.0, "share", warning.share);
  f.unless(std::string(), "output", warning.output);
  f.unless(std::string(), "input", warning.input);
  f.unless(std::int64_t{0}, "count", warning.count);
  f.unless(std::int64_t{0}, "total", warning.total);
}

template <class Fields>
void describe(Fields& f, data::ResponseWarning& warning) {
  std::string estimator{data::estimator_text(warning.estimator)};
  f.word("kind", warning.kind, all_codes<data::ResponseWarning::Kind>());
  f("channel", warning.channel);
  f("other", warning.other);
  f("value", warning.value);
  f("share", warning.share);
  f("lowest", warning.lowest);
  f("highest", warning.highest);
  f("count", warning.count);
  f("total", warning.total);
  f("estimator", estimator);
  if constexpr (Fields::reads)
    warning.estimator = data::estimator_from_text(estimator).value_or(data::Estimator::h1);
}

template <class Fields>
void describe(Fields& f, data::Harmonic& harmonic) {
  f("frequency_hz", harmonic.frequency);
  f("amplitude", harmonic.amplitude);
}

template <class Fields>
void describe(Fields& f, identification::Unexplained& part) {
  f.counted("output", part.output);
  f.counted("input", part.input);
  f.pair("band_hz", part.from, part.to);
  f("level", part.level);
  f("smooth", part.smooth);
  f("share", part.share);
}

template <class Fields>
void describe(Fields& f, identification::Identification& result) {
  std::array band{result.from, result.to};
  f.maybe("inputs", result.responses.inputs);
  f("outputs", result.responses.outputs);
  f.maybe("band_hz", band);
  f("modes", result.modes);
  f.maybe("heavily_damped", result.heavily_damped);
  f.maybe("harmonics", result.responses.harmonics);
  f.maybe("rejected", result.left_out);
  f.maybe("fit_error", result.model.error);
  f.maybe("misfit", result.model.misfit);
  f.unless(false, "errors_assumed", result.errors_assumed);
  f.maybe("unexplained", result.unexplained);
  f.derived("warnings", texts(result.warnings));
  f.maybe("findings", result.warnings);
  if constexpr (Fields::reads) {
    result.from = band[0];
    result.to = band[1];
  }
}

Json responses_json(const FrequencyResponses& r) {
  const bool with_axis = !r.on_axis.empty();
  Json response = Json::array();
  for (std::size_t o = 0; o < r.outputs.size(); ++o) {
    Json row = Json::array();
    for (std::size_t i = 0; i < r.inputs.size(); ++i)
      row.push_back(
          entry_json(r, with_axis ? r.on_axis : r.H, static_cast<Index>(o), static_cast<Index>(i)));
    response.push_back(row);
  }
  Json json{{"inputs", written(r.inputs)},
            {"outputs", written(r.outputs)},
            {"estimator", data::estimator_text(r.estimator)},
            {"averages", r.averages},
            {"degrees_of_freedom", r.degrees},
            {"frequency_hz", r.frequency},
            {"response", response}};
  if (!r.multiple_coherence.empty()) {
    Json multiple = Json::array();
    for (std::size_t o = 0; o < r.outputs.size(); ++o)
      multiple.push_back(over_lines(
          r.lines(), [&](auto k) { return r.multiple_coherence[k][static_cast<Index>(o)]; }));
    json["multiple_coherence"] = multiple;
    json["condition"] = r.condition;
  }
  if (r.has_errors()) {
    json["noise"] = lines_json(r.noise);
    json["input_factor"] = lines_json(r.input_factor);
    json["line_covariance"] =
        written(Eigen::VectorXcd::Map(r.line_covariance.data(),
                                      static_cast<Index>(r.line_covariance.size()))
                    .eval());
  }
  if (with_axis)
    json["beside_axis"] = {{"shift_per_s", r.shift}, {"response", lines_json(r.H)}};
  else if (r.shift > 0.0)
    json["shift_per_s"] = r.shift;
  if (r.taper.size() > 0) {
    json["sample_rate_hz"] = r.sample_rate;
    json["taper"] = written(r.taper);
  }
  json["warnings"] = texts(r.warnings);
  json["findings"] = written(r.warnings);
  return json;
}

Json record_origin_json(const data::RecordHeader& header) {
  return {{"title", header.title},
          {"date", header.date},
          {"notes", header.notes},
          {"machine_file", header.experiment.machine},
          {"experiment", experiment_object(header.experiment)}};
}

std::optional<data::RecordHeader> record_origin_from_json(const Json& json,
                                                          const std::string& file) {
  const auto found = json.find("record");
  if (found == json.end() || !found->is_object()) return {};
  const auto text = [&](const char* key) {
    const auto field = found->find(key);
    return field != found->end() && field->is_string() ? field->get<std::string>() : std::string();
  };
  data::RecordHeader header;
  header.title = text("title");
  header.date = text("date");
  header.notes = text("notes");
  const auto experiment = found->find("experiment");
  try {
    header.experiment =
        data::read_experiment(experiment == found->end() ? "" : experiment->dump(), header.notes);
  } catch (const std::invalid_argument& error) {
    throw base::InputError({{.file = file, .key = "record.experiment", .message = error.what()}});
  }
  header.experiment.machine = text("machine_file");
  return header;
}

FrequencyResponses responses_from_json(const Json& json, const std::string& file) {
  const Reader fields(json, file);
  for (const char* key : {"inputs", "outputs", "frequency_hz", "response"})
    if (!fields.has(key))
      fields.bad(key, "is missing; `hydrapod frf RECORD --format json` writes such a file");
  FrequencyResponses r;
  fields("inputs", r.inputs);
  fields("outputs", r.outputs);
  fields("frequency_hz", r.frequency);
  if (r.inputs.empty() || r.outputs.empty()) fields.bad("inputs", "and outputs: none is there");
  for (std::size_t k = 1; k < r.frequency.size(); ++k)
    if (!(r.frequency[k] > r.frequency[k - 1])) fields.bad("frequency_hz", "must ascend");
  const std::size_t outputs = r.outputs.size(), inputs = r.inputs.size();
  r.H = read_lines(fields, "response", outputs, inputs, r.lines());
  if (fields.has("noise")) {
    Eigen::VectorXcd covariance;
    r.noise = read_lines(fields, "noise", outputs, outputs, r.lines());
    r.input_factor = read_lines(fields, "input_factor", inputs, inputs, r.lines());
    fields("line_covariance", covariance);
    if (covariance.size() == 0) fields.bad("line_covariance", "is empty");
    r.line_covariance.assign(covariance.begin(), covariance.end());
    fields.unless(0.0, "degrees_of_freedom", r.degrees);
    fields.unless(0.0, "averages", r.averages);
  }
  if (fields.has("taper")) {
    fields("taper", r.taper);
    fields("sample_rate_hz", r.sample_rate);
    if (!(r.sample_rate > 0.0)) fields.bad("sample_rate_hz", "must be positive");
  }
  fields.unless(0.0, "shift_per_s", r.shift);
  if (!(r.shift >= 0.0)) fields.bad("shift_per_s", "must not be negative");
  if (fields.has("beside_axis"))
    fields.object("beside_axis", [&](const Reader& f) {
      f("shift_per_s", r.shift);
      if (!(r.shift > 0.0)) f.bad("shift_per_s", "must be positive");
      r.on_axis = std::exchange(r.H, read_lines(f, "response", outputs, inputs, r.lines()));
    });
  fields.maybe("findings", r.warnings);
  std::string estimator;
  fields.unless(std::string("h1"), "estimator", estimator);
  r.estimator = data::estimator_from_text(estimator).value_or(identification::Estimator::h1);
  return r;
}

Json identification_json(const identification::Identification& result) {
  std::vector<Eigen::VectorXcd> shapes;
  for (const auto& m : result.modes) shapes.push_back(m.displacement);
  Json json = written(result);
  json["mac"] = written(identification::mac_matrix(shapes, shapes));
  json["residuals"] = residuals_json(result.model);
  json["stabilisation"] = stabilisation_json(result);
  json["clusters"] = clusters_json(result);
  json["indicator"] = {
      {"frequency_hz", result.responses.frequency},
      {"values", written(identification::mode_indicator(result.responses).transpose().eval())}};
  return json;
}

identification::Identification identification_from_json(const Json& json, const std::string& file) {
  const Reader fields(json, file);
  for (const char* key : {"modes", "outputs"})
    if (!fields.has(key) || !fields.at(key).is_array())
      fields.bad(key, "is missing; `hydrapod identify RECORD --format json` writes such a file");
  identification::Identification result;
  read(json, file, result);
  if (result.modes.empty()) fields.bad("modes", "is empty: no mode was identified");
  if (fields.has("indicator") && fields.at("indicator").is_object())
    fields.object("indicator",
                  [&](const Reader& f) { f("frequency_hz", result.responses.frequency); });
  const auto outputs = static_cast<Index>(result.responses.outputs.size());
  for (auto& mode : result.modes) {
    const bool has_shape = mode.displacement.size() > 0;
    if (has_shape && mode.displacement.size() != outputs)
      fields.bad("modes[].displacement_shape", "must have a number per output");
    if (!has_shape) mode.displacement.setConstant(outputs, std::nan(""));  // not measured
    if (mode.fit.shape.size() != outputs) mode.fit.shape = mode.displacement;
    if (mode.fit.shape_deviation.size() != outputs)
      mode.fit.shape_deviation = Eigen::VectorXd::Zero(outputs);
  }
  return result;
}

void add_cross_checks(const std::vector<std::optional<identification::CrossCheck>>& cross_checks,
                      Json& json) {
  auto& modes = json["modes"];
  for (std::size_t r = 0; r < modes.size(); ++r) {
    modes[r]["cross_check"] = nullptr;
    if (r < cross_checks.size() && cross_checks[r])
      modes[r]["cross_check"] = {{"method", "era"},
                                 {"frequency_hz", cross_checks[r]->omega / two_pi},
                                 {"damping_ratio", cross_checks[r]->damping_ratio},
                                 {"mac", cross_checks[r]->mac},
                                 {"agrees", cross_checks[r]->agrees}};
  }
}

void add_bootstrap(const identification::BootstrapScatter& scatter, Json& json) {
  constexpr double band = numerics::normal_half_width;
  json["bootstrap_resamples"] = scatter.resamples;
  json["bootstrap_groups"] = scatter.groups;
  auto& modes = json["modes"];
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const auto k = static_cast<Index>(r);
    modes[r]["bootstrap"] = {{"frequency_95_hz", band * scatter.omega_deviation[k] / two_pi},
                             {"damping_95", band * scatter.damping_deviation[k]}};
  }
}

}  // namespace hydrapod::report
