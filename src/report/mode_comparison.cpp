#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <array>

#include "fields.hpp"
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
          {"pole", written(mode.pole)},
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
  constexpr std::array texts{"not found", "local seal mode", "the outputs do not show it"};
  return texts.at(static_cast<std::size_t>(reason));
}

std::string comparison_heading(const ComparedModes& c) {
  return fmt::format("{}, pose {}, {} model: {}", c.machine, c.pose, dynamics::name(c.kind),
                     observation::description(c.source));
}

Json comparison_json(const ComparedModes& c, const identification::Identification& measured) {
  const auto& result = c.result;
  Json json{{"machine", c.machine},
            {"pose", c.pose},
            {"model", dynamics::name(c.kind)},
            {"source", observation::name(c.source)},
            {"heading", comparison_heading(c)}};
  for (const char* list : {"pairs", "not_in_model", "not_measured", "outputs", "model_modes"})
    json[list] = Json::array();
  for (const auto& p : result.pairs)
    json["pairs"].push_back({{"mode", p.measured + 1},
                             {"model", model_json(c, p.model)},
                             {"frequency_difference_percent", percent * p.frequency_difference},
                             {"damping_difference_percent", percent * p.damping_difference},
                             {"mac", written(p.mac)}});
  for (const int r : result.measured_left) json["not_in_model"].push_back(r + 1);
  for (const auto& l : result.model_left) {
    json["not_measured"].push_back(model_json(c, l.model));
    json["not_measured"].back()["reason"] = words(l.reason);
  }
  for (const int o : result.outputs)
    json["outputs"].push_back(measured.responses.outputs[static_cast<std::size_t>(o)].name);
  for (int k = 0; k < static_cast<int>(result.model.size()); ++k)
    json["model_modes"].push_back(model_json(c, k));
  json["cross_mac"] = written(result.mac);
  return json;
}

}  // namespace hydrapod::report
