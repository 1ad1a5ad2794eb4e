/// What a command writes over, and what it never does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {
using test::run_hydrapod;
using testing::HasSubstr;
namespace fs = std::filesystem;

data::Record small_record() {
  data::Record record;
  record.header.sample_rate = 97.0;
  record.header.channels = {{.name = "force", .unit = "N", .role = data::Role::excitation},
                            {.name = "motion", .unit = "m", .role = data::Role::response}};
  record.samples = data::Samples::Random(400, 2);
  return record;
}

class OutputFiles : public testing::Test {
 protected:
  OutputFiles() {
    test::write_text(folder / "m.toml", model::starter_machine_file());
    data::write_record((folder / "run.h5").string(), small_record(), data::RecordFormat::hdf5);
    data::write_record((folder / "run.csv").string(), small_record(), data::RecordFormat::csv);
  }
  test::RunResult run(const std::vector<std::string>& arguments) {
    return run_hydrapod(arguments, {.folder = folder.path()});
  }
  /// Refused with exit code 2, this in the message, and nothing changed.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& file,
                      const std::string& message) {
    const auto before = test::read_text(folder / file);
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.err, HasSubstr(message)) << testing::PrintToString(arguments);
    EXPECT_EQ(test::read_text(folder / file), before);
  }

  test::TemporaryFolder folder;
};

TEST_F(OutputFiles, NoInputIsWrittenOver) {
  const std::string message = "is the input";
  for (const std::string record : {"run.h5", "run.csv"}) {
    for (const std::string command : {"identify", "frf"})
      expect_refused({command, record, "-o", record, "--force"}, record, message);
    expect_refused({"record", "convert", record, "-o", record, "--force"}, record, message);
    expect_refused({"identify", record, "--plot", record}, record, message);
    expect_refused({"diagnose", "m.toml", "--measured", record + "@neutral", "-o", record}, record,
                   message);
    expect_refused({"report", "m.toml", "--measured", record, "-o", record}, record, message);
  }
  for (const std::string command : {"modes", "check", "bode", "report", "diagnose", "sensitivity"})
    expect_refused({command, "m.toml", "-o", "m.toml", "--force"}, "m.toml", message);
  expect_refused({"rig", "m.toml", "-o", "m.toml"}, "m.toml", message);
  expect_refused({"rig", "m.toml", "--excite", "file run.csv", "-o", "run.csv", "--force"},
                 "run.csv", message);
}

TEST_F(OutputFiles, AnotherNameOfAnInputIsTheInput) {
  fs::create_symlink("run.h5", folder / "link.h5");
  fs::create_hard_link(folder / "run.h5", folder / "hard.h5");
  for (const std::string name : {"./run.h5", "link.h5", "hard.h5"})
    expect_refused({"frf", "run.h5", "-o", name, "--force"}, "run.h5", "is the input");
  expect_refused({"frf", "link.h5", "-o", "run.h5", "--force"}, "run.h5", "is the input");
  // a signal's file, with blanks as the signal's text may have them
  for (const char* command : {"file run.csv", "  file   run.csv ", "file,run.csv"})
    expect_refused({"simulate", "m.toml", "--command", command, "-o", "./run.csv", "--force"},
                   "run.csv", "is the input");
}

