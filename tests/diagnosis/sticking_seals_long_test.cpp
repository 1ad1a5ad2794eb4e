/// The series of cylinder seals that stick: `build/test/tests/diagnosis_long
/// --gtest_filter=StickingSeals*` prints the table of docs/validation/diagnosis.md.

#include <gtest/gtest.h>

#include <iostream>

#include "support/unlisted_causes.hpp"

namespace hydrapod::test {

namespace {

TEST(StickingSealsSeries, IsFoundAtSmallAmplitudes) {
  Tally tally;
  int others = 0, small = 0, found = 0;
  std::cout << "| machine | poses | noise | planted | verdict | result |\n"
               "| --- | --- | --- | --- | --- | --- |\n";
  for (const auto& test : sticking_cases()) {
    const auto result =
        run_blind(test.basic, [&](const auto&, const auto&) { return measure_unlisted(test); });
    const auto& d = result.diagnosis;
    tally.add(test.basic, result);
    const bool is_small = test.basic.size.ends_with("at 0.1 mm");
    small += is_small;
    found += is_small && result.found;
    others += !result.found && (d.finding == diagnosis::Finding::identified ||
                                d.finding == diagnosis::Finding::undecided);
    std::cout << fmt::format("| {} | {} | {:.2g} % | {} | {} | {} |\n", test.basic.machine,
                             fmt::join(test.basic.poses, ", "), 100.0 * test.basic.noise,
                             test.basic.size, verdict(d), outcome(test.basic, result))
              << std::flush;
  }
  std::cout << tally.text() << "another part identified: " << rate_text(others, tally.faults)
            << '\n';
  EXPECT_EQ(small, 6);
  EXPECT_EQ(found, small);
  // random machines 31 and 83 at 1 mm: masses that differ meet a spring of its own for each mode
  EXPECT_LE(others, 2);
}

}  // namespace

}  // namespace hydrapod::test
