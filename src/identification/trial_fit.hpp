#pragma once
/// The fit of a trial. Private to the module.

#include <optional>
#include <vector>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// What makes a trial worth its fit: modes from number `first` on with at least this significance.
struct Worth {
  std::size_t first{};
  double least_significance{}, patience{};  ///< of IdentifyOptions and TrialOptions
};

/// As fit_modes(); none, without deviations and as soon as that is clear, where the fit is not
/// worth it.
std::optional<ModalModel> fit_if_worth(const FrequencyResponses& responses,
                                       const std::vector<PoleEstimate>& start,
                                       const FitOptions& options, const Worth& worth);

}  // namespace hydrapod::identification
