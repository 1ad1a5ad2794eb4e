#pragma once
/// Commands in which calls of the system fail (tests/faults/failing_calls.c) or which are killed:
/// nothing that was there before is lost, and the exit code says what happened.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

/// A command that writes `out` over an older file.
struct WritingCommand {
  std::string name;
  std::vector<std::string> arguments;
  std::string out;
};

inline std::vector<WritingCommand> writing_commands() {
  std::vector<WritingCommand> all;
  const auto add = [&](const std::string& name, std::vector<std::string> arguments,
                       const std::string& out, const std::string& format = "") {
    arguments.insert(arguments.end(), {"-o", out, "--force"});
    if (!format.empty()) arguments.insert(arguments.end(), {"--format", format});
    all.push_back({name + (format.empty() ? "" : "_" + format), std::move(arguments), out});
  };
  add("rig", {"rig", "m.toml", "--model", "rigid", "--duration", "1"}, "new.h5");
  add("simulate",
      {"simulate", "m.toml", "--model", "rigid", "--command", "noise x=1 mm", "--until", "1"},
      "new.h5");
  for (const char* format :
       {"hdf5", "mat5", "mat73", "csv", "uff", "uff-ascii", "rpc", "rpc-short"})
    add("convert", {"record", "convert", "run.csv"}, "new", format);
  add("identify", {"identify", "run.csv"}, "new.json");
  return all;
}

/// The name of a test with it.
inline std::string command_name(const testing::TestParamInfo<WritingCommand>& info) {
  std::string name = info.param.name;
  std::erase(name, '-');
  std::erase(name, '_');
  return name;
}

/// A record that `identify` takes.
inline data::Record force_and_motion(Eigen::Index samples) {
  data::Record record;
  record.header.sample_rate = 97.0;
  record.header.channels = {{.name = "force", .unit = "N", .role = data::Role::excitation},
                            {.name = "motion", .unit = "m", .role = data::Role::response}};
  record.samples = data::Samples::NullaryExpr(samples, 2, [](Eigen::Index k, Eigen::Index c) {
    return std::cos(0.37 * static_cast<double>(k * k % 911) + static_cast<double>(c));
  });
  return record;
}

/// One folder in which a command is run again and again.
class FaultyRuns {
 public:
  explicit FaultyRuns(WritingCommand command) : command_(std::move(command)) {
    write_text(folder_ / "m.toml", model::starter_machine_file());
    data::write_record(folder_ / "run.csv", force_and_motion(2000), data::RecordFormat::csv);
    older_ = "what was there before\n";
    prepare();
    const auto good = run({});
    EXPECT_EQ(good.exit_code, 0) << good.err;
    if (is_record())
      whole_ = data::read_record(out().string()).record.samples;
    else
      whole_text_ = read_text(out());
  }

  /// Calls of that kind in a run in which none fails.
  long count(const std::string& calls) {
    prepare();
    EXPECT_EQ(run({{"FAIL_CALLS", calls}, {"FAIL_TOLD", (folder_ / "told").string()}}).exit_code,
              0);
    const long number = std::atol(read_text(folder_ / "told").c_str());
    std::filesystem::remove(folder_ / "told");
    return number;
  }

  /// The run in which the call of that number and all behind it fail, or that one alone.
  void fail(const std::string& calls, long number, bool once) {
    prepare();
    std::vector<std::pair<std::string, std::string>> variables{{"FAIL_CALLS", calls},
                                                               {"FAIL_AT", std::to_string(number)}};
    if (once) variables.emplace_back("FAIL_COUNT", "1");
    const auto result = run(variables);
    SCOPED_TRACE(command_.name + ", " + calls + ' ' + std::to_string(number) + ": exit code " +
                 std::to_string(result.exit_code) + ", " + result.err);
    EXPECT_FALSE(result.timed_out);
    expect_nothing_lost(result.exit_code == 0);
    // UDUNITS-2 and HDF5 themselves crash where they get no memory
    if (calls == "memory") return;
    EXPECT_LE(result.exit_code, 2);
    if (result.exit_code != 0) {
      EXPECT_THAT(result.err, testing::HasSubstr("error: "));
    }
    expect_parts_are_named(result.err);
  }

  /// Killed after so long [s]; true when it was done before.
  bool kill_after(double seconds) {
    prepare();
    const auto result = run({}, seconds);
    SCOPED_TRACE(command_.name + ", killed after " + std::to_string(seconds));
    expect_nothing_lost(!result.timed_out);
    return !result.timed_out;
  }

  double seconds() {
    prepare();
    const auto begin = std::chrono::steady_clock::now();
    run({});
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

 private:
  [[nodiscard]] std::filesystem::path out() const { return folder_ / command_.out; }
  [[nodiscard]] bool is_record() const { return !command_.out.ends_with(".json"); }

  /// The older file, and nothing else but the inputs.
  void prepare() {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().filename() != "m.toml" && entry.path().filename() != "run.csv")
        std::filesystem::remove(entry.path());
    write_text(out(), older_);
  }

  RunResult run(std::vector<std::pair<std::string, std::string>> variables, double timeout = 60.0) {
    if (!variables.empty()) variables.emplace_back("LD_PRELOAD", failing_calls().string());
    return run_hydrapod(command_.arguments,
                        {.folder = folder_.path(), .variables = variables, .timeout = timeout});
  }

  /// The older file or the whole new one; the new one where the command says that it is done.
  void expect_nothing_lost(bool done) {
    ASSERT_TRUE(std::filesystem::exists(out()));
    const bool is_older = read_text(out()) == older_;
    EXPECT_FALSE(done && is_older);
    if (!is_older) expect_new();
    EXPECT_TRUE(data::read_record((folder_ / "run.csv").string()).notes.empty());
  }

  void expect_new() {
    if (!is_record()) {
      EXPECT_EQ(read_text(out()), whole_text_);
      return;
    }
    const auto [record, notes] = data::read_record(out().string());
    EXPECT_TRUE(record.samples == whole_);
    for (const auto& note : notes) EXPECT_EQ(note.message.find("checksum"), std::string::npos);
  }

  /// What a command leaves besides its output is what its message names, and is readable.
  void expect_parts_are_named(const std::string& err) {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename();
      if (name == "m.toml" || name == "run.csv" || name == command_.out) continue;
      EXPECT_THAT(err, testing::HasSubstr(name + " holds what was written before"));
      const auto part = data::read_record(entry.path().string()).record.samples;
      ASSERT_LE(part.rows(), whole_.rows());
      const double tolerance = command_.name.ends_with("rpc-short") ? 1e-4 : 1e-11;
      EXPECT_TRUE(part.isApprox(whole_.topRows(part.rows()), tolerance));
    }
  }

  WritingCommand command_;
  TemporaryFolder folder_;
  std::string older_, whole_text_;
  data::Samples whole_;
};

}  // namespace hydrapod::test
