/// Checksums of records: damage is seen in every format that keeps samples bit for bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "hydrapod/data/record_io.hpp"
#include "sample_record.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::ChecksumFinding;
using data::RecordFormat;

class Checksums : public testing::TestWithParam<RecordFormat> {
 protected:
  std::string written(const data::Record& record) {
    data::write_record(folder / "record", record, GetParam());
    return read_text(folder / "record");
  }
  TemporaryFolder folder;
};

struct Read {
  data::Record record{};
  ChecksumFinding finding{};
  std::vector<base::Diagnostic> notes{};
};

Read read(const std::string& path) {
  data::RecordSet set({path});
  Read result{.record = {.header = set.header()}};
  std::vector<double> values;
  set.stream([&](std::size_t, const Eigen::Ref<const data::Samples>& block) {
    values.insert(values.end(), block.data(), block.data() + block.size());
    return true;
  });
  const auto columns = static_cast<Eigen::Index>(set.header().channels.size());
  result.record.samples = Eigen::Map<const data::Samples>(
      values.data(), static_cast<Eigen::Index>(values.size()) / columns, columns);
  result.finding = set.checksum();
  result.notes = set.notes();
  return result;
}

/// What the checksum is of.
bool same(const data::Record& a, const data::Record& b) {
  if (a.header.channels.size() != b.header.channels.size() ||
      a.header.sample_rate != b.header.sample_rate || a.header.start != b.header.start ||
      a.header.repeat != b.header.repeat || a.samples.rows() != b.samples.rows())
    return false;
  for (std::size_t c = 0; c < a.header.channels.size(); ++c) {
    const auto &x = a.header.channels[c], &y = b.header.channels[c];
    if (x.name != y.name || x.unit != y.unit || x.direction != y.direction || x.role != y.role ||
        x.point != y.point)
      return false;
  }
  for (Eigen::Index k = 0; k < a.samples.size(); ++k) {
    const double x = a.samples.data()[k], y = b.samples.data()[k];
    if (std::isnan(x) != std::isnan(y)) return false;
    if (!std::isnan(x) && std::bit_cast<std::uint64_t>(x) != std::bit_cast<std::uint64_t>(y))
      return false;
  }
  return true;
}

TEST_P(Checksums, HoldsForWhatWasWritten) {
  const auto record = sample_record(3100);
  written(record);
  const auto found = read(folder / "record");
  EXPECT_EQ(found.finding, ChecksumFinding::holds);
  EXPECT_TRUE(same(found.record, record));
  EXPECT_THAT(found.notes, testing::IsEmpty());
}

TEST_P(Checksums, HoldsForARecordThatIsReadTwiceAndForNoSamples) {
  written(sample_record(0));
  EXPECT_EQ(read(folder / "record").finding, ChecksumFinding::holds);
  written(sample_record(20000));  // more than is read at once
  data::RecordSet set({folder / "record"});
  EXPECT_EQ(set.checksum(), ChecksumFinding::none);  // not read yet
  for (int time = 0; time < 2; ++time) {
    set.stream([](auto, const auto&) { return true; });
    EXPECT_EQ(set.checksum(), ChecksumFinding::holds);
  }
  set.stream([](auto, const auto&) { return false; });
  EXPECT_EQ(set.checksum(), ChecksumFinding::none);
}

TEST_P(Checksums, APartThatWasNotCompletedHasNone) {
  const auto record = sample_record(500);
  const auto writer = data::open_record_writer(folder / "r", record.header, GetParam());
  writer->append(record.samples);
  if (GetParam() == RecordFormat::uff) return;  // it has no part that can be read
  EXPECT_EQ(read(folder / "r.part").finding, ChecksumFinding::none);
}

/// One bit at a place drawn at random, wherever in the file: what is then read as sound is the
/// same.
TEST_P(Checksums, NoChangedNumberOrNameIsCalledSound) {
  const auto record = sample_record(800);  // most of a chunk of HDF5
  const std::string sound = written(record);
  test::Random random(20261123);
  int differ = 0, hold = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = sound;
    const auto at =
        static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(damaged.size() - 1)));
    damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^
                                    (1U << static_cast<unsigned>(trial % 8)));
    write_text(folder / "damaged", damaged);
    try {
      const auto found = read(folder / "damaged");
      if (found.finding == ChecksumFinding::holds) {
        ++hold;
        EXPECT_TRUE(same(found.record, record)) << "byte " << at << ", bit " << trial % 8;
      } else if (found.finding == ChecksumFinding::differs) {
        ++differ;
        EXPECT_THAT(found.notes, testing::Not(testing::IsEmpty()));
      }
    } catch (const base::InputError&) {
    } catch (const base::ComputationError&) {
    }
  }
  EXPECT_GT(differ, 100);  // most of a file is samples
  RecordProperty("differ", differ);
  RecordProperty("hold", hold);
}

INSTANTIATE_TEST_SUITE_P(Formats, Checksums,
                         testing::Values(RecordFormat::hdf5, RecordFormat::mat5,
                                         RecordFormat::mat73, RecordFormat::csv, RecordFormat::uff),
                         [](const auto& format) { return std::string(format_text(format.param)); });

TEST(Checksum, FilesOfOthersAndRoundedOnesHaveNone) {
  const TemporaryFolder folder;
  write_text(folder / "r.csv", "time,x\n0,1\n1,2\n2,3\n");
  EXPECT_EQ(read(folder / "r.csv").finding, ChecksumFinding::none);
  for (const auto format : {RecordFormat::uff_ascii, RecordFormat::rpc, RecordFormat::rpc_short}) {
    data::write_record(folder / "r", sample_record(90), format);
    EXPECT_EQ(read(folder / "r").finding, ChecksumFinding::none);
  }
}

}  // namespace
}  // namespace hydrapod::test
