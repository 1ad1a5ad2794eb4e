/// Frequencies that a model gets wrong together: their correlation, taken out.

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "hydrapod/observation/targets.hpp"

namespace hydrapod::observation {
namespace {

/// ρ = 0.83, 0, 0.41, −0.62.
std::vector<ModeTarget> four() {
  std::vector<ModeTarget> modes(4);
  const double deviations[]{0.31, 0.07, 1.9, 0.53}, rho[]{0.83, 0.0, 0.41, -0.62};
  for (std::size_t i = 0; i < 4; ++i) {
    modes[i].omega = 23.0 + 11.0 * static_cast<double>(i);
    modes[i].deviation = deviations[i];
    modes[i].common_deviation = rho[i] * deviations[i];
  }
  return modes;
}

/// Against R and its inverse, formed entry by entry: y = W r has yᵀ y = rᵀ R⁻¹ r for every r, and
/// W R Wᵀ = 1.
TEST(CommonError, IsTakenOutOfDifferences) {
  const auto modes = four();
  Eigen::Matrix4d R;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      R(i, k) = i == k ? 1.0
                       : modes[i].common_deviation * modes[k].common_deviation /
                             (modes[i].deviation * modes[k].deviation);
  const CommonError error(modes);
  EXPECT_TRUE(error.any());
  const Eigen::Matrix4d W = error.whitened(Eigen::Matrix4d::Identity());
  EXPECT_LT((W * R * W.transpose() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((W.transpose() * W - R.inverse()).cwiseAbs().maxCoeff(), 1e-13);
}

/// Where nothing is common no bit changes.
TEST(CommonError, ThatIsNotThereLeavesDifferencesAsTheyAre) {
  auto modes = four();
  for (auto& mode : modes) mode.common_deviation = 0.0;
  modes[2].deviation = 0.0;  // not compared
  const CommonError error(modes);
  EXPECT_FALSE(error.any());
  const Eigen::Vector4d r(0.3, -1.7, 2.9, 0.01);
  EXPECT_EQ(error.whitened(r), r);
  EXPECT_EQ(CommonError({}).whitened(Eigen::MatrixXd(0, 2)).cols(), 2);
}

TEST(CommonError, IsLessThanTheDeviation) {
  auto modes = four();
  modes[1].common_deviation = modes[1].deviation;
  EXPECT_THROW(CommonError{modes}, std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::observation
