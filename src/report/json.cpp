#include "hydrapod/report/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fields.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using spatial::direction_names;

/// Keys on which the damping of chambers depends and which the file leaves open.
std::string assumed_keys(const model::Machine& machine) {
  std::string keys;
  const auto assumed = hydraulics::hydraulic_assumptions(machine);
  for (const std::string_view key :
       {"equivalent_cylinder", "valve.rated_flow", "valve.leakage", "leakage.internal"})
    if (std::ranges::any_of(assumed, [&](const auto& one) { return one.key.ends_with(key); }))
      keys += (keys.empty() ? "" : ", ") + std::string(key);
  return keys;
}
}  // namespace

std::string damping_text(const model::Machine& machine) {
  if (model::has_chambers(machine)) {
    std::string text = plant_damping_text(machine) + "; two chambers per leg, valves at rest";
    if (const auto keys = assumed_keys(machine); !keys.empty())
      text += "; assumed, as the file does not say: " + keys + " (values: hydrapod check)";
    if (std::ranges::any_of(machine.legs, [](const model::Leg& leg) {
          return leg.hydraulics.joint_friction.viscous != 0.0;
        }))
      text += "; without the friction of the joints";
    return text;
  }
  const auto ratio = modal::modal_ratio(machine);
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : " + ") + part; };
  if (ratio.value > 0.0)
    add(fmt::format("{:.3g} % of critical in every mode", 100.0 * ratio.value));
  if (model::has_leg_dampers(machine)) add("viscous dampers of the legs");
  if (model::has_elastomers(machine)) add("loss factors of the elastomer seals");
  const auto& damping = machine.damping;
  if (model::has_rayleigh_damping(machine))
    add(fmt::format("Rayleigh α = {:.3g} 1/s, β = {:.3g} s", damping.rayleigh_mass,
                    damping.rayleigh_stiffness));
  const bool payload = std::ranges::any_of(
      machine.payload_modes, [](const auto& mode) { return mode.damping_ratio != 0.0; });
  const bool none = text.empty();
  if (none) text = payload ? "modes of the payload by their damping ratios" : "none";
  if (ratio.is_default) text += " (default: the machine file states no damping)";
  if (payload && !none) text += "; modes of the payload also by their damping ratios";
  const auto any = [&](auto states) {
    return std::ranges::any_of(machine.legs,
                               [&](const model::Leg& leg) { return states(leg.hydraulics); });
  };
  const bool leakage = any([](const auto& of) {
    return of.leakage.internal || of.leakage.external != 0.0 || of.valve.leakage;
  });
  const bool valves = any([](const auto& of) { return of.valve.rated_flow.has_value(); });
  if (leakage || valves)
    text +=
        fmt::format("; the {} in the file is not used here (damping.oil = \"chambers\" uses it)",
                    leakage ? "leakage" : "flow of the valves");
  return text;
}

