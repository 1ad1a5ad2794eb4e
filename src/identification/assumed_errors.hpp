#pragma once
/// Errors of responses that come without them, from what is rough along frequency. Private to the
/// module.
///
/// A number d_k = r_k − Σ_j l_j r_j, j = k ± s, k ± 2s, with Lagrange's weights l_j for the cubic
/// through these neighbours, holds noise and hardly anything of a smooth function: E|d_k|² =
/// (1 + Σ l_j²) σ². The median over neighbouring lines, over ln 2, is σ² also where some of the
/// lines are at a sharp resonance. r is the response at first, and then what a fit has left of it.
///
/// Where several hits meet in a block, σ is in proportion to 1/|U|, which changes from line to
/// line: each d_k is then compared with what σ of its five lines makes of it.

#include "hydrapod/identification/identify.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// `responses` with noise, input factor and covariance of lines from `rest`, which is the responses
/// themselves (`fitted` false) or their residual. The variances are n_o(f) q_i.
FrequencyResponses with_assumed_errors(FrequencyResponses responses,
                                       const data::PerLine<MatrixXcd>& rest, bool fitted,
                                       const AssumedErrorOptions& options);

/// And without them.
void remove_errors(FrequencyResponses& responses);

}  // namespace hydrapod::identification
