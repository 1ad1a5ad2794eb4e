/// Rods and cases that bend: against beam elements, as a potential, and in the linear models. In
/// the nonlinear mechanics: bending_machine_test.cpp.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "dynamics/guide_contact.hpp"
#include "dynamics/leg_beams.hpp"
#include "exact/leg_potential.hpp"
#include "exact/plane_beams.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/bending_machine.hpp"
#include "support/eigenvalues.hpp"

namespace hydrapod::test {
namespace {

using dynamics::leg_beams;
using dynamics::LegBeams;
using dynamics::LegElement;
using dynamics::LegState;
using dynamics::Matrix7;
using dynamics::ModelKind;
using dynamics::straight_leg;
using dynamics::Vector7;
using spatial::Vector3;
using std::numbers::pi;

/// A tube, and where point masses sit on it.
struct Tube {
  double diameter{}, wall{}, density{};
  double length{};              ///< [m]
  double at_start{}, at_end{};  ///< [kg]

  [[nodiscard]] double inside() const { return diameter - 2.0 * wall; }
  [[nodiscard]] double mu() const {
    return density * pi / 4.0 * (diameter * diameter - inside() * inside());
  }
  [[nodiscard]] double second_moment() const {
    return pi / 64.0 * (std::pow(diameter, 4) - std::pow(inside(), 4));
  }
  [[nodiscard]] double mass() const { return mu() * length + at_start + at_end; }
  [[nodiscard]] double center() const {
    return (0.5 * mu() * length * length + at_end * length) / mass();
  }
  [[nodiscard]] double inertia() const {
    return mu() * std::pow(length, 3) / 3.0 + at_end * length * length -
           mass() * center() * center();
  }
};

constexpr double E = 2.03e11;
/// Sections of models/heavy-platform.toml, with pistons, eyes and heads as point masses.
constexpr Tube rod_tube{0.0703, 0.0101, 7830.0, 1.153, 4.1, 1.9};
constexpr Tube case_tube{0.1147, 0.0074, 7790.0, 1.247, 5.3, 4.7};

model::Leg leg_of_tubes(double k_s) {
  model::Leg leg;
  leg.bending = model::LegBending::elastic;
  leg.rod = {.length = rod_tube.length,
             .mass = rod_tube.mass(),
             .mass_center = rod_tube.center(),
             .transverse_inertia = rod_tube.inertia(),
             .diameter = rod_tube.diameter,
             .wall = rod_tube.wall,
             .youngs_modulus = E};
  leg.cylinder_case = {.mass = case_tube.mass(),
                       .mass_center = case_tube.center(),
                       .transverse_inertia = case_tube.inertia(),
                       .diameter = case_tube.diameter,
                       .wall = case_tube.wall};
  leg.guide_sleeve = {.position = case_tube.length, .stiffness = k_s};
  leg.oil_spring.stiffness = 1.7e7;
  return leg;
}

LegElement straight(const model::Leg& leg, double s) {
  kinematics::LegGeometry geometry;
  geometry.length = s + leg.rod.length;
  geometry.n = Vector3(0.13, -0.2, 1.0).normalized();
  geometry.a = leg.base_joint + geometry.length * geometry.n;
  return straight_leg(leg, geometry, model::FlexibleAxes::transverse);
}

/// The leg as beams between pinned joints. The case carries the piston at s.
struct LegOfBeams {
  PlaneBeams beams;
  int piston{PlaneBeams::held}, case_head{}, rod_at_sleeve{};
};

/// `held`: the piston stays where it is, so that only bows are left; `elements` per span.
LegOfBeams leg_of_beams(double s, double P, bool held, int elements) {
  LegOfBeams leg;
  auto& beams = leg.beams;
  const double a = case_tube.length - s, b = rod_tube.length - a;
  const double EI_r = E * rod_tube.second_moment(), EI_c = E * case_tube.second_moment();
  constexpr int pinned = PlaneBeams::held;
  if (!held) leg.piston = beams.freedom();
  leg.case_head = beams.freedom();
  leg.rod_at_sleeve = beams.freedom();
  const int base = beams.freedom(), case_slope = beams.freedom(), head_slope = beams.freedom(),
            rod_slope = beams.freedom(), sleeve_slope = beams.freedom(), end = beams.freedom();
  beams.add({pinned, base, leg.piston, case_slope}, {s, EI_c, case_tube.mu(), P}, elements);
  beams.add({leg.piston, case_slope, leg.case_head, head_slope}, {a, EI_c, case_tube.mu()},
            elements);
  beams.add({leg.piston, rod_slope, leg.rod_at_sleeve, sleeve_slope}, {a, EI_r, rod_tube.mu(), P},
            elements);
  beams.add({leg.rod_at_sleeve, sleeve_slope, pinned, end}, {b, EI_r, rod_tube.mu(), P}, elements);
  if (!held) beams.add_mass(leg.piston, rod_tube.at_start);
  beams.add_mass(leg.case_head, case_tube.at_end);
  return leg;
}

constexpr std::array positions{0.397, 0.61, 0.83, 1.04, 1.19};  // of the piston [m]

TEST(LegBeams, GiveWayAtTheSleeveAsBeamElementsDo) {
  constexpr double tolerance = 1e-8;  // rounding of the elements' equations
  const auto leg = leg_of_tubes(8.4e5);
  for (const double s : positions) {
    const auto beams = leg_of_beams(s, 0.0, true, 13);
    const double f = beams.beams.compliance(beams.case_head, beams.rod_at_sleeve);
    EXPECT_NEAR(straight(leg, s).bending, f, tolerance * f) << s;
  }
}

TEST(LegBeams, GiveWayMoreUnderCompressionAndLessUnderTensionAsBeamElementsDo) {
  constexpr double tolerance = 1e-7;  // 40 elements per span: (κL/40)⁴/720
  const auto beams = leg_beams(leg_of_tubes(8.4e5));
  ASSERT_TRUE(beams);
  for (const double s : positions) {
    const double without = beams->compliance(s, 0.0).f;
    // of 1.3 MN that buckle the rod between its ends
    for (const double P : {-9.1e5, -3.1e4, -120.0, 3.0, 2.9e4, 3.7e5, 9.3e5}) {
      const auto elements = leg_of_beams(s, P, true, 40);
      const double f = elements.beams.compliance(elements.case_head, elements.rod_at_sleeve);
      EXPECT_NEAR(beams->compliance(s, P).f, f, tolerance * f) << s << " m, " << P << " N";
      EXPECT_EQ(beams->compliance(s, P).f > without, P > 0.0);
    }
  }
}

TEST(LegBeams, HaveTheSlopesOfTheirCompliance) {
  // Differences of fourth order of what is nearly a polynomial of fourth degree.
  constexpr double h = 2e-3, tolerance = 1e-8;
  const auto beams = leg_beams(leg_of_tubes(8.4e5));
  ASSERT_TRUE(beams);
  const auto slope = [&](auto part, double s) {
    return (8.0 * (part(s + h) - part(s - h)) - (part(s + 2.0 * h) - part(s - 2.0 * h))) /
           (12.0 * h);
  };
  for (const double P : {-8.2e5, -2.0, 0.0, 4.0, 5.1e4, 7.7e5})
    for (const double s : positions) {
      const auto at = beams->compliance(s, P);
      const auto f = [&](double x) { return beams->compliance(x, P).f; };
      const auto f_s = [&](double x) { return beams->compliance(x, P).f_s; };
      const double a = beams->L_g - s;  // f is of the order of its slopes times a and a²
      EXPECT_NEAR(at.f_s, slope(f, s), tolerance * at.f / a) << P << " " << s;
      EXPECT_NEAR(at.f_ss, slope(f_s, s), tolerance * at.f / (a * a)) << P << " " << s;
    }
}

TEST(LegBeams, AreNoSofterThanAtTheShareOfEulersLoadThatCounts) {
  auto leg = leg_of_tubes(8.4e5);
  leg.cylinder_case.diameter.reset();
  const auto beams = leg_beams(leg);
  const double euler = pi * pi * beams->EI_rod / (beams->l_mn * beams->l_mn);
  const auto f = [&](double share) { return beams->compliance(0.7, share * euler).f; };
  EXPECT_LT(f(0.93), 0.8 * f(0.97));
  EXPECT_EQ(f(0.97), f(5.0));
  // a deflection like a half sine grows by 1/(1 − 0.95)
  EXPECT_NEAR(f(0.97) / f(0.0), 20.0, 0.5);
}

/// Under compression the same force deflects more: momenta grow as the deflection, the energy of
/// the bow as its square.
TEST(LegBeams, CarryMassesThatGrowWithTheirDeflection) {
  const auto beams = leg_beams(leg_of_tubes(8.4e5));
  constexpr double s = 0.61, k = 4.3e6, P = 4.7e5;
  const auto bow = beams->bow_mass(s, P, k), unloaded = beams->bow_mass(s, 0.0, k);
  const double growth = beams->compliance(s, P).f / beams->compliance(s, 0.0).f;
  EXPECT_GT(growth, 1.1);
  EXPECT_NEAR(bow.self / unloaded.self, growth * growth, 1e-12);
  EXPECT_NEAR(bow.piston / unloaded.piston, growth, 1e-12);
  EXPECT_NEAR(bow.tilt / unloaded.tilt, growth, 1e-12);
  EXPECT_NEAR(bow.around / unloaded.around, growth, 1e-12);
  EXPECT_NEAR(bow.moment / unloaded.moment, growth, 1e-12);
}

/// Of the tilt with both joints held: ω of the model over that of beam elements, less 1.
double tilt_error(double k_s, double s, bool with_bow) {
  const auto leg = leg_of_tubes(k_s);
  const auto element = straight(leg, s);
  auto elements = leg_of_beams(s, 0.0, false, 20);
  elements.beams.add_spring(elements.case_head, elements.rod_at_sleeve, k_s);
  auto rigid = leg;
  rigid.bending = model::LegBending::rigid;
  const double M = (with_bow ? element : straight(rigid, s)).M(3, 3);
  return std::sqrt(element.K(3, 3) / M / elements.beams.lowest_omega2()) - 1.0;
}

TEST(LegBending, TiltsAtTheFrequencyOfBeamElements) {
  for (const double k_s : {8.4e5, 4e6, 2e7, 1e9})
    for (const double s : positions) {
      const double error = tilt_error(k_s, s, true);
      EXPECT_GE(error, -1e-7) << k_s << " "
                              << s;  // a Ritz model is stiffer than what it stands for
      EXPECT_LE(error, 1.1e-3) << k_s << " " << s;
    }
  // with the mass on the chords
  EXPECT_LT(tilt_error(8.4e5, positions.front(), false), -0.09);
  EXPECT_LT(tilt_error(1e9, positions.front(), false), -0.2);
  EXPECT_GT(tilt_error(1e9, positions.back(), false), 0.1);
}

TEST(LegBending, IsTheDerivativeOfItsPotentialEnergyWithAndWithoutItsGuide) {
  Random random(917);
  for (const bool contact : {false, true}) {
    // of differences of eighth order; with contact, of an offset that is a root
    const double tolerance = contact ? 1e-6 : 1e-9;
    const auto step = contact ? LegPotential::contact_step : LegPotential::smooth_step;
    for (int i = 0; i < 4; ++i) {
      const auto machine = bending_machine(random, {.axes = model::FlexibleAxes::gimbal});
      for (model::Leg leg : machine.legs) {
        LegState state;
        state.flexible << random.uniform(0.1, 0.15), random.uniform(0.1, 0.15),
            random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01);
        state.oil_force = random.uniform(-2e4, 1e4);
        state.rod_compression = 0.0;
        const Vector3 a = machine.poses[0].X_BP * leg.platform_joint, gravity = random.vector(9.81);
        const auto axes = machine.flexible_axes;
        if (contact) {
          const auto free = bent_leg(leg, a, axes, gravity, state);
          leg.guide_sleeve.gap = 0.2 * free.element.sleeve_offset.norm();
          leg.guide_sleeve.guide_stiffness = 3.3 * leg.guide_sleeve.stiffness;
        }
        const auto bent = bent_leg(leg, a, axes, gravity, state);
        ASSERT_TRUE(bent.exists);
        ASSERT_EQ(bent.element.k_contact > 0.0, contact);
        LegPotential::Coordinates x;
        x << a.cast<long double>(), state.flexible.cast<long double>();
        const LegPotential potential(leg, leg.gimbal_axis, gravity, state.oil_force, x);
        Vector7 gradient;
        gradient << bent.joint_force, bent.flexible_gradient;
        const Vector7 expected = potential.gradient(x, step);
        EXPECT_LE((gradient - expected).norm(), tolerance * expected.norm());
        Matrix7 to_base = Matrix7::Identity();
        to_base.topLeftCorner<3, 3>() = bent.element.frame.R_BL;
        const Matrix7 hessian = to_base.transpose() * potential.hessian(x, step) * to_base;
        EXPECT_LE((bent.K_without_oil - hessian).norm(), tolerance * hessian.norm());
      }
    }
  }
}

TEST(LegBending, OfAnEndlesslyStiffRodIsNone) {
  Random random(46);
  const auto rigid = random_machine(random, {.gravity = Gravity::anywhere});
  auto stiff = rigid;
  for (auto& leg : stiff.legs) {
    leg.bending = model::LegBending::elastic;
    leg.rod.diameter = 0.05;
    leg.rod.youngs_modulus = 1e25;
    leg.cylinder_case.diameter = 0.09;
    leg.cylinder_case.wall = 0.006;
  }
  constexpr double tolerance = 1e-11;
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    const auto expected = dynamics::linear_model(rigid, rigid.neutral(), kind);
    const auto found = dynamics::linear_model(stiff, rigid.neutral(), kind);
    EXPECT_LE((found.K - expected.K).norm(), tolerance * expected.K.norm());
    EXPECT_LE((found.M - expected.M).norm(), tolerance * expected.M.norm());
    EXPECT_LE((found.C - expected.C).norm(), tolerance * expected.C.norm());
  }
}

