#pragma once
/// What explanations get wrong, and why data and machine may not belong together, in plain words.
/// Private to the module.

#include "evidence.hpp"

namespace hydrapod::diagnosis {

/// Resonances that are missing, and measured values that it misses, worst first; at most three.
std::vector<std::string> what_is_wrong(const Evidence& evidence, const Explanation& explanation);

/// Fitted to the direction that the machine as stated misses most, what does a suspect with one
/// number do to the others? "the bulk modulus of the oil that would explain x (0.70 GPa) puts z 9.1
/// Hz off"; empty when it does no harm.
std::string contrary(const Evidence& evidence, const Explanation& as_stated,
                     const Explanation& explanation, const numerics::Progress& stop);

/// Why the data cannot be this machine's, or cannot say anything about it; empty: they may be.
/// `as_stated`: null where the machine has fewer modes than were measured.
std::vector<std::string> objections(const Evidence& evidence, const Explanation& as_stated);

}  // namespace hydrapod::diagnosis
