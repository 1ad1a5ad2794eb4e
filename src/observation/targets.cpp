#include "hydrapod/observation/targets.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

namespace hydrapod::observation {

const char* name(Observed observed) {
  constexpr std::array words{"mechanics", "plant", "system"};
  return words[static_cast<std::size_t>(observed)];
}

const char* name(Entry entry) {
  constexpr std::array words{"valves", "forces", "commands"};
  return words[static_cast<std::size_t>(entry)];
}

const char* name(MotionAgainst against) {
  return against == MotionAgainst::base ? "base" : "ground";
}

CommonError::CommonError(const std::vector<ModeTarget>& modes)
    : own_(static_cast<Eigen::Index>(modes.size())), slopes_(own_.size()) {
  Eigen::Index i = 0;
  for (const auto& mode : modes) {
    const double rho = mode.common_deviation == 0.0 ? 0.0 : mode.common_deviation / mode.deviation;
    if (!(std::abs(rho) < 1.0))
      throw std::invalid_argument("ModeTarget::common_deviation: expected less than the deviation");
    own_[i] = std::sqrt(1.0 - rho * rho);
    slopes_[i] = rho / own_[i];
    ++i;
  }
}

Eigen::MatrixXd CommonError::whitened(const Eigen::MatrixXd& differences) const {
  Eigen::MatrixXd rows = own_.cwiseInverse().asDiagonal() * differences;
  const double square = slopes_.squaredNorm();
  if (square == 0.0) return rows;
  // (1 + s sᵀ)^(−1/2) along s is 1/√(1 + |s|²), across it 1
  const double along = (1.0 - 1.0 / std::sqrt(1.0 + square)) / square;
  rows -= along * slopes_ * (slopes_.transpose() * rows);
  return rows;
}

}  // namespace hydrapod::observation
