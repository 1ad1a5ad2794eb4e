/// Numbers of a machine file, varied without writing text, against the file read with overrides.

#include "hydrapod/model/machine_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

void expect_same(const Machine& a, const Machine& b, const std::string& what) {
  for (const auto& id : parameters(a))
    EXPECT_NEAR(*value(a, id), *value(b, id), 1e-12 * (1.0 + std::abs(*value(b, id))))
        << what << ", " << path(a, id);
}

TEST(FileNumbers, AreAssignedTogetherAndTied) {
  const auto file = read_machine_file(test::source_file("models/heavy-platform.toml"));
  const std::vector<std::pair<const char*, double>> given{{"platform.inertia.xx", 20900.0},
                                                          {"leg.3.rod.mass", 23.0},
                                                          {"platform.joints.circle.radius", 1.45},
                                                          {"legs.oil_spring.cylinder.bore", 0.1}};
  for (const auto& [path, number] : given)
    EXPECT_EQ(find_number(file, path)->value, number) << path;
  std::vector<Assignment> assignments;
  for (const auto& [path, number] :
       std::vector<std::pair<const char*, double>>{{"platform.inertia.xx", 21234.5},
                                                   {"platform.inertia.yy", 21234.5},
                                                   {"leg.3.rod.mass", 24.1},
                                                   {"platform.joints.circle.radius", 1.47},
                                                   {"legs.oil_spring.cylinder.bore", 0.097}})
    assignments.push_back({find_number(file, path)->id, number});
  const auto expected = parse_machine(
      file.text, "t",
      {"platform.inertia.xx=21234.5", "platform.inertia.yy=21234.5", "leg.3.rod.mass=24.1 kg",
       "platform.joints.circle.radius=1.47", "legs.oil_spring.cylinder.bore=0.097"});
  expect_same(with(file.machine, assignments), expected.machine, "all");
}

TEST(FileNumbers, AreThoseOfTheFileDefaultsAndSingleLegs) {
  const auto file = read_machine_file(test::source_file("models/zhang-jiang-2021.toml"));
  EXPECT_EQ(find_number(file, "legs.rod.mass")->unit, "kg");
  EXPECT_EQ(find_number(file, "platform.mass_center[2]")->value, -0.163);
  const auto added = find_number(file, "legs.added_axial_inertia")->id;
  EXPECT_EQ(std::ranges::count(file.given, added, &GivenNumber::id), 0);
  EXPECT_EQ(find_number(file, "leg.6.rod.mass")->value, 1.62);
  EXPECT_FALSE(find_number(file, "legs.rod.mas"));
  EXPECT_EQ(nearest_parameter(file, "legs.rod.mas"), "legs.rod.mass");
}

}  // namespace
}  // namespace hydrapod::model
