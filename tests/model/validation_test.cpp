/// What no machine can be, however it was described.

#include "hydrapod/model/machine_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hydrapod/model/parameters.hpp"
#include "sound_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::model {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A sound machine with everything that is optional, so that every number is there.
Machine full_machine() {
  Machine machine = parse_machine(sound_machine_file, "m.toml").machine;
  for (Leg& leg : machine.legs) {
    leg.piston_ring = PistonRing{1e7, 10.0};
    leg.joint_limits = {0.5, 0.6};
    leg.oil_spring.cylinder->air = EntrainedAir{0.01, 7e6, 1.4};
    leg.oil_spring.cylinder->control_volume = 1e-3;
  }
  machine.damping.modal_ratio = 0.01;
  return machine;
}

/// "key: message" of every finding.
std::vector<std::string> findings_about(const Machine& machine) {
  std::vector<std::string> texts;
  for (const auto& finding : validate(machine))
    texts.push_back(finding.key + ": " + finding.message);
  return texts;
}

struct Number {
  std::string key;
  double& (*in)(Machine&);
};

const std::vector<Number> numbers{
    {"environment.gravity", [](Machine& m) -> double& { return m.gravity.y(); }},
    {"platform.mass", [](Machine& m) -> double& { return m.platform.mass; }},
    {"platform.mass_center", [](Machine& m) -> double& { return m.platform.mass_center.z(); }},
    {"platform.inertia", [](Machine& m) -> double& { return m.platform.inertia(2, 1); }},
    {"damping.modal_ratio", [](Machine& m) -> double& { return *m.damping.modal_ratio; }},
    {"damping.rayleigh_mass", [](Machine& m) -> double& { return m.damping.rayleigh_mass; }},
    {"damping.rayleigh_stiffness",
     [](Machine& m) -> double& { return m.damping.rayleigh_stiffness; }},
    {"poses.tilted.position", [](Machine& m) -> double& { return m.poses[1].X_BP.p_BP.x(); }},
    {"poses.tilted.rotation", [](Machine& m) -> double& { return m.poses[1].X_BP.R_BP(1, 2); }}};

struct LegNumber {
  std::string key;
  double& (*in)(Leg&);
};

const std::vector<LegNumber> leg_numbers{
    {"base_joint", [](Leg& l) -> double& { return l.base_joint.x(); }},
    {"platform_joint", [](Leg& l) -> double& { return l.platform_joint.z(); }},
    {"case.mass", [](Leg& l) -> double& { return l.cylinder_case.mass; }},
    {"case.mass_center", [](Leg& l) -> double& { return l.cylinder_case.mass_center; }},
    {"case.transverse_inertia",
     [](Leg& l) -> double& { return l.cylinder_case.transverse_inertia; }},
    {"case.axial_inertia", [](Leg& l) -> double& { return l.cylinder_case.axial_inertia; }},
    {"rod.length", [](Leg& l) -> double& { return l.rod.length; }},
    {"rod.mass", [](Leg& l) -> double& { return l.rod.mass; }},
    {"rod.mass_center", [](Leg& l) -> double& { return l.rod.mass_center; }},
    {"rod.transverse_inertia", [](Leg& l) -> double& { return l.rod.transverse_inertia; }},
    {"rod.axial_inertia", [](Leg& l) -> double& { return l.rod.axial_inertia; }},
    {"guide_sleeve.position", [](Leg& l) -> double& { return l.guide_sleeve.position; }},
    {"guide_sleeve.stiffness", [](Leg& l) -> double& { return l.guide_sleeve.stiffness; }},
    {"guide_sleeve.damping", [](Leg& l) -> double& { return l.guide_sleeve.damping; }},
    {"piston_ring.stiffness", [](Leg& l) -> double& { return l.piston_ring->stiffness; }},
    {"piston_ring.damping", [](Leg& l) -> double& { return l.piston_ring->damping; }},
    {"oil_spring.damping", [](Leg& l) -> double& { return l.oil_spring.damping; }},
    {"oil_spring.cylinder.bore", [](Leg& l) -> double& { return l.oil_spring.cylinder->bore; }},
    {"oil_spring.cylinder.rod_diameter",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->rod_diameter; }},
    {"oil_spring.cylinder.cap_dead_volume",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->cap_dead_volume; }},
    {"oil_spring.cylinder.rod_dead_volume",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->rod_dead_volume; }},
    {"oil_spring.cylinder.cap_line_volume",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->cap_line_volume; }},
    {"oil_spring.cylinder.rod_line_volume",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->rod_line_volume; }},
    {"oil_spring.cylinder.bulk_modulus",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->bulk_modulus; }},
    {"oil_spring.cylinder.control_volume",
     [](Leg& l) -> double& { return *l.oil_spring.cylinder->control_volume; }},
    {"oil_spring.cylinder.air.fraction",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->air->fraction; }},
    {"oil_spring.cylinder.air.pressure",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->air->pressure; }},
    {"oil_spring.cylinder.air.polytropic",
     [](Leg& l) -> double& { return l.oil_spring.cylinder->air->polytropic; }},
    {"stroke.retracted", [](Leg& l) -> double& { return l.stroke->retracted; }},
    {"stroke.length", [](Leg& l) -> double& { return l.stroke->length; }},
    {"joint_limits.base", [](Leg& l) -> double& { return *l.joint_limits.base; }},
    {"joint_limits.platform", [](Leg& l) -> double& { return *l.joint_limits.platform; }},
    {"added_axial_inertia", [](Leg& l) -> double& { return l.added_axial_inertia; }},
    {"gimbal_axis", [](Leg& l) -> double& { return l.gimbal_axis.x(); }}};

