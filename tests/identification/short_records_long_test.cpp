/// Records of a few seconds: rows of docs/validation/identification.md.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"
#include "measured_records.hpp"
#include "short_records.hpp"

namespace hydrapod::identification {
namespace {

constexpr std::uint64_t short_record_seeds = 60;

/// The largest |mean error| of a mode, over the records in which all were found and no other.
class Bias {
 public:
  void add(const std::vector<test::TrueMode>& truth, const Identification& found) {
    frequency_.resize(truth.size());
    damping_.resize(truth.size());
    for (std::size_t r = 0; r < truth.size() && found.modes.size() == truth.size(); ++r) {
      const auto& fit = found.modes[r].fit;
      const double omega = std::abs(truth[r].pole);
      frequency_[r].push_back(fit.omega() / omega - 1.0);
      damping_[r].push_back(fit.damping_ratio() / (-truth[r].pole.real() / omega) - 1.0);
    }
  }
  [[nodiscard]] double frequency() const { return largest_mean(frequency_); }
  [[nodiscard]] double damping() const { return largest_mean(damping_); }

 private:
  static double largest_mean(const std::vector<std::vector<double>>& all) {
    double largest = 0.0;
    for (const auto& list : all) {
      double sum = 0.0;
      for (const double x : list) sum += x;
      largest = std::max(
          largest, std::abs(sum) / static_cast<double>(std::max<std::size_t>(list.size(), 1)));
    }
    return largest;
  }
  std::vector<std::vector<double>> frequency_, damping_;
};

/// As `hydrapod identify` does it with averages; none where it refuses.
std::vector<test::FoundMode> by_blocks(const data::Record& record) {
  try {
    return test::found_modes(identify_modes(measured({record}, {}).responses));
  } catch (const base::ComputationError&) {
    return {};
  }
}

struct Limits {
  double found{1.0}, false_modes{0.1}, frequency_bias{1e-3}, damping_bias{0.03};
  double most_coverage{0.99};
};

/// `make(seed)`: a record; `inputs_first`: as the textbook takes it.
template <class Make, class Plain>
void judge(const char* name, const test::ModalSystem& system, const Limits& limits,
           const Make& make, const Plain& inputs_first) {
  const auto truth = test::true_modes(system);
  test::ClassScore ours, blocks, plain;
  Bias bias;
  for (std::uint64_t seed = 1; seed <= short_record_seeds; ++seed) {
    const data::Record record = make(seed);
    const auto result = identified_record({record});
    ASSERT_NE(result.measured.record, nullptr) << "it was averaged";
    ours.add(truth, test::found_modes(result.found));
    bias.add(truth, result.found);
    blocks.add(truth, by_blocks(record));
    plain.add(truth, textbook_record_modes(inputs_first(record), system.inputs(), 25.0));
  }
  test::print_class(name, "hydrapod", ours);
  test::print_class(name, "hydrapod, averages of blocks", blocks);
  test::print_class(name, "VARX and realisation", plain);
  fmt::print("largest bias: frequency {:.3g} %, damping {:.3g} %\n", 100.0 * bias.frequency(),
             100.0 * bias.damping());
  EXPECT_GE(ours.found_share(), limits.found);
  EXPECT_LE(ours.false_per_seed(), limits.false_modes);
  EXPECT_LE(bias.frequency(), limits.frequency_bias);
  EXPECT_LE(bias.damping(), limits.damping_bias);
  // three standard deviations of a share of 300 intervals around 95 %
  for (const double coverage :
       {ours.frequency_coverage(), ours.damping_coverage(), ours.shape_coverage()}) {
    EXPECT_GE(coverage, 0.91);
    EXPECT_LE(coverage, limits.most_coverage);
  }
}

void judge_forces(const char* name, const test::ModalSystem& system, const ShortRecordCase& e,
                  const Limits& limits = {}) {
  judge(
      name, system, limits, [&](std::uint64_t seed) { return short_record(system, e, seed); },
      [](const data::Record& record) { return record; });
}

TEST(ShortRecordsLong, FiveMassesTenSeconds) {
  judge_forces("5 masses, 10 s, 1 % noise", five_masses(), {});
}
TEST(ShortRecordsLong, FiveMassesTwentySeconds) {
  judge_forces("5 masses, 20 s, 1 % noise", five_masses(), {.duration = 20.0});
}
TEST(ShortRecordsLong, FiveMassesFiveSeconds) {
  // 296 of 300: docs/validation/identification.md
  judge_forces("5 masses, 5 s, 1 % noise", five_masses(), {.duration = 5.0}, {.found = 0.98});
}
TEST(ShortRecordsLong, TwoRowsTenSeconds) {
  judge_forces("6 masses, close pairs, 10 s, 1 % noise", two_rows(), {});
}
TEST(ShortRecordsLong, TwoRowsTwentySeconds) {
  judge_forces("6 masses, close pairs, 20 s, 1 % noise", two_rows(), {.duration = 20.0});
}
TEST(ShortRecordsLong, MuchNoise) {
  judge_forces("5 masses, 10 s, 5 % noise", five_masses(), {.noise = 0.05});
}
TEST(ShortRecordsLong, Hum) {
  judge_forces("5 masses, 10 s, hum of 10 %", five_masses(), {.hum = 0.1});
}
TEST(ShortRecordsLong, FiveMassesSixtySeconds) {
  judge_forces("5 masses, 60 s, 1 % noise", five_masses(), {.duration = 60.0});
}
TEST(ShortRecordsLong, ForcesInABand) {
  // 298 of 300: docs/validation/identification.md
  judge_forces("5 masses, 20 s, forces below 8 Hz", five_masses(), {.duration = 20.0, .band = 8.0},
               {.found = 0.98});
}
TEST(ShortRecordsLong, Sweeps) {
  judge_forces("5 masses, 20 s, sweeps", five_masses(), {.duration = 20.0, .sweeps = true});
}
TEST(ShortRecordsLong, ForcesThatNobodyMeasured) {
  judge_forces("5 masses, 20 s, 5 % of the forces not measured", five_masses(),
               {.duration = 20.0, .forces = 0.05},
               {.most_coverage = 1.0});  // intervals of shapes are too wide: 99.7 %
}

}  // namespace
}  // namespace hydrapod::identification
