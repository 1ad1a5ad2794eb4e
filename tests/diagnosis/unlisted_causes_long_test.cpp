/// The series with causes that are not on the list, and that of sound machines:
/// `build/test/tests/diagnosis_long --gtest_filter=*Unlisted*:*Sound*` prints the tables of
/// docs/validation/diagnosis.md.

#include <gtest/gtest.h>

#include <iostream>

#include "planted_faults.hpp"
#include "support/binomial.hpp"
#include "support/unlisted_causes.hpp"

namespace hydrapod::test {

namespace {

/// The largest share of cases in which another part may be blamed.
void expect_few_blamed(unsigned draw, double most, const diagnosis::DiagnoseOptions& options = {}) {
  int cases = 0, blamed = 0, same_part = 0;
  std::cout
      << "| machine | poses | noise | planted | change of a frequency | verdict | identified |\n"
         "| --- | --- | --- | --- | ---: | --- | --- |\n";
  for (const auto& test : unlisted_cases(1000, draw)) {
    const auto result = run_unlisted(test, options);
    ++cases;
    same_part += result.right_part;
    blamed += result.blamed && !result.right_part;
    std::cout << fmt::format("| {} | {} | {:.2g} % | {} | {:.1f} % | {} | {} |\n",
                             test.basic.machine, fmt::join(test.basic.poses, ", "),
                             100.0 * test.basic.noise, test.physics, 100.0 * result.change,
                             result.refused.empty() ? verdict(result.diagnosis) : result.refused,
                             !result.blamed      ? "nothing"
                             : result.right_part ? "the part itself"
                                                 : "ANOTHER PART")
              << std::flush;
  }
  std::cout << "\nA part that is not the cause is identified in " << rate_text(blamed, cases)
            << ", the part itself in " << rate_text(same_part, cases) << ".\n";
  EXPECT_GE(cases, 60);
  EXPECT_LE(blamed, most * cases);
}

TEST(UnlistedCauses, AreNotBlamedOnListedParts) { expect_few_blamed(0, 0.05); }

/// The first draw, with half of the model error in common.
TEST(UnlistedCauses, AreBlamedMoreOftenWithACommonError) {
  expect_few_blamed(0, 0.1, {.common_share = 0.5});
}

/// No rule was set with these in view: the rate is higher.
TEST(UnlistedCauses, OfAnotherDrawAreBlamedMoreOften) { expect_few_blamed(1, 0.1); }

/// Machines as their files state them, of which nothing may be blamed.
std::vector<BlindCase> sound_machines() {
  std::vector<BlindCase> all;
  const auto add = [&](BlindCase test) {
    test.repetition = 7000 + static_cast<int>(all.size());
    all.push_back(std::move(test));
  };
  for (int k = 0; k < 5; ++k)
    for (const auto& s : settings())
      add({.machine = s.machine, .design = s.design, .poses = s.poses, .noise = s.noise});
  const std::vector<std::vector<std::string>> poses{
      {"neutral"}, {"shifted"}, {"neutral", "shifted"}};
  constexpr std::array noise{5e-4, 1e-3, 2e-3, 3e-3};
  for (std::size_t k = 0; k < 36; ++k)
    add({.machine = fmt::format("random {}", 211 + 7 * k),
         .poses = poses[k % poses.size()],
         .noise = noise[k % noise.size()]});
  return all;
}

TEST(SoundMachines, AreNotBlamed) {
  const auto all = sound_machines();
  int cases = 0, blamed = 0, unexplained = 0;
  for (const auto& test : all) {
    const auto result = run_blind(test);
    ++cases;
    if (result.found) continue;
    const bool names = !result.diagnosis.equivalent.empty();
    (names ? blamed : unexplained) += 1;
    std::cout << fmt::format("{}, {}, {:.2g} %: {}\n", test.machine, fmt::join(test.poses, ", "),
                             100.0 * test.noise, verdict(result.diagnosis));
  }
  std::cout << "A cause is named in " << rate_text(blamed, cases) << " machines without fault; "
            << unexplained << " are called unexplained.\n";
  EXPECT_GE(cases, 60);
  EXPECT_EQ(blamed, 0);
  EXPECT_EQ(unexplained, 0);
}

}  // namespace

}  // namespace hydrapod::test
