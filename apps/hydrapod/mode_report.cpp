#include "hydrapod/reports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hydrapod/base/units.hpp"
#include "hydrapod/model/section.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
using spatial::direction_names;
constexpr double worth_showing = 0.01;  // MAC; a mode with less of it is no counterpart to a reader

/// "x 18 %, legs 82 %": platform directions that hold at least one per cent of the kinetic energy.
std::string motion_text(const modal::EnergyShares& energy) {
  std::string text;
  for (int d = 0; d < 6; ++d)
    if (energy.platform[d] >= 0.01)
      text +=
          fmt::format("{} {} %, ", direction_names[d], report::percent_text(energy.platform[d]));
  if (energy.base.sum() >= 0.01)
    text += fmt::format("base {} %, ", report::percent_text(energy.base.sum()));
  if (energy.payload >= 0.01)
    text += fmt::format("payload {} %, ", report::percent_text(energy.payload));
  return text + fmt::format("legs {} %", report::percent_text(energy.legs.sum()));
}

std::string signed_percent(double change) {
  const double value = 100.0 * change;
  if (std::abs(value) < 0.005) return "0.00 %";
  return fmt::format("{}{:.{}f} %", value < 0 ? "−" : "+", std::abs(value),
                     std::abs(value) < 10 ? 2 : 1);
}

bool repeats(const std::vector<modal::TabledMode>& modes, size_t k) {
  const auto same = [&](size_t j) { return modes[j].mode.group == modes[k].mode.group; };
  return (k > 0 && same(k - 1)) || (k + 1 < modes.size() && same(k + 1));
}

std::string number_text(const std::vector<modal::TabledMode>& modes, size_t k) {
  return fmt::format("{}{}", k + 1, repeats(modes, k) ? " =" : "  ");
}

std::string change_text(const modal::TabledMode& mode, const modal::ModeTable& before, int match) {
  if (match < 0) return "new";
  const double omega = before.real.modes[match].mode.omega;
  return omega > 0.0 ? signed_percent(mode.mode.omega / omega - 1.0) : "";
}

/// Without damping what rounding leaves has either sign.
std::string damping_text(double ratio) {
  constexpr double shown = 0.5e-4;  // below this two decimals of a per cent say 0.00
  return fmt::format("{:.2f} %", std::abs(ratio) < shown ? 0.0 : 100.0 * ratio);
}

/// `change`: the cell of the change by --set, where there is such a column.
std::vector<std::string> row(const modal::ModeTable& table, size_t k,
                             const std::optional<std::string>& change) {
  const auto& entry = table.real.modes[k];
  const auto& mode = entry.mode;
  std::vector<std::string> cells{number_text(table.real.modes, k), hertz(mode.omega),
                                 fmt::format("{:.3f}", mode.omega),
                                 damping_text(mode.damping_ratio)};
  if (change) cells.push_back(*change);
  cells.insert(cells.end(),
               {entry.label, motion_text(entry.energy), report::energy_text(entry.energy)});
  if (entry.rigid && entry.rigid->mac >= worth_showing) {
    const double rigid = table.rigid.modes[entry.rigid->mode].mode.omega;
    cells.push_back(hertz(rigid));
    cells.push_back(signed_percent(entry.rigid->shift));
    cells.push_back(fmt::format("{:.2f}", entry.rigid->mac));
  }
  return cells;
}

std::vector<Column> columns(const modal::ModeTable& table, bool with_change) {
  std::vector<Column> list{"mode", "Hz", "rad/s", "damping"};
  if (with_change) list.push_back("by --set");
  list.push_back("<motion, compliance");
  list.push_back("<kinetic energy");
  list.push_back("<elastic energy");
  if (table.kind == dynamics::ModelKind::rigid) return list;
  list.insert(list.end(), {"rigid Hz", "shift", "MAC"});
  return list;
}

/// The six rigid modes and where each of them went.
std::string rigid_text(const modal::ModeTable& table, const TableStyle& style) {
  Table text({"rigid", "Hz", "rad/s", "<motion", "<found in modes (MAC)"});
  for (size_t r = 0; r < table.rigid.modes.size(); ++r) {
    const auto& rigid = table.rigid.modes[r];
    std::string found;
    for (size_t k = 0; k < table.real.modes.size(); ++k) {
      const auto& entry = table.real.modes[k];
      if (!entry.rigid || entry.rigid->mode != static_cast<int>(r) ||
          entry.rigid->mac < worth_showing)
        continue;
      found += fmt::format("{}{} at {:.3f} Hz ({:.2f})", found.empty() ? "" : ", ", k + 1,
                           entry.mode.omega / two_pi, entry.rigid->mac);
    }
    text.add_row({number_text(table.rigid.modes, r), hertz(rigid.mode.omega),
                  fmt::format("{:.3f}", rigid.mode.omega), modal::platform_directions(rigid.energy),
                  found});
  }
  return text.text(style);
}

bool any_preload(const modal::ModeTable& table) {
  return std::any_of(table.real.modes.begin(), table.real.modes.end(),
                     [](const modal::TabledMode& m) { return m.energy.preload != 0.0; });
}

}  // namespace

std::string state_line(const model::MachineFile& file) {
  return fmt::format("machine: {}\n", report::state_text(file));
}

std::string place_text(const std::string& pose, double amplitude) {
  return amplitude > 0.0 ? fmt::format("{}, {:g} mm", pose, 1e3 * amplitude) : pose;
}

std::string frequencies_line(const model::Machine& machine) {
  return fmt::format("frequencies are those of {} modes\n", study::frequency_kind(machine));
}

std::string mechanics_state_line(const model::MachineFile& file) {
  return fmt::format("machine: {}\n", report::mechanics_state_text(file));
}

