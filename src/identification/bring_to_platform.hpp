#pragma once
/// Spectra of sensors and legs as those of the platform's directions. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Channels that became directions of the platform: `map` times these, behind all others.
struct PlatformChange {
  std::vector<int> channels{};
  Eigen::MatrixXd map{};
};

/// The same for samples, a column per channel.
Eigen::MatrixXd brought_to_platform(const std::vector<PlatformChange>& changes,
                                    Eigen::MatrixXd samples);

/// Where the options say how, the outputs of `choice`, and drives of legs, become directions of the
/// platform in m.spectra and in `choice`. Throws base::ComputationError for dead channels. Returns
/// what was done, in this order.
std::vector<PlatformChange> bring_outputs_to_platform(const MeasureOptions& options,
                                                      ChannelChoice& choice, Measurement& m);

}  // namespace hydrapod::identification
