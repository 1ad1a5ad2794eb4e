/// `hydrapod rig`: from the outside.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::HasSubstr;

class Rig : public testing::Test {
 protected:
  Rig() { run_hydrapod({"init"}, {.folder = folder_.path()}); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] RunResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"rig", "machine.toml"});
    return run_hydrapod(arguments, {.folder = folder_.path()});
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Rig, TheSameSeedGivesTheSameFile) {
  const std::vector<std::string> arguments{"--duration", "0.5", "--settling", "0.1", "-o", "a.h5"};
  EXPECT_EQ(run(arguments).exit_code, 0);
  std::filesystem::rename(file("a.h5"), file("b.h5"));  // the name stands in the record
  EXPECT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(run({"--duration", "0.5", "--settling", "0.1", "--seed", "2", "-o", "c.h5"}).exit_code,
            0);
  EXPECT_EQ(read_text(file("a.h5")), read_text(file("b.h5")));
  EXPECT_NE(read_text(file("a.h5")), read_text(file("c.h5")));
  const auto record = data::read_record(file("a.h5")).record;
  EXPECT_EQ(record.samples.rows(), 500);
  EXPECT_EQ(record.header.start, 0.1);  // after settling
  EXPECT_EQ(record.header.channels.size(), 39U);
  const auto& e = record.header.experiment;
  EXPECT_EQ(e.machine, read_text(file("machine.toml")));
  EXPECT_EQ(e.seed, 1U);
  EXPECT_EQ(e.pose_name, "neutral");
  EXPECT_THAT(e.program, testing::StartsWith("hydrapod "));
  EXPECT_THAT(e.command, testing::ElementsAre("rig", "machine.toml", "--duration", "0.5",
                                              "--settling", "0.1", "-o", "a.h5"));
  const auto sum = run_program("sha256sum", {file("machine.toml")}).out.substr(0, 64);
  EXPECT_EQ(record.header.notes, "read machine.toml: sha256 " + sum);
  EXPECT_EQ(e.excitation->entry, "command");
  EXPECT_THAT(e.excitation->signals,
              testing::ElementsAre(HasSubstr("white x=0.1 mm, y=0.1 mm, z=0.1 mm, rx=0.1 mrad")));
  EXPECT_DOUBLE_EQ(e.excitation->level[5], 1e-4);
  EXPECT_FALSE(e.excitation->period);
  EXPECT_EQ(e.sensors.size(), 9U);
  EXPECT_THAT(e.controller, HasSubstr("sample_time=0.001 s"));
}

/// A record that is identified and diagnosed for one page.
TEST_F(Rig, AReportSaysAWarningOnce) {
  ASSERT_EQ(run({"--duration", "8", "-o", "a.h5"}).exit_code, 0);
  const auto report = run_hydrapod({"report", file("machine.toml"), "--measured", file("a.h5"),
                                    "--diagnose", file("a.h5"), "-o", file("a.html")},
                                   {.timeout = 120.0});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  std::istringstream lines(report.err);
  std::vector<std::string> all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  EXPECT_GT(all.size(), 1U) << "the record is short";
  std::ranges::sort(all);
  EXPECT_EQ(std::ranges::adjacent_find(all), all.end()) << report.err;
}

/// Its 39 channels are more than a picture holds.
TEST_F(Rig, ARecordCanBePlottedAsItIs) {
  ASSERT_EQ(run({"--duration", "0.5", "--settling", "0.1", "-o", "a.h5"}).exit_code, 0);
  const auto plot = run_hydrapod({"record", "plot", file("a.h5"), "-o", file("a.svg")});
  EXPECT_EQ(plot.exit_code, 0) << plot.err;
  EXPECT_THAT(plot.err, HasSubstr("the first 24 of 39 channels are shown"));
  EXPECT_THAT(read_text(file("a.svg")), HasSubstr("<svg"));
}

TEST_F(Rig, AveragesArePeriods) {
  EXPECT_EQ(run({"--excite", "multisine z=0.1 mm, to=30, period=0.4", "--averages", "3",
                 "--settling", "0.1", "--accelerometer", "none", "-o", "m.csv"})
                .exit_code,
            0);
  const auto record = data::read_record(file("m.csv")).record;
  EXPECT_EQ(record.samples.rows(), 1200);
  EXPECT_EQ(record.header.channels.size(), 30U);
  EXPECT_THAT(run({"--averages", "3", "-o", "n.csv"}).err,
              HasSubstr("the excitation does not repeat"));
}

TEST_F(Rig, RefusesWhatThereIsNoStrokeFor) {
  const auto refused = run({"--excite", "noise ry=20 deg, to=1", "--duration", "5", "-o", "r.h5"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--excite: error: ry at this level needs "));
  EXPECT_THAT(refused.err, HasSubstr(" mm of stroke in leg "));
  EXPECT_FALSE(std::filesystem::exists(file("r.h5")));
}

TEST_F(Rig, WrongInputIsExitCodeTwo) {
  EXPECT_EQ(run({}).exit_code, 2);
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--duration", "-1", "-o", "r.h5"},
        {"--rate", "0", "-o", "r.h5"},
        {"--entry", "valve", "-o", "r.h5"},
        {"--excite", "white", "-o", "r.h5"},
        {"--excite", "multisine z=1 mm, to=900", "-o", "r.h5"},
        {"--excite", "noise z=1 mm, slope=99", "-o", "r.h5"},
        {"--accelerometer", "a, at=1 2, along=z", "-o", "r.h5"},
        {"--length-sensor", "resolution=1 kg", "-o", "r.h5"},
        {"-o", "r.docx"},
        {"-o", "no/such/folder/r.h5"}}) {
    const auto result = run(wrong);
    EXPECT_EQ(result.exit_code, 2) << wrong[1] << result.err;
    EXPECT_THAT(result.err, HasSubstr("error: "));
  }
}

}  // namespace
}  // namespace hydrapod::test
