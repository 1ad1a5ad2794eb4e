#include "hydrapod/diagnosis/diagnose.hpp"

#include <cmath>

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
    const spatial::Vector6 psi = rigid_modes.shapes.col(r);
    for (int k = 0; k < modes.size() && found.mac < resonance_mac; ++k) {
      // modes that repeat share the rigid mode between them
      double mac = 0.0;
      for (int i = 0; i < modes.size(); ++i)
        if (modes.group[i] == modes.group[k])
          mac += rigid_share(flexible, psi, modes.shapes.col(i));
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
