/// Modes of the payload: what they take part with, and what they must satisfy.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <set>

#include "hydrapod/model/section.hpp"
#include "parameter_rows.hpp"
#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The part of the platform's inertia in any motion that may swing: rows of the equations of motion
/// lose a digit for every nine in it.
constexpr double most_swinging = 0.999;

Matrix6 platform_mass(const Platform& platform) {
  Matrix6 M = Matrix6::Zero();
  M.diagonal().head<3>().setConstant(platform.mass);
  M.bottomRightCorner<3, 3>() = platform.inertia;
  return M;
}

Matrix6 swinging_mass(const Machine& machine) {
  Matrix6 sum = Matrix6::Zero();
  for (const auto& mode : machine.payload_modes) {
    const Vector6 L = participation(mode, machine.platform.mass_center);
    sum += L * L.transpose();
  }
  return sum;
}

/// Its numbers within their bounds, and mass or participation, with a direction.
bool check_mode(Machine& machine, int index, ValueChecks& checks) {
  const auto& mode = machine.payload_modes[static_cast<std::size_t>(index)];
  const std::string front = fmt::format("payload_modes.{}", written_key(mode.name));
  bool sound = true;
  for (const auto& row : rows::payload_modes()) {
    if (row.find == nullptr) continue;
    const auto key = fmt::format("{}.{}", front, last_key(row.path));
    for (int k = 0; k < row.numbers; ++k)
      if (const double* number = row.find(machine, index, k);
          number != nullptr && !checks.within(key, *number, row.unit, row.bound)) {
        sound = false;
        break;
      }
  }
  if (mode.mass.has_value() == mode.participation.has_value()) {
    checks.add(front, mode.mass ? "has both `mass` and `participation`, expected one of them"
                                : "has neither `mass` nor `participation`, expected one of them");
    return false;
  }
  if (sound && mode.mass && !(mode.direction.norm() > 1.0 / largest_number)) {
    checks.add(front + ".direction",
               "is a vector of length 0, expected the direction in which the "
               "mass swings, as [1, 0, 0]");
    return false;
  }
  if (sound && participation(mode).isZero(0.0)) {
    checks.add(
        front + ".participation",
        "is zero, and so is `participation_moment`: such a mode is not coupled to the platform");
    return false;
  }
  return sound;
}

}  // namespace

Vector6 participation(const PayloadMode& mode, const Vector3& p) {
  Vector3 l = mode.participation.value_or(Vector3::Zero()), h = mode.participation_moment;
  if (mode.mass) {
    l = std::sqrt(*mode.mass) * mode.direction.normalized();
    h = mode.position.cross(l);
  }
  Vector6 L;
  L << l, h - p.cross(l);
  return L;
}

Matrix6 mass_without_payload_modes(const Machine& machine) {
  return platform_mass(machine.platform) - swinging_mass(machine);
}

void check_payload_modes(const Machine& machine, ValueChecks& checks) {
  const auto& modes = machine.payload_modes;
  if (modes.size() > most_payload_modes)
    return checks.add("payload_modes", fmt::format("holds {} modes, expected no more than {}",
                                                   modes.size(), most_payload_modes));
  auto& numbers = const_cast<Machine&>(machine);  // rows point into machines that may be changed
  bool sound = true;
  std::set<std::string> names;
  for (int k = 0; k < static_cast<int>(modes.size()); ++k) {
    const auto& name = modes[static_cast<std::size_t>(k)].name;
    if (name.empty() || !names.insert(name).second)
      checks.add("payload_modes",
                 fmt::format("has {}, expected modes with different names",
                             name.empty() ? "a mode without a name" : "two modes \"" + name + '"'));
    sound = check_mode(numbers, k, checks) && sound;
  }
  const auto& platform = machine.platform;
  const Matrix6 M = platform_mass(platform);
  if (!sound || modes.empty() || !M.allFinite() || Eigen::LLT<Matrix6>(M).info() != Eigen::Success)
    return;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(swinging_mass(machine), M);
  const double share = solver.eigenvalues()[5];
  if (share < most_swinging) return;
  Eigen::Index main = 0;
  const Vector6 motion = solver.eigenvectors().col(5);
  motion.cwiseProduct(M * motion).maxCoeff(&main);
  const double swings = swinging_mass(machine)(main, main), all = M(main, main);
  const char* unit = main < 3 ? "kg" : "kg m^2";
  checks.add(
      "payload_modes",
      fmt::format("hold {:.4g} times the inertia of the platform in a motion that is mainly {} "
                  "({:.5g} {} of {:.5g} {}), expected less than {}: `platform.mass` and "
                  "`platform.inertia` contain what swings",
                  share, spatial::direction_name(static_cast<int>(main)), swings, unit, all, unit,
                  most_swinging));
}

}  // namespace hydrapod::model
