#pragma once
/// Rates and how well a number of cases determines them.

#include <fmt/format.h>

#include <boost/math/distributions/binomial.hpp>
#include <string>
#include <utility>

namespace hydrapod::test {

/// 95 % interval of a probability of which `count` of `cases` were seen (C. J. Clopper, E. S.
/// Pearson, Biometrika 26 (1934) 404): each end with 2.5 %, and exact at 0 and at all of them.
inline std::pair<double, double> clopper_pearson(int count, int cases) {
  constexpr double outside = 0.025;
  using Binomial = boost::math::binomial_distribution<double>;
  return {count > 0 ? Binomial::find_lower_bound_on_p(cases, count, outside) : 0.0,
          count < cases ? Binomial::find_upper_bound_on_p(cases, count, outside) : 1.0};
}

/// "3 of 60 (5.0 %, with 95 % confidence between 1.0 and 13.9 %)"
inline std::string rate_text(int count, int cases) {
  const auto [low, high] = clopper_pearson(count, cases);
  return fmt::format("{} of {} ({:.1f} %, with 95 % confidence between {:.1f} and {:.1f} %)", count,
                     cases, cases > 0 ? 100.0 * count / cases : 0.0, 100.0 * low, 100.0 * high);
}

}  // namespace hydrapod::test
