/// `hydrapod frf` and `hydrapod identify` on a record of a chain of masses.

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Identify : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  test::ModalSystem system = test::chain(3, 1.13, 1733.0, 0.021);  // 4.77, 8.82, 11.52 Hz
  data::Record record = test::record_of(system, {.sample_rate = 50.0,
                                                 .samples = 1 << 14,
                                                 .output_noise = Eigen::Vector3d::Constant(1e-5),
                                                 .seed = 3});

  std::string write(const std::string& name = "run.h5") {
    const std::string path = folder / name;
    data::write_record(path, record, data::format_of_ending(path));
    return path;
  }

  void expect_modes(const json& found) const {
    ASSERT_EQ(found["modes"].size(), 3u);
    for (std::size_t r = 0; r < 3; ++r) {
      const double truth = std::abs(system.modes[r].pole) / (2.0 * std::numbers::pi);
      EXPECT_NEAR(found["modes"][r]["frequency_hz"].get<double>() / truth, 1.0, 0.003);
      EXPECT_NEAR(found["modes"][r]["damping_ratio"].get<double>(), 0.021, 0.002);
      EXPECT_GT(found["modes"][r]["damping_95"].get<double>(), 0.0);
    }
  }
};

TEST_F(Identify, ARecordGivesItsModes) {
  const auto run = test::run_hydrapod({"identify", write(), "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_modes(json::parse(run.out));
}

TEST_F(Identify, TheTableSaysWhatItIs) {
  const auto run = test::run_hydrapod({"identify", write()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("3 inputs, 3 outputs"));
  EXPECT_THAT(run.out, HasSubstr("± is 95 %"));
}

TEST_F(Identify, ResponsesThroughAFileGiveTheSameModes) {
  const std::string path = write();
  for (const char* format : {"json", "uff"}) {
    const std::string frf = folder / (std::string("frf.") + format);
    ASSERT_EQ(test::run_hydrapod({"frf", path, "--format", format, "-o", frf}).exit_code, 0);
    const auto run = test::run_hydrapod({"identify", frf, "--format", "json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    if (std::string(format) == "json") expect_modes(json::parse(run.out));
    EXPECT_EQ(json::parse(run.out)["modes"].size(), 3u);
  }
}

TEST_F(Identify, OutputsAloneGiveTheModes) {
  const auto run = test::run_hydrapod({"identify", write(), "--output-only", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["modes"].size(), 3u);
}

TEST_F(Identify, ADeadChannelIsSaidAndTheRestIsRight) {
  record.samples.col(4).setZero();
  const auto run = test::run_hydrapod({"identify", write(), "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("y2: dead"));
  expect_modes(json::parse(run.out));
}

TEST_F(Identify, UnknownChannelsAreNamedWithTheNearest) {
  const auto run = test::run_hydrapod({"frf", write(), "--outputs", "y1,Y3"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("did you mean 'y3'?"));
}

TEST_F(Identify, RolesThatAreMissingAreSaid) {
  for (auto& channel : record.header.channels) channel.role = data::Role::other;
  const std::string path = write();
  const auto run = test::run_hydrapod({"identify", path});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--inputs"));
  const auto named = test::run_hydrapod(
      {"identify", path, "--inputs", "u1, u2, u3", "--outputs", "y1,y2,y3", "--format", "json"});
  ASSERT_EQ(named.exit_code, 0) << named.err;
  expect_modes(json::parse(named.out));
}

TEST_F(Identify, ARecordTooShortForTheResolutionIsRefused) {
  const auto run = test::run_hydrapod({"frf", write(), "--block", "8192"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("too short"));
  const auto longer = test::run_hydrapod({"frf", write(), "--block", "65536"});
  EXPECT_EQ(longer.exit_code, 2);
  EXPECT_THAT(longer.err, HasSubstr("fewer than one block"));
}

TEST_F(Identify, BadOptionsAreRefused) {
  const std::string path = write();
  for (const auto& [option, value] : {std::pair{"--window", "han"},
                                      {"--estimator", "h3"},
                                      {"--block", "17"},
                                      {"--overlap", "100"},
                                      {"--from", "-1"},
                                      {"--plot", "x.bmp"},
                                      {"--order", "1"}})
    EXPECT_EQ(test::run_hydrapod({"identify", path, option, value}).exit_code, 2) << option;
  EXPECT_EQ(test::run_hydrapod({"identify", path, "--from", "9", "--to", "3"}).exit_code, 2);
}

TEST_F(Identify, BrokenResponsesAreRefusedWithTheField) {
  const std::string path = folder / "frf.json";
  test::write_text(path, R"({"kind": "frf", "inputs": [{"name": "u"}]})");
  auto run = test::run_hydrapod({"identify", path});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("outputs"));
  test::write_text(path, "{ not JSON");
  run = test::run_hydrapod({"identify", path});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("is no JSON"));
}

}  // namespace
}  // namespace hydrapod
