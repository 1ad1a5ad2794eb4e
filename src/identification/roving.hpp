#pragma once
/// Records of a hammer test with a channel for each point, of which one is hit in each record.
/// Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Throws base::ComputationError, which says what to do instead, where each record is hits of one
/// input and the others hold noise. `spectra`: those of all samples, of channels `used`, which
/// `choice` numbers.
void refuse_roving(data::RecordSet& records, const CrossSpectra& spectra,
                   const std::vector<std::size_t>& used, const ChannelChoice& choice);

}  // namespace hydrapod::identification