std::string plant_damping_text(const model::Machine& machine, bool hydraulics) {
  const auto any = [&](auto damper) { return std::ranges::any_of(machine.legs, damper); };
  const auto ratio = model::seal_ratio(machine);
  std::string seals, springs;
  const auto add_to = [](std::string& list, const std::string& part) {
    list += (list.empty() ? "" : " + ") + part;
  };
  const auto add = [&](const std::string& part) { add_to(seals, part); };
  if (any([](const model::Leg& leg) {
        return leg.guide_sleeve.damping != 0.0 ||
               (leg.piston_ring && leg.piston_ring->damping != 0.0);
      }))
    add("their dampers");
  if (ratio.value > 0.0)
    add(fmt::format("{:.3g} % of critical{}", 100.0 * ratio.value,
                    ratio.is_default ? " (default: the machine file states no damping)" : ""));
  if (model::has_elastomers(machine)) add("the loss of their elastomers");
  const bool oil = any([](const model::Leg& leg) { return leg.oil_spring.damping != 0.0; });
  if (oil) add_to(springs, "their dampers");
  if (machine.damping.rayleigh_stiffness != 0.0) {
    const auto beta = fmt::format("Rayleigh β = {:.3g} s", machine.damping.rayleigh_stiffness);
    add(beta);
    add_to(springs, beta);
  }
  const auto type = model::leg_type(machine);
  if (any([](const model::Leg& leg) {
        return (leg.strut && leg.strut->damping != 0.0) || (leg.screw && leg.screw->damping != 0.0);
      }))
    springs = springs.empty() ? "their dampers" : "their dampers + " + springs;
  const auto springs_text = springs.empty() ? std::string("nothing") : springs;
  const auto motors =
      type == model::LegType::screw && hydraulics ? "; motors by friction and speed loops" : "";
  std::string text = type != model::LegType::cylinder
                         ? fmt::format("{} by {}{}", model::axial_part(type), springs_text, motors)
                     : !hydraulics ? "oil springs by " + springs_text
                     : oil
                         ? "oil by leakage, valves and friction (in place of `oil_spring.damping`)"
                         : "oil by leakage, valves and friction";
  if (type != model::LegType::strut) text += "; seals by " + (seals.empty() ? "nothing" : seals);
  if (machine.base_mount && ratio.value > 0.0)
    text += fmt::format("; base mount by {:.3g} % of critical", 100.0 * ratio.value);
  if (!machine.payload_modes.empty()) {
    text += "; modes of the payload by their damping ratios";
    if (ratio.value > 0.0) text += fmt::format(" + {:.3g} % of critical", 100.0 * ratio.value);
  }
  if (machine.damping.rayleigh_mass != 0.0)
    text += fmt::format("; all masses by Rayleigh α = {:.3g} 1/s", machine.damping.rayleigh_mass);
  return text;
}

std::string gravity_text(const model::Machine& machine) {
  const auto& g = machine.gravity;
  if (g.isZero(0.0)) return "no gravity";
  if (g.x() == 0.0 && g.y() == 0.0 && g.z() < 0.0)
    return fmt::format("gravity {:.6g} m/s² downwards", -g.z());
  return fmt::format("gravity ({:.5g}, {:.5g}, {:.5g}) m/s²", g.x(), g.y(), g.z());
}

std::string state_text(const model::MachineFile& file) {
  constexpr std::size_t most = 4;
  const auto& overrides = file.overrides;
  std::string text = file.machine.state.empty() ? "nominal" : file.machine.state;
  for (std::size_t k = 0; k < std::min(most, overrides.size()); ++k)
    text += (k == 0 ? ", with " : "; ") + overrides[k];
  if (overrides.size() > most) text += fmt::format("; and {} more", overrides.size() - most);
  if (model::leg_type(file.machine) == model::LegType::strut)
    text += "; the legs are plain struts: results are of the rigid-leg model";
  if (model::leg_type(file.machine) == model::LegType::screw)
    text += "; the legs are electric cylinders";
  return text;
}

std::string mechanics_state_text(const model::MachineFile& file) {
  const bool screws = model::leg_type(file.machine) == model::LegType::screw;
  return state_text(file) + (screws ? ": mechanics with locked motors" : "");
}

Json machine_json(const model::MachineFile& file, const std::string& path) {
  return {{"name", file.machine.name},
          {"description", file.machine.description},
          {"source", file.machine.source},
          {"state", state_text(file)},
          {"file", path},
          {"overrides", file.overrides}};
}

Json assumptions_json(const model::Machine& machine) {
  const auto ratio = modal::modal_ratio(machine);
  return {{"hydrapod", base::version},
          {"gravity_m_s2", written(machine.gravity)},
          {"gravity", gravity_text(machine)},
          {"flexible_axes",
           machine.flexible_axes == model::FlexibleAxes::gimbal ? "gimbal" : "transverse"},
          {"damping", damping_text(machine)},
          {"damping_with_hydraulics", plant_damping_text(machine)},
          {"modal_ratio", ratio.value},
          {"modal_ratio_is_default", ratio.is_default}};
}

