/// Files of `hydrapod montecarlo`, `sweep` and `map`: rows of other runs and of other studies, and
/// the machine that a study file names.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "hydrapod/base/text.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

const std::string small_machine =
    test::source_file("models/zhang-jiang-2021-transverse.toml").string();

/// Of a table, without the comments above it.
std::vector<std::string> rows_of(const std::string& table) {
  std::vector<std::string> rows;
  for (const auto& line : base::split(table, "\n"))
    if (!line.empty() && !line.starts_with("#")) rows.emplace_back(line);
  return rows;
}

struct StudyFiles : testing::Test {
  test::TemporaryFolder folder{};
  [[nodiscard]] test::RunResult run(const std::vector<std::string>& words) const {
    return test::run_hydrapod(words, {.folder = folder.path()});
  }
  [[nodiscard]] test::RunResult masses(const std::string& range,
                                       const std::vector<std::string>& more) const {
    std::vector<std::string> words{"montecarlo", small_machine, "--vary", "platform.mass=" + range};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
};

/// Parts of one study are no result of another, whose columns would name them.
TEST_F(StudyFiles, PartsOfAnotherStudyAreNotJoined) {
  const std::vector<std::string> part{"--samples", "200", "--results", "run.h5", "--shard"};
  for (const char* shard : {"1/2", "2/2"}) {
    auto words = part;
    words.emplace_back(shard);
    ASSERT_EQ(masses("uniform 800 .. 801 kg", words).exit_code, 0);
  }
  auto join = part;
  join.insert(join.end(), {"2", "--join"});
  const auto other = masses("uniform 900 .. 901 kg", join);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_EQ(other.out, "");
  EXPECT_THAT(other.err, HasSubstr("run.h5.rows1of2: error: is of another study"));
  EXPECT_FALSE(fs::exists(folder / "run.h5"));
  EXPECT_EQ(masses("uniform 800 .. 801 kg", join).exit_code, 0);
}

/// --resume and --join do not replace what is of another study.
TEST_F(StudyFiles, ResultsOfAnotherStudyStay) {
  const std::vector<std::string> whole{"--samples", "100", "--results", "run.h5"};
  ASSERT_EQ(masses("uniform 800 .. 801 kg", whole).exit_code, 0);
  const auto before = test::read_text(folder / "run.h5");
  auto resumed = whole;
  resumed.emplace_back("--resume");
  const auto other = masses("uniform 900 .. 901 kg", resumed);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("run.h5: error: is a file of something else than this study"));
  EXPECT_EQ(test::read_text(folder / "run.h5"), before);
  EXPECT_EQ(masses("uniform 800 .. 801 kg", resumed).exit_code, 0);
  EXPECT_EQ(test::read_text(folder / "run.h5"), before);

  auto part = whole;
  part.insert(part.end(), {"--shard", "1/1"});
  ASSERT_EQ(masses("uniform 900 .. 901 kg", whole).exit_code, 2);
  auto join = whole;
  join.insert(join.end(), {"--shard", "1", "--join"});
  EXPECT_EQ(masses("uniform 900 .. 901 kg", join).exit_code, 2);
  EXPECT_EQ(test::read_text(folder / "run.h5"), before);
  resumed.emplace_back("--force");
  EXPECT_EQ(masses("uniform 900 .. 901 kg", resumed).exit_code, 0);
  EXPECT_NE(test::read_text(folder / "run.h5"), before);
}