TEST(Validation, ASoundMachineHasNoFindings) {
  EXPECT_THAT(findings_about(full_machine()), IsEmpty());
  EXPECT_THAT(findings_about(parse_machine(starter_machine_file(), "s").machine), IsEmpty());
}

TEST(Validation, EveryNumberMustBeFinite) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const auto& number : numbers) {
    Machine machine = full_machine();
    number.in(machine) = std::nan("");
    EXPECT_THAT(findings_about(machine),
                ElementsAre(number.key + ": is nan, expected a finite number"));
    number.in(machine) = -infinity;
    EXPECT_THAT(findings_about(machine),
                ElementsAre(number.key + ": is -inf, expected a finite number"));
  }
  for (const auto& number : leg_numbers) {
    Machine machine = full_machine();
    number.in(machine.legs[1]) = infinity;
    EXPECT_THAT(findings_about(machine),
                ElementsAre("leg.2." + number.key + ": is inf, expected a finite number"));
  }
}

/// Squares and products of numbers up to 1e30 stay finite in double precision.
TEST(Validation, NumbersThatWouldOverflowAreRefused) {
  for (const auto& number : leg_numbers) {
    Machine machine = full_machine();
    number.in(machine.legs[5]) = 1e31;
    const auto findings = validate(machine);
    ASSERT_FALSE(findings.empty()) << number.key;
    EXPECT_EQ(findings[0].key, "leg.6." + number.key);
    EXPECT_THAT(findings[0].message, testing::EndsWith("expected no more than 1e+30"));
  }
}

TEST(Validation, StiffSealsAreNotRefused) {
  Machine machine = full_machine();
  for (Leg& leg : machine.legs) leg.guide_sleeve.stiffness = leg.piston_ring->stiffness = 1e15;
  EXPECT_THAT(findings_about(machine), IsEmpty());
}

TEST(Validation, WhatMustNotBeNegative) {
  for (const auto& number : leg_numbers) {
    const bool any_sign = number.key.ends_with("joint") || number.key.ends_with("mass_center") ||
                          number.key == "gimbal_axis";
    if (any_sign) continue;
    Machine machine = full_machine();
    number.in(machine.legs[0]) = -1.0;
    const auto findings = validate(machine);
    ASSERT_EQ(findings.size(), 1u) << number.key;
    EXPECT_EQ(findings[0].key, "leg.1." + number.key);
    EXPECT_THAT(findings[0].message, testing::StartsWith("is -1"));
  }
}

TEST(Validation, AFaultOfAllLegsIsOneFinding) {
  Machine machine = full_machine();
  for (Leg& leg : machine.legs) leg.rod.length = 0.0;
  EXPECT_THAT(findings_about(machine),
              ElementsAre("legs.rod.length: is 0 m, expected more than 0"));
  machine.legs[3].rod.length = -1.0;
  EXPECT_EQ(validate(machine).size(), 6u);
  EXPECT_EQ(validate(machine)[3].key, "leg.4.rod.length");
}

