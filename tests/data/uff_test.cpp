/// Universal Files: laid out as the public description says, and those of other programs read.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/record_io.hpp"
#include "said.hpp"
#include "sample_record.hpp"
#include "support/run_program.hpp"
#include "uff_reference.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;

std::string written(const data::Record& record, RecordFormat format) {
  const TemporaryFolder folder;
  data::write_record(folder / "r.uff", record, format);
  return read_text(folder / "r.uff");
}

data::ReadRecordResult read(const std::string& text, const data::ReadOptions& options = {}) {
  const TemporaryFolder folder;
  write_text(folder / "r.uff", text);
  return data::read_record(folder / "r.uff", options);
}

class Layout : public testing::TestWithParam<RecordFormat> {};

TEST_P(Layout, IsReadBackByAReaderThatTakesColumnsLiterally) {
  const data::Record record = sample_record(101);
  const uff::File file = uff::Reader(written(record, GetParam())).read();
  std::vector<long> datasets{151, 164, 99001};
  datasets.insert(datasets.end(), record.header.channels.size(), 58);
  EXPECT_EQ(file.datasets, datasets);
  EXPECT_EQ(file.model_name, record.header.title);
  EXPECT_EQ(file.units_code, 1);
  EXPECT_THAT(file.unit_factors, testing::ElementsAre(1.0, 1.0, 1.0, 273.15));
  ASSERT_EQ(file.functions.size(), record.header.channels.size());
  for (std::size_t c = 0; c < file.functions.size(); ++c) {
    const uff::Function& f = file.functions[c];
    const data::Channel& channel = record.header.channels[c];
    const int code = static_cast<int>(channel.direction);
    EXPECT_EQ(f.id[0], channel.name);
    EXPECT_EQ(f.id[2], "20-NOV-26 09:00:00");
    EXPECT_EQ(f.type, 1);  // time response
    EXPECT_EQ(f.version, record.header.repeat);
    EXPECT_EQ(f.response_node, channel.point);
    EXPECT_EQ(f.response_direction, std::abs(code) <= 6 ? code : 0);
    EXPECT_EQ(f.response_entity, code > 6 ? "LEG " + std::to_string(code - 10) : "NONE");
    EXPECT_EQ(f.data_type, 4);  // real, double precision
    EXPECT_EQ(f.count, 101);
    EXPECT_EQ(f.spacing, 1);  // even
    EXPECT_NEAR(f.first, record.header.start, 5.1e-6 * std::abs(record.header.start));
    EXPECT_NEAR(f.increment * record.header.sample_rate, 1.0, 1e-5);
    EXPECT_EQ(f.quantity[0], 17);  // time
    EXPECT_EQ(f.unit[0], "s");
    EXPECT_EQ(f.unit[1], channel.unit.empty() ? "NONE" : channel.unit);
    ASSERT_EQ(f.values.size(), 101U);
    for (Eigen::Index k = 0; k < 101; ++k) {
      const double sent = record.samples(k, static_cast<Eigen::Index>(c));
      const double got = f.values[static_cast<std::size_t>(k)];
      if (GetParam() == RecordFormat::uff) {
        EXPECT_TRUE(got == sent || std::isnan(sent));
      } else if (std::isfinite(sent)) {
        EXPECT_NEAR(got, sent, 5.1e-13 * std::abs(sent));  // 13 digits
      }
      EXPECT_EQ(std::isnan(got), std::isnan(sent));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Layout,
                         testing::Values(RecordFormat::uff, RecordFormat::uff_ascii),
                         [](const auto& f) {
                           return f.param == RecordFormat::uff ? std::string("binary")
                                                               : std::string("ascii");
                         });

TEST(Uff, EveryColumnOfATinyFileIsWhereTheDescriptionHasIt) {
  data::Record record;
  record.header.title = "Tiny";
  record.header.channels = {{"pressure", "Pa", data::Direction::leg2, data::Role::response, 12},
                            {"tilt", "rad", data::Direction::minus_ry, data::Role::response, 3}};
  record.header.sample_rate = 2000.0;
  record.header.start = -0.25;
  record.samples.resize(5, 2);
  record.samples << 1.0, -0.5, 2.5e6, 1e-300, -1e300, 0.0, 1.0 / 3.0, 7.0, 5.0, 6.0;
  const std::string blank70(70, ' ');
  const std::string expected =
      "    -1\n"
      "    58\n"
      "pressure                                                                        \n"
      "Tiny                                                                            \n"
      "NONE                                                                            \n"
      "response of repeat 1                                                            \n"
      "NONE                                                                            \n"
      "    1         1    1         0 LEG 2             12   0 NONE               0   0\n"
      "         4         5         1 -2.50000E-01  5.00000E-04  0.00000E+00\n"
      "        17    0    0    0 Time                 s                   \n"
      "        15   -2    1    0 pressure             Pa                  \n"
      "         0    0    0    0 NONE                 NONE                \n"
      "         0    0    0    0 NONE                 NONE                \n"
      "  1.000000000000E+00  2.500000000000E+06-1.000000000000E+300  3.333333333333E-01\n"
      "  5.000000000000E+00\n"
      "    -1\n";
  const std::string text = written(record, RecordFormat::uff_ascii);
  EXPECT_THAT(text, testing::HasSubstr(expected));
  EXPECT_THAT(text, testing::HasSubstr("    -1\n   164\n"
                                       "         1SI: Meter (newton)           2\n"
                                       "  1.00000000000000000D+00  1.00000000000000000D+00  "
                                       "1.00000000000000000D+00\n"
                                       "  2.73149999999999977D+02\n    -1\n"));
  EXPECT_THAT(written(record, RecordFormat::uff),
              testing::HasSubstr("    58b     1     2          11          40     0     0"
                                 "           0           0\n"));
}

TEST(Uff, AsciiKeepsThirteenDigitsAndTheHeader) {
  const data::Record record = sample_record(57);
  const auto [again, notes] = read(written(record, RecordFormat::uff_ascii));
  EXPECT_THAT(notes, testing::IsEmpty());
  expect_same_header(again.header, record.header);
  for (Eigen::Index i = 0; i < record.samples.size(); ++i) {
    const double sent = record.samples.data()[i], got = again.samples.data()[i];
    if (std::isfinite(sent))
      EXPECT_NEAR(got, sent, 5.1e-13 * std::abs(sent));
    else
      EXPECT_TRUE(got == sent || (std::isnan(got) && std::isnan(sent)));
  }
}

/// A function as another program may write it.
std::string function(const std::string& ordinate, const std::string& values,
                     const std::string& form =
                         "         2         3         1 "
                         "0.00000E+000 5.00000E-005 0.00000E+000",
                     const std::string& place =
                         "    1         0    0         0 NONE               "
                         "0   0 NONE               0   0") {
  return "    -1\n    58\n1x : m/s2\nUFF58\n30-Apr-20 19:12:52\nNONE\nNONE\n" + place + "\n" +
         form + "\n        17    0    0    0 Time                 s\n" + ordinate +
         "\n         0    0    0    0 NONE                 NONE\n"
         "         0    0    0    0 NONE                 NONE\n" +
         values + "    -1\n";
}
constexpr const char* three = " -3.81956E+00 -3.56616E+00 -2.98987E+00\n";
constexpr const char* general = "         1    0    0    0 1x                   ";

TEST(Uff, ExponentsOfThreeDigitsAndLowerCaseMonthsAreRead) {
  const auto [record, notes] = read(function(std::string(general) + "m/s²", three));
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_EQ(record.header.sample_rate, 20000.0);
  EXPECT_EQ(record.header.date, "2020-04-30T19:12:52");
  EXPECT_EQ(record.header.channels.at(0).name, "1x : m/s2");
  ASSERT_EQ(record.samples.rows(), 3);
  EXPECT_EQ(record.samples(2, 0), -2.98987);
}

TEST(Uff, LinesOfCarriageReturnAndLineFeedAreLinesToo) {
  std::string text = function(std::string(general) + "m/s^2", three), dos;
  for (const char c : text) dos += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const auto record = read(dos).record;
  ASSERT_EQ(record.samples.rows(), 3);
  EXPECT_EQ(record.samples(0, 0), -3.81956);
}

TEST(Uff, FortranExponentsWithDOrWithoutALetterAreRead) {
  const auto record =
      read(function(std::string(general) + "Pa", " -3.81956D+00 -3.566161-101          1.25\n"))
          .record;
  ASSERT_EQ(record.samples.rows(), 3);
  EXPECT_EQ(record.samples(0, 0), -3.81956);
  EXPECT_EQ(record.samples(1, 0), -3.566161e-101);
  EXPECT_EQ(record.samples(2, 0), 1.25);
}

TEST(Uff, NumbersThatAreNotInTheirColumnsAreRead) {
  const auto record = read(function(std::string(general) + "Pa", "1.5 -2.5\n 4\n")).record;
  ASSERT_EQ(record.samples.rows(), 3);
  EXPECT_THAT(record.samples.reshaped(), testing::ElementsAre(1.5, -2.5, 4.0));
}

TEST(Uff, TheUnitLabelIsHonoured) {
  const auto [record, notes] = read(function(std::string(general) + "bar", three));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].message, "channel \"1x : m/s2\": converted to \"Pa\", times 100000");
  EXPECT_EQ(record.header.channels[0].unit, "Pa");
  EXPECT_EQ(record.samples(0, 0), -3.81956 * 100000.0);
}

