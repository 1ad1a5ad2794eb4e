#include "window_trial.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "twins.hpp"
#include "window_effect.hpp"

namespace hydrapod::identification {

void try_windows(const FrequencyResponses& given, const IdentifyOptions& options,
                 const IdentifyWhole& identified, const std::function<void(double)>& progress,
                 Identification& result) {
  const auto is_noise = [&](const ModalModel& model, const std::vector<Unexplained>& unexplained) {
    return unexplained.empty() && model.misfit <= options.largest_misfit;
  };
  if ((is_noise(result.model, result.unexplained) && !has_twins(result)) ||
      result.model.error < options.window.least_left)
    return;
  if (!may_be_windowed(given, options.window)) return;
  std::optional<Window> found;
  bool stopped = false;  // by progress
  const auto watched = [&](double) {
    stopped = true;
    if (progress) progress(1.0);
    stopped = false;
  };
  // BIC, where the RMS of what is left tells little: few averages err at resonances by more than
  // what a window adds. Where there are none, it is far worse with a window.
  constexpr double beyond_doubt = 50.0, alike = 1.5;
  const double plain_error = result.model.error;
  bool clean = false;  // with the window noise alone is left
  for (const auto window :
       {Window::hann, Window::rectangular, Window::hamming, Window::blackman_harris,
        Window::flat_top, Window::blackman, Window::tukey}) {
    try {
      auto other = identified(with_window(given, window, options.window), options, watched);
      if (other.modes.empty()) continue;
      const bool noise = is_noise(other.model, other.unexplained) && !has_twins(other);
      const double more = evidence(other, result, options);
      const bool shown = widens(other, options) ||
                         (noise && more > beyond_doubt && other.model.error < alike * plain_error);
      if (!shown || !(more > (found ? 0.0 : options.window.evidence))) continue;
      result = std::move(other);
      found = window;
      clean = noise;
    } catch (const base::ComputationError&) {  // with this window no modes are found
      if (stopped) throw;
    }
  }
  if (!found) return;
  // the rate of the taper is none of samples
  std::erase_if(result.warnings, [](const ModeWarning& warning) {
    return warning.kind == ModeWarning::Kind::few_samples;
  });
  const auto& r = result.responses;
  result.warnings.insert(result.warnings.begin(),
                         {.kind = ModeWarning::Kind::window,
                          .value = static_cast<double>(r.taper.size()) / r.sample_rate,
                          .from = r.frequency.front(),
                          .to = r.frequency.back(),
                          .window = std::string(window_text(*found))});
  if (clean) return;
  constexpr double uncertain = 0.4;  // the window may be another one
  for (auto& mode : result.modes) mode.explained = std::min(mode.explained, uncertain);
}

}  // namespace hydrapod::identification
