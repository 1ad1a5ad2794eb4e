#pragma once
/// Resonances that a fit has left over. Private to the module.
///
/// Poles over a wide band are those that most of the response follows from; a sharp resonance that
/// adds a hundredth of it, as a seal's mode does, is then seen in the residual alone: as a few
/// lines at which it stands above its noise. Around each such place poles of low order are fitted
/// to the residual; those that come back between orders are offered for the fit of everything.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// What `model` leaves of the responses, with their errors.
FrequencyResponses residual_of(const FrequencyResponses& responses, const ModalModel& model,
                               bool taper);

/// Clusters of poles in the residual of `model`, the most conspicuous places first; none where the
/// residual is noise. Needs responses with known errors, else none.
std::vector<PoleCluster> weak_poles(const FrequencyResponses& responses, const ModalModel& model,
                                    const IdentifyOptions& options);

/// Frequencies [Hz] at which the residual stands above its noise, most conspicuous first: where a
/// mode hides in the flank of a strong one, its residual is no resonance that poles could be
/// fitted to.
std::vector<double> conspicuous_frequencies(const FrequencyResponses& responses,
                                            const ModalModel& model,
                                            const IdentifyOptions& options);

/// `count` modes with this pole: the strongest parts of the residue that the residual of `model`
/// has there.
std::vector<PoleEstimate> modes_in_residual(const FrequencyResponses& responses,
                                            const ModalModel& model, std::complex<double> pole,
                                            std::size_t count, bool taper);

}  // namespace hydrapod::identification
