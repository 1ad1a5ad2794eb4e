#include "hydrapod/report/measured_results.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "measured_fields.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using Eigen::Index;

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

template <class Fields>
void describe(Fields& f, identification::ModeWarning& warning) {
  static constexpr std::array kinds{
      "no_mode",      "few_samples",  "misfit",     "unexplained",      "wanders",
      "short_blocks", "peaks_above",  "conjugated", "window",           "twins",
      "moved",        "common_poles", "set_ups",    "combination_tones"};
  f.word("kind", warning.kind, kinds);
  f("value", warning.value);
  f("from_hz", warning.from);
  f("to_hz", warning.to);
  f.unless(0.0, "smooth", warning.smooth);
  f.unless(0.0, "share", warning.share);
  f.unless(std::string(), "output", warning.output);
  f.unless(std::string(), "input", warning.input);
  f.unless(std::string(), "window", warning.window);
  f.unless(std::int64_t{0}, "count", warning.count);
  f.unless(std::int64_t{0}, "total", warning.total);
}

/// Of the responses or of the modes: `kind` tells which.
struct AnyWarning {
  std::variant<data::ResponseWarning, identification::ModeWarning> own{
      identification::ModeWarning{}};
};

template <class Fields>
void describe(Fields& f, AnyWarning& warning) {
  if constexpr (Fields::reads) {
    std::string kind;
    f("kind", kind);
    if (std::ranges::count(data::response_warning_names, kind) > 0)
      warning.own = data::ResponseWarning{};
  }
  std::visit([&](auto& own) { describe(f, own); }, warning.own);
}

template <class Fields>
void describe(Fields& f, data::Harmonic& harmonic) {
  f("frequency_hz", harmonic.frequency);
  f("amplitude", harmonic.amplitude);
  f.unless(0.0, "wander_hz", harmonic.wander);
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
  f.optional("needed_duration_s", result.needed_duration);
  f.maybe("unexplained", result.unexplained);
  std::vector<AnyWarning> findings;
  for (const auto& warning : result.responses.warnings) findings.push_back({warning});
  for (const auto& warning : result.warnings) findings.push_back({warning});
  auto texts_of_all = texts(result.responses.warnings);
  std::ranges::move(texts(result.warnings), std::back_inserter(texts_of_all));
  f.derived("warnings", texts_of_all);
  f.maybe("findings", findings);
  if constexpr (Fields::reads) {
    for (const auto& warning : findings)
      if (const auto* of_responses = std::get_if<data::ResponseWarning>(&warning.own))
        result.responses.warnings.push_back(*of_responses);
      else
        result.warnings.push_back(std::get<identification::ModeWarning>(warning.own));
    result.from = band[0];
    result.to = band[1];
  }
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
      fields.bad(key,
                 "is missing; `hydrapod identify RECORD --format json` writes such a file, and a "
                 "list of modes by hand is CSV with the columns `frequency [Hz]` and `direction`, "
                 "or TOML");
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
