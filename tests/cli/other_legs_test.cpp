/// Plain struts and electric cylinders at the command line: what works says which legs it is of,
/// what needs hydraulics is refused in one sentence.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "support/other_legs.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using test::run_hydrapod;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class OtherLegs : public testing::Test {
 protected:
  OtherLegs() {
    test::write_text(folder_ / "struts.toml", test::strut_file);
    test::write_text(folder_ / "screws.toml", test::screw_file);
  }
  test::RunResult run(const std::vector<std::string>& arguments) {
    return run_hydrapod(arguments, {.folder = folder_.path()});
  }
  test::TemporaryFolder folder_{};
};

constexpr auto of_struts = "the legs are plain struts: results are of the rigid-leg model";

TEST_F(OtherLegs, CheckOfStrutsHasNeitherOilNorStroke) {
  const auto result = run({"check", "struts.toml"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(of_struts));
  EXPECT_THAT(result.out, HasSubstr("strut N/µm"));
  EXPECT_THAT(result.out, HasSubstr("Sound at all 2 poses."));
  for (const char* word : {"oil", "piston", "stroke", "hydraulics", "column", "Buckling"})
    EXPECT_THAT(result.out, Not(HasSubstr(word)));
  const auto json = nlohmann::json::parse(run({"check", "struts.toml", "--format", "json"}).out);
  for (const char* of_oil : {"largest_push_N", "largest_pull_N"})
    EXPECT_TRUE(json["poses"][0]["legs"][0][of_oil].is_null()) << of_oil;
}

TEST_F(OtherLegs, ModesOfStrutsSayWhichModelTheyAreOf) {
  const auto result = run({"modes", "struts.toml"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("rigid-leg model, 6 modes"));
  EXPECT_THAT(result.out, HasSubstr(of_struts));
  EXPECT_THAT(result.out, HasSubstr("struts of"));
  EXPECT_THAT(result.out, HasSubstr("struts 100 %"));
  const auto json = nlohmann::json::parse(run({"modes", "struts.toml", "--format", "json"}).out);
  EXPECT_THAT(json["machine"]["state"].get<std::string>(), HasSubstr(of_struts));
  EXPECT_EQ(json["modes"].size(), 6u);
  EXPECT_EQ(run({"modes", "struts.toml", "--poses", "all"}).exit_code, 0);
}

/// Struts have no seals, no pistons and no rigid counterpart.
TEST_F(OtherLegs, StudiesOfStrutsHaveNoOutputsOfCylinders) {
  const std::vector<std::string> sweep{"sweep", "struts.toml", "--over",
                                       "platform.mass=1300:1400:3 kg"};
  const auto with = [&](const std::vector<std::string>& more) {
    auto arguments = sweep;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  const auto result = with({});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("lowest"));
  EXPECT_THAT(result.out, HasSubstr("\nLeft out: drop compares flexible legs with rigid ones, and "
                                    "plain struts have no guide sleeves.\n"));
  for (const char* absent : {"\ndrop", "\nstroke", "\nbuckling"})
    EXPECT_THAT(result.out, Not(HasSubstr(absent)));
  const auto json = nlohmann::json::parse(with({"--format", "json"}).out);
  for (const auto& output : json["outputs"])
    EXPECT_THAT(output["name"].get<std::string>(),
                Not(testing::AnyOf(testing::StartsWith("drop"), "stroke", "buckling")));
  for (const auto& [output, why] :
       {std::pair{"drop", "plain struts have no guide sleeves"},
        std::pair{"drop_rx", "plain struts have no guide sleeves"},
        std::pair{"stroke", "is what pistons have left, and plain struts have none"}}) {
    const auto refused = with({"--want", std::string(output) + " <= 1"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr(why), HasSubstr("outputs of this machine are status")));
  }
  EXPECT_THAT(with({"--buckling"}).err,
              HasSubstr("--buckling: error: buckling is of flexible legs"));
  const auto rigid = run({"sweep", "screws.toml", "--model", "rigid", "--over",
                          "platform.mass=1300:1400:3 kg", "--want", "drop <= 2 %"});
  EXPECT_EQ(rigid.exit_code, 2);
  EXPECT_THAT(rigid.err, HasSubstr("expected --model guide or full"));
}

TEST_F(OtherLegs, ModesOfStrutsAtAmplitudesHaveNoSleevesAndPistons) {
  const auto result = run({"modes", "struts.toml", "--amplitude", "1 mm"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("strut mm"));
  for (const char* absent : {"leeve", "iston", "rods on guide", "elastomer", "`friction"})
    EXPECT_THAT(result.out, Not(HasSubstr(absent)));
  const auto rigid = run({"modes", "screws.toml", "--amplitude", "1 mm", "--model", "rigid"});
  EXPECT_THAT(rigid.out, AllOf(HasSubstr("piston mm"), Not(HasSubstr("sleeve mm"))));
}

TEST_F(OtherLegs, OtherCommandsOfMechanicsWorkWithStruts) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"bode", "struts.toml"},
           {"sensitivity", "struts.toml"},
           {"sweep", "struts.toml", "--over", "legs.strut.stiffness=10:20:5 kN/mm"},
           {"montecarlo", "struts.toml", "--vary", "legs.strut.stiffness=normal ± 5 %", "--samples",
            "20"},
           {"export", "struts.toml", "--to", "mjcf", "-o", "struts.xml"},
           {"simulate", "struts.toml", "--actuators", "springs", "--initial", "z=2 mm", "--until",
            "0.2", "-o", "run.csv"}}) {
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments[0] << ": " << result.err;
  }
  const auto nastran = run({"export", "struts.toml", "--to", "dmig", "-o", "struts.pch"});
  EXPECT_EQ(nastran.exit_code, 0) << nastran.err;
  EXPECT_THAT(nastran.out, AllOf(HasSubstr("struts"), Not(HasSubstr("oil"))));
  EXPECT_THAT(test::read_text(folder_ / "struts.pch"), Not(HasSubstr("oil")));
}

