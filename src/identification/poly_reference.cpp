#include "hydrapod/identification/identify.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "hydrapod/numerics/dense.hpp"
#include "line_weights.hpp"
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

Sums make_sums(const Problem& p, int order) {
  const Index lines = p.lines(), inputs = p.inputs();
  MatrixXd cosine(lines, order + 1), sine(lines, order + 1);
  for (Index k = 0; k < lines; ++k)
    for (Index m = 0; m <= order; ++m) {
      cosine(k, m) = std::cos(static_cast<double>(m) * p.angle[static_cast<size_t>(k)]);
      sine(k, m) = std::sin(static_cast<double>(m) * p.angle[static_cast<size_t>(k)]);
    }
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

/// α (p (n+1) × p) with A_0 = I for one order. `reduced` is M of the highest order that was asked
/// so far less the rows beyond.
MatrixXd denominator(const Normal& normal, Index inputs, int order) {
  const Index n = order + 1, size = inputs * n;
  MatrixXd M = normal.square.topLeftCorner(size, size);
  for (const auto& output : normal.outputs) {
    const auto rows = output.reduced.topLeftCorner(n, size);
    M.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose(), -1.0);
  }
  M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
  const Index rest = size - inputs;
  MatrixXd alpha(size, inputs);
  alpha.topRows(inputs).setIdentity();
  const MatrixXd B = M.bottomLeftCorner(rest, inputs);
  alpha.bottomRows(rest) = -numerics::solve_positive(M.bottomRightCorner(rest, rest), B);
  return alpha;
}

/// Σ_k B_ok z^k for all outputs, given α: β_o = −R⁻¹ S_o α.
class Numerator {
 public:
  Numerator(const Normal& normal, const MatrixXd& alpha, int order) {
    const Index n = order + 1;
    for (const auto& output : normal.outputs)
      beta_.push_back(
          -output.factor.topLeftCorner(n, n).transpose().triangularView<Eigen::Upper>().solve(
              output.reduced.topLeftCorner(n, alpha.rows()) * alpha));
  }
  [[nodiscard]] MatrixXcd at(Complex z) const {
    MatrixXcd B(static_cast<Index>(beta_.size()), beta_[0].cols());
    for (Index o = 0; o < B.rows(); ++o) {
      const auto& beta = beta_[static_cast<size_t>(o)];
      Eigen::RowVectorXcd sum = Eigen::RowVectorXcd::Zero(B.cols());
      for (Index k = beta.rows() - 1; k >= 0; --k) sum = sum * z + beta.row(k);
      B.row(o) = sum;
    }
    return B;
  }

 private:
  std::vector<MatrixXd> beta_;
};

/// Zeros of det A from the companion matrix of A(1/w) w^n, which is monic because of A_0 = I.
OrderPoles poles_of(const Problem& p, const Normal& normal, const MatrixXd& alpha, int order,
                    double highest) {
  const Index inputs = p.inputs(), size = inputs * order;
  MatrixXd companion = MatrixXd::Zero(size, size);
  if (order > 1) companion.topRightCorner(size - inputs, size - inputs).setIdentity();
  for (Index k = 0; k < order; ++k)  // w^k has the coefficient A_{n−k}
    companion.block(size - inputs, k * inputs, inputs, inputs) =
        -alpha.middleRows((order - k) * inputs, inputs);
  const auto [values, vectors, converged] = numerics::eigen_pairs(companion);
  OrderPoles found{.order = order, .poles = {}};
  if (!converged) return found;
  const MatrixXcd left = numerics::inverse(vectors);
  const Numerator numerator(normal, alpha, order);
  for (Index r = 0; r < size; ++r) {
    const Complex w = values[r];
    if (std::abs(w) < 1e-12) continue;
    const Complex z = 1.0 / w, s = std::log(z) / p.period;
    PoleEstimate e;
    e.pole = s + Complex(0.0, two_pi * p.from);
    if (s.imag() <= 0.0 || std::arg(z) >= std::numbers::pi * (1.0 - 1e-9)) continue;
    if (std::abs(e.pole) > highest) continue;
    // A⁻¹ = z⁻ⁿ Σ v ℓᵀ/(w_z − w), w_z = 1/z; dw/ds = −T w
    const Complex scale = std::pow(w, order) / (-p.period * w);
    e.shape = scale * (numerator.at(z) * vectors.col(r).head(inputs));
    e.participation = left.row(r).tail(inputs).transpose();
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
  std::vector<OrderPoles> all;
  for (int order = std::min(orders.lowest, highest); order <= highest; order += step) {
    all.push_back(
        poles_of(problem, normal, denominator(normal, problem.inputs(), order), order, largest));
    for (auto& e : all.back().poles) e.pole += responses.shift;
    if (progress) progress(static_cast<double>(order * order) / (highest * highest));
  }
  return all;
}

}  // namespace hydrapod::identification
