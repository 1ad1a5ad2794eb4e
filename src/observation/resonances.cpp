#include <Eigen/Eigenvalues>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "pair_cost.hpp"

namespace hydrapod::observation {

namespace {

using spatial::Matrix6;

/// Modes with real motions of the platform's mass centre, a column each.
struct RealModes {
  Matrix6 platform_mass{};
  Eigen::Matrix<double, 6, Eigen::Dynamic> motion{};
  Eigen::VectorXd omega{};
  std::vector<std::complex<double>> poles{};
};

/// What of a group of modes is seen.
void add_group(const RealModes& modes, const std::vector<int>& group, double visible,
               std::vector<Resonance>& seen) {
  const Matrix6 root = metric_root(modes.platform_mass);
  const Eigen::MatrixXd u = root * modes.motion(Eigen::all, group);
  const Matrix6 energy = u * u.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(energy);
  for (int j = 0; j < 6; ++j) {
    const double strength = solver.eigenvalues()[j];
    if (strength < visible) continue;
    const Vector6 along = solver.eigenvectors().col(j);
    double omega = 0.0;
    for (std::size_t i = 0; i < group.size(); ++i)
      omega += modes.omega[group[i]] * std::pow(along.dot(u.col(static_cast<Eigen::Index>(i))), 2) /
               strength;
    const Vector6 motion = root.ldlt().solve(along);
    seen.push_back({main_direction(modes.platform_mass, motion), omega, strength, motion});
  }
}

std::vector<Resonance> resonances_of(const RealModes& modes, const ObservationOptions& options) {
  std::vector<Resonance> seen;
  for (const auto& group : groups_of(modes.poles, options))
    add_group(modes, group, options.visible, seen);
  return seen;
}

}  // namespace

std::vector<Resonance> visible_resonances(const model::Machine& machine, const spatial::Pose& X_BP,
                                          dynamics::ModelKind kind,
                                          const ObservationOptions& options) {
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  const auto modes = modal::modes_with_elastomers(machine, model);
  RealModes real{model.platform_mass, modes.shapes.topRows<6>(), Eigen::VectorXd(modes.size()), {}};
  for (int k = 0; k < modes.size(); ++k) {
    real.omega[k] = modes.omega(k);
    real.poles.emplace_back(0.0, modes.omega(k));
  }
  return resonances_of(real, options);
}

std::vector<Resonance> visible_resonances(const Observation& seen,
                                          const ObservationOptions& options) {
  const auto all = std::ssize(seen.modes);
  const Matrix6 root = metric_root(seen.mechanics.platform_mass);
  RealModes real{seen.mechanics.platform_mass, {6, all}, Eigen::VectorXd(all), {}};
  Eigen::Index count = 0;
  for (const auto& mode : seen.modes) {
    if (mode.damping_ratio() > options.overdamped) continue;
    const Vector6c turned = turned_to_real(root.cast<std::complex<double>>() * mode.motion());
    real.motion.col(count) = root.ldlt().solve(turned.real());
    real.omega[count++] = mode.omega();
    real.poles.push_back(mode.pole);
  }
  real.motion.conservativeResize(Eigen::NoChange, count);
  return resonances_of(real, options);
}

}  // namespace hydrapod::observation
