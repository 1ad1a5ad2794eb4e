#pragma once
/// Modes that a model says should be measured: poles, and how the platform moves in them.
///
/// Which model depends on where the inputs of the measurement stand:
///
///     mechanics  legs on oil springs (linear_model.hpp): a machine whose valves are shut
///     plant      mechanics, oil and valves: inputs are the drives of the valves
///     system     plant with its controller: inputs are commands or forces on a controlled machine
///
/// Poles with an imaginary part only. Motion is that of the mass centre, in base axes [m, rad],
/// against the ground, and against the base where that gives way.

#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::observation {

using Motion = Eigen::Matrix<std::complex<double>, 6, 1>;

using Source = observation::Observed;
/// "mechanics with oil springs", "mechanics, hydraulics and valves", "… and controller".
std::string_view source_description(Source source);

struct ModelMode {
  std::complex<double> pole{};          ///< λ [1/s], Im > 0
  Motion motion{Motion::Zero()};        ///< against the ground
  Motion against_base{Motion::Zero()};  ///< in the same scale
  std::string label{};                  ///< what moves or takes part, in words
  bool felt{};                          ///< by the platform
  [[nodiscard]] double omega() const { return std::abs(pole); }
  [[nodiscard]] double damping_ratio() const { return -pole.real() / std::abs(pole); }
};

/// Ascending in frequency. Throws base::ComputationError where the machine cannot stand.
std::vector<ModelMode> model_modes(const model::Machine& machine, const spatial::Pose& X_BP,
                                   dynamics::ModelKind kind, Source source);

}  // namespace hydrapod::observation