/// Sections and a modulus that are stated, of rods that do not bend, change no bit of the machine
/// without them; of rods that bend they do.
TEST(LegBending, ThatIsNotAskedForChangesNoBit) {
  Random random(4801);
  for (const auto gravity : {Gravity::none, Gravity::down})
    for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
      auto stated = bending_machine(random, {.gravity = gravity});
      const auto bends = stated;
      for (auto& leg : stated.legs) leg.bending = model::LegBending::rigid;
      auto without = stated;
      for (auto& leg : without.legs) {
        leg.rod.diameter.reset();
        leg.rod.wall.reset();
        leg.cylinder_case.diameter.reset();
        leg.cylinder_case.wall.reset();
        leg.rod.youngs_modulus = model::Rod{}.youngs_modulus;
      }
      const auto& X = without.neutral();
      const auto expected = dynamics::linear_model(without, X, kind);
      const auto found = dynamics::linear_model(stated, X, kind);
      EXPECT_EQ(found.M, expected.M);
      EXPECT_EQ(found.K, expected.K);
      EXPECT_EQ(found.C, expected.C);
      for (std::size_t i = 0; i < model::leg_count; ++i)
        EXPECT_EQ(found.statics.legs[i].flexible, expected.statics.legs[i].flexible);
      if (kind != ModelKind::rigid) EXPECT_NE(dynamics::linear_model(bends, X, kind).K, expected.K);
    }
}

