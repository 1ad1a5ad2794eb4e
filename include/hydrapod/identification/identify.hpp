#pragma once
/// From frequency responses to modes without a choice to make.
///
/// 1. Band: from the first to the last frequency at which the responses stand above their noise.
///    Where all poles lie in its lower part it is narrowed to what they need, and the search
///    repeated.
/// 2. Poles of all model orders (poly_reference.hpp), clusters of those that come back
///    (selection.hpp).
/// 3. Maximum-likelihood fit of the modal model to all of them (modal_model.hpp).
/// 4. What the fit shows to be nothing is taken out, and the rest fitted again: modes that do not
///    stand above the noise, whose frequency or damping is not determined, that left the band, or
///    that double another (nearly the same pole and shape).
/// 5. Modes with little damping are the machine's modes; heavily damped poles (a controller's, a
///    delay's) stay in the model and are listed apart.

#include <optional>

#include "hydrapod/identification/modal_model.hpp"

namespace hydrapod::identification {

struct IdentifyOptions {
  std::optional<double> from{}, to{};  ///< band [Hz]; default: found as said above
  OrderRange orders{};
  SelectionOptions selection{};
  FitOptions fit{};
  double highest_damping{0.3};               ///< of a mode
  double least_significance{20.0};           ///< FittedMode::significance
  double largest_frequency_deviation{0.02};  ///< of ω, relative
  double largest_damping_deviation{0.5};     ///< of ζ, relative
};

struct IdentifiedMode {
  FittedMode fit{};
  /// φ as displacement: φ/λ^d for outputs that are speeds (d = 1) or accelerations (2).
  /// Of repeated modes along outputs, where the space of their shapes has a real basis.
  Eigen::VectorXcd displacement{};
  int repeated{1};       ///< how many modes this one cannot be told from by its pole, with itself
  double persistence{};  ///< see PoleCluster
  double vector_consistency{};
  double mpc{};  ///< of the displacement shape
  double mpd{};  ///< [rad]
  /// Share of model orders that know it × MAC across them: 1 is best.
  [[nodiscard]] double quality() const { return persistence * vector_consistency; }
};

struct LeftOut {
  std::complex<double> pole{};
  std::string reason{};
};

struct Identification {
  FrequencyResponses responses{};   ///< in the band that was used
  std::vector<OrderPoles> chart{};  ///< stabilisation chart
  std::vector<PoleCluster> clusters{};
  ModalModel model{};                   ///< all poles, also the heavily damped ones
  std::vector<IdentifiedMode> modes{};  ///< the machine's, ascending in frequency
  std::vector<FittedMode> heavily_damped{};
  std::vector<LeftOut> left_out{};
  double from{}, to{};  ///< [Hz]
  std::vector<std::string> warnings{};
};

/// Without a mode in the band the result has none, and a warning that says so. Throws
/// base::ComputationError where there are too few frequencies.
Identification identify_modes(const FrequencyResponses& responses,
                              const IdentifyOptions& options = {},
                              const std::function<void(double)>& progress = {});

/// The modes with their errors, as others take them.
data::ModalResults modal_results(const Identification& identified);

/// Lines from `from` to `to` [Hz].
FrequencyResponses within(const FrequencyResponses& responses, double from, double to);

/// Complex mode indicator function: singular values of H, outputs scaled to their own size.
/// lines × min(outputs, inputs), descending.
Eigen::MatrixXd mode_indicator(const FrequencyResponses& responses);

/// MAC of every shape with every other.
Eigen::MatrixXd mac_matrix(const std::vector<Eigen::VectorXcd>& a,
                           const std::vector<Eigen::VectorXcd>& b);

}  // namespace hydrapod::identification
