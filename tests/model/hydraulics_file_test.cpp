/// Servo-hydraulics in the machine file: every key, its unit, and what is refused.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"

namespace hydrapod::model {
namespace {

Machine with(const std::vector<std::string>& overrides) {
  return parse_machine(sound_machine_file, "m.toml", overrides).machine;
}

TEST(HydraulicsFile, WithoutItsTablesEverythingHasItsDefault) {
  const Machine machine = with({});
  const auto& leg = machine.legs[2].hydraulics;
  EXPECT_FALSE(leg.valve.rated_flow);
  EXPECT_FALSE(leg.leakage.internal);
  EXPECT_FALSE(leg.friction.bristles);
  EXPECT_EQ(leg.valve.natural_frequency, 600.0);
  EXPECT_FALSE(machine.hydraulics.supply.pump_flow);
  EXPECT_EQ(machine.hydraulics.supply.pressure, 14e6);
}

TEST(HydraulicsFile, TheLegsTablesAreReadInTheirUnits) {
  const Machine machine =
      with({"legs.valve={ rated_flow = \"60 l/min\", rated_pressure_drop = \"70 bar\", overlap = "
            "\"2 %\", laminar_pressure = \"3 bar\", natural_frequency = 900, damping_ratio = 0.7, "
            "rate_limit = 80, leakage = \"0.6 l/min\" }",
            "legs.leakage={ internal = 2e-13, external = 3e-14 }",
            "legs.friction={ coulomb = \"90 N\", breakaway = \"120 N\", stribeck_velocity = "
            "\"15 mm/s\", smoothing_velocity = \"1 mm/s\", viscous = 800, bristles = { stiffness = "
            "\"40 kN/mm\", damping = 5e3 } }",
            "legs.joint_friction={ viscous = 2, coulomb = 3, smoothing_rate = 0.02 }",
            "legs.end_stops={ stiffness = 1e8, damping = 0.25 }",
            "legs.equivalent_cylinder={ area_ratio = 0.6, area = \"7 cm^2\", bulk_modulus = "
            "\"0.9 GPa\" }",
            "leg.4.valve.overlap=-1 %"});
  const auto& leg = machine.legs[0].hydraulics;
  EXPECT_DOUBLE_EQ(leg.valve.rated_flow.value(), 1e-3);
  EXPECT_DOUBLE_EQ(leg.valve.rated_pressure_drop, 7e6);
  EXPECT_DOUBLE_EQ(leg.valve.overlap, 0.02);
  EXPECT_DOUBLE_EQ(leg.valve.laminar_pressure, 3e5);
  EXPECT_EQ(leg.valve.natural_frequency, 900.0);
  EXPECT_EQ(leg.valve.damping_ratio, 0.7);
  EXPECT_EQ(leg.valve.rate_limit, 80.0);
  EXPECT_DOUBLE_EQ(leg.valve.leakage.value(), 1e-5);
  EXPECT_EQ(leg.leakage.internal, 2e-13);
  EXPECT_EQ(leg.leakage.external, 3e-14);
  EXPECT_EQ(leg.friction.coulomb, 90.0);
  EXPECT_EQ(leg.friction.breakaway, 120.0);
  EXPECT_DOUBLE_EQ(leg.friction.stribeck_velocity, 0.015);
  EXPECT_DOUBLE_EQ(leg.friction.smoothing_velocity, 0.001);
  EXPECT_EQ(leg.friction.viscous, 800.0);
  EXPECT_DOUBLE_EQ(leg.friction.bristles.value().stiffness, 4e7);
  EXPECT_EQ(leg.friction.bristles.value().damping, 5e3);
  EXPECT_EQ(leg.joint_friction.viscous, 2.0);
  EXPECT_EQ(leg.joint_friction.coulomb, 3.0);
  EXPECT_EQ(leg.joint_friction.smoothing_rate, 0.02);
  EXPECT_EQ(leg.joint_friction.bristle_damping, 0.0);
  EXPECT_EQ(leg.end_stops.stiffness, 1e8);
  EXPECT_EQ(leg.end_stops.damping, 0.25);
  EXPECT_EQ(leg.equivalent_cylinder.area_ratio, 0.6);
  EXPECT_DOUBLE_EQ(leg.equivalent_cylinder.area.value(), 7e-4);
  EXPECT_DOUBLE_EQ(leg.equivalent_cylinder.bulk_modulus, 9e8);
  EXPECT_DOUBLE_EQ(machine.legs[3].hydraulics.valve.overlap, -0.01);
  EXPECT_EQ(machine.legs[3].hydraulics.valve.natural_frequency, 900.0);
}

TEST(HydraulicsFile, TheSupplyIsReadInItsUnits) {
  const auto hydraulics =
      with({"supply={ pressure = \"210 bar\", return_pressure = \"3 bar\", pump_flow = \"120 "
            "l/min\", line_volume = \"2 l\", cavitation_pressure = \"0.2 bar\", accumulator = { "
            "gas_volume = \"10 l\", precharge = \"150 bar\", polytropic = 1.3 } }"})
          .hydraulics;
  const auto& supply = hydraulics.supply;
  EXPECT_DOUBLE_EQ(supply.pressure, 21e6);
  EXPECT_DOUBLE_EQ(supply.return_pressure, 3e5);
  EXPECT_DOUBLE_EQ(supply.pump_flow.value(), 2e-3);
  EXPECT_DOUBLE_EQ(supply.line_volume, 2e-3);
  EXPECT_DOUBLE_EQ(hydraulics.cavitation_pressure, 2e4);
  EXPECT_DOUBLE_EQ(supply.accumulator.value().gas_volume, 1e-2);
  EXPECT_DOUBLE_EQ(supply.accumulator.value().precharge, 15e6);
  EXPECT_EQ(supply.accumulator.value().polytropic, 1.3);
}

TEST(HydraulicsFile, LinesHaveSegments) {
  const std::vector<std::string> line{"legs.oil_spring.cylinder.rod_line_volume=1.1 l",
                                      "leg.5.oil_spring.cylinder.rod_line_length=3.7 m"};
  const auto lines_with = [&line](std::vector<std::string> more) {
    more.insert(more.end(), line.begin(), line.end());
    return with(more).hydraulics.lines;
  };
  EXPECT_EQ(with({}).hydraulics.lines.segments, 0.0);
  const auto lines = lines_with({"lines={ segments = 3, viscosity = \"31 mPa s\" }"});
  EXPECT_EQ(lines.segments, 3.0);
  EXPECT_DOUBLE_EQ(lines.viscosity, 0.031);
  const auto message_of = [&](const std::vector<std::string>& more) -> std::string {
    try {
      lines_with(more);
    } catch (const base::InputError& error) {
      return error.diagnostics()[0].message;
    }
    return "accepted";
  };
  EXPECT_EQ(message_of({"lines.segments=2.5"}), "is 2.5, expected a whole number up to 8");
  EXPECT_EQ(lines_with({"lines.modes=5"}).modes, 5.0);
  EXPECT_EQ(message_of({"lines.modes=1.5"}), "is 1.5, expected a whole number up to 8");
  EXPECT_EQ(message_of({"lines.modes=3", "lines.segments=3"}),
            "stands beside `lines.segments`: a line has modes or segments, expected one of them");
  EXPECT_EQ(message_of({"lines.segments=2", "legs.oil_spring.cylinder.volumes=equal",
                        "legs.oil_spring.cylinder.control_volume=2 l"}),
            "takes lines out of the chambers that hold them, expected "
            "`legs.oil_spring.cylinder.volumes` = \"chambers\"");
}

struct Refused {
  std::string override_text{}, message{};
};

class RefusedHydraulics : public testing::TestWithParam<Refused> {};

TEST_P(RefusedHydraulics, GetItsMessage) {
  try {
    with({GetParam().override_text});
    ADD_FAILURE() << "accepted";
  } catch (const base::InputError& error) {
    ASSERT_EQ(error.diagnostics().size(), 1u) << error.what();
    EXPECT_EQ(error.diagnostics()[0].key + ": " + error.diagnostics()[0].message,
              GetParam().message);
  }
}

INSTANTIATE_TEST_SUITE_P(
    , RefusedHydraulics,
    testing::Values(
        Refused{"legs.valve.overlap=0.6",
                "legs.valve.overlap: is 0.6 of the travel, expected -0.5 (underlap) to 0.5 "
                "(overlap)"},
        Refused{"legs.valve={ rated_flow = 1e-3, leakage = 6e-4 }",
                "legs.valve.leakage: is 0.0006 m^3/s, expected no more than half the rated flow, "
                "0.0005 m^3/s"},
        Refused{"legs.valve.natural_frequency=100 Hz",
                "legs.valve.natural_frequency: \"100 Hz\" has the unit \"Hz\" (a frequency), "
                "expected an angular speed such as \"rad/s\""},
        Refused{"legs.friction.breakaway=9",
                "legs.friction.breakaway: is given alone, expected `coulomb` too"},
        Refused{"leg.2.friction={ coulomb = 9, breakaway = 8 }",
                "leg.2.friction.breakaway: is 8 N, expected no less than `coulomb`, 9 N"},
        Refused{"legs.friction={ bristles = { stiffness = 1e7 } }",
                "legs.friction.bristles: have no effect without `coulomb`"},
        Refused{"legs.friction={ coulomb = 0, bristles = { stiffness = 1e7 } }",
                "legs.friction.bristles: have no effect with `coulomb` = 0 N, expected more"},
        Refused{"legs.leakage.internal=-1",
                "legs.leakage.internal: is -1 m^3/(s Pa), expected 0 or more"},
        Refused{"legs.equivalent_cylinder.area_ratio=1.5",
                "legs.equivalent_cylinder.area_ratio: is 1.5, expected no more than 1"},
        Refused{"supply.return_pressure=150 bar",
                "supply.return_pressure: is 1.5e+07 Pa, expected less than the supply pressure, "
                "1.4e+07 Pa"},
        Refused{"supply.cavitation_pressure=6 bar",
                "supply.cavitation_pressure: is 600000 Pa, expected less than the return pressure, "
                "500000 Pa"},
        Refused{"supply.accumulator={ gas_volume = 0.01, precharge = 9e6 }",
                "supply.accumulator: has no effect: without a `pump_flow` the supply pressure is "
                "constant, expected `pump_flow` too"},
        Refused{"lines.segments=9",
                "lines.segments: is 9, expected 0 (dead ends) or a whole number of segments up to "
                "8"},
        Refused{"lines.viscosity=-0.01", "lines.viscosity: is -0.01 Pa s, expected 0 or more"},
        Refused{"lines.segments=3",
                "lines.segments: has no effect: no line has a length, expected "
                "`legs.oil_spring.cylinder.cap_line_length` or `rod_line_length`"},
        Refused{"lines.modes=3",
                "lines.modes: has no effect: no line has a length, expected "
                "`legs.oil_spring.cylinder.cap_line_length` or `rod_line_length`"},
        Refused{"supply.pressur=1e7", "supply.pressur: unknown key; did you mean `pressure`?"}));

TEST(HydraulicsFile, AnEquivalentCylinderMustHoldItsStroke) {
  try {
    with({"legs.oil_spring.stiffness=20 kN/mm", "legs.equivalent_cylinder.area=1 cm^2"});
    ADD_FAILURE() << "accepted";
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message,
              "is 0.0001 m^2: with the stiffness of the oil spring its chambers would be shorter "
              "than the stroke, expected more than 0.0048 m^2");
  }
}

}  // namespace
}  // namespace hydrapod::model
