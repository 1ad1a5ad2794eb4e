#include "hydrapod/data/modal_results.hpp"

#include <cmath>

namespace hydrapod::data {

int time_derivatives(const std::string& unit) {
  return unit.ends_with("/s^2") || unit.ends_with("s^-2") || unit.ends_with("/s2")    ? 2
         : unit == "m/s" || unit == "rad/s" || unit == "m s^-1" || unit == "rad s^-1" ? 1
                                                                                      : 0;
}

bool against_ground(const Channel& channel) {
  return channel.direction < Direction::leg1 && time_derivatives(channel.unit) == 2;
}

double mac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  const double norms = a.squaredNorm() * b.squaredNorm();
  return norms > 0.0 ? std::norm(a.dot(b)) / norms : 0.0;
}

double modal_phase_collinearity(const Eigen::VectorXcd& shape) {
  const double rr = shape.real().squaredNorm(), ii = shape.imag().squaredNorm();
  const double ri = shape.real().dot(shape.imag());
  // the eigenvalues of [rr ri; ri ii]: (λ1 − λ2)²/(λ1 + λ2)²
  return rr + ii > 0.0 ? (std::pow(rr - ii, 2) + 4.0 * ri * ri) / std::pow(rr + ii, 2) : 0.0;
}

double mean_phase_deviation(const Eigen::VectorXcd& shape) {
  if (!(shape.squaredNorm() > 0.0)) return 0.0;
  // the straight line through the complex plane that fits the elements best
  const double rr = shape.real().squaredNorm(), ii = shape.imag().squaredNorm();
  const double ri = shape.real().dot(shape.imag());
  const double direction = 0.5 * std::atan2(2.0 * ri, rr - ii);
  double sum = 0.0, weight = 0.0;
  for (const std::complex<double> c : shape) {
    if (c == 0.0) continue;
    const std::complex<double> turned = c * std::polar(1.0, -direction);
    sum += std::abs(c) * std::atan2(std::abs(turned.imag()), std::abs(turned.real()));
    weight += std::abs(c);
  }
  return sum / weight;
}

}  // namespace hydrapod::data
