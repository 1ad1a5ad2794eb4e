/// `hydrapod simulate`: what it prints and writes, and what is left when something goes wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using test::run_hydrapod;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

std::string model(const std::string& name) {
  return test::source_file("models/" + name + ".toml").string();
}
const std::string published = model("zhang-jiang-2021");

double last_of(const data::Record& record, const std::string& channel) {
  const auto column = data::find_channel(record.header, channel);
  return record.samples(record.samples.rows() - 1, static_cast<Eigen::Index>(column.value()));
}

TEST(Simulate, ShowsHowAStepSettles) {
  const auto result = run_hydrapod(
      {"simulate", published, "--command", "step z=2 mm", "--until", "3", "--model", "rigid"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("step z=2 mm, at=0.1 s"), HasSubstr("rigid legs"),
                                HasSubstr("within 2 % after"), HasSubstr("stroke used")));
}

TEST(Simulate, JsonHoldsTheRunAndItsHistories) {
  const auto result = run_hydrapod({"simulate", published, "--command", "step z=2 mm", "--until",
                                    "4", "--model", "rigid", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("kind"), "simulation");
  EXPECT_EQ(json.at("run").at("end"), "finished");
  EXPECT_NEAR(json.at("run").at("time_s").get<double>(), 4.0, 1e-9);
  const auto& z = json.at("directions").at(2);
  EXPECT_EQ(z.at("direction"), "z");
  EXPECT_NEAR(z.at("peak_command").get<double>(), 2e-3, 1e-15);
  EXPECT_GT(z.at("settling_time_s").get<double>(), 0.05);
  EXPECT_LT(z.at("settling_time_s").get<double>(), 3.0);
  const auto& trace = json.at("trace");
  EXPECT_EQ(trace.at("motion").size(), 6U);
  EXPECT_EQ(trace.at("motion").at(2).size(), trace.at("time_s").size());
  EXPECT_NEAR(trace.at("motion").at(2).back().get<double>(), 2e-3, 2e-5);
}

/// At rest at each of its points, a sample apart, and too fast between them.
TEST(Simulate, WarnsOfATrajectoryThatIsFastBetweenSamples) {
  const TemporaryFolder folder;
  test::write_text(folder / "fast.csv", "time [s], z [mm]\n0, 0\n0.001, 7.3\n0.002, 0\n");
  test::write_text(folder / "slow.csv", "time [s], z [mm]\n0, 0\n0.4, 7.3\n0.8, 0\n");
  const auto command = [&](const char* name) {
    return run_hydrapod({"simulate", published, "--command", std::string("file ") + name, "--until",
                         "0.02", "--model", "rigid"},
                        {.folder = folder.path()});
  };
  EXPECT_THAT(command("fast.csv").err, AllOf(HasSubstr("warning: leg 1 must extend at "),
                                             HasSubstr("m/s at 0.0005 s, its valve gives ")));
  const auto slow = command("slow.csv");
  EXPECT_EQ(slow.exit_code, 0);
  EXPECT_THAT(slow.err, testing::Not(HasSubstr("warning")));
}

/// An equilibrium is there at 18 t, and the seals do not hold it: a step of 1 mm moves 10 mm.
TEST(Simulate, WarnsWhereItStartsFromAnUnstableEquilibrium) {
  const auto of_mass = [](const char* mass, std::vector<std::string> more) {
    std::vector<std::string> arguments{"simulate", model("heavy-platform"),
                                       "--set",    std::string("platform.mass=") + mass,
                                       "--until",  "0.02"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_hydrapod(arguments);
  };
  const std::string warning =
      "warning: the machine does not stay at its pose: the static equilibrium is unstable under "
      "the present load; `hydrapod check` states the cause, and the load that the legs carry\n";
  for (const std::vector<std::string>& moved :
       {std::vector<std::string>{"--command", "step z=1 mm"},
        {"--actuators", "springs", "--initial", "z=1 mm"},
        {"--actuators", "held"}}) {
    const auto buckled = of_mass("18 t", moved);
    EXPECT_EQ(buckled.exit_code, 0) << buckled.err;
    EXPECT_EQ(buckled.err, warning) << moved.back();
    EXPECT_EQ(of_mass("14 t", moved).err, "") << moved.back();
  }
  const auto unstable = run_hydrapod(
      {"simulate", model("heavy-platform"), "--set", "controller.gain=40", "--until", "0.02"});
  EXPECT_THAT(unstable.err, HasSubstr("warning: the closed loop is unstable: it oscillates at "));
}

TEST(Simulate, SaysThatStepsEndAtSamples) {
  const auto err = [](const char* step) {
    return run_hydrapod({"simulate", published, "--command", "step z=1 mm", "--until", "0.02",
                         "--model", "rigid", "--integrator", "fixed", "--step", step})
        .err;
  };
  EXPECT_THAT(err("50 ms"), HasSubstr("warning: the fixed integrator takes steps of at most 1 ms, "
                                      "not 50 ms: no step goes on beyond a sample"));
  EXPECT_THAT(err("1 ms"), testing::Not(HasSubstr("warning")));
}

/// The same samples in every format, with names, units and the machine file.
TEST(Simulate, WritesRecordsThatSayWhatTheyAre) {
  const TemporaryFolder folder;
  std::vector<double> ends;
  for (const std::string ending : {"csv", "h5", "mat"}) {
    const std::string path = (folder.path() / ("run." + ending)).string();
    const auto result =
        run_hydrapod({"simulate", published, "--command", "noise x=1 mm, ry=0.05 deg", "--until",
                      "0.3", "--dt-output", "2 ms", "--seed", "7", "-o", path});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto record = data::read_record(path).record;
    EXPECT_EQ(record.samples.rows(), 151);
    EXPECT_EQ(record.header.sample_rate, 500.0);
    EXPECT_EQ(record.header.experiment.machine, test::read_text(published));
    EXPECT_EQ(record.header.experiment.seed, 7U);
    EXPECT_FALSE(record.header.experiment.excitation);  // of no test rig
    EXPECT_THAT(record.header.notes, HasSubstr("noise x=1 mm, ry=0.05 deg"));
    const auto length = data::find_channel(record.header, "leg3.length");
    EXPECT_EQ(record.header.channels.at(length.value()).unit, "m");
    ends.push_back(last_of(record, "leg3.length"));
    EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  }
  EXPECT_EQ(ends[0], ends[1]);
  EXPECT_EQ(ends[0], ends[2]);
}

TEST(Simulate, TheSameSeedWritesTheSameFile) {
  const TemporaryFolder folder;
  std::vector<std::string> texts;
  for (int k = 0; k < 2; ++k) {
    const std::string path = (folder.path() / "one.csv").string();  // it stands in the record
    ASSERT_EQ(run_hydrapod({"simulate", published, "--command", "noise z=1 mm", "--until", "0.2",
                            "--seed", "11", "-o", path})
                  .exit_code,
              0);
    texts.push_back(test::read_text(path));
    std::filesystem::remove(path);
  }
  EXPECT_EQ(texts[0], texts[1]);
}

/// Oil springs hold the legs: half a period after the release the platform is on the other side.
TEST(Simulate, LetsTheMechanicsVibrateFreely) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& until) {
    const auto result = run_hydrapod(
        {"simulate", published, "--model", "rigid", "--actuators", "springs", "--initial",
         "z=0.2 mm", "--until", until, "--dt-output", "0.05 ms", "-o", "free.h5"},
        {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("released at z=0.2 mm"));
    EXPECT_THAT(result.out, HasSubstr("oil springs, no hydraulics"));
    EXPECT_THAT(result.out,
                HasSubstr("damping: oil springs by nothing; seals by 0.2 % of critical"));
    return data::read_record(folder.path() / "free.h5").record;
  };
  const auto json = nlohmann::json::parse(
      run_hydrapod({"modes", published, "--model", "rigid", "--format", "json"}).out);
  double z = 0.0;  // [Hz]
  for (const auto& mode : json.at("modes"))
    if (mode.at("label").get<std::string>().starts_with("z,")) z = mode.at("frequency_hz");
  ASSERT_GT(z, 1.0);
  const auto record = run(std::to_string(0.5 / z) + " s");
  EXPECT_NEAR(record.samples(0, *data::find_channel(record.header, "platform.z")), 2e-4, 1e-12);
  // rigid legs have no seals, and nothing damps the oil springs; z moves with rx and ry a little
  EXPECT_NEAR(last_of(record, "platform.z"), -2e-4, 1e-3 * 2e-4);
  EXPECT_FALSE(data::find_channel(record.header, "leg1.spool"));
  EXPECT_FALSE(data::find_channel(record.header, "command.x"));
}

/// An undamped mass on a spring moves twice as far under a step of force as it does at rest.
TEST(Simulate, ShakesThePlatform) {
  const TemporaryFolder folder;
  const auto json = nlohmann::json::parse(
      run_hydrapod({"modes", published, "--model", "rigid", "--format", "json", "--matrices"}).out);
  const double k = json.at("matrices").at("K").at(2).at(2);  // [N/m], of z
  const auto record_of = [&](const std::string& actuators) {
    const auto result =
        run_hydrapod({"simulate", published, "--model", "rigid", "--actuators", actuators,
                      "--wrench", "step z=900 N, at=0.01 s", "--until", "0.6", "-o", "pushed.h5"},
                     {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    auto record = data::read_record(folder.path() / "pushed.h5").record;
    std::filesystem::remove(folder.path() / "pushed.h5");
    return record;
  };
  const auto z_of = [](const data::Record& record) {
    return record.samples.col(*data::find_channel(record.header, "platform.z"));
  };
  const auto springs = record_of("springs"), held = record_of("held");
  EXPECT_NEAR(z_of(springs).maxCoeff(), 2.0 * 900.0 / k, 0.01 * 900.0 / k);  // samples of 1 ms
  EXPECT_EQ(last_of(held, "wrench.z"), 900.0);
  EXPECT_TRUE(data::find_channel(held.header, "leg1.spool"));
  // held valves leak: the oil is the same spring at first
  EXPECT_NEAR(z_of(held).head(60).maxCoeff(), 2.0 * 900.0 / k, 0.1 * 900.0 / k);
}

TEST(Simulate, DrawsAPicture) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "run.svg").string();
  const auto result = run_hydrapod(
      {"simulate", published, "--command", "step z=2 mm", "--until", "0.5", "--plot", path});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(test::read_text(path), AllOf(HasSubstr("<svg"), HasSubstr("drives at the valves")));
}

TEST(Simulate, FollowsAFileAndNamesItsMistakes) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "motion.csv";
  std::ofstream(path) << "time [s], z [mm], rz [deg]\n0, 0, 0\n0.5, 4, 0.5\n1, 4, 0\n";
  const std::string record = (folder.path() / "run.csv").string();
  const auto result = run_hydrapod(
      {"simulate", published, "--command", "file " + path.string(), "--until", "5", "-o", record});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NEAR(last_of(data::read_record(record).record, "platform.z"), 4e-3, 2e-5);

  std::ofstream(path) << "time [s], z [mm]\n0, 0\n0.5, nan\n";
  const auto wrong = run_hydrapod({"simulate", published, "--command", "file " + path.string()});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(wrong.err, path.string() + ":3:6: error: z is 'nan', expected a finite number\n");
}

