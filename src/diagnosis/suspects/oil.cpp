// The oil as a spring: bulk modulus, entrained air, volumes of chambers and lines.
#include "around.hpp"

namespace hydrapod::diagnosis {

namespace {

constexpr double factor = 5.0;

/// Path below a leg and value of the number that scales the oil spring.
std::pair<const char*, double> spring_number(const model::Leg& leg) {
  if (leg.oil_spring.cylinder)
    return {"oil_spring.cylinder.bulk_modulus", leg.oil_spring.cylinder->bulk_modulus};
  return {"oil_spring.stiffness", leg.oil_spring.stiffness.value_or(0.0)};
}

/// Air in all legs; where the file has none, from next to nothing, at a usual chamber pressure.
Suspect entrained_air(const model::MachineFile& file) {
  const auto& cylinder = *file.machine.legs[0].oil_spring.cylinder;
  constexpr double least = 1e-4, most = 0.25, usual_pressure = 4e6;
  Suspect air{.name = "entrained air in all legs",
              .statement = "the air content of the oil of all legs differs from the nominal value",
              .family = "leg axes",
              .in_pairs = false};
  double fraction = 1e-3;
  if (cylinder.air && cylinder.air->fraction > least) fraction = cylinder.air->fraction;
  if (!cylinder.air)
    air.changes = {change(file, "legs.oil_spring.cylinder.air.pressure", usual_pressure),
                   change(file, "legs.oil_spring.cylinder.air.fraction", fraction)};
  air.free = {{.paths = {"legs.oil_spring.cylinder.air.fraction"},
               .start = fraction,
               .lower = least,
               .upper = most}};
  return air;
}

/// More oil behind the piston than stated, on one side: dead volume or line, which the linear
/// models do not tell apart.
Suspect volume(const model::MachineFile& file, const char* side, int leg) {
  const auto& of = file.machine.legs[static_cast<std::size_t>(std::max(leg, 0))];
  const auto& cylinder = *of.oil_spring.cylinder;
  const bool cap = std::string(side) == "cap";
  const double stated = cap ? cylinder.cap_line_volume : cylinder.rod_line_volume;
  const double area = 0.25 * std::numbers::pi * cylinder.bore * cylinder.bore;
  const double swept = area * of.stroke->length;
  const std::string rest = fmt::format("oil_spring.cylinder.{}_line_volume", side);
  const std::string whose = leg < 0 ? "all legs" : fmt::format("leg {}", leg + 1);
  Suspect suspect{
      .name = fmt::format("{}-side chamber or line volume of {}", side, whose),
      .statement = fmt::format("the oil volume on the {} side of {} differs from the nominal value",
                               side, whose),
      .family = "leg axes",
      .in_pairs = false};
  if (leg >= 0) suspect.leg = leg;
  const double start = std::max(stated, 0.01 * swept);
  const std::string path = leg < 0 ? "legs." + rest : leg_path(leg, rest.c_str());
  if (start != stated) suspect.changes = {change(file, path, start)};
  suspect.free = {
      {.paths = {path}, .start = start, .lower = 1e-4 * swept, .upper = 5.0 * swept + stated}};
  return suspect;
}

}  // namespace

std::vector<Suspect> oil(const model::MachineFile& file) {
  const auto& first = file.machine.legs[0];
  const auto [path, value] = spring_number(first);
  const bool from_modulus = first.oil_spring.cylinder.has_value();
  std::vector<Suspect> suspects{
      {.name = from_modulus ? "bulk modulus of the oil" : "oil springs of all legs",
       .statement = "the oil stiffness of all legs differs from the nominal value",
       .family = "leg axes",
       .free = {within(std::string("legs.") + path, value, factor)}}};
  for (int i = 0; i < model::leg_count; ++i) {
    const auto [own, stated] = spring_number(file.machine.legs[static_cast<std::size_t>(i)]);
    suspects.push_back({.name = fmt::format("oil spring of leg {}", i + 1),
                        .statement = fmt::format(
                            "the oil stiffness of leg {} differs from the nominal value", i + 1),
                        .family = "leg axes",
                        .leg = i,
                        .free = {within(leg_path(i, own), stated, factor)}});
  }
  if (!from_modulus) return suspects;
  suspects.push_back(entrained_air(file));
  if (first.oil_spring.cylinder->volumes == model::VolumeRule::equal) return suspects;
  for (const char* side : {"cap", "rod"})
    for (int leg = -1; leg < model::leg_count; ++leg) suspects.push_back(volume(file, side, leg));
  return suspects;
}

}  // namespace hydrapod::diagnosis
