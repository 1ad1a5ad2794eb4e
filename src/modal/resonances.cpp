#include <cmath>
#include <limits>

#include "hydrapod/modal/mode_table.hpp"

namespace hydrapod::modal {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Rows of M φ for platform, base and payload.
ModelVector momentum_of(const LinearModel& flexible, const ModelVector& phi) {
  const int beyond = flexible.beyond_legs();
  ModelVector momentum(6 + beyond);
  momentum.head<6>() = flexible.M.topRows<6>() * phi;
  momentum.tail(beyond) = flexible.M.bottomRows(beyond) * phi;
  return momentum;
}

/// Platform energies of mode k per direction, φᵀ M φ being 1.
Vector6 platform_energies(const LinearModel& model, const NormalModes& modes, int k) {
  const Vector6 phi = modes.shapes.col(k).head<6>();
  return phi.cwiseProduct(model.platform_mass * phi);
}

}  // namespace

int first_resonance(const NormalModes& modes, int d, double share) {
  const double all = modes.shapes.row(d).squaredNorm();
  for (int k = 0; k < modes.size(); ++k)
    if (std::pow(modes.shapes(d, k), 2) >= share * all) return k;
  return -1;
}

Counterpart counterpart(const ModelVector& momentum, const NormalModes& rigid) {
  int best = 0;
  const ModelVector common = rigid.shapes.transpose() * momentum;
  common.cwiseAbs().maxCoeff(&best);
  return {best, common[best] * common[best]};
}

Resonances resonances(const LinearModel& flexible, const NormalModes& modes,
                      const NormalModes& rigid, double share) {
  Resonances found{.lowest = missing, .direction = -1, .drop = missing};
  found.share = found.peak = missing;
  for (auto* numbers : {&found.first, &found.drops, &found.shares, &found.peaks})
    numbers->setConstant(missing);
  for (int k = 0; k < modes.size(); ++k) {
    const Vector6 energies = platform_energies(flexible, modes, k);
    if (energies.sum() < local_mode_energy) continue;
    energies.maxCoeff(&found.direction);
    found.lowest = modes.omega(k);
    const auto like = counterpart(momentum_of(flexible, modes.shapes.col(k)), rigid);
    const double ratio = found.lowest / rigid.omega(like.mode);
    found.drop = 1.0 - ratio;
    found.share = like.share;
    found.peak = like.share / (ratio * ratio);
    break;
  }
  for (int d = 0; d < 6; ++d) {
    const int k = first_resonance(modes, d, share), r = first_resonance(rigid, d, share);
    if (k < 0 || r < 0) continue;
    found.first[d] = modes.omega(k);
    found.drops[d] = 1.0 - modes.omega(k) / rigid.omega(r);
    const double own = std::pow(modes.shapes(d, k), 2), of_rigid = std::pow(rigid.shapes(d, r), 2);
    found.shares[d] = own / modes.shapes.row(d).squaredNorm();
    found.peaks[d] = own * rigid.omega2[r] / (of_rigid * modes.omega2[k]);
  }
  return found;
}

}  // namespace hydrapod::modal
