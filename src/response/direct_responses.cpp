#include "direct_responses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hydrapod::response {

namespace {

using SmallComplex =
    Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, 0, dynamics::max_dof, dynamics::max_dof>;

/// Those of the standard library also mind infinities.
Complex product(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
Complex one_over(const Complex& a) {
  const double scale = 1.0 / std::norm(a);
  return {a.real() * scale, -a.imag() * scale};
}

/// A complex matrix by its parts: products of real ones are faster.
struct Parts {
  ModelMatrix re{}, im{};

  [[nodiscard]] Parts columns(int first, int size) const {
    return {re.middleCols(first, size), im.middleCols(first, size)};
  }
  void set_columns(int first, const Parts& A) {
    re.middleCols(first, A.re.cols()) = A.re;
    im.middleCols(first, A.im.cols()) = A.im;
  }
  [[nodiscard]] Complex at(Eigen::Index row, Eigen::Index column) const {
    return {re(row, column), im(row, column)};
  }
};

Parts times(const Parts& A, const Parts& B) {
  return {A.re * B.re - A.im * B.im, A.re * B.im + A.im * B.re};
}
Parts times(const ModelMatrix& A, const Parts& B) { return {A * B.re, A * B.im}; }
Parts transposed_times(const Parts& A, const Parts& B) {
  return {A.re.transpose() * B.re - A.im.transpose() * B.im,
          A.re.transpose() * B.im + A.im.transpose() * B.re};
}

Parts parts_of(const SmallComplex& A) { return {A.real(), A.imag()}; }

/// L⁻¹ of the complex symmetric G = L Lᵀ, of which the lower triangle is used. Nothing where a
/// pivot is small against `scale`: two shapes are then the same, as at critical damping.
std::optional<SmallComplex> inverse_root(const SmallComplex& G, double scale) {
  constexpr double small = 1e-3;
  const auto n = G.rows();
  SmallComplex L = G;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k)
      for (Eigen::Index i = j; i < n; ++i) L(i, j) -= product(L(i, k), L(j, k));
    if (!(std::abs(L(j, j)) > small * scale)) return std::nullopt;
    const Complex root = std::sqrt(L(j, j)), over = one_over(root);
    L(j, j) = over;  // the inverse is what is needed of it
    for (Eigen::Index i = j + 1; i < n; ++i) L(i, j) = product(L(i, j), over);
  }
  SmallComplex inverse = SmallComplex::Zero(n, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    inverse(c, c) = L(c, c);
    for (Eigen::Index i = c + 1; i < n; ++i) {
      Complex sum = 0.0;
      for (Eigen::Index k = c; k < i; ++k) sum -= product(L(i, k), inverse(k, c));
      inverse(i, c) = product(sum, L(i, i));
    }
  }
  return inverse;
}

/// Turns the columns j and k of U and the complex symmetric B, so that B(j, k) becomes 0. False
/// where no rotation does it: B has one eigenvector there.
bool turn(SmallComplex& B, SmallComplex& U, Eigen::Index j, Eigen::Index k) {
  constexpr double small = 1e-3;
  const Complex b = B(j, k);
  const Complex tau = product(0.5 * (B(k, k) - B(j, j)), one_over(b));
  const Complex root = std::sqrt(product(tau, tau) + 1.0);
  const Complex t =
      one_over(std::norm(tau + root) >= std::norm(tau - root) ? tau + root : tau - root);
  const Complex length2 = product(t, t) + 1.0;
  if (!(std::abs(length2) > small)) return false;
  const Complex c = one_over(std::sqrt(length2)), s = product(t, c);
  const auto combine = [&](Complex& x, Complex& y) {
    const Complex before = x;
    x = product(c, before) - product(s, y);
    y = product(s, before) + product(c, y);
  };
  const Complex change = product(t, b);
  const Complex at_j = B(j, j) - change, at_k = B(k, k) + change;
  for (Eigen::Index i = 0; i < B.rows(); ++i) combine(B(i, j), B(i, k));
  for (Eigen::Index i = 0; i < B.rows(); ++i) combine(B(j, i), B(k, i));
  for (Eigen::Index i = 0; i < U.rows(); ++i) combine(U(i, j), U(i, k));
  B(j, j) = at_j;
  B(k, k) = at_k;
  B(j, k) = B(k, j) = 0.0;
  return true;
}

