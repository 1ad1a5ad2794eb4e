#pragma once
/// Spectra of sensors and legs as those of the platform's directions. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Where the options say how, the outputs of `choice`, and drives of legs, become directions of the
/// platform in m.spectra and in `choice`. Throws base::ComputationError for dead channels.
void bring_outputs_to_platform(const MeasureOptions& options, ChannelChoice& choice,
                               Measurement& m);

}  // namespace hydrapod::identification
