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
  Tally tally;
  std::cout << "| machine | poses | noise | planted | size | verdict | result |\n"
               "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& test : cases) {
    const auto result = run_blind(test);
    tally.add(test, result);
    std::cout << fmt::format("| {} | {} | {:.2g} % | {} | {} | {} | {} |\n", test.machine,
                             fmt::join(test.poses, ", "), 100.0 * test.noise, test.planted_name(),
                             test.size, verdict(result.diagnosis), outcome(test, result))
              << std::flush;
  }
  std::cout << tally.text();
  EXPECT_GE(tally.alone + tally.ties, 0.95 * tally.faults);
  EXPECT_EQ(tally.wrong, 0);
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
