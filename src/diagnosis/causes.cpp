#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cause_parts.hpp"
#include "evidence.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::diagnosis {

namespace {

using causes::all_and_each;
using causes::change;
using causes::index_with;
using causes::Leg;
using causes::leg_of;
using causes::leg_path;
using causes::leg_with;
using causes::near;
using causes::within;

/// For all legs the first with chambers, where there is one.
const model::Leg& oil_leg(const model::MachineFile& file, Leg leg) {
  return leg_with(file, leg, "oil_spring.cylinder.bulk_modulus");
}

/// Path below a leg and value of the number that scales the oil spring.
std::pair<const char*, double> spring_number(const model::Leg& leg) {
  if (leg.oil_spring.cylinder)
    return {"oil_spring.cylinder.bulk_modulus", leg.oil_spring.cylinder->bulk_modulus};
  return {"oil_spring.stiffness", leg.oil_spring.stiffness.value_or(0.0)};
}

/// Air in all legs; where the file has none, from next to nothing, at a usual chamber pressure.
Cause entrained_air(const model::MachineFile& file) {
  const std::string key = "oil_spring.cylinder.air.fraction";
  const auto& cylinder = *leg_with(file, {}, key).oil_spring.cylinder;
  constexpr double least = 1e-4, most = 0.25, usual_pressure = 4e6;
  const auto path = leg_path({}, key);
  Cause air{Cause::Kind::air};
  double fraction = 1e-3;
  if (cylinder.air && cylinder.air->fraction > least) fraction = cylinder.air->fraction;
  if (!cylinder.air)
    air.changes = {change(file, "legs.oil_spring.cylinder.air.pressure", usual_pressure),
                   change(file, path, fraction)};
  air.free = {
      {.paths = {path}, .start = fraction, .lower = least, .upper = std::max(most, fraction)}};
  return air;
}

/// More oil behind the piston than stated, on one side: dead volume or line, which the linear
/// models do not tell apart.
void add_volume(const model::MachineFile& file, Cause::Kind side, Leg leg,
                std::vector<Cause>& all) {
  const bool cap = side == Cause::Kind::cap_volume;
  const auto key = fmt::format("oil_spring.cylinder.{}_line_volume", cap ? "cap" : "rod");
  const auto& of = leg_with(file, leg, key);
  if (!of.oil_spring.cylinder || !of.stroke) return;
  const auto& cylinder = *of.oil_spring.cylinder;
  const double stated = cap ? cylinder.cap_line_volume : cylinder.rod_line_volume;
  const double area = 0.25 * std::numbers::pi * cylinder.bore * cylinder.bore;
  const double swept = area * of.stroke->length;
  const double start = std::max(stated, 0.01 * swept);
  const auto path = leg_path(leg, key);
  Cause cause{side, leg};
  if (start != stated) cause.changes = {change(file, path, start)};
  cause.free = {
      {.paths = {path}, .start = start, .lower = 1e-4 * swept, .upper = 5.0 * swept + stated}};
  all.push_back(cause);
}

/// Plain struts, or screws of electric cylinders, softer or stiffer than stated.
void add_struts_and_screws(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double factor = 5.0;
  const std::string of_strut = "strut.stiffness", of_screw = "screw.stiffness";
  for (const auto leg : all_and_each) {
    if (const auto& strut = leg_with(file, leg, of_strut).strut)
      all.push_back(
          {Cause::Kind::struts, leg, {within(leg_path(leg, of_strut), strut->stiffness, factor)}});
    if (const auto& screw = leg_with(file, leg, of_screw).screw)
      all.push_back(
          {Cause::Kind::screws, leg, {within(leg_path(leg, of_screw), screw->stiffness, factor)}});
  }
}

/// The oil as a spring: bulk modulus, entrained air, volumes of chambers and lines.
void add_oil(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double factor = 5.0;
  if (model::leg_type(file.machine) != model::LegType::cylinder) return;
  const auto& cylinder = oil_leg(file, {}).oil_spring.cylinder;
  for (const auto leg : all_and_each) {
    const auto& of = cylinder ? oil_leg(file, leg) : leg_with(file, leg, "oil_spring.stiffness");
    const auto [path, stated] = spring_number(of);
    all.push_back({!leg && cylinder ? Cause::Kind::bulk_modulus : Cause::Kind::oil_springs,
                   leg,
                   {within(leg_path(leg, path), stated, factor)}});
  }
  if (!cylinder) return;
  const auto has_air_alike = [&](const auto& leg) {
    const auto& own = leg.oil_spring.cylinder;
    return own && own->air.has_value() == cylinder->air.has_value();
  };
  if (std::ranges::all_of(file.machine.legs, has_air_alike)) all.push_back(entrained_air(file));
  if (cylinder->volumes == model::VolumeRule::equal) return;
  for (const auto side : {Cause::Kind::cap_volume, Cause::Kind::rod_volume})
    for (const auto leg : all_and_each) add_volume(file, side, leg, all);
}

/// Gimbals and their fastening, which are compliant along the legs or have play; play shows as a
/// softer spring, the softer the smaller the motion.
void add_gimbals(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double stiff = 30.0, factor = 1000.0;
  const auto lengths = kinematics::leg_lengths(file.machine, file.machine.neutral());
  const std::string key = "gimbal_stiffness";
  for (const auto leg : all_and_each) {
    const int number = index_with(file, leg, key);
    const auto& of = leg_of(file, number);
    const double l_m = lengths[number] - of.rod.length;
    const double k = of.gimbal_stiffness.value_or(stiff * hydraulics::oil_stiffness(of, l_m));
    const auto path = leg_path(leg, key);
    Cause cause{Cause::Kind::gimbals, leg, {within(path, k, factor)}};
    if (!of.gimbal_stiffness) cause.changes = {change(file, path, k)};
    all.push_back(cause);
  }
}

/// Seals of the cylinders that do not slide at the measured amplitude: their bristles are a spring
/// beside the oil, which makes the leg stiffer at every extension alike. It is no stiffer than what
/// friction can be over the way on which it builds up: presliding displacements of seals and other
/// dry contacts are 5 to 50 µm. Where a part of the bristles slides, it is any softer.
void add_sticking_seals(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double shortest_way = 5e-6;         // [m]
  constexpr double most_friction = 0.05;        // of A_p p_s; with O-rings 0.01
  constexpr double least = 1e-4, start = 0.01;  // of the oil spring
  if (model::leg_type(file.machine) != model::LegType::cylinder) return;
  const auto lengths = kinematics::leg_lengths(file.machine, file.machine.neutral());
  const std::string key = "stick_stiffness";
  for (const auto leg : all_and_each) {
    const int number = index_with(file, leg, key);
    const auto& of = leg_of(file, number);
    const auto axis = hydraulics::servo_axis(file.machine, number);
    const double force =
        std::max(axis.friction.breakaway,
                 most_friction * axis.area.piston * file.machine.hydraulics.supply.pressure);
    const double k_h = hydraulics::oil_stiffness(of, lengths[number] - of.rod.length);
    const double stated = of.stick_stiffness, begin = stated > 0.0 ? stated : start * k_h;
    const auto path = leg_path(leg, key);
    Cause cause{Cause::Kind::sticking_seals,
                leg,
                {{.paths = {path},
                  .start = begin,
                  .lower = std::min(begin, least * k_h),
                  .upper = std::max(begin, force / shortest_way)}}};
    if (begin != stated) cause.changes = {change(file, path, begin)};
    all.push_back(cause);
  }
}

/// The platform and what stands on it.
void add_platform(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double most = 3.0;
  const auto& platform = file.machine.platform;
  const auto& I = platform.inertia;
  const auto mass = within("platform.mass", platform.mass, most);
  const std::vector moments{within("platform.inertia.xx", I(0, 0), most),
                            within("platform.inertia.yy", I(1, 1), most),
                            within("platform.inertia.zz", I(2, 2), most)};
  auto both = moments;
  both.insert(both.begin(), mass);
  // a radius of gyration to every side
  const double reach = std::sqrt(I.trace() / (3.0 * platform.mass));
  std::vector<calibration::FreeParameter> center;
  for (int k = 0; k < 3; ++k)
    center.push_back(
        near(fmt::format("platform.mass_center[{}]", k), platform.mass_center[k], reach));
  all.push_back({Cause::Kind::payload, {}, {mass}});
  // a payload raises the centre with the mass, and where there is gravity presses on the knees
  all.push_back({Cause::Kind::payload_height, {}, {mass, center[2]}});
  all.push_back({Cause::Kind::inertia, {}, moments});
  all.push_back({Cause::Kind::mass_and_inertia, {}, both});
  all.push_back({Cause::Kind::mass_center, {}, center});
}

/// The base on its foundation: pushed sideways, pressed down, rocking.
void add_base(const model::MachineFile& file, std::vector<Cause>& all) {
  struct Way {
    Cause::Kind kind{};
    std::vector<int> directions{};
  };
  constexpr double stiff = 50.0, factor = 500.0;
  const auto& machine = file.machine;
  const auto model = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::rigid);
  // what the legs hold the platform with, seen at the base
  spatial::Matrix6 T = spatial::Matrix6::Identity();
  T.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
  const spatial::Matrix6 K = model.K.topLeftCorner<6, 6>();
  const spatial::Vector6 of_legs = (T.transpose() * K * T).diagonal();
  for (const auto& [kind, directions] :
       {Way{Cause::Kind::base_lateral, {0, 1}}, Way{Cause::Kind::base_vertical, {2}},
        Way{Cause::Kind::base_rocking, {3, 4}}}) {
    Cause cause{kind};
    for (const int direction : directions) {
      std::optional<double> stated;
      if (machine.base_mount)
        stated = machine.base_mount->stiffness[static_cast<std::size_t>(direction)];
      const double value = stated.value_or(stiff * std::abs(of_legs[directions.front()]));
      const auto path = std::string("base.mount.stiffness.") + direction_name(direction);
      if (!stated) cause.changes.push_back(change(file, path, value));
      if (cause.free.empty())
        cause.free.push_back(within(path, value, factor));
      else
        cause.free.front().paths.push_back(path);
    }
    all.push_back(cause);
  }
}

