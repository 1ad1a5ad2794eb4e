/// The help of every command ends with examples, and every one of them works as it stands.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "exact/modal_system.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "support/beam_payload.hpp"
#include "support/run_program.hpp"
#include "support/universal_text.hpp"

namespace hydrapod {
namespace {
using test::run_hydrapod;

/// The first words of the indented lines that follow the line `title`.
std::vector<std::string> entries_below(const std::string& title, const std::string& help) {
  std::vector<std::string> entries;
  std::istringstream lines(help.substr(std::min(help.find(title + '\n'), help.size())));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("  ")) {
    if (line[2] == ' ') continue;  // a description that goes on
    entries.push_back(line.substr(2, line.find("  ", 2) - 2));
  }
  return entries;
}

std::vector<std::string> commands() {
  return entries_below("Subcommands:", run_hydrapod({"--help"}).out);
}

TEST(Help, ListsTheCommands) { EXPECT_THAT(commands(), testing::Contains("init")); }

TEST(Help, OfEveryCommandEndsWithExamples) {
  for (const std::string& command : commands()) {
    const auto help = run_hydrapod({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_FALSE(entries_below("Examples:", help.out).empty()) << command;
  }
}

/// A second of two channels.
data::Record small_record() {
  data::Record record;
  record.header.channels = {{"demand x", "m", data::Direction::x, data::Role::excitation, 0},
                            {"demand ry", "rad", data::Direction::ry, data::Role::response, 0}};
  record.header.sample_rate = 1000.0;
  record.samples = data::Samples::NullaryExpr(
      1000, 2, [](Eigen::Index k, Eigen::Index c) { return std::sin(0.3 * k + c); });
  return record;
}

constexpr const char* modes_csv = "frequency [Hz],direction\n16.9,x\n16.9,y\n26.5,rz\n41.2,z\n";
constexpr const char* modes_toml = R"([[mode]]
frequency = "16.9 Hz"
direction = "x"
[[mode]]
frequency = "41.2 Hz"
direction = "z"
[[free]]
path = "legs.guide_sleeve.stiffness"
)";

constexpr const char* study_toml = R"(machine = "machine.toml"
samples = 300
[vary]
"legs.guide_sleeve.stiffness" = "normal ± 10 %"
)";

/// Records for frf and identify: a chain of two masses driven through an amplifier.
void furnish_for_identification(const std::filesystem::path& folder) {
  auto record = test::record_of(
      test::chain(2, 1.0, 1500.0, 0.02),
      {.sample_rate = 50.0, .samples = 1 << 15, .output_noise = Eigen::Vector2d::Constant(1e-5)});
  const data::Samples measured = record.samples;
  record.header.channels.push_back({.name = "d1", .role = data::Role::drive});
  record.header.channels.push_back({.name = "d2", .role = data::Role::drive});
  record.samples.resize(measured.rows(), 6);
  record.samples << measured, 0.3 * measured.leftCols(2);
  for (const char* name :
       {"run.h5", "run1.h5", "run2.h5", "neutral.h5", "high.h5", "before.h5", "after.h5"})
    data::write_record(folder / name, record, data::RecordFormat::hdf5);
  data::Record named = {.header = record.header, .samples = measured.rightCols(3)};
  named.header.channels = {{.name = "force"}, {.name = "a1"}, {.name = "a2"}};
  data::write_record(folder / "test.csv", named, data::RecordFormat::csv);
  run_hydrapod({"frf", "run.h5", "--format", "json", "-o", "frf.json"}, {.folder = folder});
}

/// A flexible payload as a finite-element program writes it.
void furnish_with_a_cabin(const std::filesystem::path& folder) {
  const auto [M, K] = test::mast_matrices({});
  test::write_text(folder / "cabin.K.mtx", exchange::matrix_market(K, {"cabin"}));
  test::write_text(folder / "cabin.M.mtx", exchange::matrix_market(M, {"cabin"}));
  exchange::Superelement element;
  element.M = M;
  element.K = K;
  test::write_text(folder / "cabin.pch", exchange::dmig_punch(element, {"cabin"}));
  Eigen::MatrixXd on_platform = M;
  on_platform.diagonal().head<6>().array() += 200.0;
  test::write_text(folder / "cabin.unv", test::free_modes_text(on_platform, K, 14, 0.01));
}

/// A folder as the examples expect it: with the models, and a machine.toml unless that is what is
/// made, a motion, and measured modes.
void furnish(const std::filesystem::path& folder, const std::string& command) {
  std::filesystem::create_directory_symlink(test::source_file("models"), folder / "models");
  if (command != "init") run_hydrapod({"init"}, {.folder = folder});
  std::ofstream(folder / "motion.csv")
      << "time [s], x [mm], rz [deg]\n0, 0, 0\n0.5, 5, 1\n1, 0, 0\n";
  std::ofstream(folder / "study.toml") << study_toml;
  std::ofstream(folder / "params.in")
      << "1 variables\n2.5 k\n1 functions\n1 ASV_1:f\n0 derivative_variables\n1 eval_id\n";
  std::ofstream(folder / "modes.csv") << modes_csv;
  std::ofstream(folder / "modes.toml") << modes_toml;
  if (command == "frf" || command == "identify" || command == "report" || command == "diagnose" ||
      command == "compare" || command == "studio")
    furnish_for_identification(folder);
  if (command == "report")
    run_hydrapod({"compare", "machine.toml", "run.h5", "-o", "comparison.json"},
                 {.folder = folder});
  if (command == "attach") furnish_with_a_cabin(folder);
  if (command != "record") return;
  for (const char* name : {"run.h5", "run.csv"})
    data::write_record(folder / name, small_record(), data::format_of_ending(name));
}

/// Folders furnished once per command, of which each example gets a copy.
class Furnished {
 public:
  explicit Furnished(const std::string& command) { furnish(folder_.path(), command); }
  void copy_to(const std::filesystem::path& folder) const {
    std::filesystem::copy(
        folder_.path(), folder,
        std::filesystem::copy_options::recursive | std::filesystem::copy_options::copy_symlinks);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(Help, IsPrintedByItsCommandAsByItsOption) {
  EXPECT_EQ(run_hydrapod({"help"}).out, run_hydrapod({"--help"}).out);
  for (const std::string& command : commands())
    EXPECT_EQ(run_hydrapod({"help", command}).out, run_hydrapod({command, "--help"}).out);
  EXPECT_EQ(run_hydrapod({"help", "record", "show"}).out,
            run_hydrapod({"record", "show", "--help"}).out);
  const auto unknown = run_hydrapod({"help", "mods"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.out, "");
  EXPECT_THAT(unknown.err, testing::HasSubstr("unknown command 'mods'; did you mean 'modes'?"));
  EXPECT_THAT(run_hydrapod({"help", "modes", "more"}).err,
              testing::HasSubstr("one argument too many: 'more'"));
}

/// A page per command, and per command of a command, with each of its options.
TEST(Help, BecomesManPages) {
  const test::TemporaryFolder folder;
  const auto made = run_hydrapod({"help", "--man", "."}, {.folder = folder.path()});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  const auto read = [&](const std::string& name) {
    std::ifstream file(folder.path() / name);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  for (const std::string& command : commands()) {
    const auto page = read("hydrapod-" + command + ".1");
    EXPECT_TRUE(page.starts_with(".TH \"HYDRAPOD")) << command;
    EXPECT_THAT(page, testing::HasSubstr("\n.SH \"EXAMPLES\"\n")) << command;
    const auto help = run_hydrapod({command, "--help"}).out;
    for (std::size_t at = help.find("\n  --"); at != help.npos; at = help.find("\n  --", at + 1)) {
      std::string name = help.substr(at + 3, help.find_first_of(" ,\n", at + 3) - at - 3), escaped;
      for (const char letter : name) escaped += letter == '-' ? "\\-" : std::string(1, letter);
      EXPECT_THAT(page, testing::HasSubstr("\\fB" + escaped + "\\fR")) << command;
    }
  }
  EXPECT_THAT(read("hydrapod-record-show.1"), testing::HasSubstr("\\fBhydrapod\\-record\\fR(1)"));
  EXPECT_THAT(run_hydrapod({"help", "--man", "nowhere"}).err,
              testing::HasSubstr("'nowhere' is not a folder"));
  EXPECT_EQ(run_hydrapod({"help", "--man"}).exit_code, 2);
  EXPECT_THAT(run_hydrapod({"help", "--completions"}).err,
              testing::HasSubstr("unknown option '--completions'; did you mean '--completion'?"));
}

/// A server would go on: it is ended as by Ctrl-C once it has printed its address, and opens no
/// browser.
std::string until_it_listens(const std::string& example) {
  return example +
         " --no-browser >address & while kill -0 $! && ! grep -q http address; do sleep 0.05; "
         "done; kill -INT $!; wait $!";
}

TEST(Help, ExamplesWork) {
  const std::string programs = test::hydrapod_program().parent_path().string();
  const std::string path = programs + ':' + std::getenv("PATH");
  for (const std::string& command : commands()) {
    const Furnished furnished(command);
    for (const auto& example : entries_below("Examples:", run_hydrapod({command, "--help"}).out)) {
      const test::TemporaryFolder folder;
      furnished.copy_to(folder.path());
      const std::string line = command != "studio" ? example : until_it_listens(example);
      const auto result = test::run_program(
          "sh", {"-c", line}, {.folder = folder.path(), .variables = {{"PATH", path}}});
      EXPECT_EQ(result.exit_code, 0) << example << '\n' << result.err;
    }
  }
}

}  // namespace
}  // namespace hydrapod
