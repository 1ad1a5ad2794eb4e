/// Numbers of a machine file, varied without writing text, against the file read with overrides.

#include "hydrapod/model/machine_file.hpp"

#include <gtest/gtest.h>

#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

void expect_same(const Machine& a, const Machine& b, const std::string& what) {
  for (const auto& id : parameters(a))
    EXPECT_NEAR(*value(a, id), *value(b, id), 1e-12 * (1.0 + std::abs(*value(b, id))))
        << what << ", " << path(a, id);
}

TEST(VariableMachine, VariesSeveralNumbersTogetherAndTiesThem) {
  const auto file = read_machine_file(test::source_file("models/heavy-platform.toml"));
  VariableMachine machine(file);
  machine.vary({{"platform.inertia.xx", "platform.inertia.yy"},
                {"leg.3.rod.mass"},
                {"platform.joints.circle.radius"},
                {"legs.oil_spring.cylinder.bore"}});
  EXPECT_EQ(machine.values(), (std::vector<double>{20900.0, 23.0, 1.45, 0.1}));
  const auto expected = parse_machine(
      file.text, "t",
      {"platform.inertia.xx=21234.5", "platform.inertia.yy=21234.5", "leg.3.rod.mass=24.1 kg",
       "platform.joints.circle.radius=1.47", "legs.oil_spring.cylinder.bore=0.097"});
  expect_same(machine.machine({21234.5, 24.1, 1.47, 0.097}), expected.machine, "all");
}

TEST(VariableMachine, KnowsWhatItCanVary) {
  const auto file = read_machine_file(test::source_file("models/zhang-jiang-2021.toml"));
  VariableMachine machine(file);
  EXPECT_EQ(machine.find("legs.rod.mass")->unit, "kg");
  EXPECT_EQ(machine.find("platform.mass_center[2]")->value, -0.163);
  EXPECT_FALSE(machine.find("legs.added_axial_inertia")->given);
  EXPECT_EQ(machine.find("leg.6.rod.mass")->value, 1.62);
  EXPECT_EQ(machine.find("legs.rod.mas"), nullptr);
  EXPECT_EQ(machine.nearest_path("legs.rod.mas"), "legs.rod.mass");
  EXPECT_THROW(machine.vary({{"legs.rod.mas"}}), std::invalid_argument);
  EXPECT_THROW(machine.vary({{"legs.rod.mass"}, {"legs.rod.mass"}}), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::model
