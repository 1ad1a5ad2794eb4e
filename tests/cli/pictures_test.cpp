/// Pictures say by which command they were drawn, and of what their frequencies are.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
using test::read_text;
using test::run_hydrapod;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class Pictures : public testing::Test {
 protected:
  Pictures() {
    fs::copy_file(test::source_file("models/heavy-platform.toml"), folder / "a & b.toml");
  }

  /// What was drawn by these arguments, which end with the picture's name.
  std::string drawn(const std::vector<std::string>& arguments) const {
    const auto result = run_hydrapod(arguments, {.folder = folder.path(), .timeout = 120.0});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_text(folder / arguments.back());
  }

  [[nodiscard]] std::string sum() const {
    return test::run_program("sha256sum", {(folder / "a & b.toml").string()}).out.substr(0, 64);
  }

  test::TemporaryFolder folder;
};

std::size_t count_of(const std::string& text, std::string_view piece) {
  std::size_t count = 0;
  for (auto at = text.find(piece); at != text.npos; at = text.find(piece, at + 1)) ++count;
  return count;
}

/// Phases are points below levels, whose axis is another: they are within their frames.
TEST_F(Pictures, OfResponsesShowTheirPhases) {
  ASSERT_EQ(run_hydrapod({"rig", "a & b.toml", "--duration", "20 s", "-o", "r.h5"},
                         {.folder = folder.path(), .timeout = 120.0})
                .exit_code,
            0);
  for (const std::string command : {"frf", "identify"}) {
    const auto picture =
        drawn({command, "r.h5", "--force", "-o", command + ".json", "--plot", "p.svg"});
    EXPECT_GT(count_of(picture, "' transform='translate("), 100U) << command;
  }
}

/// A requirement that is met by far at every point is within the frame.
TEST_F(Pictures, OfDesignsShowARequirementThatIsFarFromItsBound) {
  const auto picture =
      drawn({"design", "a & b.toml", "--change", "platform.mass=12:16 t", "--want", "x >= 1 Hz",
             "--minimise", "platform.mass", "--samples", "16", "--starts", "1", "--plot", "p.svg"});
  EXPECT_GT(count_of(picture, " L"), 150U);
}

TEST_F(Pictures, InSvgNameTheirCommandAndTheFilesInADescription) {
  const std::string file = "a & b.toml";
  const std::vector<std::vector<std::string>> commands{
      {"map", file, "--over", "x=-2:2:3 mm", "--over", "y=-2:2:3 mm", "--plot", "p.svg"},
      {"sweep", file, "--over", "platform.mass=12:14:3 t", "--over",
       "legs.guide_sleeve.stiffness=0.84:0.9:3 kN/mm", "--force", "--plot", "p.svg"},
      {"design", file, "--change", "legs.guide_sleeve.stiffness=1:20 kN/mm", "--want",
       "x >= 5.9 Hz", "--minimise", "legs.guide_sleeve.stiffness", "--samples", "64", "--starts",
       "1", "--plot", "p.svg"},
      {"bode", file, "--entries", "x", "--points", "60", "--plot", "p.svg"},
      {"sensitivity", file, "--parameter", "platform.mass", "--plot", "p.svg"},
      {"check", file, "--pose", "low", "--plot", "p.svg"}};
  for (const auto& command : commands) {
    const auto picture = drawn(command);
    const auto from = picture.find("<desc>"), to = picture.find("</desc>");
    ASSERT_NE(to, std::string::npos) << command.front();
    const auto description = picture.substr(from, to - from);
    EXPECT_THAT(
        description,
        AllOf(HasSubstr("by: hydrapod " + command.front() + " 'a &amp; b.toml'"),
              HasSubstr("--plot p.svg\n"), HasSubstr("read a &amp; b.toml: sha256 " + sum()),
              HasSubstr("\nwritten by hydrapod ")));
    EXPECT_THAT(picture, Not(HasSubstr("Gnuplot"))) << "browsers show a title beside the pointer";
  }
}

TEST_F(Pictures, InPngHoldItInAChunkWithTheRightChecksum) {
  const auto picture =
      drawn({"bode", "a & b.toml", "--entries", "x", "--points", "60", "--plot", "p.png"});
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k)
      value = (value << 8U) | static_cast<unsigned char>(picture.at(at + k));
    return value;
  };
  std::string found;
  std::size_t at = 8;
  while (at < picture.size()) {
    const auto size = number(at);
    const auto* named = reinterpret_cast<const Bytef*>(picture.data() + at + 4);
    EXPECT_EQ(::crc32(0, named, size + 4), number(at + 8 + size)) << picture.substr(at + 4, 4);
    if (picture.substr(at + 4, 4) == "iTXt") found = picture.substr(at + 8, size);
    at += 12 + size;
  }
  EXPECT_EQ(at, picture.size());
  EXPECT_THAT(found, AllOf(testing::StartsWith("Description"),
                           HasSubstr("by: hydrapod bode 'a & b.toml'"), HasSubstr(sum())));
}

