#pragma once
/// Responses that another program averaged with a window, which its file does not name. Private to
/// the module.
///
/// Under random excitation an averaged response is, in the mean, the transform of the impulse
/// response times ρ, see lag_taper(): resonances come out wider than they are. A modal model that
/// does not know of ρ leaves that over, finds damping ratios that are too high, or takes two modes
/// for one. With K blocks the response at f is also uncertain by what the window lets in from other
/// frequencies ν,
///
///     E[e_oi e*_pi] = Q_ii/K Σ_j 1/Q_jj ∫ |W(f − ν)|² d_oj d*_pj dν / ∫ |W|² dν,
///     d = H(ν) − H̄(f),
///
/// with H̄ the averaged response and Q the input factor. Such errors are largest at resonances.
/// They go on from line to line, so that what is rough along frequency shows little of them.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Are they lines of a discrete transform on the imaginary axis, no window of them is known, and
/// they are few enough for a taper?
bool may_be_windowed(const FrequencyResponses& responses, const WindowOptions& options);

/// As estimated with this window: with its taper and the covariance of its lines. A block is as
/// long as the distance of the lines says.
FrequencyResponses with_window(FrequencyResponses responses, Window window,
                               const WindowOptions& options);

/// Adds the errors above to those of `r`, which has a taper: at each line the larger of both. 1/K
/// is what `rest`, the residual of `model`, shows where they are largest.
void add_leakage(FrequencyResponses& r, const data::PerLine<Eigen::MatrixXcd>& rest,
                 const ModalModel& model);

/// Do the same modes leave clearly more where the model does not know of the window?
bool widens(const Identification& windowed, const IdentifyOptions& options);

/// How much more speaks for `a` than for `b`, both with errors: the difference of their Bayesian
/// information criteria at the lines that both have,
///
///     BIC = n (mean ln σ² + ln mean |residual|²/σ²) + k ln n,
///
/// n: numbers that are independent, k: of poles and residues.
double evidence(const Identification& a, const Identification& b, const IdentifyOptions& options);

}  // namespace hydrapod::identification
