#pragma once
/// A pole that was found against the true one. Shared by tests of systems of a few real modes.

#include <gtest/gtest.h>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// The first `inputs` places of the shapes are pushed.
test::ModalSystem pushed_at_first(std::vector<test::ExactMode> modes, Eigen::Index inputs);

struct TruePole {
  double omega{}, ratio{};
  explicit TruePole(std::complex<double> pole)
      : omega(std::abs(pole)), ratio(-pole.real() / omega) {}
};

/// Within so many of the deviations that are stated, and these shares of the true numbers besides.
void expect_within_deviations(const FittedMode& fit, const TruePole& truth, double of_omega = 0.0,
                              double of_ratio = 0.0, double deviations = 4.0);

}  // namespace hydrapod::identification