TEST_F(OtherLegs, WhatNeedsHydraulicsIsRefused) {
  constexpr auto refusal =
      "legs.strut: error: has no valves, oil and supply, and this needs hydraulics; expected what "
      "is of mechanics alone (in simulations --actuators springs), or hydraulic cylinders "
      "(legs.oil_spring)\n";
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"modes", "struts.toml", "--system"},
           {"modes", "struts.toml", "--open-loop"},
           {"simulate", "struts.toml", "--command", "step z=2 mm"},
           {"simulate", "struts.toml", "--show-controller"}}) {
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments[2];
    EXPECT_EQ(result.err, refusal) << arguments[2];
  }
  const auto flexible = run({"modes", "struts.toml", "--model", "guide"});
  EXPECT_EQ(flexible.exit_code, 2);
  EXPECT_EQ(flexible.err,
            "--model guide: error: plain struts have neither guide sleeves nor piston rings; "
            "expected --model rigid, which is taken where none is asked for\n");
  EXPECT_THAT(run({"export", "struts.toml", "--to", "sdf", "-o", "struts.sdf"}).err,
              HasSubstr("legs.strut: error: has no mass, and links of SDF and URDF need one"));
}

TEST_F(OtherLegs, CheckOfScrewsStatesTorqueForceAndSpeed) {
  const auto result = run({"check", "screws.toml"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("torque at rest (limit) N m"));
  EXPECT_THAT(result.out, HasSubstr("(37)"));
  EXPECT_THAT(result.out, HasSubstr("565.5"));  // 2900 rpm · 11.7 mm
  EXPECT_THAT(result.out, HasSubstr("T torque of a motor"));
  EXPECT_THAT(result.out, Not(HasSubstr("oil")));
  const auto weak = run({"check", "screws.toml", "--set", "legs.screw.torque_limit=3 N m"});
  EXPECT_EQ(weak.exit_code, 1);
  EXPECT_THAT(weak.out, HasSubstr("the motors cannot move the load"));
}

TEST_F(OtherLegs, CapabilityOfScrewsHasAPictureThatOfStrutsHasNone) {
  const auto drawn = run({"check", "screws.toml", "--plot", "screws.svg"});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  const std::string picture = test::read_text(folder_ / "screws.svg");
  for (const char* word : {"torque of a motor", "speed of a motor", "no limit"})
    EXPECT_THAT(picture, HasSubstr(word));
  for (const char* word : {"oil", "valve", "inf", "nan"})
    EXPECT_THAT(picture, Not(HasSubstr(word)));
  const auto struts = run({"check", "struts.toml", "--plot", "struts.svg"});
  EXPECT_EQ(struts.exit_code, 2);
  EXPECT_EQ(struts.err,
            "--plot struts.svg: error: shows what cylinders can do, and the legs are struts; "
            "expected no legs.strut, or the table without --plot\n");
}

TEST_F(OtherLegs, ModesOfScrewsAreOfHeldOrOfFreeMotors) {
  const auto held = run({"modes", "screws.toml"});
  EXPECT_EQ(held.exit_code, 0) << held.err;
  EXPECT_THAT(held.out, HasSubstr("the legs are electric cylinders: mechanics with locked motors"));
  EXPECT_THAT(held.out, HasSubstr("screws of"));
  EXPECT_THAT(held.out, Not(HasSubstr("includes")));
  const auto soft = run({"modes", "screws.toml", "--set", "legs.gimbal_stiffness=300 N/um"});
  EXPECT_THAT(soft.out, HasSubstr("\nelastic energy of screws includes that of gimbals in series "
                                  "(legs.gimbal_stiffness)\n"));
  const auto free = run({"modes", "screws.toml", "--open-loop"});
  EXPECT_EQ(free.exit_code, 0) << free.err;
  EXPECT_THAT(free.out, HasSubstr("with free motors"));
  EXPECT_THAT(free.out, HasSubstr("motors"));
  EXPECT_THAT(free.out, Not(HasSubstr("held at")));
  EXPECT_THAT(free.out, Not(HasSubstr("locked motors")));
  const auto closed = run({"modes", "screws.toml", "--system"});
  EXPECT_EQ(closed.exit_code, 0) << closed.err;
  EXPECT_THAT(closed.out, HasSubstr("with electric drives and controller"));
  EXPECT_THAT(closed.out, HasSubstr("motors by friction and speed loops"));
  EXPECT_THAT(closed.out, HasSubstr("stable: "));
  EXPECT_THAT(closed.out, AllOf(HasSubstr("the legs are electric cylinders\n"),
                                Not(HasSubstr("locked motors"))));
}

/// What the linear model leaves out is named where nothing explains the measurement.
TEST_F(OtherLegs, FrictionOfMotorsIsNamedWhereNothingExplainsARecord) {
  const auto modes = nlohmann::json::parse(
      run({"modes", "screws.toml", "--model", "rigid", "--format", "json"}).out);
  std::string list = "frequency [Hz],direction\n";
  for (std::size_t k = 0; k < 6; ++k)
    list += fmt::format("{},{}\n", 3.3 * modes["modes"][k]["frequency_hz"].get<double>(),
                        spatial::direction_name(static_cast<int>(k)));
  test::write_text(folder_ / "list.csv", list);
  const auto plant =
      run({"diagnose", "screws.toml", "--measured", "list.csv", "--against", "plant"});
  EXPECT_THAT(plant.out, HasSubstr("do not match"));
  EXPECT_THAT(plant.err, HasSubstr("list.csv: warning: legs.screw.friction_torque acts in the "
                                   "record, and the linear model that it is compared with"));
  const auto mechanics = run({"diagnose", "screws.toml", "--measured", "list.csv"});
  EXPECT_THAT(mechanics.out, HasSubstr("do not match"));
  EXPECT_THAT(mechanics.err, Not(HasSubstr("friction")));
}

/// Seals without dampers, on a machine so symmetric that nothing else damps them either: whether
/// rounding leaves them a real part above or below zero says nothing.
TEST_F(OtherLegs, SealsThatNothingDampsAreNotUnstable) {
  const auto result =
      run({"modes", "screws.toml", "--system", "--pose", "up", "--set",
           "platform.mass_center=[0, 0, 0]", "--set", "platform.inertia={xx=430, yy=430, zz=700}"});
  EXPECT_THAT(result.out,
              HasSubstr("\nstable: nothing grows, and nothing damps the oscillation at "));
}

TEST_F(OtherLegs, ScrewsAreSimulatedWithTheirDrives) {
  const auto step = run(
      {"simulate", "screws.toml", "--command", "step z=2 mm", "--until", "0.8", "-o", "step.csv"});
  EXPECT_EQ(step.exit_code, 0) << step.err;
  EXPECT_THAT(step.out, HasSubstr("peak torque N m"));
  EXPECT_THAT(step.out, HasSubstr("no feedback"));
  EXPECT_THAT(step.out, Not(HasSubstr("locked motors")));
  EXPECT_THAT(step.out, HasSubstr("motors by friction and speed loops"));
  const auto record = test::read_text(folder_ / "step.csv");
  for (const char* channel : {"leg1.nut", "leg3.motor_speed", "leg6.torque", "leg2.screw_force"})
    EXPECT_THAT(record, HasSubstr(channel));
  EXPECT_THAT(record, Not(HasSubstr("p_cap")));
  const auto json = nlohmann::json::parse(
      run({"simulate", "screws.toml", "--until", "0.1", "--format", "json"}).out);
  EXPECT_EQ(json["trace"]["torque_N_m"].size(), 6u);
  EXPECT_TRUE(json["trace"]["cap_pressure_Pa"][0].empty());
  EXPECT_GT(json["legs"][0]["peak_torque_N_m"].get<double>(), 0.0);
  const auto held = run({"simulate", "screws.toml", "--actuators", "held", "--wrench", "step z=500",
                         "--until", "0.2"});
  EXPECT_EQ(held.exit_code, 0) << held.err;
  EXPECT_THAT(held.out, HasSubstr("motors held at the speed 0, no controller"));
  const auto controller = run({"simulate", "screws.toml", "--show-controller"});
  EXPECT_EQ(controller.exit_code, 0) << controller.err;
  EXPECT_THAT(controller.out, HasSubstr("0.05 of "));
  EXPECT_THAT(controller.out, HasSubstr("the lowest mode of the platform with locked motors"));
  EXPECT_THAT(controller.out, HasSubstr("speed loop of leg 1"));
  EXPECT_EQ(run({"bode", "screws.toml", "--input", "command"}).exit_code, 0);
}

TEST_F(OtherLegs, ScrewsAreExcitedOnTheRig) {
  const auto rig = run({"rig", "screws.toml", "--duration", "1", "--settling", "0.2", "-o",
                        "run.csv", "--torque-sensor", "noise=0.1 N m"});
  EXPECT_EQ(rig.exit_code, 0) << rig.err;
  const auto record = test::read_text(folder_ / "run.csv");
  for (const char* channel : {"motor 1 drive", "motor 4 torque", "motor 6 speed", "leg 2 length"})
    EXPECT_THAT(record, HasSubstr(channel));
  EXPECT_THAT(record, Not(HasSubstr("valve")));
  EXPECT_EQ(run({"rig", "screws.toml", "--pressure-sensor", "noise=1 kPa", "--check"}).err,
            "--pressure-sensor: error: electric cylinders have no oil; expected --torque-sensor or "
            "--speed-sensor\n");
  const auto fast =
      run({"rig", "screws.toml", "--excite", "sine z=20 mm, frequency=12", "--check"});
  EXPECT_THAT(fast.err, HasSubstr("and the motor gives 0.56"));
  EXPECT_THAT(fast.err, HasSubstr("for rotor and platform, and its limit leaves"));
}

TEST_F(OtherLegs, DrivesArePartOfStateSpaces) {
  for (const char* system : {"plant", "loop"})
    for (const char* format : {"mat", "npz", "json", "hdf5"}) {
      const auto result = run({"export", "screws.toml", "--to", format, "--system", system, "-o",
                               std::string("drives.") + format, "--force"});
      EXPECT_EQ(result.exit_code, 0) << format << ": " << result.err;
      EXPECT_THAT(result.out, HasSubstr("friction of the motors"));
      EXPECT_THAT(result.out, Not(HasSubstr("valves")));
    }
  EXPECT_EQ(run({"export", "screws.toml", "--to", "json", "--system", "loop", "--outputs",
                 "leg1.torque,z", "--reduce", "40", "-o", "drives.json"})
                .exit_code,
            0);
  const auto json = nlohmann::json::parse(test::read_text(folder_ / "drives.json"));
  EXPECT_EQ(json["inputs"][12]["name"], "leg1.drive");
  EXPECT_EQ(json["outputs"][0]["unit"], "N m");
  EXPECT_GT(std::abs(json["outputs"][0]["rest"].get<double>()), 0.1);
}

TEST_F(OtherLegs, DrivesAreServed) {
  const auto served = run({"serve", "screws.toml", "--udp", "0", "--duration", "0.1"});
  EXPECT_EQ(served.exit_code, 0) << served.err;
  const auto packets = run({"serve", "screws.toml", "--print-layout"}).out;
  for (const char* name : {"torque", "motor_speed", "nut"})
    EXPECT_THAT(packets, HasSubstr(fmt::format("{{ name = \"{}\"", name)));
  EXPECT_THAT(packets, Not(HasSubstr("cap_pressure")));
  EXPECT_THAT(run({"serve", "struts.toml", "--udp", "0", "--duration", "0.1"}).err,
              HasSubstr("legs.strut: error: has no valves"));
}

TEST_F(OtherLegs, DrivesNeedLimits) {
  test::write_text(folder_ / "endless.toml",
                   std::regex_replace(test::screw_file, std::regex("torque_limit[^\n]*\n"), ""));
  constexpr auto missing =
      "legs.screw.torque_limit: error: is missing, and a drive is simulated up to the largest "
      "torque of its motor; expected this key, or locked motors (--actuators springs) or free "
      "motors "
      "(modes --open-loop)\n";
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"simulate", "endless.toml", "--command", "step z=2 mm"},
           {"rig", "endless.toml", "--check"},
           {"modes", "endless.toml", "--system"}}) {
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments[0];
    EXPECT_EQ(result.err, missing) << arguments[0];
  }
  EXPECT_EQ(run({"modes", "endless.toml", "--open-loop"}).exit_code, 0);
}

/// A controlled machine was recorded; neither of these can be controlled.
TEST_F(OtherLegs, IdentifiedModesAreKeptWhereTheMachineCannotBeCompared) {
  const auto rig = run({"rig", "screws.toml", "--duration", "20", "-o", "run.h5"});
  ASSERT_EQ(rig.exit_code, 0) << rig.err;
  const auto endless = std::regex_replace(test::screw_file, std::regex("torque_limit.*\n"), "");
  test::write_text(folder_ / "endless.toml", endless);
  for (const auto& [file, lacks] :
       {std::pair{"struts.toml", "legs.strut has no valves, oil and supply"},
        std::pair{"endless.toml", "legs.screw.torque_limit is missing"}}) {
    const auto result = run({"identify", "run.h5", "--machine", file, "--format", "json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr(fmt::format("{}: warning: not compared with the model: {}",
                                                  file, lacks)));
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_FALSE(json["modes"].empty());
    EXPECT_TRUE(json.value("comparison", nlohmann::json()).is_null());
  }
}

}  // namespace
}  // namespace hydrapod
