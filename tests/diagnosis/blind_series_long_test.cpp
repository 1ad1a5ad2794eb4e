/// The blind series: `build/test/tests/diagnosis_long --gtest_filter=*BlindSeries*` prints the
/// table of docs/validation/diagnosis.md.

#include "planted_faults.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace hydrapod::test {

namespace {

class BlindSeries : public testing::TestWithParam<std::size_t> {};

TEST_P(BlindSeries, FindsWhatWasPlanted) {
  int first = 0;
  std::vector<BlindCase> cases;
  for (std::size_t k = 0; k <= GetParam(); ++k) {
    first += static_cast<int>(cases.size());
    cases = cases_of(settings()[k], first);
  }
  int found = 0, innocent = 0, wrong = 0;
  std::cout << "| machine | poses | noise | planted | verdict | ranked |\n"
               "| --- | --- | --- | --- | --- | --- |\n";
  for (const auto& test : cases) {
    const auto result = run_blind(test);
    found += result.found;
    if (test.planted.empty()) {
      ++innocent;
      wrong += !result.found;
    }
    std::cout << fmt::format("| {} | {} | {:.2g} % | {} | {} | {} |\n", test.machine,
                             fmt::join(test.poses, ", "), 100.0 * test.noise, test.planted_name(),
                             verdict(result.diagnosis),
                             result.first   ? "first"
                             : result.found ? "equal"
                                            : "MISSED")
              << std::flush;
  }
  std::cout << fmt::format(
      "\n{} of {} found; a cause identified in {} of {} machines without fault\n", found,
      cases.size(), wrong, innocent);
  EXPECT_GE(found, 0.95 * static_cast<double>(cases.size()));
  EXPECT_EQ(wrong, 0);
}

INSTANTIATE_TEST_SUITE_P(Settings, BlindSeries, testing::Range<std::size_t>(0, 6));

TEST(BlindPair, IsNamed) {
  const auto result =
      run_blind({.machine = "heavy-platform.toml",
                 .design = {"legs.guide_sleeve.stiffness=20 kN/mm"},
                 .fault = {"legs.guide_sleeve.stiffness=1.1 kN/mm",
                           "legs.oil_spring.cylinder.bulk_modulus=1.0 GPa"},
                 .planted = {"guide sleeves of all legs", "bulk modulus of the oil"}});
  EXPECT_TRUE(result.found) << verdict(result.diagnosis);
}

}  // namespace

}  // namespace hydrapod::test
