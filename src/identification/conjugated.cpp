#include "conjugated.hpp"

#include <algorithm>
#include <cmath>

#include "names.hpp"

namespace hydrapod::identification {

bool are_before_cause(const FrequencyResponses& r) {
  if (r.whole != nullptr || !r.excitation.empty() || r.shift != 0.0 || r.lines() < 2) return false;
  Eigen::ArrayXXd turned = Eigen::ArrayXXd::Zero(r.H[0].rows(), r.H[0].cols()), size = turned;
  for (std::size_t k = 1; k < r.lines(); ++k) {
    const Eigen::ArrayXXcd step = r.H[k].array() * r.H[k - 1].array().conjugate();
    turned += step.imag();
    size += step.abs();
  }
  return (turned / size.max(1e-300)).sum() > 0.0;
}

FrequencyResponses conjugated(FrequencyResponses r) {
  for (auto* matrices : {&r.H, &r.on_axis, &r.noise, &r.input_factor})
    for (auto& M : *matrices) M = M.conjugate().eval();
  for (auto& covariance : r.line_covariance) covariance = std::conj(covariance);
  return r;
}

double share_left_by(const ModalModel& model, const FrequencyResponses& r) {
  if (model.modes.empty()) return 1.0;
  double left = 0.0, all = 0.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    left += (r.H[k] - synthesised(model, r.frequency[k], r.shift)).squaredNorm();
    all += r.H[k].squaredNorm();
  }
  return std::sqrt(left / std::max(all, 1e-300));
}

}  // namespace hydrapod::identification
