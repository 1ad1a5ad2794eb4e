#include "fit_covariance.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "hydrapod/numerics/dense.hpp"
#include "leakage.hpp"
#include "line_weights.hpp"
#include "output_errors.hpp"

namespace hydrapod::identification {

namespace {

/// Rounding taken away; what is no number stays none.
double not_below_zero(double variance) { return variance < 0.0 ? 0.0 : variance; }

/// Variances of what the errors of all lines make of functions of the shared parameters: own ones
/// are eliminated, output o's by `X`.
class Propagation {
 public:
  /// Per output what factor each column of its derivatives has.
  using Factors = std::vector<VectorXd>;

  Propagation(const FitSystem& system, const FrequencyResponses& responses, const FitState& state,
              const std::vector<MatrixXd>& X, const LeakageParts& let_in)
      : system_(system),
        responses_(responses),
        state_(state),
        slopes_(system.slopes(state)),
        whitening_(system.lines(), system.inputs() * system.inputs()) {
    const Index p = system.inputs(), shared = system.shared_count(state.shared.poles.size());
    for (Index o = 0; o < system.outputs(); ++o) {
      const MatrixXd T = system.derivatives(state, o);
      derivatives_.push_back(T.leftCols(shared) - numerics::times(T.rightCols(T.cols() - shared),
                                                                  X[static_cast<size_t>(o)]));
    }
    for (Index k = 0; k < system.lines(); ++k)
      whitening_.row(k) =
          system.whitening()[static_cast<size_t>(k)].reshaped<Eigen::RowMajor>(1, p * p);
    if (responses.whole)
      errors_.emplace(responses, state.shared.poles);
    else
      add_coherence(let_in);
  }

  /// vᵀ Jᵀ cov(e) J v.
  [[nodiscard]] double variance(const VectorXd& v) const { return variance(factors(v)); }

  [[nodiscard]] Factors factors(const VectorXd& v) const {
    Factors all;
    for (const auto& derivatives : derivatives_) all.emplace_back(derivatives * v);
    return all;
  }

  /// `first`: the output of the first factors.
  [[nodiscard]] double variance(const Factors& factors, Index first = 0) const {
    const MatrixXcd F = changes(factors, first);
    if (errors_) return not_below_zero(errors_->variance(of_plain_errors(F)));
    // estimates of what lines have in common can make a sum below 0: then they are worth nothing
    const double correlated = variance_of(F, smoothed(F, responses_.line_covariance), first);
    const double noise = correlated > 0.0 ? correlated : not_below_zero(variance_of(F, F, first));
    return let_in_.size() > 0 ? noise + not_below_zero(variance_of_leakage(F, first)) : noise;
  }

 private:
  [[nodiscard]] double variance_of(const MatrixXcd& F, const MatrixXcd& S, Index first) const {
    const Index p = system_.inputs(), outputs = system_.outputs(), some = F.cols() / p;
    double sum = 0.0;
    for (Index o = 0; o < some; ++o)
      for (Index q = 0; q < some; ++q) {
        if (!responses_.has_errors() && o != q) continue;
        const VectorXcd product =
            F.middleCols(o * p, p).conjugate().cwiseProduct(S.middleCols(q * p, p)).rowwise().sum();
        sum += coherence_.col((first + o) * outputs + first + q).cwiseProduct(product).real().sum();
      }
    return 0.5 * sum;
  }

  /// z_ji = Σ_o D_oj* F_oi: zᴴ a z, and of the relation z_jiᴴ b z_ij*.
  [[nodiscard]] double variance_of_leakage(const MatrixXcd& F, Index first) const {
    const Index p = system_.inputs();
    std::vector<MatrixXcd> z;
    for (Index j = 0; j < p; ++j) {
      z.emplace_back(MatrixXcd::Zero(F.rows(), p));
      for (Index o = 0; o < F.cols() / p; ++o)
        z.back() +=
            let_in_.col((first + o) * p + j).conjugate().asDiagonal() * F.middleCols(o * p, p);
    }
    const auto& leakage = responses_.leakage;
    const std::vector<Complex> a(leakage.line_covariance.begin(), leakage.line_covariance.end()),
        b(leakage.relation.begin(), leakage.relation.end());
    double alone = 0.0, related = 0.0;
    for (Index j = 0; j < p; ++j) {
      const auto& own = z[static_cast<size_t>(j)];
      alone += own.conjugate().cwiseProduct(smoothed(own, a)).real().sum();
      const MatrixXcd S = smoothed(own, b);
      for (Index i = 0; i < p; ++i)
        related += z[static_cast<size_t>(i)].col(j).cwiseProduct(S.col(i)).real().sum();
    }
    // of the first order: where it says that nothing is left, higher ones are
    constexpr double beyond_first_order = 0.05;
    return 0.5 * std::max(alone + related, beyond_first_order * alone);
  }