TEST(Simulate, RefusesAMotionThatLeavesTheWorkspace) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.csv";
  const auto result = run_hydrapod({"simulate", model("heavy-platform"), "--command",
                                    "sine z=0.2 m, frequency=0.5", "-o", path.string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("error: leg 1 needs "));
  EXPECT_THAT(result.err, HasSubstr(" mm more stroke than it has extending at "));
  EXPECT_FALSE(std::filesystem::exists(path));
}

/// 20 mm higher the heavy machine's legs buckle under their load, 5 mm higher they do not.
TEST(Simulate, SaysWhereTheCommandLeavesWhatTheLegsHold) {
  const auto err = [](const char* command, const char* gravity = "9.80665") {
    return run_hydrapod({"simulate", model("heavy-platform"), "--command", command, "--until",
                         "0.6", "--set", std::string("environment.gravity=") + gravity})
        .err;
  };
  EXPECT_THAT(err("step z=20 mm"),
              HasSubstr("warning: at 0.1 s the command is z=20 mm, where the legs buckle: "));
  EXPECT_THAT(err("step z=20 mm, rx=0.1 deg, at=0.3"),
              HasSubstr("at 0.3 s the command is z=20 mm, rx=0.1 deg, where "));
  EXPECT_THAT(err("step z=5 mm"), testing::Not(HasSubstr("buckle")));
  EXPECT_THAT(err("step z=20 mm", "0"), testing::Not(HasSubstr("buckle")));
  const auto rig = run_hydrapod({"rig", model("heavy-platform"), "--excite",
                                 "sine z=20 mm, frequency=0.5", "--duration", "3", "--check"});
  EXPECT_THAT(rig.out + rig.err, HasSubstr(" the command is z="));
}

