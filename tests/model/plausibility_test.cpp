/// Numbers that a machine may have and that none is known to have.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/parameters.hpp"
#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::IsEmpty;
using testing::StartsWith;

std::vector<std::string> unusual(const Machine& machine) {
  std::vector<std::string> texts;
  for (const auto& finding : unusual_numbers(machine).findings) {
    EXPECT_EQ(finding.severity, base::Severity::warning);
    EXPECT_TRUE(finding.unusual);
    texts.push_back(finding.key + ": " + finding.message);
  }
  return texts;
}

Machine heavy() {
  return read_machine_file(test::source_file("models/heavy-platform.toml").string()).machine;
}

TEST(UnusualNumbers, OurMachinesHaveNone) {
  for (const char* name : {"heavy-platform", "zhang-jiang-2021", "zhang-jiang-2021-transverse"})
    EXPECT_THAT(
        unusual(
            read_machine_file(test::source_file("models").string() + "/" + name + ".toml").machine),
        IsEmpty())
        << name;
}

struct Slip {
  std::string path;
  double value;
  std::string says;  ///< after the path
};

class Slips : public testing::TestWithParam<Slip> {};

TEST_P(Slips, AreOneMessageWithAGuess) {
  const Slip& slip = GetParam();
  auto machine = heavy();
  machine.hydraulics.supply.pressure = 81e5;
  const auto id = find_parameter(machine, slip.path);
  ASSERT_TRUE(id) << slip.path;
  const std::vector<Assignment> one{{*id, slip.value}};
  assign(machine, one);
  EXPECT_THAT(unusual(machine), ElementsAre(slip.path + ": " + slip.says));
}

INSTANTIATE_TEST_SUITE_P(
    All, Slips,
    testing::Values(
        Slip{"legs.case.mass_center", 1050.0,
             "is 1050 m, usual are 0.001 m to 20 m; did you mean 1050 mm?"},
        Slip{"legs.oil_spring.cylinder.bore", 110.0,
             "is 110 m, usual are 0.004 m to 1.5 m; did you mean 110 mm?"},
        Slip{"legs.oil_spring.cylinder.bore", 11.0,
             "is 11 m, usual are 0.004 m to 1.5 m; did you mean 11 mm?"},
        Slip{"legs.oil_spring.cylinder.cap_dead_volume", 310.0,
             "is 310 m^3, usual are up to 10 m^3; did you mean 310 l?"},
        Slip{"legs.oil_spring.cylinder.bulk_modulus", 1.43,
             "is 1.43 Pa, usual are 1e+07 Pa to 1e+10 Pa; did you mean 1.43 GPa?"},
        Slip{"legs.oil_spring.cylinder.bulk_modulus", 1400.0,
             "is 1400 Pa, usual are 1e+07 Pa to 1e+10 Pa; did you mean 1400 MPa?"},
        Slip{"legs.rod.yield_strength", 355.0,
             "is 355 Pa, usual are 1e+07 Pa to 5e+09 Pa; did you mean 355 MPa?"},
        Slip{"legs.rod.youngs_modulus", 210.0,
             "is 210 Pa, usual are 1e+09 Pa to 1e+12 Pa; did you mean 210 GPa?"},
        Slip{"legs.guide_sleeve.stiffness", 1e14,
             "is 1e+14 N/m, usual are 100 N/m to 1e+13 N/m; did you mean \"rigid\"?"},
        Slip{"legs.guide_sleeve.stiffness", 0.84,
             "is 0.84 N/m, usual are 100 N/m to 1e+13 N/m; did you mean 0.84 N/mm?"},
        Slip{"legs.rod.mass", 23.7e3,
             "is 23700 kg, usual are 0.05 kg to 20000 kg, 23.7 t here; did you mean 23.7 kg?"},
        Slip{"leg.3.rod.length", 1150.0,
             "is 1150 m, usual are 0.02 m to 20 m; did you mean 1150 mm?"},
        Slip{"platform.mass", 14.3,
             "is 14.3 kg, less than a twentieth of the legs' 348 kg; did you mean 14.3 t?"},
        Slip{"platform.mass_center[2]", -150.0,
             "is -150 m, usual are 0.0001 m to 20 m; did you mean -150 mm?"},
        Slip{"platform.joints.circle.radius", 1450.0,
             "is 1450 m, usual are 0.001 m to 50 m; did you mean 1450 mm?"},
        Slip{"base.joints.circle.spacing", 0.36e-3,
             "is 0.00036 m, usual are 0.001 m to 50 m, 0.36 mm here; did you mean 0.36 m?"},
        Slip{"supply.pressure", 83.0,
             "is 83 Pa, usual are 100000 Pa to 1e+08 Pa; did you mean 83 bar?"},
        Slip{"poses.low.position[2]", 1300.0,
             "is 1300 m, usual are up to 50 m; did you mean 1300 mm?"},
        Slip{"environment.gravity[2]", -981.0,
             "is -981 m/s^2, usual are 0.001 m/s^2 to 100 m/s^2"}));

TEST(UnusualNumbers, OfInertiaThatDoesNotBelongToTheMass) {
  auto machine = heavy();
  machine.platform.inertia *= 1e-3;  // t m^2 typed as kg m^2: 20.9 for 14 t
  EXPECT_THAT(unusual(machine), IsEmpty()) << "a compact load: 0.05 m";
  machine.platform.inertia *= 0.1;
  EXPECT_THAT(
      unusual(machine),
      ElementsAre(AllOf(StartsWith("platform.inertia: goes with a radius of gyration of 0.01"),
                        EndsWith("; the joints are 1.45 m from the origin"))));
  machine.platform.inertia *= 1e8;
  EXPECT_THAT(unusual(machine), ElementsAre(StartsWith("platform.inertia: ")));
}

TEST(UnusualNumbers, OfSingleLegsAreToldApart) {
  auto machine = heavy();
  machine.legs[1].rod.mass_center = 560.0;
  machine.legs[4].rod.mass_center = 561.0;
  EXPECT_THAT(unusual(machine), ElementsAre(StartsWith("leg.2.rod.mass_center: is 560 m"),
                                            StartsWith("leg.5.rod.mass_center: is 561 m")));
}

TEST(UnusualNumbers, TheGuessIsTheMachineThatWasMeant) {
  const auto meant = heavy();
  auto machine = meant;
  for (auto& leg : machine.legs) leg.rod.length *= 1000.0;
  machine.legs[3].guide_sleeve.stiffness = 0.84;
  machine.platform.mass *= 1e-3;
  EXPECT_EQ(unusual(machine).size(), 3U);
  const auto guessed = unusual_numbers(machine).guessed;
  for (const auto& leg : guessed.legs) EXPECT_DOUBLE_EQ(leg.rod.length, 1.15);
  EXPECT_DOUBLE_EQ(guessed.legs[3].guide_sleeve.stiffness, 840.0);
  EXPECT_EQ(guessed.legs[2].guide_sleeve.stiffness, meant.legs[2].guide_sleeve.stiffness);
  EXPECT_DOUBLE_EQ(guessed.platform.mass, 14e3);
}

TEST(UnusualNumbers, WhatIsNotFiniteIsForValidationToSay) {
  auto machine = heavy();
  machine.platform.mass = std::numeric_limits<double>::quiet_NaN();
  machine.legs[0].rod.length = std::numeric_limits<double>::infinity();
  EXPECT_THAT(unusual(machine), IsEmpty());
}

}  // namespace
}  // namespace hydrapod::model
