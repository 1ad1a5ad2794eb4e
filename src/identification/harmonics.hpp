#pragma once
/// Vibrations of constant frequency among those that noise excites: harmonics of what turns, and
/// mains hum. Private to the module.
///
/// Averaged over K blocks of length n, a vibration A cos(ωt + φ) adds A²/2 times the window's own
/// line shape |W|², and nothing else; a resonance that decays by e^(−2πγ/n) per sample adds that
/// shape widened by a Lorentzian of half width γ lines. Around each line that stands out the sum of
/// a constant and one such shape,
///
///     μ_d = b + a ℓ_γ(d − δ),   ℓ_γ(d) = Σ_k ρ_k e^(−2πγk/n) cos(2πkd/n),
///
/// is fitted to the powers p_d, which scatter as averages of K squares do: greatest is
/// −K Σ (ln μ_d + p_d/μ_d). It is a harmonic where the best fit with γ = 0 is more likely than
/// every one with γ ≥ `narrowest`: a resonance as sharp as that is not told from a harmonic by a
/// block that is shorter than its decay.

#include <array>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

using data::Harmonic;

struct HarmonicOptions {
  /// A line is looked at where its power is > stands_out times the median of those within `reach`
  /// lines: an average of ten squares is three times its mean once in 10⁵.
  double stands_out{6.0};
  int reach{20};
  int half_band{10};      ///< lines on either side that the fit takes
  double narrowest{0.2};  ///< γ [lines]: e^(−2πγ) = 0.28 is left of it after a block
  /// ln likelihood(γ = 0) − ln likelihood(γ ≥ narrowest) > this; 5: odds of 150.
  double evidence{5.0};
};

/// In `channels` of spectra that are not periodic; ascending in frequency.
std::vector<Harmonic> find_harmonics(const CrossSpectra& spectra, const std::vector<int>& channels,
                                     const HarmonicOptions& options = {});

/// Puts between the lines on either side what lies on a straight line there. `S` at multiples of
/// `spacing` [Hz].
void leave_out_harmonics(const std::vector<Harmonic>& harmonics, double spacing,
                         std::vector<Eigen::MatrixXcd>& S);

/// The same with a vibration that wanders between two frequencies [Hz] of `tone`, and with its
/// flanks. It joins the harmonics and warnings of `half`. `S`: of `channels` of `spectra`, at their
/// lines.
void leave_out_wandering(const CrossSpectra& spectra, const std::vector<int>& channels,
                         const std::array<double, 2>& tone, std::vector<Eigen::MatrixXcd>& S,
                         FrequencyResponses& half);

/// Half spectra alone do not tell a harmonic from a pole whose e^(Re λ τ) is > e^(−decays) at the
/// largest lag.
struct EndlessOptions {
  double decays{0.3};
};
bool is_endless(const FrequencyResponses& half, std::complex<double> pole,
                const EndlessOptions& options = {});

}  // namespace hydrapod::identification
