#include "exact/leg_potential.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace hydrapod::test {

namespace {

using Real = LegPotential::Real;
using Vector3L = LegPotential::Vector3L;
using Matrix3L = LegPotential::Matrix3L;

Matrix3L turn(Real angle, const Vector3L& axis) {
  return Eigen::AngleAxis<Real>(angle, axis).toRotationMatrix();
}

}  // namespace

LegPotential::LegPotential(const model::Leg& leg, const model::Vector3& a1,
                           const model::Vector3& gravity, double oil_force,
                           const Coordinates& around)
    : leg_(leg), a1_(a1.cast<Real>()), gravity_(gravity.cast<Real>()), oil_force_(oil_force) {
  const Vector3L n = (around.head<3>() - leg.base_joint.cast<Real>()).normalized();
  const Vector3L a2 = n.cross(a1_).normalized();
  start_ << a2.cross(n), a2, n;
}

LegPotential::Shape LegPotential::close(const Coordinates& x) const {
  const Vector3L L = x.head<3>() - leg_.base_joint.cast<Real>();
  const Real l_mn = leg_.rod.length;
  Shape shape;
  shape.e = turn(x[3], Vector3L::UnitX()) * turn(x[4], Vector3L::UnitY()) * Vector3L::UnitZ();
  const Vector3L beyond_piston = Vector3L(x[5], x[6], 0) + l_mn * shape.e;
  Vector3L angles_and_s(0, 0, L.norm() - l_mn);
  for (int step = 0; step < 8; ++step) {
    const Matrix3L first = turn(angles_and_s[0], a1_);
    shape.R = first * turn(angles_and_s[1], start_.col(1)) * start_;
    shape.s = angles_and_s[2];
    const Vector3L joint = shape.R * (beyond_piston + shape.s * Vector3L::UnitZ());
    Matrix3L rates;
    rates << a1_.cross(joint), (first * start_.col(1)).cross(joint), shape.R.col(2);
    angles_and_s -= rates.inverse() * (joint - L);
  }
  return shape;
}

Real LegPotential::extension(const Coordinates& x) const { return close(x).s; }

Eigen::Matrix<Real, 2, 1> LegPotential::sleeve_offset(const Coordinates& x) const {
  const Shape shape = close(x);
  const Real along = leg_.guide_sleeve.position - shape.s;
  return x.tail<2>() + along * shape.e.head<2>() / shape.e.z();
}

Real LegPotential::energy(const Coordinates& x) const {
  const Shape shape = close(x);
  const Vector3L base = leg_.base_joint.cast<Real>(), n = shape.R.col(2);
  const Vector3L case_center = base + Real(leg_.cylinder_case.mass_center) * n;
  const Vector3L rod_center =
      base + shape.R * (Vector3L(x[5], x[6], shape.s) + Real(leg_.rod.mass_center) * shape.e);
  const Vector3L offset(sleeve_offset(x)[0], sleeve_offset(x)[1], 0);
  // The sharp corner: the library's law has the same force and stiffness beyond 1.1 times the gap.
  const Real pressed =
      leg_.guide_sleeve.gap ? std::max(offset.norm() - Real(*leg_.guide_sleeve.gap), Real(0)) : 0;
  const Real k_g = leg_.piston_ring ? leg_.piston_ring->stiffness : 0.0;
  return oil_force_ * shape.s +
         Real(0.5) * leg_.guide_sleeve.stiffness * sleeve_offset(x).squaredNorm() +
         Real(0.5) * leg_.guide_sleeve.guide_stiffness * pressed * pressed +
         Real(0.5) * k_g * x.tail<2>().squaredNorm() -
         gravity_.dot(leg_.cylinder_case.mass * case_center + leg_.rod.mass * rod_center);
}

Eigen::Matrix<double, 7, 1> LegPotential::gradient(const Coordinates& x, Real step) const {
  Eigen::Matrix<double, 7, 1> g;
  for (int k = 0; k < 7; ++k)
    g[k] = static_cast<double>(derivative([&](const auto& at) { return energy(at); }, x, k, step));
  return g;
}

Eigen::Matrix<double, 7, 7> LegPotential::hessian(const Coordinates& x, Real step) const {
  Eigen::Matrix<double, 7, 7> H;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j <= i; ++j) {
      const auto slope = [&](const Coordinates& there) {
        return derivative([&](const auto& at) { return energy(at); }, there, j, step);
      };
      H(i, j) = H(j, i) = static_cast<double>(derivative(slope, x, i, step));
    }
  return H;
}

}  // namespace hydrapod::test
