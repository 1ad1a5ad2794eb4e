#include "hydrapod/report/json.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/spatial/directions.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using spatial::direction_names;

template <class Vector>
Json array(const Vector& values) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) list.push_back(values[i]);
  return list;
}

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json rows(const dynamics::ModelMatrix& A) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < A.rows(); ++i) list.push_back(array(A.row(i)));
  return list;
}

Json strain_json(const modal::EnergyShares& energy) {
  Json json{{"oil", energy.oil.sum()},
            {"guide_sleeve", energy.guide_sleeve.sum()},
            {"piston_ring", energy.piston_ring.sum()},
            {"preload", energy.preload},
            {"per_leg",
             {{"oil", array(energy.oil)},
              {"guide_sleeve", array(energy.guide_sleeve)},
              {"piston_ring", array(energy.piston_ring)}}}};
  if (energy.base_mount != 0.0) json["base_mount"] = energy.base_mount;
  return json;
}

Json mode_json(const modal::TabledMode& entry, size_t number) {
  const auto& mode = entry.mode;
  Json json{{"number", number},
            {"omega_rad_s", mode.omega},
            {"frequency_hz", mode.omega / two_pi},
            {"damping_ratio", mode.damping_ratio},
            {"pole", {{"re", mode.pole.real()}, {"im", mode.pole.imag()}}},
            {"stable", mode.stable},
            {"label", entry.label},
            {"platform_feels", entry.platform_feels},
            {"group", mode.group},
            {"platform_energy", array(entry.energy.platform)},
            {"leg_energy", array(entry.energy.legs)},
            {"strain_energy", strain_json(entry.energy)},
            {"shape", array(mode.real)}};
  if (mode.is_complex()) json["shape_imaginary"] = array(mode.imaginary);
  return json;
}

Json matrix_set(const modal::LinearModel& model) {
  return {{"M", rows(model.M)}, {"K", rows(model.K)}, {"C", rows(model.C)}};
}

bool has_dampers(const model::Machine& machine) {
  for (const auto& leg : machine.legs)
    if (leg.guide_sleeve.damping != 0.0 || leg.oil_spring.damping != 0.0 ||
        (leg.piston_ring && leg.piston_ring->damping != 0.0))
      return true;
  return false;
}

}  // namespace

std::string damping_text(const model::Machine& machine) {
  const auto ratio = modal::modal_ratio(machine);
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : " + ") + part; };
  if (ratio.value > 0.0)
    add(fmt::format("{:.3g} % of critical in every mode", 100.0 * ratio.value));
  if (has_dampers(machine)) add("viscous dampers of the legs");
  const auto& damping = machine.damping;
  if (damping.rayleigh_mass != 0.0 || damping.rayleigh_stiffness != 0.0)
    add(fmt::format("Rayleigh α = {:.3g} 1/s, β = {:.3g} s", damping.rayleigh_mass,
                    damping.rayleigh_stiffness));
  if (text.empty()) return "none";
  return ratio.is_default ? text + " (default: the machine file gives no damping)" : text;
}

std::string gravity_text(const model::Machine& machine) {
  const auto& g = machine.gravity;
  if (g.isZero(0.0)) return "no gravity";
  if (g.x() == 0.0 && g.y() == 0.0 && g.z() < 0.0)
    return fmt::format("gravity {:.6g} m/s² downwards", -g.z());
  return fmt::format("gravity ({:.5g}, {:.5g}, {:.5g}) m/s²", g.x(), g.y(), g.z());
}

Json machine_json(const model::MachineFile& file, const std::string& path) {
  return {{"name", file.machine.name},
          {"description", file.machine.description},
          {"source", file.machine.source},
          {"file", path},
          {"overrides", file.overrides}};
}

Json pose_json(const PoseChoice& pose) {
  return {{"name", pose.name},
          {"position_m", array(pose.X_BP.p_BP)},
          {"rotation_rad", array(spatial::rpy_from_rotation(pose.X_BP.R_BP))}};
}

Json assumptions_json(const model::Machine& machine) {
  const auto ratio = modal::modal_ratio(machine);
  return {{"hydrapod", base::version},
          {"gravity_m_s2", array(machine.gravity)},
          {"gravity", gravity_text(machine)},
          {"flexible_axes",
           machine.flexible_axes == model::FlexibleAxes::gimbal ? "gimbal" : "transverse"},
          {"damping", damping_text(machine)},
          {"modal_ratio", ratio.value},
          {"modal_ratio_is_default", ratio.is_default}};
}

Json modes_json(const modal::ModeTable& table) {
  Json json{{"model", dynamics::name(table.kind)},
            {"coordinates", dynamics::coordinate_names(table.kind)},
            {"modes", Json::array()},
            {"rigid_modes", Json::array()}};
  for (size_t k = 0; k < table.real.modes.size(); ++k) {
    const auto& entry = table.real.modes[k];
    Json mode = mode_json(entry, k + 1);
    if (entry.rigid)
      mode["rigid"] = {{"mode", entry.rigid->mode + 1},
                       {"omega_rad_s", table.rigid.modes[entry.rigid->mode].mode.omega},
                       {"mac", entry.rigid->mac},
                       {"shift_percent", 100.0 * entry.rigid->shift}};
    json["modes"].push_back(std::move(mode));
  }
  for (size_t k = 0; k < table.rigid.modes.size(); ++k)
    json["rigid_modes"].push_back(mode_json(table.rigid.modes[k], k + 1));
  return json;
}

Json matrices_json(const modal::ModeTable& table) {
  Json json = matrix_set(table.real.linear);
  json["rigid"] = matrix_set(table.rigid.linear);
  return json;
}

Json response_json(const std::vector<double>& omega, const std::vector<response::Matrix6c>& H) {
  Json json{{"omega_rad_s", omega}};
  std::vector<double> hertz(omega.size());
  for (size_t i = 0; i < omega.size(); ++i) hertz[i] = omega[i] / two_pi;
  json["frequency_hz"] = hertz;
  for (int out = 0; out < 6; ++out)
    for (int in = 0; in < 6; ++in) {
      std::vector<double> re(H.size()), im(H.size());
      for (size_t i = 0; i < H.size(); ++i) {
        re[i] = H[i](out, in).real();
        im[i] = H[i](out, in).imag();
      }
      json["response"][direction_names[out]][direction_names[in]] = {{"re", re}, {"im", im}};
    }
  return json;
}

Json peaks_json(const std::vector<response::Peak>& peaks, const modal::ModeTable& table,
                bool rigid) {
  Json list = Json::array();
  const auto& model = rigid ? table.rigid : table.real;
  for (const auto& peak : peaks) {
    const int tabled = model.tabled_of_normal[peak.mode];
    list.push_back({{"direction", direction_names[peak.direction]},
                    {"omega_rad_s", peak.omega},
                    {"frequency_hz", peak.omega / two_pi},
                    {"magnitude", finite_or_null(peak.magnitude)},
                    {"prominence_db", finite_or_null(peak.prominence_db)},
                    {"mode", tabled + 1},
                    {"label", model.modes[tabled].label},
                    {"own", peak.own}});
  }
  return list;
}

}  // namespace hydrapod::report