  /// The outputs' noise without leakage, each to its own deviation: cov(e_o, e_p*), o outputs + p.
  void add_coherence(const LeakageParts& let_in) {
    const Index outputs = system_.outputs(), inputs = system_.inputs();
    if (!let_in.D.empty()) let_in_.resize(system_.lines(), outputs * inputs);
    coherence_ = MatrixXcd::Ones(system_.lines(), outputs * outputs);
    if (!responses_.has_errors()) return;
    const auto& deviation = system_.deviation();
    for (Index k = 0; k < system_.lines(); ++k) {
      const auto& S = responses_.noise[static_cast<size_t>(k)];
      const double Q = responses_.input_factor[static_cast<size_t>(k)].diagonal().real().mean();
      for (Index o = 0; o < outputs; ++o)
        for (Index p = 0; p < outputs; ++p)
          coherence_(k, o * outputs + p) = S(o, p) * Q / (deviation(k, o) * deviation(k, p));
      if (let_in.D.empty()) continue;
      for (Index o = 0; o < outputs; ++o) {
        let_in_.row(k).segment(o * inputs, inputs) =
            std::sqrt(Q) / deviation(k, o) * let_in.D[static_cast<size_t>(k)].row(o);
        for (Index p = 0; p < outputs; ++p)
          coherence_(k, o * outputs + p) *=
              std::sqrt((1.0 - let_in.share(k, o)) * (1.0 - let_in.share(k, p)));
      }
    }
  }

  /// Wᴴ F/σ: what stands beside errors that are not whitened.
  [[nodiscard]] MatrixXcd of_plain_errors(const MatrixXcd& F) const {
    const Index p = system_.inputs();
    MatrixXcd c = MatrixXcd::Zero(F.rows(), F.cols());
    for (Index o = 0; o < system_.outputs(); ++o)
      for (Index j = 0; j < p; ++j) {
        auto column = c.col(o * p + j);
        for (Index i = j; i < p; ++i)
          column += whitening_.col(i * p + j).conjugate().cwiseProduct(F.col(o * p + i));
        column.array() /= system_.deviation().col(o).array();
      }
    return c;
  }

  /// The columns times their factors, whitened: entry o p + i, a row per line.
  [[nodiscard]] MatrixXcd changes(const Factors& factors, Index first) const {
    const Index p = system_.inputs(), outputs = static_cast<Index>(factors.size());
    const Index n = state_.functions.re.cols(), count = slopes_.re.cols() / p;
    MatrixXd by_functions(n, p * outputs), by_slopes(count, outputs);
    for (Index o = 0; o < outputs; ++o) {
      const VectorXd& c = factors[static_cast<size_t>(o)];
      by_functions.middleCols(o * p, p) = c.head(n * p).reshaped(p, n).transpose();
      by_slopes.col(o) = c.tail(count);
    }
    MatrixXcd plain = product(state_.functions, 0, by_functions);
    for (Index i = 0; i < p; ++i)
      plain(Eigen::all, Eigen::seqN(i, outputs, p)) += product(slopes_, i * count, by_slopes);
    MatrixXcd white = MatrixXcd::Zero(plain.rows(), plain.cols());
    for (Index o = 0; o < outputs; ++o)
      for (Index i = 0; i < p; ++i) {
        auto column = white.col(o * p + i);
        for (Index j = 0; j <= i; ++j)  // W is lower triangular
          column += whitening_.col(i * p + j).cwiseProduct(plain.col(o * p + j));
        column.array() /= system_.deviation().col(first + o).array();
      }
    return white;
  }

  /// Each line with its neighbours, as their noise goes together.
  [[nodiscard]] static MatrixXcd smoothed(const MatrixXcd& F, const std::vector<Complex>& a) {
    MatrixXcd S = a[0] * F;
    const Index lines = F.rows();
    for (Index d = 1; d < std::min(lines, static_cast<Index>(a.size())); ++d) {
      const Complex along = a[static_cast<size_t>(d)];
      S.topRows(lines - d) += along * F.bottomRows(lines - d);
      S.bottomRows(lines - d) += std::conj(along) * F.topRows(lines - d);
    }
    return S;
  }

