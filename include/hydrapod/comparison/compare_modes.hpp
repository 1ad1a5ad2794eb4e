#pragma once
/// Measured modes beside those of a model: who is who, and by how much they differ.
///
/// Shapes. The model's motion q of the mass centre C gives what an output sees: a direction of the
/// point Q, a leg length J_l_q q; q against the ground for accelerometers, else against the base
/// (identification::against_ground). Shapes are compared on the outputs that are such; angles count
/// with the platform's radius of gyration, ρ² = tr I/(3 m), so that lengths and angles weigh alike.
///
/// Likeness s of a measured and a model mode: MAC of the measured shape with the subspace that
/// all model modes span whose pole lies within a fifth of its decay rate: of repeated modes a
/// measurement shows any mix.
///
/// Pairs. Each measured mode gets a model mode of its own or none, so that the sum of
///
///     (ln(ω/ω_m)/0.1)² + 25 (1 − s),      16 for a mode that has none
///
/// is smallest: a pair is at most 40 % apart in frequency, and s is at least 0.36. Without
/// comparable outputs frequencies alone decide.

#include <optional>

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/observation/model_modes.hpp"

namespace hydrapod::comparison {

using observation::ModelMode;

struct ModePair {
  int measured{}, model{};        ///< indices
  double frequency_difference{};  ///< ω/ω_model − 1
  double damping_difference{};    ///< ζ/ζ_model − 1
  std::optional<double> mac{};    ///< s; none where shapes cannot be compared
};

struct ModelModeLeft {
  int model{};
  std::string reason{};  ///< "not found", "the platform does not feel it", …
};

struct ModeComparison {
  std::vector<ModelMode> model{};  ///< all of them
  std::vector<ModePair> pairs{};   ///< ascending in the measured mode
  std::vector<int> measured_left{};
  std::vector<ModelModeLeft> model_left{};  ///< in the band, less damped than a mode may be
  std::vector<int> outputs{};               ///< on which shapes were compared
  Eigen::MatrixXd mac{};  ///< measured × model, single shapes; empty without comparable outputs
};

/// Where the measurement was made.
struct ComparisonFrame {
  model::Machine machine{};
  spatial::Pose X_BP{};
  spatial::Vector3 p_BQ{};  ///< the point whose directions the outputs x … rz are [m]
};

/// What each output sees of the motion of the mass centre: outputs × 6; NaN rows for those that see
/// something else (pressures, sensors without a direction, directions of several points).
Eigen::MatrixXd output_map(const std::vector<data::Channel>& outputs, const ComparisonFrame& frame);

/// `highest_damping`: poles of the model above it are not looked at, as in IdentifyOptions.
ModeComparison compare_modes(const identification::Identification& measured,
                             std::vector<ModelMode> model, const ComparisonFrame& frame,
                             double highest_damping = 0.3);

}  // namespace hydrapod::comparison