TEST(Validation, InertiaOfAThinPlateIsAllowedAndLessIsNot) {
  Machine machine = full_machine();
  machine.platform.inertia =
      Vector3(100, 200, 300).asDiagonal();  // a flat body: I_zz = I_xx + I_yy
  EXPECT_THAT(findings_about(machine), IsEmpty());
  machine.platform.inertia(2, 2) = 300.001;
  EXPECT_THAT(findings_about(machine),
              ElementsAre("platform.inertia: principal moments 100, 200, 300.001 kg m^2: no body "
                          "has these, expected none above the sum of the other two"));
}

TEST(Validation, InertiaIsJudgedByPrincipalMomentsNotByTheDiagonal) {
  Machine machine = full_machine();
  const Matrix3 R = spatial::rotation_from_rpy({0.3, -0.7, 1.1});
  const Matrix3 bad = Vector3(100, 200, 350).asDiagonal();
  machine.platform.inertia = R * bad * R.transpose();
  const auto& I = machine.platform.inertia;
  ASSERT_GT(I(0, 0) + I(1, 1), I(2, 2));  // the diagonal alone looks like a body
  ASSERT_GT(I(0, 0) + I(2, 2), I(1, 1));
  ASSERT_GT(I(1, 1) + I(2, 2), I(0, 0));
  EXPECT_EQ(validate(machine).size(), 1u);
  const Matrix3 good = Vector3(100, 200, 250).asDiagonal();
  machine.platform.inertia = R * good * R.transpose();
  EXPECT_THAT(findings_about(machine), IsEmpty());
}

TEST(Validation, InertiaMayBeVeryLargeOrSmall) {
  Machine machine = full_machine();
  for (const double scale : {1e-20, 1e20}) {
    machine.platform.inertia = scale * Vector3(5, 6, 7).asDiagonal().toDenseMatrix();
    EXPECT_THAT(findings_about(machine), IsEmpty());
  }
}

TEST(Validation, JointsInOnePlaceAreNamedTogether) {
  Machine machine = full_machine();
  for (const int i : {1, 3, 5}) machine.legs[i].base_joint = Vector3(0.5, 0.25, 0);
  const std::string three =
      "leg.6.base_joint: legs 2, 4, 6 have their base joints in one place, (0.5, 0.25, 0) m";
  EXPECT_THAT(findings_about(machine), ElementsAre(three + "; is this meant?"));
  EXPECT_EQ(validate(machine).front().severity, base::Severity::warning);
  machine.legs[0].base_joint = machine.legs[1].base_joint;
  EXPECT_THAT(findings_about(machine),
              ElementsAre("leg.6.base_joint: legs 1, 2, 4, 6 have their base joints in one place, "
                          "(0.5, 0.25, 0) m, expected no more than three legs in a point"));
  EXPECT_EQ(validate(machine).front().severity, base::Severity::error);
}

/// Three pairs at one side or at both: 6-3 and 3-3 platforms.
TEST(Validation, JointsMayMeetInPairs) {
  Machine machine = full_machine();
  const auto meet = [&](Vector3 Leg::*joint, std::initializer_list<std::array<int, 2>> pairs) {
    for (const auto& [i, j] : pairs) machine.legs[i].*joint = machine.legs[j].*joint;
  };
  meet(&Leg::platform_joint, {{0, 1}, {2, 3}, {4, 5}});
  EXPECT_THAT(findings_about(machine), IsEmpty());
  meet(&Leg::base_joint, {{0, 5}, {2, 1}, {4, 3}});
  EXPECT_THAT(findings_about(machine), IsEmpty());
  meet(&Leg::base_joint, {{0, 1}, {2, 3}, {4, 5}});
  EXPECT_THAT(findings_about(machine), testing::SizeIs(3));  // pairs of legs along one line
}

TEST(Validation, OnePairInOnePlaceIsAskedAbout) {
  Machine machine = full_machine();
  machine.legs[0].platform_joint = machine.legs[1].platform_joint + Vector3(1e-5, 0, 0);
  EXPECT_THAT(findings_about(machine), IsEmpty());
  machine.legs[0].platform_joint = machine.legs[1].platform_joint + Vector3(1e-8, 0, 0);
  ASSERT_EQ(validate(machine).size(), 1u);
  EXPECT_EQ(validate(machine).front().severity, base::Severity::warning);
}