/// Hours of work: a run that was killed leaves rows, and the same command without --resume would
/// begin with an empty file.
TEST_F(StudyFiles, RowsOfAnInterruptedRunAreReplacedByForceAlone) {
  const std::vector<std::string> words{"--samples", "200", "--results", "run.h5", "--shard", "1/2"};
  ASSERT_EQ(masses("uniform 800 .. 801 kg", words).exit_code, 0);
  fs::rename(folder / "run.h5.rows1of2", folder / "whole.h5.rows");
  const auto rows = test::read_text(folder / "whole.h5.rows");
  const auto again = masses("uniform 800 .. 801 kg", {"--samples", "200", "--results", "whole.h5"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("whole.h5.rows: error: holds rows of an interrupted study or of "
                                   "a part; --resume goes on with them, --force begins anew"));
  EXPECT_EQ(test::read_text(folder / "whole.h5.rows"), rows);
  const auto forced =
      masses("uniform 800 .. 801 kg", {"--samples", "200", "--results", "whole.h5", "--force"});
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_FALSE(fs::exists(folder / "whole.h5.rows"));
}

TEST_F(StudyFiles, NoOtherFileBecomesRows) {
  const std::vector<std::string> words{"--samples", "100", "--force"};
  test::write_text(folder / "notes", "precious\n");
  fs::create_symlink("notes", folder / "study.h5.rows");
  const auto link = masses("uniform 800 .. 801 kg", words);
  EXPECT_EQ(link.exit_code, 2);
  EXPECT_THAT(link.err, HasSubstr("study.h5.rows: error: is a link and was left as it is"));
  fs::remove(folder / "study.h5.rows");
  fs::rename(folder / "notes", folder / "study.h5.rows");
  for (const char* more : {"--force", "--resume"}) {
    const auto text = masses("uniform 800 .. 801 kg", {"--samples", "100", more});
    EXPECT_EQ(text.exit_code, 2);
    EXPECT_THAT(text.err, HasSubstr("study.h5.rows: error: is no file of a study's rows"));
    EXPECT_EQ(test::read_text(folder / "study.h5.rows"), "precious\n");
  }
}

/// The second of two runs of one name does not write into the rows of the first.
TEST_F(StudyFiles, RowsHaveOneWriter) {
  const auto rows = (folder / "study.h5.rows").string();
  const int first = ::open(rows.c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(::flock(first, LOCK_EX), 0);
  for (const char* more : {"--force", "--resume"}) {
    const auto second = masses("uniform 800 .. 801 kg", {"--samples", "100", more});
    EXPECT_EQ(second.exit_code, 2);
    EXPECT_THAT(second.err, HasSubstr("study.h5.rows: error: another run is writing it"));
  }
  ::close(first);
  EXPECT_EQ(masses("uniform 800 .. 801 kg", {"--samples", "100"}).exit_code, 0);
}

/// A study file names its machine, which is an input like the study file.
TEST_F(StudyFiles, TheMachineOfAStudyFileIsAnInput) {
  fs::copy_file(small_machine, folder / "m.toml");
  fs::create_hard_link(folder / "m.toml", folder / "other.h5");
  fs::create_symlink("m.toml", folder / "table.csv");
  test::write_text(folder / "study.toml",
                   "machine = \"m.toml\"\nsamples = 64\nwant = [\"x >= 7 Hz\"]\n[vary]\n"
                   "\"platform.mass\" = \"uniform 800 .. 900 kg\"\n");
  const auto before = test::read_text(folder / "m.toml");
  const std::vector<std::vector<std::string>> outputs{
      {"--worst", "./m.toml"}, {"--results", "other.h5"}, {"--csv", "table.csv"}};
  for (const auto& output : outputs) {
    const auto refused = run({"montecarlo", "study.toml", output[0], output[1], "--force"});
    EXPECT_EQ(refused.exit_code, 2) << output[0];
    EXPECT_THAT(refused.err, HasSubstr(output[1] + ": error: the file is the input"));
    EXPECT_EQ(test::read_text(folder / "m.toml"), before);
  }
  const auto ending = run({"montecarlo", "study.toml", "--csv", "rows.toml"});
  EXPECT_EQ(ending.exit_code, 2);
  EXPECT_THAT(ending.err, HasSubstr("does not fit the content"));
  // a result says which machine it is of
  ASSERT_EQ(run({"montecarlo", "study.toml", "-o", "summary.json"}).exit_code, 0);
  EXPECT_THAT(test::read_text(folder / "summary.json"), HasSubstr("m.toml"));
}

/// Whatever its name is and however its TOML is laid out.
TEST_F(StudyFiles, AStudyFileIsKnownByItsKeys) {
  fs::copy_file(small_machine, folder / "m.toml");
  const std::string vary = "\"platform.mass\" = \"uniform 800 .. 900 kg\"";
  const std::vector<std::string> texts{"machine = \"m.toml\"\n  [vary]\n" + vary,
                                       "machine = \"m.toml\"\nvary = {" + vary + "}\n",
                                       "machine = \"m.toml\"\nvary." + vary + "\n"};
  for (const auto& text : texts) {
    test::write_text(folder / "study.txt", text);
    const auto study = run({"montecarlo", "study.txt", "--samples", "64"});
    EXPECT_EQ(study.exit_code, 0) << text << study.err;
  }
  const auto sweep = run({"sweep", "study.txt", "--over", "platform.mass=800:900:3 kg"});
  EXPECT_EQ(sweep.exit_code, 2);
  EXPECT_THAT(sweep.err, HasSubstr("study.txt: error: is a study file"));
}

/// Numbers of rows beyond 64 bits are no small numbers.
TEST_F(StudyFiles, NumbersOfRowsDoNotWrapAround) {
  for (const char* samples :
       {"6148914691236517206", "9223372036854775808", "18446744073709551615"}) {
    const auto huge =
        masses("uniform 800 .. 801 kg", {"--samples", samples, "--indices", "--results", "h.h5"});
    EXPECT_EQ(huge.exit_code, 1) << samples;
    EXPECT_THAT(huge.err, HasSubstr("GB left")) << samples;
  }
  std::vector<std::string> words{"sweep", small_machine, "--results", "h.h5"};
  for (const char* over :
       {"platform.mass=800:900:65536", "environment.gravity=0:10:65536",
        "legs.guide_sleeve.stiffness=1:2:65536 kN/mm", "legs.oil_spring.stiffness=1:2:65536 kN/mm"})
    words.insert(words.end(), {"--over", over});
  const auto grid = run(words);
  EXPECT_NE(grid.exit_code, 0);
  EXPECT_THAT(grid.err, HasSubstr("GB left"));
  EXPECT_FALSE(fs::exists(folder / "h.h5"));
}

/// Of 12,800 rows, after the program's place and before what else it should do.
std::string many_masses() {
  return fmt::format(
      "'{}' montecarlo '{}' --vary 'platform.mass=uniform 800 .. 900 kg' --samples 12800 "
      "--threads 1 --quiet -o summary.txt ",
      test::hydrapod_program().string(), small_machine);
}

/// A disk that is full in the middle of a study, as a limit on the size of files.
const std::string on_a_full_disk = "trap '' XFSZ; ulimit -f 400; ";

TEST_F(StudyFiles, OnAFullDiskTheRowsStay) {
  const auto shell = [&](const std::string& line) {
    return test::run_program("bash", {"-c", line}, {.folder = folder.path()});
  };
  ASSERT_EQ(shell(many_masses() + "--results run.h5 --csv whole.csv && rm run.h5").exit_code, 0);
  const auto full = shell(on_a_full_disk + many_masses() + "--results run.h5");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.err, MatchesRegex("error: run.h5.rows cannot be written: File too large; "
                                     "[1-9][0-9]* rows are in it \\(go on with --resume\\)\n"));
  EXPECT_FALSE(fs::exists(folder / "run.h5"));
  const auto rest = shell(many_masses() + "--results run.h5 --resume --force --csv rest.csv");
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(rows_of(test::read_text(folder / "rest.csv")),
            rows_of(test::read_text(folder / "whole.csv")));
}

/// On a file system of its own, that is filled until there is room for the rows that are not there
/// yet and for the results, and not for all rows.
TEST_F(StudyFiles, RowsThatAreGoneOnWithNeedNoRoom) {
  const auto unshared = [&](const std::string& line) {
    return test::run_program("unshare", {"-rm", "bash", "-c", line}, {.folder = folder.path()});
  };
  const std::string begin = "mkdir -p small && mount -t tmpfs -o size=8m tmpfs small && cd small";
  if (unshared(begin).exit_code != 0) GTEST_SKIP() << "no file system can be mounted here";
  const std::string fill =
      "; there=$(stat -c %s run.h5.rows); width=$(od -An -t u8 -j 16 -N 8 run.h5.rows); "
      "free=$(($(stat -f -c '%a * %S' .))); "
      "head -c $((free - 2 * 12800 * 8 * width + there / 2)) /dev/zero > filler; ";
  const auto result =
      unshared(begin + "; (" + on_a_full_disk + many_masses() + "--results run.h5) 2> first" +
               fill + many_masses() + "--results other.h5; " + many_masses() +
               "--results run.h5 --resume --force && echo whole");
  EXPECT_THAT(result.err, MatchesRegex("error: .* rows need .* GB left.*\n"));
  EXPECT_EQ(result.out, "whole\n");
}

TEST_F(StudyFiles, ADistributionHasNoGrid) {
  const auto grid = masses("uniform 800 .. 801 kg", {"--design", "grid"});
  EXPECT_EQ(grid.exit_code, 2);
  EXPECT_THAT(grid.err, HasSubstr("platform.mass: error: a grid needs a range or a list"));
}

/// The table is read from the rows: it has the digits of the results, and as many rows as they.
TEST_F(StudyFiles, TheTableHasTheRowsThatWereComputed) {
  ASSERT_EQ(
      masses("uniform 800 .. 900 kg", {"--samples", "130", "--csv", "a.csv", "--threads", "1"})
          .exit_code,
      0);
  const auto table = test::read_text(folder / "a.csv");
  EXPECT_EQ(rows_of(table).size(), 131U);
  EXPECT_THAT(table, AllOf(HasSubstr(", pose neutral, guide model\n# machine: "),
                           HasSubstr("# made by: hydrapod montecarlo "), HasSubstr(": sha256 "),
                           Not(HasSubstr("a.csv"))))
      << "says which machine it is of and how it was made, not where it went";
  EXPECT_FALSE(fs::exists(folder / "a.csv.part"));
  const auto printed = masses("uniform 800 .. 900 kg", {"--samples", "130", "--csv", "-", "-o",
                                                        "summary.txt", "--threads", "1"});
  EXPECT_EQ(printed.out, table);
}

/// HDF5 is locked while it writes: who looks into the file that came to be there must not wait for
/// that lock.
TEST_F(StudyFiles, AFileThatComesMeanwhileStays) {
  ASSERT_EQ(masses("uniform 800 .. 801 kg", {"--samples", "64", "--results", "other.h5"}).exit_code,
            0);
  const auto other = test::read_text(folder / "other.h5");
  const std::string script = fmt::format(
      "'{}' montecarlo '{}' --vary 'platform.mass=uniform 900 .. 901 kg' --samples 40000 "
      "--threads 1 --results run.h5 & while [ ! -e run.h5.rows ]; do sleep 0.01; done; "
      "cp other.h5 run.h5; wait $!",
      test::hydrapod_program().string(), small_machine);
  const auto late = test::run_program("bash", {"-c", script}, {.folder = folder.path()});
  EXPECT_NE(late.exit_code, 0);
  EXPECT_THAT(late.err, HasSubstr("run.h5"));
  EXPECT_THAT(late.err, HasSubstr("was left as it is"));
  EXPECT_EQ(test::read_text(folder / "run.h5"), other);
  EXPECT_TRUE(fs::exists(folder / "run.h5.rows")) << "the rows stay for --resume";
}

/// What was interrupted is no success. The table has the rows that were computed, and is no table
/// of all: it does not take the place of one.
TEST_F(StudyFiles, AnInterruptedStudyIsNoSuccess) {
  test::write_text(folder / "table.csv", "m,lowest [Hz],x [Hz]\n1,2,3\n");
  const std::string script = fmt::format(
      "'{}' montecarlo '{}' --vary 'platform.mass=uniform 800 .. 900 kg' --samples 1000000 "
      "--threads 1 --csv table.csv -o summary.json & while [ ! -s study.h5.rows ]; do sleep 0.01; "
      "done; sleep 0.2; kill -TERM $!; wait $!",
      test::hydrapod_program().string(), small_machine);
  const auto interrupted = test::run_program("bash", {"-c", script}, {.folder = folder.path()});
  EXPECT_EQ(interrupted.exit_code, 1);
  EXPECT_THAT(interrupted.err, HasSubstr("error: interrupted after"));
  EXPECT_EQ(test::read_text(folder / "table.csv"), "m,lowest [Hz],x [Hz]\n1,2,3\n");
  const auto rows = std::ssize(rows_of(test::read_text(folder / "table.csv.part"))) - 1;
  EXPECT_GT(rows, 0);
  EXPECT_LT(rows, 1000000);
  EXPECT_THAT(test::read_text(folder / "summary.json"),
              HasSubstr(fmt::format("\"rows\": {}", rows)));
}

/// Columns of a table by their titles, the cells as texts.
std::map<std::string, std::vector<std::string>> columns_of(const std::string& table) {
  const auto rows = rows_of(table);
  const auto titles = base::split(rows.at(0), ",");
  std::map<std::string, std::vector<std::string>> columns;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const auto cells = base::split(rows[k], ",");
    for (std::size_t c = 0; c < titles.size(); ++c)
      columns[std::string(titles[c])].emplace_back(cells.at(c));
  }
  return columns;
}

