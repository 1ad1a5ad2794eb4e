#include <algorithm>
#include <array>

#include "evidence.hpp"

namespace hydrapod::diagnosis {

namespace {

/// Kinds that are not in pairs are represented there by another one that does nearly the same: air,
/// gimbals and seals that stick change the same springs as the bulk modulus, rods that bend and
/// elastomers the same as the guide sleeves, only otherwise from pose to pose or from frequency
/// to frequency.
struct OfKind {
  Cause::Kind kind{};
  Family family{};
  bool in_pairs{true};
};
constexpr bool alone = false;
constexpr std::array kinds{OfKind{Cause::Kind::guide_sleeves, Family::guide_sleeves},
                           OfKind{Cause::Kind::piston_rings, Family::piston_rings},
                           OfKind{Cause::Kind::bulk_modulus, Family::leg_axes},
                           OfKind{Cause::Kind::oil_springs, Family::leg_axes},
                           OfKind{Cause::Kind::air, Family::leg_axes, alone},
                           OfKind{Cause::Kind::cap_volume, Family::leg_axes, alone},
                           OfKind{Cause::Kind::rod_volume, Family::leg_axes, alone},
                           OfKind{Cause::Kind::gimbals, Family::leg_axes, alone},
                           OfKind{Cause::Kind::sticking_seals, Family::leg_axes, alone},
                           OfKind{Cause::Kind::payload, Family::platform},
                           OfKind{Cause::Kind::payload_height, Family::platform, alone},
                           OfKind{Cause::Kind::inertia, Family::platform},
                           OfKind{Cause::Kind::mass_and_inertia, Family::platform},
                           OfKind{Cause::Kind::mass_center, Family::mass_center},
                           OfKind{Cause::Kind::base_lateral, Family::base},
                           OfKind{Cause::Kind::base_vertical, Family::base},
                           OfKind{Cause::Kind::base_rocking, Family::base},
                           OfKind{Cause::Kind::oil_lines, Family::oil_lines},
                           OfKind{Cause::Kind::leakage, Family::leakage},
                           OfKind{Cause::Kind::payload_sways, Family::payload_modes, alone},
                           OfKind{Cause::Kind::payload_heaves, Family::payload_modes, alone},
                           OfKind{Cause::Kind::payload_modes, Family::payload_modes, alone},
                           OfKind{Cause::Kind::rods_bend, Family::bending, alone},
                           OfKind{Cause::Kind::elastomer_ratio, Family::elastomers, alone},
                           OfKind{Cause::Kind::elastomer_loss, Family::elastomers, alone},
                           OfKind{Cause::Kind::struts, Family::leg_axes},
                           OfKind{Cause::Kind::screws, Family::leg_axes},
                           OfKind{Cause::Kind::guide_clearance, Family::guide_sleeves, alone}};

static_assert(kinds.size() == static_cast<std::size_t>(Cause::Kind::guide_clearance) + 1);

const OfKind& of(Cause::Kind kind) { return *std::ranges::find(kinds, kind, &OfKind::kind); }

}  // namespace

Family Cause::family() const { return of(kind).family; }
bool Cause::in_pairs() const { return of(kind).in_pairs; }

bool can_be_together(const Cause& a, const Cause& b) {
  if (!a.in_pairs() || !b.in_pairs()) return false;
  if (a.family() != b.family()) return true;
  return a.leg && b.leg && *a.leg != *b.leg;
}

}  // namespace hydrapod::diagnosis