  const FitSystem& system_;
  const FrequencyResponses& responses_;
  const FitState& state_;
  Parts slopes_;
  MatrixXcd whitening_;                // lines × inputs², column i p + j
  MatrixXcd coherence_;                // lines × outputs²
  MatrixXcd let_in_;                   // D in column o p + j, a row per line; empty: none
  std::vector<MatrixXd> derivatives_;  // of the columns (c_a e_i, d), by the shared parameters
  std::optional<OutputErrors> errors_;
};

/// Derivatives of each output by its own parameters.
std::vector<MatrixXd> own_derivatives(const FitSystem& system, const FitState& state) {
  const Index shared = system.shared_count(state.shared.poles.size());
  std::vector<MatrixXd> own;
  for (Index o = 0; o < system.outputs(); ++o) {
    const MatrixXd T = system.derivatives(state, o);
    own.emplace_back(T.rightCols(T.cols() - shared));
  }
  return own;
}

/// Errors of the shape of one mode of half spectra. Only its ratios mean anything: deviations are
/// √E|δφ_o − φ_o/φ_m δφ_m|², m the largest.
class ShapeErrors {
 public:
  ShapeErrors(const FitSystem& system, const FitState& state, const Propagation& propagation,
              const std::vector<MatrixXd>& X, const std::vector<MatrixXd>& own_inverse,
              const MatrixXd& N_inverse)
      : propagation_(propagation),
        X_(X),
        own_inverse_(own_inverse),
        N_inverse_(N_inverse),
        own_(own_derivatives(system, state)) {}

  /// |φ_o|²/E|δφ_o|², the best of the outputs that move most in proportion to their `sizes`.
  /// Entries err together, so that their sum is no measure.
  [[nodiscard]] double significance(const VectorXcd& shape, const VectorXd& sizes,
                                    Index mode) const {
    constexpr int tried = 3;
    VectorXd share = shape.cwiseAbs().cwiseQuotient(sizes);
    double best = 0.0;
    for (Index k = 0; k < std::min<Index>(tried, share.size()); ++k) {
      Index o = 0;
      share.maxCoeff(&o);
      share[o] = -1.0;
      const double variance =
          propagation_.variance(part(o, 2 * mode)) + propagation_.variance(part(o, 2 * mode + 1));
      best = std::max(best, std::norm(shape[o]) / std::max(variance, 1e-300));
    }
    return best;
  }

  [[nodiscard]] VectorXd deviations(const VectorXcd& shape, Index mode) const {
    Index largest = 0;
    shape.cwiseAbs().maxCoeff(&largest);
    const auto re_m = part(largest, 2 * mode), im_m = part(largest, 2 * mode + 1);
    VectorXd deviation = VectorXd::Zero(shape.size());
    for (Index o = 0; o < shape.size(); ++o) {
      if (o == largest) continue;
      const Complex s = shape[o] / shape[largest];
      auto re = part(o, 2 * mode), im = part(o, 2 * mode + 1);
      for (std::size_t k = 0; k < re.size(); ++k) {
        re[k] += s.imag() * im_m[k] - s.real() * re_m[k];
        im[k] -= s.real() * im_m[k] + s.imag() * re_m[k];
      }
      deviation[o] = std::sqrt(propagation_.variance(re) + propagation_.variance(im));
    }
    return deviation;
  }

 private:
  /// Of own parameter `at` of output o.
  [[nodiscard]] Propagation::Factors part(Index o, Index at) const {
    const auto k = static_cast<std::size_t>(o);
    const VectorXd by_shared = N_inverse_ * X_[k].row(at).transpose();
    auto factors = propagation_.factors(-by_shared);
    factors[k] += own_[k] * own_inverse_[k].col(at);
    return factors;
  }

