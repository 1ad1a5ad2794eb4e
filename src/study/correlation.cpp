/// Inputs that depend on each other: a Gaussian copula.

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

using Normal = boost::math::normal_distribution<
    double, boost::math::policies::policy<boost::math::policies::promote_double<false>>>;

}  // namespace

Eigen::MatrixXd correlation_factor(const Eigen::MatrixXd& correlations, const std::string& place) {
  constexpr double rounding = 1e-10;  // of the unit diagonal: inputs that depend on others entirely
  const Eigen::Index n = correlations.rows();
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double left = correlations(j, j) - L.row(j).head(j).squaredNorm();
    bool contradiction = left < -rounding;
    if (left > rounding) L(j, j) = std::sqrt(left);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      const double rest = correlations(i, j) - L.row(i).head(j).dot(L.row(j).head(j));
      if (left > rounding)
        L(i, j) = rest / L(j, j);
      else
        contradiction = contradiction || std::abs(rest) > std::sqrt(rounding);
    }
    if (contradiction)
      base::refuse(place,
                   "no numbers can have all these correlations: two that are like a third one "
                   "are like each other");
  }
  return L;
}

void correlate(const Eigen::MatrixXd& factor, std::span<double> u) {
  constexpr double least = std::numeric_limits<double>::epsilon();
  Eigen::VectorXd z(factor.rows());
  for (Eigen::Index k = 0; k < z.size(); ++k)
    z[k] = boost::math::quantile(Normal(), u[static_cast<std::size_t>(k)]);
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    if (factor(k, k) == 1.0) continue;  // as it is, bit for bit
    const double score = factor.row(k).head(k + 1).dot(z.head(k + 1));
    u[static_cast<std::size_t>(k)] =
        std::clamp(boost::math::cdf(Normal(), score), least, 1.0 - least);
  }
}

}  // namespace hydrapod::study
