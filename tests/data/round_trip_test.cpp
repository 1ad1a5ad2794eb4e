/// A record that is written and read again is the same record, in every format.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "hydrapod/data/record_io.hpp"
#include "sample_record.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;

class RoundTrip : public testing::TestWithParam<RecordFormat> {};

/// Bits of a sample, all NaNs being one.
std::uint64_t bits(double value) {
  return std::isnan(value) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(value);
}

TEST_P(RoundTrip, KeepsEveryBitAndEveryField) {
  const TemporaryFolder folder;
  const std::string path = folder / "record";
  const data::Record record = sample_record(2500);
  data::write_record(path, record, GetParam());
  const auto [read, notes] = data::read_record(path);
  EXPECT_THAT(notes, testing::IsEmpty());
  expect_same_header(read.header, record.header);
  ASSERT_EQ(read.samples.rows(), record.samples.rows());
  for (Eigen::Index i = 0; i < record.samples.size(); ++i)
    ASSERT_EQ(bits(read.samples.data()[i]), bits(record.samples.data()[i])) << i;
}

TEST_P(RoundTrip, EqualRecordsAreEqualFiles) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"})
    data::write_record(folder / name, sample_record(37), GetParam());
  EXPECT_EQ(read_text(folder / "a"), read_text(folder / "b"));
}

TEST_P(RoundTrip, BlocksMakeNoDifference) {
  const TemporaryFolder folder;
  const data::Record record = sample_record(1234);
  data::write_record(folder / "whole", record, GetParam());
  {
    const auto writer = data::open_record_writer(folder / "pieces", record.header, GetParam());
    for (Eigen::Index at = 0, size = 1; at < 1234; at += size, size = 1 + (7 * size) % 300)
      writer->append(record.samples.middleRows(at, std::min<Eigen::Index>(size, 1234 - at)));
    writer->close();
  }
  const auto whole = data::read_record(folder / "whole").record;
  const auto pieces = data::read_record(folder / "pieces").record;
  ASSERT_EQ(pieces.samples.rows(), 1234);
  for (Eigen::Index i = 0; i < whole.samples.size(); ++i)
    ASSERT_EQ(bits(whole.samples.data()[i]), bits(pieces.samples.data()[i]));
}

/// Readers take blanks off the ends of names, and the checksum would no longer hold.
TEST_P(RoundTrip, NamesWithBlanksAtTheirEndsAreNotWritten) {
  const TemporaryFolder folder;
  for (const char* name : {" a", "a ", "a\u00e9 "}) {
    data::Record record = sample_record(3);
    record.header.channels[1].name = name;
    EXPECT_THROW(data::write_record(folder / "record", record, GetParam()), std::invalid_argument)
        << name;
  }
}

TEST_P(RoundTrip, ARecordWithoutSamplesIsARecord) {
  const TemporaryFolder folder;
  const data::Record record = sample_record(0);
  data::write_record(folder / "empty", record, GetParam());
  const auto read = data::read_record(folder / "empty").record;
  EXPECT_EQ(read.samples.rows(), 0);
  expect_same_header(read.header, record.header);
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(RecordFormat::hdf5, RecordFormat::mat5,
                                         RecordFormat::mat73, RecordFormat::csv, RecordFormat::uff),
                         [](const auto& format) { return std::string(format_text(format.param)); });

}  // namespace
}  // namespace hydrapod::test