TEST(Validation, BristlesOfJointsNeedFriction) {
  Machine machine = full_machine();
  for (auto& leg : machine.legs) {
    leg.hydraulics.joint_friction = {};
    leg.hydraulics.joint_friction.bristle_stiffness = 3e5;
  }
  EXPECT_THAT(findings_about(machine),
              ElementsAre("legs.joint_friction.bristle_stiffness: has no effect with `coulomb` = 0 "
                          "N m, expected more"));
  EXPECT_EQ(validate(machine).front().severity, base::Severity::warning);
  for (auto& leg : machine.legs) leg.hydraulics.joint_friction.coulomb = 40.0;
  EXPECT_THAT(findings_about(machine), IsEmpty());
}

/// Of a line with a length the inertia follows; a number beside it may be of the same oil.
TEST(Validation, OilInALineThatIsCountedTwiceIsAskedAbout) {
  Machine machine = full_machine();
  for (auto& leg : machine.legs) {
    leg.added_axial_inertia = 13.7;
    leg.oil_spring = {.cylinder = model::Cylinder{.cap_line_volume = 1.1e-3}};
  }
  const auto about_inertia = [&] {
    std::vector<std::string> found;
    for (const auto& finding : validate(machine))
      if (finding.key.ends_with("added_axial_inertia")) {
        EXPECT_EQ(finding.severity, base::Severity::warning);
        found.push_back(finding.key + ": " + finding.message);
      }
    return found;
  };
  EXPECT_THAT(about_inertia(), IsEmpty());
  machine.legs[3].oil_spring.cylinder->cap_line_length = 3.75;
  EXPECT_THAT(about_inertia(),
              ElementsAre("leg.4.added_axial_inertia: is 13.7 kg beside "
                          "`oil_spring.cylinder.cap_line_length` = 3.75 m, from which the oil of "
                          "this line has an inertia: is it counted twice?"));
  machine.legs[3].added_axial_inertia = 0.0;
  EXPECT_THAT(about_inertia(), IsEmpty());
}

TEST(Validation, ExactlyOneOilSpring) {
  Machine machine = full_machine();
  machine.legs[0].oil_spring.stiffness = 1e7;
  EXPECT_THAT(findings_about(machine),
              ElementsAre("leg.1.oil_spring: both `stiffness` and `cylinder` are given, expected "
                          "one of them"));
  machine.legs[0].oil_spring = {};
  EXPECT_THAT(findings_about(machine),
              ElementsAre("leg.1.oil_spring: neither `stiffness` nor `cylinder` is given, expected "
                          "one of them"));
}

TEST(Validation, EqualVolumesNeedAVolumeOrAStroke) {
  Machine machine = full_machine();
  Leg& leg = machine.legs[0];
  leg.stroke.reset();
  leg.oil_spring.cylinder->volumes = VolumeRule::equal;
  EXPECT_THAT(findings_about(machine), IsEmpty());
  leg.oil_spring.cylinder->control_volume.reset();
  ASSERT_EQ(validate(machine).size(), 1u);
  EXPECT_EQ(validate(machine)[0].key, "leg.1.oil_spring.cylinder.control_volume");
}

/// With the platform held, the case turns about the base joint and the rod about the platform
/// joint.
TEST(Validation, FlexibleCoordinatesNeedInertia) {
  Machine machine = full_machine();
  Leg& leg = machine.legs[0];
  leg.cylinder_case = {};
  EXPECT_EQ(validate(machine).at(0).key, "leg.1.case.transverse_inertia");
  leg.piston_ring.reset();  // case and rod then move together, and the rod has inertia
  EXPECT_THAT(findings_about(machine), IsEmpty());
  leg.rod.transverse_inertia = 0.0;
  EXPECT_THAT(findings_about(machine), IsEmpty());
  leg.rod.mass_center = leg.rod.length;  // all its mass in the platform joint
  EXPECT_EQ(validate(machine).at(0).key, "leg.1.rod.transverse_inertia");
}

/// What follows from a wrong number is not reported besides it.
TEST(Validation, AMassBelowZeroIsOneFinding) {
  Machine machine = full_machine();
  machine.legs[0].cylinder_case.mass = -60.0;
  machine.legs[0].cylinder_case.mass_center = 2.0;
  const auto findings = findings_about(machine);
  EXPECT_THAT(findings, testing::Contains(testing::HasSubstr("case.mass: ")));
  EXPECT_THAT(findings, testing::Not(testing::Contains(testing::HasSubstr("no inertia about"))));
}

TEST(Validation, TheGimbalAxisIsAUnitVector) {
  Machine machine = full_machine();
  machine.legs[0].gimbal_axis = Vector3(0, 2, 0);
  EXPECT_THAT(findings_about(machine),
              ElementsAre("leg.1.gimbal_axis: has the length 2, expected a unit vector"));
}

