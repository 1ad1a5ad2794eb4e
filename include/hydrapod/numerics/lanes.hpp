#pragma once
/// One number per leg: the equations of all six legs are computed at once.
///
/// Lanes is a scalar for Eigen whose operations act on eight doubles side by side (two more than
/// there are legs), which compilers turn into vector instructions. Code on Lanes does not branch on
/// values: where numbers are compared, max(), min(), clamp() and where_less() choose lane by lane,
/// and any_less() tells whether there is anything to choose.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // everything here is inlined
#endif

namespace hydrapod::numerics {

struct Lanes {
  static constexpr int size = 8;
  static constexpr int used = 6;  ///< the lanes that stand for legs come first
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
    for (int i = 1; i < used; ++i) total += values[i];
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

/// Turns what belongs to the legs one by one into lanes; the lanes that are no legs repeat leg 1.
template <class Value>
Lanes gather(Value value) {
  Lanes lanes;
  for (int i = 0; i < Lanes::size; ++i) lanes.set(i, value(i < Lanes::used ? i : 0));
  return lanes;
}

/// Every lane through a function of doubles.
template <class Function>
Lanes each(const Lanes& a, Function function) {
  Lanes result;
  for (int i = 0; i < Lanes::size; ++i) result.values[i] = function(a.values[i]);
  return result;
}

/// Every lane through a function of Eigen's arrays, which has vector instructions for it.
template <class Function>
Lanes each_by_array(const Lanes& a, Function function) {
  using Half = Eigen::Array<double, Lanes::size / 2, 1>;
  Half low, high;
  for (int i = 0; i < Lanes::size / 2; ++i) {
    low[i] = a.values[i];
    high[i] = a.values[i + Lanes::size / 2];
  }
  low = function(low);
  high = function(high);
  Lanes result;
  for (int i = 0; i < Lanes::size / 2; ++i) {
    result.values[i] = low[i];
    result.values[i + Lanes::size / 2] = high[i];
  }
  return result;
}

inline Lanes sqrt(const Lanes& a) {
  return each_by_array(a, [](const auto& half) { return half.sqrt(); });
}
inline Lanes exp(const Lanes& a) {
  return each_by_array(a, [](const auto& half) { return half.exp(); });
}
/// a^b for a > 0, to |b ln a| epsilons.
inline Lanes pow(const Lanes& a, const Lanes& b) {
  return exp(b * each_by_array(a, [](const auto& half) { return half.log(); }));
}

inline Lanes where_less(const Lanes& a, const Lanes& b, const Lanes& yes, const Lanes& no) {
  return Lanes(Lanes::Array(a.values < b.values ? yes.values : no.values));
}
inline Lanes max(const Lanes& a, const Lanes& b) { return where_less(a, b, b, a); }
inline Lanes min(const Lanes& a, const Lanes& b) { return where_less(b, a, b, a); }
inline Lanes clamp(const Lanes& a, const Lanes& low, const Lanes& high) {
  return min(max(a, low), high);
}
inline Lanes abs(const Lanes& a) { return max(a, -a); }
/// Whether a < b in any lane.
inline bool any_less(const Lanes& a, const Lanes& b) {
  bool any = false;
  for (int i = 0; i < Lanes::size; ++i) any |= a.values[i] < b.values[i];
  return any;
}
/// tanh to an epsilon of 1.
inline Lanes tanh(const Lanes& a) {
  const Lanes falling = exp(-2.0 * abs(a));
  const Lanes size = (1.0 - falling) / (1.0 + falling);
  return where_less(a, 0.0, -size, size);
}

/// The same of one number, for code on either.
inline double where_less(double a, double b, double yes, double no) { return a < b ? yes : no; }
inline bool any_less(double a, double b) { return a < b; }

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

}  // namespace hydrapod::numerics

namespace Eigen {
template <>
struct NumTraits<hydrapod::numerics::Lanes> : GenericNumTraits<double> {
  using Real = hydrapod::numerics::Lanes;
  using NonInteger = hydrapod::numerics::Lanes;
  using Nested = hydrapod::numerics::Lanes;
  using Literal = hydrapod::numerics::Lanes;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 0 };
};
}  // namespace Eigen

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