  const Propagation& propagation_;
  const std::vector<MatrixXd>&X_, &own_inverse_;
  const MatrixXd& N_inverse_;
  std::vector<MatrixXd> own_;  // derivatives by own parameters
};

/// Derivatives of ω and of ζ by Re λ and Im λ.
std::pair<Eigen::Vector2d, Eigen::Vector2d> frequency_and_damping(Complex l) {
  const double w = std::abs(l);
  // ζ = −Re/|λ|
  return {{l.real() / w, l.imag() / w},
          {-std::pow(l.imag(), 2) / std::pow(w, 3), l.real() * l.imag() / std::pow(w, 3)}};
}

}  // namespace

MatrixXd own_by_shared(const MatrixXd& normal, Index shared) {
  const Index own = normal.rows() - shared;
  const MatrixXd N = normal.bottomRightCorner(own, own), B = normal.bottomLeftCorner(own, shared);
  return numerics::solve_positive(N, B);
}

double lines_in_step(const FrequencyResponses& responses) {
  double count = 1.0;
  for (std::size_t d = 1; d < responses.line_covariance.size(); ++d)
    count += 2.0 * responses.line_covariance[d].real();
  return count;
}

MatrixXcd modelled(const ModalModel& model, const std::vector<PoleLines>& lines, Index line,
                   const FrequencyResponses& responses) {
  const double omega = two_pi * responses.frequency[static_cast<size_t>(line)];
  const Complex s = Complex(responses.shift, omega) / model.omega_scale;
  MatrixXcd H = MatrixXcd::Zero(responses.H[0].rows(), responses.H[0].cols());
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    const MatrixXcd A = model.modes[r].shape * model.modes[r].participation.transpose();
    H += lines[r].g[line] * A + lines[r].g_conjugate[line] * A.conjugate();
  }
  int power = lowest_residual_power;
  for (const auto& C : model.residuals) H += std::pow(s, power++) * C;
  return H;
}

void add_deviations(const FitSystem& system, const FrequencyResponses& responses,
                    const FitState& state, const FitOptions& options, double misfit,
                    ModalModel& model) {
  const Deviations asked = options.deviations;
  const Index modes = state.shared.poles.size(), shared = system.shared_count(modes);
  MatrixXd N = MatrixXd::Zero(shared, shared);
  std::vector<MatrixXd> X, own_inverse;
  for (const auto& normal : system.normals(state)) {
    const Index own = normal.matrix.rows() - shared;
    X.push_back(own_by_shared(normal.matrix, shared));
    if (asked == Deviations::all || responses.whole)
      own_inverse.push_back(numerics::inverse_positive(normal.matrix.bottomRightCorner(own, own)));
    N += normal.matrix.topLeftCorner(shared, shared) -
         numerics::times(normal.matrix.topRightCorner(shared, own), X.back());
  }
  const double scale = responses.has_errors() ? std::max(1.0, misfit) : misfit;
  const MatrixXd N_inverse = numerics::inverse_positive(N);
  const auto let_in = leakage_parts(responses, model, options);
  const Propagation propagation(system, responses, state, X, let_in);
  const auto variance = [&](const VectorXd& v) { return scale * propagation.variance(v); };
  std::optional<ShapeErrors> shape_errors;
  if (responses.whole) shape_errors.emplace(system, state, propagation, X, own_inverse, N_inverse);
  const VectorXd sizes = row_sizes(responses);
  const double neighbours = lines_in_step(responses);
  const bool by_parts = asked == Deviations::all && !let_in.D.empty();
  const auto own = by_parts ? own_derivatives(system, state) : std::vector<MatrixXd>();
  for (Index r = 0; r < modes; ++r) {
    auto& mode = model.modes[static_cast<size_t>(r)];
    const auto [omega, zeta] = frequency_and_damping(mode.pole);
    const auto pole = N_inverse.middleCols<2>(r * 2 * system.inputs());
    mode.omega_deviation = std::sqrt(variance(pole * omega));
    mode.damping_deviation = std::sqrt(variance(pole * zeta));
    if (shape_errors) mode.significance = shape_errors->significance(mode.shape, sizes, r) / scale;
    if (asked != Deviations::all) continue;
    if (shape_errors) {
      mode.shape_deviation = std::sqrt(scale) * shape_errors->deviations(mode.shape, r);
      continue;
    }
    mode.shape_deviation.resize(system.outputs());
    for (Index o = 0; o < system.outputs(); ++o) {
      const auto at = static_cast<size_t>(o);
      const MatrixXd by_poles = numerics::times(N_inverse, X[at].middleRows<2>(2 * r).transpose());
      const double of_own =
          let_in.D.empty()
              ? 0.5 * neighbours * own_inverse[at].block<2, 2>(2 * r, 2 * r).trace()
              : propagation.variance({own[at] * own_inverse[at].col(2 * r)}, o) +
                    propagation.variance({own[at] * own_inverse[at].col(2 * r + 1)}, o);
      mode.shape_deviation[o] =
          std::sqrt(variance(by_poles.col(0)) + variance(by_poles.col(1)) + scale * of_own);
    }
  }
}

}  // namespace hydrapod::identification
