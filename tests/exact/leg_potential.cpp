#include "exact/leg_potential.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

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

Real LegPotential::bending_compliance(Real s) const {
  if (leg_.bending == model::LegBending::rigid) return 0;
  const auto EI = [&](Real diameter, Real wall) {
    const Real inside = diameter - 2 * wall;
    return Real(leg_.rod.youngs_modulus) * std::numbers::pi_v<Real> / 64 *
           (std::pow(diameter, 4) - std::pow(inside, 4));
  };
  const auto& tube = leg_.cylinder_case;
  const Real a = leg_.guide_sleeve.position - s, b = leg_.rod.length - a;
  return a * a * b * b / (3 * (a + b) * EI(*leg_.rod.diameter, *leg_.rod.wall)) +
         a * a * (s + a) / (3 * EI(*tube.diameter, *tube.wall));
}

Real LegPotential::energy(const Coordinates& x) const {
  const Shape shape = close(x);
  const Vector3L base = leg_.base_joint.cast<Real>(), n = shape.R.col(2);
  const Vector3L case_center = base + Real(leg_.cylinder_case.mass_center) * n;
  const Vector3L rod_center =
      base + shape.R * (Vector3L(x[5], x[6], shape.s) + Real(leg_.rod.mass_center) * shape.e);
  // The sharp corner: the library's law has the same force and stiffness beyond 1.1 times the gap.
  // Rod and case that bend are in series, without a compression: d = δ + f (k_s δ + k_c (δ − g)).
  const Real f = bending_compliance(shape.s), k_s = leg_.guide_sleeve.stiffness;
  const Real k_c = leg_.guide_sleeve.guide_stiffness, chords = sleeve_offset(x).norm();
  Real offset = chords / (1 + f * k_s), pressed = 0;
  if (leg_.guide_sleeve.gap && offset > Real(*leg_.guide_sleeve.gap)) {
    const Real gap = *leg_.guide_sleeve.gap;
    offset = (chords + f * k_c * gap) / (1 + f * (k_s + k_c));
    pressed = offset - gap;
  }
  const Real force = k_s * offset + k_c * pressed;
  const Real k_g = leg_.piston_ring ? leg_.piston_ring->stiffness : 0.0;
  return oil_force_ * shape.s +
         Real(0.5) * (k_s * offset * offset + k_c * pressed * pressed + f * force * force) +
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