/// Dataset 164 for feet and pounds, as the description has it for an example.
constexpr const char* feet =
    "    -1\n   164\n         2Foot (pound f)               2\n"
    "  3.28083989501312334D+00  2.24808943099710480D-01  1.79999999999999999D+00\n"
    "  4.59670000000000002D+02\n    -1\n";

TEST(Uff, Dataset164AppliesWhereThereIsNoUnitLabel) {
  const std::string acceleration = "        12    1    0    0 NONE                 NONE";
  const std::string pressure = "        15   -2    1    0 NONE                 NONE";
  const auto a = read(feet + function(acceleration, three)).record;
  EXPECT_EQ(a.header.channels[0].unit, "m/s^2");
  EXPECT_NEAR(a.samples(0, 0), -3.81956 * 0.3048, 1e-14);
  const auto p = read(feet + function(pressure, three)).record;
  EXPECT_EQ(p.header.channels[0].unit, "Pa");
  EXPECT_NEAR(p.samples(0, 0), -3.81956 * 4.4482216152605 / (0.3048 * 0.3048), 1e-12 * 183.0);
}

TEST(Uff, AnAngleIsNoLength) {
  const std::string displacement = "         8    1    0    0 NONE                 NONE";
  for (const auto direction : {data::Direction::ry, data::Direction::minus_ry}) {
    const std::string place = fmt::format(
        "    1         0    0         0 NONE               7{:4} NONE               0   0",
        static_cast<int>(direction));
    const auto record =
        read(feet +
             function(displacement, three,
                      "         2         3         1 0.00000E+000 5.00000E-005 0.00000E+000",
                      place))
            .record;
    EXPECT_EQ(record.header.channels[0].unit, "rad");
    EXPECT_EQ(record.header.channels[0].direction, direction);
    EXPECT_EQ(record.header.channels[0].point, 7);
    EXPECT_EQ(record.samples(0, 0), -3.81956);
  }
}

