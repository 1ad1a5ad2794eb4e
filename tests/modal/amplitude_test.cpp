/// Modes at amplitudes: limits in closed form. Against simulations: tests/simulation.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>

#include "exact/guide_ring.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "support/massless_legs.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

model::Machine guided_machine() {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.013;
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.gap = 1.7e-4;
    leg.guide_sleeve.guide_stiffness = 4.1e7;
  }
  return machine;
}

std::vector<modal::AmplitudeCurve> curves_of(const model::Machine& machine,
                                             std::vector<double> amplitudes,
                                             ModelKind kind = ModelKind::guide) {
  return modal::modes_at_amplitudes(machine, machine.neutral(), kind, amplitudes);
}

TEST(ModesAtAmplitudes, OfSmallMotionsAreTheLinearOnes) {
  const auto machine = guided_machine();
  const auto normal =
      modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
  const auto curves = curves_of(machine, {1e-7, 1e-5});
  ASSERT_GE(curves.size(), 6U);
  for (const auto& curve : curves) {
    ASSERT_EQ(curve.points.size(), 2U);
    for (const auto& point : curve.points) {
      ASSERT_TRUE(point.converged);
      EXPECT_EQ(point.legs_on_guide, 0);
      EXPECT_NEAR(point.omega, normal.omega(curve.mode), 1e-9 * point.omega);
      EXPECT_NEAR(point.damping_ratio, 0.013, 1e-9);
      EXPECT_NEAR(point.mac, 1.0, 1e-9);
    }
  }
}

/// Long swings lie on the guide for nearly the whole period: k_s + k_c.
TEST(ModesAtAmplitudes, OfLongSwingsApproachThoseOfAStiffGuide) {
  const auto machine = guided_machine();
  auto stiff = machine;
  for (auto& leg : stiff.legs) {
    leg.guide_sleeve.gap.reset();
    leg.guide_sleeve.stiffness += leg.guide_sleeve.guide_stiffness;
  }
  const auto modes_of = [](const model::Machine& of) {
    return modal::normal_modes(dynamics::linear_model(of, of.neutral(), ModelKind::guide));
  };
  const auto limit = modes_of(stiff), linear = modes_of(machine);
  const auto curves = curves_of(machine, {1e-4, 1e-3, 1e-2, 0.1, 1.0, 30.0});
  const auto& lowest = curves.front();
  ASSERT_EQ(lowest.points.size(), 6U);
  double before = linear.omega(lowest.mode);
  for (const auto& point : lowest.points) {
    ASSERT_TRUE(point.converged) << point.amplitude;
    EXPECT_GE(point.omega, before * (1.0 - 1e-9));
    before = point.omega;
  }
  const double whole = limit.omega(0) - linear.omega(lowest.mode);
  EXPECT_NEAR(before - linear.omega(lowest.mode), whole, 0.02 * whole);
  EXPECT_EQ(lowest.points.back().legs_on_guide, 6);
}

/// The amplitude is that against the base, whether it has coordinates or none.
TEST(ModesAtAmplitudes, OfABaseWithoutInertiaAreThoseOfALightOne) {
  auto machine = guided_machine();
  machine.base_mount = model::BaseMount{.stiffness = {8.3e7, 9.1e7, 1.07e8, {}, {}, {}}};
  auto light = machine;
  scale_legs_inertia(light, 1e-9);
  ASSERT_EQ(dynamics::base_directions(light).size(), 3U);
  scale_legs_inertia(machine, 0.0);
  ASSERT_TRUE(dynamics::base_directions(machine).empty());
  const auto without = curves_of(machine, {1e-3}, ModelKind::rigid),
             with = curves_of(light, {1e-3}, ModelKind::rigid);
  ASSERT_EQ(without.size(), 6U);
  ASSERT_GE(with.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(without[k].points[0].omega, with[k].points[0].omega, 1e-7 * with[k].omega) << k;
    EXPECT_NEAR(without[k].points[0].piston, with[k].points[0].piston,
                1e-6 * with[k].points[0].piston)
        << k;
  }
}

