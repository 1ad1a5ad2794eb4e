/// Files of other programs from the outside: what commands say of them.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support/json_fields.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::HasSubstr;

class ForeignFiles : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

/// A hit on a mass on a spring: force, and an output whose name and unit say nothing but "a1".
std::string hit(std::uint64_t seed) {
  constexpr double omega = 2.0 * std::numbers::pi * 17.3, zeta = 0.013, dt = 1.0 / 512.0;
  Random random(seed);
  std::string text = "time [s],force [N],a1\n";
  for (int k = 0; k < 2048; ++k) {
    const double t = k * dt, since = t - 0.103;
    const double force =
        since >= 0.0 && since < 0.011 ? 130.0 * std::sin(std::numbers::pi * since / 0.011) : 0.0;
    const double motion = since < 0.0 ? 0.0
                                      : std::exp(-zeta * omega * since) * std::sin(omega * since) +
                                            1e-4 * random.uniform(-1.0, 1.0);
    text += fmt::format("{},{},{}\n", t, force, motion);
  }
  return text;
}

TEST_F(ForeignFiles, FrfOfAHitShowsARowPerOutput) {
  write_text(file("hit.csv"), hit(3));
  const auto run = run_hydrapod({"frf", file("hit.csv")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("excitation: force; response: a1"));
  EXPECT_THAT(run.out, testing::ContainsRegex("\na1 .*from force"));
}

TEST_F(ForeignFiles, NamesOfChannelsThatAreEmptyOrRepeatedAreRefused) {
  write_text(file("hit.csv"), hit(4));
  const auto refused = [&](const char* option, const char* value) {
    const auto run = run_hydrapod({"frf", file("hit.csv"), option, value});
    EXPECT_EQ(run.exit_code, 2);
    return run.err;
  };
  EXPECT_THAT(refused("--inputs", "force,force"),
              HasSubstr("--inputs force,force: error: the channel 'force' is named twice"));
  EXPECT_THAT(refused("--inputs", ","), HasSubstr("--inputs ,: error: a name is empty"));
  EXPECT_THAT(refused("--outputs", "a1,"), HasSubstr("a name is empty"));
}

/// Names have blanks in them: those of the rig's own accelerometers do.
TEST_F(ForeignFiles, ASensorMayHaveABlankInItsName) {
  const auto run =
      run_hydrapod({"rig", source_file("models/heavy-platform.toml"), "--duration", "2", "--excite",
                    "noise all=0.2 mm, from=2, to=12", "--accelerometer",
                    "acceleration 1x, at=0.31 0 0.1, along=x", "--accelerometer",
                    "top left at=0.1 0.2 0, along=y", "-o", file("run.h5")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto shown = run_hydrapod({"record", "show", file("run.h5")});
  EXPECT_THAT(shown.out, HasSubstr("sensor: acceleration 1x at 0.31 0 0.1 m along 1 0 0"));
  EXPECT_THAT(shown.out, HasSubstr("sensor: top left at 0.1 0.2 0 m along 0 1 0"));
}

TEST_F(ForeignFiles, NamesThatBeginWithAQuoteArePlotted) {
  data::Record record;
  record.header.sample_rate = 100.0;
  record.header.title = "''";
  record.header.channels = {{.name = "'a'", .unit = "m"}, {.name = "''"}, {.name = "\"\\n"}};
  record.samples = data::Samples::Random(500, 3);
  data::write_record(file("q.h5"), record, data::RecordFormat::hdf5);
  const auto run = run_hydrapod({"record", "plot", file("q.h5"), "-o", file("q.svg")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(read_text(file("q.svg")), testing::StartsWith("<?xml"));
}

data::FrequencyResponses one_mode() {
  data::FrequencyResponses all;
  all.inputs = {{"F", "N", data::Direction::x, data::Role::excitation, 12}};
  all.outputs = {{"a1", "m/s^2", data::Direction::x, data::Role::response, 12},
                 {"a2", "m/s^2", data::Direction::x, data::Role::response, 7}};
  all.outputs[1].entity = "WING";
  all.geometry = {.nodes = {{12, {0.125, -0.0375, 0.0}}, {7, {0.0, 0.4125, -0.0015}}},
                  .lines = {{"edge", {12, 7}, 2}}};
  all.id_lines = {{"first", "H1"}, {}};
  Random random(8);
  const double omega = 2.0 * std::numbers::pi * 9.37, zeta = 0.021;
  for (int k = 0; k < 400; ++k) {
    const double f = 1.0 + 0.05 * k;
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    const auto h = s * s / (s * s + 2.0 * zeta * omega * s + omega * omega);
    all.frequency.push_back(f);
    auto& H = all.H.emplace_back(2, 1);
    for (int o = 0; o < 2; ++o)
      H(o, 0) = (o == 0 ? 1.0 : -0.61) * h +
                1e-3 * std::complex<double>(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  }
  return all;
}

/// From a file of responses to a file of modes: points, parts and lines go with them.
TEST_F(ForeignFiles, GeometryGoesFromResponsesToModes) {
  data::write_frequency_responses(file("h.uff"), one_mode());
  for (const char* name : {"h.h5", "h.mat", "h.json", "h.csv"}) {
    SCOPED_TRACE(name);
    ASSERT_EQ(run_hydrapod({"frf", file("h.uff"), "-o", file(name)}).exit_code, 0);
    const auto run = run_hydrapod({"identify", file(name), "-o", file("modes.uff")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const std::string modes = read_text(file("modes.uff"));
    EXPECT_THAT(modes, HasSubstr("        12         0         0         0  1.25000E-01"));
    EXPECT_THAT(modes, HasSubstr("    82\n         1         2         2\nedge"));
    const auto table = run_hydrapod({"identify", file(name)});
    EXPECT_THAT(table.out, testing::ContainsRegex("9\\.3(70|69)"));
  }
  const Json json = json_of({"frf", file("h.h5"), "--format", "json"});
  EXPECT_EQ(json["outputs"][1]["entity"], "WING");
  EXPECT_EQ(json["geometry"]["nodes"][1]["position_m"][1], 0.4125);
  EXPECT_EQ(json["id_lines"][0][1], "H1");
}

TEST_F(ForeignFiles, RecordShowOfResponsesPointsToIdentify) {
  data::write_frequency_responses(file("h.uff"), one_mode());
  for (const char* name : {"h.uff", "h.h5", "h.mat", "h.csv", "h.json"}) {
    SCOPED_TRACE(name);
    if (name != std::string("h.uff")) run_hydrapod({"frf", file("h.uff"), "-o", file(name)});
    const auto run = run_hydrapod({"record", "show", file(name)});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("hydrapod identify"));
  }
}

TEST_F(ForeignFiles, RecordShowTellsNodesPartsAndLinesOfText) {
  data::Record record;
  record.header.sample_rate = 64.0;
  record.header.channels = {{"a", "m", data::Direction::z, data::Role::response, 12}};
  record.header.channels[0].entity = "WING";
  record.header.channels[0].id_lines = {"run 3, flap 5 deg", "NONE", "x"};
  record.header.geometry = one_mode().geometry;
  record.samples = data::Samples::Random(50, 1);
  data::write_record(file("r.uff"), record, data::RecordFormat::uff);
  const auto run = run_hydrapod({"record", "show", file("r.uff")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("geometry: 2 nodes, 1 line\n"));
  EXPECT_THAT(run.out, testing::ContainsRegex("\na .* WING 12\n"));
  EXPECT_THAT(run.out, HasSubstr("a: run 3, flap 5 deg | NONE | x\n"));
  const Json json = json_of({"record", "show", file("r.uff"), "--format", "json"});
  EXPECT_EQ(json["channels"][0]["entity"], "WING");
  EXPECT_EQ(json["channels"][0]["id_lines"][2], "x");
  EXPECT_EQ(json["geometry"]["lines"][0]["nodes"][1], 7);
}

}  // namespace
}  // namespace hydrapod::test
