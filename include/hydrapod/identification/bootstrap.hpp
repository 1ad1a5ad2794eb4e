#pragma once
/// How much frequencies and damping scatter when the averages are drawn anew: a check of the
/// intervals that needs none of their theory.
///
/// The blocks of a record are kept in G groups of neighbours. A resample draws G groups with
/// replacement, averages their spectra, estimates the responses anew and fits the modes that were
/// found, starting from them. The standard deviation over resamples, times √(G/(G − 1)), estimates
/// that of the frequency and the damping ratio.
///
/// Source: B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap (1993), ch. 6 and 8.

#include <cstdint>

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::identification {

/// Spectra that were formed alike as one, each with the weight of its blocks. `picks`: which ones,
/// some perhaps several times.
CrossSpectra averaged_spectra(const std::vector<CrossSpectra>& groups,
                              const std::vector<std::size_t>& picks);

struct BootstrapOptions {
  int resamples{50};
  std::uint64_t seed{1};
  IdentifyOptions identify{};  ///< those that found the modes
};

struct BootstrapScatter {
  Eigen::VectorXd omega_deviation{};    ///< of ω [rad/s], per mode that was found
  Eigen::VectorXd damping_deviation{};  ///< of ζ
  int resamples{};                      ///< that could be fitted
  int groups{};  ///< G: the scatter itself is known to 1/√(2 (G − 1)) or so
};

/// `groups`: spectra of at least four groups with the same channels and options. `progress` is told
/// the share that is done; where it says false the resamples so far count. Throws
/// std::invalid_argument for fewer groups and for a result without modes.
BootstrapScatter bootstrap_modes(const std::vector<CrossSpectra>& groups,
                                 const ChannelChoice& choice, Estimator estimator,
                                 const Identification& found, const BootstrapOptions& options = {},
                                 const numerics::Progress& progress = {});

}  // namespace hydrapod::identification
