/// The scripts that pictures are drawn by: what their axes and legends say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"
#include "report/gnuplot.hpp"
#include "support/run_program.hpp"

namespace hydrapod::report {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The numbers of "set xtics (1, 2, 5)".
std::vector<double> ticks_of(const std::string& script) {
  const std::string begins = "set xtics (";
  const auto at = script.find(begins);
  if (at == std::string::npos) return {};
  std::istringstream list(script.substr(at + begins.size()));
  std::vector<double> ticks;
  char comma{','};
  for (double tick{}; comma == ',' && list >> tick; list >> comma) ticks.push_back(tick);
  return ticks;
}

TEST(LogarithmicFrequencies, AreLabelledInOneWay) {
  using testing::ElementsAre;
  EXPECT_THAT(ticks_of(logarithmic_frequencies(3.052, 99.98)), ElementsAre(5, 10, 20, 50));
  EXPECT_THAT(ticks_of(logarithmic_frequencies(0.5, 100.0)),
              ElementsAre(0.5, 1, 2, 5, 10, 20, 50, 100));
  EXPECT_THAT(ticks_of(logarithmic_frequencies(0.013, 513.0)), ElementsAre(0.1, 1, 10, 100));
  EXPECT_THAT(ticks_of(logarithmic_frequencies(4.1, 31.0)), ElementsAre(5, 7, 10, 15, 20, 30));
  EXPECT_THAT(ticks_of(logarithmic_frequencies(10.3, 14.7)), ElementsAre(11, 12, 13, 14));
  EXPECT_THAT(logarithmic_frequencies(3.052, 99.98),
              HasSubstr("set logscale x\nset xrange [3.052:99.98]\n"));
}

/// Any band has enough labels, and not so many that they run into each other.
TEST(LogarithmicFrequencies, HaveFourLabelsOrMoreInAnyBand) {
  for (double from = 0.00137; from < 300.0; from *= 1.37)
    for (double ratio = 1.013; ratio < 1e6; ratio *= 1.19) {
      const auto ticks = ticks_of(logarithmic_frequencies(from, from * ratio));
      EXPECT_GE(ticks.size(), 4U) << from << " … " << from * ratio;
      EXPECT_LE(ticks.size(), 11U) << from << " … " << from * ratio;
      EXPECT_TRUE(std::ranges::is_sorted(ticks));
      ASSERT_FALSE(ticks.empty());
      EXPECT_GE(ticks.front(), 0.999 * from);
      EXPECT_LE(ticks.back(), 1.001 * from * ratio);
    }
}

/// What `draw` gives to gnuplot, of which a program of that name keeps a copy.
template <class Draw>
std::string script_of(const Draw& draw) {
  const test::TemporaryFolder folder;
  const std::string kept = (folder / "kept").string();
  test::write_text(folder / "gnuplot", "#!/bin/sh\ncp \"$1\" '" + kept + "'\n");
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const std::string before = std::getenv("PATH");
  setenv("PATH", (folder.path().string() + ":" + before).c_str(), 1);
  draw((folder / "picture.svg").string());
  setenv("PATH", before.c_str(), 1);
  return test::read_text(kept);
}

identification::FrequencyResponses responses(Eigen::Index inputs) {
  identification::FrequencyResponses r;
  for (Eigen::Index i = 0; i < inputs; ++i) r.inputs.push_back({.name = "u", .unit = "N"});
  r.outputs = {{.name = "a1", .unit = "m/s²"}};
  for (const double f : {3.1, 17.0, 99.0}) {
    r.frequency.push_back(f);
    r.H.emplace_back(Eigen::MatrixXcd::Ones(1, inputs));
    r.multiple_coherence.emplace_back(Eigen::VectorXd::Constant(1, 0.93));
    r.condition.push_back(1.7);
  }
  return r;
}

TEST(PicturesOfResponses, LabelTheirFrequenciesAsBodeDiagramsDo) {
  const std::string axis = "set xtics (5, 10, 20, 50)\n";
  EXPECT_THAT(script_of([](const auto& path) { plot_responses(responses(1), nullptr, {}, path); }),
              HasSubstr(axis));
  EXPECT_THAT(script_of([](const auto& path) { plot_coherence(responses(1), {}, path); }),
              HasSubstr(axis));
}

TEST(PicturesOfResponses, ShowNoConditionOfASingleInput) {
  const std::string condition = "condition of the inputs";
  EXPECT_THAT(script_of([](const auto& path) { plot_coherence(responses(1), {}, path); }),
              Not(HasSubstr(condition)));
  EXPECT_THAT(script_of([](const auto& path) { plot_coherence(responses(2), {}, path); }),
              HasSubstr(condition));
}

TEST(PicturesOfRecords, NameChannelsBesideTheCurvesAndEndAtTheirLastLine) {
  const data::RecordHeader header{.channels = {{.name = "a1", .unit = "g"}}, .sample_rate = 500.0};
  TraceBuilder traces(1);
  traces.add(data::Samples::Ones(7, 1));
  data::RecordOverview overview;
  overview.spectrum = {.frequency = Eigen::VectorXd::LinSpaced(251, 0.0, 250.0),
                       .density = Eigen::MatrixXd::Ones(251, 1),
                       .segments = 3};
  const auto script =
      script_of([&](const auto& path) { plot_record(header, traces, overview, {0}, path); });
  EXPECT_THAT(script, AllOf(HasSubstr("unset key\n"), HasSubstr("set label 2 'a1' at graph 0,1"),
                            HasSubstr("set xrange [1:250]\nset xtics (1, 2, 5, 10, 20, 50, 100, "
                                      "200)\n"),
                            Not(HasSubstr("title 'a1'"))));
}

/// One branch that moves to the left with the value, at 20 rad/s; today it is at its beginning.
TEST(PicturesOfRootLoci, HaveDampingRaysArrowsAndTheMachineOfToday) {
  RootLocus locus{.key = "controller.gain", .today_value = 10.2};
  const auto at = [](double real, double imaginary) {
    simulation::SystemPoles poles;
    poles.poles.push_back({.pole = {real, imaginary}});
    return poles;
  };
  for (int k = 0; k < 4; ++k) {
    locus.values.push_back(10.0 + k);
    locus.poles.push_back(at(-1.0 - 0.2 * k, 20.0));
  }
  locus.today = at(-1.05, 20.0);
  const auto draw = [&](const auto& path) { plot_root_locus(locus, "Machine", "gain", path); };
  const auto script = script_of(draw);
  EXPECT_THAT(script, AllOf(HasSubstr("set label '1 %' at "), HasSubstr("set label '5 %' at "),
                            HasSubstr("set arrow from -1.2,20 to -1.3,20 head filled"),
                            HasSubstr("$today << "), HasSubstr("-1.05 20\n"),
                            HasSubstr("title 'today: 10.2'")));
  // a cross in the plane that is no pole would look like one, right of the axis like an unstable
  // one
  EXPECT_THAT(script, AllOf(HasSubstr("set key at screen "), Not(HasSubstr("set key at graph "))));
  locus.today = {};
  EXPECT_THAT(script_of(draw), Not(HasSubstr("$today")));
}

TEST(PicturesOfDiagnoses, SayAtWhichPoseAModeWasMeasured) {
  diagnosis::CaseFile file;
  auto& d = file.diagnosis.emplace();
  d.hypotheses.resize(1);
  for (const char* pose : {"low", "low", "it's high"})
    d.modes.push_back({.pose = pose, .direction = 1, .omega = 37.0, .omega_best = 38.0});
  const auto draw = [&](const auto& path) { plot_diagnosis(file, path); };
  EXPECT_THAT(script_of(draw),
              AllOf(HasSubstr("set label 'low' at first 1.5, graph 0"),
                    HasSubstr("set label 'it''s high' at first 3.0, graph 0"),
                    HasSubstr("set arrow from first 2.5,"), Not(HasSubstr("set key inside"))));
  for (auto& mode : d.modes) mode.pose = "low";
  EXPECT_THAT(script_of(draw), Not(HasSubstr("'low'"))) << "one pose needs no name";
}

}  // namespace
}  // namespace hydrapod::report
