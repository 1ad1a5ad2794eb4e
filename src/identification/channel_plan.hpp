#pragma once
/// Which channels of a record are inputs, outputs and instruments, and which estimate that asks
/// for. Private to the module.

#include <string>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct Plan {
  ChannelChoice choice{};  ///< of the record's channels
  Estimator estimator{Estimator::h1};
};

/// By the names of `options`, else by the roles, as responses.hpp says. Throws base::InputError
/// about `file`.
Plan plan_channels(const std::string& file, const data::RecordHeader& header,
                   const MeasureOptions& options);

/// For outputs alone.
Plan plan_outputs(const std::string& file, const data::RecordHeader& header,
                  const MeasureOptions& options);

/// Channels that are used, in the order of the record; `choice` becomes one of them.
std::vector<std::size_t> used_channels(ChannelChoice& choice);

}  // namespace hydrapod::identification