TEST_F(StudyFiles, HaveTheOutputsThatAreAskedFor) {
  const auto table = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"--samples", "23", "--csv", "t.csv", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const auto done = masses("uniform ± 5 %", words);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return columns_of(test::read_text(folder.path() / "t.csv"));
  };
  const auto all = table({});
  const auto some =
      table({"--only", "x", "--only", "drop_z", "--only", "sag", "--want", "rx >= 1"});
  std::vector<std::string> titles;
  for (const auto& [title, cells] : some) {
    titles.push_back(title);
    if (title != "sag [m]") {
      EXPECT_EQ(cells, all.at(title)) << title;
    }
  }
  EXPECT_THAT(titles, testing::UnorderedElementsAre("platform.mass [kg]", "status [1]", "x [Hz]",
                                                    "z [Hz]", "drop_z [1]", "share_z [1]",
                                                    "peak_z [1]", "rx [Hz]", "sag [m]"));
  test::write_text(folder.path() / "study.toml", "machine = \"" + small_machine +
                                                     "\"\nsamples = 5\nonly = [\"modes\"]\n[vary]\n"
                                                     "\"platform.mass\" = \"uniform ± 5 %\"\n");
  const auto from_file = run({"montecarlo", "study.toml", "--format", "json", "--modes", "2"});
  EXPECT_THAT(from_file.out,
              AllOf(HasSubstr("\"mode2\""), HasSubstr("\"mac\""), Not(HasSubstr("\"lowest\""))));
}

