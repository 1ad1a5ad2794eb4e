#pragma once
/// How long the blocks of a record are that are averaged. Private to the module.

#include "channel_plan.hpp"
#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Side by side, for so many inputs: the noise of the outputs is then still known.
double fewest_blocks(std::size_t inputs);

/// [samples] What the options ask for, else what suits the record. `shortest`: samples of the
/// shortest record. Refuses blocks that are longer than that.
int block_to_use(const data::RecordSet& records, const Plan& plan, const MeasureOptions& options,
                 std::int64_t shortest);

}  // namespace hydrapod::identification
