#pragma once
/// What a machine must satisfy to be one that can be built, as margins that a fit can hold on to.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::calibration {

/// `margin` ≥ 0: holds. Margins are relative: 0.1 means that there is room of a tenth.
struct Constraint {
  std::string statement{};   ///< "the platform's mass is positive"
  std::optional<int> leg{};  ///< 0…5; none: of the platform
  double margin{};
};

/// For any machine in the same order:
/// - the platform's mass and principal moments are positive, and none exceeds the sum of the
/// others;
/// - per leg: masses, inertias and springs are not negative, axial inertias at most twice the
///   transverse ones; the mass centres lie within case and rod, and at every named pose the piston
///   lies beyond the base joint and the guide sleeve between the piston and the platform joint.
std::vector<Constraint> admissibility(const model::Machine& machine);

/// The margins alone.
std::vector<double> admissibility_margins(const model::Machine& machine);

/// Statements that do not hold, each leg's once: "legs: …" where all legs agree.
std::vector<std::string> violations(const model::Machine& machine);

}  // namespace hydrapod::calibration
