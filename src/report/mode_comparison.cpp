#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/units.hpp"

#include "hydrapod/modal/mode_table.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
constexpr double percent = 100.0;

Json model_json(const ComparedModes& c, int model) {
  const auto& mode = c.result.model[static_cast<std::size_t>(model)];
  return {{"frequency_hz", mode.omega() / two_pi},
          {"damping_ratio", mode.damping_ratio()},
          {"pole", {{"re", mode.pole.real()}, {"im", mode.pole.imag()}}},
          {"label", c.labels[static_cast<std::size_t>(model)]}};
}

}  // namespace

ComparedModes compared_with(const identification::Identification& measured,
                            const observation::ComparisonFrame& frame, dynamics::ModelKind kind,
                            observation::Observed source, double highest_damping) {
  auto model = observation::observe(frame.machine, frame.X_BP, kind, source);
  ComparedModes compared{.source = source, .kind = kind};
  for (const auto& mode : model.modes)
    compared.labels.push_back(modal::mode_label(
        modal::energy_shares(model.mechanics, mode.shape.real(), mode.shape.imag()),
        mode.pole.real() < 0.0));
  compared.result = observation::compare_modes(identification::modal_results(measured),
                                               std::move(model.modes), frame, highest_damping);
  return compared;
}

std::string_view words(observation::Unpaired reason) {
  switch (reason) {
    case observation::Unpaired::not_found:
      return "not found";
    case observation::Unpaired::not_felt:
      return "local seal mode";
    case observation::Unpaired::not_seen:
      break;
  }
  return "the outputs do not show it";
}

std::string comparison_heading(const ComparedModes& c) {
  return fmt::format("{}, pose {}, {} model: {}", c.machine, c.pose, dynamics::name(c.kind),
                     observation::description(c.source));
}

Json comparison_json(const ComparedModes& c, const identification::Identification& measured) {
  Json pairs = Json::array(), alone = Json::array(), left = Json::array(), names = Json::array();
  for (const auto& p : c.result.pairs) {
    Json pair{{"mode", p.measured + 1},
              {"model", model_json(c, p.model)},
              {"frequency_difference_percent", percent * p.frequency_difference},
              {"damping_difference_percent", percent * p.damping_difference},
              {"mac", nullptr}};
    if (p.mac) pair["mac"] = *p.mac;
    pairs.push_back(std::move(pair));
  }
  for (const int r : c.result.measured_left) alone.push_back(r + 1);
  for (const auto& l : c.result.model_left) {
    Json mode = model_json(c, l.model);
    mode["reason"] = words(l.reason);
    left.push_back(std::move(mode));
  }
  for (const int o : c.result.outputs)
    names.push_back(measured.responses.outputs[static_cast<std::size_t>(o)].name);
  Json mac = Json::array();
  for (Eigen::Index r = 0; r < c.result.mac.rows(); ++r) {
    const Eigen::VectorXd row = c.result.mac.row(r);
    mac.push_back(std::vector<double>(row.begin(), row.end()));
  }
  Json model = Json::array();
  for (int k = 0; k < static_cast<int>(c.result.model.size()); ++k)
    model.push_back(model_json(c, k));
  return {{"machine", c.machine},
          {"pose", c.pose},
          {"model", dynamics::name(c.kind)},
          {"source", observation::name(c.source)},
          {"heading", comparison_heading(c)},
          {"pairs", pairs},
          {"not_in_model", alone},
          {"not_measured", left},
          {"outputs", names},
          {"model_modes", model},
          {"cross_mac", mac}};
}

std::string comparison_csv(const ComparedModes& c, const identification::Identification& measured) {
  std::string text =
      "mode,frequency_hz,model_frequency_hz,frequency_difference_percent,damping_ratio,"
      "model_damping_ratio,damping_difference_percent,mac,reason\n";
  const auto fit = [&](int r) { return measured.modes[static_cast<std::size_t>(r)].fit; };
  for (const auto& p : c.result.pairs) {
    const auto& model = c.result.model[static_cast<std::size_t>(p.model)];
    text += fmt::format("{},{:.17g},{:.17g},{:.6g},{:.17g},{:.17g},{:.6g},{},\n", p.measured + 1,
                        fit(p.measured).omega() / two_pi, model.omega() / two_pi,
                        percent * p.frequency_difference, fit(p.measured).damping_ratio(),
                        model.damping_ratio(), percent * p.damping_difference,
                        p.mac ? fmt::format("{:.6g}", *p.mac) : "");
  }
  for (const int r : c.result.measured_left)
    text += fmt::format("{},{:.17g},,,{:.17g},,,,not in the model\n", r + 1,
                        fit(r).omega() / two_pi, fit(r).damping_ratio());
  for (const auto& l : c.result.model_left) {
    const auto& model = c.result.model[static_cast<std::size_t>(l.model)];
    text += fmt::format(",,{:.17g},,,{:.17g},,,{}\n", model.omega() / two_pi, model.damping_ratio(),
                        words(l.reason));
  }
  return text;
}

}  // namespace hydrapod::report
