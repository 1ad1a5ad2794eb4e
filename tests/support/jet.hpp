#pragma once
/// Values along a motion with their first and second time derivative: arithmetic on Taylor
/// polynomials of order two.

#include <Eigen/Geometry>
#include <cmath>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::test {

/// x, ẋ, ẍ.
struct Jet {
  double x{}, v{}, a{};
  friend Jet operator+(const Jet& p, const Jet& q) { return {p.x + q.x, p.v + q.v, p.a + q.a}; }
  friend Jet operator-(const Jet& p) { return {-p.x, -p.v, -p.a}; }
  friend Jet operator*(const Jet& p, const Jet& q) {
    return {p.x * q.x, p.v * q.x + p.x * q.v, p.a * q.x + 2.0 * p.v * q.v + p.x * q.a};
  }
  /// f(p) with f, f', f'' at p.x.
  [[nodiscard]] Jet through(double f, double f1, double f2) const {
    return {f, f1 * v, f1 * a + f2 * v * v};
  }
};
inline Jet inverse(const Jet& p) {
  return p.through(1.0 / p.x, -1.0 / (p.x * p.x), 2.0 / (p.x * p.x * p.x));
}
inline Jet sqrt(const Jet& p) {
  const double r = std::sqrt(p.x);
  return p.through(r, 0.5 / r, -0.25 / (r * p.x));
}
inline Jet asin(const Jet& p) {
  const double c = std::sqrt(1.0 - p.x * p.x);
  return p.through(std::asin(p.x), 1.0 / c, p.x / (c * c * c));
}
/// Angle of (x, y) for x > 0.
inline Jet atan2(const Jet& y, const Jet& x) {
  const Jet slope = y * inverse(x);
  const double d = 1.0 + slope.x * slope.x;
  return slope.through(std::atan(slope.x), 1.0 / d, -2.0 * slope.x / (d * d));
}

struct VectorJet {
  spatial::Vector3 x{}, v{}, a{};
  friend VectorJet cross(const VectorJet& p, const VectorJet& q) {
    return {p.x.cross(q.x), p.v.cross(q.x) + p.x.cross(q.v),
            p.a.cross(q.x) + 2.0 * p.v.cross(q.v) + p.x.cross(q.a)};
  }
  friend Jet dot(const VectorJet& p, const VectorJet& q) {
    return {p.x.dot(q.x), p.v.dot(q.x) + p.x.dot(q.v),
            p.a.dot(q.x) + 2.0 * p.v.dot(q.v) + p.x.dot(q.a)};
  }
  friend VectorJet operator*(const Jet& s, const VectorJet& p) {
    return {s.x * p.x, s.v * p.x + s.x * p.v, s.a * p.x + 2.0 * s.v * p.v + s.x * p.a};
  }
};
inline VectorJet unit(const VectorJet& p) { return inverse(sqrt(dot(p, p))) * p; }

/// A vector fixed in a body that turns with ω and ω̇.
inline VectorJet fixed_in_body(const spatial::Vector3& r, const spatial::Vector3& omega,
                               const spatial::Vector3& alpha) {
  const spatial::Vector3 v = omega.cross(r);
  return {r, v, alpha.cross(r) + omega.cross(v)};
}

}  // namespace hydrapod::test
