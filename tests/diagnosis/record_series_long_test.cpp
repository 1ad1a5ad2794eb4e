/// The blind series on records: `build/test/tests/diagnosis_long --gtest_filter=*RecordSeries*`
/// prints the second table of docs/validation/diagnosis.md.

#include <gtest/gtest.h>

#include <iostream>

#include "by_record.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "planted_faults.hpp"

namespace hydrapod::test {

namespace {

struct Recorded {
  Setting setting;
  RecordSetting record;
  int missed{};  ///< cases known not to be found, see docs/validation/diagnosis.md
};

/// The heavy machine's oil holds 4 % of air and gets stiffer with the load on it, which the linear
/// model does not know of: here it holds next to none.
std::vector<Recorded> recorded() {
  const std::vector<std::string> oil{"legs.oil_spring.cylinder.air.fraction=0.001",
                                     "legs.oil_spring.cylinder.bulk_modulus=0.8 GPa"};
  auto stiff = oil;
  stiff.push_back("legs.guide_sleeve.stiffness=20 kN/mm");
  // slower than it would be tuned: with air in the oil it would oscillate by itself
  auto undamped = stiff;
  undamped.insert(undamped.end(), {"controller.feedback=none", "controller.bandwidth=0.73"});
  const Sizes soft{1.7, 0.93, 40.0, 0.2}, hard{0.06, 1.21, 0.15, 1.0};
  return {// the seals' modes are sharp there: ten minutes; faults that keep them away from x and y
          {{"zhang-jiang-2021.toml", {}, {"neutral"}, 0.0, {0.55, 1.24, 6.0, 1.0}},
           {.duration = 600.0, .level = 3e-4, .varied = true},
           1},
          {{"heavy-platform.toml", oil, {"neutral", "low"}, 0.0, soft},
           {.duration = 180.0, .level = 2e-4, .varied = true},
           0},
          {{"heavy-platform.toml", stiff, {"neutral"}, 0.0, hard},
           {.duration = 180.0, .level = 2e-4, .sensors = 2.0, .varied = true},
           1},
          {{"heavy-platform.toml", stiff, {"neutral", "low"}, 0.0, hard},
           {.duration = 120.0, .level = 2e-4, .varied = true},
           1},
          {{"vibration table", {}, {"neutral", "tilted"}, 0.0, {0.07, 1.19, 0.1, 1.0}},
           {.duration = 90.0, .level = 1.1e-4, .sensors = 1.7, .varied = true, .to = 150.0},
           2},
          // a controller that does not damp, and forces on the platform
          {{"heavy-platform.toml", undamped, {"neutral"}, 0.0, hard},
           {.duration = 120.0, .force = 3e3, .varied = true},
           1}};
}

class RecordSeries : public testing::TestWithParam<std::size_t> {};

TEST_P(RecordSeries, FindsWhatWasPlanted) {
  const auto [setting, record, missed] = recorded()[GetParam()];
  const auto measure = by_record(record);
  Tally tally;
  std::cout << "| machine | poses | record | planted | size | verdict | result | raw χ²/ν |\n"
               "| --- | --- | --- | --- | --- | --- | --- | ---: |\n";
  for (const auto& test : cases_of(setting, 1000 * static_cast<int>(GetParam() + 1))) {
    BlindResult result;
    try {
      result = run_blind(test, measure);
    } catch (const base::InputError& error) {  // nothing to diagnose in it
      ADD_FAILURE() << test.planted_name() << ": " << error.what();
      continue;
    }
    tally.add(test, result);
    const auto variation = variation_of(record, test.repetition);
    std::cout << fmt::format(
                     "| {} | {} | {:g} s, {}, {}, sensors ×{:g} | {} | {} | {} | {} | {:.2f} |\n",
                     test.machine, fmt::join(test.poses, ", "),
                     variation.duration > 0.0 ? variation.duration : record.duration,
                     variation.name,
                     record.force > 0.0 ? fmt::format("{:g} kN", 1e-3 * record.force)
                                        : fmt::format("{:g} mm", 1e3 * record.level),
                     record.sensors, test.planted_name(), test.size, verdict(result.diagnosis),
                     outcome(test, result), diagnosis::raw_scatter2(result.diagnosis))
              << std::flush;
  }
  std::cout << tally.text();
  EXPECT_GE(tally.alone + tally.ties, tally.faults - missed);
  EXPECT_EQ(tally.wrong, 0);
}

/// Every planted fault has a size that the table can state.
TEST(RecordSizes, AreStated) {
  int setting = 0;
  for (const auto& one : recorded()) {
    ++setting;
    for (const auto& test : cases_of(one.setting, 1000 * setting)) {
      EXPECT_EQ(test.size.empty(), test.planted.empty()) << test.planted_name();
      std::cout << fmt::format("| {} | {} | {} | {} |\n", setting, test.machine,
                               test.planted_name(), test.size);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, RecordSeries, testing::Range<std::size_t>(0, 6));

}  // namespace

}  // namespace hydrapod::test