Json head_json(const char* kind, const model::MachineFile& file, const std::string& path) {
  return {{"kind", kind},
          {"machine", machine_json(file, path)},
          {"assumptions", assumptions_json(file.machine)}};
}

Json head_json(const char* kind, const Subject& subject) {
  Json json = head_json(kind, subject.file, subject.path);
  json["pose"] = pose_json(subject.pose);
  return json;
}

Json pose_json(const model::NamedPose& pose) { return written(pose); }

model::NamedPose pose_from_json(const Json& json, const std::string& file) {
  model::NamedPose pose;
  Reader(json, file)("pose", pose);
  return pose;
}

template <class Fields>
void describe(Fields& f, modal::EnergyShares& energy) {
  f.derived("oil", energy.oil.sum());
  f.derived("guide_sleeve", energy.guide_sleeve.sum());
  f.derived("piston_ring", energy.piston_ring.sum());
  f("preload", energy.preload);
  describe_axial_part(f, energy.leg_type);
  f.object("per_leg", [&](auto& leg) {
    leg("oil", energy.oil);
    leg("guide_sleeve", energy.guide_sleeve);
    leg("piston_ring", energy.piston_ring);
    leg.unless(spatial::Vector6(spatial::Vector6::Zero()), "bending", energy.bending);
  });
  if (!energy.bending.isZero(0.0)) f.derived("bending", energy.bending.sum());
  f.unless(0.0, "base_mount", energy.base_mount);
  f.unless(0.0, "payload", energy.payload_elastic);
}

template <class Fields>
void describe(Fields& f, modal::RigidCounterpart& rigid) {
  f.counted("mode", rigid.mode);
  f.derived("omega_rad_s", 0.0);  // modes_json() knows it
  f("mac", rigid.mac);
  f.percent("shift_percent", rigid.shift);
}

template <class Fields>
void describe(Fields& f, modal::TabledMode& entry) {
  auto& mode = entry.mode;
  f.derived("number", 0);  // modes_json() knows it
  f("omega_rad_s", mode.omega);
  f.derived("frequency_hz", mode.omega / base::two_pi);
  f("damping_ratio", mode.damping_ratio);
  f("pole", mode.pole);
  f("stable", mode.stable);
  f("label", entry.label);
  f("moves_platform", entry.moves_platform);
  f("group", mode.group);
  f("platform_energy", entry.energy.platform);
  f("leg_energy", entry.energy.legs);
  f.unless(spatial::Vector6(spatial::Vector6::Zero()), "base_energy", entry.energy.base);
  f.unless(0.0, "payload_energy", entry.energy.payload);
  f("strain_energy", entry.energy);
  f("shape", mode.real);
  if (Fields::reads) mode.imaginary = modal::ModelVector::Zero(mode.real.size());
  if (mode.is_complex() || f.has("shape_imaginary")) f("shape_imaginary", mode.imaginary);
  f.optional("rigid", entry.rigid);
}

template <class Fields>
void describe(Fields& f, modal::ModeTable& table) {
  f.word("model", table.kind, model_words);
  const auto& linear = table.real.linear;
  f.derived("coordinates",
            dynamics::coordinate_names(table.kind, linear.base_directions, linear.payload_names));
  f("modes", table.real.modes);
  f("rigid_modes", table.rigid.modes);
}

Json modes_json(const modal::ModeTable& table) {
  Json json = written(table);
  for (auto* list : {&json["modes"], &json["rigid_modes"]})
    for (std::size_t k = 0; k < list->size(); ++k) {
      auto& mode = (*list)[k];
      mode["number"] = k + 1;
      if (!mode.contains("rigid")) continue;
      const int rigid = mode["rigid"]["mode"].get<int>() - 1;
      mode["rigid"]["omega_rad_s"] = table.rigid.modes[static_cast<std::size_t>(rigid)].mode.omega;
    }
  return json;
}