TEST(Uff, UnevenTimesThatAreEvenAreARecord) {
  const std::string form = "         2         3         0  0.00000E+00  0.00000E+00  0.00000E+00";
  const std::string values =
      "  1.00000E+00  7.00000E+00  1.50000E+00  8.00000E+00  2.00000E+00"
      "  9.00000E+00\n";
  const auto [record, notes] = read(function(std::string(general) + "m", values, form));
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_EQ(record.header.sample_rate, 2.0);
  EXPECT_EQ(record.header.start, 1.0);
  EXPECT_THAT(record.samples.reshaped(), testing::ElementsAre(7.0, 8.0, 9.0));
}

TEST(Uff, BigEndianBinaryIsRead) {
  std::string text = function(std::string(general) + "m", "");
  text.replace(text.find("    58\n"), 7,
               "    58b     2     2          11          12     0     0           0           0\n");
  const std::string floats("\x3F\x80\x00\x00\xC0\x20\x00\x00\x42\xF6\x00\x00", 12);
  text.insert(text.rfind("    -1\n"), floats);
  const auto [record, notes] = read(text);
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_THAT(record.samples.reshaped(), testing::ElementsAre(1.0, -2.5, 123.0));
}

/// Times in single precision beside values in double: the number of bytes says so.
TEST(Uff, BinaryTimesMayBeNarrowerThanTheirValues) {
  const std::string form = "         4         3         0  0.00000E+00  0.00000E+00  0.00000E+00";
  std::string text = function(std::string(general) + "m", "", form);
  text.replace(text.find("    58\n"), 7,
               "    58b     1     2          11          36     0     0           0           0\n");
  std::string bytes;
  for (const auto& [time, value] :
       {std::pair{1.25F, 7.1}, std::pair{1.5F, -8.3e-7}, std::pair{1.75F, 9.7e5}}) {
    bytes.append(reinterpret_cast<const char*>(&time), 4);
    bytes.append(reinterpret_cast<const char*>(&value), 8);
  }
  text.insert(text.rfind("    -1\n"), bytes);
  const auto [record, notes] = read(text);
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_EQ(record.header.sample_rate, 4.0);
  EXPECT_EQ(record.header.start, 1.25);
  EXPECT_THAT(record.samples.reshaped(), testing::ElementsAre(7.1, -8.3e-7, 9.7e5));
}