/// U with Uᵀ U = 1 that makes the complex symmetric B diagonal, by Jacobi's rotations;
/// `negligible`: below it an entry of B is zero. Nothing where there is none.
std::optional<SmallComplex> diagonalise(SmallComplex& B, double negligible) {
  constexpr int most_sweeps = 30;
  const auto n = B.rows();
  SmallComplex U = SmallComplex::Identity(n, n);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool is_diagonal = true;
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index k = j + 1; k < n; ++k) {
        if (std::norm(B(j, k)) <= negligible * negligible) continue;
        is_diagonal = false;
        if (!turn(B, U, j, k)) return std::nullopt;
      }
    if (is_diagonal) return U;
  }
  return std::nullopt;
}

/// The sum over modes: H_dd = Σ (b + iω a) / (square − ω² + iω decay).
struct Terms {
  std::vector<double> square{}, decay{};
  std::array<std::vector<double>, 6> a{}, b{};

  explicit Terms(int modes) : square(at(modes)), decay(at(modes)) {
    for (auto* factors : {&a, &b})
      for (auto& one : *factors) one.resize(at(modes));
  }
  static std::size_t at(Eigen::Index k) { return static_cast<std::size_t>(k); }
};

/// Of modes that no damper couples.
Terms undamped_terms(const ResponseModel& model) {
  const auto& modes = model.modes;
  Terms terms(modes.size());
  for (int k = 0; k < modes.size(); ++k) {
    const auto place = Terms::at(k);
    terms.square[place] = modes.omega2[k];
    terms.decay[place] = 2.0 * model.modal_ratio * modes.omega(k);
    for (int d = 0; d < 6; ++d)
      terms.b[Terms::at(d)][place] = modes.shapes(d, k) * modes.shapes(d, k);
  }
  return terms;
}

/// Damped modes with the digits that the sum needs. The model's C has all damping in it.
class CorrectedModes {
 public:
  CorrectedModes(const ResponseModel& model, const DampedShapes& damped)
      : n_(model.modes.size()),
        poles_(damped.poles),
        group_of_(poles_.size()),
        y_{damped.real, damped.imaginary},
        M_y_(times(model.M, y_)),
        C_y_(times(model.C, y_)),
        K_y_(times(model.K, y_)) {}

  /// Nothing where the modes are not good enough for a correction.
  std::optional<Terms> terms() {
    for (int first = 0, group = 0; first < n_; ++group) {
      const int size = group_size(first);
      if (!part(first, size)) return std::nullopt;
      for (int k = first; k < first + size; ++k) group_of_[at(k)] = group;
      first += size;
    }
    return corrected();
  }

 private:
  static std::size_t at(Eigen::Index k) { return Terms::at(k); }

  [[nodiscard]] int group_size(int first) const {
    constexpr double near = 1e-3;
    int last = first;
    while (last + 1 < n_ && std::abs(poles_[at(last + 1)]) - std::abs(poles_[at(last)]) <
                                near * std::abs(poles_[at(last)]))
      ++last;
    return last - first + 1;
  }

  /// Q(s) y of some modes.
  [[nodiscard]] Parts stiffness_times(const Complex& s, int first, int size) const {
    const Parts M = M_y_.columns(first, size), C = C_y_.columns(first, size),
                K = K_y_.columns(first, size);
    const Complex s2 = product(s, s);
    return {K.re + (s2.real() * M.re - s2.imag() * M.im) + (s.real() * C.re - s.imag() * C.im),
            K.im + (s2.real() * M.im + s2.imag() * M.re) + (s.real() * C.im + s.imag() * C.re)};
  }

