#include "hydrapod/identification/poles.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "hydrapod/numerics/dense.hpp"
#include "line_weights.hpp"
#include "matrix_roots.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// H per line, transposed where there are fewer outputs than inputs, and weights per row of it.
struct Problem {
  std::vector<MatrixXcd> H;
  MatrixXd weight;  // lines × outputs: w²
  std::vector<double> angle;
  double from{}, period{};  // f_0 [Hz], T [s]
  bool transposed{};
  [[nodiscard]] Index lines() const { return static_cast<Index>(H.size()); }
  [[nodiscard]] Index outputs() const { return H[0].rows(); }
  [[nodiscard]] Index inputs() const { return H[0].cols(); }
};

Problem make_problem(const FrequencyResponses& r) {
  Problem p;
  p.transposed = r.H[0].rows() < r.H[0].cols();
  for (const auto& H : r.H) p.H.push_back(p.transposed ? MatrixXcd(H.transpose()) : H);
  p.weight = row_weights(r, p.transposed);
  p.from = r.frequency.front();
  // a band that begins near zero is taken from zero: the responses are those of a real system
  const double to = r.frequency.back();
  if (p.from < 0.1 * to) p.from = 0.0;
  p.period = 0.5 / (to - p.from);
  for (const double f : r.frequency) p.angle.push_back(two_pi * (f - p.from) * p.period);
  return p;
}

/// Sums over lines for all differences of powers, m = 0 … n: Σ Re(a e^(imθ)).
struct Sums {
  MatrixXd denominator;                // outputs columns: w²
  std::vector<MatrixXd> cross;         // per output (n+1) × inputs, Σ w² Re(H e^(+imθ)); and
  std::vector<MatrixXd> cross_behind;  // the same with e^(−imθ)
  std::vector<MatrixXd> square;        // (n+1) × inputs², Σ w² Re(H_i* H_j e^(imθ))
};

/// cos and sin of mθ, m = 0 … order, in columns; of z^m = z^⌊m/2⌋ z^⌈m/2⌉.
void make_powers(const Problem& p, int order, MatrixXd& cosine, MatrixXd& sine) {
  cosine.setOnes(p.lines(), order + 1);
  sine.setZero(p.lines(), order + 1);
  for (Index k = 0; k < p.lines() && order > 0; ++k) {
    cosine(k, 1) = std::cos(p.angle[static_cast<size_t>(k)]);
    sine(k, 1) = std::sin(p.angle[static_cast<size_t>(k)]);
  }
  for (Index m = 2; m <= order; ++m) {
    const auto c1 = cosine.col(m / 2).array(), c2 = cosine.col(m - m / 2).array();
    const auto s1 = sine.col(m / 2).array(), s2 = sine.col(m - m / 2).array();
    cosine.col(m) = c1 * c2 - s1 * s2;
    sine.col(m) = s1 * c2 + c1 * s2;
  }
}

Sums make_sums(const Problem& p, int order) {
  const Index lines = p.lines(), inputs = p.inputs();
  MatrixXd cosine, sine;
  make_powers(p, order, cosine, sine);
  Sums sums;
  sums.denominator = cosine.transpose() * p.weight;
  for (Index o = 0; o < p.outputs(); ++o) {
    MatrixXd h_re(lines, inputs), h_im(lines, inputs), q_re(lines, inputs * inputs),
        q_im(lines, inputs * inputs);
    for (Index k = 0; k < lines; ++k) {
      const double w = p.weight(k, o);
      const auto row = p.H[static_cast<size_t>(k)].row(o);
      for (Index i = 0; i < inputs; ++i) {
        h_re(k, i) = w * row[i].real();
        h_im(k, i) = w * row[i].imag();
        for (Index j = 0; j < inputs; ++j) {
          const Complex q = w * std::conj(row[i]) * row[j];
          q_re(k, i * inputs + j) = q.real();
          q_im(k, i * inputs + j) = q.imag();
        }
      }
    }
    const MatrixXd cc = cosine.transpose() * h_re, ss = sine.transpose() * h_im;
    sums.cross.push_back(cc - ss);
    sums.cross_behind.push_back(cc + ss);
    sums.square.push_back(cosine.transpose() * q_re - sine.transpose() * q_im);
  }
  return sums;
}

