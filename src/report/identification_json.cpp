#include "hydrapod/report/identification_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/identification/stabilisation.hpp"
#include "hydrapod/numerics/quantiles.hpp"
#include "hydrapod/report/record_json.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using Eigen::Index;
using Eigen::MatrixXcd;
using identification::FrequencyResponses;

Json complex_json(std::complex<double> value) {
  return {{"re", value.real()}, {"im", value.imag()}};
}

Json vector_json(const Eigen::VectorXcd& v) {
  Json re = Json::array(), im = Json::array();
  for (const auto& value : v) {
    re.push_back(value.real());
    im.push_back(value.imag());
  }
  return {{"re", re}, {"im", im}};
}

Json matrix_json(const Eigen::MatrixXd& M) {
  Json rows = Json::array();
  for (Index i = 0; i < M.rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < M.cols(); ++j) row.push_back(M(i, j));
    rows.push_back(row);
  }
  return rows;
}

Json channels_json(const std::vector<data::Channel>& channels) {
  Json list = Json::array();
  for (const auto& c : channels)
    list.push_back({{"name", c.name},
                    {"unit", c.unit},
                    {"direction", data::direction_text(c.direction)},
                    {"role", data::role_text(c.role)},
                    {"point", c.point}});
  return list;
}

/// `[row][column]` with re[] and im[] over the lines.
Json lines_json(const std::vector<MatrixXcd>& lines) {
  Json rows = Json::array();
  if (lines.empty()) return rows;
  for (Index i = 0; i < lines[0].rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < lines[0].cols(); ++j) {
      Json re = Json::array(), im = Json::array();
      for (const auto& M : lines) {
        re.push_back(M(i, j).real());
        im.push_back(M(i, j).imag());
      }
      row.push_back({{"re", re}, {"im", im}});
    }
    rows.push_back(row);
  }
  return rows;
}

template <class Number>
Json over_lines(std::size_t lines, const Number& number) {
  Json list = Json::array();
  for (std::size_t k = 0; k < lines; ++k) list.push_back(number(k));
  return list;
}

Json entry_json(const FrequencyResponses& r, Index o, Index i) {
  Json entry{{"re", over_lines(r.lines(), [&](auto k) { return r.H[k](o, i).real(); })},
             {"im", over_lines(r.lines(), [&](auto k) { return r.H[k](o, i).imag(); })}};
  if (r.has_errors())
    entry["deviation"] = over_lines(r.lines(), [&](auto k) {
      return std::sqrt(r.variance(k, static_cast<int>(o), static_cast<int>(i)));
    });
  if (!r.coherence.empty())
    entry["coherence"] = over_lines(r.lines(), [&](auto k) { return r.coherence[k](o, i); });
  return entry;
}

/// Reads fields, and says which one is wrong.
class Fields {
 public:
  Fields(const Json& json, const std::string& file) : json_(json), file_(file) {}

  [[noreturn]] void bad(const std::string& key, const std::string& message) const {
    throw base::InputError({{.file = file_, .key = key, .message = message}});
  }
  [[nodiscard]] const Json& at(const std::string& key) const {
    const auto found = json_.find(key);
    if (found == json_.end())
      bad(key, "is missing; `hydrapod frf RECORD --format json` writes such a file");
    return *found;
  }
  [[nodiscard]] bool has(const std::string& key) const { return json_.contains(key); }
  /// "line_covariance": real numbers, or re and im.
  [[nodiscard]] std::vector<std::complex<double>> covariance() const {
    const Json& given = at("line_covariance");
    const bool complex = given.is_object();
    const auto re = numbers(complex ? given.value("re", Json()) : given, "line_covariance");
    const auto im = complex ? numbers(given.value("im", Json()), "line_covariance.im")
                            : std::vector<double>(re.size(), 0.0);
    if (re.empty() || re.size() != im.size())
      bad("line_covariance", "needs re and im, as many numbers each");
    std::vector<std::complex<double>> list;
    for (std::size_t d = 0; d < re.size(); ++d) list.emplace_back(re[d], im[d]);
    return list;
  }
  [[nodiscard]] std::vector<double> numbers(const Json& list, const std::string& key) const {
    if (!list.is_array()) bad(key, "is no list of numbers");
    std::vector<double> values;
    for (const auto& value : list) {
      if (!value.is_number()) bad(key, "holds something that is no number");
      values.push_back(value.get<double>());
    }
    return values;
  }
  /// A text, or what stands for one that is not there.
  [[nodiscard]] std::string text(const Json& object, const std::string& key,
                                 const std::string& otherwise) const {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    if (!found->is_string()) bad(key, "is no text");
    return found->get<std::string>();
  }
  [[nodiscard]] double number(const Json& object, const std::string& key, double otherwise) const {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    if (!found->is_number()) bad(key, "is no number");
    return found->get<double>();
  }
  [[nodiscard]] std::vector<data::Channel> channels(const std::string& key) const {
    std::vector<data::Channel> list;
    const Json& all = at(key);
    if (!all.is_array() || all.empty()) bad(key, "is no list of channels");
    for (const auto& c : all) {
      if (!c.is_object()) bad(key, "holds something that is no channel");
      data::Channel channel;
      channel.name = text(c, "name", "");
      channel.unit = text(c, "unit", "1");
      channel.direction =
          data::direction_from_text(text(c, "direction", "")).value_or(data::Direction::none);
      channel.role = data::role_from_text(text(c, "role", "")).value_or(data::Role::other);
      const double point = number(c, "point", 0.0);
      if (!(std::abs(point) < 1e9)) bad("point", "is no number of a measuring point");
      channel.point = static_cast<int>(point);
      list.push_back(channel);
    }
    return list;
  }
  /// `[row][column]` with re[] and im[] of `lines` numbers.
  [[nodiscard]] std::vector<MatrixXcd> lines(const std::string& key, Index rows, Index columns,
                                             std::size_t lines) const {
    std::vector<MatrixXcd> result(lines, MatrixXcd(rows, columns));
    const Json& all = at(key);
    const auto size = [](const Json& list) { return static_cast<Index>(list.size()); };
    if (!all.is_array() || size(all) != rows)
      bad(key, fmt::format("must have {} rows, one per output", rows));
    for (Index i = 0; i < rows; ++i) {
      const Json& row = all[static_cast<std::size_t>(i)];
      if (!row.is_array() || size(row) != columns)
        bad(key, fmt::format("row {} must have {} entries", i + 1, columns));
      for (Index j = 0; j < columns; ++j) {
        const Json& entry = row[static_cast<std::size_t>(j)];
        const std::string place = fmt::format("{}[{}][{}]", key, i, j);
        if (!entry.is_object() || !entry.contains("re") || !entry.contains("im"))
          bad(place, "must have re and im");
        const auto re = numbers(entry["re"], place + ".re"),
                   im = numbers(entry["im"], place + ".im");
        if (re.size() != lines || im.size() != lines)
          bad(place, fmt::format("has {} and {} numbers, but there are {} frequencies", re.size(),
                                 im.size(), lines));
        for (std::size_t k = 0; k < lines; ++k) result[k](i, j) = {re[k], im[k]};
      }
    }
    return result;
  }

