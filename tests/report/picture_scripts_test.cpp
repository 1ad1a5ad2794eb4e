/// The scripts that pictures are drawn by: what their axes and legends say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <functional>
#include <numbers>
#include <sstream>

#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"
#include "report/gnuplot.hpp"
#include "support/picture_script.hpp"
#include "support/run_program.hpp"

namespace hydrapod::report {
namespace {

using test::script_of;
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
  EXPECT_THAT(ticks_of(logarithmic_axis(3.052, 99.98)), ElementsAre(5, 10, 20, 50));
  EXPECT_THAT(ticks_of(logarithmic_axis(0.5, 100.0)), ElementsAre(0.5, 1, 2, 5, 10, 20, 50, 100));
  EXPECT_THAT(ticks_of(logarithmic_axis(0.013, 513.0)), ElementsAre(0.1, 1, 10, 100));
  EXPECT_THAT(ticks_of(logarithmic_axis(4.1, 31.0)), ElementsAre(5, 7, 10, 15, 20, 30));
  EXPECT_THAT(ticks_of(logarithmic_axis(10.3, 14.7)), ElementsAre(11, 12, 13, 14));
  EXPECT_THAT(logarithmic_axis(3.052, 99.98),
              HasSubstr("set logscale x\nset xrange [3.052:99.98]\n"));
}

/// Any band has enough labels, and not so many that they run into each other.
TEST(LogarithmicFrequencies, HaveFourLabelsOrMoreInAnyBand) {
  for (double from = 0.00137; from < 300.0; from *= 1.37)
    for (double ratio = 1.013; ratio < 1e6; ratio *= 1.19) {
      const auto ticks = ticks_of(logarithmic_axis(from, from * ratio));
      EXPECT_GE(ticks.size(), 4U) << from << " … " << from * ratio;
      EXPECT_LE(ticks.size(), 11U) << from << " … " << from * ratio;
      EXPECT_TRUE(std::ranges::is_sorted(ticks));
      ASSERT_FALSE(ticks.empty());
      EXPECT_GE(ticks.front(), 0.999 * from);
      EXPECT_LE(ticks.back(), 1.001 * from * ratio);
    }
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
  const auto script = script_of(
      [&](const auto& path) { plot_record(header, traces, overview, {0}, "run.h5", path); });
  EXPECT_THAT(script, AllOf(HasSubstr("unset key\n"), HasSubstr("set label 2 'a1' at graph 0,1"),
                            HasSubstr("set xrange [1:250]\nset xtics (1, 2, 5, 10, 20, 50, 100, "
                                      "200)\n"),
                            Not(HasSubstr("title 'a1'"))));
}

/// The lines of `$name << END … END`.
std::vector<std::string> block_in(const std::string& script, const std::string& name) {
  const std::string begins = "$" + name + " << END\n";
  std::istringstream text(script.substr(script.find(begins) + begins.size()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line) && line != "END";) lines.push_back(line);
  return lines;
}

// An SVG of 24 channels with the lines of every sample was of 5 MB.
TEST(PicturesOfRecords, HaveNoMorePointsThanPixels) {
  const data::RecordHeader header{.channels = {{.name = "a1", .unit = "g"}}, .sample_rate = 500.0};
  TraceBuilder traces(1);
  traces.add(data::Samples::Random(37000, 1));
  data::RecordOverview overview;
  overview.spectrum = {.frequency = Eigen::VectorXd::LinSpaced(8193, 0.0, 250.0),
                       .density = Eigen::MatrixXd::Constant(8193, 1, 0.01),
                       .segments = 3};
  overview.spectrum.density(7001, 0) = 10.0;  // a line of its own is not lost
  const auto script = script_of(
      [&](const auto& path) { plot_record(header, traces, overview, {0}, "run.h5", path); });
  EXPECT_LE(block_in(script, "traces").size(), 800U);
  EXPECT_GE(block_in(script, "traces").size(), 400U);
  const auto spectrum = block_in(script, "spectra");
  EXPECT_LE(spectrum.size(), 400U);
  EXPECT_GE(spectrum.size(), 200U);
  EXPECT_EQ(
      std::ranges::count_if(spectrum, [](const auto& line) { return line.ends_with(" 10.000"); }),
      1);
}

/// A line for each Hz. The output follows from the input up to `heard`.
identification::FrequencyResponses heard_up_to(int heard, int lines,
                                               const std::function<double(int)>& magnitude) {
  auto r = responses(1);
  r.frequency.clear();
  r.H.clear();
  r.multiple_coherence.clear();
  r.condition.clear();
  for (int k = 1; k <= lines; ++k) {
    r.frequency.push_back(k);
    r.H.emplace_back(Eigen::MatrixXcd::Constant(1, 1, magnitude(k)));
    r.multiple_coherence.emplace_back(Eigen::VectorXd::Constant(1, k <= heard ? 0.98 : 0.11));
    r.condition.push_back(1.7);
  }
  r.averages = 9.7;
  return r;
}

// Above a hundredth of 500 Hz most of a logarithmic axis showed noise.
TEST(PicturesOfResponses, EndWhereNoiseBegins) {
  auto r = heard_up_to(80, 500, [](int k) { return k == 61 ? 1000.0 : 1.0; });
  const auto both = [&](const std::string& expected) {
    EXPECT_THAT(script_of([&](const auto& path) { plot_responses(r, nullptr, {}, path); }),
                HasSubstr(expected));
    EXPECT_THAT(script_of([&](const auto& path) { plot_coherence(r, {}, path); }),
                HasSubstr(expected));
  };
  both("set xrange [1:100]\n");
  both("; beyond 100 Hz there is noise alone");
  const auto lines =
      block_in(script_of([&](const auto& path) { plot_responses(r, nullptr, {}, path); }), "frf");
  EXPECT_EQ(
      std::ranges::count_if(
          lines, [](const auto& line) { return line.find(" 60.0000 ") != std::string::npos; }),
      1)
      << "a resonance of one line is shown";
  for (auto& c : r.multiple_coherence) c[0] = 0.11;  // nothing is coherent: all is shown
  both("set xrange [1:500]\n");
  r.averages = 0.0;  // of a file of another program
  r.multiple_coherence.clear();
  EXPECT_THAT(script_of([&](const auto& path) { plot_responses(r, nullptr, {}, path); }),
              HasSubstr("set xrange [1:500]\n"));
}

// Beyond an excitation noise is divided by noise: quotients 50 dB above all others.
TEST(PicturesOfResponses, NoiseDoesNotSetTheScale) {
  auto r = heard_up_to(60, 63, [](int k) { return k > 60 ? 300.0 : k == 20 ? 10.0 : 1.0; });
  const auto draw = [&](const auto& path) { plot_responses(r, nullptr, {}, path); };
  EXPECT_THAT(script_of(draw), HasSubstr("set yrange [-3.200:21.600]\n"));
  r.averages = 0.0;  // of a file of another program: nothing is known of noise
  EXPECT_THAT(script_of(draw), HasSubstr("set autoscale y\n"));
}

TEST(PicturesOfRecords, HaveUnitsThatFitTheNumbers) {
  const data::RecordHeader header{.title = "Rig",
                                  .channels = {{.name = "pressure", .unit = "Pa"},
                                               {.name = "length", .unit = "m"},
                                               {.name = "angle", .unit = "rad"},
                                               {.name = "load", .unit = "N"}},
                                  .sample_rate = 500.0};
  TraceBuilder traces(4);
  data::Samples samples(3, 4);
  samples.col(0).setConstant(5e6);
  samples.col(1).setConstant(0.873);
  samples.col(2).setConstant(1e-3);
  samples.col(3).setConstant(-812.0);
  traces.add(samples);
  const auto script = script_of([&](const auto& path) {
    plot_record(header, traces, {}, {0, 1, 2, 3}, "run.h5; 500 samples a second", path);
  });
  EXPECT_THAT(script, AllOf(HasSubstr("set ylabel 'MPa'"), HasSubstr("set ylabel 'mm'"),
                            HasSubstr("set ylabel 'rad'"), HasSubstr("set ylabel 'N'"),
                            HasSubstr("'run.h5; 500 samples a second'"), HasSubstr("'Rig'")));
  EXPECT_EQ(block_in(script, "traces").front(), "0 5 5 873 873 0.001 0.001 -812 -812");
}

TEST(Stretches, AreEquallyWideOnTheirAxis) {
  using testing::ElementsAre;
  EXPECT_THAT(stretches_of({1, 2, 3, 4, 5, 6, 7, 9}, false, 4), ElementsAre(0, 2, 4, 6, 8));
  EXPECT_THAT(stretches_of({1, 2, 3, 4, 10, 20, 99, 100}, true, 2), ElementsAre(0, 4, 8));
  EXPECT_THAT(stretches_of({7}, true, 5), ElementsAre(0, 1));
  EXPECT_THAT(stretches_of({}, false, 5), ElementsAre(0));
}

TEST(JoinedCells, AreOnePathPerColour) {
  const std::string cell = "\t\t<polygon fill = 'rgb(194,  70, 122)' points = '";
  const std::string svg = "<g>\n" + cell + "2,5 4,5 4,4 2,4 '/>\n" + cell +
                          "2,4 4,4 4,3 2,3 '/>\n" + cell +
                          "6,4 8,4 8,3 6,3 '/>\n\t<polygon fill = 'rgb( 16,   0,   9)' points = "
                          "'4,5 6,5 6,4 4,4 '/>\n" +
                          cell + "1,1 2,2 3,1 '/>\n" + cell + "0,1 1,2 2,1 1,0 '/>\n</g>\n";
  EXPECT_EQ(joined_cells(svg),
            "<g>\n<path shape-rendering='crispEdges' fill='#100009' d='M4 4H6V5H4z'/>\n"
            "<path shape-rendering='crispEdges' fill='#c2467a' d='M2 3H4V5H2zM6 3H8V4H6z'/>\n" +
                cell + "1,1 2,2 3,1 '/>\n" + cell + "0,1 1,2 2,1 1,0 '/>\n</g>\n");
  EXPECT_EQ(joined_cells(""), "");
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

// The interval of a mode that is hardly determined was 860 %: all others were points on a line.
TEST(PicturesOfComparisons, OneModeHardlyDeterminedDoesNotSetTheScale) {
  SideBySide both;
  both.things.resize(2);
  both.comparisons.push_back({.thing = 1});
  for (int k = 0; k < 5; ++k) {
    both.things[0].modes.push_back({.omega = 100.0});
    const double deviation = k == 2 ? 400.0 : 1.0;
    both.comparisons[0].pairs.push_back({.first = k,
                                         .second = k,
                                         .frequency = {.value = 2.0, .deviation = deviation},
                                         .damping = {.value = 0.01, .deviation = 0.002}});
  }
  const auto script = script_of([&](const auto& path) { plot_side_by_side(both, path); });
  const std::string begins = "set yrange [";
  std::istringstream range(script.substr(script.find(begins) + begins.size()));
  double low{}, high{};
  char colon{};
  range >> low >> colon >> high;  // 2 % with an interval of ± 1.96 %
  EXPECT_NEAR(low, -0.4, 0.01);
  EXPECT_NEAR(high, 3.96 + 1.0, 0.1);
}

// It left the frame without any sign, as if it ended there.
TEST(PicturesOfComparisons, AnIntervalThatLeavesTheFrameIsMarked) {
  SideBySide both;
  both.things.resize(2);
  both.comparisons.push_back({.thing = 1});
  for (int k = 0; k < 3; ++k) {
    both.things[0].modes.push_back({.omega = 100.0});
    both.comparisons[0].pairs.push_back(
        {.first = k,
         .second = k,
         .frequency = {.value = 2.0, .deviation = k == 2 ? 400.0 : 1.0},
         .damping = {.value = 0.01, .deviation = 0.002}});
  }
  const auto draw = [&](const auto& path) { plot_side_by_side(both, path); };
  const auto script = script_of(draw);
  EXPECT_THAT(script, AllOf(HasSubstr("set label '±784' at 3.0000,"), HasSubstr("point pt 9"),
                            HasSubstr("point pt 11"), HasSubstr("(▲▼ beyond the frame)")));
  both.comparisons[0].pairs[2].frequency.deviation = 1.0;
  EXPECT_THAT(script_of(draw), Not(HasSubstr("±")));
}

/// The cut is where no phase is, and in the middle of the widest gap.
TEST(Phases, AreCutWhereNoneIs) {
  EXPECT_EQ(phase_cut({}), -180.0);
  EXPECT_EQ(phase_cut({0.1, -0.1}), -180.0);
  EXPECT_EQ(phase_cut({-178.0, 171.0, -37.0, 33.0}), -257.5);  // widest gap: 35° … 170°
  EXPECT_EQ(phase_cut({179.0, -179.0}), -360.0);
  EXPECT_EQ(within_turn(171.0, -255.0), -189.0);
  EXPECT_EQ(within_turn(-255.0, -255.0), -255.0);
  EXPECT_EQ(within_turn(105.0, -255.0), -255.0);
  for (double angle = -179.3; angle < 180.0; angle += 7.7) {
    const double cut = phase_cut({angle, angle + 93.1});
    EXPECT_LT(within_turn(angle, cut), within_turn(angle + 93.1, cut)) << angle;
    EXPECT_GE(cut, -360.0);
    EXPECT_LT(cut, 0.0);
  }
}

/// −178° and 171° are 11° apart: they were drawn 349° apart, with jumps.
TEST(PicturesOfComparisons, PhasesThatPassHalfATurnDoNotJump) {
  SideBySide both;
  both.things.resize(2);
  for (std::size_t t = 0; t < 2; ++t) {
    ComparedThing::Response response{.name = "x from x", .unit = "m/N"};
    for (int k = 0; k < 40; ++k) {
      response.frequency.push_back(3.0 + k);
      response.H.push_back(
          std::polar(1.3, -(5.3 * k + 11.7 * static_cast<double>(t)) * std::numbers::pi / 180.0));
    }
    both.things[t].responses.push_back(response);
  }
  const auto script = script_of([&](const auto& path) { plot_side_by_side(both, path); });
  const auto first = block_in(script, "r0_0"), second = block_in(script, "r0_1");
  ASSERT_EQ(first.size(), 40U);
  const auto degrees = [](const std::string& line) {
    return std::stod(line.substr(line.rfind(' ')));
  };
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(degrees(first[k]) - degrees(second[k]), 11.7, 1e-3);
    if (k == 0) continue;
    EXPECT_NEAR(degrees(first[k - 1]) - degrees(first[k]), 5.3, 1e-3);
  }
  EXPECT_THAT(script, HasSubstr("abs(step) > 135 ? NaN : last) with lines"));
}

TEST(PicturesOfCapability, SayWhichMachineTheyAreOf) {
  PoseCheck check;
  check.pose.name = "high";
  check.first_resonance = 16.1 * base::two_pi;
  check.capability.emplace().gain_limit = 5.46;
  check.capability->combined = {0.19, 0.21, 0.37};
  const auto script = script_of([&](const auto& path) {
    plot_capability(check, {.title = "Rig", .subtitle = "machine: nominal, with a=1"}, path);
  });
  EXPECT_THAT(script, AllOf(HasSubstr("'Rig'"), HasSubstr("; machine: nominal, with a=1'"),
                            HasSubstr("'all six directions at once: 19 % of forces,'"),
                            HasSubstr("'21 % of speeds, 37 % of accelerations'"),
                            HasSubstr("'lowest mode (|λ|): 16.1 Hz'"),
                            HasSubstr("'loop gain below 5.46 1/s; half of it:'"),
                            HasSubstr("'bandwidth 0.434 Hz'")));
}

TEST(PicturesOfDiagnoses, SayAtWhichPoseAModeWasMeasured) {
  diagnosis::CaseFile file;
  auto& d = file.diagnosis.emplace();
  d.hypotheses.resize(1);
  for (const char* pose : {"low", "low", "it's high"})
    d.modes.push_back({.pose = pose, .direction = 1, .omega = 37.0, .omega_best = 38.0});
  const auto draw = [&](const auto& path) {
    plot_diagnosis(file, "nominal machine: nominal", path);
  };
  EXPECT_THAT(script_of(draw),
              AllOf(HasSubstr("set label 'low' at first 1.5, graph 0"),
                    HasSubstr("set label 'it''s high' at first 3.0, graph 0"),
                    HasSubstr("set arrow from first 2.5,"), Not(HasSubstr("set key inside"))));
  for (auto& mode : d.modes) mode.pose = "low";
  EXPECT_THAT(script_of(draw), Not(HasSubstr("'low'"))) << "one pose needs no name";
}

}  // namespace
}  // namespace hydrapod::report
