#pragma once
/// What of responses modes can be identified from. Private to the module.

#include <optional>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// The lines of `r` with these numbers.
FrequencyResponses lines_of(const FrequencyResponses& r, const std::vector<std::size_t>& lines);

/// Responses without
///
/// - lines at 0 Hz (f ≤ 1e-6 of the highest), where the residual terms s⁻² of a modal model have no
///   value: files of analysers begin with one;
/// - lines with a number that is not finite, with a warning;
/// - lines above half the sample rate that are the conjugates of those below, in reverse, with a
///   warning: such files have all lines of a transform;
/// - lines at which a response is exactly 0 that is not so at all lines, with a warning: analysers
///   write that outside their band and where the coherence was low; not what is rounded to 0;
/// - outputs and inputs whose responses are 0 at all lines, with a warning each.
///
/// They are copied only where something is left out. Throws base::ComputationError where no
/// response is left, where too few lines are not 0, and where the largest is no size that units
/// could give it.
class UsableResponses {
 public:
  /// `all` must live as long.
  explicit UsableResponses(const FrequencyResponses& all);
  [[nodiscard]] const FrequencyResponses& get() const { return changed_ ? *changed_ : given_; }

 private:
  const FrequencyResponses& given_;
  std::optional<FrequencyResponses> changed_{};
};

}  // namespace hydrapod::identification
