#include "support/random_machine.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::test {

namespace {

using model::Leg;
using model::Machine;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

/// Joints in three pairs around a circle, each moved a little in radius, angle and height.
Vector3 scattered_joint(Random& random, double radius, double angle) {
  const double r = radius * random.uniform(0.9, 1.1);
  const double at = angle + random.uniform(-0.12, 0.12);
  return {r * std::cos(at), r * std::sin(at), radius * random.uniform(-0.08, 0.08)};
}

void scatter_joints(Random& random, Machine& machine, double base_radius, double platform_radius) {
  constexpr double third = 2.0 * std::numbers::pi / 3.0;
  const double half = random.uniform(0.1, 0.35), half_base = random.uniform(0.1, 0.35);
  for (int i = 0; i < model::leg_count; ++i) {
    const double pair = third * (i / 2);
    const bool second = i % 2 == 1;
    machine.legs[i].platform_joint =
        scattered_joint(random, platform_radius, second ? pair + third - half : pair + half);
    machine.legs[i].base_joint = scattered_joint(
        random, base_radius, pair + 0.5 * third + (second ? half_base : -half_base));
  }
}

Pose tilted_pose(Random& random, const Pose& neutral) {
  constexpr double degree = std::numbers::pi / 180.0;
  const double heading = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double tilt = random.uniform(0.0, 25.0 * degree);
  const Vector3 axis(std::cos(heading), std::sin(heading), random.uniform(-0.4, 0.4));
  Vector6 displacement;
  displacement << random.vector(0.1 * neutral.p_BP.z()), tilt * axis.normalized();
  return spatial::displaced(neutral, displacement);
}

/// Range of one leg's length over the machine's poses.
struct LengthRange {
  double shortest{1e300}, longest{0.0};
};

LengthRange length_range(const Machine& machine, int leg) {
  LengthRange range;
  for (const auto& pose : machine.poses) {
    const double l = kinematics::leg_lengths(machine, pose.X_BP)[leg];
    range = {std::min(range.shortest, l), std::max(range.longest, l)};
  }
  return range;
}

void draw_cylinder(Random& random, Leg& leg, double stiffness) {
  const double bulk_modulus = random.uniform(0.7e9, 1.6e9);
  const double volume_per_area = leg.stroke->length * random.uniform(0.6, 0.9);
  const double area = stiffness * volume_per_area / (1.7 * bulk_modulus);
  const double bore = std::sqrt(4.0 * area / std::numbers::pi);
  leg.oil_spring.cylinder = model::Cylinder{.bore = bore,
                                            .rod_diameter = bore * random.uniform(0.4, 0.7),
                                            .cap_dead_volume = area * random.uniform(0.01, 0.05),
                                            .rod_dead_volume = area * random.uniform(0.01, 0.05),
                                            .cap_line_volume = area * random.uniform(0.0, 0.05),
                                            .rod_line_volume = area * random.uniform(0.0, 0.05),
                                            .bulk_modulus = bulk_modulus};
  if (random.chance(0.3))
    leg.oil_spring.cylinder->air = model::EntrainedAir{.fraction = random.uniform(0.001, 0.02),
                                                       .pressure = random.uniform(2e6, 1e7)};
  if (random.chance(0.2)) leg.oil_spring.cylinder->volumes = model::VolumeRule::equal;
}

/// Lengths along the leg. False when the two poses differ too much for one cylinder.
bool draw_lengths(Random& random, Leg& leg, const LengthRange& range) {
  leg.rod.length = range.shortest * random.uniform(0.4, 0.55);
  const double lowest = range.shortest - leg.rod.length;
  const double highest = range.longest - leg.rod.length;
  const double retracted = lowest * random.uniform(0.7, 0.98);
  leg.stroke = model::Stroke{retracted, highest - retracted + random.uniform(0.005, 0.05)};
  const double end = leg.stroke->retracted + leg.stroke->length;
  leg.guide_sleeve.position = end + random.uniform(0.03, 0.15) * leg.rod.length;
  return leg.guide_sleeve.position - retracted < 0.95 * leg.rod.length;
}

/// A slender body of revolution: transverse and axial inertia that fit together.
struct SlenderBody {
  double mass, transverse, axial;
  SlenderBody(Random& random, double m, double length)
      : mass(m),
        transverse(m * length * length * random.uniform(0.05, 0.12)),
        axial(transverse * random.uniform(0.01, 0.2)) {}
};

void draw_leg(Random& random, Leg& leg, double platform_mass) {
  const double length = leg.rod.length;
  const SlenderBody tube(random, platform_mass * random.log_uniform(0.004, 0.05),
                         leg.guide_sleeve.position);
  leg.cylinder_case = {tube.mass, leg.guide_sleeve.position * random.uniform(0.2, 0.7),
                       tube.transverse, tube.axial};
  const SlenderBody rod(random, platform_mass * random.log_uniform(0.002, 0.03), length);
  leg.rod = {length, rod.mass, length * random.uniform(0.2, 0.8), rod.transverse, rod.axial};
  leg.gimbal_cross_inertia = 0.7 * tube.axial;
  const double k_h = platform_mass * random.log_uniform(3e3, 6e4);
  if (random.chance(0.5))
    draw_cylinder(random, leg, k_h);
  else
    leg.oil_spring.stiffness = k_h;
  leg.oil_spring.damping = random.uniform(0.002, 0.01) * std::sqrt(k_h * platform_mass);
  if (random.chance(0.5)) leg.added_axial_inertia = platform_mass * random.log_uniform(0.001, 0.03);
}

/// A gimbal axis well away from the leg's direction at every pose.
Vector3 draw_gimbal_axis(Random& random, const Machine& machine, int leg) {
  constexpr double nearest = 0.8;
  for (;;) {
    const Vector3 a1 = random.direction();
    bool good = true;
    for (const auto& pose : machine.poses)
      good &= std::abs(kinematics::inverse_kinematics(machine, pose.X_BP)[leg].n.dot(a1)) < nearest;
    if (good || machine.flexible_axes == model::FlexibleAxes::transverse) return a1;
  }
}

/// Axial forces [N] with straight weightless legs: J_l_qᵀ f = (m g; 0).
Vector6 axial_forces(const Machine& machine, const Pose& X_BP) {
  double mass = machine.platform.mass;
  for (const auto& leg : machine.legs) mass += leg.rod.mass + 0.5 * leg.cylinder_case.mass;
  Vector6 weight = Vector6::Zero();
  weight.head<3>() = mass * machine.gravity;
  const auto J = kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP),
                                          kinematics::mass_center(machine, X_BP));
  return J.transpose().partialPivLu().solve(weight);
}

