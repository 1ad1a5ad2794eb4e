#pragma once
/// One step of the classical Runge–Kutta method, written here so that no integrator of the library
/// is believed.

#include <Eigen/Core>

namespace hydrapod::test {

/// x after `h` [s]; `rate`: its derivative at a state.
template <typename Rate>
Eigen::VectorXd classical_step(const Rate& rate, const Eigen::VectorXd& x, double h) {
  const Eigen::VectorXd k1 = rate(x), k2 = rate(x + 0.5 * h * k1), k3 = rate(x + 0.5 * h * k2),
                        k4 = rate(x + h * k3);
  return x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

}  // namespace hydrapod::test
