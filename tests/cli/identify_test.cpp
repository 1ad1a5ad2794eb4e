/// `hydrapod frf` and `hydrapod identify` on a record of a chain of masses.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/report/measured_results.hpp"
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

/// Of one record with six multisines no response can be told apart from the others. Whatever comes
/// out has an interval that is not 0.
TEST_F(Identify, NoIntervalIsZero) {
  const std::string machine = folder / "machine.toml", run = folder / "multisine.h5",
                    found = folder / "modes.json";
  ASSERT_EQ(test::run_hydrapod({"init", machine}).exit_code, 0);
  const auto rig = test::run_hydrapod(
      {"rig", machine, "--set", "legs.guide_sleeve.stiffness=300 N/mm", "--excite",
       "multisine all=0.2 mm, from=1, to=30, period=8.192 s", "--duration", "60", "-o", run});
  ASSERT_EQ(rig.exit_code, 0) << rig.err;
  ASSERT_EQ(test::run_hydrapod({"identify", run, "-o", found}).exit_code, 0);
  const json result = json::parse(test::read_text(found));
  ASSERT_TRUE(result.contains("modes"));
  for (const auto& mode : result["modes"]) {
    EXPECT_GT(mode["frequency_95_hz"].get<double>(), 0.0);
    EXPECT_GT(mode["damping_95"].get<double>(), 0.0);
  }
}

/// Where it has no meaning it is an error that says where it has one.
TEST_F(Identify, TheWholeRecordIsRefusedWhereAveragesAreTaken) {
  const auto refused = [](std::vector<std::string> arguments) {
    arguments.push_back("--whole-record");
    const auto run = test::run_hydrapod(arguments);
    EXPECT_NE(run.exit_code, 0) << testing::PrintToString(arguments);
    EXPECT_EQ(run.out, "");
    return run.err;
  };
  const std::string run = write();
  const char* where = "from the whole record at once where it is too short for averages of blocks";
  for (const auto& arguments : {std::vector<std::string>{"identify", run, "--output-only"}})
    EXPECT_THAT(refused(arguments),
                testing::AllOf(HasSubstr(where), HasSubstr("leave --whole-record out")));
  EXPECT_THAT(refused({"frf", run}), HasSubstr("--whole-record: error: is for modes"));
  const std::string responses = folder / "frf.json";
  ASSERT_EQ(test::run_hydrapod({"frf", run, "-o", responses}).exit_code, 0);
  EXPECT_THAT(refused({"identify", responses}), HasSubstr("needs a record; "));
  // a decaying answer to one hit
  std::string hit = "time [s],force [N],a [m/s^2]\n";
  for (int k = 0; k < 2048; ++k) {
    const double t = k / 512.0, since = t - 0.1;
    const bool on = since >= 0.0 && since < 0.011;
    hit +=
        fmt::format("{},{},{}\n", t, on ? 90.0 * std::sin(std::numbers::pi * since / 0.011) : 0.0,
                    since < 0.0 ? 0.0 : std::exp(-1.5 * since) * std::sin(107.0 * since));
  }
  test::write_text(folder / "hit.csv", hit);
  EXPECT_THAT(refused({"identify", (folder / "hit.csv").string()}),
              testing::AllOf(HasSubstr(where), HasSubstr("this one is of hits")));
}

