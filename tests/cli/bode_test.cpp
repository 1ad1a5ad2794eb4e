/// `hydrapod bode`: responses, peaks and pictures.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <regex>

#include "hydrapod/base/units.hpp"
#include "support/csv.hpp"
#include "support/json_fields.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;
using test::fields;
using test::Json;
using test::json_of;
using test::run_hydrapod;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::string published = test::source_file("models/zhang-jiang-2021.toml").string();
using base::two_pi;

TEST(Bode, TableCountsTheResonancesOfThePaper) {
  const auto result = run_hydrapod({"bode", published});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("displacement from wrench; point (0, 0, -0.163) m of the platform; "),
                    HasSubstr("  with seals  x 2, y 2, z 1, rx 1, ry 1, rz 1\n"),
                    HasSubstr("  rigid legs  x 1, y 1, z 1, rx 1, ry 1, rz 1\n"),
                    HasSubstr("damping: 0.2 % of critical in every mode"), Not(HasSubstr("\033"))));
}

TEST(Bode, TableCountsOneResonanceEverywhereOnStiffSeals) {
  const auto result = run_hydrapod(
      {"bode", published, "--set", "legs.guide_sleeve.stiffness=1e9 N/m", "--to", "60"});
  EXPECT_THAT(result.out, HasSubstr("  with seals  x 1, y 1, z 1, rx 1, ry 1, rz 1\n"));
}

TEST(Bode, JsonHasItsStableFields) {
  const auto json = json_of({"bode", published, "--points", "50", "--format", "json"});
  EXPECT_THAT(fields(json),
              ElementsAre("kind", "machine", "assumptions", "pose", "model", "input", "output",
                          "point_m", "peaks", "rigid_peaks", "omega_rad_s", "frequency_hz",
                          "response", "rigid_response", "reproduction"));
  EXPECT_EQ(json["kind"], "bode");
  EXPECT_EQ(json["input"], "wrench");
  EXPECT_EQ(json["output"], "displacement");
  EXPECT_EQ(json["omega_rad_s"].size(), 50U);
  EXPECT_DOUBLE_EQ(json["frequency_hz"][7].get<double>() * two_pi,
                   json["omega_rad_s"][7].get<double>());
  for (const char* response : {"response", "rigid_response"}) {
    EXPECT_THAT(fields(json[response]), ElementsAre("x", "y", "z", "rx", "ry", "rz"));
    EXPECT_THAT(fields(json[response]["ry"]), ElementsAre("x", "y", "z", "rx", "ry", "rz"));
    EXPECT_THAT(fields(json[response]["ry"]["x"]), ElementsAre("re", "im"));
    EXPECT_EQ(json[response]["ry"]["x"]["re"].size(), 50U);
  }
  const Json& peak = json["peaks"][0];
  EXPECT_THAT(fields(peak), ElementsAre("direction", "omega_rad_s", "frequency_hz", "magnitude",
                                        "prominence_db", "mode", "label", "own"));
  EXPECT_EQ(peak["direction"], "x");
  EXPECT_NEAR(peak["omega_rad_s"].get<double>(), 46.780, 0.002);
  EXPECT_EQ(peak["mode"], 1);
  EXPECT_EQ(peak["own"], true);
  EXPECT_TRUE(peak["prominence_db"].is_null()) << "the highest peak has no valley to stand over";
}

Json sweep(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"bode", published, "--points", "5",        "--from",
                                     "3",    "--to",    "5",        "--format", "json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return json_of(arguments);
}

std::complex<double> at(const Json& json, const char* out, const char* in, size_t i) {
  const Json& entry = json["response"][out][in];
  return {entry["re"][i], entry["im"][i]};
}

