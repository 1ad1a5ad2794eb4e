#include "refit.hpp"

#include "names.hpp"

namespace hydrapod::identification {

ModalModel refitted(const FrequencyResponses& responses, const Identification& found,
                    FitOptions options, Deviations deviations) {
  std::vector<PoleEstimate> start;
  for (const auto& m : found.modes) start.push_back(m.fit);
  start.insert(start.end(), found.heavily_damped.begin(), found.heavily_damped.end());
  options.deviations = deviations;
  return fit_modes(within(responses, found.from, found.to), start, options);
}

std::vector<FittedMode> refitted_modes(const FrequencyResponses& responses,
                                       const Identification& found, FitOptions options,
                                       Deviations deviations) {
  auto modes = refitted(responses, found, options, deviations).modes;
  modes.resize(found.modes.size());
  return modes;
}

}  // namespace hydrapod::identification
