#pragma once
/// The elimination of elimination.hpp for whatever the lines of a model need. Each kind of lines
/// has a file of its own, so that the compiler makes the same of one kind whether there is another:
/// results stay what they are to the last bit.

#include <algorithm>
#include <array>

#include "elimination.hpp"

namespace hydrapod::response {

namespace {

constexpr int lanes = 8;  // frequencies that go through together
using Reals = Eigen::Array<double, lanes, 1>;

/// One complex number per lane, in cache lines of its own.
struct alignas(64) Numbers {
  Reals re, im;
};

inline Numbers operator*(const Numbers& a, const Numbers& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
inline void operator-=(Numbers& a, const Numbers& b) {
  a.re -= b.re;
  a.im -= b.im;
}
inline void operator+=(Numbers& a, const Numbers& b) {
  a.re += b.re;
  a.im += b.im;
}
inline Numbers reciprocal(const Numbers& a) {
  const Reals scale = (a.re * a.re + a.im * a.im).inverse();
  return {a.re * scale, -a.im * scale};
}

template <int rows, int cols>
using Block = std::array<std::array<Numbers, cols>, rows>;

struct Frequencies {
  Reals omega, omega2;
};

/// Entry of D = K − ω² M + iω C.
inline Numbers stiffness(const ResponseModel& model, const Frequencies& f, int i, int j) {
  return {model.K(i, j) - f.omega2 * model.M(i, j), f.omega * model.C(i, j)};
}

/// D = L diag(d) Lᵀ of a complex symmetric block, in place: L below the diagonal, 1/d on it.
template <int n>
void factor(Block<n, n>& A) {
  for (int j = 0; j < n; ++j) {
    Numbers pivot = A[j][j];
    for (int k = 0; k < j; ++k) {
      const Numbers scaled = A[j][k];  // L_jk d_k, still unscaled
      A[j][k] = scaled * A[k][k];
      pivot -= A[j][k] * scaled;
    }
    A[j][j] = reciprocal(pivot);
    for (int i = j + 1; i < n; ++i) {
      Numbers below = A[i][j];
      for (int k = 0; k < j; ++k) below -= A[i][k] * A[j][k];
      A[i][j] = below;
    }
  }
}

/// Y ← L⁻¹ Y.
template <int n, int cols>
void forward(const Block<n, n>& L, Block<n, cols>& Y) {
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < i; ++k)
      for (int c = 0; c < cols; ++c) Y[i][c] -= L[i][k] * Y[k][c];
}

/// Takes leg block `at` out of the platform's stiffness S (lower triangle) and, where inputs act on
/// the leg itself, out of the load W.
template <int n, class Lines>
void eliminate_leg(const ResponseModel& model, const Lines& f, int at, Block<6, 6>& S,
                   Block<6, 6>& W) {
  Block<n, n> D;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) D[i][j] = stiffness(model, f, at + i, at + j);
  factor<n>(D);
  Block<n, 6> Y;
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < 6; ++c) Y[i][c] = stiffness(model, f, at + i, c);
  forward<n, 6>(D, Y);
  Block<n, 6> Z;
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < 6; ++c) Z[i][c] = D[i][i] * Y[i][c];
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c <= r; ++c) {
      Numbers sum = S[r][c];
      for (int k = 0; k < n; ++k) sum -= Y[k][r] * Z[k][c];
      S[r][c] = sum;
    }
  if (!model.loads_flexible) return;
  Block<n, 6> B;
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < 6; ++c) B[i][c] = {Reals::Constant(model.loads(at + i, c)), Reals::Zero()};
  forward<n, 6>(D, B);
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) W[r][c] -= Z[k][r] * B[k][c];
}

/// S⁻¹ of the complex symmetric 6×6 S (lower triangle in, whole matrix out).
inline Block<6, 6> inverse(Block<6, 6>& S) {
  factor<6>(S);
  Block<6, 6> Z, D_Z;  // L⁻¹ below its diagonal of ones, and d L⁻¹
  for (int i = 0; i < 6; ++i) {
    D_Z[i][i] = S[i][i];
    for (int c = 0; c < i; ++c) {
      Numbers sum{-S[i][c].re, -S[i][c].im};
      for (int k = c + 1; k < i; ++k) sum -= S[i][k] * Z[k][c];
      Z[i][c] = sum;
      D_Z[i][c] = S[i][i] * sum;
    }
  }
  Block<6, 6> G;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c <= r; ++c) {
      Numbers sum = D_Z[r][c];
      for (int k = r + 1; k < 6; ++k) sum += Z[k][r] * D_Z[k][c];
      G[r][c] = G[c][r] = sum;
    }
  return G;
}

Block<6, 6> times(const Block<6, 6>& A, const Block<6, 6>& B) {
  Block<6, 6> C;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) {
      C[r][c] = A[r][0] * B[0][c];
      for (int k = 1; k < 6; ++k) C[r][c] += A[r][k] * B[k][c];
    }
  return C;
}

template <int flexible, class Lines>
Block<6, 6> solve(const ResponseModel& model, const Lines& f) {
  Block<6, 6> S, W;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c <= r; ++c) S[r][c] = stiffness(model, f, r, c);
  if (model.loads_flexible)
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) W[r][c] = {Reals::Constant(model.loads(r, c)), Reals::Zero()};
  if constexpr (flexible > 0)
    for (int leg = 0; leg < model::leg_count; ++leg)
      eliminate_leg<flexible>(model, f, 6 + flexible * leg, S, W);
  for (int mode = 0; mode < model.payload_count; ++mode)
    eliminate_leg<1>(model, f, 6 + flexible * model::leg_count + mode, S, W);
  const Block<6, 6> G = inverse(S);
  return model.loads_flexible ? times(G, W) : G;
}

template <class Lines>
Block<6, 6> solve(const ResponseModel& model, const Lines& f) {
  switch (model.kind) {
    case dynamics::ModelKind::guide:
      return solve<2>(model, f);
    case dynamics::ModelKind::full:
      return solve<4>(model, f);
    case dynamics::ModelKind::rigid:
      break;
  }
  return solve<0>(model, f);
}

/// `lanes` frequencies at a time; `lines_at` makes of Frequencies what solve() needs of the lines
/// there.
template <class LinesAt>
void eliminate_lanes(const ResponseModel& model, std::span<const double> omega,
                     std::span<Matrix6c> out, const LinesAt& lines_at) {
  for (size_t first = 0; first < omega.size(); first += lanes) {
    const size_t count = std::min<size_t>(lanes, omega.size() - first);
    Frequencies f;
    for (size_t k = 0; k < lanes; ++k)
      f.omega[static_cast<Eigen::Index>(k)] = omega[first + std::min(k, count - 1)];
    f.omega2 = f.omega.square();
    const Block<6, 6> H = solve(model, lines_at(f));
    for (size_t k = 0; k < count; ++k)
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r)
          out[first + k](r, c) = Complex(H[r][c].re[static_cast<Eigen::Index>(k)],
                                         H[r][c].im[static_cast<Eigen::Index>(k)]);
  }
}

}  // namespace

}  // namespace hydrapod::response
