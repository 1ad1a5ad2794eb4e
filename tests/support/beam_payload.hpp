#pragma once
/// A straight mast as beam elements, standing on the platform: Euler and Bernoulli, consistent
/// masses, along z, both bending planes, stretch and torsion.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <tuple>

namespace hydrapod::test {

struct Mast {
  double length{1.37}, EI_x{3.1e5}, EI_y{2.3e5}, EA{4.7e8}, GJ{1.9e5};
  double mass_per_length{71.3}, polar_per_length{1.31};  ///< [kg/m], [kg m²/m]
  int elements{8};
};

struct MastMatrices {
  Eigen::MatrixXd M{}, K{};  ///< x, y, z, rx, ry, rz of the foot, then of the nodes above
};

/// Adds a bending element: deflection and slope at both ends, `sign`: slope per rotation.
inline void add_bending(const Mast& mast, double EI, double h, int deflection, int rotation,
                        double sign, int first, MastMatrices& to) {
  const int at[4]{first + deflection, first + rotation, first + 6 + deflection,
                  first + 6 + rotation};
  const double k = EI / (h * h * h), m = mast.mass_per_length * h / 420.0;
  const double s = sign * h;
  const double K[4][4]{{12, 6 * s, -12, 6 * s},
                       {6 * s, 4 * h * h, -6 * s, 2 * h * h},
                       {-12, -6 * s, 12, -6 * s},
                       {6 * s, 2 * h * h, -6 * s, 4 * h * h}};
  const double M[4][4]{{156, 22 * s, 54, -13 * s},
                       {22 * s, 4 * h * h, 13 * s, -3 * h * h},
                       {54, 13 * s, 156, -22 * s},
                       {-13 * s, -3 * h * h, -22 * s, 4 * h * h}};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      to.K(at[i], at[j]) += k * K[i][j];
      to.M(at[i], at[j]) += m * M[i][j];
    }
}

/// Adds a rod in stretch or torsion.
inline void add_rod(double stiffness, double mass, int direction, int first, MastMatrices& to) {
  const int a = first + direction, b = first + 6 + direction;
  for (const auto& [i, j, k, m] :
       {std::tuple{a, a, 1.0, 2.0}, {b, b, 1.0, 2.0}, {a, b, -1.0, 1.0}, {b, a, -1.0, 1.0}}) {
    to.K(i, j) += stiffness * k;
    to.M(i, j) += mass * m / 6.0;
  }
}

inline MastMatrices mast_matrices(const Mast& mast) {
  const int n = 6 * (mast.elements + 1);
  MastMatrices all{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  const double h = mast.length / mast.elements;
  for (int e = 0; e < mast.elements; ++e) {
    const int first = 6 * e;
    add_bending(mast, mast.EI_x, h, 0, 4, 1.0, first, all);   // x with ry = dx/dz
    add_bending(mast, mast.EI_y, h, 1, 3, -1.0, first, all);  // y with rx = −dy/dz
    add_rod(mast.EA / h, mast.mass_per_length * h, 2, first, all);
    add_rod(mast.GJ / h, mast.polar_per_length * h, 5, first, all);
  }
  return all;
}

}  // namespace hydrapod::test