TEST(Bode, OutputIsDifferentiated) {
  const auto x = sweep({}), v = sweep({"--output", "velocity"}),
             a = sweep({"--output", "acceleration"});
  EXPECT_EQ(a["output"], "acceleration");
  for (size_t i = 0; i < 5; ++i) {
    const double omega = x["omega_rad_s"][i];
    const auto base = at(x, "x", "x", i);
    EXPECT_LE(std::abs(at(v, "x", "x", i) - std::complex(0.0, omega) * base),
              1e-14 * std::abs(omega * base));
    EXPECT_LE(std::abs(at(a, "x", "x", i) + omega * omega * base),
              1e-14 * std::abs(omega * omega * base));
  }
}

TEST(Bode, ActuatorForcesOfStraightLegsAreWrenches) {
  const auto wrench = sweep({}), actuator = sweep({"--input", "actuator"});
  EXPECT_EQ(actuator["input"], "actuator");
  EXPECT_LE(std::abs(at(wrench, "x", "x", 2) - at(actuator, "x", "x", 2)),
            1e-12 * std::abs(at(wrench, "x", "x", 2)));
}

TEST(Bode, FrequenciesAreHertzUnlessTheyHaveAUnit) {
  const auto band = [](const std::string& from, const std::string& to) {
    const auto json = json_of(
        {"bode", published, "--points", "3", "--from", from, "--to", to, "--format", "json"});
    return std::pair<double, double>(json["frequency_hz"].front(), json["frequency_hz"].back());
  };
  const auto near = [](double from, double to) {
    return testing::Pair(testing::DoubleNear(from, 1e-12 * from),
                         testing::DoubleNear(to, 1e-12 * to));
  };
  EXPECT_THAT(band("2", "20"), near(2.0, 20.0));
  EXPECT_THAT(band("2 Hz", "0.02 kHz"), near(2.0, 20.0));
  EXPECT_THAT(band("30 rad/s", "20"), near(30.0 / two_pi, 20.0));
}

TEST(Bode, PointIsOfThePlatform) {
  EXPECT_EQ(sweep({"--point", "0,0,-163 mm"})["response"], sweep({})["response"]);
  const auto above = sweep({"--point", "0.1,0,0.5 m"});
  EXPECT_THAT(above["point_m"], ElementsAre(0.1, 0.0, 0.5));
  EXPECT_NE(above["response"]["x"], sweep({})["response"]["x"]);
  EXPECT_NEAR(std::abs(at(above, "rx", "rx", 1) / at(sweep({}), "rx", "rx", 1)), 1.0, 1e-9)
      << "rotations are the same everywhere on it";
}