namespace {

/// The word "rigid" for the spring of a leg is a stiffness, and the frequencies against it are no
/// results.
std::string stand_in_text(const model::Machine& machine) {
  const bool rigid = std::ranges::all_of(machine.legs, [](const model::Leg& leg) {
    const double stiffness = leg.strut   ? leg.strut->stiffness
                             : leg.screw ? 0.0
                                         : leg.oil_spring.stiffness.value_or(0.0);
    return stiffness >= model::rigid_stiffness;
  });
  if (!rigid) return {};
  return fmt::format(
      "The legs are rigid along their axes: {:g} N/m or more stands for that, and frequencies of "
      "modes in which legs are compressed are those of this value\n",
      model::rigid_stiffness);
}

}  // namespace

std::string heading(const tasks::Machine& subject, const TableStyle& style) {
  constexpr std::array<const char*, 3> what{"rigid-leg model", "guide-sleeve model",
                                            "guide-sleeve and piston-ring model"};
  const auto& machine = subject.file.machine;
  const int modes = dynamics::degrees_of_freedom(machine, subject.kind);
  const int of_payload = static_cast<int>(machine.payload_modes.size());
  const int of_base = modes - dynamics::degrees_of_freedom(subject.kind) - of_payload;
  const std::string payload = of_payload > 0
                                  ? fmt::format(" ({} {} of the payload)", of_payload,
                                                of_payload == 1 ? "coordinate" : "coordinates")
                                  : "";
  const std::string base =
      of_base > 0 ? fmt::format(" ({} {} of the base)", of_base,
                                of_base == 1 ? "coordinate" : "coordinates")
      : machine.base_mount
          ? " (base and legs have no inertia: the mount is in series with the legs)"
          : "";
  return fmt::format("{}, pose {}: {}, {} modes{}{}\n{}{}; {} axes; damping: {}\n{}",
                     bold(machine.name, style), subject.pose.name,
                     what[static_cast<size_t>(subject.kind)], modes, base, payload,
                     mechanics_state_line(subject.file), report::gravity_text(machine),
                     machine.flexible_axes == model::FlexibleAxes::gimbal ? "gimbal" : "transverse",
                     report::damping_text(machine), stand_in_text(machine));
}

std::string mode_text(const modal::ModeTable& table, const modal::ModeTable* before,
                      const TableStyle& style) {
  Table text(columns(table, before != nullptr));
  const auto match = before ? modal::match_modes(table.real, before->real)
                            : std::vector<int>(table.real.modes.size());
  bool pairs = false;
  for (size_t k = 0; k < table.real.modes.size(); ++k) {
    std::optional<std::string> change;
    if (before) change = change_text(table.real.modes[k], *before, match[k]);
    text.add_row(row(table, k, change));
    pairs = pairs || repeats(table.real.modes, k);
  }
  std::string all = text.text(style);
  if (style.brief) return all;
  if (table.kind != dynamics::ModelKind::rigid) all += "\n" + rigid_text(table, style);
  if (pairs)
    all +=
        "\n= repeated frequency: any combination of these modes is a mode; shown are the "
        "combinations along the axes";
  if (any_preload(table))
    all += "\nelastic energy is that of the springs; the compression of the legs reduces the total";
  return all + "\nHz and rad/s: " + damped_frequencies;
}

std::string mode_csv(const modal::ModeTable& table) {
  std::string text =
      "mode,omega_rad_s,frequency_hz,damping_ratio,stable,moves_platform,group,label,"
      "kinetic_x,kinetic_y,kinetic_z,kinetic_rx,kinetic_ry,kinetic_rz,kinetic_legs,"
      "elastic_oil,elastic_guide_sleeve,elastic_piston_ring,preload,"
      "rigid_mode,rigid_omega_rad_s,rigid_mac,rigid_shift_percent,kinetic_base,elastic_base_"
      "mount";
  const bool payload = table.real.linear.payload_count() > 0;
  const bool bends = std::ranges::any_of(table.real.modes, [](const modal::TabledMode& mode) {
    return !mode.energy.bending.isZero(0.0);
  });
  if (payload) text += ",kinetic_payload,elastic_payload";
  text += bends ? ",elastic_bending\n" : "\n";
  for (size_t k = 0; k < table.real.modes.size(); ++k) {
    const auto& entry = table.real.modes[k];
    const auto& energy = entry.energy;
    text += fmt::format("{},{:.17g},{:.17g},{:.17g},{},{},{},\"{}\"", k + 1, entry.mode.omega,
                        entry.mode.omega / two_pi, entry.mode.damping_ratio, entry.mode.stable,
                        entry.moves_platform, entry.mode.group, entry.label);
    for (int d = 0; d < 6; ++d) text += fmt::format(",{:.17g}", energy.platform[d]);
    text +=
        fmt::format(",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}", energy.legs.sum(), energy.oil.sum(),
                    energy.guide_sleeve.sum(), energy.piston_ring.sum(), energy.preload);
    if (entry.rigid)
      text += fmt::format(",{},{:.17g},{:.17g},{:.17g}", entry.rigid->mode + 1,
                          table.rigid.modes[entry.rigid->mode].mode.omega, entry.rigid->mac,
                          100.0 * entry.rigid->shift);
    else
      text += ",,,,";
    text += fmt::format(",{:.17g},{:.17g}", energy.base.sum(), energy.base_mount);
    if (payload) text += fmt::format(",{:.17g},{:.17g}", energy.payload, energy.payload_elastic);
    text += bends ? fmt::format(",{:.17g}\n", energy.bending.sum()) : "\n";
  }
  return text;
}

}  // namespace hydrapod::cli
