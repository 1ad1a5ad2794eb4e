/// Numbers of a machine file, varied without writing text, against the file read with overrides.

#include "hydrapod/model/variable_machine.hpp"

#include <gtest/gtest.h>

#include "model/machine_numbers.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

std::vector<double> numbers_of(Machine machine) {
  std::vector<double> numbers;
  for_each_number(machine, [&](double& number) { numbers.push_back(number); });
  return numbers;
}

void expect_same(const Machine& a, const Machine& b, const std::string& what) {
  const auto x = numbers_of(a), y = numbers_of(b);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(x[i], y[i], 1e-12 * (1.0 + std::abs(y[i]))) << what << ", number " << i;
}

/// Every number of the heavy platform's file: units, defaults, circles, rotations, single legs.
TEST(VariableMachine, IsTheFileReadWithThatValue) {
  const auto file = read_machine_file(test::source_file("models/heavy-platform.toml"));
  VariableMachine machine(file);
  test::Random random(11);
  int tried = 0;
  for (const auto& number : machine.numbers()) {
    // a shared number is varied for one leg in the test below
    const double value = number.value * random.uniform(0.93, 1.06) + (number.value == 0.0) * 0.01;
    machine.vary({{number.path}});
    if (!machine.matters(0)) continue;
    MachineFile expected;
    try {
      expected = parse_machine(file.text, "t", {fmt::format("{}={:.17g}", number.path, value)}, {});
    } catch (const base::InputError&) {
      continue;  // not a machine with this value
    }
    expect_same(machine.machine({value}), expected.machine, number.path);
    ++tried;
  }
  EXPECT_GE(tried, 60);
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
