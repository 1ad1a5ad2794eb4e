#include "refit.hpp"

#include "names.hpp"

namespace hydrapod::identification {

std::vector<FittedMode> refitted_modes(const FrequencyResponses& responses,
                                       const Identification& found, FitOptions options,
                                       Deviations deviations) {
  std::vector<PoleEstimate> start;
  for (const auto& m : found.modes) start.push_back(m.fit);
  start.insert(start.end(), found.heavily_damped.begin(), found.heavily_damped.end());
  options.deviations = deviations;
  auto modes = fit_modes(within(responses, found.from, found.to), start, options).modes;
  modes.resize(found.modes.size());
  return modes;
}

}  // namespace hydrapod::identification