/// As in a machine file, where the table of parameters says so.
TEST(Bode, APointFarOffThePlatformIsProbablyInMillimetres) {
  const auto run = run_hydrapod({"bode", published, "--points", "5", "--point", "0,-250,300"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(
      run.err,
      "--point 0,-250,300: warning: y is -250 m, usual are 0.0001 m to 50 m; did you mean -250 "
      "mm?\n");
  EXPECT_EQ(run_hydrapod({"bode", published, "--points", "5", "--point", "0,0,3"}).err, "");
}

TEST(Bode, CsvIsWellFormed) {
  const auto result = run_hydrapod({"bode", published, "--points", "7", "--format", "csv"});
  ASSERT_EQ(result.exit_code, 0);
  const auto rows = test::parse_csv(result.out);
  ASSERT_EQ(rows.size(), 8U) << "a header and a line per frequency";
  EXPECT_EQ(rows[0].size(), 2U + 2U * 36U * 2U);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[0][0], "frequency_hz");
  EXPECT_EQ(rows[0][2], "re x/x [m/N]");
  EXPECT_EQ(rows[0][4], "re x/y [m/N]");
  EXPECT_EQ(rows[0].back(), "rigid im rz/rz [rad/(N m)]");
  const auto json = json_of({"bode", published, "--points", "7", "--format", "json"});
  EXPECT_NEAR(std::stod(rows[3][2]), at(json, "x", "x", 2).real(),
              1e-11 * std::abs(at(json, "x", "x", 2)));
}

TEST(Bode, WithoutDampingSaysThatPeaksAreUnbounded) {
  const auto result = run_hydrapod({"bode", published, "--set", "damping.modal_ratio=0"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("damping: none"), HasSubstr("unbounded"),
                                Not(HasSubstr(" nan")), Not(HasSubstr(" inf"))));
  const auto json = json_of(
      {"bode", published, "--set", "damping.modal_ratio=0", "--points", "9", "--format", "json"});
  EXPECT_TRUE(json["peaks"][0]["magnitude"].is_null());
}

TEST(Bode, WithoutPeaksInTheBandSaysSo) {
  const auto result = run_hydrapod({"bode", published, "--from", "1", "--to", "5"});
  EXPECT_THAT(result.out, HasSubstr("Peaks of the direct responses\nnone in this band\n"));
}

struct WrongCall {
  std::vector<std::string> arguments;
  std::string error;
};

TEST(Bode, SaysWhatIsWrongWithItsArguments) {
  const std::vector<WrongCall> calls{
      {{"--input", "actuater"},
       "--input actuater: error: unknown value; did you mean 'actuator'? accepted are wrench, "
       "actuator, command\n"},
      {{"--output", "speed"},
       "--output speed: error: unknown value; accepted are displacement, velocity, acceleration\n"},
      {{"--from", "-1"}, "--from -1: error: a frequency must be positive\n"},
      {{"--from", "5 %"},
       "--from 5 %: error: \"5 %\" has the unit \"%\" (a pure number), expected a frequency such "
       "as \"Hz\"\n"},
      {{"--from", "1e308"}, "--from 1e308: error: expected a frequency up to 1e+09 Hz\n"},
      {{"--from", "5", "--to", "2"}, "--from 5: error: must be less than --to 2\n"},
      {{"--point", "0,0"},
       "--point 0,0: error: a point is three lengths, for instance \"0,0,0.2 m\"\n"},
      {{"--point", "0,0,2 %"},
       "--point 0,0,2 %: error: \"2 %\" has the unit \"%\" (a pure number), expected a length such "
       "as \"m\"\n"},
      {{"--entries", "x,q"},
       "--entries q: error: unknown value; accepted are x, y, z, rx, ry, rz\n"},
      {{"--entries", "x/y/z"},
       "--entries x/y/z: error: 'x/y/z' is no output/input pair such as ry/x\n"},
      {{"--points", "1"}, "error: --points: Value 1 not in range 2 to 100000\n"},
      {{"--plot", "bode.jpg"},
       "--plot bode.jpg: error: a plot ends in .svg, .png or .pdf; found '.jpg'\n"},
      {{"--plot", "bode"}, "--plot bode: error: a plot ends in .svg, .png or .pdf; found ''\n"},
      {{"--plot", "no/where.svg"},
       "no/where.svg: error: cannot write the file: there is no folder 'no'\n"}};
  const test::TemporaryFolder folder;
  for (const auto& call : calls) {
    std::vector<std::string> arguments{"bode", published};
    arguments.insert(arguments.end(), call.arguments.begin(), call.arguments.end());
    const auto result = run_hydrapod(arguments, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 2) << call.error;
    EXPECT_EQ(result.err, call.error);
    EXPECT_EQ(result.out, "");
  }
  EXPECT_TRUE(fs::is_empty(folder.path())) << "nothing is left behind";
}

class PlotFile : public testing::TestWithParam<std::string> {};

/// How pictures of each kind begin and end.
TEST_P(PlotFile, IsAPictureOfItsKind) {
  const test::TemporaryFolder folder;
  const auto result = run_hydrapod(
      {"bode", published, "--entries", "x,ry/x", "--points", "200", "--plot", "bode." + GetParam()},
      {.folder = folder.path()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "wrote bode." + GetParam() + "\n");
  EXPECT_THAT(result.out, HasSubstr("Peaks of the direct responses")) << "the table still comes";
  const std::string picture = test::read_text(folder / ("bode." + GetParam()));
  if (GetParam() == "svg") {
    EXPECT_THAT(picture, AllOf(HasSubstr("<svg"), HasSubstr("</svg>"), HasSubstr("ry from x"),
                               HasSubstr("damping: 0.2 % of critical in every mode"),
                               HasSubstr("with seals"), HasSubstr("rigid legs")));
  } else if (GetParam() == "png") {
    EXPECT_TRUE(picture.starts_with("\x89PNG\r\n\x1a\n"));
    EXPECT_THAT(picture.substr(picture.size() - 12), HasSubstr("IEND"));
  } else {
    EXPECT_TRUE(picture.starts_with("%PDF-"));
    EXPECT_THAT(picture.substr(picture.size() - 10), HasSubstr("%%EOF"));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

INSTANTIATE_TEST_SUITE_P(, PlotFile, testing::Values("svg", "png", "pdf"),
                         [](const auto& test) { return test.param; });

TEST(Plot, OfANarrowBandHasTicks) {
  const test::TemporaryFolder folder;
  const auto result = run_hydrapod({"bode", published, "--entries", "x", "--points", "100",
                                    "--from", "7.1", "--to", "8.9", "--plot", "bode.svg"},
                                   {.folder = folder.path()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string picture = test::read_text(folder / "bode.svg");
  for (const char* tick : {">7.4<", ">8<", ">8.6<"}) EXPECT_THAT(picture, HasSubstr(tick));
}

/// Quotes and line ends in a machine's name are text, and no commands.
TEST(Plot, TakesANameAsText) {
  const test::TemporaryFolder folder;
  const std::string text =
      std::regex_replace(test::read_text(published), std::regex("name = \"Zhang & Jiang 2021\""),
                         "name = \"''it's\\nset output 'stolen'\\nplot x\"");
  const auto result =
      run_hydrapod({"bode", "-", "--entries", "x", "--points", "50", "--plot", "bode.svg"},
                   {.input = text, .folder = folder.path()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(fs::exists(folder / "stolen"));
  EXPECT_THAT(test::read_text(folder / "bode.svg"), HasSubstr("''it's set output 'stolen' plot x"));
}

TEST(Plot, WithoutGnuplotNamesThePackage) {
  const test::TemporaryFolder folder;
  const std::string nothing_in_it = (folder / "").string();
  const auto result =
      run_hydrapod({"bode", published, "--plot", "bode.svg"},
                   {.folder = folder.path(), .variables = {{"PATH", nothing_in_it}}});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "error: plots need the program gnuplot; install the package gnuplot-nox\n");
  EXPECT_EQ(result.out, "");
  EXPECT_FALSE(fs::exists(folder / "bode.svg"));
}

TEST(Plot, ThatCannotBeDrawnLeavesTheOldOne) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "bode.svg", "old");
  test::write_text(folder / "gnuplot", "#!/bin/sh\necho no such terminal\nexit 3\n");
  fs::permissions(folder / "gnuplot", fs::perms::owner_all);
  const auto result =
      run_hydrapod({"bode", published, "--plot", "bode.svg"},
                   {.folder = folder.path(), .variables = {{"PATH", folder.path().string()}}});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "error: gnuplot failed: no such terminal\n");
  EXPECT_EQ(test::read_text(folder / "bode.svg"), "old");
}

TEST(Bode, OfAnUnstableMachineWarns) {
  std::string text = test::read_text(published);
  text = std::regex_replace(text, std::regex("gravity = 0 "), "gravity = 9.81 ");
  text = std::regex_replace(text, std::regex("\nmass = 7.207 "), "\nmass = 0 ");
  text = std::regex_replace(text, std::regex("\nmass = 1.620 "), "\nmass = 0 ");
  text = std::regex_replace(text, std::regex("mass = 894.0"), "mass = 4000.0");
  const auto result = run_hydrapod({"bode", "-"}, {.input = text});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(
      result.err,
      "warning: the machine is unstable at this pose, so that no steady vibration exists; the "
      "response is that of its linear equations\n");
}

}  // namespace
}  // namespace hydrapod
