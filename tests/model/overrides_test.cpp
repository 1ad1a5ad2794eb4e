/// `--set PATH=VALUE`: what the file would say if it said something else.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"

namespace hydrapod::model {
namespace {

Machine with(const std::vector<std::string>& overrides) {
  return parse_machine(sound_machine_file, "m.toml", overrides).machine;
}

TEST(Overrides, TakeNumbersAndQuantities) {
  EXPECT_EQ(with({"platform.mass=3"}).platform.mass, 3.0);
  EXPECT_EQ(with({"platform.mass=3 t"}).platform.mass, 3000.0);
  EXPECT_EQ(with({"platform.mass=\"3 t\""}).platform.mass, 3000.0);
  EXPECT_EQ(with({" platform.mass = 2.5e3 "}).platform.mass, 2500.0);
  EXPECT_EQ(with({"platform.mass=.5"}).platform.mass, 0.5);   // TOML would want 0.5
  EXPECT_EQ(with({"platform.mass=007"}).platform.mass, 7.0);  // and 7
}

TEST(Overrides, SwitchGravityOff) {
  const Machine machine = with({"environment.gravity=0"});
  EXPECT_EQ(machine.gravity, Vector3::Zero());
  EXPECT_FALSE(std::signbit(machine.gravity.z()));
}

TEST(Overrides, TakeWordsArraysAndTables) {
  EXPECT_EQ(with({"model.flexible_axes=gimbal"}).flexible_axes, FlexibleAxes::gimbal);
  EXPECT_EQ(with({"name=two words"}).name, "two words");
  EXPECT_EQ(with({"platform.mass_center=[1, 2, \"3 mm\"]"}).platform.mass_center,
            Vector3(1, 2, 0.003));
  const Machine machine = with({"legs.piston_ring={ stiffness = 7, damping = 8 }"});
  EXPECT_EQ(machine.legs[3].piston_ring.value().damping, 8.0);
}

/// A part that is rigid where it is left out is left out; other springs get a large number.
TEST(Overrides, SpringsMayBeRigid) {
  EXPECT_EQ(with({"legs.guide_sleeve.stiffness=rigid"}).legs[0].guide_sleeve.stiffness, 1e12);
  EXPECT_EQ(with({"legs.oil_spring={stiffness=\"rigid\"}"}).legs[2].oil_spring.stiffness, 1e12);
  const Machine gimbals =
      with({"legs.gimbal_stiffness=300 kN/mm", "leg.3.gimbal_stiffness=\"rigid\""});
  EXPECT_EQ(gimbals.legs[1].gimbal_stiffness, 3e8);
  EXPECT_FALSE(gimbals.legs[2].gimbal_stiffness);
  const Machine mounted =
      with({"base.mount={stiffness={x=1e8,rz=\"rigid\"},mass=2000,inertia=[100,100,100]}"});
  const Machine left_out = with({"base.mount={stiffness={x=1e8},mass=2000,inertia=[100,100,100]}"});
  ASSERT_TRUE(mounted.base_mount && left_out.base_mount);
  EXPECT_EQ(mounted.base_mount->stiffness, left_out.base_mount->stiffness);
}

/// The assumed ratio of 2 % is for files without a word about damping.
TEST(Overrides, ADamperOfZeroSaysThatNothingDamps) {
  const std::vector<std::string> undamped{"legs.guide_sleeve.damping=0",
                                          "legs.oil_spring.damping=0"};
  EXPECT_EQ(seal_ratio(with(undamped)).value, 0.0);
  EXPECT_FALSE(seal_ratio(with(undamped)).is_default);
  auto and_a_ratio = undamped;
  and_a_ratio.push_back("damping.modal_ratio=3 %");
  EXPECT_EQ(seal_ratio(with(and_a_ratio)).value, 0.03);
}

/// Nor is it assumed where a study takes a damper of the file to zero.
TEST(Overrides, ADamperThatIsTakenToZeroLeavesNothingThatDamps) {
  auto machine = with({"legs.oil_spring.damping=512.3"});
  for (auto& leg : machine.legs) leg.oil_spring.damping = 0.0;
  EXPECT_EQ(seal_ratio(machine).value, 0.0);
  EXPECT_FALSE(seal_ratio(machine).is_default);
}

TEST(Overrides, OnlySpringsMayBeRigidAndNoneIsStifferThanRounding) {
  EXPECT_THROW(with({"platform.mass=rigid"}), base::InputError);
  EXPECT_NO_THROW(with({"legs.guide_sleeve.stiffness=1e15"}));
  try {
    with({"legs.guide_sleeve.stiffness=1e22"});
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("is 1e+22 N/m, expected no more than 1e+15"),
              std::string::npos)
        << error.what();
  }
}

TEST(Overrides, ReachElementsOfArrays) {
  EXPECT_EQ(with({"platform.mass_center[2]=-10 cm"}).platform.mass_center, Vector3(0, 0, -0.1));
  EXPECT_EQ(with({"poses.tilted.rotation[1]=0.25"}).poses[1].X_BP.R_BP,
            spatial::rotation_from_rpy({10 * std::acos(-1.0) / 180, 0.25, 0}));
}

/// The file gives a circle of joints, an axis for all legs, a magnitude, a pose without rotation.
TEST(Overrides, ReachElementsThatTheFileSaysInAnotherWay) {
  const Machine as_it_is = with({});
  const Machine moved = with({"leg.1.base_joint[0]=1.07 m", "leg.1.base_joint[2]=2 mm"});
  EXPECT_EQ(moved.legs[0].base_joint, Vector3(1.07, as_it_is.legs[0].base_joint.y(), 0.002));
  EXPECT_EQ(moved.legs[1].base_joint, as_it_is.legs[1].base_joint);
  const Machine turned = with({"leg.2.gimbal_axis[0]=1"});
  EXPECT_TRUE(turned.legs[1].gimbal_axis.isApprox(Vector3(1, 1, 0).normalized()));
  EXPECT_EQ(turned.legs[2].gimbal_axis, Vector3(0, 1, 0));
  EXPECT_EQ(with({"environment.gravity[0]=0.3"}).gravity, Vector3(0.3, 0, -9.81));
  EXPECT_EQ(with({"poses.neutral.rotation[2]=0.25"}).poses[0].X_BP.R_BP,
            spatial::rotation_from_rpy({0, 0, 0.25}));
  const Machine of_rows =
      with({"platform.inertia=[[500,1,2],[1,550,3],[2,3,800]]", "platform.inertia.xy=7"});
  EXPECT_EQ(of_rows.platform.inertia(0, 1), 7.0);
  EXPECT_EQ(of_rows.platform.inertia(1, 2), 3.0);
  EXPECT_EQ(complaint_about(sound_machine_file, {"leg.2.gimbal_axis[3]=1"}),
            "--set leg.2.gimbal_axis[3]=1: error: leg.2.gimbal_axis[3]: `leg.2.gimbal_axis` is an "
            "array of 3, counted from 0");
}

/// Whatever a study may vary can be given by an override too.
TEST(Overrides, TakeEveryNumberThatTheFileHas) {
  const auto file = parse_machine(sound_machine_file, "m.toml");
  for (const auto& id : parameters(file.machine)) {
    const auto number = number_of(file, id);
    if (!number || !find_number(file, number->path)) continue;
    if (!within_bound({id, number->value})) continue;  // 0 for a part that is left out
    EXPECT_EQ(
        complaint_about(sound_machine_file, {fmt::format("{}={}", number->path, number->value)}),
        "")
        << number->path;
  }
}

TEST(Overrides, MakeTablesThatTheFileHasNot) {
  const Machine machine = with({"leg.5.rod.length=1.1", "damping.modal_ratio=3 %",
                                "poses.\"far left\".position=[0, 0.1, 1.4]"});
  EXPECT_EQ(machine.legs[4].rod.length, 1.1);
  EXPECT_EQ(machine.legs[3].rod.length, 1.05);
  EXPECT_EQ(machine.damping.modal_ratio, 0.03);
  EXPECT_EQ(machine.poses.back().name, "far left");
}

TEST(Overrides, TheLaterOneCounts) {
  EXPECT_EQ(with({"platform.mass=1", "platform.mass=2"}).platform.mass, 2.0);
}

TEST(Overrides, OfAllLegsLeaveWhatOneLegSays) {
  const Machine machine = with({"legs.guide_sleeve.stiffness=1e9"});
  EXPECT_EQ(machine.legs[0].guide_sleeve.stiffness, 1e9);
  EXPECT_DOUBLE_EQ(machine.legs[2].guide_sleeve.stiffness, 4e6);
}

TEST(Overrides, OfTheOilSpringReplaceTheOtherKind) {
  const Machine stiffness = with({"legs.oil_spring.stiffness=2e7"});
  EXPECT_EQ(stiffness.legs[0].oil_spring.stiffness, 2e7);
  EXPECT_FALSE(stiffness.legs[0].oil_spring.cylinder);

  const Machine one_leg = with({"leg.3.oil_spring.stiffness=2e7"});
  EXPECT_TRUE(one_leg.legs[2].oil_spring.stiffness);
  EXPECT_TRUE(one_leg.legs[1].oil_spring.cylinder);

  const Machine back = with({"legs.oil_spring.stiffness=2e7",
                             "legs.oil_spring.cylinder={ bore = 0.1, rod_diameter = 0.05, "
                             "bulk_modulus = 1e9 }"});
  EXPECT_FALSE(back.legs[0].oil_spring.stiffness);
  EXPECT_EQ(back.legs[0].oil_spring.cylinder.value().bore, 0.1);
}

TEST(Overrides, OfTheJointsReplaceTheOtherKind) {
  const Machine machine =
      with({"base.joints.points=[[1,0,0],[1,1,0],[0,1,0],[-1,0,0],[-1,-1,0],"
            "[0,-1,0]]"});
  EXPECT_EQ(machine.legs[4].base_joint, Vector3(-1, -1, 0));
}

/// An override is one value: it cannot smuggle in further keys.
TEST(Overrides, AreOneValueEach) {
  EXPECT_EQ(complaint_about(sound_machine_file, {"platform.mass=3\nname = \"other\""}),
            "--set platform.mass=3?name = \"other\": error: platform.mass: \"3?name = \"other\"\" "
            "has the unknown unit \"name = \"other\"\", expected a mass such as \"kg\"");
}

TEST(Overrides, AreShownShortAndOnOneLine) {
  const std::string text = "platform.mass=" + std::string(200, '\x1b');
  const std::string complaint = complaint_about(sound_machine_file, {text});
  EXPECT_EQ(complaint.substr(0, 100),
            "--set platform.mass=" + std::string(66, '?') + "...: error: pl");
  EXPECT_NE(complaint_about(sound_machine_file, {"name=" + std::string(5000, 'x')}), "");
}

}  // namespace
}  // namespace hydrapod::model
