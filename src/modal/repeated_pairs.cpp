#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>
#include <utility>

#include "swinging.hpp"

namespace hydrapod::modal {

namespace {

constexpr double pi = std::numbers::pi;

/// Two modes of the same frequency. Any combination e(θ) = u_1 cos θ + u_2 sin θ is balanced as
/// long as nothing depends on the amplitude, then only those with T = e'(θ)ᵀ K(e) e(θ) = 0.
class Pair {
 public:
  Pair(const Swinging& swinging, int first)
      : swinging_(swinging), first_(first), omega_(swinging.modes().omega(first)) {}

  [[nodiscard]] ModelVector at(double theta, double amplitude) const {
    ModelVector q = ModelVector::Zero(swinging_.modes().size());
    q[first_] = std::cos(theta);
    q[first_ + 1] = std::sin(theta);
    return q * (amplitude / swinging_.amplitude(q));
  }

  /// θ of both modes, near 0 and π/2; these where nothing tells the directions apart.
  [[nodiscard]] std::pair<double, double> angles() const {
    constexpr double least = 1e-9, most = 1.0;  // [m]: less than atoms, more than any swing
    for (double amplitude = least; amplitude < most; amplitude *= 3.0) {
      const auto zeros = balanced(amplitude, least);
      if (zeros.empty()) continue;
      const auto nearest = [&](double theta) {
        return *std::ranges::min_element(
            zeros, {}, [&](double zero) { return std::abs(std::remainder(zero - theta, pi)); });
      };
      const double one = nearest(0.0);
      return {one, nearest(one + 0.5 * pi)};
    }
    return {0.0, 0.5 * pi};
  }

 private:
  /// Zeros of T in [0, π) where all directions have left the stiffness at `least` and differ; else
  /// none.
  [[nodiscard]] std::vector<double> balanced(double amplitude, double least) const {
    constexpr int directions = 37;  // odd: T is not zero at one of them by the machine's symmetry
    const double tells = 1e-6 * omega_ * omega_;
    double largest = 0.0;
    std::vector<double> T, zeros;
    for (int k = 0; k <= directions; ++k) {
      const double theta = pi * k / directions;
      const ModelVector q = at(theta, amplitude);
      const ModelMatrix change =
          swinging_.at(q, omega_).K - swinging_.at(at(theta, least), omega_).K;
      if ((change * q).norm() < tells * q.norm()) return {};
      T.push_back(torque(theta, amplitude));
      largest = std::max(largest, std::abs(T.back()));
    }
    if (largest < tells) return {};
    for (int k = 0; k < directions; ++k) {
      const double low = T[static_cast<std::size_t>(k)], high = T[static_cast<std::size_t>(k + 1)];
      if ((low > 0.0) == (high > 0.0)) continue;
      constexpr int digits = 40;  // of 53 bits
      std::uintmax_t most = 60;
      const auto ends = boost::math::tools::toms748_solve(
          [&](double theta) { return torque(theta, amplitude); }, pi * k / directions,
          pi * (k + 1) / directions, low, high, boost::math::tools::eps_tolerance<double>(digits),
          most);
      zeros.push_back(0.5 * (ends.first + ends.second));
    }
    return zeros;
  }

  /// T/|q|² of the motion q along e(θ).
  [[nodiscard]] double torque(double theta, double amplitude) const {
    const ModelVector q = at(theta, amplitude);
    const ModelVector force = swinging_.at(q, omega_).K * q / q.norm();
    return std::cos(theta) * force[first_ + 1] - std::sin(theta) * force[first_];
  }

  const Swinging& swinging_;
  int first_;
  double omega_;
};

}  // namespace

ModelMatrix shapes_to_begin_with(const Swinging& swinging) {
  const auto& group = swinging.modes().group;
  const Eigen::Index n = swinging.modes().size();
  ModelMatrix shapes = ModelMatrix::Identity(n, n);
  for (int k = 0; k + 1 < n; ++k) {
    const int number = group[static_cast<std::size_t>(k)];
    if (std::ranges::count(group, number) != 2 || group[static_cast<std::size_t>(k + 1)] != number)
      continue;
    const Pair pair(swinging, k);
    const auto [one, other] = pair.angles();
    shapes.col(k) = pair.at(one, 1.0).normalized();
    shapes.col(k + 1) = pair.at(other, 1.0).normalized();
  }
  return shapes;
}

}  // namespace hydrapod::modal
