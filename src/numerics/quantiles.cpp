#include "hydrapod/numerics/statistics.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace hydrapod::numerics {

double student_half_width(int degrees) {
  constexpr double upper = 0.975;
  return degrees > 0 ? boost::math::quantile(boost::math::students_t(degrees), upper)
                     : normal_half_width;
}

double chi_squared_quantile(double probability, int degrees) {
  return boost::math::quantile(boost::math::chi_squared(degrees), probability);
}

double fisher_quantile(double probability, double numerator, double denominator) {
  return boost::math::quantile(boost::math::fisher_f(numerator, denominator), probability);
}

}  // namespace hydrapod::numerics
