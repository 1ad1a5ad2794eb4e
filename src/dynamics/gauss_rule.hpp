#pragma once
/// Gauss' rule over a piece of an integral. Private to the module.

#include <boost/math/quadrature/gauss.hpp>

namespace hydrapod::dynamics {

/// Calls use(x, weight) at the `points` (an even number) of [from, to]: exact for polynomials of the
/// degree 2 points − 1.
template <unsigned points, class Use>
void over_piece(double from, double to, Use use) {
  using Rule = boost::math::quadrature::gauss<double, points>;
  const double half = 0.5 * (to - from), middle = 0.5 * (from + to);
  for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
    for (const double side : {-half, half})
      use(middle + side * Rule::abscissa()[k], half * Rule::weights()[k]);
}

}  // namespace hydrapod::dynamics
