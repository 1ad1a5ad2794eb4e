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
  write("fs", 2500.0, "samples/second");
  EXPECT_DOUBLE_EQ(rate(), 2500.0);
  write("fs", 100.0, "1/s");
  EXPECT_DOUBLE_EQ(rate(), 100.0);
  write("dt", 5.0, "ms");
  EXPECT_DOUBLE_EQ(rate(), 200.0);
}

/// 128 Hz are 0.128 kHz and steps of 7.8125 ms.
TEST_F(RateOfVariables, WithoutAUnitThatMakesASlowRateIsNamed) {
  const auto said = [&](const char* name, double number, const char* unit) {
    const double x[] = {1.0, -2.0, 4.0};
    {
      Hdf5File file(path());
      file.write("x", H5T_NATIVE_DOUBLE, {3}, x);
      file.write(name, H5T_NATIVE_DOUBLE, {}, &number);
      if (*unit != '\0') file.attribute(name, "unit", std::string(unit));
    }
    return messages(data::read_record(path()).notes);
  };
  EXPECT_THAT(
      said("Fs", 0.128, ""),
      testing::Contains(HasSubstr("'Fs' has no unit and is taken for Hz, which makes 0.128 Hz; "
                                  "write Hz into the file")));
  EXPECT_THAT(
      said("dt", 7.8125, ""),
      testing::Contains(HasSubstr("'dt' has no unit and is taken for seconds, which makes 0.128 "
                                  "Hz; write s into the file")));
  const auto silent = testing::Not(testing::Contains(HasSubstr("no unit")));
  EXPECT_THAT(said("Fs", 0.128, "Hz"), silent);
  EXPECT_THAT(said("dt", 7.8125, "s"), silent);
  EXPECT_THAT(said("dt", 7.8125, "ms"), silent);
  EXPECT_THAT(said("sample_rate_hz", 0.128, ""), silent);
  EXPECT_THAT(said("Fs", 128.0, ""), silent);
}

TEST_F(RateOfVariables, InAnotherUnitIsRefused) {
  write("fs", 2.5, "rad/s");
  EXPECT_THAT(refusal_of([&] { rate(); }).message,
              HasSubstr("'fs' states the sampling in the unit \"rad/s\"; accepted are Hz, kHz"));
  write("dt", 5.0, "ticks");
  EXPECT_THAT(refusal_of([&] { rate(); }).message,
              HasSubstr("'dt' states the sampling in the unit \"ticks\"; accepted are s, ms"));
}

/// It is no step of time: the rate is stated otherwise.
TEST_F(RateOfVariables, InAnotherUnitIsLeftAsideWhereThereIsAnother) {
  const auto beside = [&](const char* name, double number, const char* unit) {
    const double x[] = {1.0, -2.0, 4.0}, step = 0.5;
    Hdf5File file(path());
    file.write("x", H5T_NATIVE_DOUBLE, {3}, x);
    file.write("step", H5T_NATIVE_DOUBLE, {}, &step);
    file.attribute("step", "unit", std::string("mm"));
    file.write(name, H5T_NATIVE_DOUBLE, {}, &number);
    file.attribute(name, "unit", std::string(unit));
  };
  const auto aside =
      testing::Contains(HasSubstr("'step' states the sampling in the unit \"mm\": left aside"));
  beside("fs", 200.0, "Hz");
  EXPECT_DOUBLE_EQ(rate(), 200.0);
  EXPECT_THAT(messages(data::read_record(path()).notes), aside);
  write("step", 0.5, "mm");
  const auto [record, notes] = data::read_record(path(), {.sample_rate = 50.0});
  EXPECT_DOUBLE_EQ(record.header.sample_rate, 50.0);
  EXPECT_THAT(messages(notes), aside);
}

TEST(TimesOfVariables, InAUnitThatIsUnknownAreNamed) {
  const TemporaryFolder folder;
  const std::string path = folder / "r.h5";
  for (const auto& [unit, rate] : {std::pair{"ms", 100.0}, {"Sec", 0.1}, {"ticks", 0.1}}) {
    {
      const double x[] = {1.0, -2.0, 4.0}, t[] = {0.0, 10.0, 20.0};
      Hdf5File file(path);
      file.write("x", H5T_NATIVE_DOUBLE, {3}, x);
      file.write("time", H5T_NATIVE_DOUBLE, {3}, t);
      file.attribute("time", "unit", std::string(unit));
    }
    const auto [record, notes] = data::read_record(path);
    EXPECT_NEAR(record.header.sample_rate, rate, 1e-9 * rate) << unit;
    const auto named = testing::Contains(
        HasSubstr("the unit \"ticks\" of the times 'time' is unknown: taken for s"));
    if (unit == std::string("ticks"))
      EXPECT_THAT(messages(notes), named);
    else
      EXPECT_THAT(messages(notes), testing::Not(named));
  }
}

}  // namespace
}  // namespace hydrapod::test