TEST_F(StudyFiles, SayWhichOutputsThereAre) {
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"sweep", small_machine, "--over", "platform.mass=800:900:3 kg"};
    words.insert(words.end(), more.begin(), more.end());
    const auto done = run(words);
    EXPECT_EQ(done.exit_code, 2);
    return done.err;
  };
  EXPECT_THAT(said({"--only", "drp_x"}), AllOf(HasSubstr("--only drp_x: error: unknown output"),
                                               HasSubstr("did you mean 'drop_x'?"),
                                               HasSubstr("accepted are frequencies, modes")));
  EXPECT_THAT(said({"--only", "drop", "--model", "rigid"}),
              HasSubstr("--only drop: error: drop compares flexible legs with rigid ones"));
  EXPECT_THAT(said({"--only", "x", "--refine", "1"}), HasSubstr("expected `modes`"));
  EXPECT_THAT(said({"--only", "x", "--value", "y"}), HasSubstr("add --plot FILE"));
}

TEST_F(StudyFiles, PicturesHaveWhatTheyShow) {
  const auto done = run({"map", small_machine, "--over", "x=-30:30:4 mm", "--over", "z=-30:30:3 mm",
                         "--only", "drop", "--plot", "m.svg", "--value", "rz"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("largest drop: "), HasSubstr("lowest frequency: "),
                              Not(HasSubstr("condition"))));
  EXPECT_THAT(test::read_text(folder.path() / "m.svg"), HasSubstr("rz"));
}

TEST_F(StudyFiles, AMissingPartIsNamed) {
  const auto part = [&](const std::string& which, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"--samples", "64", "--results", "p.h5", "--shard", which};
    words.insert(words.end(), more.begin(), more.end());
    return masses("uniform ± 5 %", words);
  };
  EXPECT_EQ(part("1/3").exit_code, 0);
  EXPECT_EQ(part("3/3").exit_code, 0);
  const auto joined = part("3", {"--join"});
  EXPECT_EQ(joined.exit_code, 2);
  EXPECT_THAT(joined.err, HasSubstr("p.h5.rows2of3: error: part 2 of 3 is not there; run it with "
                                    "--shard 2/3"));
}

}  // namespace
}  // namespace hydrapod
