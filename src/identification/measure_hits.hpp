#pragma once
/// Measurements of a hammer test. Private to the module.

#include <optional>
#include <vector>

#include "beginning.hpp"
#include "channel_plan.hpp"
#include "spikes.hpp"

namespace hydrapod::identification {

/// All samples of these channels of the records; none where there are more than `most` samples.
std::optional<std::vector<data::Samples>> whole_records(data::RecordSet& records,
                                                        const std::vector<std::size_t>& channels,
                                                        std::int64_t most);

/// Records of a hammer test, unless the options ask for blocks; none: these are no hits.
std::optional<Measurement> measure_hits(data::RecordSet& records, Plan plan,
                                        const MeasureOptions& options,
                                        const std::vector<Spike>& spikes, Beginning& beginning);

}  // namespace hydrapod::identification
