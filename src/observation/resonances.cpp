#include <Eigen/Eigenvalues>
#include <cmath>

#include "hydrapod/modal/normal_modes.hpp"
#include "pair_cost.hpp"

namespace hydrapod::observation {

namespace {

using spatial::Matrix6;

/// What of a group of modes is seen.
void add_group(const dynamics::LinearModel& model, const dynamics::NormalModes& modes,
               const std::vector<int>& group, double visible, std::vector<Resonance>& seen) {
  const Matrix6 root = metric_root(model.platform_mass);
  const Eigen::MatrixXd u = root * modes.shapes(Eigen::seqN(0, 6), group);
  const Matrix6 energy = u * u.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(energy);
  for (int j = 0; j < 6; ++j) {
    const double strength = solver.eigenvalues()[j];
    if (strength < visible) continue;
    const Vector6 along = solver.eigenvectors().col(j);
    double omega = 0.0;
    for (std::size_t i = 0; i < group.size(); ++i)
      omega += modes.omega(group[i]) * std::pow(along.dot(u.col(static_cast<Eigen::Index>(i))), 2) /
               strength;
    const Vector6 motion = root.ldlt().solve(along);
    seen.push_back({main_direction(model.platform_mass, motion), omega, strength, motion});
  }
}

}  // namespace

std::vector<Resonance> visible_resonances(const model::Machine& machine, const spatial::Pose& X_BP,
                                          dynamics::ModelKind kind,
                                          const ObservationOptions& options) {
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  const auto modes = modal::normal_modes(model);
  std::vector<std::complex<double>> poles;
  for (int k = 0; k < modes.size(); ++k) poles.emplace_back(0.0, modes.omega(k));
  std::vector<Resonance> seen;
  for (const auto& group : groups_of(poles, options))
    add_group(model, modes, group, options.visible, seen);
  return seen;
}

}  // namespace hydrapod::observation