/// Six legs and their joints are beyond their limits for one cause.
TEST(Simulate, GuessesTheUnitOfACommandThatCannotBe) {
  const auto err = [](const char* command) {
    const auto result = run_hydrapod({"simulate", model("heavy-platform"), "--command", command});
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  const auto plain = err("step z=5");
  EXPECT_THAT(plain, AllOf(testing::StartsWith("--command step z=5: error: leg 1 needs "),
                           testing::EndsWith("; did you mean \"step z=5 mm\"?\n")));
  EXPECT_EQ(std::count(plain.begin(), plain.end(), '\n'), 1);
  EXPECT_THAT(
      err("sine ry=-2.5, x = 1e1, frequency=1 Hz"),
      testing::EndsWith("; did you mean \"sine ry=-2.5 deg, x = 1e1 mm, frequency=1 Hz\"?\n"));
  EXPECT_THAT(err("step z=5 m"), testing::Not(HasSubstr("did you mean")));
  EXPECT_THAT(err("step z=5000"), testing::Not(HasSubstr("did you mean")));
}

TEST(Simulate, WithoutAControllerNothingFollowsACommand) {
  const auto refused = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"simulate", published});
    const auto result = run_hydrapod(more);
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(refused({"--actuators", "springs", "--command", "step z=1 mm"}),
              HasSubstr("--command: error: without the controller nothing follows a command"));
  EXPECT_THAT(refused({"--actuators", "held", "--initial", "z=1 mm"}),
              HasSubstr("--initial z=1 mm: error: held valves hold the platform where it stands"));
  EXPECT_THAT(refused({"--actuators", "spring"}), HasSubstr("did you mean 'springs'"));
  EXPECT_THAT(refused({"--initial", "z=3 m"}), HasSubstr("--initial z=3 m: error: "));
  EXPECT_THAT(refused({"--initial", "z=3"}), HasSubstr("did you mean \"z=3 mm\"?"));
  EXPECT_THAT(refused({"--initial", "u=3 mm"}), HasSubstr("--initial u=3 mm: error: "));
  EXPECT_THAT(refused({"--wrench", "step z=5 mm"}), HasSubstr("--wrench step z=5 mm: error: "));
}