/// Bytes that this process has read so far.
std::uint64_t bytes_read() {
  std::ifstream stream("/proc/self/io");
  std::string key;
  std::uint64_t bytes = 0;
  stream >> key >> bytes;
  return key == "rchar:" ? bytes : 0;
}

TEST(Uff, TheKindOfALargeFileIsFoundWithoutItsValues) {
  if (bytes_read() == 0) GTEST_SKIP() << "no /proc/self/io";
  const TemporaryFolder folder;
  data::write_record(folder / "r.uff", sample_record(100'000), RecordFormat::uff_ascii);
  const std::uint64_t before = bytes_read();
  EXPECT_EQ(data::file_kind(folder / "r.uff"), data::FileKind::record);
  EXPECT_LT(bytes_read() - before, std::filesystem::file_size(folder / "r.uff") / 3);
}

TEST(Uff, TheKindIsFoundBehindValuesThatAreNotAsDeclared) {
  const TemporaryFolder folder;
  const auto kind = [&](const std::string& text) {
    write_text(folder / "r.uff", text);
    return data::file_kind(folder / "r.uff");
  };
  const std::string response =
      function(std::string(general) + "m", three,
               "         5         1         1  0.00000E+00  1.00000E+00  0.00000E+00",
               "    4         1    0         0 NONE               0   0 NONE               0   0");
  for (const std::string values : {three, " -3.81956E+00\n", "1.5 -2.5\n 4\n", ""})
    EXPECT_EQ(kind(function(std::string(general) + "m", values) + response),
              data::FileKind::frequency_responses)
        << values;
}

/// As other programs and editors leave files behind.
TEST(Uff, TheKindIsFoundBehindBlankLinesWithCarriageReturnsAndLowerCaseExponents) {
  const TemporaryFolder folder;
  const std::string lines = " -3.81956e+00 -3.56616d+00 -2.98987e+00\n",
                    record = function(std::string(general) + "m/s^2", lines),
                    responses = record +
                                function(std::string(general) + "m", lines,
                                         "         5         1         1  0.00000e+00  1.00000e+00 "
                                         " 0.00000e+00",
                                         "    4         1    0         0 NONE               0   0 "
                                         "NONE               0   0");
  for (const std::string before : {"", "\n", "  \t\n\n", "     \n      \n"})
    for (const bool dos : {false, true}) {
      SCOPED_TRACE(before + (dos ? "CR" : ""));
      const auto written = [&](std::string text) {
        text = before + text;
        for (std::size_t at = 0; dos && (at = text.find('\n', at)) != text.npos; at += 2)
          text.insert(at, "\r");
        write_text(folder / "r.uff", text);
        return text;
      };
      written(responses);
      EXPECT_EQ(data::file_kind(folder / "r.uff"), data::FileKind::frequency_responses);
      const auto found = read(written(record));
      EXPECT_EQ(data::file_kind(folder / "r.uff"), data::FileKind::record);
      EXPECT_THAT(found.notes, testing::IsEmpty());
      EXPECT_THAT(found.record.samples.reshaped(),
                  testing::ElementsAre(-3.81956, -3.56616, -2.98987));
    }
}

TEST(Uff, UnknownDatasetsAreSkippedWithANote) {
  const std::string nodes =
      "    -1\n  2420\n         1         0         0        11  1.0 2.0 3.0\n    -1\n";
  const auto [record, notes] = read(nodes + function(std::string(general) + "m", three) + nodes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].message,
            "dataset 1 has the number 2420, which is not read: skipped, and 1 more like it");
  EXPECT_EQ(record.samples.rows(), 3);
}

/// A frequency response of three lines as another program may write it.
std::string foreign_response(const std::string& abscissa, const std::string& force = "N",
                             const std::string& type = "5", int quantity = 18) {
  const bool real = type == "2" || type == "4";
  return fmt::format(
      "    -1\n    58\nNONE\nNONE\nNONE\nNONE\nNONE\n"
      "    4         1    0         0 NONE               1   1 NONE               1   1\n"
      "{:>10}         3         1  1.00000E+00  5.00000E-01  0.00000E+00\n"
      "{:10}    0    0    0 Frequency            {:20}\n"
      "        12    0    0    0 Acceleration         m/s^2               \n"
      "        13    0    0    0 Force                {:20}\n"
      "         0    0    0    0 NONE                 NONE                \n"
      "{}    -1\n",
      type, quantity, abscissa, force,
      real ? " -3.81956E+00 -3.56616E+00 -2.98987E+00\n"
           : " -3.81956E+00 -3.56616E+00 -2.98987E+00  1.00000E+00  2.00000E+00  3.00000E+00\n");
}
data::ReadFrequencyResponsesResult read_responses(const std::string& text) {
  const TemporaryFolder folder;
  write_text(folder / "r.uff", text);
  return data::read_frequency_responses(folder / "r.uff");
}

TEST(Uff, FrequenciesAreInTheUnitOfTheirLabel) {
  for (const auto& [unit, hertz] : {std::pair{"Hz", 1.0},
                                    {"HZ", 1.0},
                                    {"NONE", 1.0},
                                    {"", 1.0},
                                    {"kHz", 1000.0},
                                    {"rad/s", 0.5 / std::numbers::pi},
                                    {"RPM", 1.0 / 60.0}}) {
    const auto [all, notes] = read_responses(foreign_response(unit));
    EXPECT_THAT(notes, testing::IsEmpty()) << unit;
    EXPECT_NEAR(all.frequency.at(2), 2.0 * hertz, 1e-12 * hertz) << unit;
  }
  const auto [all, notes] = read_responses(foreign_response("wobbles"));
  EXPECT_EQ(all.frequency.at(2), 2.0);
  EXPECT_THAT(messages(notes),
              testing::ElementsAre("dataset 1: the unit \"wobbles\" of its abscissa is unknown: "
                                   "taken for Hz"));
  EXPECT_THAT(refusal_of([] { read_responses(foreign_response("mm")); }).message,
              testing::HasSubstr("the unit of its abscissa is \"mm\"; accepted are Hz, kHz"));
  EXPECT_THAT(refusal_of([] { read_responses(foreign_response("radian/sec.")); }).message,
              testing::HasSubstr("the unit of its abscissa is \"radian/sec.\"; accepted are Hz"));
  EXPECT_THAT(refusal_of([] { read_responses(foreign_response("NONE", "N", "5", 17)); }).message,
              testing::HasSubstr("its abscissa is time (specific data type 17)"));
}

TEST(Uff, TimesAreInTheUnitOfTheirLabel) {
  const std::string in_seconds = function(std::string(general) + "m", three);
  for (const auto& [unit, rate] : {std::pair{"ms", 2e7}, {"S", 2e4}, {"us", 2e10}, {"NONE", 2e4}}) {
    std::string text = in_seconds;
    text.replace(text.find("Time                 s") + 21, 1, unit);
    const auto [record, notes] = read(text);
    EXPECT_THAT(notes, testing::IsEmpty()) << unit;
    EXPECT_NEAR(record.header.sample_rate, rate, 1e-9 * rate) << unit;
  }
  std::string text = in_seconds;
  text.replace(text.find("Time                 s") + 21, 1, "Hz");
  EXPECT_THAT(refusal_of([&] { read(text); }).message,
              testing::HasSubstr("the unit of its abscissa is \"Hz\"; accepted are s, ms and us"));
}

TEST(Uff, RealFrequencyResponsesAreRefused) {
  EXPECT_THAT(refusal_of([] { read_responses(foreign_response("Hz", "N", "2")); }).message,
              testing::HasSubstr("is a frequency response (function type 4) of real numbers (data "
                                 "type 2), without phases; expected are complex ones"));
}

TEST(Uff, FrequencyResponsesWithoutImaginaryPartsAreRefused) {
  std::string text = foreign_response("Hz");
  const std::string values =
      " -3.81956E+00 -3.56616E+00 -2.98987E+00  1.00000E+00  2.00000E+00  "
      "3.00000E+00\n";
  text.replace(text.find(values), values.size(),
               " -3.81956E+00  0.00000E+00 -2.98987E+00  0.00000E+00  2.00000E+00  0.00000E+00\n");
  EXPECT_THAT(refusal_of([&] { read_responses(text); }).message,
              testing::HasSubstr("all imaginary parts are 0"));
}

TEST(Uff, PoundsOfAForceAreForces) {
  const auto [all, notes] = read_responses(foreign_response("Hz", "lb"));
  EXPECT_EQ(all.inputs.at(0).unit, "N");
  EXPECT_NEAR(all.H[0](0, 0).real(), -3.81956 / 4.4482216152605, 1e-12);
  EXPECT_THAT(messages(notes), testing::Contains("\"lb\" is taken for lbf, pounds of force"));
}

}  // namespace
}  // namespace hydrapod::test
