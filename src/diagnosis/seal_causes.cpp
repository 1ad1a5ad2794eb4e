/// Causes in the seals: guide sleeves with their guide rings, piston rings.

#include "cause_parts.hpp"

namespace hydrapod::diagnosis::causes {

namespace {

/// With the stiffness at `path`, of which the file states `value`. A seal that is stated as rigid
/// is looked for among those that seals have.
Cause softer(const model::MachineFile& file, Cause cause, const std::string& path, double value,
             double factor) {
  constexpr double like_rigid = 1e9, softest = 1e4, usual = 1e7;  // [N/m]
  auto free = within(path, value, factor);
  if (value > like_rigid) {
    free.start = usual;
    free.lower = softest;
    cause.changes = {change(file, path, usual)};
  }
  cause.free = {free};
  return cause;
}

}  // namespace

/// The O-rings under the step seals: softer or stiffer than stated.
void add_guide_sleeves(const model::MachineFile& file, std::vector<Cause>& all) {
  if (leg_of(file, {}).strut) return;
  constexpr double factor = 1e4;  // who calculates with rigid legs may state anything
  const std::string key = "guide_sleeve.stiffness";
  for (const auto leg : all_and_each)
    all.push_back(softer(file, {Cause::Kind::guide_sleeves, leg}, leg_path(leg, key),
                         leg_with(file, leg, key).guide_sleeve.stiffness, factor));
}

/// The O-rings under the glyd rings at the pistons: a third resonance in x and y.
void add_piston_rings(const model::MachineFile& file, std::vector<Cause>& all) {
  if (leg_of(file, {}).strut) return;
  // where the file has none they begin stiffer than the sleeves, as they are in cylinders
  constexpr double factor = 1000.0, stiffer = 10.0, stiffest = 1e9;
  const std::string key = "piston_ring.stiffness";
  for (const auto leg : all_and_each) {
    const auto& of = leg_with(file, leg, key);
    if (leg && !of.piston_ring) continue;
    const auto path = leg_path(leg, key);
    const double start = of.piston_ring ? of.piston_ring->stiffness
                                        : std::min(stiffer * of.guide_sleeve.stiffness, stiffest);
    auto rings = softer(file, {Cause::Kind::piston_rings, leg}, path, start, factor);
    if (!of.piston_ring) {
      rings.changes = {change(file, path, start)};
      // sleeves that are stated as good as rigid say nothing about the rings
      rings.free[0].lower = 1000.0;
    }
    all.push_back(rings);
  }
}

/// Guide rings that are worn, or swollen. Where no rod comes near its ring the gap changes nothing.
void add_guide_clearance(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double factor = 5.0;
  const std::string key = "guide_sleeve.gap";
  const auto& legs = file.machine.legs;
  const bool of_all =
      std::ranges::all_of(legs, [](const auto& leg) { return leg.guide_sleeve.gap.has_value(); });
  for (const auto leg : all_and_each)
    if (const auto gap = leg_with(file, leg, key).guide_sleeve.gap; gap && (leg || of_all))
      all.push_back(
          {Cause::Kind::guide_clearance, leg, {within(leg_path(leg, key), *gap, factor)}});
}

/// Another compound, or an aged one: what O-rings have, and a little more where the file states
/// more.
void add_elastomers(const model::MachineFile& file, std::vector<Cause>& all) {
  constexpr double least_ratio = 1.05, most_ratio = 4.0;  // catalogues: 1.3 to 3
  constexpr double least_loss = 0.02, most_loss = 0.6;    // catalogues: 0.1 to 0.3
  constexpr double margin = 1.2;
  const auto& legs = file.machine.legs;
  const auto has_numbers = [](const auto& leg) {  // `arms` have none
    const auto& elastomer = leg.guide_sleeve.elastomer;
    return elastomer && elastomer->dynamic_ratio && elastomer->loss_factor;
  };
  if (!std::ranges::all_of(legs, has_numbers)) return;
  const std::string of_ratio = "guide_sleeve.elastomer.dynamic_ratio",
                    of_loss = "guide_sleeve.elastomer.loss_factor";
  const auto elastomer = [&](const std::string& key) {
    return *leg_with(file, {}, key).guide_sleeve.elastomer;
  };
  const auto add = [&](Cause::Kind kind, const std::string& key, double value, double least,
                       double most) {
    all.push_back({kind,
                   {},
                   {{.paths = {leg_path({}, key)},
                     .start = value,
                     .lower = std::min(least, value),
                     .upper = std::max(most, margin * value)}}});
  };
  const double ratio = *elastomer(of_ratio).dynamic_ratio;
  add(Cause::Kind::elastomer_ratio, of_ratio, ratio,
      std::min(least_ratio, 1.0 + 0.5 * (ratio - 1.0)), most_ratio);
  add(Cause::Kind::elastomer_loss, of_loss, *elastomer(of_loss).loss_factor, least_loss, most_loss);
}

}  // namespace hydrapod::diagnosis::causes
