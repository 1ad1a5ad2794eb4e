#include "hydrapod/diagnosis/resonances.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace hydrapod::diagnosis {

namespace {

using spatial::Matrix6;
using spatial::Vector6;

/// Share of a rigid shape ψ that is in a shape φ: (ψᵀ M_r φ)²/(ψᵀ M_rr ψ).
double share(const dynamics::LinearModel& flexible, const Vector6& psi,
             const dynamics::ModelVector& phi) {
  const Vector6 momentum = flexible.M.topRows<6>() * phi;
  const Matrix6 M_rr = flexible.M.topLeftCorner<6, 6>();
  return std::pow(psi.dot(momentum), 2) / psi.dot(M_rr * psi);
}

/// What of the modes first … last − 1 is seen.
void add_group(const dynamics::LinearModel& model, const dynamics::NormalModes& modes, int first,
               int last, std::vector<Resonance>& seen) {
  const Eigen::LLT<Matrix6> llt(model.platform_mass);
  const Matrix6 root = llt.matrixU();
  Matrix6 energy = Matrix6::Zero();
  Eigen::MatrixXd u(6, last - first);
  for (int k = first; k < last; ++k) u.col(k - first) = root * modes.shapes.col(k).head<6>();
  energy = u * u.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(energy);
  for (int j = 0; j < 6; ++j) {
    const double strength = solver.eigenvalues()[j];
    if (strength < visible) continue;
    const Vector6 along = solver.eigenvectors().col(j);
    double omega = 0.0;
    for (int k = first; k < last; ++k)
      omega += modes.omega(k) * std::pow(along.dot(u.col(k - first)), 2) / strength;
    const Vector6 motion = llt.matrixU().solve(along);
    Eigen::Index main = 0;
    motion.cwiseProduct(model.platform_mass * motion).maxCoeff(&main);
    seen.push_back({static_cast<int>(main), omega, strength, motion});
  }
}

}  // namespace

std::vector<Resonance> visible_resonances(const model::Machine& machine, const spatial::Pose& X_BP,
                                          dynamics::ModelKind kind) {
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  const auto modes = modal::normal_modes(model);
  std::vector<Resonance> seen;
  for (int first = 0; first < modes.size();) {
    int last = first + 1;
    while (last < modes.size() && modes.omega(last) < modes.omega(first) * (1.0 + seen_as_one))
      ++last;
    add_group(model, modes, first, last, seen);
    first = last;
  }
  return seen;
}

model::Machine without_mount_and_gimbals(model::Machine machine) {
  machine.base_mount.reset();
  for (auto& leg : machine.legs) leg.gimbal_stiffness.reset();
  return machine;
}

std::array<FirstResonance, 6> first_resonances(const model::Machine& machine,
                                               const spatial::Pose& X_BP,
                                               dynamics::ModelKind kind) {
  const auto rigid =
      dynamics::linear_model(without_mount_and_gimbals(machine), X_BP, dynamics::ModelKind::rigid);
  const auto rigid_modes = modal::normal_modes(rigid);
  const auto energies = modal::energy_shares(rigid, rigid_modes.shapes);
  const auto flexible = dynamics::linear_model(machine, X_BP, kind);
  const auto modes = modal::normal_modes(flexible);
  std::array<FirstResonance, 6> result;
  for (int r = 0; r < 6; ++r) {
    const auto& energy = energies[static_cast<std::size_t>(r)];
    auto& found = result[static_cast<std::size_t>(r)];
    Eigen::Index main = 0;
    energy.platform.maxCoeff(&main);
    found = {.direction = modal::platform_directions(energy),
             .main_direction = static_cast<int>(main),
             .rigid_mode = r,
             .omega_rigid = rigid_modes.omega(r)};
    const Vector6 psi = rigid_modes.shapes.col(r);
    for (int k = 0; k < modes.size() && found.mac < resonance_mac; ++k) {
      // modes that repeat share the rigid mode between them
      double mac = 0.0;
      for (int i = 0; i < modes.size(); ++i)
        if (modes.group[i] == modes.group[k]) mac += share(flexible, psi, modes.shapes.col(i));
      if (mac >= resonance_mac) {
        found.mode = k;
        found.omega = modes.omega(k);
        found.mac = mac;
      }
    }
  }
  return result;
}

}  // namespace hydrapod::diagnosis