TEST_F(Pictures, InPdfHoldItInCommentsBeforeTheMarkOfTheEnd) {
  const auto picture =
      drawn({"bode", "a & b.toml", "--entries", "x", "--points", "60", "--plot", "p.pdf"});
  const auto first = picture.find("%%EOF"), last = picture.rfind("%%EOF");
  ASSERT_LT(first, last);
  EXPECT_THAT(picture.substr(first), AllOf(HasSubstr("by: hydrapod bode 'a & b.toml'"),
                                           HasSubstr("% read a & b.toml: sha256 " + sum())));
  const auto place = [&](std::size_t before) {
    const auto begin = picture.rfind("startxref", before);
    return picture.substr(begin, before - begin);
  };
  EXPECT_EQ(place(first), place(last)) << "the table of the file is where it was";
}

/// `modes` has 4.101 Hz, studies 4.096 Hz: each says what it is.
TEST_F(Pictures, AndTablesOfStudiesSayThatTheirFrequenciesAreUndamped) {
  const std::vector<std::string> map{"map",         "a & b.toml", "--over",
                                     "x=-2:2:3 mm", "--over",     "y=-2:2:3 mm"};
  auto plotted = map;
  plotted.insert(plotted.end(), {"--csv", "m.csv", "--plot", "m.svg"});
  EXPECT_THAT(drawn(plotted), AllOf(HasSubstr("lowest, undamped [Hz]"),
                                    HasSubstr("undamped frequency of the lowest mode")));
  EXPECT_THAT(read_text(folder / "m.csv"),
              HasSubstr("# frequencies are those of undamped modes\n"));
  EXPECT_THAT(read_text(folder / "study.h5"), HasSubstr("undamped"));
  auto as_json = map;
  as_json.insert(as_json.end(), {"--format", "json", "-o", "m.json"});
  for (const auto& output : nlohmann::json::parse(drawn(as_json)).at("outputs")) {
    if (output.at("unit") != "Hz") continue;
    EXPECT_THAT(output.at("meaning").get<std::string>(),
                testing::StartsWith("undamped frequency of the "));
  }
  const auto design = [&](const std::string& format) {
    return run_hydrapod(
        {"design", "a & b.toml", "--change", "legs.guide_sleeve.stiffness=0.9:20 kN/mm", "--want",
         "x >= 5.9 Hz", "--maximise", "lowest", "--samples", "64", "--starts", "1", "--plot",
         "d.svg", "--format", format},
        {.folder = folder.path()});
  };
  EXPECT_THAT(design("table").out, HasSubstr("\nfrequencies are those of undamped modes\n"));
  EXPECT_THAT(read_text(folder / "d.svg"), HasSubstr("undamped frequencies"));
  const auto found = nlohmann::json::parse(design("json").out);
  for (const char* kind : {"aims", "requirements"})
    EXPECT_THAT(found.at(kind).at(0).at("meaning").get<std::string>(),
                testing::StartsWith("undamped frequency of the "));
}

TEST_F(Pictures, AndHelpOfStudiesSaysItToo) {
  for (const char* command : {"montecarlo", "sweep", "map", "design", "evaluate"})
    EXPECT_THAT(run_hydrapod({command, "--help"}).out,
                HasSubstr("\n  Outputs in Hz are frequencies of undamped modes; where seals are "
                          "elastomers, of damped modes.\n"))
        << command;
}

TEST_F(Pictures, DampedFrequenciesAreTheSameInAllCommands) {
  const auto json = [&](const std::string& command) {
    const auto run =
        run_hydrapod({command, "a & b.toml", "--format", "json"}, {.folder = folder.path()});
    return nlohmann::json::parse(run.out);
  };
  const double lowest = json("modes").at("modes").at(0).at("omega_rad_s");
  EXPECT_NEAR(json("check").at("poses").at(0).at("first_resonance_rad_s").get<double>(), lowest,
              1e-12 * lowest);
  EXPECT_NEAR(json("sensitivity").at("modes").at(0).at("omega_rad_s").get<double>(), lowest,
              1e-12 * lowest);
  for (const char* command : {"modes", "sensitivity"})
    EXPECT_THAT(run_hydrapod({command, "a & b.toml"}, {.folder = folder.path()}).out,
                HasSubstr("natural frequencies |λ| of the damped modes"));
}

}  // namespace
}  // namespace hydrapod
