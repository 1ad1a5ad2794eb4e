// A program of somebody who installed the library. It is compiled for any processor, the library
// for this one: passing fixed-size Eigen types between the two must work.
#include <cmath>
#include <cstdio>
#include <hydrapod/base/version.hpp>
#include <hydrapod/model/machine.hpp>
#include <hydrapod/spatial/pose.hpp>

int main() {
  const hydrapod::spatial::Vector3 rpy(0.1, -0.2, 0.3);
  const auto R = hydrapod::spatial::rotation_from_rpy(rpy);
  const double error = (hydrapod::spatial::rpy_from_rotation(R) - rpy).norm();
  const auto joints = hydrapod::model::base_joint_points({.radius = 1.0, .spacing = 0.2});
  const double radius = joints[5].norm();
  std::printf("hydrapod %s: %g %g\n", hydrapod::base::version, error, radius);
  return error < 1e-14 && std::abs(radius - 1.0) < 1e-14 ? 0 : 1;
}
