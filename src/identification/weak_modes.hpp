#pragma once
/// Resonances that a fit has left over. Private to the module.
///
/// Poles over a wide band are those that most of the response follows from; a sharp resonance that
/// adds a hundredth of it, as a seal's mode does, is then seen in the residual alone: as a few
/// lines at which it stands above its noise. Around each such place poles of low order are fitted
/// to the residual; those that come back between orders are offered for the fit of everything.

#include "hydrapod/identification/modal_model.hpp"

namespace hydrapod::identification {

/// Clusters of poles in the residual of `model`, the most conspicuous places first; none where the
/// residual is noise. Needs responses with known errors, else none.
std::vector<PoleCluster> weak_poles(const FrequencyResponses& responses, const ModalModel& model,
                                    bool taper, double highest_damping);

/// A second mode with the pole of mode `number` of `model`: the strongest part of the residue that
/// the residual has there. A weak mode of a machine with equal legs is often one of a pair.
PoleEstimate second_of_pair(const FrequencyResponses& responses, const ModalModel& model,
                            std::size_t number, bool taper);

}  // namespace hydrapod::identification