/// The blocks R, S, T of one output for the highest order, with R = Lᵀ-factor and L⁻¹ S ready, so
/// that lower orders use their leading rows.
struct Output {
  MatrixXd factor;   // L, (n+1)×(n+1)
  MatrixXd reduced;  // L⁻¹ S, (n+1) × p (n+1)
};

struct Normal {
  std::vector<Output> outputs;
  MatrixXd square;  // Σ_o T_o, p (n+1) square
};

Normal make_normal(const Problem& p, const Sums& sums, int order) {
  const Index n = order + 1, inputs = p.inputs();
  Normal normal;
  normal.square = MatrixXd::Zero(inputs * n, inputs * n);
  for (Index o = 0; o < p.outputs(); ++o) {
    MatrixXd R(n, n), S(n, inputs * n);
    const auto& ahead = sums.cross[static_cast<size_t>(o)];
    const auto& behind = sums.cross_behind[static_cast<size_t>(o)];
    const auto& square = sums.square[static_cast<size_t>(o)];
    for (Index r = 0; r < n; ++r)
      for (Index s = 0; s < n; ++s) {
        const Index m = std::abs(s - r);
        R(r, s) = sums.denominator(m, o);
        S.row(r).segment(s * inputs, inputs) = -(s >= r ? ahead : behind).row(m);
        for (Index i = 0; i < inputs; ++i)
          for (Index j = 0; j < inputs; ++j)
            normal.square(r * inputs + i, s * inputs + j) +=
                s >= r ? square(m, i * inputs + j) : square(m, j * inputs + i);
      }
    R.diagonal() *= 1.0 + 1e-13;  // few lines and high orders make it singular
    Output output;
    output.factor = R.llt().matrixL();
    output.reduced = output.factor.triangularView<Eigen::Lower>().solve(S);
    normal.outputs.push_back(std::move(output));
  }
  return normal;
}

/// M = Σ_o T_o − S_oᵀ R_o⁻¹ S_o, for orders that ascend: each takes away rows of L⁻¹ S.
class Reduction {
 public:
  explicit Reduction(const Normal& normal) : normal_(normal), M_(normal.square) {}

  /// α (p (n+1) × p) with A_0 = I.
  MatrixXd denominator(Index inputs, int order) {
    const Index rows = order + 1 - rows_taken_, size = inputs * (order + 1);
    MatrixXd taken(rows * static_cast<Index>(normal_.outputs.size()), M_.cols());
    Index at = 0;
    for (const auto& output : normal_.outputs) {
      taken.middleRows(at, rows) = output.reduced.middleRows(rows_taken_, rows);
      at += rows;
    }
    M_.selfadjointView<Eigen::Lower>().rankUpdate(taken.transpose(), -1.0);
    rows_taken_ = order + 1;
    MatrixXd M = M_.topLeftCorner(size, size);
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    const Index rest = size - inputs;
    MatrixXd alpha(size, inputs);
    alpha.topRows(inputs).setIdentity();
    const MatrixXd B = M.bottomLeftCorner(rest, inputs);
    alpha.bottomRows(rest) = -numerics::solve_positive(M.bottomRightCorner(rest, rest), B);
    return alpha;
  }

 private:
  const Normal& normal_;
  MatrixXd M_;  // lower half
  Index rows_taken_{};
};

/// B(z) = Σ_k B_k z^k for all outputs, given α: β_o = −R⁻¹ S_o α.
class Numerator {
 public:
  Numerator(const Normal& normal, const MatrixXd& alpha, int order)
      : inputs_(alpha.cols()),
        beta_(order + 1, alpha.cols() * static_cast<Index>(normal.outputs.size())) {
    const Index n = order + 1;
    Index at = 0;
    for (const auto& output : normal.outputs) {
      beta_.middleCols(at, inputs_) =
          -output.factor.topLeftCorner(n, n).transpose().triangularView<Eigen::Upper>().solve(
              output.reduced.topLeftCorner(n, alpha.rows()) * alpha);
      at += inputs_;
    }
  }
  /// B(z) v of each z and v.
  [[nodiscard]] std::vector<VectorXcd> times(const std::vector<Complex>& z,
                                             const std::vector<MatrixRoot>& roots) const {
    MatrixXd re(static_cast<Index>(z.size()), beta_.rows()), im = re;
    for (Index r = 0; r < re.rows(); ++r) {
      Complex power = 1.0;
      for (Index k = 0; k < re.cols(); ++k, power *= z[static_cast<size_t>(r)]) {
        re(r, k) = power.real();
        im(r, k) = power.imag();
      }
    }
    const MatrixXd B_re = numerics::times(re, beta_), B_im = numerics::times(im, beta_);
    std::vector<VectorXcd> products;
    for (Index r = 0; r < re.rows(); ++r) {
      products.emplace_back(VectorXcd::Zero(beta_.cols() / inputs_));
      for (Index k = 0; k < beta_.cols(); ++k)
        products.back()[k / inputs_] +=
            Complex(B_re(r, k), B_im(r, k)) * roots[static_cast<size_t>(r)].right[k % inputs_];
    }
    return products;
  }