TEST(Simulate, MistakesInArgumentsAreNamed) {
  const auto complaint = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"simulate", published});
    const auto result = run_hydrapod(arguments);
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_EQ(complaint({"--command", "sine z=1 mm, frequency=600"}),
            "--command sine z=1 mm, frequency=600: error: sine: frequency is 600, expected more "
            "than 0 and less than 500 Hz, half the sample rate\n");
  EXPECT_EQ(complaint({"--until", "-1"}), "--until -1: error: expected a time of more than 0 s\n");
  EXPECT_EQ(complaint({"--integrator", "euler"}),
            "--integrator euler: error: unknown value; accepted are exponential, adaptive, adams, "
            "bdf, fixed\n");
  EXPECT_EQ(complaint({"--tolerance", "1"}), "--tolerance 1: error: expected 1e-13 to 0.01\n");
  EXPECT_EQ(complaint({"--step", "10 us"}),
            "--step 10 us: error: is of the fixed integrator; add --integrator fixed\n");
  EXPECT_EQ(complaint({"--integrator", "fixed", "--tolerance", "1e-8"}),
            "--tolerance 1e-08: error: the fixed integrator has a step and no tolerance; give "
            "--step\n");
  EXPECT_THAT(complaint({"-o", "run.xyz"}), HasSubstr("run.xyz"));
  EXPECT_EQ(complaint({"--plot", "run.gif"}),
            "--plot run.gif: error: a plot ends in .svg, .png or .pdf; found '.gif'\n");
}

TEST(Simulate, ARunThatFailsKeepsWhatItHas) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "run.h5").string();
  // The platform is driven beyond a joint's limit by overshoot: the command itself stays within.
  const auto result =
      run_hydrapod({"simulate", published, "--command", "step x=30 mm", "--set",
                    "legs.joint_limits.base=0.035", "--set", "controller.gain=33", "-o", path});
  EXPECT_EQ(result.exit_code, 1) << result.out;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("error: the run ended at "), HasSubstr("beyond its limit of 2.01°"),
                    HasSubstr("contains the run up to this time")));
  const auto record = data::read_record(path).record;
  EXPECT_GT(record.samples.rows(), 100);
  EXPECT_TRUE(record.samples.allFinite());
}