 private:
  const Json& json_;
  const std::string& file_;
};

Json mode_json(const identification::FittedMode& m) {
  constexpr double band = numerics::normal_half_width;
  return {
      {"frequency_hz", m.omega() / two_pi},
      {"frequency_95_hz", band * m.omega_deviation / two_pi},
      {"damping_ratio", m.damping_ratio()},
      {"damping_95", band * m.damping_deviation},
      {"pole", complex_json(m.pole)},
      {"shape", vector_json(m.shape)},
      {"shape_deviation", std::vector<double>(m.shape_deviation.begin(), m.shape_deviation.end())},
      {"participation", vector_json(m.participation)},
      {"significance", m.significance}};
}

/// Which mode (from 1) a cluster became; null for heavily damped poles.
Json mode_of_cluster(const identification::Identification& result, std::size_t cluster) {
  if (cluster >= result.model.modes.size()) return nullptr;
  for (std::size_t r = 0; r < result.modes.size(); ++r)
    if (result.modes[r].fit.pole == result.model.modes[cluster].pole) return r + 1;
  return nullptr;
}

/// Lower and upper residuals C_k, k = −2 … 1, of (iω/scale)^k.
Json residuals_json(const identification::ModalModel& model) {
  Json terms = Json::array();
  for (const auto& C : model.residuals) terms.push_back(matrix_json(C));
  return {{"omega_scale_rad_s", model.omega_scale}, {"terms", terms}};
}

/// The same among the heavily damped poles.
Json heavy_of_cluster(const identification::Identification& result, std::size_t cluster) {
  if (cluster >= result.model.modes.size()) return nullptr;
  for (std::size_t r = 0; r < result.heavily_damped.size(); ++r)
    if (result.heavily_damped[r].pole == result.model.modes[cluster].pole) return r + 1;
  return nullptr;
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
                       {"agrees", identification::stability_text(stability[n][i])},
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
    list.push_back({{"mode", mode_of_cluster(result, c)},
                    {"heavily_damped", heavy_of_cluster(result, c)},
                    {"orders", cluster.members.size()},
                    {"persistence", cluster.persistence},
                    {"frequency_scatter", cluster.frequency_scatter},
                    {"damping_scatter", cluster.damping_scatter},
                    {"vector_consistency", cluster.vector_consistency}});
  }
  return list;
}

}  // namespace