namespace {

/// Shapes must be those of the model, and counterparts must be there.
void require_whole(const Reader& fields, const char* key, std::size_t coordinates,
                   std::size_t rigid_modes, const std::vector<modal::TabledMode>& modes) {
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto& [mode, energy, moves, label, rigid] = modes[k];
    const auto at = [&](const char* field) { return fmt::format("{}[{}].{}", key, k, field); };
    const auto size = static_cast<Eigen::Index>(coordinates);
    if (mode.real.size() != size)
      fields.bad(at("shape"), fmt::format("expected {} numbers", coordinates));
    if (mode.imaginary.size() != size)
      fields.bad(at("shape_imaginary"), fmt::format("expected {} numbers", coordinates));
    if (rigid && static_cast<std::size_t>(rigid->mode) >= rigid_modes)
      fields.bad(at("rigid.mode"), fmt::format("there are {} rigid modes", rigid_modes));
  }
}

}  // namespace

namespace {

std::vector<std::string> coordinates_in(const Reader& fields) {
  std::vector<std::string> names;
  if (fields.has("coordinates")) fields("coordinates", names);
  return names;
}

/// Directions of the base among the coordinates, behind those of the legs.
std::vector<int> base_directions(const std::vector<std::string>& names) {
  std::vector<int> directions;
  for (const auto& name : names)
    for (int k = 0; k < 6; ++k)
      if (name == fmt::format("base.{}", spatial::direction_name(k)) &&
          (directions.empty() || directions.back() < k))
        directions.push_back(k);
  return directions;
}

/// Modes of the payload among the coordinates, the last of them.
std::vector<std::string> payload_names(const std::vector<std::string>& names) {
  constexpr std::string_view front = "payload.";
  std::vector<std::string> modes;
  for (const auto& name : names)
    if (name.starts_with(front) && modes.size() < model::most_payload_modes)
      modes.push_back(name.substr(front.size()));
  return modes;
}

}  // namespace

modal::ModeTable modes_from_json(const Json& json, const std::string& file) {
  auto table = read<modal::ModeTable>(json, file);
  const Reader fields(json, file);
  const std::size_t rigid_modes = table.rigid.modes.size();
  const auto names = coordinates_in(fields);
  const auto base = base_directions(names);
  const auto payload = payload_names(names);
  table.real.linear.base_directions = table.rigid.linear.base_directions = base;
  table.real.linear.payload_names = table.rigid.linear.payload_names = payload;
  const auto count = [&](dynamics::ModelKind kind) {
    return dynamics::coordinate_names(kind, base, payload).size();
  };
  require_whole(fields, "modes", count(table.kind), rigid_modes, table.real.modes);
  require_whole(fields, "rigid_modes", count(dynamics::ModelKind::rigid), rigid_modes,
                table.rigid.modes);
  return table;
}

template <class Fields>
void describe(Fields& f, modal::LinearModel& model) {
  f("M", model.M);
  f("K", model.K);
  f("C", model.C);
}

Json matrices_json(const modal::ModeTable& table) {
  Json json = written(table.real.linear);
  json["rigid"] = written(table.rigid.linear);
  const auto add_arms = [](const modal::LinearModel& model, Json& to) {
    for (const auto& arm : model.arms) {
      Json entry{{"leg", arm.leg + 1},
                 {"stiffness_N_m", arm.stiffness},
                 {"rate_1_s", arm.rate},
                 {"extension", written(arm.s_y)}};
      if (arm.what == dynamics::Relaxing::oil) {
        to["oil_arms"].push_back(std::move(entry));
        continue;
      }
      entry["seal"] = arm.what == dynamics::Relaxing::sleeve ? "guide_sleeve" : "piston_ring";
      to["seal_arms"].push_back(std::move(entry));
    }
  };
  add_arms(table.real.linear, json);
  add_arms(table.rigid.linear, json["rigid"]);
  return json;
}

}  // namespace hydrapod::report
