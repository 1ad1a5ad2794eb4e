#pragma once
/// One number per leg: the equations of all six legs are computed at once.
///
/// Lanes is a scalar for Eigen whose operations act on eight doubles side by side (two more than
/// there are legs), which compilers turn into vector instructions. There are no comparisons: code
/// on Lanes does not branch on values.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "hydrapod/model/machine.hpp"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // everything here is inlined
#endif

namespace hydrapod::dynamics {

struct Lanes {
  static constexpr int size = 8;
  // An array of the compiler's: held in registers where there are wide ones. Aligned as doubles, so
  // that what holds it may stand anywhere.
  typedef double Array __attribute__((vector_size(size * sizeof(double)), aligned(8)));  // NOLINT
  Array values;

  Lanes() = default;
  Lanes(double x) : values(x - Array{}) {}  // NOLINT: a number is the same in every lane
  explicit Lanes(const Array& array) : values(array) {}

  [[nodiscard]] double operator[](int i) const { return values[i]; }
  void set(int i, double x) { values[i] = x; }
  /// Over the legs.
  [[nodiscard]] double sum() const {
    double total = values[0];
    for (int i = 1; i < model::leg_count; ++i) total += values[i];
    return total;
  }

  Lanes& operator+=(const Lanes& b) {
    values += b.values;
    return *this;
  }
  Lanes& operator-=(const Lanes& b) {
    values -= b.values;
    return *this;
  }
  Lanes& operator*=(const Lanes& b) {
    values *= b.values;
    return *this;
  }
  Lanes& operator/=(const Lanes& b) {
    values /= b.values;
    return *this;
  }
  friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  friend Lanes operator*(Lanes a, const Lanes& b) { return a *= b; }
  friend Lanes operator/(Lanes a, const Lanes& b) { return a /= b; }
  friend Lanes operator-(const Lanes& a) { return Lanes(Array(-a.values)); }
};

/// Every lane through a function of doubles.
template <class Function>
Lanes each(const Lanes& a, Function function) {
  Lanes result;
  for (int i = 0; i < Lanes::size; ++i) result.values[i] = function(a.values[i]);
  return result;
}

inline Lanes sqrt(const Lanes& a) {
  using Half = Eigen::Array<double, Lanes::size / 2, 1>;
  Half low, high;
  for (int i = 0; i < Lanes::size / 2; ++i) {
    low[i] = a.values[i];
    high[i] = a.values[i + Lanes::size / 2];
  }
  low = low.sqrt();
  high = high.sqrt();
  Lanes result;
  for (int i = 0; i < Lanes::size / 2; ++i) {
    result.values[i] = low[i];
    result.values[i + Lanes::size / 2] = high[i];
  }
  return result;
}

/// Sine and cosine of every lane. Tilts are small: series up to π/4, which end below rounding
/// there.
inline void sine_cosine(const Lanes& x, Lanes& sine, Lanes& cosine) {
  constexpr double quarter_pi = 0.785398163397448;
  double largest = 0.0;
  for (int i = 0; i < Lanes::size; ++i) largest = std::max(largest, std::abs(x[i]));
  if (!(largest <= quarter_pi)) {
    sine = each(x, [](double a) { return std::sin(a); });
    cosine = each(x, [](double a) { return std::cos(a); });
    return;
  }
  const Lanes q = x * x;
  Lanes s(1.0), c(1.0);
  for (int k = 16; k >= 2; k -= 2) {
    s = 1.0 - q * (1.0 / (k * (k + 1))) * s;
    c = 1.0 - q * (1.0 / (k * (k - 1))) * c;
  }
  sine = x * s;
  cosine = c;
}

using Vector2L = Eigen::Matrix<Lanes, 2, 1>;
using Vector3L = Eigen::Matrix<Lanes, 3, 1>;
using Vector4L = Eigen::Matrix<Lanes, 4, 1>;
using Matrix3L = Eigen::Matrix<Lanes, 3, 3>;

}  // namespace hydrapod::dynamics

namespace Eigen {
template <>
struct NumTraits<hydrapod::dynamics::Lanes> : GenericNumTraits<double> {
  using Real = hydrapod::dynamics::Lanes;
  using NonInteger = hydrapod::dynamics::Lanes;
  using Nested = hydrapod::dynamics::Lanes;
  using Literal = hydrapod::dynamics::Lanes;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 0 };
};
}  // namespace Eigen

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