 private:
  Index inputs_;
  MatrixXd beta_;  // powers × outputs · inputs
};

/// Zeros of det A: those of A(1/w) w^n, which is monic because of A_0 = I.
OrderPoles poles_of(const Problem& p, const Normal& normal, const MatrixXd& alpha, int order,
                    double highest) {
  const Index inputs = p.inputs();
  std::vector<MatrixXd> A;
  for (Index k = 1; k <= order; ++k) A.emplace_back(alpha.middleRows(k * inputs, inputs));
  const auto iterated = iterated_roots(A);
  auto roots = iterated ? *iterated : companion_roots(A);
  const auto pole_of = [&](Complex w) {
    return -std::log(w) / p.period + Complex(0.0, two_pi * p.from);
  };
  std::erase_if(roots, [&](const MatrixRoot& root) {
    const double turn = std::arg(1.0 / root.value);
    return std::abs(root.value) < 1e-12 || turn <= 0.0 || turn >= std::numbers::pi * (1.0 - 1e-9) ||
           std::abs(pole_of(root.value)) > highest;
  });
  std::vector<Complex> z;
  for (const auto& root : roots) z.push_back(1.0 / root.value);
  const auto shapes = Numerator(normal, alpha, order).times(z, roots);
  OrderPoles found{.order = order, .poles = {}};
  for (std::size_t r = 0; r < roots.size(); ++r) {
    const Complex w = roots[r].value;
    PoleEstimate e{.pole = pole_of(w), .shape = shapes[r], .participation = roots[r].left};
    // A⁻¹ = z⁻ⁿ Σ v ℓᵀ/(w_z − w), w_z = 1/z; dw/ds = −T w
    e.shape *= std::pow(w, order) / (-p.period * w);
    if (!e.shape.allFinite() || !e.participation.allFinite()) continue;
    if (p.transposed) e.shape.swap(e.participation);
    found.poles.push_back(std::move(e));
  }
  std::ranges::sort(found.poles, {}, [](const PoleEstimate& e) { return e.omega(); });
  return found;
}

}  // namespace

std::vector<OrderPoles> poly_reference_poles(const FrequencyResponses& responses,
                                             const OrderRange& orders,
                                             const std::function<void(double)>& progress) {
  if (orders.lowest < 1 || (orders.highest != 0 && orders.highest < orders.lowest) ||
      orders.step < 0)
    throw std::invalid_argument(fmt::format("orders from {} to {} in steps of {} are not valid",
                                            orders.lowest, orders.highest, orders.step));
  if (responses.lines() < 4)
    throw std::invalid_argument(
        fmt::format("poles need at least 4 frequencies, not {}", responses.lines()));
  const Problem problem = make_problem(responses);
  // 2 real equations per line and input against (n + 1) (1 + 1/outputs…) unknowns: keep half spare
  const int bearable = std::max(1, static_cast<int>(problem.lines()) / 2 - 1);
  const int inputs = static_cast<int>(problem.inputs());
  const int asked = orders.highest != 0
                        ? orders.highest
                        : std::max(orders.fewest, (orders.poles + inputs - 1) / inputs);
  const int highest = std::min(asked, bearable);
  const int step = orders.step != 0 ? orders.step : std::max(1, 2 * highest / orders.fewest);
  const Normal normal = make_normal(problem, make_sums(problem, highest), highest);
  const double largest = two_pi * responses.frequency.back() * 1.0;
  Reduction reduction(normal);
  std::vector<OrderPoles> all;
  for (int order = std::min(orders.lowest, highest); order <= highest; order += step) {
    all.push_back(
        poles_of(problem, normal, reduction.denominator(problem.inputs(), order), order, largest));
    for (auto& e : all.back().poles) e.pole += responses.shift;
    if (progress) progress(static_cast<double>(order * order) / (highest * highest));
  }
  return all;
}

}  // namespace hydrapod::identification