/// Oil that swings in the lines with the pistons: inertia along the legs. Lines that end at closed
/// valves have little (hydraulics::line_inertia); those with an open end move as a whole.
void add_oil_lines(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double least = 1e-4, most = 0.5;  // of the platform's mass, per leg
  if (model::leg_type(file.machine) != model::LegType::cylinder) return;
  const double mass = file.machine.platform.mass;
  const std::string key = "added_axial_inertia";
  for (const auto leg : all_and_each) {
    const auto path = leg_path(leg, key);
    const double stated = leg_with(file, leg, key).added_axial_inertia;
    const double start = std::max(stated, 10.0 * least * mass);
    Cause cause{Cause::Kind::oil_lines, leg};
    if (start != stated) cause.changes = {change(file, path, start)};
    cause.free = {{.paths = {path},
                   .start = start,
                   .lower = least * mass,
                   .upper = std::max(most * mass, start)}};
    all.push_back(cause);
  }
}

/// Worn piston seals: damping that falls with the frequency. Without chambers leakage is not in the
/// modes.
void add_leakage(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double tighter = 30.0, worn = 1000.0;
  if (!model::has_chambers(file.machine)) return;
  const std::string key = "leakage.internal";
  for (const auto leg : all_and_each) {
    const int number = index_with(file, leg, key);
    const double resolved = hydraulics::servo_axis(file.machine, number).internal_leakage;
    if (!(resolved > 0.0)) continue;
    const auto path = leg_path(leg, key);
    Cause cause{Cause::Kind::leakage,
                leg,
                {{.paths = {path},
                  .start = resolved,
                  .lower = resolved / tighter,
                  .upper = resolved * worn}}};
    if (!leg_of(file, number).hydraulics.leakage.internal)
      cause.changes = {change(file, path, resolved)};
    all.push_back(cause);
  }
}

