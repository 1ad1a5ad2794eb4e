/// The blind series: `build/test/tests/diagnosis_long --gtest_filter=*BlindSeries*` prints the
/// table of docs/validation/diagnosis.md.

#include "planted_faults.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace hydrapod::test {

namespace {

/// BIC of the hypotheses, fitted as they are, if the share `common` of the variance of the model
/// error were one error of all frequencies: covariance d I + c 1 1ᵀ of relative frequencies,
/// inverted after Sherman and Morrison.
std::vector<double> with_common_error(const diagnosis::Diagnosis& d, double noise, double common) {
  const double f2 = std::pow(diagnosis::DiagnoseOptions{}.frequency_error, 2);
  const double own = noise * noise + (1.0 - common) * f2, shared = common * f2;
  std::vector<double> all;
  for (const auto& e : d.hypotheses) {
    double before = 0.0, squares = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < e.fit.targets.size(); ++i) {
      const auto& target = d.targets.modes[i];
      const double off = e.fit.targets[i].difference;
      const double relative = off * target.deviation / target.omega;
      before += off * off;
      squares += relative * relative;
      sum += relative;
    }
    const auto n = static_cast<double>(e.fit.targets.size());
    const double after =
        squares / own - shared * sum * sum / (own * own * (1.0 + n * shared / own));
    all.push_back(e.bic + after - before);
  }
  return all;
}

/// What half of the model error in common would change of a verdict.
struct CommonError {
  int cases{}, first{}, alike{};
  void add(const diagnosis::Diagnosis& d, double noise) {
    if (d.equivalent.empty()) return;
    const auto bic = with_common_error(d, noise, 0.5);
    const auto least = std::ranges::min_element(bic);
    ++cases;
    first += d.hypotheses[d.equivalent.front()].bic < d.best().bic + rounding &&
             *least < bic[d.equivalent.front()] - rounding;
    std::size_t count = 0;
    for (const auto k : d.equivalent) count += bic[k] <= *least + diagnosis::same;
    alike += count != d.equivalent.size();
  }
};

class BlindSeries : public testing::TestWithParam<std::size_t> {};

TEST_P(BlindSeries, FindsWhatWasPlanted) {
  int first = 0;
  std::vector<BlindCase> cases;
  for (std::size_t k = 0; k <= GetParam(); ++k) {
    first += static_cast<int>(cases.size());
    cases = cases_of(settings()[k], first);
  }
  Tally tally;
  CommonError common;
  std::cout << "| machine | poses | noise | planted | size | verdict | result |\n"
               "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& test : cases) {
    const auto result = run_blind(test);
    tally.add(test, result);
    common.add(result.diagnosis, test.noise);
    std::cout << fmt::format("| {} | {} | {:.2g} % | {} | {} | {} | {} |\n", test.machine,
                             fmt::join(test.poses, ", "), 100.0 * test.noise, test.planted_name(),
                             test.size, verdict(result.diagnosis), outcome(test, result))
              << std::flush;
  }
  std::cout << tally.text()
            << fmt::format(
                   "with half of the model error in common, another hypothesis would be first "
                   "in {} of {}, and the ties would be others in {}\n",
                   common.first, common.cases, common.alike);
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