/// All springs of a machine with rigid legs soften alike: ω of the oil with bristles beside it.
TEST(ModesAtAmplitudes, HaveTheBristlesOfTheSealsBesideTheOil) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  constexpr double sigma = 2.9e6;
  for (auto& leg : machine.legs)
    leg.hydraulics.friction = {
        .coulomb = 310.0, .breakaway = 310.0, .bristles = model::LuGreBristles{.stiffness = sigma}};
  auto sticking = machine;
  for (auto& leg : sticking.legs) {
    *leg.oil_spring.stiffness += sigma;
    leg.hydraulics.friction = {};
  }
  const auto oil =
      modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid));
  const auto stuck =
      modal::normal_modes(dynamics::linear_model(sticking, machine.neutral(), ModelKind::rigid));
  for (const auto& curve : curves_of(machine, {1e-9, 1e-4, 0.1}, ModelKind::rigid)) {
    ASSERT_EQ(curve.points.size(), 3U);
    EXPECT_NEAR(curve.points[0].omega, stuck.omega(curve.mode), 1e-4 * curve.omega);
    EXPECT_NEAR(curve.points[2].omega, oil.omega(curve.mode), 1e-2 * curve.omega);
    // Most damped where bristles begin to slide; little where they stick or slide for long.
    EXPECT_GT(curve.points[1].damping_ratio, curve.points[0].damping_ratio);
    EXPECT_GT(curve.points[1].damping_ratio, curve.points[2].damping_ratio);
  }
}

/// Bristles that only stick are the spring of linear models, which they replace: it does not count
/// twice where a file states both.
TEST(ModesAtAmplitudes, OfBristlesThatStickAreThoseOfLinearModelsWithSealsThatStick) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  constexpr double sigma = 2.9e6;
  for (auto& leg : machine.legs) leg.stick_stiffness = sigma;
  const auto linear =
      modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
  const auto found = curves_of(machine, {1e-4}, ModelKind::guide);
  for (const auto& curve : found)  // without bristles at any amplitude
    EXPECT_NEAR(curve.points.at(0).omega, linear.omega(curve.mode), 1e-9 * curve.omega);
  for (auto& leg : machine.legs)
    leg.hydraulics.friction = {
        .coulomb = 310.0, .breakaway = 310.0, .bristles = model::LuGreBristles{.stiffness = sigma}};
  for (const auto& curve : curves_of(machine, {1e-9}, ModelKind::guide)) {
    const double omega = curve.points.at(0).omega;
    EXPECT_LT((linear.omega2.cwiseSqrt().array() - omega).abs().minCoeff(), 1e-4 * omega);
  }
}

/// An elastomer without a softening has the damped frequency of its arms.
TEST(ModesAtAmplitudes, HaveTheComplexStiffnessOfElastomersAtTheirFrequency) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.5, .loss_factor = 0.1, .frequency = 9.7};
  const auto linear = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto damped = modal::damped_modes(linear, modal::normal_modes(linear), 0.0);
  const auto curves = curves_of(machine, {1e-6});
  for (int k = 0; k < 6; ++k) {
    const auto& point = curves[static_cast<std::size_t>(k)].points[0];
    ASSERT_TRUE(point.converged);
    double nearest = 1e300, damping = 0.0;
    for (const auto& mode : damped)
      if (std::abs(mode.omega - point.omega) < nearest) {
        nearest = std::abs(mode.omega - point.omega);
        damping = mode.damping_ratio;
      }
    // real modes for complex ones: of the order of the damping squared
    EXPECT_LT(nearest, 5e-3 * point.omega);
    EXPECT_NEAR(point.damping_ratio, damping, 0.05 * damping);
  }
}

TEST(ModesAtAmplitudes, SoftenWithElastomersThatAmplitudesSoften) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.5,
                                  .loss_factor = 0.1,
                                  .frequency = 9.7,
                                  .softening = 0.4,
                                  .softening_amplitude = 5e-5};
  for (auto& leg : machine.legs)
    leg.guide_sleeve.stiffness *= 5.3;  // far above the platform's modes
  auto soft = machine;
  for (auto& leg : soft.legs) {
    leg.guide_sleeve.stiffness *= 0.6;
    leg.guide_sleeve.elastomer->softening = 0.0;
  }
  const double limit = curves_of(soft, {1e-6}).front().points[0].omega;
  const auto lowest = curves_of(machine, {1e-7, 1e-3, 10.0}).front();
  ASSERT_EQ(lowest.points.size(), 3U);
  const double whole = lowest.points[0].omega - limit;
  EXPECT_GT(whole, 1e-5 * limit);
  EXPECT_GT(lowest.points[0].omega, lowest.points[1].omega);
  EXPECT_NEAR(lowest.points[2].omega, limit, 0.01 * whole);
}