Json responses_json(const FrequencyResponses& r) {
  Json response = Json::array();
  for (std::size_t o = 0; o < r.outputs.size(); ++o) {
    Json row = Json::array();
    for (std::size_t i = 0; i < r.inputs.size(); ++i)
      row.push_back(entry_json(r, static_cast<Index>(o), static_cast<Index>(i)));
    response.push_back(row);
  }
  Json json{{"inputs", channels_json(r.inputs)},
            {"outputs", channels_json(r.outputs)},
            {"estimator", identification::estimator_text(r.estimator)},
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
    const Eigen::VectorXcd covariance = Eigen::VectorXcd::Map(
        r.line_covariance.data(), static_cast<Index>(r.line_covariance.size()));
    json["line_covariance"] = vector_json(covariance);
  }
  if (r.shift > 0.0) json["shift_per_s"] = r.shift;
  if (r.taper.size() > 0) {
    json["sample_rate_hz"] = r.sample_rate;
    json["taper"] = std::vector<double>(r.taper.begin(), r.taper.end());
  }
  json["warnings"] = r.warnings;
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
  const Fields fields(json, file);
  FrequencyResponses r;
  r.inputs = fields.channels("inputs");
  r.outputs = fields.channels("outputs");
  r.frequency = fields.numbers(fields.at("frequency_hz"), "frequency_hz");
  for (std::size_t k = 1; k < r.frequency.size(); ++k)
    if (!(r.frequency[k] > r.frequency[k - 1])) fields.bad("frequency_hz", "must ascend");
  const auto outputs = static_cast<Index>(r.outputs.size()),
             inputs = static_cast<Index>(r.inputs.size());
  r.H = fields.lines("response", outputs, inputs, r.lines());
  if (fields.has("noise")) {
    r.noise = fields.lines("noise", outputs, outputs, r.lines());
    r.input_factor = fields.lines("input_factor", inputs, inputs, r.lines());
    r.line_covariance = fields.covariance();
    r.degrees = fields.number(json, "degrees_of_freedom", 0.0);
    r.averages = fields.number(json, "averages", 0.0);
  }
  if (fields.has("taper")) {
    const auto taper = fields.numbers(fields.at("taper"), "taper");
    r.taper = Eigen::VectorXd::Map(taper.data(), static_cast<Index>(taper.size()));
    r.sample_rate = fields.number(json, "sample_rate_hz", 0.0);
    if (!(r.sample_rate > 0.0)) fields.bad("sample_rate_hz", "must be positive");
  }
  r.shift = fields.number(json, "shift_per_s", 0.0);
  if (!(r.shift >= 0.0)) fields.bad("shift_per_s", "must not be negative");
  r.estimator = identification::estimator_from_text(fields.text(json, "estimator", "h1"))
                    .value_or(identification::Estimator::h1);
  return r;
}

Json identification_json(const identification::Identification& result) {
  Json modes = Json::array(), heavy = Json::array(), left = Json::array();
  std::vector<Eigen::VectorXcd> shapes;
  for (const auto& m : result.modes) {
    Json mode = mode_json(m.fit);
    mode["displacement_shape"] = vector_json(m.displacement);
    mode["mpc"] = m.mpc;
    mode["mpd_rad"] = m.mpd;
    mode["persistence"] = m.persistence;
    mode["vector_consistency"] = m.vector_consistency;
    mode["quality"] = m.quality();
    modes.push_back(mode);
    shapes.push_back(m.displacement);
  }
  for (const auto& m : result.heavily_damped) heavy.push_back(mode_json(m));
  for (const auto& l : result.left_out)
    left.push_back({{"pole", complex_json(l.pole)}, {"reason", l.reason}});
  return {{"inputs", channels_json(result.responses.inputs)},
          {"outputs", channels_json(result.responses.outputs)},
          {"band_hz", {result.from, result.to}},
          {"modes", modes},
          {"heavily_damped", heavy},
          {"left_out", left},
          {"mac", matrix_json(identification::mac_matrix(shapes, shapes))},
          {"residuals", residuals_json(result.model)},
          {"fit_error", result.model.error},
          {"misfit", result.model.misfit},
          {"stabilisation", stabilisation_json(result)},
          {"clusters", clusters_json(result)},
          {"indicator",
           {{"frequency_hz", result.responses.frequency},
            {"values", matrix_json(identification::mode_indicator(result.responses).transpose())}}},
          {"warnings", result.warnings}};
}

void add_second_opinions(const std::vector<std::optional<identification::SecondOpinion>>& opinions,
                         Json& json) {
  auto& modes = json["modes"];
  for (std::size_t r = 0; r < modes.size(); ++r) {
    modes[r]["second_opinion"] = nullptr;
    if (r < opinions.size() && opinions[r])
      modes[r]["second_opinion"] = {{"method", "era"},
                                    {"frequency_hz", opinions[r]->omega / two_pi},
                                    {"damping_ratio", opinions[r]->damping_ratio},
                                    {"mac", opinions[r]->mac},
                                    {"agrees", opinions[r]->agrees}};
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

Json output_only_json(const std::vector<identification::OutputOnlyMode>& modes) {
  Json list = Json::array();
  for (const auto& m : modes)
    list.push_back({{"frequency_hz", std::abs(m.pole) / two_pi},
                    {"frequency_scatter", m.frequency_scatter},
                    {"damping_ratio", -m.pole.real() / std::abs(m.pole)},
                    {"damping_scatter", m.damping_scatter},
                    {"pole", complex_json(m.pole)},
                    {"shape", vector_json(m.shape)},
                    {"mpc", m.mpc},
                    {"persistence", m.persistence}});
  return list;
}

}  // namespace hydrapod::report
