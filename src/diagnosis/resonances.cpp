#include "hydrapod/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "ranking.hpp"

namespace hydrapod::diagnosis {

double rigid_share(const dynamics::LinearModel& flexible, const spatial::Vector6& psi,
                   const dynamics::ModelVector& phi) {
  const spatial::Vector6 momentum = flexible.M.topRows<6>() * phi;
  const spatial::Matrix6 M_rr = flexible.M.topLeftCorner<6, 6>();
  return std::pow(psi.dot(momentum), 2) / psi.dot(M_rr * psi);
}

model::Machine without_mount_and_gimbals(model::Machine machine) {
  machine.base_mount.reset();
  machine.payload_modes.clear();
  for (auto& leg : machine.legs) leg.gimbal_stiffness.reset();
  return machine;
}

namespace {

/// Shares of a rigid mode in all modes; modes that repeat share it between them.
std::vector<SharedMode> shares_of(const spatial::Vector6& psi, const dynamics::LinearModel& model,
                                  const modal::NormalModes& modes) {
  std::vector<SharedMode> all;
  for (int k = 0; k < modes.size(); ++k) {
    double mac = 0.0;
    for (int i = 0; i < modes.size(); ++i)
      if (modes.group[i] == modes.group[k]) mac += rigid_share(model, psi, modes.shapes.col(i));
    all.push_back({k, modes.omega(k), mac});
  }
  return all;
}

}  // namespace

std::array<FirstResonance, 6> first_resonances(const model::Machine& machine,
                                               const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                               const ResonanceOptions& options) {
  const auto rigid =
      dynamics::linear_model(without_mount_and_gimbals(machine), X_BP, dynamics::ModelKind::rigid);
  const auto rigid_modes = modal::normal_modes(rigid);
  const auto energies = modal::energy_shares(rigid, rigid_modes.shapes);
  const auto flexible = dynamics::linear_model(machine, X_BP, kind);
  const auto modes = modal::modes_with_elastomers(machine, flexible);
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
    if (!(modes.omega2.minCoeff() > 0.0)) continue;  // the legs fold
    const auto all = shares_of(rigid_modes.shapes.col(r), flexible, modes);
    const double largest = std::ranges::max_element(all, {}, &SharedMode::mac)->mac;
    const double enough = std::max(options.least, options.of_largest * largest);
    for (const auto& mode : all) {
      if (mode.mac >= enough) {
        found.mode = mode.mode;
        found.omega = mode.omega;
        found.mac = mode.mac;
        break;
      }
      if (mode.mac >= resonance_mac && (!found.below || mode.mac > found.below->mac))
        found.below = mode;
    }
  }
  return result;
}

}  // namespace hydrapod::diagnosis