/// Rods that bend, elastomers that soften and guide rings at once. Every point is put into the
/// complex balance, set up without springs and arms in series: per leg (δ-stiffness in series with
/// f) times the chord's offset, the ring's part at ω by a sum over the period.
TEST(ModesAtAmplitudes, AreComplexBalancesWhereRodsBendAndElastomersSoften) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.013;
  for (auto& leg : machine.legs) {
    leg.bending = model::LegBending::elastic;
    leg.rod.diameter = 0.023;
    leg.rod.wall = 0.007;
    leg.cylinder_case.diameter = 0.041;
    leg.cylinder_case.wall = 0.003;
    leg.guide_sleeve.stiffness = 4.7e6;
    leg.guide_sleeve.gap = 1.9e-5;
    leg.guide_sleeve.guide_stiffness = 3.3e7;
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.7,
                                  .loss_factor = 0.23,
                                  .frequency = 11.3,
                                  .softening = 0.43,
                                  .softening_amplitude = 1.1e-5};
  }
  const auto& sleeve = machine.legs[0].guide_sleeve;
  const auto linear = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto arms = dynamics::seal_arms(sleeve.stiffness, *sleeve.elastomer);
  const double f = linear.legs[0].bending;
  ASSERT_GT(f * sleeve.stiffness, 0.01);
  const auto in_series = [&](std::complex<double> k) { return k / (1.0 + f * k); };
  const auto ring = [&](double A) {
    return ring_stiffness(A, *sleeve.gap, sleeve.guide_stiffness);
  };
  int softened = 0, on_guide = 0, turned = 0;
  for (const auto& curve : curves_of(machine, {1.3e-6, 1.7e-4, 1.1e-3, 4.7e-3})) {
    auto points = curve.points;
    points.insert(points.end(), curve.further.begin(), curve.further.end());
    for (const auto& point : points) {
      if (!point.converged) continue;
      double largest = 0.0;
      for (const auto& J : linear.J)
        largest = std::max(largest, (J * linear.against_base * point.shape).norm());
      const dynamics::ModelVector y = point.shape * (point.amplitude / largest);
      Eigen::VectorXcd force = (dynamics::slow_stiffness(linear) * y).cast<std::complex<double>>();
      double largest_seal = 0.0;
      for (int i = 0; i < model::leg_count; ++i) {
        const auto& leg = linear.legs[static_cast<std::size_t>(i)];
        Eigen::MatrixXd rows(2, linear.dof());
        for (int k : {0, 1})
          rows.row(k) = dynamics::per_coordinate(
              linear, i, leg.d_x.row(k).transpose() + f * leg.F_x.row(k).transpose());
        const Eigen::VectorXd chord = rows * y;
        std::complex<double> seal = sleeve.stiffness;
        for (const auto& arm : arms)
          seal += arm.stiffness * std::complex<double>(0.0, point.omega) /
                  std::complex<double>(arm.rate, point.omega);
        // The amplitude of the seal by halving: it grows with that of the chord.
        double low = 0.0, high = chord.norm();
        std::complex<double> k;
        for (int n = 0; n < 60; ++n) {
          const double A = 0.5 * (low + high);
          const double r = std::pow(A / 1.1e-5, 1.2);
          k = seal * (1.0 - 0.43 * r / (1.0 + r)) + ring(A);
          (A * std::abs(1.0 + f * k) < chord.norm() ? low : high) = A;
        }
        largest_seal = std::max(largest_seal, low);
        force += rows.transpose() * (in_series(k) - in_series(sleeve.stiffness)) * chord;
      }
      const Eigen::VectorXd balance = force.real() - point.omega * point.omega * linear.M * y;
      EXPECT_LT(balance.norm(), 1e-7 * force.norm()) << curve.mode << " at " << point.amplitude;
      const double loss =
          y.dot(force.imag()) / (2.0 * point.omega * point.omega * y.dot(linear.M * y));
      EXPECT_NEAR(point.damping_ratio, 0.013 + loss, 1e-8);
      EXPECT_NEAR(point.sleeve, largest_seal, 1e-6 * largest_seal);
      softened += largest_seal > 2e-6;
      on_guide += point.legs_on_guide > 0;
      turned += point.turns > 0;
    }
  }
  EXPECT_GT(softened, 6);
  EXPECT_GT(on_guide, 5);
  RecordProperty("points on turned branches", turned);
}

