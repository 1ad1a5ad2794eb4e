#include "hydrapod/diagnosis/diagnose.hpp"

#include <algorithm>

namespace hydrapod::diagnosis {

namespace {

constexpr double rigid = 1e6;

/// The compliances that this machine has in this model.
std::vector<Compliance> compliances(const model::Machine& machine, dynamics::ModelKind kind) {
  std::vector<Compliance> all;
  if (kind != dynamics::ModelKind::rigid) all.push_back(Compliance::guide_sleeve);
  if (kind == dynamics::ModelKind::full) all.push_back(Compliance::piston_ring);
  if (std::ranges::any_of(machine.legs,
                          [](const auto& leg) { return leg.gimbal_stiffness.has_value(); }))
    all.push_back(Compliance::gimbals);
  if (machine.base_mount) all.push_back(Compliance::base_mount);
  if (!machine.payload_modes.empty()) all.push_back(Compliance::payload);
  if (kind != dynamics::ModelKind::rigid && model::has_elastic_legs(machine))
    all.push_back(Compliance::bending);
  return all;
}

std::vector<Part> parts_of(const model::Machine& machine, dynamics::ModelKind kind) {
  const auto all = compliances(machine, kind);
  std::vector<Part> parts;
  for (const auto what : all) parts.push_back({what, {}});
  for (const auto what : all) {
    if (what == Compliance::base_mount || what == Compliance::payload) continue;
    for (int leg = 0; leg < model::leg_count; ++leg) parts.push_back({what, leg});
  }
  return parts;
}

model::Machine stiffened(model::Machine machine, const Part& part) {
  if (part.what == Compliance::base_mount) machine.base_mount.reset();
  if (part.what == Compliance::payload) machine.payload_modes.clear();
  for (int i = 0; i < model::leg_count; ++i) {
    if (part.leg && *part.leg != i) continue;
    auto& leg = machine.legs[static_cast<std::size_t>(i)];
    if (part.what == Compliance::guide_sleeve) leg.guide_sleeve.stiffness *= rigid;
    if (part.what == Compliance::piston_ring && leg.piston_ring)
      leg.piston_ring->stiffness *= rigid;
    if (part.what == Compliance::gimbals) leg.gimbal_stiffness.reset();
    if (part.what == Compliance::bending) leg.bending = model::LegBending::rigid;
  }
  return machine;
}

}  // namespace

std::vector<AttributedDrop> attribute_drops(const model::Machine& machine,
                                            const spatial::Pose& X_BP, dynamics::ModelKind kind) {
  std::vector<AttributedDrop> drops;
  for (const auto& resonance : first_resonances(machine, X_BP, kind)) drops.push_back({resonance});
  for (const auto& part : parts_of(machine, kind)) {
    const auto without = first_resonances(stiffened(machine, part), X_BP, kind);
    for (std::size_t r = 0; r < drops.size(); ++r) {
      const auto& now = drops[r].resonance;
      const double lost = now.omega_rigid - now.omega;
      const double share = lost != 0.0 ? (without[r].omega - now.omega) / lost : 0.0;
      drops[r].parts.push_back({part, without[r].omega, share});
    }
  }
  return drops;
}

}  // namespace hydrapod::diagnosis
