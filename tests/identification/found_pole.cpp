#include "found_pole.hpp"

namespace hydrapod::identification {

test::ModalSystem pushed_at_first(std::vector<test::ExactMode> modes, Eigen::Index inputs) {
  for (auto& mode : modes) mode.participation = mode.participation.head(inputs).eval();
  return {std::move(modes)};
}

void expect_within_deviations(const FittedMode& fit, const TruePole& truth, double of_omega,
                              double of_ratio, double deviations) {
  EXPECT_NEAR(fit.omega(), truth.omega, deviations * fit.omega_deviation + of_omega * truth.omega);
  EXPECT_NEAR(fit.damping_ratio(), truth.ratio,
              deviations * fit.damping_deviation + of_ratio * truth.ratio);
}

}  // namespace hydrapod::identification
