/// Modes of the payload in machine files and as numbers of a machine.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"

namespace hydrapod::model {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string cabin = R"(
[payload_modes.cabin]
frequency = "11 Hz"
damping_ratio = "3 %"
mass = "120 kg"
position = [0, "10 mm", "1.3 m"]
direction = [0, 3, 4]

[payload_modes."front frame"]
frequency = 24
participation = [3.1, 0, -1.7]
participation_moment = [0.2, 4.1, 0]
)";

MachineFile file_with(const std::string& more, const std::vector<std::string>& overrides = {}) {
  return parse_machine(std::string(sound_machine_file) + more, "m.toml", overrides);
}

std::string refusal(const std::string& more, const std::vector<std::string>& overrides = {}) {
  try {
    file_with(more, overrides);
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PayloadModes, AreReadInTheOrderOfTheFile) {
  const auto machine = file_with(cabin).machine;
  ASSERT_EQ(machine.payload_modes.size(), 2U);
  const auto& first = machine.payload_modes[0];
  EXPECT_EQ(first.name, "cabin");
  EXPECT_DOUBLE_EQ(first.frequency, 11.0);
  EXPECT_DOUBLE_EQ(first.damping_ratio, 0.03);
  EXPECT_DOUBLE_EQ(first.mass.value(), 120.0);
  EXPECT_FALSE(first.participation);
  EXPECT_DOUBLE_EQ(first.position.y(), 0.01);
  const auto& second = machine.payload_modes[1];
  EXPECT_EQ(second.name, "front frame");
  EXPECT_FALSE(second.mass);
  EXPECT_DOUBLE_EQ(second.participation.value().z(), -1.7);
}

/// √m (d; r × d) about the origin; about p the lever is from there.
TEST(PayloadModes, TakePartWithMassAndLever) {
  const auto machine = file_with(cabin).machine;
  const Vector3 d(0.0, 0.6, 0.8), r(0.0, 0.01, 1.3), p(0.3, -0.2, 0.1);
  const auto L = participation(machine.payload_modes[0], p);
  EXPECT_LT((L.head<3>() - std::sqrt(120.0) * d).norm(), 1e-12);
  EXPECT_LT((L.tail<3>() - std::sqrt(120.0) * (r - p).cross(d)).norm(), 1e-12);
}

TEST(PayloadModes, AreNumbersWithPaths) {
  auto file = file_with(cabin);
  auto& machine = file.machine;
  const auto frequency = find_parameter(machine, "payload_modes.cabin.frequency");
  ASSERT_TRUE(frequency);
  EXPECT_EQ(path(machine, *frequency), "payload_modes.cabin.frequency");
  EXPECT_EQ(unit(machine, *frequency), "Hz");
  EXPECT_TRUE(of_mechanics(machine, *frequency));
  const auto moment = find_parameter(machine, "payload_modes.\"front frame\".participation[2]");
  ASSERT_TRUE(moment);
  EXPECT_DOUBLE_EQ(value(machine, *moment).value(), -1.7);
  EXPECT_EQ(path(machine, *moment), "payload_modes.\"front frame\".participation[2]");
  EXPECT_FALSE(value(machine, *find_parameter(machine, "payload_modes.cabin.participation[2]")));
  assign(machine, std::array{Assignment{*frequency, 77.0}});
  EXPECT_DOUBLE_EQ(machine.payload_modes[0].frequency, 77.0);
  EXPECT_FALSE(find_parameter(machine, "payload_modes.roof.frequency"));
}

/// assign() makes modes that a machine lacks, under their next names.
TEST(PayloadModes, AreMadeByAssignment) {
  Machine machine = file_with("").machine;
  const auto mass = find_parameter(machine, "payload_modes.mode_2.mass");
  ASSERT_TRUE(mass);
  EXPECT_FALSE(value(machine, *mass));
  EXPECT_EQ(path(machine, *mass), "payload_modes.mode_2.mass");
  assign(machine, std::array{Assignment{*mass, 12.5}});
  ASSERT_EQ(machine.payload_modes.size(), 2U);
  EXPECT_EQ(machine.payload_modes[1].name, "mode_2");
  EXPECT_DOUBLE_EQ(machine.payload_modes[1].mass.value(), 12.5);
  EXPECT_FALSE(find_parameter(machine, "payload_modes.mode_7.mass"));
}

TEST(PayloadModes, AreChangedByOverrides) {
  const auto machine = file_with(cabin, {"payload_modes.cabin.frequency=9 Hz",
                                         "payload_modes.lamp={frequency=60, mass=2}"})
                           .machine;
  ASSERT_EQ(machine.payload_modes.size(), 3U);
  EXPECT_DOUBLE_EQ(machine.payload_modes[0].frequency, 9.0);
  EXPECT_EQ(machine.payload_modes[2].name, "lamp");
}

TEST(PayloadModes, ThatCannotBeAreRefusedWithTheirPlace) {
  EXPECT_THAT(refusal("[payload_modes.cabin]\nmass = 3\n"),
              AllOf(HasSubstr("m.toml:"), HasSubstr("frequency")));
  EXPECT_THAT(refusal("[payload_modes.cabin]\nfrequency = 70\n"),
              HasSubstr("has neither `mass` nor `participation`"));
  EXPECT_THAT(
      refusal("[payload_modes.cabin]\nfrequency = 70\nmass = 3\nparticipation = [1, 0, 0]\n"),
      HasSubstr("has both `mass` and `participation`"));
  EXPECT_THAT(refusal("[payload_modes.cabin]\nfrequency = -70\nmass = 3\n"),
              AllOf(HasSubstr("payload_modes.cabin.frequency"), HasSubstr("more than 0")));
  EXPECT_THAT(refusal("[payload_modes.cabin]\nfrequency = 70\nmass = 3\ndirection = [0, 0, 0]\n"),
              HasSubstr("vector of length 0"));
  EXPECT_THAT(refusal("[payload_modes.cabin]\nfrequenzy = 70\nmass = 3\n"),
              HasSubstr("did you mean `frequency`?"));
  EXPECT_THAT(refusal("[payload_modes.cabin]\nfrequency = 70\nmass = 3e5\n"),
              AllOf(HasSubstr("times the inertia of the platform"), HasSubstr("mainly x")));
  EXPECT_THAT(refusal("payload_modes = 3\n"), HasSubstr("payload_modes"));
  std::string seven;
  for (int k = 1; k <= 7; ++k)
    seven += "[payload_modes.m" + std::to_string(k) + "]\nfrequency = 70\nmass = 0.1\n";
  EXPECT_THAT(refusal(seven), HasSubstr("holds 7 modes, expected no more than 6"));
}

TEST(PayloadModes, LeaveTheRestOfThePlatform) {
  const auto machine = file_with(cabin).machine;
  const auto rest = mass_without_payload_modes(machine);
  EXPECT_NEAR(rest(1, 1), machine.platform.mass - 0.36 * 120.0, 1e-9);
  EXPECT_NEAR(rest(0, 0), machine.platform.mass - 3.1 * 3.1, 1e-9);
}

}  // namespace
}  // namespace hydrapod::model