TEST(LegBending, ChangesNothingOfRigidLegs) {
  Random random(48);
  const auto machine = bending_machine(random, {.gravity = Gravity::down});
  auto rigid = machine;
  for (auto& leg : rigid.legs) leg.bending = model::LegBending::rigid;
  const auto expected = dynamics::linear_model(rigid, rigid.neutral(), ModelKind::rigid);
  const auto found = dynamics::linear_model(machine, rigid.neutral(), ModelKind::rigid);
  EXPECT_TRUE(found.M.isApprox(expected.M, 1e-13));
  EXPECT_TRUE(found.K.isApprox(expected.K, 1e-12));
}

/// A straight leg stores f k_s of the seal's energy in its beams, and the damper of the seal loses
/// what a spring f in series with k_s + iωc loses, but for second order in ωc.
TEST(LegBending, SharesEnergyAndDampingAsSpringsInSeriesDo) {
  Random random(49);
  const auto machine = bending_machine(random, {});
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto modes = modal::normal_modes(model);
  for (const auto& shares : modal::energy_shares(model, modes.shapes)) {
    double total = shares.oil.sum() + shares.guide_sleeve.sum() + shares.bending.sum();
    EXPECT_NEAR(total, 1.0, 1e-12);
    for (int i = 0; i < model::leg_count; ++i) {
      const double series = model.legs[i].bending * machine.legs[i].guide_sleeve.stiffness;
      EXPECT_GT(series, 0.4);
      EXPECT_NEAR(shares.bending[i], series * shares.guide_sleeve[i], 1e-12);
    }
  }
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& sleeve = machine.legs[i].guide_sleeve;
    const auto& element = model.legs[i];
    const double lever2 = element.l_mh * element.l_mh;
    const std::complex<double> seal(sleeve.stiffness, 1e-3 * sleeve.stiffness);  // k + iωc
    const std::complex<double> exact = lever2 / (element.bending + 1.0 / seal);
    const double loss = element.C(3, 3) * seal.imag() / sleeve.damping;
    EXPECT_NEAR(element.K(3, 3), exact.real(), 1e-6 * exact.real());
    EXPECT_NEAR(loss, exact.imag(), 2e-6 * exact.imag());
  }
}

