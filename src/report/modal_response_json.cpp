#include "modal_response_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fields.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

using dynamics::ModelMatrix;

/// Off-diagonal terms of rounding size beside their diagonal ones do not couple modes.
bool is_diagonal(const ModelMatrix& Gamma) {
  constexpr double rounding = 1e-13;
  const ModelMatrix diagonal = Gamma.diagonal().asDiagonal();
  return (Gamma - diagonal).cwiseAbs().maxCoeff() <= rounding * Gamma.cwiseAbs().maxCoeff();
}

Json damping_json(const response::ResponseModel& model) {
  const ModelMatrix& Phi = model.modes.shapes;
  ModelMatrix Gamma = Phi.transpose() * model.C * Phi;
  for (int k = 0; k < model.modes.size(); ++k)
    Gamma(k, k) += 2.0 * model.modal_ratio * model.modes.omega(k);
  if (is_diagonal(Gamma)) return written(Gamma.diagonal());
  return written(Gamma);
}

struct Band {
  double from{std::numeric_limits<double>::infinity()};
  double to{0.0};
};

void widen(Band& band, const std::vector<modal::TabledMode>& modes) {
  for (const auto& entry : modes) {
    if (!entry.moves_platform || !(entry.mode.omega > 0.0)) continue;
    band.from = std::min(band.from, entry.mode.omega);
    band.to = std::max(band.to, entry.mode.omega);
  }
}

}  // namespace

Json modal_response_json(const response::ResponseModel& model, const std::vector<int>& tabled) {
  if (model.loads_flexible)
    throw std::invalid_argument("modal_response_json: loads on flexible coordinates");
  Json json{{"omega2", written(model.modes.omega2)},
            {"damping", damping_json(model)},
            {"platform_shapes", Json::array()},
            {"mode", Json::array()}};
  for (const auto& arm : model.arms) {
    if (arm.rate == 0.0) continue;
    const dynamics::ModelVector shape =
        std::sqrt(arm.stiffness) * (model.modes.shapes.transpose() * arm.s_y);
    json["relaxing"].push_back({{"rate_1_s", arm.rate}, {"shape", written(shape)}});
  }
  for (int k = 0; k < model.modes.size(); ++k) {
    json["platform_shapes"].push_back(written(model.modes.shapes.col(k).head<6>()));
    json["mode"].push_back(tabled.at(k) + 1);
  }
  return json;
}

Json bode_json(const modal::ModeTable& table, const model::Machine& machine, int points) {
  const auto& p_PC = machine.platform.mass_center;
  const auto response_of = [&](const modal::AnalysedModel& model) {
    return response::response_model(model.linear, model.normal, table.ratio.value, p_PC);
  };
  Band band;
  widen(band, table.real.modes);
  widen(band, table.rigid.modes);
  if (!(band.to > 0.0)) return nullptr;
  constexpr double room_below = 0.3, room_above = 2.5;
  const response::PeakOptions options{.from = room_below * band.from, .to = room_above * band.to};
  const auto real = response_of(table.real);
  const auto rigid = response_of(table.rigid);
  return {{"input", "wrench"},
          {"output", "displacement"},
          {"point", "platform mass centre"},
          {"point_m", written(real.p_BQ)},
          {"from_rad_s", options.from},
          {"to_rad_s", options.to},
          {"points", points},
          {"real", modal_response_json(real, table.real.tabled_of_normal)},
          {"rigid", modal_response_json(rigid, table.rigid.tabled_of_normal)},
          {"peaks", peaks_json(response::find_peaks(real, options), table.real)},
          {"rigid_peaks", peaks_json(response::find_peaks(rigid, options), table.rigid)}};
}

}  // namespace hydrapod::report
