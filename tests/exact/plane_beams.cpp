#include "exact/plane_beams.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace hydrapod::test {

namespace {

using Element = Eigen::Matrix4d;

/// Lengths in the slopes' rows and columns.
Element scaled(Element A, double L) {
  for (const int k : {1, 3}) {
    A.row(k) *= L;
    A.col(k) *= L;
  }
  return A;
}

Element bending(double EI, double L) {
  Element A;
  A << 12, 6, -12, 6, 6, 4, -6, 2, -12, -6, 12, -6, 6, 2, -6, 4;
  return EI / (L * L * L) * scaled(A, L);
}

Element pressed(double P, double L) {
  Element A;
  A << 36, 3, -36, 3, 3, 4, -3, -1, -36, -3, 36, -3, 3, -1, -3, 4;
  return -P / (30.0 * L) * scaled(A, L);
}

Element consistent_mass(double mu, double L) {
  Element A;
  A << 156, 22, 54, -13, 22, 4, 13, -3, 54, 13, 156, -22, -13, -3, -22, 4;
  return mu * L / 420.0 * scaled(A, L);
}

}  // namespace

void PlaneBeams::add(const std::array<int, 4>& ends, const Span& span, int elements) {
  const double L = span.length / elements;
  const Element K = bending(span.EI, L) + pressed(span.compression, L);
  const Element M = consistent_mass(span.mu, L);
  std::array<int, 4> at = ends;
  for (int e = 0; e < elements; ++e) {
    const bool last = e + 1 == elements;
    at[2] = last ? ends[2] : freedom();
    at[3] = last ? ends[3] : freedom();
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const int row = at[static_cast<std::size_t>(i)], column = at[static_cast<std::size_t>(j)];
        if (row == held || column == held) continue;
        stiffness_.push_back({row, column, K(i, j)});
        mass_.push_back({row, column, M(i, j)});
      }
    at[0] = at[2];
    at[1] = at[3];
  }
}

void PlaneBeams::add_spring(int a, int b, double k) {
  stiffness_.push_back({a, a, k});
  stiffness_.push_back({b, b, k});
  stiffness_.push_back({a, b, -k});
  stiffness_.push_back({b, a, -k});
}

void PlaneBeams::add_mass(int at, double m) { mass_.push_back({at, at, m}); }

double PlaneBeams::compliance(int a, int b) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(freedoms_);
  force[a] = -1.0;
  force[b] = 1.0;
  return force.dot(stiffness().ldlt().solve(force));
}

double PlaneBeams::lowest_omega2() const {
  const Eigen::MatrixXd K = stiffness(), M = mass();
  const Eigen::LDLT<Eigen::MatrixXd> factors(K);
  Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(freedoms_, 1.0, 2.0);
  double omega2 = 0.0;
  constexpr int most = 500;
  for (int k = 0; k < most; ++k) {
    v = factors.solve(M * v);
    v /= std::sqrt(v.dot(M * v));
    const double before = omega2;
    omega2 = v.dot(K * v);
    if (std::abs(omega2 - before) <= 1e-13 * omega2) break;
  }
  return omega2;
}

Eigen::MatrixXd PlaneBeams::assembled(const std::vector<Entry>& entries) const {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(freedoms_, freedoms_);
  for (const auto& entry : entries) A(entry.row, entry.column) += entry.value;
  return A;
}

}  // namespace hydrapod::test
