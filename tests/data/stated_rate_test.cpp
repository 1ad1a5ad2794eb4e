/// A sample rate that is given beside one that the file states.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/data/record_io.hpp"
#include "library_files.hpp"
#include "said.hpp"
#include "sample_record.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;
using testing::HasSubstr;

std::string refusal(const std::string& path, double rate) {
  return refusal_of([&] { data::read_record(path, {.sample_rate = rate}); }).message;
}

TEST(StatedRate, ThatContradictsTheFileIsRefusedInAllFormats) {
  const TemporaryFolder folder;
  const data::Record record = sample_record(57);
  const double rate = record.header.sample_rate;
  for (const RecordFormat format :
       {RecordFormat::hdf5, RecordFormat::mat73, RecordFormat::mat5, RecordFormat::csv,
        RecordFormat::uff, RecordFormat::uff_ascii, RecordFormat::rpc, RecordFormat::rpc_short}) {
    SCOPED_TRACE(data::format_text(format));
    const std::string path = folder / "r";
    data::write_record(path, record, format);
    const bool rpc = format == RecordFormat::rpc || format == RecordFormat::rpc_short;
    const bool uff = format == RecordFormat::uff || format == RecordFormat::uff_ascii;
    EXPECT_THAT(refusal(path, 1.0015 * rate),
                testing::AllOf(HasSubstr(rpc   ? "DELTA_T: the file states 1706.66667 Hz"
                                         : uff ? "abscissa increment: the file states 1706.66667 Hz"
                                               : "sample_rate_hz: the file states 1706.66667 Hz"),
                               HasSubstr("but --rate says 1709.22667 Hz; expected is the rate of "
                                         "the file: leave --rate out")));
    const auto read = data::read_record(path, {.sample_rate = 1.0005 * rate}).record;
    EXPECT_NEAR(read.header.sample_rate, rate, 1e-6 * rate);
  }
}

class RateOfVariables : public testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return folder_ / "r.h5"; }
  /// Three samples beside one number with a unit.
  void write(const char* name, double number, const char* unit) const {
    const double x[] = {1.0, -2.0, 4.0};
    Hdf5File file(path());
    file.write("x", H5T_NATIVE_DOUBLE, {3}, x);
    file.write(name, H5T_NATIVE_DOUBLE, {}, &number);
    file.attribute(name, "unit", std::string(unit));
  }
  double rate() const { return data::read_record(path()).record.header.sample_rate; }

 private:
  TemporaryFolder folder_;
};

TEST_F(RateOfVariables, IsInItsUnit) {
  write("fs", 2.5, "kHz");
  EXPECT_DOUBLE_EQ(rate(), 2500.0);
  EXPECT_THAT(refusal(path(), 2.5),
              HasSubstr("fs: the file states 2500 Hz, but --rate says 2.5 Hz"));
  write("fs", 100.0, "1/s");
  EXPECT_DOUBLE_EQ(rate(), 100.0);
  write("dt", 5.0, "ms");
  EXPECT_DOUBLE_EQ(rate(), 200.0);
}

TEST_F(RateOfVariables, InAnotherUnitIsRefused) {
  write("fs", 2.5, "rad/s");
  EXPECT_THAT(refusal_of([&] { rate(); }).message,
              HasSubstr("'fs' states the sampling in the unit \"rad/s\"; accepted are Hz, kHz"));
  write("dt", 5.0, "ticks");
  EXPECT_THAT(refusal_of([&] { rate(); }).message,
              HasSubstr("'dt' states the sampling in the unit \"ticks\"; accepted are s, ms"));
}

}  // namespace
}  // namespace hydrapod::test
