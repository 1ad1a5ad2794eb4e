#pragma once
/// Dense linear algebra of dynamic size, compiled once.
///
/// Eigen's decompositions take expressions, and every file that hands one over compiles the
/// algorithm anew: 5 to 20 s a file. These take and give plain matrices.
///
/// One number per leg: the equations of all six legs are computed at once.
///
/// Lanes is a scalar for Eigen whose operations act on eight doubles side by side (two more than
/// there are legs), which compilers turn into vector instructions. Code on Lanes does not branch on
/// values: where numbers are compared, max(), min(), clamp() and where_less() choose lane by lane,
/// and any_less() tells whether there is anything to choose.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>
#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace hydrapod::numerics {

/// A V = V diag(values) of a real matrix; complex values come as pairs of conjugates, vectors with
/// length 1.
struct EigenPairs {
  Eigen::VectorXcd values{};
  Eigen::MatrixXcd vectors{};
  bool converged = false;  ///< else, and where A is not finite, values and vectors are empty
};
EigenPairs eigen_pairs(const Eigen::MatrixXd& A);

/// The same with the inverse of the vectors' matrix: A = right diag(values) left. States that only
/// a few others act on, as those of filters and valves in front of a machine, are solved apart:
///
///     A = [A₁ B; 0 A₂],   right = [V₁ V₁Z; 0 V₂],   left = [V₁⁻¹ −Z V₂⁻¹; 0 V₂⁻¹],
///     Z_jk = (V₁⁻¹ B V₂)_jk / (μ_k − λ_j)
struct EigenSystem {
  Eigen::VectorXcd values{};  ///< conjugates are neighbours, Im > 0 first
  Eigen::MatrixXcd right{}, left{};
  bool converged = false;  ///< else, and where A is not finite, all is empty
};
EigenSystem eigen_system(const Eigen::MatrixXd& A);

/// Scales d, powers of two, for which rows and columns of D⁻¹ A D have like norms (Osborne, J. ACM
/// 7 (1960) 338). Eigenvalues of a matrix of states in SI units, 1e7 Pa beside 1e-5 m, keep some
/// six more digits.
Eigen::VectorXd balancing(const Eigen::MatrixXd& A);

/// The eigenvalues alone; empty where A is not finite or the iteration did not converge.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// For every row of `cost` a column of its own, so that the sum is smallest (Hungarian method,
/// O(rows² columns)). Throws std::invalid_argument when there are more rows than columns.
std::vector<int> assign(const Eigen::MatrixXd& cost);

/// A⁻¹ B, by elimination with partial pivoting. Whether A can be inverted is not checked.
Eigen::MatrixXcd solve(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B);
Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& A);

/// A B, and C += Aᵀ B: every shape of a product that a file writes is compiled there.
Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& A,
                      const Eigen::Ref<const Eigen::MatrixXd>& B);
void add_transposed_times(const Eigen::Ref<const Eigen::MatrixXd>& A,
                          const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::MatrixXd& C);

/// N⁻¹ B of a symmetric positive N by LDLᵀ. N is scaled to a diagonal of 1, to which 1e-14 is
/// added: rows may be of very different size, and directions that N hardly determines stay finite.
Eigen::MatrixXd solve_positive(const Eigen::MatrixXd& N, const Eigen::MatrixXd& B);
Eigen::VectorXd solve_positive(const Eigen::MatrixXd& N, const Eigen::VectorXd& b);

/// N⁻¹ of such a matrix. Where an eigenvalue of the scaled matrix is below 1e-13 of the largest,
/// its direction is left out: the inverse has nothing there instead of nearly infinity.
Eigen::MatrixXd inverse_positive(const Eigen::MatrixXd& N);

/// L⁻¹ of A = L Lᴴ, A Hermitian and positive, L lower triangular.
Eigen::MatrixXcd inverse_factor(const Eigen::MatrixXcd& A);

/// X with the least ‖A X − B‖, by QR with column pivoting.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// A = U diag(s) Vᵀ with as many columns as A has singular values; s descends.
struct SingularValues {
  Eigen::MatrixXd U{}, V{};
  Eigen::VectorXd s{};
};
SingularValues singular_values(const Eigen::MatrixXd& A);

}  // namespace hydrapod::numerics

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
#if defined(__AVX512F__)
  return Lanes(Lanes::Array(_mm512_sqrt_pd(__m512d(a.values))));
#else
  return each_by_array(a, [](const auto& half) { return half.sqrt(); });
#endif
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
#if defined(__AVX512F__)
  return _mm512_cmp_pd_mask(__m512d(a.values), __m512d(b.values), _CMP_LT_OQ) != 0;
#else
  bool any = false;
  for (int i = 0; i < Lanes::size; ++i) any |= a.values[i] < b.values[i];
  return any;
#endif
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
