#pragma once
/// Groups of neighbouring blocks one after the other. Private to the module.

#include <functional>
#include <optional>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Spectra of a group, and the rest as in GroupedSpectra.
using TakeGroup =
    std::function<void(CrossSpectra&& spectra, const ChannelChoice& choice, Estimator estimator)>;

/// The groups of measure_groups(), which holds all of them at once: `take` gets each as soon as it
/// is read.
void each_group(data::RecordSet& records, const Measurement& measured,
                const MeasureOptions& options, int groups, const numerics::Progress& progress,
                std::optional<double> highest, const TakeGroup& take);

/// The same with each record, `take` gets its number; records without a block are passed over.
void each_record(data::RecordSet& records, const Measurement& measured,
                 const MeasureOptions& options, const numerics::Progress& progress,
                 std::optional<double> highest,
                 const std::function<void(std::size_t record, CrossSpectra&& spectra,
                                          const ChannelChoice& choice, Estimator estimator)>& take);

/// The groups of measure_groups() in blocks of another length, also of a record that is identified
/// in one piece.
GroupedSpectra measure_groups_in_blocks(data::RecordSet& records, const Measurement& measured,
                                        const MeasureOptions& options, int block_length, int groups,
                                        const numerics::Progress& progress,
                                        std::optional<double> highest);

}  // namespace hydrapod::identification
