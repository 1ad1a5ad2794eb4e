/// `hydrapod record`: from the outside, as people call it.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support/json_fields.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;
using testing::HasSubstr;

/// 10 s at 1 kHz: a sine of 40 Hz, one of 180 Hz that is clipped, a constant with gaps.
data::Record example() {
  data::Record record;
  record.header.title = "Example";
  record.header.channels = {{"slow", "m", data::Direction::x, data::Role::excitation, 0},
                            {"clipped", "m/s^2", data::Direction::z, data::Role::response, 3},
                            {"gappy", "Pa", data::Direction::leg2, data::Role::response, 0}};
  record.header.sample_rate = 1000.0;
  record.header.start = 5.0;
  record.samples.resize(10000, 3);
  for (Eigen::Index k = 0; k < 10000; ++k) {
    const double t = 0.001 * static_cast<double>(k);
    record.samples(k, 0) = 0.01 * std::sin(two_pi * 40.0 * t);
    record.samples(k, 1) = std::clamp(3.0 * std::sin(two_pi * 7.0 * t + 0.1), -2.0, 2.0);
    record.samples(k, 2) = k % 1000 < 3 ? std::nan("") : 1e5 * std::cos(two_pi * 3.0 * t);
  }
  return record;
}

class Record : public testing::Test {
 protected:
  Record() { data::write_record(file("run.h5"), example(), data::RecordFormat::hdf5); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] RunResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "record");
    return run_hydrapod(arguments, {.folder = folder_.path()});
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Record, ShowTellsLevelsClippingAndDropOuts) {
  const Json json = json_of({"record", "show", file("run.h5"), "--format", "json"});
  EXPECT_EQ(json["kind"], "record");
  EXPECT_EQ(json["samples"], 10000);
  EXPECT_EQ(json["duration_s"], 10.0);
  const Json& channels = json["channels"];
  EXPECT_NEAR(channels[0]["rms"], 0.01 / std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(channels[0]["at_limit"], 0);
  EXPECT_NEAR(channels[0]["strongest_frequency_hz"], 40.0, 0.25);
  EXPECT_GT(channels[1]["at_limit"], 4000);  // |sin| > 2/3 for 53 % of the time
  EXPECT_EQ(channels[2]["missing"], 30);
  EXPECT_EQ(channels[2]["direction"], "leg 2");
}

void add_names(const Json& json, std::set<std::string>& names) {
  if (json.is_array())
    for (const auto& item : json) add_names(item, names);
  if (!json.is_object()) return;
  for (const auto& [name, value] : json.items()) {
    names.insert(name);
    add_names(value, names);
  }
}

TEST_F(Record, TheManualNamesEveryFieldOfTheJson) {
  std::set<std::string> names;
  add_names(json_of({"record", "show", file("run.h5"), "--format", "json", "--spectra"}), names);
  EXPECT_GT(names.size(), 30U);
  const std::string manual = read_text(source_file("docs/howto/json.md"));
  const std::string part = manual.substr(manual.find("## `record show`"));
  for (const std::string& name : names)
    EXPECT_TRUE(part.find('`' + name + '`') != std::string::npos ||
                part.find('`' + name + "[]`") != std::string::npos)
        << name;
}

TEST_F(Record, ShowPrintsATable) {
  const auto shown = run({"show", "run.h5"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("3 channels, 10000 samples at 1000 Hz: 10 s from 5 s (hdf5)"));
  EXPECT_THAT(shown.out, HasSubstr("at limit"));
}

TEST_F(Record, ConvertsToEveryFormatAndBack) {
  for (const char* name : {"a.mat", "a.csv", "a.uff", "a.hdf5"}) {
    EXPECT_EQ(run({"convert", "run.h5", "-o", name}).exit_code, 0) << name;
    EXPECT_EQ(run({"convert", name, "-o", "back.h5", "--force"}).exit_code, 0) << name;
    EXPECT_EQ(read_text(file("back.h5")), read_text(file("run.h5"))) << name;
  }
  EXPECT_EQ(run({"convert", "run.h5", "--format", "mat73", "-o", "b.mat"}).exit_code, 0);
  EXPECT_EQ(run({"convert", "b.mat", "-o", "back.h5", "--force"}).exit_code, 0);
  EXPECT_EQ(read_text(file("back.h5")), read_text(file("run.h5")));
}

TEST_F(Record, RecoversWhatIsLeft) {
  for (const char* format : {"hdf5", "mat73"}) {
    EXPECT_EQ(run({"convert", "run.h5", "--format", format, "-o", "whole", "--force"}).exit_code,
              0);
    const std::string whole = read_text(file("whole"));
    for (const double share : {0.3, 0.6, 0.9}) {
      const auto bytes = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
      write_text(file("cut"), whole.substr(0, bytes));
      for (const char* rest : {"rest.h5", "rest.mat", "rest.csv"}) {
        const auto result = run({"recover", "cut", "-o", rest, "--force"});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        const auto [read, notes] = data::read_record(file(rest));
        const auto rows = read.samples.rows();
        EXPECT_GT(static_cast<double>(rows), share * 10'000.0 - 2'000.0);
        EXPECT_LT(rows, 10'000);
        EXPECT_THAT(
            result.err,
            HasSubstr(fmt::format("cut: {} of 10000 samples were read; the checksum is one of the "
                                  "whole record and cannot vouch for a part\nwrote {}: {} samples",
                                  rows, rest, rows)));
        EXPECT_EQ(read.samples.col(0), example().samples.col(0).head(rows));
        EXPECT_THAT(read.header.notes, testing::MatchesRegex("recovered by hydrapod [0-9.]+ from "
                                                             "cut, which was written with 10000 "
                                                             "samples\n"));
      }
    }
  }
}

TEST_F(Record, RecoverSaysWhatTheChecksumSays) {
  const auto sound = run({"recover", "run.h5", "-o", "same.h5"});
  EXPECT_EQ(sound.exit_code, 0);
  EXPECT_THAT(sound.err, HasSubstr("run.h5: all 10000 samples were read; the checksum holds\n"));
  EXPECT_EQ(run({"convert", "run.h5", "-o", "run.csv"}).exit_code, 0);
  const std::string text = read_text(file("run.csv"));
  write_text(file("cut.csv"), text.substr(0, text.size() / 2));
  EXPECT_THAT(run({"recover", "cut.csv", "-o", "rest.h5"}).err,
              HasSubstr(" samples were read; the file does not say how many there were; no "
                        "checksum vouches for what was read\n"));
  const auto own = run({"recover", "run.h5", "-o", "./run.h5", "--force"});
  EXPECT_EQ(own.exit_code, 2);
  EXPECT_THAT(own.err, HasSubstr("is the input"));
  write_text(file("short.h5"), read_text(file("run.h5")).substr(0, 300));
  const auto nothing = run({"recover", "short.h5", "-o", "none.h5"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_EQ(nothing.err,
            "short.h5: error: nothing can be recovered: no index of samples is found: the file is "
            "cut off "
            "before it, or another program wrote it\n");
  EXPECT_FALSE(std::filesystem::exists(file("none.h5")));
}

/// Of a file that was cut off within its samples. A checksum of the whole record vouches for no
/// part and condemns none.
TEST_F(Record, RecoverSaysOfAPartWhatIsKnown) {
  const std::string whole = "the checksum is one of the whole record and cannot vouch for a part\n",
                    none = "no checksum vouches for what was read\n",
                    fewer = "cut: [0-9]+ of 10000 samples were read; ",
                    uneven = "cut: 10000 samples were read, not of all channels; ";
  const std::vector<std::pair<const char*, std::string>> said{
      {"hdf5", fewer + whole},
      {"mat73", fewer + whole},
      {"mat5", fewer + whole},
      {"csv", "cut: [0-9]+ samples were read; the file does not say how many there were; " + none},
      {"uff", uneven + whole},
      {"uff-ascii", uneven + none},
      {"rpc", fewer + none},
      {"rpc-short", fewer + none}};
  for (const auto& [format, words] : said) {
    EXPECT_EQ(run({"convert", "run.h5", "--format", format, "-o", "whole", "--force"}).exit_code,
              0);
    const std::string text = read_text(file("whole"));
    write_text(file("cut"), text.substr(0, text.size() * 3 / 4));
    const auto result = run({"recover", "cut", "-o", "rest.h5", "--force"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, testing::ContainsRegex(words)) << format;
    EXPECT_THAT(result.err, testing::Not(HasSubstr("checksum does not hold"))) << format;
    const auto complete = run({"recover", "whole", "-o", "rest.h5", "--force"});
    const bool summed = words.ends_with(whole) || format == std::string("csv");
    EXPECT_THAT(complete.err, HasSubstr("whole: all 10000 samples were read; " +
                                        (summed ? std::string("the checksum holds\n") : none)))
        << format;
  }
}

TEST_F(Record, RecoverCountsASingleSampleAsOne) {
  EXPECT_EQ(run({"cut", "run.h5", "--to", "5.001", "-o", "one.csv"}).exit_code, 0);
  EXPECT_EQ(data::read_record(file("one.csv")).record.samples.rows(), 1);
  EXPECT_THAT(run({"recover", "one.csv", "-o", "same.h5"}).err,
              testing::EndsWith("one.csv: the only sample was read; the checksum holds\n"
                                "wrote same.h5: 1 sample\n"));
}

TEST_F(Record, RecoverSaysWhereTheChecksumDoesNotHold) {
  EXPECT_EQ(run({"convert", "run.h5", "-o", "run.mat"}).exit_code, 0);
  std::string text = read_text(file("run.mat"));
  text[text.size() - 1001] = static_cast<char>(text[text.size() - 1001] ^ 4);
  write_text(file("run.mat"), text);
  EXPECT_THAT(run({"recover", "run.mat", "-o", "rest.h5"}).err,
              HasSubstr("run.mat: all 10000 samples were read; the checksum does not hold: not all "
                        "is what was written\n"));
}

TEST_F(Record, ConvertsToRpcAndSaysWhatIntegersCannotHold) {
  EXPECT_EQ(run({"convert", "run.h5", "-o", "a.rsp"}).exit_code, 0);
  const auto floats = data::read_record(file("a.rsp")).record;
  ASSERT_EQ(floats.samples.rows(), 10000);
  EXPECT_EQ(floats.header.start, 5.0);
  const auto whole = example();
  for (Eigen::Index k = 0; k < 10000; ++k)
    EXPECT_EQ(floats.samples(k, 1), static_cast<double>(static_cast<float>(whole.samples(k, 1))));
  const auto shorts = run({"convert", "run.h5", "--format", "rpc-short", "-o", "b.rsp"});
  EXPECT_EQ(shorts.exit_code, 0);
  EXPECT_THAT(shorts.err, HasSubstr("channel \"gappy\": 30 missing samples are written as the last "
                                    "one before them"));
  EXPECT_THAT(run({"show", "b.rsp"}).out, HasSubstr("(rpc-short)"));
}

/// One name for the sample rate of a file in every command; earlier names still work.
TEST_F(Record, TheRateOfAFileHasOneName) {
  write_text(file("no-rate.csv"), "1;2\n3;4\n5;6\n");
  for (const char* option : {"--rate", "--sample-rate", "--file-rate"})
    for (const auto& command :
         {std::vector<std::string>{"show", "no-rate.csv"},
          {"convert", "no-rate.csv", "-o", "x.h5", "--force"},
          {"resample", "no-rate.csv", "--new-rate", "50", "-o", "x.h5", "--force"}}) {
      auto arguments = command;
      arguments.insert(arguments.end(), {option, "100"});
      EXPECT_EQ(run(arguments).exit_code, 0) << command[0] << ' ' << option;
    }
  for (const char* command : {"show", "convert", "cut", "resample", "plot"}) {
    const auto help = run({command, "--help"}).out;
    EXPECT_THAT(help, HasSubstr("--rate")) << command;
    EXPECT_THAT(help, testing::Not(HasSubstr("--file-rate"))) << command;
    EXPECT_THAT(help, testing::Not(HasSubstr("--sample-rate"))) << command;
  }
  const auto old = run({"resample", "run.h5", "--rate", "170", "-o", "r.h5"});
  EXPECT_EQ(old.exit_code, 2);
  EXPECT_THAT(old.err, HasSubstr("--new-rate: error: the new sample rate in Hz is missing"));
}

/// Of 3000 samples, segments are shorter than of a long record.
TEST_F(Record, SpectraDoNotDependOnTheFormat) {
  data::Record record = example();
  record.samples.conservativeResize(3000, Eigen::NoChange);
  data::write_record(file("short.h5"), record, data::RecordFormat::hdf5);
  data::write_record(file("short.csv"), record, data::RecordFormat::csv);
  const auto channels_of = [&](const char* name) {
    return json_of({"record", "show", file(name), "--format", "json"})["channels"];
  };
  const Json table = channels_of("short.csv"), arrays = channels_of("short.h5");
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_EQ(table[c]["strongest_frequency_hz"], arrays[c]["strongest_frequency_hz"]) << c;
}

TEST_F(Record, RatesMayHaveAUnit) {
  write_text(file("no-rate.csv"), "a,b\n1,4\n2,5\n4,3\n8,9\n");
  const auto shown = run({"show", "no-rate.csv", "--rate", "0.2 kHz"});
  EXPECT_EQ(shown.exit_code, 0);
  EXPECT_THAT(shown.out, HasSubstr("4 samples at 200 Hz"));
  EXPECT_EQ(run({"resample", "run.h5", "--new-rate", "0.17 kHz", "-o", "k.h5"}).exit_code, 0);
  EXPECT_EQ(data::read_record(file("k.h5")).record.header.sample_rate, 170.0);
  const auto wrong = run({"show", "no-rate.csv", "--rate", "200 mm"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("expected a frequency such as"));
}

TEST_F(Record, OfResponsesItPointsToIdentify) {
  write_text(file("h.csv"), "Hz,re a/F [m/N],im a/F [m/N]\n1,2,3\n2,4,5\n");
  const auto shown = run({"show", "h.csv"});
  EXPECT_EQ(shown.exit_code, 2);
  EXPECT_THAT(shown.err, HasSubstr("`hydrapod identify` finds their modes"));
}

TEST_F(Record, CutKeepsTheTimesAndChannelsAskedFor) {
  EXPECT_EQ(run({"cut", "run.h5", "--from", "6 s", "--to", "6500 ms", "--role", "response",
                 "--channel", "*p*", "-o", "c.h5"})
                .exit_code,
            0);
  const auto piece = data::read_record(file("c.h5")).record;
  EXPECT_EQ(piece.header.start, 6.0);
  ASSERT_EQ(piece.samples.rows(), 500);
  ASSERT_EQ(piece.header.channels.size(), 2U);
  EXPECT_EQ(piece.header.channels[0].name, "clipped");
  const auto whole = example();
  for (Eigen::Index k = 0; k < 500; ++k) EXPECT_EQ(piece.samples(k, 0), whole.samples(k + 1000, 1));
}

TEST_F(Record, CutSaysWhatIsWrong) {
  EXPECT_THAT(run({"cut", "run.h5", "--channel", "clippd", "-o", "c.h5"}).err,
              HasSubstr("--channel clippd: error: the record has no such channel; did you mean "
                        "'clipped'?"));
  const auto late = run({"cut", "run.h5", "--from", "100", "-o", "c.h5"});
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_THAT(late.err, HasSubstr("no sample lies there; the record begins at 5 s and has 10 s"));
  EXPECT_FALSE(std::filesystem::exists(file("c.h5")));
}

/// The length of a table is not known before its end.
TEST_F(Record, CutOutsideATableLeavesWhatWasWritten) {
  data::write_record(file("run.csv"), example(), data::RecordFormat::csv);
  write_text(file("c.h5"), "good");
  const auto late =
      run({"cut", "run.csv", "--from", "300", "--to", "400", "-o", "c.h5", "--force"});
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_THAT(late.err, HasSubstr("no sample lies there; the record begins at 5 s and has 10 s"));
  EXPECT_EQ(read_text(file("c.h5")), "good");
}

TEST_F(Record, CutSaysThatTheRecordEndsBefore) {
  const auto part = run({"cut", "run.h5", "--from", "14", "--to", "20", "-o", "c.h5"});
  EXPECT_EQ(part.exit_code, 0);
  EXPECT_THAT(part.err, HasSubstr("the record ends at 15 s, before --to 20"));
  EXPECT_EQ(data::read_record(file("c.h5")).record.samples.rows(), 1000);
  EXPECT_THAT(run({"cut", "run.h5", "--from", "14", "--to", "15", "-o", "d.h5"}).err,
              testing::Not(HasSubstr("ends at")));
}

TEST_F(Record, ResampleKeepsWhatIsBelowTheNewNyquistFrequency) {
  EXPECT_EQ(run({"resample", "run.h5", "--new-rate", "170", "-o", "r.h5"}).exit_code, 0);
  const auto slow = data::read_record(file("r.h5")).record;
  EXPECT_EQ(slow.header.sample_rate, 170.0);
  EXPECT_EQ(slow.samples.rows(), 1700);
  for (Eigen::Index k = 200; k < 1500; ++k)
    EXPECT_NEAR(slow.samples(k, 0), 0.01 * std::sin(two_pi * 40.0 * static_cast<double>(k) / 170.0),
                1e-5 * 0.01);
}

TEST_F(Record, PlotDrawsAPicture) {
  const auto plot = run({"plot", "run.h5", "-o", "p.svg"});
  EXPECT_EQ(plot.exit_code, 0) << plot.err;
  EXPECT_THAT(read_text(file("p.svg")), HasSubstr("<svg"));
}

TEST_F(Record, WrongInputIsExitCodeTwo) {
  EXPECT_THAT(run({"show", "none.h5"}).err,
              HasSubstr("none.h5: error: cannot read the file: No such file or directory"));
  EXPECT_EQ(run({"convert", "run.h5", "-o", "x.docx"}).exit_code, 2);
  EXPECT_EQ(run({"convert", "run.h5", "-o", "no/such/folder.h5"}).exit_code, 2);
  EXPECT_EQ(run({"resample", "run.h5", "--new-rate", "-3", "-o", "r.h5"}).exit_code, 2);
  EXPECT_EQ(run({"plot", "run.h5", "-o", "p.bmp"}).exit_code, 2);
  write_text(file("no-rate.csv"), "1;2\n3;4\n");
  EXPECT_THAT(run({"show", "no-rate.csv"}).err, HasSubstr("give the rate in Hz with --rate"));
  EXPECT_EQ(run({"show", "no-rate.csv", "--rate", "100"}).exit_code, 0);
}

TEST_F(Record, VerifyGoesOnAfterFilesThatCannotBeRead) {
  write_text(file("cells.csv"), "time_s,a\n0.0,left\n0.1,right\n");
  const auto whole = read_text(file("run.h5"));
  write_text(file("short.h5"), whole.substr(0, 700));
  const auto all = run({"verify", "cells.csv", "run.h5", "missing.h5", "short.h5", "run.h5"});
  EXPECT_EQ(all.exit_code, 2);
  EXPECT_THAT(all.out,
              HasSubstr("run.h5: 10000 samples of 3 channels: the checksum holds\nrun.h5"));
  for (const char* name : {"cells.csv", "missing.h5", "short.h5"})
    EXPECT_THAT(all.err, HasSubstr(name));
  EXPECT_THAT(all.err, testing::EndsWith("the checksum holds in 2 of 5 files; 3 cannot be read\n"));
  auto damaged = whole;
  damaged[damaged.size() / 2] ^= 0x10;
  write_text(file("damaged.h5"), damaged);
  const auto readable = run({"verify", "damaged.h5", "run.h5"});
  EXPECT_EQ(readable.exit_code, 1);
  EXPECT_THAT(readable.err, testing::EndsWith("the checksum holds in 1 of 2 files\n"));
}

}  // namespace
}  // namespace hydrapod::test
