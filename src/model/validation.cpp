#include "hydrapod/model/machine_file.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

constexpr double symmetry_tolerance = 1e-9;   ///< of the largest element
constexpr double triangle_tolerance = 1e-9;   ///< of the largest principal moment
constexpr double definite_tolerance = 1e-12;  ///< of the largest principal moment
constexpr double rotation_tolerance = 1e-9;
constexpr double same_place_tolerance = 1e-6;  ///< of the size of the joint pattern

void check_inertia_tensor(const Matrix3& inertia, ValueChecks& checks) {
  constexpr const char* key = "platform.inertia";
  for (int i = 0; i < 9; ++i) {
    if (!checks.finite(key, inertia(i / 3, i % 3), "kg m^2")) return;
  }
  const double largest = inertia.cwiseAbs().maxCoeff();
  for (int row = 0; row < 3; ++row) {
    for (int column = row + 1; column < 3; ++column) {
      const double upper = inertia(row, column);
      const double lower = inertia(column, row);
      if (std::abs(upper - lower) <= symmetry_tolerance * largest) continue;
      return checks.add(key,
                        fmt::format("is not symmetric: element ({0},{1}) is {2:.6g}, ({1},{0}) "
                                    "is {3:.6g} kg m^2",
                                    row + 1, column + 1, upper, lower));
    }
  }
  const Matrix3 scaled = largest > 0.0 ? Matrix3(inertia / largest) : inertia;
  const Vector3 moments =
      Eigen::SelfAdjointEigenSolver<Matrix3>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string found =
      fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m^2", moments[0] * largest,
                  moments[1] * largest, moments[2] * largest);
  if (moments[0] <= definite_tolerance * moments[2]) {
    checks.add(key, found + ", expected all three above 0");
  } else if (moments[0] + moments[1] < (1.0 - triangle_tolerance) * moments[2]) {
    checks.add(key, found + ": no body has these, expected none above the sum of the other two");
  }
}

/// Largest distance of a joint from the middle of all.
double pattern_size(const JointPoints& joints) {
  Vector3 middle = Vector3::Zero();
  for (const auto& joint : joints) middle += joint / leg_count;
  double size = 0.0;
  for (const auto& joint : joints) size = std::max(size, (joint - middle).norm());
  return size;
}

/// Legs 1…6 whose joints at one side stand together, for each place where some do.
std::vector<std::vector<std::size_t>> legs_together(const JointPoints& joints) {
  const double tolerance = same_place_tolerance * pattern_size(joints);
  std::vector<std::vector<std::size_t>> places;
  std::set<std::size_t> seen;
  for (std::size_t i = 0; i < leg_count; ++i) {
    if (seen.contains(i)) continue;
    std::vector<std::size_t> together{i + 1};
    for (std::size_t j = i + 1; j < leg_count; ++j) {
      if (seen.contains(j) || !((joints[i] - joints[j]).norm() <= tolerance)) continue;
      together.push_back(j + 1);
      seen.insert(j);
    }
    if (together.size() > 1) places.push_back(std::move(together));
  }
  return places;
}

/// Up to three legs may meet in a point: lines through it span three directions of force. Three
/// pairs are the pattern of a 6-3 or 3-3 platform; of other meetings it is asked whether they are
/// meant.
void check_joints_apart(const JointPoints& joints, const char* side, ValueChecks& checks) {
  constexpr std::size_t most_in_a_point = 3;
  const auto places = legs_together(joints);
  const bool three_pairs = places.size() == leg_count / 2;
  for (const auto& together : places) {
    const auto& joint = joints[together.front() - 1];
    const Vector3 place =
        (joint.array().abs() > same_place_tolerance * pattern_size(joints)).select(joint, 0.0);
    const auto key = fmt::format("leg.{}.{}_joint", together.back(), side);
    const auto found =
        fmt::format("legs {} have their {} joints in one place, ({:.6g}, {:.6g}, {:.6g}) m",
                    fmt::join(together, ", "), side, place.x(), place.y(), place.z());
    if (together.size() > most_in_a_point) {
      checks.add(key, found + ", expected no more than three legs in a point");
    } else if (!three_pairs) {
      checks.warn(key, found + "; is this meant?");
    }
  }
}

/// Two legs along one line hold nothing that one of them does not hold.
void check_lines_apart(const Machine& machine, ValueChecks& checks) {
  JointPoints base, platform;
  for (std::size_t i = 0; i < leg_count; ++i) {
    base[i] = machine.legs[i].base_joint;
    platform[i] = machine.legs[i].platform_joint;
  }
  const auto on_platform = legs_together(platform);
  for (const auto& together : legs_together(base))
    for (const auto& others : on_platform) {
      std::vector<std::size_t> both;
      std::set_intersection(together.begin(), together.end(), others.begin(), others.end(),
                            std::back_inserter(both));
      if (both.size() > 1)
        checks.add(fmt::format("leg.{}.platform_joint", both.back()),
                   fmt::format("legs {} have their base joints in one place and their platform "
                               "joints too, expected legs along different lines",
                               fmt::join(both, ", ")));
    }
}

