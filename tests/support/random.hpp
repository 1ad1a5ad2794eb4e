#pragma once
/// Random numbers that are the same on every machine: the standard fixes std::mt19937_64 to the
/// bit, but leaves its distributions open, so they are written out here.

#include <cstdint>
#include <random>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1), 53 random bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in the logarithm; 0 < low < high.
  double log_uniform(double low, double high);
  bool chance(double probability) { return uniform() < probability; }

  /// Each component uniform in [-size, size].
  spatial::Vector3 vector(double size);
  /// Uniform on the unit sphere.
  spatial::Vector3 direction();
  /// Any orientation (not uniformly distributed over them; nothing here depends on that).
  spatial::Matrix3 rotation();
  /// Inertia about the mass centre of a body with radii of gyration about `radius`, axes anywhere.
  spatial::Matrix3 inertia(double mass, double radius);
  /// Small motion of a pose: |translation component| ≤ `length`, rotation up to `angle` about any
  /// axis.
  spatial::Vector6 displacement(double length, double angle);

 private:
  std::mt19937_64 engine_;
};

}  // namespace hydrapod::test