/// Runs a shell line in `folder` with the program's folder in PATH.
test::RunResult shell(const TemporaryFolder& folder, const std::string& line) {
  const std::string path =
      test::hydrapod_program().parent_path().string() + ':' + std::getenv("PATH");
  return test::run_program("sh", {"-c", line},
                           {.folder = folder.path(), .variables = {{"PATH", path}}});
}

const std::string long_run =
    "hydrapod simulate '" + published + "' --model rigid --command 'noise x=1 mm' --until 600 -o ";

TEST(Simulate, AnInterruptedRunLeavesAFile) {
  for (const std::string ending : {"csv", "h5", "mat"}) {
    const TemporaryFolder folder;
    const auto result = shell(folder, long_run + "run." + ending +
                                          " > out 2> err & pid=$!; "
                                          "for i in $(seq 200); do [ -e run.*.part ] && break; "
                                          "sleep 0.1; done; sleep 1.5; kill -INT $pid; "
                                          "wait $pid; echo \"left $?\"");
    EXPECT_THAT(result.out, HasSubstr("left 1"));
    EXPECT_THAT(test::read_text(folder.path() / "err"), HasSubstr("s of 600 s: interrupted"));
    const auto record = data::read_record((folder.path() / ("run." + ending)).string()).record;
    EXPECT_GT(record.samples.rows(), 10);
    EXPECT_TRUE(record.samples.allFinite());
  }
}

TEST(Simulate, OfAKilledRunWhatWasWrittenCanBeRead) {
  for (const std::string ending : {"csv", "h5"}) {
    const TemporaryFolder folder;
    // Killed once the part has some size, however fast the machine is.
    shell(folder, long_run + "run." + ending +
                      " > out 2> err & pid=$!; "
                      "for k in $(seq 300); do sleep 0.1; "
                      "[ \"$(stat -c %s run." +
                      ending +
                      ".part 2>/dev/null || echo 0)\" -gt 1500000 ] "
                      "&& break; done; kill -KILL $pid; wait $pid");
    EXPECT_FALSE(std::filesystem::exists(folder.path() / ("run." + ending)));
    const auto record =
        data::read_record((folder.path() / ("run." + ending + ".part")).string()).record;
    EXPECT_GT(record.samples.rows(), 500) << ending;
    EXPECT_TRUE(record.samples.allFinite());
  }
}

void expect_readable_part(const std::filesystem::path& part) {
  const auto record = data::read_record(part.string()).record;
  EXPECT_GT(record.samples.rows(), 500) << part;
  EXPECT_TRUE(record.samples.allFinite());
}

/// A disk that is full after some megabytes, as a limit on the size of files.
TEST(Simulate, OnAFullDiskWhatWasWrittenCanBeRead) {
  const TemporaryFolder folder;
  const auto result = shell(folder, "trap '' XFSZ; ulimit -f 8000; " + long_run + "run.csv");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err,
            "error: writing 'run.csv' failed; is the disk full? run.csv.part holds what was "
            "written before\n");
  expect_readable_part(folder / "run.csv.part");
}

/// A file system of 4 MB in a namespace of its own.
TEST(Simulate, OnAFullFileSystemWhatWasWrittenCanBeRead) {
  const TemporaryFolder folder;
  if (shell(folder, "mkdir small && unshare -rm mount -t tmpfs -o size=4m tmpfs small").exit_code !=
      0)
    GTEST_SKIP() << "no file system can be mounted here";
  for (const std::string ending : {"csv", "h5"}) {
    const auto result =
        shell(folder, "unshare -rm sh -c \"mount -t tmpfs -o size=4m tmpfs small && cd small && " +
                          long_run + "run." + ending + "; cp run.* ..\"");
    EXPECT_EQ(result.err, "error: writing 'run." + ending + "' failed; is the disk full? run." +
                              ending + ".part holds what was written before\n");
    expect_readable_part(folder / ("run." + ending + ".part"));
  }
}

TEST(Simulate, ShowsItsController) {
  const auto result = run_hydrapod({"simulate", published, "--show-controller"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("14.05 1/s"), HasSubstr("0.3 of 46.84 rad/s, the lowest oil mode")));
}