/// Bristles of joints that stick are springs between the leg's axis and base and platform: with
/// rigid legs their energy follows from the directions of the legs alone.
TEST(ModesAtAmplitudes, HaveTheBristlesOfJointsAsSpringsOfTheirTurning) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  constexpr double sigma = 2.3e5, coulomb = 37.0;
  for (auto& leg : machine.legs)
    leg.hydraulics.joint_friction = {.coulomb = coulomb, .bristle_stiffness = sigma};
  const auto& X_BP = machine.neutral();
  auto stuck = dynamics::linear_model(machine, X_BP, ModelKind::rigid);
  const spatial::Vector3 C = X_BP.p_BP + X_BP.R_BP * machine.platform.mass_center;
  for (const auto& leg : machine.legs) {
    // Directions of the leg in the base and in the platform, by central differences.
    Eigen::Matrix<double, 6, 6> per;
    constexpr double step = 1e-6;
    for (int k = 0; k < 6; ++k) {
      Eigen::Matrix<double, 6, 2> n;
      for (int side : {0, 1}) {
        spatial::Vector6 q = spatial::Vector6::Zero();
        q[k] = side == 0 ? step : -step;
        const Eigen::AngleAxisd turn(q.tail<3>().norm(), q.tail<3>().norm() > 0.0
                                                             ? q.tail<3>().normalized()
                                                             : spatial::Vector3::UnitX());
        const spatial::Matrix3 R = turn.toRotationMatrix() * X_BP.R_BP;
        const spatial::Vector3 joint =
            C + q.head<3>() + R * (leg.platform_joint - machine.platform.mass_center);
        const spatial::Vector3 axis = (joint - leg.base_joint).normalized();
        n.col(side) << axis, R.transpose() * axis;
      }
      per.col(k) = (n.col(0) - n.col(1)) / (2.0 * step);
    }
    stuck.K += sigma * per.transpose() * per;
  }
  const auto limit = modal::normal_modes(stuck);
  const auto free = modal::normal_modes(dynamics::linear_model(machine, X_BP, ModelKind::rigid));
  EXPECT_GT(limit.omega(0), 1.01 * free.omega(0));
  const auto curves = curves_of(machine, {1e-9, 3e-4, 1.0}, ModelKind::rigid);
  ASSERT_EQ(curves.size(), 6U);
  for (const auto& curve : curves) {
    // The order of the modes is another one with these springs.
    const auto nearest = *std::ranges::min_element(limit.omega2, {}, [&](double omega2) {
      return std::abs(std::sqrt(omega2) - curve.points[0].omega);
    });
    EXPECT_NEAR(curve.points[0].omega, std::sqrt(nearest), 1e-6 * curve.omega);
    EXPECT_NEAR(curve.points[2].omega, free.omega(curve.mode), 1e-4 * curve.omega);
    EXPECT_GT(curve.points[1].damping_ratio, curve.points[0].damping_ratio);
    EXPECT_GT(curve.points[1].damping_ratio, curve.points[2].damping_ratio);
  }
}

TEST(ModesAtAmplitudes, MustAscend) {
  const auto machine = guided_machine();
  EXPECT_THROW((void)curves_of(machine, {}), std::invalid_argument);
  EXPECT_THROW((void)curves_of(machine, {0.0, 1e-3}), std::invalid_argument);
  EXPECT_THROW((void)curves_of(machine, {1e-3, 1e-3}), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::test
