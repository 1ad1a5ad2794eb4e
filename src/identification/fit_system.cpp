#include "fit_system.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/numerics/dense.hpp"
#include "line_weights.hpp"

namespace hydrapod::identification {

namespace {

using Columns = Eigen::Ref<const MatrixXd>;
constexpr Index chunk = 128;  // lines whose products are held at once

/// Re(aᴴ b).
MatrixXd real_inner(const Columns& a_re, const Columns& a_im, const Columns& b_re,
                    const Columns& b_im) {
  MatrixXd result = MatrixXd::Zero(a_re.cols(), b_re.cols());
  numerics::add_transposed_times(a_re, b_re, result);
  numerics::add_transposed_times(a_im, b_im, result);
  return result;
}

/// a + b and i (a − b) into columns `at` and the next.
void set_pair(const VectorXcd& a, const VectorXcd& b, Index at, Parts& columns) {
  columns.re.col(at) = a.real() + b.real();
  columns.im.col(at) = a.imag() + b.imag();
  columns.re.col(at + 1) = b.imag() - a.imag();
  columns.im.col(at + 1) = a.real() - b.real();
}

/// B with columns (c_a e_i …) to columns by the own parameters.
MatrixXd by_own(const Columns& B, const MatrixXcd& L) {
  const Index p = L.rows(), modes = L.cols(), residuals = B.cols() - 2 * modes * p;
  MatrixXd result(B.rows(), 2 * modes + residuals);
  for (Index r = 0; r < modes; ++r) {
    MatrixXd turn(2 * p, 2);  // of the columns (g + ḡ) e_i and i (g − ḡ) e_i
    turn << L.col(r).real(), -L.col(r).imag(), L.col(r).imag(), L.col(r).real();
    result.middleCols(2 * r, 2) = numerics::times(B.middleCols(2 * r * p, 2 * p), turn);
  }
  result.rightCols(residuals) = B.rightCols(residuals);
  return result;
}

/// B with columns (c_a e_i, d) to columns by all parameters of an output with the shape row φ.
MatrixXd by_parameters(const MatrixXd& B, const SharedParameters& shared, const VectorXcd& phi) {
  const Index p = shared.participations.rows(), modes = phi.size();
  const Index slopes = B.cols() - 2 * modes, own = 2 * modes + slopes - 2 * modes * p;
  MatrixXd result(B.rows(), modes * 2 * p + own);
  Index at = 0;
  for (Index r = 0; r < modes; ++r) {
    const auto add = [&](Index sum, Index difference) {
      result.col(at++) = phi[r].real() * B.col(sum) + phi[r].imag() * B.col(difference);
      result.col(at++) = phi[r].real() * B.col(difference) - phi[r].imag() * B.col(sum);
    };
    add(slopes + 2 * r, slopes + 2 * r + 1);
    for (Index i = 0; i < p; ++i)
      if (i != shared.fixed[static_cast<size_t>(r)]) add(2 * r * p + i, (2 * r + 1) * p + i);
  }
  result.rightCols(own) = by_own(B.leftCols(slopes), shared.participations);
  return result;
}

/// W of rows that are whitened, Wᴴ W = M.
MatrixXcd whitening_of(const FrequencyResponses& r, std::size_t line) {
  const Index p = r.H[0].cols();
  if (!r.excitation.empty()) {  // what is seen of rows e_o is e_oᵀ U alone
    MatrixXcd W = MatrixXcd::Zero(p, p);
    W.row(p - 1) = r.excitation[line].transpose();
    return W;
  }
  if (!r.has_errors()) return MatrixXcd::Identity(p, p);
  MatrixXcd Q = r.input_factor[line].transpose();
  Q /= Q.diagonal().real().mean();
  Q.diagonal().array() += 1e-12;
  return numerics::inverse_factor(Q);
}

/// Coefficients a p + i as a matrix, functions × inputs.
MatrixXd by_function(const VectorXd& coefficients, Index inputs) {
  return coefficients.reshaped(inputs, coefficients.size() / inputs).transpose();
}

}  // namespace

MatrixXcd product(const Parts& left, Index first, const MatrixXd& right) {
  const MatrixXd re = numerics::times(left.re.middleCols(first, right.rows()), right);
  const MatrixXd im = numerics::times(left.im.middleCols(first, right.rows()), right);
  MatrixXcd both(re.rows(), re.cols());
  both.real() = re;
  both.imag() = im;
  return both;
}

void SharedParameters::step(const VectorXd& change) {
  Index at = 0;
  for (Index r = 0; r < poles.size(); ++r) {
    poles[r] += Complex(change[at], change[at + 1]);
    at += 2;
    for (Index i = 0; i < participations.rows(); ++i) {
      if (i == fixed[static_cast<size_t>(r)]) continue;
      participations(i, r) += Complex(change[at], change[at + 1]);
      at += 2;
    }
  }
}

FitSystem::FitSystem(const FrequencyResponses& r, const FitOptions& options)
    : responses_(r),
      pole_basis_(r, options.taper),
      residual_terms_(options.highest_residual_power - lowest_residual_power + 1),
      inputs_(r.H[0].cols()),
      outputs_(r.H[0].rows()),
      lines_(static_cast<Index>(r.lines())),
      numbers_(identification::numbers_per_line(r)),
      omega_scale_(two_pi * r.frequency.back()),
      M_(lines_, inputs_ * inputs_),
      data_(lines_, outputs_ * inputs_) {
  // row_weights hold one over the variance averaged over inputs; W takes the inputs' part of it
  const MatrixXd weight = row_weights(r, false);
  deviation_ = weight.cwiseSqrt().cwiseInverse();
  for (Index k = 0; k < lines_; ++k) {
    MatrixXcd W = whitening_of(r, static_cast<std::size_t>(k));
    for (Index i = 0; i < inputs_; ++i)
      for (Index j = 0; j < inputs_; ++j) M_(k, i * inputs_ + j) = W.col(i).dot(W.col(j));
    data_.row(k) = r.H[static_cast<size_t>(k)].reshaped<Eigen::RowMajor>().transpose();
    white_.push_back(std::move(W));
  }
  for (Index i = 0; i < inputs_; ++i) pairs_.push_back({i, i});
  for (Index i = 0; i < inputs_; ++i)
    for (Index j = i + 1; j < inputs_; ++j)
      if (!M_.col(i * inputs_ + j).isZero(0.0)) pairs_.push_back({i, j});
  data_gradient_ = Parts(weighted(data_));
}

/// w_o M_ij of some lines: of all pairs, and of those i < j.
Parts FitSystem::weights(Index first, Index lines) const {
  const Index count = std::ssize(pairs_), off = count - inputs_;
  Parts result;
  result.re.resize(lines, outputs_ * count);
  result.im.resize(lines, outputs_ * off);
  const MatrixXd weight = deviation_.middleRows(first, lines).cwiseAbs2().cwiseInverse();
  for (Index n = 0; n < count; ++n) {
    const auto [i, j] = pairs_[static_cast<std::size_t>(n)];
    const auto M_ij = M_.col(i * inputs_ + j).segment(first, lines);
    const VectorXd re = M_ij.real(), im = M_ij.imag();
    for (Index o = 0; o < outputs_; ++o) {
      result.re.col(o * count + n) = weight.col(o).cwiseProduct(re);
      if (j > i) result.im.col(o * off + n - inputs_) = weight.col(o).cwiseProduct(im);
    }
  }
  return result;
}

/// w_o M e_o for rows e_o, laid out as the residual.
MatrixXcd FitSystem::weighted(const MatrixXcd& rows) const {
  MatrixXcd result = MatrixXcd::Zero(rows.rows(), rows.cols());
  for (Index o = 0; o < outputs_; ++o)
    for (Index i = 0; i < inputs_; ++i) {
      auto column = result.col(o * inputs_ + i);
      for (Index j = 0; j < inputs_; ++j)
        column += M_.col(i * inputs_ + j).cwiseProduct(rows.col(o * inputs_ + j));
      column.array() /= deviation_.col(o).array().square();
    }
  return result;
}

/// Σ w_o Re(c_a* c_b M_ij) for all outputs.
void FitSystem::add_gram(FitState& state) const {
  const auto& c = state.functions;
  const Index n = c.re.cols(), p = inputs_, pairs = std::ssize(pairs_), off = pairs - p;
  MatrixXd re(chunk, n * (n + 1) / 2), im(off > 0 ? chunk : 0, re.cols());
  MatrixXd even = MatrixXd::Zero(re.cols(), outputs_ * pairs),
           odd = MatrixXd::Zero(im.cols(), outputs_ * off);
  for (Index first = 0; first < lines_; first += chunk) {
    const Index count = std::min(chunk, lines_ - first);
    for (Index b = 0, at = 0; b < n; ++b)
      for (Index a = 0; a <= b; ++a, ++at) {
        const auto some = [&](const MatrixXd& m, Index column) {
          return m.col(column).segment(first, count).array();
        };
        re.col(at).head(count) = some(c.re, a) * some(c.re, b) + some(c.im, a) * some(c.im, b);
        if (off > 0)
          im.col(at).head(count) = some(c.re, a) * some(c.im, b) - some(c.im, a) * some(c.re, b);
      }
    const Parts some_weights = weights(first, count);
    numerics::add_transposed_times(re.topRows(count), some_weights.re, even);
    if (off > 0) numerics::add_transposed_times(im.topRows(count), some_weights.im, odd);
  }
  state.gram.assign(static_cast<size_t>(outputs_), MatrixXd::Zero(n * p, n * p));
  for (Index o = 0; o < outputs_; ++o) {
    auto& G = state.gram[static_cast<size_t>(o)];
    for (Index b = 0, at = 0; b < n; ++b)
      for (Index a = 0; a <= b; ++a, ++at)
        for (Index pair = 0; pair < pairs; ++pair) {
          const auto [i, j] = pairs_[static_cast<std::size_t>(pair)];
          const double same = even(at, o * pairs + pair),
                       turned = i == j ? 0.0 : odd(at, o * off + pair - p);
          G(a * p + i, b * p + j) = G(b * p + j, a * p + i) = same - turned;
          G(a * p + j, b * p + i) = G(b * p + i, a * p + j) = same + turned;
        }
  }
}

/// The own parameters that leave least, and what they leave.
void FitSystem::solve_own(FitState& state) const {
  const auto& L = state.shared.participations;
  const Index modes = L.cols(), p = inputs_;
  const auto& c = state.functions;
  const MatrixXd gradient = real_inner(c.re, c.im, data_gradient_.re, data_gradient_.im);
  MatrixXd coefficients(c.re.cols(), data_.cols());
  const MatrixXd T = by_own(MatrixXd::Identity(state.gram[0].rows(), state.gram[0].cols()), L);
  state.mode_power = VectorXd::Zero(modes);
  for (Index o = 0; o < outputs_; ++o) {
    const MatrixXd N = by_own(by_own(state.gram[static_cast<size_t>(o)], L).transpose(), L);
    const VectorXd by_column = gradient.middleCols(o * p, p).reshaped<Eigen::RowMajor>();
    const VectorXd b = T.transpose() * by_column;
    const VectorXd x = numerics::solve_positive(N, b);
    coefficients.middleCols(o * p, p) = by_function(T * x, p);
    for (Index r = 0; r < modes; ++r)
      state.mode_power[r] +=
          x.segment<2>(2 * r).dot(N.block<2, 2>(2 * r, 2 * r) * x.segment<2>(2 * r));
    state.own.push_back(x);
  }
  state.residual = data_ - product(c, 0, coefficients);
  state.cost = state.residual.conjugate().cwiseProduct(weighted(state.residual)).real().sum();
}

PoleLines FitSystem::lines_of(Complex pole, const FitState* before) const {
  if (before != nullptr)
    for (Index r = 0; r < before->shared.poles.size(); ++r)
      if (before->shared.poles[r] == pole) return before->lines[static_cast<size_t>(r)];
  return pole_basis_.at(pole);
}

FitState FitSystem::solved(SharedParameters shared, const FitState* before) const {
  FitState state;
  state.shared = std::move(shared);
  const Index modes = state.shared.poles.size();
  state.functions = Parts(lines_, 2 * modes + residual_terms_);
  for (Index r = 0; r < modes; ++r) {
    state.lines.push_back(lines_of(state.shared.poles[r], before));
    const auto& lines = state.lines.back();
    set_pair(lines.g, lines.g_conjugate, 2 * r, state.functions);
  }
  for (Index k = 0; k < lines_; ++k) {
    const double omega = two_pi * responses_.frequency[static_cast<size_t>(k)];
    const Complex s = Complex(responses_.shift, omega) / omega_scale_;
    for (int t = 0; t < residual_terms_; ++t) {
      const Complex power = std::pow(s, t + lowest_residual_power);
      state.functions.re(k, 2 * modes + t) = power.real();
      state.functions.im(k, 2 * modes + t) = power.imag();
    }
  }
  add_gram(state);
  solve_own(state);
  return state;
}

Parts FitSystem::slopes(const FitState& state) const {
  const auto& L = state.shared.participations;
  const Index modes = L.cols();
  Parts d(lines_, inputs_ * 2 * modes);
  for (Index i = 0; i < inputs_; ++i)
    for (Index r = 0; r < modes; ++r) {
      const auto& lines = state.lines[static_cast<size_t>(r)];
      set_pair(L(i, r) * lines.slope, std::conj(L(i, r)) * lines.slope_conjugate,
               i * 2 * modes + 2 * r, d);
    }
  return d;
}

/// M d.
Parts FitSystem::times_weight(const Parts& slopes) const {
  const Index count = slopes.re.cols() / inputs_;
  Parts turned;
  turned.re = turned.im = MatrixXd::Zero(lines_, slopes.re.cols());
  for (Index i = 0; i < inputs_; ++i)
    for (Index j = 0; j < inputs_; ++j) {
      const VectorXd re = M_.col(i * inputs_ + j).real(), im = M_.col(i * inputs_ + j).imag();
      for (Index c = 0; c < count; ++c) {
        const auto d_re = slopes.re.col(j * count + c), d_im = slopes.im.col(j * count + c);
        turned.re.col(i * count + c) += re.cwiseProduct(d_re) - im.cwiseProduct(d_im);
        turned.im.col(i * count + c) += re.cwiseProduct(d_im) + im.cwiseProduct(d_re);
      }
    }
  return turned;
}

/// The Gram matrix of all columns of an output. `turned`: M d.
MatrixXd FitSystem::with_slopes(const FitState& state, const Parts& slopes, const Parts& turned,
                                Index output) const {
  const auto& c = state.functions;
  const Index n = c.re.cols(), count = slopes.re.cols() / inputs_, p = inputs_;
  const VectorXd weight = deviation_.col(output).cwiseAbs2().cwiseInverse();
  const MatrixXd re = weight.asDiagonal() * turned.re, im = weight.asDiagonal() * turned.im;
  const MatrixXd mixed = real_inner(re, im, c.re, c.im);  // i · count + number, a
  MatrixXd G(n * p + count, n * p + count);
  G.topLeftCorner(n * p, n * p) = state.gram[static_cast<size_t>(output)];
  G.bottomRightCorner(count, count).setZero();
  for (Index i = 0; i < p; ++i) {
    const Index at = i * count;
    for (Index a = 0; a < n; ++a) G.col(a * p + i).tail(count) = mixed.col(a).segment(at, count);
    G.bottomRightCorner(count, count) +=
        real_inner(re.middleCols(at, count), im.middleCols(at, count),
                   slopes.re.middleCols(at, count), slopes.im.middleCols(at, count));
  }
  G.topRightCorner(n * p, count) = G.bottomLeftCorner(count, n * p).transpose();
  return G;
}

std::vector<FitSystem::Normal> FitSystem::normals(const FitState& state) const {
  const auto& c = state.functions;
  const Parts d = slopes(state), turned = times_weight(d), e(weighted(state.residual));
  const Index n = c.re.cols(), p = inputs_, count = d.re.cols() / p;
  const MatrixXd by_functions = real_inner(c.re, c.im, e.re, e.im);
  std::vector<Normal> all;
  for (Index o = 0; o < outputs_; ++o) {
    const VectorXcd phi = shape_row(state.own[static_cast<size_t>(o)], count / 2);
    MatrixXd gradient(1, n * p + count);
    gradient.leftCols(n * p) =
        by_functions.middleCols(o * p, p).reshaped<Eigen::RowMajor>().transpose();
    gradient.rightCols(count).setZero();
    for (Index i = 0; i < p; ++i)
      gradient.rightCols(count) +=
          real_inner(e.re.col(o * p + i), e.im.col(o * p + i), d.re.middleCols(i * count, count),
                     d.im.middleCols(i * count, count));
    const MatrixXd half =
        by_parameters(with_slopes(state, d, turned, o), state.shared, phi).transpose();
    all.push_back({by_parameters(half, state.shared, phi).transpose(),
                   by_parameters(gradient, state.shared, phi).transpose()});
  }
  return all;
}

MatrixXd FitSystem::derivatives(const FitState& state, Index output) const {
  const Index modes = state.shared.poles.size();
  const Index size = state.functions.re.cols() * inputs_ + 2 * modes;
  return by_parameters(MatrixXd::Identity(size, size), state.shared,
                       shape_row(state.own[static_cast<size_t>(output)], modes));
}

VectorXcd shape_row(const VectorXd& own, Index modes) {
  VectorXcd phi(modes);
  for (Index r = 0; r < modes; ++r) phi[r] = {own[2 * r], own[2 * r + 1]};
  return phi;
}

}  // namespace hydrapod::identification