  /// Makes the modes of a group those of its pencil, with g = 1. The shapes move as (y, λ y).
  bool part(int first, int size) {
    Complex center = 0.0;
    for (int k = 0; k < size; ++k) center += poles_[at(first + k)] / double(size);
    const Parts V = y_.columns(first, size);
    const Parts V_M_V = transposed_times(V, M_y_.columns(first, size)),
                V_C_V = transposed_times(V, C_y_.columns(first, size)),
                V_Q_V = transposed_times(V, stiffness_times(center, first, size));
    SmallComplex G(size, size), P(size, size);
    for (int k = 0; k < size; ++k)
      for (int j = 0; j < size; ++j) {
        const Complex lambda_j = poles_[at(first + j)], lambda_k = poles_[at(first + k)];
        G(j, k) = product(lambda_j + lambda_k, V_M_V.at(j, k)) + V_C_V.at(j, k);
        P(j, k) =
            V_Q_V.at(j, k) - product(product(center - lambda_j, center - lambda_k), V_M_V.at(j, k));
      }
    const auto root = inverse_root(G, std::abs(center));
    if (!root) return false;
    const Parts L = parts_of(*root), L_P = times(L, parts_of(P));
    const Parts shifted = times(L_P, {L.re.transpose(), L.im.transpose()});
    SmallComplex B(size, size);
    for (int k = 0; k < size; ++k)
      for (int j = 0; j <= k; ++j) B(j, k) = B(k, j) = shifted.at(j, k);
    constexpr double epsilon = std::numeric_limits<double>::epsilon(), small = 1e-3;
    const double largest = B.diagonal().cwiseAbs().maxCoeff();
    const auto turned = diagonalise(B, epsilon * std::max(largest, small * std::abs(center)));
    if (!turned) return false;
    const Parts U = transposed_times(L, parts_of(*turned));
    for (auto* columns : {&y_, &M_y_, &C_y_, &K_y_})
      columns->set_columns(first, times(columns->columns(first, size), U));
    for (int k = 0; k < size; ++k) poles_[at(first + k)] = center - B(k, k);
    return true;
  }

  /// The step of Newton's method.
  [[nodiscard]] std::optional<Terms> corrected() const {
    constexpr double largest_step = 1e-7;  // its square is left
    Parts R{ModelMatrix(n_, n_), ModelMatrix(n_, n_)};
    for (int k = 0; k < n_; ++k) R.set_columns(k, stiffness_times(poles_[at(k)], k, 1));
    const std::vector<Complex> over_g = inverse_norms();
    const ModelMatrix re_re = y_.re.transpose() * R.re, im_im = y_.im.transpose() * R.im,
                      re_im = y_.re.transpose() * R.im, im_re = y_.im.transpose() * R.re;
    Terms terms(n_);
    double largest = 0.0;
    for (int k = 0; k < n_; ++k) {
      std::array<Complex, 6> p;
      for (int d = 0; d < 6; ++d) p[at(d)] = y_.at(d, k);
      const auto add = [&](int j, double sense, const Complex& rest, const Complex& apart) {
        const Complex step = product(rest, one_over(apart));
        largest = std::max(largest, std::norm(step));
        for (int d = 0; d < 6; ++d) p[at(d)] += product(step, {y_.re(d, j), sense * y_.im(d, j)});
      };
      const Complex pole = poles_[at(k)];
      for (int j = 0; j < n_; ++j) {
        const Complex other = poles_[at(j)], over = over_g[at(j)];
        const Complex rest{re_re(j, k) - im_im(j, k), re_im(j, k) + im_re(j, k)},
            of_conjugate{re_re(j, k) + im_im(j, k), re_im(j, k) - im_re(j, k)};
        if (group_of_[at(j)] != group_of_[at(k)]) add(j, 1.0, product(rest, over), other - pole);
        add(j, -1.0, product(of_conjugate, std::conj(over)), std::conj(other) - pole);
      }
      const Complex error{re_re(k, k) - im_im(k, k), re_im(k, k) + im_re(k, k)};
      set_term(terms, k, pole - product(error, over_g[at(k)]), p, over_g[at(k)]);
    }
    if (!(largest < largest_step * largest_step)) return std::nullopt;
    return terms;
  }

