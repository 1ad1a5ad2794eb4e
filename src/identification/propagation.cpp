#include "propagation.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::identification {

namespace {

/// Rounding taken away; what is no number stays none.
double not_below_zero(double variance) { return variance < 0.0 ? 0.0 : variance; }

Parts transposed(const Parts& parts) {
  Parts result;
  result.re = parts.re.transpose();
  result.im = parts.im.transpose();
  return result;
}

}  // namespace

/// Complex numbers of lines `from` to `to`, a row for each function. The columns of line k and
/// input i are a block: `width` real parts, then as many imaginary ones.
struct Propagation::Stack {
  MatrixXd values;
  Index from, to, inputs, width;

  Stack(Index functions, Index first, Index last, Index p, Index numbers)
      : values(functions, (last - first) * p * 2 * numbers),
        from(first),
        to(last),
        inputs(p),
        width(numbers) {}

  [[nodiscard]] Index at(Index line, Index input) const {
    return ((line - from) * inputs + input) * 2 * width;
  }
  auto block(Index line, Index input) { return values.middleCols(at(line, input), 2 * width); }
  [[nodiscard]] auto block(Index line, Index input) const {
    return values.middleCols(at(line, input), 2 * width);
  }
  [[nodiscard]] auto lines(Index first, Index last) const {
    return values.middleCols(at(first, 0), at(last, 0) - at(first, 0));
  }

  /// Σ_d a_d f(k + d) of some of the lines, a_−d = a_d*; none lies beyond these.
  [[nodiscard]] Stack smoothed(Index first, Index last, std::span<const Complex> a) const {
    Stack result(values.rows(), first, last, inputs, width);
    result.values.setZero();
    const auto reach = static_cast<Index>(a.size()) - 1;
    for (Index k = first; k < last; ++k)
      for (Index other = std::max(from, k - reach); other < std::min(to, k + reach + 1); ++other) {
        const Complex along = a[static_cast<std::size_t>(std::abs(other - k))];
        const double re = along.real(), im = other < k ? -along.imag() : along.imag();
        for (Index i = 0; i < inputs; ++i) {
          const auto f = block(other, i);
          auto s = result.block(k, i);
          s += re * f;
          if (im == 0.0) continue;
          s.leftCols(width) -= im * f.rightCols(width);
          s.rightCols(width) += im * f.leftCols(width);
        }
      }
    return result;
  }

  /// The conjugates, the input and the number within the block exchanged.
  [[nodiscard]] Stack exchanged(Index first, Index last) const {
    Stack result(values.rows(), first, last, inputs, width);
    for (Index k = first; k < last; ++k)
      for (Index i = 0; i < inputs; ++i)
        for (Index j = 0; j < width; ++j) {
          result.block(k, i).col(j) = block(k, j).col(i);
          result.block(k, i).col(width + j) = -block(k, j).col(width + i);
        }
    return result;
  }
};

/// Σ Re f* s over all lines: of all pairs of functions, or of each with itself, a column.
struct Propagation::Sums {
  MatrixXd noise, let_in, related;
};

Propagation::Propagation(const FitSystem& system, const FrequencyResponses& responses,
                         const FitState& state, const std::vector<MatrixXd>& X,
                         const LeakageParts& let_in)
    : system_(system),
      responses_(responses),
      let_in_(let_in),
      functions_(transposed(state.functions)),
      slopes_(transposed(system.slopes(state))) {
  const Index shared = system.shared_count(state.shared.poles.size());
  for (Index o = 0; o < system.outputs(); ++o) {
    const MatrixXd T = system.derivatives(state, o);
    derivatives_.push_back(T.leftCols(shared) - numerics::times(T.rightCols(T.cols() - shared),
                                                                X[static_cast<size_t>(o)]));
  }
  if (responses.whole)
    errors_.emplace(responses, state.shared.poles);
  else if (responses.has_errors())
    add_noise();
}

/// What the noise beside leakage, and what windows let in, is multiplied by.
void Propagation::add_noise() {
  by_leakage_.resize(system_.outputs(), system_.lines());
  for (Index k = 0; k < system_.lines(); ++k)
    by_leakage_.col(k) =
        std::sqrt(responses_.input_factor[static_cast<std::size_t>(k)].diagonal().real().mean()) *
        system_.deviation().row(k).cwiseInverse().transpose();
  by_noise_ = by_leakage_;
  if (!let_in_.D.empty()) by_noise_.array() *= (1.0 - let_in_.share.array()).sqrt().transpose();
}