TEST_F(OutputFiles, TwoOutputsAreTwoFiles) {
  const auto result = run({"bode", "m.toml", "--plot", "a.svg", "-o", "./a.svg"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--plot writes the same file"));
  EXPECT_FALSE(fs::exists(folder / "a.svg"));
}

TEST_F(OutputFiles, RecordsAndMachinesAreReplacedByForceAlone) {
  expect_refused({"modes", "m.toml", "-o", "run.csv"}, "run.csv", "a record exists there");
  expect_refused({"modes", "m.toml", "-o", "run.h5"}, "run.h5", "a record exists there");
  expect_refused({"record", "convert", "run.csv", "-o", "run.h5"}, "run.h5",
                 "a record exists there");
  test::write_text(folder / "other.toml", "mine");
  expect_refused({"modes", "m.toml", "-o", "other.toml"}, "other.toml",
                 "a machine file or study exists there");
  test::write_text(folder / "f.csv", "f [Hz],re a/F [m/s^2/N],im a/F [m/s^2/N]\n1,2,3\n2,3,4\n");
  expect_refused({"bode", "m.toml", "-o", "f.csv"}, "f.csv",
                 "a file of frequency responses exists there");
  test::write_text(folder / "list.csv", "frequency,direction\n4.31 Hz,x\n");
  expect_refused({"modes", "m.toml", "-o", "list.csv"}, "list.csv", "a file of modes exists there");
  test::write_text(folder / "notes.txt", "mine");
  expect_refused({"sweep", "m.toml", "--over", "platform.mass=1:2:3 t", "--results", "notes.txt"},
                 "notes.txt", "a file exists there");
  const auto forced = run({"record", "convert", "run.csv", "-o", "run.h5", "--force"});
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_THAT(forced.err, HasSubstr("wrote run.h5"));
}

/// Every kind of result that is written, by every command, is known again.
TEST_F(OutputFiles, AResultIsReplacedAndAnnounced) {
  test::write_text(folder / "heavier.toml", test::read_text(folder / "m.toml"));
  const std::vector<std::vector<std::string>> commands{
      {"modes", "m.toml", "-o", "a.json"},
      {"modes", "m.toml", "-o", "a.csv"},
      {"modes", "m.toml", "-o", "a.txt"},
      {"modes", "m.toml", "-o", "without-ending"},
      {"modes", "m.toml", "--system", "-o", "b.csv"},
      {"modes", "m.toml", "--system", "-o", "b.txt"},
      {"modes", "m.toml", "--root-locus", "controller.gain=5:50:3", "-o", "c.csv"},
      {"modes", "m.toml", "--poses", "all", "-o", "d.csv"},
      {"modes", "m.toml", "--poses", "all", "-o", "d.txt"},
      {"modes", "m.toml", "--amplitude", "1 mm", "-o", "e.csv"},
      {"modes", "m.toml", "--amplitude", "1 mm", "-o", "e.txt"},
      {"bode", "m.toml", "--points", "20", "-o", "f.csv"},
      {"bode", "m.toml", "--points", "20", "-o", "f.txt"},
      {"bode", "m.toml", "--points", "20", "-o", "f.json"},
      {"bode", "m.toml", "--points", "20", "--input", "command", "-o", "g.csv"},
      {"check", "m.toml", "-o", "h.txt"},
      {"sensitivity", "m.toml", "-o", "i.csv"},
      {"sensitivity", "m.toml", "-o", "i.txt"},
      {"compare", "m.toml", "heavier.toml", "-o", "j.csv"},
      {"compare", "m.toml", "heavier.toml", "-o", "j.txt"},
      {"sweep", "m.toml", "--over", "platform.mass=1:2:3 t", "--csv", "l.csv", "-o", "k.txt"},
      {"frf", "run.csv", "-o", "m.csv"},
      {"frf", "run.csv", "-o", "m.txt"},
      {"frf", "run.csv", "-o", "m.json"},
      {"identify", "run.csv", "-o", "n.csv"},
      {"identify", "run.csv", "-o", "n.txt"},
      {"identify", "run.csv", "-o", "n.uff"},
      {"record", "show", "run.csv", "-o", "o.txt"},
      {"record", "show", "run.csv", "-o", "o.json"},
      {"report", "m.toml", "-o", "p.html"},
      {"export", "m.toml", "--to", "json", "-o", "q.json"},
      {"export", "m.toml", "--to", "mat", "--sample-time", "1 ms", "-o", "q.mat"},
      {"export", "m.toml", "--to", "hdf5", "--sample-time", "1 ms", "-o", "q.h5"},
      {"export", "m.toml", "--to", "dmig", "-o", "q.pch"},
      {"export", "m.toml", "--to", "mtx", "-o", "q.mtx"},
      {"export", "m.toml", "--to", "sdf", "--approximate", "-o", "q.sdf"},
      {"export", "m.toml", "--to", "urdf", "--approximate", "-o", "q.urdf"},
      {"export", "m.toml", "--to", "mjcf", "--approximate", "-o", "q.xml"}};
  for (const auto& command : commands)
    for (int time = 0; time < 2; ++time) {
      const auto result = run(command);
      EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(command) << result.err;
      const std::string stem = command.back().substr(0, command.back().find('.'));
      EXPECT_THAT(result.err + result.out, HasSubstr("wrote " + stem));
    }
}

/// A sampled state space has matrices and a sample time, as records of other programs have.
TEST_F(OutputFiles, AStateSpaceIsNoRecord) {
  for (const std::string file : {"q.mat", "q.h5"}) {
    ASSERT_EQ(run({"export", "m.toml", "--to", file == "q.mat" ? "mat" : "hdf5", "--sample-time",
                   "1 ms", "-o", file})
                  .exit_code,
              0);
    const auto shown = run({"record", "show", file});
    EXPECT_EQ(shown.exit_code, 2);
    EXPECT_THAT(shown.err, HasSubstr("holds a state space that `hydrapod export` wrote"));
  }
}

/// What somebody wrote is not what a program wrote, though it speaks of it and has its endings.
TEST_F(OutputFiles, ATextOfSomebodyElseIsReplacedByForceAlone) {
  const std::string message = "a text that hydrapod did not write exists there";
  const std::string notes = "Modes\n\nwritten by hydrapod on Monday:\n4.1 Hz in x\n";
  for (const std::string file : {"notes.txt", "notes.md", "notes", "notes.xml"}) {
    test::write_text(folder / file, notes);
    expect_refused({"modes", "m.toml", "-o", file}, file, message);
    expect_refused({"export", "m.toml", "--to", "mjcf", "--approximate", "-o", file}, file,
                   message);
  }
  test::write_text(folder / "package.json", R"({"name": "hydrapod", "version": "1"})");
  expect_refused({"modes", "m.toml", "-o", "package.json"}, "package.json", message);
  test::write_text(folder / "parts.csv", "part,price\nhydrapod valve,three hundred\n");
  expect_refused({"modes", "m.toml", "-o", "parts.csv"}, "parts.csv", message);
  expect_refused({"sweep", "m.toml", "--over", "platform.mass=1:2:3 t", "--csv", "parts.csv"},
                 "parts.csv", message);
  test::write_text(folder / "page.html", "<html>mine</html>");
  expect_refused({"report", "m.toml", "-o", "page.html"}, "page.html", message);
  test::write_text(folder / "q.M.mtx", "mine");  // beside the name that was given
  expect_refused({"export", "m.toml", "--to", "mtx", "-o", "q.mtx"}, "q.M.mtx", message);
  const auto forced = run({"modes", "m.toml", "-o", "notes.txt", "--force"});
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_EQ(run({"export", "m.toml", "--to", "mtx", "-o", "q.mtx", "--force"}).exit_code, 0);
  test::write_text(folder / "empty.txt", "");
  EXPECT_EQ(run({"modes", "m.toml", "-o", "empty.txt"}).exit_code, 0);
}

TEST_F(OutputFiles, APlaceThatCannotBeWrittenIsSaidAtOnce) {
  for (const std::string command : {"modes", "bode", "report", "diagnose"}) {
    const auto result = run({command, "m.toml", "-o", "no/where.json"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "no/where.json: error: cannot write the file: there is no folder 'no'\n");
  }
}

TEST_F(OutputFiles, TwoRunsAtOnceLeaveOneWholeRecord) {
  const auto rig = [&](const std::string& seed) {
    return run({"rig", "m.toml", "--duration", "2", "--seed", seed, "-o", "x.mat"});
  };
  test::RunResult first, second;
  std::thread other([&] { first = rig("1"); });
  second = rig("2");
  other.join();
  EXPECT_EQ((first.exit_code == 0) + (second.exit_code == 0), 1) << first.err << second.err;
  const std::string seed = first.exit_code == 0 ? "1" : "2";
  EXPECT_THAT((first.exit_code == 0 ? second : first).err,  // by which came first
              testing::AnyOf(HasSubstr("x.mat.part"), HasSubstr("a record exists there"),
                             HasSubstr("x.mat: error: was written by another program meanwhile")));
  const auto alone = run({"rig", "m.toml", "--duration", "2", "--seed", seed, "-o", "y.mat"});
  EXPECT_EQ(alone.exit_code, 0);
  const auto x = data::read_record((folder / "x.mat").string()).record.samples,
             y = data::read_record((folder / "y.mat").string()).record.samples;
  EXPECT_TRUE(x == y);
}

TEST_F(OutputFiles, APartOfAnotherRunIsLeftAloneAndNoLinkIsFollowed) {
  test::write_text(folder / "precious", "mine");
  fs::create_symlink("precious", folder / "x.h5.part");
  const auto result = run({"rig", "m.toml", "--duration", "1", "-o", "x.h5"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(test::read_text(folder / "precious"), "mine");
  EXPECT_TRUE(fs::is_symlink(folder / "x.h5.part"));
  EXPECT_FALSE(fs::exists(folder / "x.h5.part2"));
}

TEST_F(OutputFiles, TheEndingSaysTheFormat) {
  for (const std::string command : {"modes", "check"}) {
    ASSERT_EQ(run({command, "m.toml", "-o", "a.json"}).exit_code, 0);
    auto by_ending = nlohmann::json::parse(test::read_text(folder / "a.json"));
    auto by_option = nlohmann::json::parse(run({command, "m.toml", "--format", "json"}).out);
    for (auto* json : {&by_ending, &by_option}) json->erase("reproduction");  // another command
    EXPECT_EQ(by_ending, by_option);
    ASSERT_EQ(run({command, "m.toml", "-o", "a.txt"}).exit_code, 0);
    EXPECT_THAT(test::read_text(folder / "a.txt"),
                testing::MatchesRegex("(.|\n)*\n\nwritten by hydrapod [0-9.]+(, commit .*)?\n"));
    EXPECT_THAT(test::read_text(folder / "a.txt"),
                testing::StartsWith(run({command, "m.toml"}).out));
  }
  ASSERT_EQ(run({"modes", "m.toml", "-o", "a.CSV"}).exit_code, 0);
  EXPECT_EQ(test::read_text(folder / "a.CSV"), run({"modes", "m.toml", "--format", "csv"}).out);
}

TEST_F(OutputFiles, AnEndingOfOtherContentsIsRefusedBeforeTheWork) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& message) {
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.err, HasSubstr(message)) << testing::PrintToString(arguments);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder / arguments.back()));
  };
  for (const std::string name : {"a.h5", "a.MAT", "a.png", "a.uff", "a.html", "a.toml"})
    refused({"modes", "m.toml", "-o", name},
            name + ": error: the ending '" + name.substr(1) +
                "' does not fit the content: this command writes table, json, csv");
  refused({"check", "m.toml", "-o", "a.csv"}, "this command writes table, json (");
  refused({"identify", "run.h5", "-o", "a.svg"}, "this command writes table, json, csv, uff, mat");
  refused({"bode", "m.toml", "--format", "csv", "-o", "a.json"},
          "the ending '.json' does not fit --format csv");
  refused({"report", "m.toml", "-o", "a.json"}, "report writes .html");
  refused({"report", "m.toml", "--from", "nan", "-o", "a.html"},
          "--from nan: error: needs --measured");
  refused({"rig", "m.toml", "-o", "a.json"}, "names no format of records");
}

TEST_F(OutputFiles, MessagesThatNobodyReadsChangeNothing) {
  for (const std::string where : {"2>&-", "2>/dev/full"}) {
    const std::string program = test::hydrapod_program().string();
    const auto good = test::run_program("sh", {"-c", program + " modes m.toml -o a.json " + where},
                                        {.folder = folder.path()});
    EXPECT_EQ(good.exit_code, 0) << where;
    EXPECT_TRUE(fs::remove(folder / "a.json")) << where;
    const auto bad = test::run_program("sh", {"-c", program + " modes none.toml " + where},
                                       {.folder = folder.path()});
    EXPECT_EQ(bad.exit_code, 2) << where;
  }
}

}  // namespace
}  // namespace hydrapod