  /// 1/g of each mode.
  [[nodiscard]] std::vector<Complex> inverse_norms() const {
    std::vector<Complex> over_g(poles_.size());
    for (int k = 0; k < n_; ++k) {
      const Parts y = y_.columns(k, 1);
      over_g[at(k)] =
          one_over(product(2.0 * poles_[at(k)], transposed_times(y, M_y_.columns(k, 1)).at(0, 0)) +
                   transposed_times(y, C_y_.columns(k, 1)).at(0, 0));
    }
    return over_g;
  }

  static void set_term(Terms& terms, int k, const Complex& pole, const std::array<Complex, 6>& p,
                       const Complex& over_g) {
    terms.square[at(k)] = std::norm(pole);
    terms.decay[at(k)] = -2.0 * pole.real();
    for (int d = 0; d < 6; ++d) {
      const Complex residue = product(product(p[at(d)], p[at(d)]), over_g);
      terms.a[at(d)][at(k)] = 2.0 * residue.real();
      terms.b[at(d)][at(k)] = -2.0 * (residue.real() * pole.real() + residue.imag() * pole.imag());
    }
  }

  int n_;
  std::vector<Complex> poles_;
  std::vector<int> group_of_;  ///< of each mode
  Parts y_, M_y_, C_y_, K_y_;
};

/// Lines that are computed at once, in the lanes of registers.
constexpr std::size_t at_once = 4;
typedef double Four __attribute__((vector_size(at_once * sizeof(double)), aligned(8)));  // NOLINT

/// 1/(square − ω² + iω decay) at some lines, of each mode.
struct Weight {
  Four re, im;
};
using ModeWeights = std::array<Weight, dynamics::max_dof>;

void weigh(const Terms& terms, const Four& omega, ModeWeights& weights) {
  const Four omega2 = omega * omega;
  for (std::size_t k = 0; k < terms.square.size(); ++k) {
    const Four re = terms.square[k] - omega2, im = terms.decay[k] * omega;
    const Four scale = 1.0 / (re * re + im * im);
    weights[k] = {re * scale, -im * scale};
  }
}

std::vector<DirectLine> sum_of(const Terms& terms, std::span<const double> omega) {
  std::vector<DirectLine> H(omega.size());
  ModeWeights weights;
  for (std::size_t first = 0; first < omega.size(); first += at_once) {
    const std::size_t count = std::min(at_once, omega.size() - first);
    Four lines;
    for (std::size_t l = 0; l < at_once; ++l) lines[l] = omega[first + std::min(l, count - 1)];
    weigh(terms, lines, weights);
    for (std::size_t d = 0; d < 6; ++d) {
      const double *a = terms.a[d].data(), *b = terms.b[d].data();
      Four a_re{}, a_im{}, b_re{}, b_im{};
      for (std::size_t k = 0; k < terms.square.size(); ++k) {
        const auto& [re, im] = weights[k];
        a_re += a[k] * re;
        a_im += a[k] * im;
        b_re += b[k] * re;
        b_im += b[k] * im;
      }
      const Four re = b_re - lines * a_im, im = b_im + lines * a_re;
      for (std::size_t l = 0; l < count; ++l) H[first + l][d] = {re[l], im[l]};
    }
  }
  return H;
}

std::vector<DirectLine> diagonals(const std::vector<Matrix6c>& H) {
  std::vector<DirectLine> lines(H.size());
  for (std::size_t i = 0; i < H.size(); ++i)
    for (int d = 0; d < 6; ++d) lines[i][Terms::at(d)] = H[i](d, d);
  return lines;
}

/// Each of the lines once.
std::vector<std::size_t> ascending(std::vector<std::size_t> lines) {
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return lines;
}