/// s ← C s.
void Propagation::apply_coherence(Stack& stack, Index first) const {
  const Index outputs = stack.width;
  MatrixXd C(2 * outputs, 2 * outputs), product;
  for (Index k = stack.from; k < stack.to; ++k) {
    const auto by_noise = by_noise_.col(k).segment(first, outputs);
    const MatrixXcd of_line = by_noise.asDiagonal() *
                              responses_.noise[static_cast<std::size_t>(k)]
                                  .block(first, first, outputs, outputs)
                                  .transpose() *
                              by_noise.asDiagonal();
    C.topLeftCorner(outputs, outputs) = of_line.real();
    C.bottomRightCorner(outputs, outputs) = of_line.real();
    C.topRightCorner(outputs, outputs) = of_line.imag();
    C.bottomLeftCorner(outputs, outputs) = -of_line.imag();
    for (Index i = 0; i < stack.inputs; ++i) {
      product = numerics::times(stack.block(k, i), C);
      stack.block(k, i) = product;
    }
  }
}

/// Dᴴ f: a number for each input j.
Propagation::Stack Propagation::let_in_by(const Stack& stack, Index first) const {
  const Index outputs = stack.width, p = stack.inputs;
  Stack result(stack.values.rows(), stack.from, stack.to, p, p);
  MatrixXd D(2 * outputs, 2 * p);
  for (Index k = stack.from; k < stack.to; ++k) {
    const MatrixXcd of_line = by_leakage_.col(k).segment(first, outputs).asDiagonal() *
                              let_in_.D[static_cast<std::size_t>(k)].middleRows(first, outputs);
    D.topLeftCorner(outputs, p) = of_line.real();
    D.bottomRightCorner(outputs, p) = of_line.real();
    D.topRightCorner(outputs, p) = -of_line.imag();
    D.bottomLeftCorner(outputs, p) = of_line.imag();
    for (Index i = 0; i < p; ++i) result.block(k, i) = numerics::times(stack.block(k, i), D);
  }
  return result;
}

/// The columns times their factors, whitened.
Propagation::Stack Propagation::changes(const Factors& factors, Index first, Index from,
                                        Index to) const {
  const Index p = system_.inputs(), outputs = std::ssize(factors), m = factors[0].cols(),
              n = functions_.re.rows(), count = slopes_.re.rows() / p, lines = to - from;
  Stack stack(m, from, to, p, outputs);
  MatrixXd by_functions(p * m, n), by_slopes(m, count);
  for (Index o = 0; o < outputs; ++o) {
    const auto& c = factors[static_cast<std::size_t>(o)];
    for (Index i = 0; i < p; ++i)
      by_functions.middleRows(i * m, m) = c(Eigen::seqN(i, n, p), Eigen::all).transpose();
    by_slopes = c.bottomRows(count).transpose();
    const auto plain = [&](const MatrixXd& functions, const MatrixXd& slopes) {
      MatrixXd sum = numerics::times(by_functions, functions.middleCols(from, lines));
      for (Index i = 0; i < p; ++i)
        sum.middleRows(i * m, m) +=
            numerics::times(by_slopes, slopes.block(i * count, from, count, lines));
      return sum;
    };
    const MatrixXd re = plain(functions_.re, slopes_.re), im = plain(functions_.im, slopes_.im);
    for (Index k = from; k < to; ++k) {
      const MatrixXcd W =
          system_.whitening()[static_cast<std::size_t>(k)] / system_.deviation()(k, first + o);
      for (Index i = 0; i < p; ++i) {
        auto white_re = stack.block(k, i).col(o), white_im = stack.block(k, i).col(outputs + o);
        white_re.setZero();
        white_im.setZero();
        for (Index j = 0; j <= i; ++j) {  // W is lower triangular
          const double a = W(i, j).real(), b = W(i, j).imag();
          if (a == 0.0 && b == 0.0) continue;
          const auto x = re.col(k - from).segment(j * m, m), y = im.col(k - from).segment(j * m, m);
          white_re += a * x - b * y;
          white_im += a * y + b * x;
        }
      }
    }
  }
  return stack;
}

