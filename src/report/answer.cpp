#include "hydrapod/report/json.hpp"
#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "hydrapod/base/units.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;

std::string drop_text(const modal::ModeTable& table, double drop) {
  const bool rings = table.kind == dynamics::ModelKind::full;
  const std::string parts = rings ? "The seals and piston rings" : "The seals";
  if (drop < 0.0) return parts + " do not lower it";
  return fmt::format("{} lower it by {:.{}f} %", parts, drop, drop < 10.0 ? 2 : 0);
}

/// Index of the mode that holds most of the rigid-leg model's mode `rigid`; −1 when none does.
int main_mode(const modal::ModeTable& table, int rigid) {
  int best = -1;
  for (int k = 0; k < static_cast<int>(table.real.modes.size()); ++k) {
    const auto& of = table.real.modes[k].rigid;
    if (!of || of->mode != rigid) continue;
    if (best < 0 || of->mac > table.real.modes[best].rigid->mac) best = k;
  }
  return best;
}

/// Of a mode beside that of its counterpart with rigid legs.
double peak_height(const modal::TabledMode& entry) {
  const double over_rigid = 1.0 + entry.rigid->shift;
  return report::peak_height(entry.rigid->mac, over_rigid, 1.0);
}

/// How much of the rigid-leg mode's motion the lowered mode holds, how high it stands, and where
/// the rest of the motion is.
std::string share_text(const modal::ModeTable& table, int k) {
  const auto& entry = table.real.modes[k];
  std::string text = fmt::format(
      " This mode holds {} % of the motion of the mode with rigid legs, its peak is {:.2f} times "
      "as "
      "high at equal damping ratios",
      percent_text(entry.rigid->mac), peak_height(entry));
  const int main = main_mode(table, entry.rigid->mode);
  if (main == k) return text + ".";
  const auto& other = table.real.modes[main];
  return text + fmt::format(
                    "; {} % of it is in the mode at {:.3f} Hz ({:+.1f} %), whose peak is "
                    "{:.2f} times as high.",
                    percent_text(other.rigid->mac), other.mode.omega / two_pi,
                    100.0 * other.rigid->shift, peak_height(other));
}

/// The platform may rest in the mode in which the legs buckle.
bool is_stable(const std::vector<modal::TabledMode>& modes) {
  return std::ranges::all_of(modes, [](const auto& entry) { return entry.mode.stable; });
}

bool is_stable(const modal::ModeTable& table) { return is_stable(table.real.modes); }

}  // namespace

std::string percent_text(double share) {
  const double value = 100.0 * share;
  return value > 0.0 && value < 0.5 ? "<1" : fmt::format("{:.0f}", value);
}

std::string energy_text(double oil, double guide_sleeve, double piston_ring, double base,
                        double payload, double bending, model::LegType leg) {
  constexpr double worth_naming = 0.005;
  std::string text;
  const auto add = [&](std::string_view part, double share) {
    if (share >= worth_naming)
      text += fmt::format("{}{} {} %", text.empty() ? "" : ", ", part, percent_text(share));
  };
  add(model::axial_part(leg), oil);
  add("sleeves", guide_sleeve);
  add("rings", piston_ring);
  add("bending", bending);
  add("base", base);
  add("payload", payload);
  return text;
}

std::string energy_text(const modal::EnergyShares& energy) {
  return energy_text(energy.oil.sum(), energy.guide_sleeve.sum(), energy.piston_ring.sum(),
                     energy.base_mount, energy.payload_elastic, energy.bending.sum(),
                     energy.leg_type);
}

std::string axial_energy_text(const model::Machine& machine) {
  const auto any = [&](const auto& has) { return std::ranges::any_of(machine.legs, has); };
  std::vector<std::string> others;
  if (any([](const model::Leg& leg) { return leg.gimbal_stiffness.has_value(); }))
    others.emplace_back("gimbals in series (legs.gimbal_stiffness)");
  if (any([](const model::Leg& leg) { return leg.stick_stiffness > 0.0; }))
    others.emplace_back("sticking cylinder seals in parallel (legs.stick_stiffness)");
  if (others.empty()) return {};
  return fmt::format("elastic energy of {} includes that of {}\n",
                     model::axial_part(model::leg_type(machine)), fmt::join(others, " and "));
}

std::string answer_text(const modal::ModeTable& table) {
  if (!is_stable(table))
    return table.rigid.modes.empty() || is_stable(table.rigid.modes)
               ? "The machine is unstable at this pose: the legs buckle. `hydrapod check` computes "
                 "the buckling load.\n"
               : "The machine is unstable at this pose, also in the rigid-leg model: what holds "
                 "the "
                 "legs along their axes is too soft for the load. `hydrapod check` states the "
                 "cause.\n";
  const int k = modal::lowest_platform_mode(table.real.modes);
  if (k < 0) return {};
  const auto& entry = table.real.modes[k];
  std::string text =
      fmt::format("Lowest mode with platform motion: {:.3f} Hz in {}", entry.mode.omega / two_pi,
                  modal::platform_directions(entry.energy));
  if (!entry.rigid) return text + ".\n";
  const double rigid = table.rigid.modes[entry.rigid->mode].mode.omega;
  return text + fmt::format("; with rigid legs: {:.3f} Hz. {}.{} Elastic energy: {}.\n",
                            rigid / two_pi, drop_text(table, -100.0 * entry.rigid->shift),
                            share_text(table, k), energy_text(entry.energy));
}

Json answer_json(const modal::ModeTable& table) {
  const int k = modal::lowest_platform_mode(table.real.modes);
  if (k < 0) return nullptr;
  const auto& entry = table.real.modes[k];
  std::string text = answer_text(table);
  text.pop_back();
  Json json{{"text", text},
            {"stable", is_stable(table)},
            {"mode", k + 1},
            {"frequency_hz", entry.mode.omega / two_pi},
            {"directions", modal::platform_directions(entry.energy)},
            {"strain_energy",
             {{"oil", entry.energy.oil.sum()},
              {"guide_sleeve", entry.energy.guide_sleeve.sum()},
              {"piston_ring", entry.energy.piston_ring.sum()}}}};
  if (entry.energy.leg_type != model::LegType::cylinder)
    json["strain_energy"]["axial"] = model::axial_part(entry.energy.leg_type);
  if (entry.energy.base_mount != 0.0) json["strain_energy"]["base_mount"] = entry.energy.base_mount;
  if (entry.energy.payload_elastic != 0.0)
    json["strain_energy"]["payload"] = entry.energy.payload_elastic;
  if (!entry.energy.bending.isZero(0.0))
    json["strain_energy"]["bending"] = entry.energy.bending.sum();
  if (entry.rigid) {
    json["rigid_mode"] = entry.rigid->mode + 1;
    json["rigid_frequency_hz"] = table.rigid.modes[entry.rigid->mode].mode.omega / two_pi;
    json["drop_percent"] = -100.0 * entry.rigid->shift;
    json["share_of_rigid_mode"] = entry.rigid->mac;
    json["peak_height"] = peak_height(entry);
    const int main = main_mode(table, entry.rigid->mode);
    json["main_mode"] = main + 1;
    json["main_frequency_hz"] = table.real.modes[main].mode.omega / two_pi;
    json["main_share_of_rigid_mode"] = table.real.modes[main].rigid->mac;
    json["main_peak_height"] = peak_height(table.real.modes[main]);
  }
  return json;
}

}  // namespace hydrapod::report