TEST(Validation, PosesBeginWithNeutralAndDiffer) {
  Machine machine = full_machine();
  machine.poses[0].name = "tilted";
  EXPECT_THAT(findings_about(machine),
              ElementsAre("poses: has no first pose \"neutral\", expected one",
                          "poses.tilted: is given twice, expected different names"));
  machine.poses.clear();
  EXPECT_EQ(validate(machine).size(), 1u);
}

TEST(Validation, RotationsMustBeRotations) {
  Machine machine = full_machine();
  for (const Matrix3& R : {Matrix3(2 * Matrix3::Identity()), Matrix3(-Matrix3::Identity())}) {
    machine.poses[0].X_BP.R_BP = R;
    EXPECT_THAT(findings_about(machine),
                ElementsAre("poses.neutral.rotation: is not a rotation, expected an orthonormal "
                            "right-handed matrix"));
  }
}

TEST(Validation, AnUnsetMachineHasManyFindingsAndDoesNotThrow) {
  EXPECT_GT(findings_about(Machine{}).size(), 5u);
}

/// Values across and beyond their bounds, of every number that validate() relates to no other.
TEST(Validation, OfNumbersThatStandAloneIsTheirBound) {
  test::Random random(77);
  int alone = 0, unsound = 0;
  for (int trial = 0; trial < 3; ++trial) {
    const auto machine = test::random_machine(random);
    for (const auto& id : parameters(machine)) {
      if (!stands_alone(machine, id)) continue;
      ++alone;
      for (const double value :
           {-1.0, 0.0, 1e-35, 3e-4, 0.7, 41.0, 2e6, 1e29, 1e31,
            std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        const Assignment assignment{id, value};
        const bool sound = validate(with(machine, {&assignment, 1})).empty();
        EXPECT_EQ(within_bound(assignment), sound) << path(machine, id) << " = " << value;
        unsound += sound ? 0 : 1;
      }
    }
  }
  EXPECT_GT(alone, 150);
  EXPECT_GT(unsound, alone);
}

TEST(Bending, NeedsToKnowHowThickTheRodIs) {
  auto machine = full_machine();
  for (Leg& leg : machine.legs) leg.bending = LegBending::elastic;
  EXPECT_THAT(findings_about(machine), IsEmpty());  // the cylinder says it
  machine.legs[3].oil_spring = {.stiffness = 2e7};
  EXPECT_THAT(findings_about(machine), testing::Contains(testing::AllOf(
                                           testing::HasSubstr("bending: is \"elastic\" for a rod "
                                                              "of unknown thickness"),
                                           testing::HasSubstr("`rod.diameter`"))));
  machine.legs[3].rod.diameter = 0.051;
  EXPECT_THAT(findings_about(machine), IsEmpty());
}

TEST(Bending, MakesTheSectionsOfRodAndCaseMechanical) {
  auto machine = full_machine();
  const auto id = find_parameter(machine, "legs.rod.youngs_modulus");
  ASSERT_TRUE(id);
  EXPECT_FALSE(of_mechanics(machine, *id));
  machine.legs[0].bending = LegBending::elastic;
  EXPECT_TRUE(of_mechanics(machine, *id));
  const auto yield = find_parameter(machine, "legs.rod.yield_strength");
  ASSERT_TRUE(yield);
  EXPECT_FALSE(of_mechanics(machine, *yield));
}

/// The pressures at rest do not know the friction.
TEST(PressedSeals, MakeWhatThePressuresFollowFromMechanical) {
  auto machine = full_machine();
  const auto of = [&](const char* path) {
    const auto id = find_parameter(machine, path);
    return id && of_mechanics(machine, *id);
  };
  const std::vector<const char*> of_pressures{"supply.pressure", "supply.return_pressure",
                                              "legs.valve.overlap", "legs.leakage.external"};
  for (const auto* path : of_pressures) EXPECT_FALSE(of(path)) << path;
  machine.legs[4].guide_sleeve.elastomer = {.pressure_stiffening = 3.7e-8};
  for (const auto* path : of_pressures) EXPECT_TRUE(of(path)) << path;
  EXPECT_FALSE(of("legs.friction.coulomb"));
  machine.legs[4].guide_sleeve.elastomer->pressure_stiffening = 0.0;
  for (const auto* path : of_pressures) EXPECT_FALSE(of(path)) << path;
}

}  // namespace
}  // namespace hydrapod::model