Propagation::Sums Propagation::sums(const Factors& factors, Index first,
                                    std::span<const Complex> along, const MatrixXd* V) const {
  const auto& leakage = responses_.leakage;
  const std::vector<Complex> a(leakage.line_covariance.begin(), leakage.line_covariance.end()),
      b(leakage.relation.begin(), leakage.relation.end());
  const bool lets_in = !let_in_.D.empty();
  const Index m = factors[0].cols(), lines = system_.lines(),
              reach = std::ssize(along.size() > a.size() || !lets_in ? along : std::span(a)) - 1;
  Sums sum;
  for (auto* part : {&sum.noise, &sum.let_in, &sum.related}) part->setZero(m, V != nullptr ? m : 1);
  const auto add = [&](MatrixXd& to, const auto& f, const auto& s) {
    if (V == nullptr)
      to += f.cwiseProduct(s).rowwise().sum();
    else
      to.noalias() += f * s.transpose();
  };
  // as many lines at once as the processor's caches hold
  constexpr Index numbers_at_once = 1 << 18, fewest_lines = 16;
  const Index chunk =
      std::max(fewest_lines, numbers_at_once / (m * 2 * std::ssize(factors) * system_.inputs()));
  for (Index from = 0; from < lines; from += chunk) {
    const Index to = std::min(lines, from + chunk);
    const Stack f =
        changes(factors, first, std::max<Index>(0, from - reach), std::min(lines, to + reach));
    Stack s = f.smoothed(from, to, along);
    if (by_noise_.size() > 0) apply_coherence(s, first);
    add(sum.noise, f.lines(from, to), s.values);
    if (!lets_in) continue;
    const Stack z = let_in_by(f, first);
    add(sum.let_in, z.lines(from, to), z.smoothed(from, to, a).values);
    add(sum.related, z.exchanged(from, to).values, z.smoothed(from, to, b).values);
  }
  return sum;
}

VectorXd Propagation::summed(const Factors& factors, Index first, const MatrixXd* V) const {
  const auto of_each = [V](const MatrixXd& sum) -> VectorXd {
    if (V == nullptr) return 0.5 * sum;
    return 0.5 * V->cwiseProduct(numerics::times(sum, *V)).colwise().sum().transpose();
  };
  const auto sum = sums(factors, first, responses_.line_covariance, V);
  VectorXd noise = of_each(sum.noise);
  if (!(noise.array() > 0.0).all()) {
    // estimates of what lines have in common can make a sum below 0: then they are worth nothing
    const Complex alone[]{1.0};
    const VectorXd independent = of_each(sums(factors, first, alone, V).noise);
    for (Index v = 0; v < noise.size(); ++v)
      if (!(noise[v] > 0.0)) noise[v] = not_below_zero(independent[v]);
  }
  if (let_in_.D.empty()) return noise;
  const VectorXd alone = of_each(sum.let_in), related = of_each(sum.related);
  // of the first order: where it says that nothing is left, higher ones are
  constexpr double beyond_first_order = 0.05;
  for (Index v = 0; v < noise.size(); ++v)
    noise[v] += not_below_zero(std::max(alone[v] + related[v], beyond_first_order * alone[v]));
  return noise;
}

/// Wᴴ f/σ is what stands beside errors that are not whitened.
VectorXd Propagation::of_half_spectra(const Factors& factors) const {
  const Index p = system_.inputs(), outputs = system_.outputs(), lines = system_.lines();
  const Stack f = changes(factors, 0, 0, lines);
  VectorXd result(f.values.rows());
  MatrixXcd c(lines, outputs * p);
  for (Index v = 0; v < result.size(); ++v) {
    for (Index k = 0; k < lines; ++k) {
      const auto& W = system_.whitening()[static_cast<std::size_t>(k)];
      for (Index o = 0; o < outputs; ++o)
        for (Index j = 0; j < p; ++j) {
          Complex sum = 0.0;
          for (Index i = j; i < p; ++i) {
            const auto of_input = f.block(k, i).row(v);
            sum += std::conj(W(i, j)) * Complex(of_input[o], of_input[outputs + o]);
          }
          c(k, o * p + j) = sum / system_.deviation()(k, o);
        }
    }
    result[v] = not_below_zero(errors_->variance(c));
  }
  return result;
}

/// Whether sums of all pairs of the parameters take less than those of the functions.
bool Propagation::by_all_parameters(Index functions) const {
  const Index parameters = derivatives_[0].cols(),
              alone = functions_.re.rows() + slopes_.re.rows() + 2 * system_.outputs();
  return parameters * (parameters + alone) < functions * alone;
}

Propagation::Factors Propagation::factors(const MatrixXd& V) const {
  Factors all;
  for (const auto& derivatives : derivatives_) all.push_back(numerics::times(derivatives, V));
  return all;
}

VectorXd Propagation::variances(const Factors& factors, Index first) const {
  return errors_ ? of_half_spectra(factors) : summed(factors, first, nullptr);
}

VectorXd Propagation::variances(const MatrixXd& V) const {
  if (errors_ || !by_all_parameters(V.cols())) return variances(factors(V));
  return summed(derivatives_, 0, &V);
}

}  // namespace hydrapod::identification
