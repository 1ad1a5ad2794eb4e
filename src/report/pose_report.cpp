#include "pose_report.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "fields.hpp"
#include "geometry_json.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

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

/// The band of the modes that the platform's mass centre feels, and the peaks there; null without.
Json bode_section(const modal::ModeTable& table, const model::Machine& machine, int points) {
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
          {"peaks", peaks_json(response::find_peaks(real, options), table.real)},
          {"rigid_peaks", peaks_json(response::find_peaks(rigid, options), table.rigid)}};
}

}  // namespace

Json pose_report(const model::Machine& machine, const model::NamedPose& pose,
                 const modal::ModeTable& table, int points) {
  Json json{{"pose", pose_json(pose)}, {"answer", answer_json(table)}};
  json.update(modes_json(table));
  json["geometry"] = geometry_json(machine, table.real.linear);
  if (points > 0)
    if (Json bode = bode_section(table, machine, points); !bode.is_null())
      json["bode"] = std::move(bode);
  return json;
}

namespace {

Json brief_modes(const std::vector<modal::TabledMode>& modes) {
  Json list = Json::array();
  for (const auto& entry : modes) {
    Json mode{{"number", list.size() + 1},
              {"frequency_hz", entry.mode.omega / base::two_pi},
              {"stable", entry.mode.stable},
              {"platform_energy", written(entry.energy.platform)}};
    if (entry.rigid) mode["rigid"] = {{"mode", entry.rigid->mode + 1}, {"mac", entry.rigid->mac}};
    list.push_back(std::move(mode));
  }
  return list;
}

}  // namespace

Json brief_pose_report(const model::NamedPose& pose, const modal::ModeTable& table) {
  return {{"pose", {{"name", pose.name}}},
          {"answer", answer_json(table)},
          {"model", dynamics::name(table.kind)},
          {"modes", brief_modes(table.real.modes)},
          {"rigid_modes", brief_modes(table.rigid.modes)}};
}

}  // namespace hydrapod::report