/// Springs and arms in series with the compliance f, against the complex stiffness.
void expect_in_series(const dynamics::SealArms& arms, double k) {
  const auto stiffness = [](double slow, const dynamics::SealArms& of, double per_chord,
                            double omega) {
    const std::complex<double> p(0.0, omega);
    std::complex<double> sum = slow;
    for (const auto& arm : of) sum += per_chord * arm.stiffness * p / (p + arm.rate);
    return sum;
  };
  for (const double f : {1e-9, 1.1e-7, 3e-6}) {
    const double r = 1.0 / (1.0 + f * k);
    const auto series = dynamics::arms_in_series(arms, k, f);
    for (const double omega : {0.3, 11.0, 71.0, 430.0, 9e3}) {
      const auto exact = 1.0 / (f + 1.0 / stiffness(k, arms, 1.0, omega));
      const auto found = stiffness(r * k, series, r * r, omega);
      // the pole is known to ε of itself, its distance from that of the seal is f κ of it
      EXPECT_LE(std::abs(found - exact), 1e-15 / (f * k) * std::abs(exact)) << f << " " << omega;
    }
  }
}

/// Of springs and arms in series with a spring, against the complex stiffness; some arms relax
/// alike, or are none.
TEST(LegBending, IsInSeriesWithTheArmsOfAnElastomer) {
  constexpr double k = 8.4e5;
  const auto of = [](const Vector3& strength, const Vector3& time) {
    return dynamics::seal_arms(k, {.arms = model::MaxwellArms{.strength = strength, .time = time}});
  };
  for (const auto& arms :
       {dynamics::seal_arms(k, {.dynamic_ratio = 2.3, .loss_factor = 0.21, .frequency = 71.0}),
        of({0.31, 0.17, 0.43}, {0.0031, 0.27, 0.019}), of({0.31, 0.0, 0.43}, {0.0031, 0.27, 0.019}),
        of({0.31, 0.17, 0.43}, {0.0031, 0.27, 0.27}), of({0.0, 0.17, 0.0}, {0.01, 0.01, 0.01})})
    expect_in_series(arms, k);
}

}  // namespace
}  // namespace hydrapod::test