/// A payload that the file has as rigid: a part of its mass swings at the mass centre. Stated
/// modes: at other frequencies.
void add_payload_modes(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double factor = 4.0;
  const auto& machine = file.machine;
  if (!machine.payload_modes.empty()) {
    Cause cause{Cause::Kind::payload_modes};
    for (const auto& mode : machine.payload_modes)
      cause.free.push_back(
          within(fmt::format("payload_modes.{}.frequency", model::written_key(mode.name)),
                 mode.frequency, factor));
    all.push_back(cause);
    return;
  }
  constexpr double start = 0.2, least = 0.01, most = 0.9;      // of the platform's mass
  constexpr double above = 2.0, lowest = 0.4, highest = 40.0;  // of the lowest rigid frequency
  const auto rigid_modes = modal::normal_modes(dynamics::linear_model(
      without_mount_and_gimbals(machine), machine.neutral(), dynamics::ModelKind::rigid));
  const double mass = machine.platform.mass, lowest_hz = rigid_modes.omega(0) / base::two_pi;
  for (const auto& [kind, directions] : {std::pair{Cause::Kind::payload_sways, std::vector{0, 1}},
                                         std::pair{Cause::Kind::payload_heaves, std::vector{2}}}) {
    Cause cause{kind};
    cause.free = {
        {.start = start * mass, .lower = least * mass, .upper = most * mass},
        {.start = above * lowest_hz, .lower = lowest * lowest_hz, .upper = highest * lowest_hz}};
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const auto path = [&](const std::string& key) {
        return fmt::format("payload_modes.mode_{}.{}", k + 1, key);
      };
      for (int i = 0; i < 3; ++i) {
        cause.changes.push_back(
            change(file, path(fmt::format("position[{}]", i)), machine.platform.mass_center[i]));
        cause.changes.push_back(
            change(file, path(fmt::format("direction[{}]", i)), i == directions[k] ? 1.0 : 0.0));
      }
      cause.changes.push_back(change(file, path("mass"), start * mass));
      cause.changes.push_back(change(file, path("frequency"), above * lowest_hz));
      cause.free[0].paths.push_back(path("mass"));
      cause.free[1].paths.push_back(path("frequency"));
    }
    all.push_back(cause);
  }
}

