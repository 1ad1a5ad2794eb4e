#include "fit_covariance.hpp"

#include <cmath>
#include <utility>

#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::identification {

namespace {

/// Variances of what the errors of all lines make of functions of the shared parameters: own ones
/// are eliminated, output o's by `X`.
class Propagation {
 public:
  Propagation(const FitSystem& system, const FrequencyResponses& responses, const FitState& state,
              const std::vector<MatrixXd>& X)
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
    add_coherence();
  }

  /// vᵀ Jᵀ cov(e) J v.
  [[nodiscard]] double variance(const VectorXd& v) const {
    const MatrixXcd F = changes(v), S = smoothed(F);
    const Index p = system_.inputs(), outputs = system_.outputs();
    double sum = 0.0;
    for (Index o = 0; o < outputs; ++o)
      for (Index q = 0; q < outputs; ++q) {
        if (!responses_.has_errors() && o != q) continue;
        const VectorXcd product =
            F.middleCols(o * p, p).conjugate().cwiseProduct(S.middleCols(q * p, p)).rowwise().sum();
        sum += coherence_.col(o * outputs + q).cwiseProduct(product).real().sum();
      }
    return 0.5 * sum;
  }

 private:
  /// The outputs' noise, each to its own deviation: cov(e_o, e_p*), o outputs + p.
  void add_coherence() {
    const Index outputs = system_.outputs();
    coherence_ = MatrixXcd::Ones(system_.lines(), outputs * outputs);
    if (!responses_.has_errors()) return;
    const auto& deviation = system_.deviation();
    for (Index k = 0; k < system_.lines(); ++k) {
      const auto& S = responses_.noise[static_cast<size_t>(k)];
      const double Q = responses_.input_factor[static_cast<size_t>(k)].diagonal().real().mean();
      for (Index o = 0; o < outputs; ++o)
        for (Index p = 0; p < outputs; ++p)
          coherence_(k, o * outputs + p) = S(o, p) * Q / (deviation(k, o) * deviation(k, p));
    }
  }

  /// J v, whitened: entry o p + i, a row per line.
  [[nodiscard]] MatrixXcd changes(const VectorXd& v) const {
    const Index p = system_.inputs(), outputs = system_.outputs();
    const Index n = state_.functions.re.cols(), count = slopes_.re.cols() / p;
    MatrixXd by_functions(n, p * outputs), by_slopes(count, outputs);
    for (Index o = 0; o < outputs; ++o) {
      const VectorXd c = derivatives_[static_cast<size_t>(o)] * v;
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
        column.array() /= system_.deviation().col(o).array();
      }
    return white;
  }

  /// Each line with its neighbours, as their noise goes together.
  [[nodiscard]] MatrixXcd smoothed(const MatrixXcd& F) const {
    const auto& a = responses_.line_covariance;
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
  std::vector<MatrixXd> derivatives_;  // of the columns (c_a e_i, d), by the shared parameters
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

VectorXd row_sizes(const FrequencyResponses& responses) {
  VectorXd sum = VectorXd::Zero(responses.H[0].rows());
  for (const auto& H : responses.H) sum += H.rowwise().squaredNorm();
  return (sum / static_cast<double>(responses.lines())).cwiseSqrt().cwiseMax(1e-300);
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
                    const FitState& state, Deviations asked, double misfit, ModalModel& model) {
  const Index modes = state.shared.poles.size(), shared = system.shared_count(modes);
  MatrixXd N = MatrixXd::Zero(shared, shared);
  std::vector<MatrixXd> X, own_inverse;
  for (const auto& normal : system.normals(state)) {
    const Index own = normal.matrix.rows() - shared;
    X.push_back(own_by_shared(normal.matrix, shared));
    if (asked == Deviations::all)
      own_inverse.push_back(numerics::inverse_positive(normal.matrix.bottomRightCorner(own, own)));
    N += normal.matrix.topLeftCorner(shared, shared) -
         numerics::times(normal.matrix.topRightCorner(shared, own), X.back());
  }
  const double scale = responses.has_errors() ? std::max(1.0, misfit) : misfit;
  const MatrixXd N_inverse = numerics::inverse_positive(N);
  const Propagation propagation(system, responses, state, X);
  const auto variance = [&](const VectorXd& v) {
    return scale * std::max(0.0, propagation.variance(v));
  };
  const double neighbours = lines_in_step(responses);
  for (Index r = 0; r < modes; ++r) {
    auto& mode = model.modes[static_cast<size_t>(r)];
    const auto [omega, zeta] = frequency_and_damping(mode.pole);
    const auto pole = N_inverse.middleCols<2>(r * 2 * system.inputs());
    mode.omega_deviation = std::sqrt(variance(pole * omega));
    mode.damping_deviation = std::sqrt(variance(pole * zeta));
    if (asked != Deviations::all) continue;
    mode.shape_deviation.resize(system.outputs());
    for (Index o = 0; o < system.outputs(); ++o) {
      const auto at = static_cast<size_t>(o);
      const MatrixXd by_poles = numerics::times(N_inverse, X[at].middleRows<2>(2 * r).transpose());
      mode.shape_deviation[o] =
          std::sqrt(variance(by_poles.col(0)) + variance(by_poles.col(1)) +
                    0.5 * scale * neighbours * own_inverse[at].block<2, 2>(2 * r, 2 * r).trace());
    }
  }
}

}  // namespace hydrapod::identification