/// Tilt stiffness k_s l_mh² at which a straight knee under `force` would fold.
double buckling_stiffness(const Leg& leg, double l, double force) {
  return std::abs(force) * (l - leg.rod.length) * leg.rod.length / l;
}

/// Tilt stiffness with which the leg's own weight bends it by 0.1 rad, as a beam on two supports.
double sagging_stiffness(const Leg& leg, double l) {
  return 10.0 * (leg.cylinder_case.mass + leg.rod.mass) * model::standard_gravity * l / 8.0;
}

double guided_length(const Leg& leg, double l) {
  return leg.guide_sleeve.position - (l - leg.rod.length);
}

void draw_seals(Random& random, Machine& machine, const RandomMachineOptions& options) {
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    double k_s = machine.platform.mass * random.log_uniform(3e2, 3e4);
    if (options.gravity != Gravity::none) {
      double softest = 0.0;
      for (const auto& pose : machine.poses) {
        const double l = kinematics::leg_lengths(machine, pose.X_BP)[i];
        const double l_mh = guided_length(leg, l);
        const double tilt_stiffness =
            buckling_stiffness(leg, l, axial_forces(machine, pose.X_BP)[i]) +
            sagging_stiffness(leg, l);
        softest = std::max(softest, tilt_stiffness / (l_mh * l_mh));
      }
      k_s = softest / random.uniform(options.lowest_load, options.highest_load);
    }
    leg.guide_sleeve.stiffness = k_s;
    leg.guide_sleeve.damping = 1e-4 * k_s * random.uniform(0.2, 1.0);
    if (options.piston_ring)
      leg.piston_ring =
          model::PistonRing{k_s * random.uniform(2.0, 20.0), 1e-4 * k_s * random.uniform(0.2, 1.0)};
  }
}

Vector3 draw_gravity(Random& random, Gravity kind) {
  if (kind == Gravity::none) return Vector3::Zero();
  if (kind == Gravity::down) return {0.0, 0.0, -model::standard_gravity};
  return model::standard_gravity * random.direction();
}

bool well_conditioned(const Machine& machine) {
  constexpr double worst = 30.0;
  return std::all_of(machine.poses.begin(), machine.poses.end(), [&](const auto& pose) {
    return kinematics::pose_quality(machine, pose.X_BP).condition < worst;
  });
}

/// False when the drawn numbers do not make a machine.
bool draw_machine(Random& random, const RandomMachineOptions& options, Machine& machine) {
  machine.flexible_axes = options.axes;
  machine.gravity = draw_gravity(random, options.gravity);
  const double base_radius = random.uniform(0.5, 1.4);
  scatter_joints(random, machine, base_radius, base_radius * random.uniform(0.45, 0.9));
  const Pose neutral{.p_BP = {0.0, 0.0, base_radius * random.uniform(0.9, 1.6)}};
  machine.poses = {{"neutral", neutral}, {"tilted", tilted_pose(random, neutral)}};
  const double mass = random.log_uniform(40.0, 6000.0);
  machine.platform = {mass, random.vector(0.2 * base_radius),
                      random.inertia(mass, base_radius * random.uniform(0.4, 0.8))};
  if (!well_conditioned(machine)) return false;
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    if (!draw_lengths(random, leg, length_range(machine, i))) return false;
    draw_leg(random, leg, mass);
    leg.gimbal_axis = draw_gimbal_axis(random, machine, i);
  }
  draw_seals(random, machine, options);
  return true;
}

}  // namespace

Machine random_machine(Random& random, const RandomMachineOptions& options) {
  for (;;) {
    Machine machine{.name = "random", .source = "drawn by a test"};
    if (draw_machine(random, options, machine) && kinematics::check_machine(machine).empty())
      return machine;
  }
}

double largest_load_share(const Machine& machine, const Pose& X_BP) {
  const Vector6 f = axial_forces(machine, X_BP);
  const Vector6 l = kinematics::leg_lengths(machine, X_BP);
  double largest = 0.0;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const double l_mh = guided_length(leg, l[i]);
    largest = std::max(
        largest, buckling_stiffness(leg, l[i], f[i]) / (leg.guide_sleeve.stiffness * l_mh * l_mh));
  }
  return largest;
}

}  // namespace hydrapod::test
