#pragma once
/// What may be wrong with a machine: named changes of its model, each with numbers of its own.
///
/// A suspect is one small file in src/diagnosis/suspects; to add one, write its function there,
/// declare it here and put it into all_suspects.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/calibration/plan.hpp"
#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::diagnosis {

struct Suspect {
  std::string name{};       ///< "guide sleeves of all legs"
  std::string statement{};  ///< "the guide sleeves of all legs are not as stiff as stated"
  /// What gives way or is wrong: "guide sleeves", "piston rings", "leg axes", "platform",
  /// "mass centre", "base", "oil lines". Two of one family are tried together only for two legs.
  std::string family{};
  std::optional<int> leg{};  ///< 0…5; none: all legs, or no leg at all
  std::vector<calibration::FreeParameter> free{};
  std::vector<model::Assignment> changes{};  ///< what the model needs before it can have this fault
  bool needs_rings{};                        ///< the model with piston rings
  /// Tried in pairs. Off for those that another one stands for (air and gimbals change the same
  /// springs as the bulk modulus, only otherwise from pose to pose).
  bool in_pairs{true};
};

using SuspectMaker = std::vector<Suspect> (*)(const model::MachineFile&);

std::vector<Suspect> guide_sleeves(const model::MachineFile& file);
std::vector<Suspect> piston_rings(const model::MachineFile& file);
std::vector<Suspect> oil(const model::MachineFile& file);
std::vector<Suspect> gimbals(const model::MachineFile& file);
std::vector<Suspect> platform(const model::MachineFile& file);
std::vector<Suspect> mass_center(const model::MachineFile& file);
std::vector<Suspect> base(const model::MachineFile& file);
std::vector<Suspect> oil_lines(const model::MachineFile& file);

inline constexpr std::array all_suspects{&guide_sleeves, &piston_rings, &oil,  &gimbals,
                                         &platform,      &mass_center,  &base, &oil_lines};

/// All suspects of a machine.
std::vector<Suspect> suspects_of(const model::MachineFile& file);

/// Can both be guilty at once, and are they worth being tried together?
bool can_be_together(const Suspect& a, const Suspect& b);

}  // namespace hydrapod::diagnosis