/// Each direction in which the base moves has some inertia, or nothing on it has any.
void check_base_inertia(const Machine& machine, ValueChecks& checks) {
  if (!machine.base_mount) return;
  const auto& mount = *machine.base_mount;
  // a case moves with the base whatever the rod does
  if (std::ranges::all_of(machine.legs,
                          [](const Leg& leg) { return leg.cylinder_case.mass > 0.0; }))
    return;
  const bool none =
      mount.mass == 0.0 && mount.inertia.isZero(0.0) && leg_type(machine) == LegType::strut;
  for (int k = 0; k < 6 && !none; ++k) {
    const double own = k < 3 ? mount.mass : mount.inertia[k - 3];
    if (!mount.stiffness[static_cast<std::size_t>(k)] || own != 0.0) continue;
    return checks.add(k < 3 ? "base.mount.mass" : "base.mount.inertia",
                      "is 0 where the base has a spring, and the legs' cases have no mass to give "
                      "it inertia there, expected more than 0");
  }
}

/// Chambers are those of cylinders.
void check_oil_damping(const Machine& machine, ValueChecks& checks) {
  if (has_chambers(machine) && leg_type(machine) != LegType::cylinder)
    checks.add("damping.oil",
               fmt::format("is \"chambers\", and a {} has none, expected \"viscous\"",
                           name(leg_type(machine))));
}

bool check_joints(const Machine& machine, Vector3 Leg::*joint, const char* side,
                  ValueChecks& checks) {
  JointPoints joints;
  bool finite = true;
  for (std::size_t i = 0; i < leg_count; ++i) {
    joints[i] = machine.legs[i].*joint;
    finite &= checks.finite(fmt::format("leg.{}.{}_joint", i + 1, side), joints[i], "m");
  }
  if (finite) check_joints_apart(joints, side, checks);
  return finite;
}

/// One finding under `legs.` for what all legs have in common, under `leg.N.` for the rest.
void check_legs(const Machine& machine, NonFinite non_finite, std::vector<Finding>& findings) {
  std::array<std::vector<Finding>, leg_count> found;
  for (std::size_t i = 0; i < leg_count; ++i) {
    found[i] = leg_findings(machine, static_cast<int>(i), non_finite);
  }
  const auto shared = [&](const Finding& finding) {
    return std::all_of(found.begin(), found.end(), [&](const auto& others) {
      return std::any_of(others.begin(), others.end(), [&](const Finding& other) {
        return std::tie(other.key, other.message) == std::tie(finding.key, finding.message);
      });
    });
  };
  for (std::size_t i = 0; i < leg_count; ++i) {
    for (const auto& finding : found[i]) {
      const bool by_all = shared(finding);
      if (by_all && i > 0) continue;
      const std::string leg = by_all ? "legs" : fmt::format("leg.{}", i + 1);
      findings.push_back(
          {finding.severity, fmt::format("{}.{}", leg, finding.key), finding.message});
    }
  }
}

void check_pose(const std::string& key, const Pose& pose, ValueChecks& checks) {
  checks.finite(key + ".position", pose.p_BP, "m");
  for (int i = 0; i < 3; ++i) {
    if (!checks.finite(key + ".rotation", Vector3(pose.R_BP.row(i)), "1")) return;
  }
  const double error = (pose.R_BP.transpose() * pose.R_BP - Matrix3::Identity()).norm();
  if (error > rotation_tolerance || pose.R_BP.determinant() < 0.0) {
    checks.add(key + ".rotation", "is not a rotation, expected an orthonormal right-handed matrix");
  }
}

std::string pose_key(const std::string& name) {
  const bool bare = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
  return bare && !name.empty() ? "poses." + name : "poses.\"" + name + '"';
}

void check_poses(const std::vector<NamedPose>& poses, ValueChecks& checks) {
  if (poses.empty() || poses.front().name != "neutral") {
    checks.add("poses", "has no first pose \"neutral\", expected one");
  }
  std::set<std::string> names;
  for (const auto& pose : poses) {
    if (!names.insert(pose.name).second) {
      checks.add(pose_key(pose.name), "is given twice, expected different names");
    }
    check_pose(pose_key(pose.name), pose.X_BP, checks);
  }
}

}  // namespace

std::vector<Finding> validate_values(const Machine& machine, NonFinite non_finite) {
  ValueChecks checks(non_finite);
  checks.finite("environment.gravity", machine.gravity, "m/s^2");
  checks.rows(machine, std::nullopt);
  check_inertia_tensor(machine.platform.inertia, checks);
  check_payload_modes(machine, checks);
  const bool on_base = check_joints(machine, &Leg::base_joint, "base", checks);
  const bool on_platform = check_joints(machine, &Leg::platform_joint, "platform", checks);
  if (on_base && on_platform) check_lines_apart(machine, checks);
  check_supply(machine.hydraulics, checks);
  check_lines(machine, checks);
  check_oil_damping(machine, checks);
  check_base_inertia(machine, checks);
  check_sensors(machine.sensors, checks);
  check_poses(machine.poses, checks);
  std::vector<Finding> findings = checks.take();
  check_legs(machine, non_finite, findings);
  return findings;
}

std::vector<Finding> validate(const Machine& machine) {
  return validate_values(machine, NonFinite::report);
}

bool stands_alone(const Machine& machine, const ParameterId& id) {
  return row_of(id).alone && value(machine, id).has_value();
}

bool within_bound(const Assignment& assignment) {
  return ValueChecks(NonFinite::report)
      .within("", assignment.value, "", row_of(assignment.id).bound);
}

}  // namespace hydrapod::model
