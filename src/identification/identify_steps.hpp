#pragma once
/// Steps of identify_modes() that records without blocks take as well. Private to the module.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Candidates that a fit has lost, where the residual asks for them again.
void add_candidates(const IdentifyOptions& options, const std::vector<PoleCluster>& candidates,
                    Identification& result);

/// Modes that hide in the flank of a strong one: one, or a pair at once, of which one alone is no
/// resonance.
void add_hidden_modes(const IdentifyOptions& options, Identification& result);

/// Where a mode stands alone among the weak ones, from number `strong` on, a second one like it is
/// tried.
void add_second_of_pairs(const IdentifyOptions& options, std::size_t strong,
                         Identification& result);

struct PoleBelowOptions {
  /// It is looked for where the mean of |residual|²/variance below side · ω_lowest > more · its
  /// mean over the band: the flank of the lowest mode, which a wrong damping leaves over, is above
  /// that; 5 % is what the mean of some hundred lines of noise scatters by.
  double side{0.75}, more{1.05};
  /// A fit begins at ω = share · ω_lowest, the first one that stays: a pole may be anywhere between
  /// the band's beginning and the lowest mode, and from within a factor of two a fit gets there.
  std::vector<double> shares{0.3, 0.6};
  double damping{0.7};  ///< ζ that it begins with: a high-pass filter of second order has that
  /// Fall of the sum of squares as in Certainty::gain ≥ gain · least_significance.
  double gain{1.0};
};

/// A pole below the lowest mode that is damped too much for one: of sensors that do not measure
/// what is constant, of a soft mount. Residual terms do not follow it, and the damping of the modes
/// above is wrong by what they miss.
void add_pole_below_modes(const IdentifyOptions& options, Identification& result,
                          const PoleBelowOptions& pole = {});

/// What lies far above the highest mode cannot tell of any mode, but of delays, valves and higher
/// modes, for which the residual terms stand: it is left out.
void leave_out_above(const IdentifyOptions& options, Identification& result);

/// As many residual terms as the responses ask for.
void settle_residuals(const IdentifyOptions& options, Identification& result);

/// Those of the final model, which no trial needs.
void add_shape_deviations(const IdentifyOptions& options, Identification& result);

/// The modes of the final model, without heavily damped poles.
void list_modes(const IdentifyOptions& options, Identification& result);

/// Asks what noise explains, and tells the modes there.
void test_residual(const IdentifyOptions& options, Identification& result);

void add_warnings(const IdentifyOptions& options, Identification& result);

}  // namespace hydrapod::identification
