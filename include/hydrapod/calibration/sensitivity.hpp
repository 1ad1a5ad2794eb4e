#pragma once
/// How the modes of a machine follow the numbers of its file.
///
/// The derivatives of eigenvalues and shapes are exact given those of M, K and C
/// (modal/damped_modes.hpp). Those of the matrices are central differences of the assembly,
/// equilibrium under gravity included, with a relative step of `relative_step`: masses, inertias
/// and stiffnesses enter M and K linearly and lengths as low polynomials over l², so that the error
/// is some 1e-9 of the derivative.

#include <span>
#include <vector>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::calibration {

inline constexpr double relative_step = 1e-4;

/// The modes at one pose and how they follow the parameters.
struct ModePoint {
  dynamics::LinearModel model{};
  dynamics::NormalModes modes{};
  std::vector<modal::ModelDerivative> derivatives{};   ///< per parameter [per its SI unit]
  std::vector<spatial::Vector3> center_derivatives{};  ///< of the mass centre's place [m per unit]
  /// Of LinearModel::against_base.
  std::vector<dynamics::PlatformRows> against_base_derivatives{};
  Eigen::MatrixXd domega2{};  ///< modes × parameters
};

/// A machine with the numbers of it that vary: a parameter sets all of its ids to one value.
struct VariedMachine {
  model::Machine machine{};
  std::vector<std::vector<model::ParameterId>> parameters{};

  /// Of the parameters in `machine`, each in its first id [SI].
  [[nodiscard]] std::vector<double> values() const;
  /// The machine with the parameters at `values`, not validated.
  [[nodiscard]] model::Machine at(const std::vector<double>& values) const;
  /// The same into `result`, whose memory is used again.
  void at(const std::vector<double>& values, model::Machine& result) const;
};

/// Modes of `machine` at its pose number `pose`, without derivatives. Throws base::ComputationError
/// where the machine has no modes there.
ModePoint mode_point(const model::Machine& machine, std::size_t pose, dynamics::ModelKind kind);

/// Adds the derivatives by the parameters to the point of the machine at `values`. `scales`: size
/// of each parameter, for the steps. Turns the basis of modes that repeat to the parameter that
/// parts them most.
void add_derivatives(const VariedMachine& machine, const std::vector<double>& values,
                     std::size_t pose, std::span<const double> scales, ModePoint& point);

/// One mode's frequency against all numbers of the file.
struct Sensitivities {
  ModePoint point{};
  std::vector<model::FileNumber> parameters{};  ///< those that matter and are not zero
  Eigen::MatrixXd percent_per_percent{};        ///< modes × parameters: d ln ω / d ln p; NaN for
                                                ///< modes that have buckled
  Eigen::VectorXd omega{};                      ///< [rad/s]
};

/// All numbers of the file that change its modes at pose number `pose`, or those at `paths`.
/// Numbers that are zero have no relative sensitivity and are left out.
Sensitivities sensitivities(const model::MachineFile& file, std::size_t pose,
                            dynamics::ModelKind kind, const std::vector<std::string>& paths = {});

}  // namespace hydrapod::calibration
