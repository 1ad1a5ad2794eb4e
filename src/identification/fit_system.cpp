#include "fit_system.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "line_weights.hpp"

namespace hydrapod::identification {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

constexpr Complex i_unit{0.0, 1.0};
constexpr Index chunk = 128;  // lines whose products are held at once

/// B with columns (c_a e_i …) to columns by the own parameters.
MatrixXd by_own(const Eigen::Ref<const MatrixXd>& B, const MatrixXcd& L) {
  const Index p = L.rows(), modes = L.cols(), residuals = B.cols() - 2 * modes * p;
  MatrixXd result(B.rows(), 2 * modes + residuals);
  for (Index r = 0; r < modes; ++r) {
    const auto sum = B.middleCols(2 * r * p, p), difference = B.middleCols((2 * r + 1) * p, p);
    const VectorXd x = L.col(r).real(), y = L.col(r).imag();
    result.col(2 * r) = sum * x + difference * y;
    result.col(2 * r + 1) = difference * x - sum * y;
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

/// Coefficients a p + i as a matrix, functions × inputs.
MatrixXd by_function(const VectorXd& coefficients, Index inputs) {
  return coefficients.reshaped(inputs, coefficients.size() / inputs).transpose();
}

}  // namespace

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
      omega_scale_(base::two_pi * r.frequency.back()),
      M_(lines_, inputs_ * inputs_),
      weights_re_(lines_, outputs_ * inputs_ * (inputs_ + 1) / 2),
      weights_im_(lines_, weights_re_.cols()),
      data_(lines_, outputs_ * inputs_) {
  // row_weights hold one over the variance averaged over inputs; W takes the inputs' part of it
  const MatrixXd weight = row_weights(r, false);
  deviation_ = weight.cwiseSqrt().cwiseInverse();
  for (Index k = 0; k < lines_; ++k) {
    MatrixXcd W = MatrixXcd::Identity(inputs_, inputs_);
    if (r.has_errors()) {
      MatrixXcd Q = r.input_factor[static_cast<size_t>(k)].transpose();
      Q /= Q.diagonal().real().mean();
      Q.diagonal().array() += 1e-12;
      W = Q.llt().matrixL().solve(W);
    }
    const MatrixXcd M = W.adjoint() * W;
    for (Index i = 0, pair = 0; i < inputs_; ++i)
      for (Index j = 0; j < inputs_; ++j) {
        M_(k, i * inputs_ + j) = M(i, j);
        if (j < i) continue;
        for (Index o = 0; o < outputs_; ++o) {
          const Index at = o * inputs_ * (inputs_ + 1) / 2 + pair;
          weights_re_(k, at) = weight(k, o) * M(i, j).real();
          weights_im_(k, at) = weight(k, o) * M(i, j).imag();
        }
        ++pair;
      }
    data_.row(k) = r.H[static_cast<size_t>(k)].reshaped<Eigen::RowMajor>().transpose();
    white_.push_back(std::move(W));
  }
  const MatrixXcd gradient = weighted(data_);
  data_gradient_re_ = gradient.real();
  data_gradient_im_ = gradient.imag();
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
  const Index n = c.cols(), p = inputs_, pairs = p * (p + 1) / 2;
  MatrixXd re(chunk, n * (n + 1) / 2), im(chunk, re.cols());
  MatrixXd even = MatrixXd::Zero(re.cols(), weights_re_.cols()), odd = even;
  for (Index first = 0; first < lines_; first += chunk) {
    const Index count = std::min(chunk, lines_ - first);
    for (Index b = 0, at = 0; b < n; ++b)
      for (Index a = 0; a <= b; ++a, ++at) {
        const VectorXcd product =
            c.col(a).segment(first, count).conjugate().cwiseProduct(c.col(b).segment(first, count));
        re.col(at).head(count) = product.real();
        im.col(at).head(count) = product.imag();
      }
    even.noalias() += re.topRows(count).transpose() * weights_re_.middleRows(first, count);
    odd.noalias() += im.topRows(count).transpose() * weights_im_.middleRows(first, count);
  }
  state.gram.assign(static_cast<size_t>(outputs_), MatrixXd(n * p, n * p));
  for (Index o = 0; o < outputs_; ++o) {
    auto& G = state.gram[static_cast<size_t>(o)];
    for (Index b = 0, at = 0; b < n; ++b)
      for (Index a = 0; a <= b; ++a, ++at)
        for (Index i = 0, pair = o * pairs; i < p; ++i)
          for (Index j = i; j < p; ++j, ++pair) {
            const double same = even(at, pair), turned = odd(at, pair);
            G(a * p + i, b * p + j) = G(b * p + j, a * p + i) = same - turned;
            G(a * p + j, b * p + i) = G(b * p + i, a * p + j) = same + turned;
          }
  }
}

/// The own parameters that leave least, and what they leave.
void FitSystem::solve_own(FitState& state) const {
  const auto& L = state.shared.participations;
  const Index modes = L.cols(), p = inputs_;
  const MatrixXd gradient = state.functions.real().transpose() * data_gradient_re_ +
                            state.functions.imag().transpose() * data_gradient_im_;
  MatrixXd coefficients(state.functions.cols(), data_.cols());
  const MatrixXd T = by_own(MatrixXd::Identity(state.gram[0].rows(), state.gram[0].cols()), L);
  state.mode_power = VectorXd::Zero(modes);
  for (Index o = 0; o < outputs_; ++o) {
    const MatrixXd N = by_own(by_own(state.gram[static_cast<size_t>(o)], L).transpose(), L);
    const VectorXd b = T.transpose() * gradient.middleCols(o * p, p).reshaped<Eigen::RowMajor>();
    const VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    MatrixXd scaled = scale.asDiagonal() * N * scale.asDiagonal();
    scaled.diagonal().array() += 1e-14;
    const VectorXd x = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * b);
    coefficients.middleCols(o * p, p) = by_function(T * x, p);
    for (Index r = 0; r < modes; ++r)
      state.mode_power[r] +=
          x.segment<2>(2 * r).dot(N.block<2, 2>(2 * r, 2 * r) * x.segment<2>(2 * r));
    state.own.push_back(x);
  }
  state.residual = data_ - state.functions * coefficients;
  state.cost = state.residual.conjugate().cwiseProduct(weighted(state.residual)).real().sum();
}

FitState FitSystem::solved(SharedParameters shared) const {
  FitState state;
  state.shared = std::move(shared);
  const Index modes = state.shared.poles.size();
  state.functions.resize(lines_, 2 * modes + residual_terms_);
  for (Index r = 0; r < modes; ++r) {
    state.lines.push_back(pole_basis_.at(state.shared.poles[r]));
    const auto& lines = state.lines.back();
    state.functions.col(2 * r) = lines.g + lines.g_conjugate;
    state.functions.col(2 * r + 1) = i_unit * (lines.g - lines.g_conjugate);
  }
  for (Index k = 0; k < lines_; ++k) {
    const double omega = base::two_pi * responses_.frequency[static_cast<size_t>(k)];
    const Complex s = Complex(responses_.shift, omega) / omega_scale_;
    for (int t = 0; t < residual_terms_; ++t)
      state.functions(k, 2 * modes + t) = std::pow(s, t + lowest_residual_power);
  }
  add_gram(state);
  solve_own(state);
  return state;
}

MatrixXcd FitSystem::slopes(const FitState& state) const {
  const auto& L = state.shared.participations;
  const Index modes = L.cols();
  MatrixXcd d(lines_, inputs_ * 2 * modes);
  for (Index i = 0; i < inputs_; ++i)
    for (Index r = 0; r < modes; ++r) {
      const auto& lines = state.lines[static_cast<size_t>(r)];
      const VectorXcd a = L(i, r) * lines.slope, b = std::conj(L(i, r)) * lines.slope_conjugate;
      d.col(i * 2 * modes + 2 * r) = a + b;
      d.col(i * 2 * modes + 2 * r + 1) = i_unit * (a - b);
    }
  return d;
}

/// The Gram matrix of all columns of an output. `turned`: M d.
MatrixXd FitSystem::with_slopes(const FitState& state, const MatrixXcd& slopes,
                                const MatrixXcd& turned, Index output) const {
  const Index n = state.functions.cols(), count = slopes.cols() / inputs_, p = inputs_;
  const VectorXd weight = deviation_.col(output).cwiseAbs2().cwiseInverse();
  const MatrixXd re = weight.asDiagonal() * turned.real(), im = weight.asDiagonal() * turned.imag();
  const MatrixXd mixed = re.transpose() * state.functions.real() +
                         im.transpose() * state.functions.imag();  // i · count + number, a
  MatrixXd G(n * p + count, n * p + count);
  G.topLeftCorner(n * p, n * p) = state.gram[static_cast<size_t>(output)];
  G.bottomRightCorner(count, count).setZero();
  for (Index i = 0; i < p; ++i) {
    for (Index a = 0; a < n; ++a)
      G.col(a * p + i).tail(count) = mixed.col(a).segment(i * count, count);
    const auto d = slopes.middleCols(i * count, count);
    G.bottomRightCorner(count, count).noalias() +=
        re.middleCols(i * count, count).transpose() * d.real() +
        im.middleCols(i * count, count).transpose() * d.imag();
  }
  G.topRightCorner(n * p, count) = G.bottomLeftCorner(count, n * p).transpose();
  return G;
}

std::vector<FitSystem::Normal> FitSystem::normals(const FitState& state) const {
  const MatrixXcd d = slopes(state), e = weighted(state.residual);
  const Index n = state.functions.cols(), p = inputs_, count = d.cols() / p;
  MatrixXcd turned = MatrixXcd::Zero(lines_, d.cols());
  for (Index i = 0; i < p; ++i)
    for (Index j = 0; j < p; ++j)
      turned.middleCols(i * count, count) +=
          M_.col(i * p + j).asDiagonal() * d.middleCols(j * count, count);
  const MatrixXd by_functions = (state.functions.adjoint() * e).real();
  std::vector<Normal> all;
  for (Index o = 0; o < outputs_; ++o) {
    const VectorXcd phi = shape_row(state.own[static_cast<size_t>(o)], count / 2);
    MatrixXd gradient(1, n * p + count);
    gradient.leftCols(n * p) =
        by_functions.middleCols(o * p, p).reshaped<Eigen::RowMajor>().transpose();
    gradient.rightCols(count).setZero();
    for (Index i = 0; i < p; ++i)
      gradient.rightCols(count) +=
          (d.middleCols(i * count, count).adjoint() * e.col(o * p + i)).real().transpose();
    const MatrixXd half =
        by_parameters(with_slopes(state, d, turned, o), state.shared, phi).transpose();
    all.push_back({by_parameters(half, state.shared, phi).transpose(),
                   by_parameters(gradient, state.shared, phi).transpose()});
  }
  return all;
}

MatrixXd FitSystem::derivatives(const FitState& state, Index output) const {
  const Index modes = state.shared.poles.size();
  const Index size = state.functions.cols() * inputs_ + 2 * modes;
  return by_parameters(MatrixXd::Identity(size, size), state.shared,
                       shape_row(state.own[static_cast<size_t>(output)], modes));
}

VectorXcd shape_row(const VectorXd& own, Index modes) {
  VectorXcd phi(modes);
  for (Index r = 0; r < modes; ++r) phi[r] = {own[2 * r], own[2 * r + 1]};
  return phi;
}

}  // namespace hydrapod::identification