TEST(SystemModes, SayWhetherTheLoopIsStable) {
  const auto stable = run_hydrapod({"modes", published, "--system"});
  EXPECT_EQ(stable.exit_code, 0) << stable.err;
  EXPECT_THAT(stable.out, AllOf(HasSubstr("\nstable: "), HasSubstr("platform z"),
                                HasSubstr("controller"), HasSubstr("valves")));
  const auto unstable =
      run_hydrapod({"modes", published, "--system", "--set", "controller.gain=60"});
  EXPECT_THAT(unstable.out, HasSubstr("\nUNSTABLE: an oscillation at "));
  const auto json = nlohmann::json::parse(
      run_hydrapod({"modes", published, "--system", "--model", "rigid", "--format", "json"}).out);
  EXPECT_EQ(json.at("kind"), "system");
  EXPECT_EQ(json.at("stable"), true);
  EXPECT_EQ(json.at("delay").at("pade_order"), 2);
  EXPECT_NEAR(json.at("delay").at("seconds").get<double>(), 1.5e-3, 1e-15);
}

/// Just below the limit the poles of the approximation grow, those of the sampled loop do not.
TEST(SystemModes, MarkThePolesOfWhichTheVerdictSpeaks) {
  const std::vector<std::string> words{"modes", published, "--system", "--set"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return run_hydrapod(more).out;
  };
  const auto table = with({"controller.gain=33.9"});
  EXPECT_THAT(table, AllOf(testing::ContainsRegex(
                               "  stable, sampled  platform x.*\n.*  stable, sampled  platform y"),
                           testing::Not(HasSubstr("  UNSTABLE")), HasSubstr("\nstable: "),
                           HasSubstr("; the continuous approximation would be unstable\n")));
  const auto json = nlohmann::json::parse(with({"controller.gain=33.9", "--format", "json"}));
  for (const auto& pole : json.at("poles")) EXPECT_EQ(pole.at("stable"), true);
  EXPECT_THAT(with({"controller.gain=34.03"}),
              AllOf(HasSubstr("  UNSTABLE  platform x"), HasSubstr("  UNSTABLE  platform y"),
                    testing::Not(HasSubstr("sampled  ")), HasSubstr("\nUNSTABLE: ")));
}

TEST(SystemModes, WithoutTheControllerTheOilModesAreThoseOfTheMechanics) {
  const auto result =
      run_hydrapod({"modes", published, "--open-loop", "--model", "rigid", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_FALSE(json.contains("controller"));
  // valves shut: the oil springs are those of the static model, to what the damping shifts
  const double expected[]{46.839, 46.839, 112.065, 143.364, 189.241, 189.241};
  std::vector<double> oil;
  for (const auto& pole : json.at("poles"))
    if (pole.at("pole").at("im") > 1.0 && pole.at("damping_ratio") < 0.3)
      oil.push_back(pole.at("omega_rad_s"));
  std::ranges::sort(oil);
  ASSERT_EQ(oil.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(oil[k] / expected[k], 1.0, 2e-3);
  const auto table = run_hydrapod({"modes", published, "--open-loop", "--model", "rigid"});
  EXPECT_THAT(table.out, AllOf(HasSubstr("without controller"), HasSubstr("the pose is not held"),
                               testing::Not(HasSubstr("UNSTABLE"))));
}

TEST(SystemModes, RootLocusFindsTheLimitOfStability) {
  const auto result = run_hydrapod({"modes", published, "--model", "rigid", "--format", "json",
                                    "--root-locus", "controller.gain=20:60:5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json.at("limits").size(), 1U);
  const double limit = json.at("limits").at(0);
  for (const auto& [factor, verdict] :
       {std::pair{0.999, "\nstable"}, std::pair{1.001, "\nUNSTABLE"}})
    EXPECT_THAT(run_hydrapod({"modes", published, "--model", "rigid", "--system", "--set",
                              "controller.gain=" + std::to_string(factor * limit)})
                    .out,
                HasSubstr(verdict));
  const auto wrong = run_hydrapod({"modes", published, "--root-locus", "controller.gain=20"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(wrong.err,
            "--root-locus controller.gain=20: error: only one number, expected KEY=from:to:count "
            "with numbers in SI, for instance controller.gain=5:80:16\n");
}

TEST(CommandBode, ShowsBandwidths) {
  const auto result = run_hydrapod(
      {"bode", published, "--input", "command", "--points", "300", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("input"), "command");
  const auto& x = json.at("bandwidths").at(0);
  EXPECT_GT(x.at("minus_3_db_hz").get<double>(), x.at("minus_90_deg_hz").get<double>());
  EXPECT_EQ(json.at("response").at("z").at("z").at("re").size(), 300U);
}

}  // namespace
}  // namespace hydrapod