/// The first and the last line, those nearest to the poles, of which some may be together, and
/// those in valleys where digits are lost.
std::vector<std::size_t> telling_lines(const Terms& terms, std::span<const double> omega,
                                       const std::vector<DirectLine>& H) {
  constexpr double together = 1e-3;
  std::vector<std::size_t> lines{0, omega.size() - 1};
  double last = 0.0;
  for (const double square : terms.square) {
    const double pole = std::sqrt(square);
    const auto above = std::lower_bound(omega.begin(), omega.end(), pole);
    if (pole < (1.0 + together) * last || above == omega.begin() || above == omega.end()) continue;
    const bool is_nearer = *above - pole < pole - *(above - 1);
    lines.push_back(static_cast<std::size_t>(above - omega.begin()) - (is_nearer ? 0 : 1));
    last = pole;
  }
  std::vector<double> size(omega.size());
  for (std::size_t d = 0; d < 6; ++d) {
    for (std::size_t i = 0; i < size.size(); ++i) size[i] = std::norm(H[i][d]);
    for (std::size_t i = 1; i + 1 < size.size(); ++i)
      if (size[i] < size[i - 1] && size[i] <= size[i + 1]) lines.push_back(i);
  }
  return ascending(std::move(lines));
}

bool is_same(const DirectLine& H, const DirectLine& expected, double share) {
  for (std::size_t d = 0; d < 6; ++d)
    if (!(std::abs(H[d] - expected[d]) <= share * std::abs(expected[d]))) return false;
  return true;
}

/// Compares `H` with `method` at telling lines, and beside every line where they
/// differ, and puts what that gives there. False where they differ at too many lines.
bool made_exact(const ResponseModel& model, Method method, const Terms& terms,
                std::span<const double> omega, std::vector<DirectLine>& H) {
  constexpr double rounding = 5e-13;  // of both ways
  constexpr std::size_t beside = 4, most_share = 10;
  std::vector<bool> is_known(omega.size());
  auto lines = telling_lines(terms, omega, H);
  const std::size_t most = lines.size() + omega.size() / most_share;
  for (std::size_t known = 0; !lines.empty();) {
    if ((known += lines.size()) > most) return false;
    std::vector<double> there;
    for (const auto line : lines) there.push_back(omega[line]);
    const auto expected = diagonals(frequency_response(model, there, Output::displacement, method));
    std::vector<std::size_t> next;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto line = lines[i];
      is_known[line] = true;
      if (is_same(H[line], expected[i], rounding)) continue;
      H[line] = expected[i];
      const auto last = std::min(line + beside, omega.size() - 1);
      for (auto k = line - std::min(line, beside); k <= last; ++k) next.push_back(k);
    }
    lines = ascending(std::move(next));
    std::erase_if(lines, [&](std::size_t line) { return is_known[line]; });
  }
  return true;
}

bool all_oscillate(const ResponseModel& model, const DampedShapes& damped) {
  const auto oscillates = [](const Complex& pole) { return pole.imag() > 0.0; };
  return model.arms.empty() &&
         damped.poles.size() == static_cast<std::size_t>(model.modes.size()) &&
         std::all_of(damped.poles.begin(), damped.poles.end(), oscillates);
}

}  // namespace

DirectResponses direct_responses(const ResponseModel& model, const DampedShapes& damped,
                                 std::span<const double> omega) {
  const Method method = best_method(model);
  if (omega.empty()) return {};
  if (method == Method::modes) return {sum_of(undamped_terms(model), omega), true};
  if (all_oscillate(model, damped) && std::is_sorted(omega.begin(), omega.end())) {
    ResponseModel whole = model;  // its damping matrix is made once
    whole.C = damping_matrix(model);
    whole.modal_ratio = 0.0;
    if (const auto terms = CorrectedModes(whole, damped).terms()) {
      auto H = sum_of(*terms, omega);
      if (made_exact(whole, method, *terms, omega, H)) return {std::move(H), true};
    }
  }
  return {diagonals(frequency_response(model, omega)), false};
}

}  // namespace hydrapod::response
