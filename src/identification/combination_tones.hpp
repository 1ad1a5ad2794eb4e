#pragma once
/// Modes that are none: combination tones of a machine that is not linear. Private to the module.
///
/// To second order, free vibrations with the poles λ_a and λ_b make others with λ_a + λ_b and
/// λ_a + λ_b*: at sums and differences of frequencies, with sums of decay rates. A hammer test, a
/// step release or a sweep shows them as peaks of all responses. One mode may stand there by
/// chance, as it often does among many. Of a mode k whose frequency is anywhere in the band the
/// share p_k of it that is as near to combinations of larger modes is even between 0 and 1; the
/// product of the p_k tells by how much less than that they are (R. A. Fisher).

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct CombinationToneOptions {
  double smaller{0.25};    ///< peak of acceleration < smaller · those of both others
  double decay{2.0};       ///< decay rates differ by less than this factor
  double deviations{3.0};  ///< |ω_k − ω_a ± ω_b| < deviations · its standard deviation …
  double beside{0.002};  ///< … + beside · ω_k: frequencies are not constant in amplitude either
  double chance{1e-3};   ///< of a product of the p_k that is so small < chance
  std::size_t fewest{2};
  double quality{0.3};  ///< of these modes, at most
};

void warn_of_combination_tones(Identification& result, const CombinationToneOptions& options = {});

}  // namespace hydrapod::identification