TEST_F(Identify, ARecordGivesItsModes) {
  const auto run = test::run_hydrapod({"identify", write(), "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_modes(json::parse(run.out));
}

TEST_F(Identify, TheRealisationAgrees) {
  const auto run = test::run_hydrapod({"identify", write(), "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto found = json::parse(run.out);
  for (const auto& mode : found["modes"]) {
    const auto& cross_check = mode["cross_check"];
    ASSERT_TRUE(cross_check.is_object());
    EXPECT_EQ(cross_check["agrees"], true);
    EXPECT_NEAR(cross_check["frequency_hz"].get<double>() / mode["frequency_hz"].get<double>(), 1.0,
                0.005);
    EXPECT_NE(cross_check["frequency_hz"], mode["frequency_hz"]);
  }
}

TEST_F(Identify, TheBootstrapIsLikeTheIntervals) {
  record = test::record_of(system, {.sample_rate = 50.0,
                                    .samples = 1 << 16,
                                    .output_noise = Eigen::Vector3d::Constant(2e-3),
                                    .seed = 11});
  const std::string path = write();
  const auto run = test::run_hydrapod(
      {"identify", path, "--bootstrap", "30", "--block", "1024", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto found = json::parse(run.out);
  EXPECT_EQ(found["bootstrap_resamples"], 30);
  EXPECT_EQ(found["bootstrap_groups"], 24);
  // 24 groups and 30 draws tell a deviation to some 20 %
  for (const auto& mode : found["modes"])
    for (const char* what : {"frequency_95_hz", "damping_95"}) {
      const double ratio = mode["bootstrap"][what].get<double>() / mode[what].get<double>();
      EXPECT_GT(ratio, 0.4) << what;
      EXPECT_LT(ratio, 1.7) << what;
    }
  const std::string frf = folder / "frf.json";
  ASSERT_EQ(test::run_hydrapod({"frf", path, "-o", frf}).exit_code, 0);
  const auto refused = test::run_hydrapod({"identify", frf, "--bootstrap", "30"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("resamples the blocks of a record"));
}

TEST_F(Identify, TheTableSaysWhatItIs) {
  const auto run = test::run_hydrapod({"identify", write()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("3 inputs, 3 outputs"));
  EXPECT_THAT(run.out, HasSubstr("\nHz: |λ| of damped modes. ± is half the 95 % interval"));
  EXPECT_THAT(run.out, HasSubstr("ERA"));
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
  const auto found = json::parse(run.out);
  EXPECT_EQ(found["kind"], "identified_modes");
  ASSERT_EQ(found["modes"].size(), 3u);
  for (const auto& mode : found["modes"]) {
    EXPECT_GT(mode["frequency_95_hz"], 0.0);
    EXPECT_GT(mode["damping_95"], 0.0);
    EXPECT_GT(mode["quality"], 0.5);
  }
  for (const char* key : {"band_hz", "stabilisation", "harmonics"})
    EXPECT_TRUE(found.contains(key)) << key;
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

/// Its role says response, and its name is among the inputs.
TEST_F(Identify, AChannelThatIsNamedAsInputIsNoOutputByItsRole) {
  const std::string path = write();
  const auto run =
      test::run_hydrapod({"frf", path, "--inputs", "y2", "--estimator", "h1", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["response"].size(), 2U);
  const auto both = test::run_hydrapod({"frf", path, "--inputs", "y2", "--outputs", "y1,y2"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("channel 'y2' is named as input and as output"));
}

TEST_F(Identify, ARecordTooShortForTheResolutionIsRefused) {
  const auto run = test::run_hydrapod({"frf", write(), "--block", "8192"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("too short"));
  const auto longer = test::run_hydrapod({"frf", write(), "--block", "65536"});
  EXPECT_EQ(longer.exit_code, 2);
  EXPECT_THAT(longer.err, HasSubstr("fewer than one block"));
  const std::string few = folder / "few.csv", rate = "# hydrapod record 1\n# sample_rate_hz: 9\n";
  test::write_text(few, rate + "time [s],u1 [N],y1 [m]\n0,1,0.1\n0.1,2,0.3\n");
  const auto short_one = test::run_hydrapod({"frf", few, "--inputs", "u1", "--outputs", "y1"});
  EXPECT_THAT(short_one.err, HasSubstr("few.csv: error: the record has only 2 samples:"));
}

TEST_F(Identify, SettlingLongerThanTheRecordIsRefused) {
  const auto run = test::run_hydrapod({"frf", write(), "--settling", "400 s"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("400 s are left out as settling, and the record has 327.68 s"));
}

TEST_F(Identify, ARecordThatIsGivenTwiceDoesNotCountTwice) {
  const auto path = write();
  const auto run = test::run_hydrapod({"frf", path, folder / "./run.h5"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("is given twice"));
}

/// The reader of the file says `--rate`, whatever command reads it.
TEST_F(Identify, TheRateOfAFileWithoutOneCanBeGiven) {
  const std::string few = folder / "few.csv";
  test::write_text(few, "u1 [N],y1 [m]\n1,0.1\n2,0.3\n");
  const std::vector<std::string> arguments{"frf", few, "--inputs", "u1", "--outputs", "y1"};
  EXPECT_THAT(test::run_hydrapod(arguments).err, HasSubstr("give the rate in Hz with --rate"));
  for (const char* option : {"--rate", "--sample-rate", "--file-rate"}) {
    auto with = arguments;
    with.insert(with.end(), {option, "9 Hz"});
    EXPECT_THAT(test::run_hydrapod(with).err, HasSubstr("the record has only 2 samples:"));
  }
}

TEST_F(Identify, BadOptionsAreRefused) {
  const std::string path = write();
  for (const auto& [option, value] : {std::pair{"--window", "han"},
                                      {"--estimator", "h3"},
                                      {"--block", "17"},
                                      {"--overlap", "100"},
                                      {"--overlap", "0.75"},
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
  EXPECT_THAT(run.err, HasSubstr("is not JSON"));
  test::write_text(path, R"({"inputs": [{"name": 3}], "outputs": [{"name": "y"}],
      "frequency_hz": [1, 2], "response": []})");
  run = test::run_hydrapod({"identify", path});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("inputs[0].name: expected a text"));
}

TEST_F(Identify, ResultsGoIntoFilesOfOtherPrograms) {
  const std::string path = write();
  const auto uff = folder / "modes.uff";
  ASSERT_EQ(test::run_hydrapod({"identify", path, "-o", uff}).exit_code, 0);
  const auto read = data::read_modal_results(uff).results;
  ASSERT_EQ(read.modes.size(), 3u);
  ASSERT_EQ(read.outputs.size(), 3u);
  EXPECT_EQ(read.outputs[1].name, "y2");
  for (std::size_t r = 0; r < 3; ++r) {
    EXPECT_NEAR(std::abs(read.modes[r].pole) / std::abs(system.modes[r].pole), 1.0, 0.003);
    const auto& a = read.modes[r].shape;
    const auto& b = system.modes[r].shape;
    EXPECT_GT(std::norm(a.dot(b)) / a.squaredNorm() / b.squaredNorm(), 0.99);
  }
  const auto mat = folder / "modes.mat";
  ASSERT_EQ(test::run_hydrapod({"identify", path, "--format", "mat", "-o", mat}).exit_code, 0);
  EXPECT_THAT(test::read_text(mat), testing::StartsWith("MATLAB 5.0 MAT-file"));
  const auto frf = folder / "frf.mat";
  ASSERT_EQ(test::run_hydrapod({"frf", path, "-o", frf}).exit_code, 0);
  EXPECT_THAT(test::read_text(frf), testing::StartsWith("MATLAB 5.0 MAT-file"));
  const auto unnamed = test::run_hydrapod({"identify", path, "--format", "uff"});
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("-o FILE.uff"));
}

TEST_F(Identify, NamesWithCommasStayOneField) {
  record.header.channels[3].name = "a, \"left\"";
  const auto run = test::run_hydrapod({"identify", write(), "--format", "csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\"re a, \"\"left\"\"\",\"im a, \"\"left\"\"\",re y2"));
}

TEST_F(Identify, TheChartSaysOfEveryPoleWhatAgrees) {
  const auto run = test::run_hydrapod({"identify", write(), "--block", "1024", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto found = json::parse(run.out);
  std::map<int, int> members;
  std::map<std::string, int> words;
  for (const auto& order : found["stabilisation"])
    for (const auto& pole : order["poles"]) {
      ++words[pole["agrees"].get<std::string>()];
      if (!pole["cluster"].is_null()) ++members[pole["cluster"].get<int>()];
    }
  ASSERT_EQ(found["clusters"].size(), 3u);
  for (int c = 1; c <= 3; ++c) {
    const auto& cluster = found["clusters"][static_cast<std::size_t>(c - 1)];
    EXPECT_EQ(cluster["mode"], c);
    EXPECT_EQ(cluster["orders"], members[c]);
  }
  EXPECT_GT(words["vector"], 3 * 10);
  EXPECT_GT(words["new"], 0);
}

/// H of a machine on its oil springs with dampers βK, from M and K alone, as JSON of `hydrapod
/// frf`.
class MeasuredMachine : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  model::Machine machine =
      model::read_machine_file(test::source_file("models/heavy-platform.toml")).machine;
  double beta = 2e-4;  // [s]
  std::string path = folder / "frf.json";

  void write() const {
    const auto linear =
        dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::rigid);
    const Eigen::MatrixXd M = linear.M, K = linear.K;
    identification::FrequencyResponses r;
    for (int d = 1; d <= 6; ++d) {
      const auto direction = static_cast<data::Direction>(d);
      const std::string name(data::direction_text(direction));
      r.inputs.push_back({"F" + name, d < 4 ? "N" : "N m", direction, data::Role::other});
      r.outputs.push_back({name, d < 4 ? "m" : "rad", direction, data::Role::response});
    }
    for (double f = 1.0; f < 25.0; f += 0.05) {
      const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
      r.frequency.push_back(f);
      r.H.push_back((K * (1.0 + s * beta) + s * s * M).inverse());
    }
    test::write_text(path, report::responses_json(r).dump());
  }
};

TEST_F(MeasuredMachine, IsComparedWithItsFile) {
  write();
  const std::string file = test::source_file("models/heavy-platform.toml");
  const auto run = test::run_hydrapod(
      {"identify", path, "--machine", file, "--model", "rigid", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto c = json::parse(run.out)["comparison"];
  EXPECT_EQ(c["source"], "mechanics");
  ASSERT_EQ(c["pairs"].size(), 6u);
  EXPECT_TRUE(c["not_in_model"].empty());
  EXPECT_TRUE(c["not_measured"].empty());
  for (const auto& pair : c["pairs"]) {
    EXPECT_NEAR(pair["frequency_difference_percent"].get<double>(), 0.0, 1e-3);
    EXPECT_GT(pair["mac"].get<double>(), 0.9999);
    const double omega = 2.0 * std::numbers::pi * pair["model"]["frequency_hz"].get<double>();
    const double ratio = 0.5 * beta * omega / pair["model"]["damping_ratio"].get<double>();
    EXPECT_NEAR(pair["damping_difference_percent"].get<double>(), 100.0 * (ratio - 1.0), 0.1);
  }
  const auto table = test::run_hydrapod({"identify", path, "--machine", file, "--model", "rigid"});
  EXPECT_THAT(table.out, HasSubstr("Compared with Heavy motion platform, pose neutral, rigid "
                                   "model: mechanics, legs as springs"));
  EXPECT_THAT(table.out, testing::ContainsRegex(
                             "\n\n6 of 6 modes are in the model; largest difference of a frequency "
                             ".*0\\.00 % \\(mode .\\), lowest MAC 1\\.000 \\(mode .\\)\\.\n$"));
  const auto brief =
      test::run_hydrapod({"identify", path, "--machine", file, "--model", "rigid", "--brief"});
  EXPECT_THAT(brief.out, testing::AllOf(HasSubstr("\n6 of 6 modes are in the model; "),
                                        testing::Not(HasSubstr("model Hz"))));
}

TEST_F(MeasuredMachine, ModesThatTheModelLacksAreSaid) {
  write();
  const std::string file = test::source_file("models/heavy-platform.toml");
  // legs without seals were measured: the seals' own modes are not there
  const auto run = test::run_hydrapod({"identify", path, "--machine", file, "--model", "guide"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Not measured"));
  EXPECT_THAT(run.out, HasSubstr("Not measured, local seal modes: "));
}

TEST_F(MeasuredMachine, WithoutAMachineNothingIsCompared) {
  write();
  const auto run = test::run_hydrapod({"identify", path});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, testing::Not(HasSubstr("Compared")));
  for (const auto& more :
       {std::vector<std::string>{"--against", "plant"}, {"--cross-mac", folder / "mac.svg"}}) {
    std::vector<std::string> words{"identify", path};
    words.insert(words.end(), more.begin(), more.end());
    const auto refused = test::run_hydrapod(words);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("add --machine FILE"));
  }
  EXPECT_EQ(test::run_hydrapod({"identify", path, "--against", "plan"}).exit_code, 2);
}

TEST(Accelerometers, OfTheRigAreBroughtToThePlatform) {
  const test::TemporaryFolder folder;
  const std::string file = test::source_file("models/heavy-platform.toml");
  const std::string record = folder / "run.csv";
  ASSERT_EQ(test::run_hydrapod({"rig", file, "--pose", "z=20 mm, ry=2 deg", "--duration", "3",
                                "--excite", "noise all=0.2 mm, from=2, to=12", "-o", record})
                .exit_code,
            0);
  const auto run =
      test::run_hydrapod({"frf", record, "--accelerometers", "--block", "256", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto outputs = json::parse(run.out)["outputs"];
  ASSERT_EQ(outputs.size(), 6u);
  EXPECT_EQ(outputs[4]["name"], "ry");
  EXPECT_EQ(outputs[4]["unit"], "rad/s^2");
  // two of the three places do not tell the rotation about the line through them
  const auto few = test::run_hydrapod({"frf", record, "--accelerometers", "--outputs",
                                       "acceleration 1x,acceleration 1y,acceleration 1z,"
                                       "acceleration 3x,acceleration 3y,acceleration 3z"});
  EXPECT_EQ(few.exit_code, 1);
  EXPECT_THAT(few.err, HasSubstr("do not determine all six directions"));
  const auto unknown =
      test::run_hydrapod({"frf", record, "--accelerometers", "--outputs", "acceleration 9x"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("not a sensor with a known position"));
}

TEST_F(Identify, AccelerometersNeedPlacesAndAPose) {
  const std::string path = write();
  const auto machine = test::source_file("models/heavy-platform.toml");
  const auto run = test::run_hydrapod({"identify", path, "--accelerometers"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("add --machine FILE"));
  const auto placed =
      test::run_hydrapod({"identify", path, "--accelerometers", "--machine", machine});
  EXPECT_EQ(placed.exit_code, 2);
  EXPECT_THAT(placed.err, HasSubstr("add --sensor"));
}

}  // namespace
}  // namespace hydrapod