/// Rods that bend more than stated: thinner, or weakened where they are fastened. The diameter
/// stands for the stiffness E I, of a solid rod as its fourth power.
void add_bending(const model::MachineFile& file, std::vector<Cause>& all) {
  // half the diameter of a solid rod has a sixteenth of the stiffness; rods are rarely
  // thicker than drawn
  constexpr double thinner = 0.5, thicker = 1.25, clearance = 1.02;
  const std::string key = "rod.diameter";
  for (const auto leg : all_and_each) {
    const auto& of = leg_with(file, leg, key);
    if (of.bending != model::LegBending::elastic) continue;
    const double stated = model::rod_diameter(of).value();
    double lower = thinner * stated, upper = thicker * stated;
    if (of.rod.wall) lower = std::max(lower, std::min(stated, 2.0 * clearance * *of.rod.wall));
    if (const auto& cylinder = of.oil_spring.cylinder)
      upper = std::min(upper, std::max(stated, cylinder->bore / clearance));
    const auto path = leg_path(leg, key);
    Cause cause{Cause::Kind::rods_bend,
                leg,
                {{.paths = {path}, .start = stated, .lower = lower, .upper = upper}}};
    if (!of.rod.diameter) cause.changes = {change(file, path, stated)};
    all.push_back(cause);
  }
}

/// One number for all legs is that of each leg where the file states it for each of them.
std::vector<std::string> paths_in_file(const model::MachineFile& file,
                                       const std::vector<std::string>& paths) {
  constexpr std::string_view of_all = "legs.";
  std::vector<std::string> found;
  for (const auto& path : paths) {
    if (!path.starts_with(of_all) || find_parameter(file, path) ||
        !find_parameter(file.machine, path)) {
      found.push_back(path);
      continue;
    }
    for (int leg = 0; leg < model::leg_count; ++leg)
      found.push_back(leg_path(leg, path.substr(of_all.size())));
  }
  return found;
}

}  // namespace

std::vector<Cause> causes_of(const model::MachineFile& file) {
  std::vector<Cause> all;
  for (const auto add :
       {add_struts_and_screws, causes::add_guide_sleeves, causes::add_piston_rings, add_oil,
        add_gimbals, add_sticking_seals, add_platform, add_base, add_oil_lines, add_leakage,
        add_payload_modes, add_bending, causes::add_guide_clearance, causes::add_elastomers})
    add(file, all);
  for (auto& cause : all)
    for (auto& free : cause.free) free.paths = paths_in_file(file, free.paths);
  return all;
}

}  // namespace hydrapod::diagnosis
