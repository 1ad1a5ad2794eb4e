/// Records are large: how often they are read is part of what a measurement costs.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "foreign_loop.hpp"
#include "gapped.hpp"
#include "hall_record.hpp"

namespace hydrapod::identification {
namespace {

/// Bytes that this process has read so far; none: the system does not say.
std::optional<double> bytes_read() {
  std::ifstream counters("/proc/self/io");
  std::string name;
  double value = 0.0;
  while (counters >> name >> value)
    if (name == "rchar:") return value;
  return {};
}

class ReadingRecords : public testing::Test {
 protected:
  void write(const data::Record& record) {
    // a process of their own reads HDF5 files
    data::write_record(file_, record, data::RecordFormat::mat5);
    records_.emplace(std::vector<std::string>{file_});
  }
  /// How often `work` reads the record.
  template <class Work>
  double times(const Work& work) {
    const double before = *bytes_read();
    work(*records_);
    return (*bytes_read() - before) / static_cast<double>(std::filesystem::file_size(file_));
  }

 private:
  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "run.mat";
  std::optional<data::RecordSet> records_;
};

/// Of records that are too large to be kept.
const MeasureOptions large{.most_kept = 0};

TEST_F(ReadingRecords, TheirBeginningIsReadOnce) {
  if (!bytes_read()) GTEST_SKIP() << "what is read is not counted here";
  // for the period and the band of the excitation, for the spectra, for lines that may be tones,
  // and twice for rows that were lost
  write(foreign_loop_record(foreign_plant(), {}));
  EXPECT_LT(times([](auto& records) { measure_responses(records, large); }), 5.3);
  write(gapped_record(five_masses(1), {}, 3));  // without a loop also for a second clock
  EXPECT_LT(times([](auto& records) { measure_responses(records, large); }), 6.3);
}

TEST_F(ReadingRecords, ThatAreKeptAreReadOnce) {
  if (!bytes_read()) GTEST_SKIP() << "what is read is not counted here";
  write(gapped_record(five_masses(1), {}, 3));
  Measurement read_again, kept;
  times([&](auto& records) { read_again = measure_responses(records, large); });
  EXPECT_LT(times([&](auto& records) { kept = measure_responses(records, {}); }), 1.1);
  ASSERT_EQ(kept.responses.lines(), read_again.responses.lines());
  for (std::size_t k = 0; k < kept.responses.lines(); ++k)
    EXPECT_EQ(kept.responses.H[k], read_again.responses.H[k]) << k;
}

TEST_F(ReadingRecords, PartsOfThemAreReadOnceMore) {
  if (!bytes_read()) GTEST_SKIP() << "what is read is not counted here";
  for (const Eigen::Index lost : {0, 5}) {
    auto record = hall_record(hall_plant(), {.level = 1e4, .input_level = 100.0, .seed = 2}).record;
    for (Eigen::Index k = 0; k < lost; ++k)
      record.samples(150 + 307 * k, k % 7) = std::numeric_limits<double>::quiet_NaN();
    write(record);
    Measurement m;
    GroupedSpectra once, again;
    times([&](auto& records) { m = measure_responses(records, large); });
    ASSERT_EQ(m.responses.harmonics.size(), 3U);
    EXPECT_LT(times([&](auto& records) { once = measure_groups(records, m, large, 4); }), 1.1);
    EXPECT_GT(times([&](auto& records) { again = measure_groups(records, large, 4); }), 3.9);
    ASSERT_EQ(once.groups.size(), 4U);
    ASSERT_EQ(again.groups.size(), 4U);
    EXPECT_EQ(once.estimator, again.estimator);
    EXPECT_EQ(once.choice.outputs, again.choice.outputs);
    for (std::size_t g = 0; g < 4; ++g) {
      EXPECT_EQ(once.groups[g].blocks_left_out, 0) << g;
      EXPECT_EQ(once.groups[g].re, again.groups[g].re) << g;
      EXPECT_EQ(once.groups[g].im, again.groups[g].im) << g;
    }
  }
}

TEST_F(ReadingRecords, HitsHaveNoBlocksToDrawFrom) {
  data::Record record{.header = test::header_of(1, 1, 500.0), .samples = {}};
  record.samples.setZero(4001, 2);
  record.samples(113, 0) = 31.0;
  for (Eigen::Index t = 113; t < 4001; ++t)
    record.samples(t, 1) = std::sin(0.37 * static_cast<double>(t - 113)) *
                           std::exp(-0.004 * static_cast<double>(t - 113));
  write(record);
  times([](auto& records) {
    const auto m = measure_responses(records, {});
    ASSERT_GT(m.responses.shift, 0.0);
    EXPECT_THROW(measure_groups(records, m, {}, 4), base::ComputationError);
  });
}

}  // namespace
}  // namespace hydrapod::identification
