#pragma once
/// Where poles are looked for, and the poles of all model orders there. Private to the module.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Fewer lines are too few to find modes in, and with fewer than `few_lines` a band is not
/// narrowed.
inline constexpr std::size_t fewest_lines = 16, few_lines = 4 * fewest_lines;

struct Band {
  double from{}, to{};  ///< [Hz]
};

struct Search {
  FrequencyResponses responses;
  std::vector<OrderPoles> chart;
  std::vector<PoleCluster> clusters;
};

/// Throws base::ComputationError where the band has too few lines.
Search search(const FrequencyResponses& r, const Band& band, const IdentifyOptions& options,
              const std::function<void(double)>& progress);

/// In the band where the responses stand above their noise, narrowed while all poles are in its
/// lower part.
Search search_in_best_band(const FrequencyResponses& r, const IdentifyOptions& options,
                           const std::function<void(double)>& progress);

}  // namespace hydrapod::identification
