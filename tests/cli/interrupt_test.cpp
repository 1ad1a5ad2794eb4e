/// Whoever presses Ctrl-C is answered at once by every command that may take long: it ends, or says
/// that it is about to and keeps what there is.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "exact/modal_system.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A program that runs beside the test, in a folder, its messages in the file `err` there.
class Running {
 public:
  Running(const std::vector<std::string>& arguments, const std::filesystem::path& folder)
      : err_(folder / "err") {
    std::filesystem::remove(err_);
    std::vector<std::string> words{test::hydrapod_program().string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ == 0) {
      ::signal(SIGINT, SIG_DFL);  // as at a terminal, also where the test runs in the background
      const bool there = ::chdir(folder.c_str()) == 0;
      ::dup2(::open("out", O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
      ::dup2(::open("err", O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      if (there) ::execv(argv[0], argv.data());
      ::_exit(127);
    }
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    if (!over()) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
  }
  [[nodiscard]] bool over() { return over_ = over_ || ::waitpid(child_, &status_, WNOHANG) != 0; }
  [[nodiscard]] std::string messages() const {
    return std::filesystem::exists(err_) ? test::read_text(err_) : "";
  }
  [[nodiscard]] bool succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }
  void interrupt() const { ::kill(child_, SIGINT); }

 private:
  std::filesystem::path err_;
  pid_t child_{};
  int status_{};
  bool over_{};
};

/// [s] from the signal, sent `after` seconds [s], to the end of the program or to its answer;
/// negative: it ended before.
double answers_after(const std::vector<std::string>& arguments, double after,
                     const std::filesystem::path& folder) {
  Running program(arguments, folder);
  const auto begin = Clock::now();
  while (since(begin) < after) {
    if (program.over()) {
      EXPECT_TRUE(program.succeeded()) << program.messages();
      return -1.0;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const std::string before = program.messages();
  const auto sent = Clock::now();
  program.interrupt();
  constexpr double patience = 20.0;
  while (!program.over() && since(sent) < patience &&
         program.messages().find("interrupted", before.size()) == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const double answered = since(sent);
  while (!program.over() && since(sent) < patience)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_TRUE(program.over()) << "goes on: " << program.messages();
  return answered;
}

/// A record long enough to be read for a while: two masses, a force on each, 60 MB of text.
void write_long_record(const std::filesystem::path& folder) {
  const auto record = test::record_of(
      test::chain(2, 1.0, 1500.0, 0.02),
      {.sample_rate = 50.0, .samples = 1 << 19, .output_noise = Eigen::Vector2d::Constant(1e-5)});
  data::write_record((folder / "long.csv").string(), record, data::RecordFormat::csv);
}

struct Case {
  std::vector<std::string> arguments{};
  double after{};  ///< [s]
};

/// 0.3 s are promised; a busy machine gets three times as much, and three attempts.
TEST(Interrupt, IsAnsweredAtOnce) {
  constexpr double promised = 0.3, busy = 3.0;
  const std::string machine = test::source_file("models/heavy-platform.toml").string();
  const test::TemporaryFolder folder;
  write_long_record(folder.path());
  test::write_text(folder / "modes.csv", "frequency [Hz],direction\n4.1,x\n4.1,y\n6.5,rz\n8.2,z\n");
  test::write_text(
      folder / "modes.toml",
      "[[mode]]\nfrequency = \"4.1 Hz\"\ndirection = \"x\"\n[[mode]]\nfrequency = "
      "\"8.2 Hz\"\ndirection = \"z\"\n[[free]]\npath = \"legs.guide_sleeve.stiffness\"\n");
  const std::vector<Case> cases{
      {{"rig", machine, "--duration", "1e5", "-o", "rig.h5", "--force"}, 0.8},
      {{"rig", machine, "--duration", "1e5", "-o", "rig.csv", "--force"}, 0.8},
      {{"simulate", machine, "--command", "noise x=1 mm", "--until", "1e4"}, 0.5},
      {{"simulate", machine, "--command", "noise x=1 mm", "--until", "1e5", "-o", "run.mat",
        "--force"},
       0.8},
      // while the samples of one step of the controller are computed
      {{"simulate", machine, "--set", "legs.valve.natural_frequency=7e5", "--until", "100"}, 0.5},
      {{"frf", "long.csv"}, 0.3},
      {{"identify", "long.csv"}, 0.3},
      {{"identify", "long.csv", "--bootstrap", "10000"}, 4.0},
      {{"record", "show", "long.csv"}, 0.2},
      {{"record", "convert", "long.csv", "-o", "long.h5", "--force"}, 0.3},
      {{"record", "resample", "long.csv", "--new-rate", "20", "-o", "slow.h5", "--force"}, 0.3},
      {{"record", "verify", "long.csv"}, 0.2},
      {{"diagnose", machine, "--measured", "modes.csv", "--poses", "workspace"}, 0.3},
      {{"calibrate", machine, "--targets", "modes.toml", "--starts", "10000"}, 0.4},
      {{"report", machine, "--measured", "long.csv", "-o", "report.html"}, 0.3},
      {{"bode", machine, "--points", "100000", "--format", "json"}, 0.2},
      {{"sensitivity", machine}, 0.05},
      {{"design", machine, "--samples", "1000000", "--change", "platform.mass=10:16 t", "--want",
        "lowest >= 4 Hz", "--maximise", "platform.mass"},
       0.3},
  };
  int met = 0;  // at work
  for (const auto& one : cases) {
    double best = 1e9;
    for (int attempt = 0; attempt < 3 && best > promised; ++attempt)
      best = std::min(best, answers_after(one.arguments, one.after, folder.path()));
    EXPECT_LT(best, busy * promised) << testing::PrintToString(one.arguments);
    met += best >= 0.0 ? 1 : 0;
  }
  EXPECT_GE(met, 10) << "most of these programs ended before they were interrupted";
}

/// What a command keeps when it is stopped is whole, and it does not end as if nothing had been.
TEST(Interrupt, IsNoSuccess) {
  const std::string machine = test::source_file("models/heavy-platform.toml").string();
  const test::TemporaryFolder folder;
  Running program({"rig", machine, "--settling", "0", "--duration", "1e5", "-o", "rig.h5"},
                  folder.path());
  const auto begin = Clock::now();
  const auto part = folder / "rig.h5.part";
  std::error_code absent;
  const auto has_grown = [&] {
    constexpr std::uintmax_t some = 300'000;  // bytes
    const auto size = std::filesystem::file_size(part, absent);
    return !absent && size > some;
  };
  while (!has_grown() && since(begin) < 20.0 && !program.over())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.interrupt();
  while (!program.over() && since(begin) < 40.0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(program.over());
  EXPECT_FALSE(program.succeeded());
  EXPECT_THAT(program.messages(), testing::HasSubstr("interrupted"));
  EXPECT_GT(data::read_record((folder / "rig.h5").string()).record.samples.rows(), 10);
}

/// A Universal File gets its numbers after the last sample was read, which takes longer than to
/// read them.
TEST(Interrupt, IsAnsweredWhileTheFileIsCompleted) {
  constexpr double busy = 0.9;
  const test::TemporaryFolder folder;
  data::Record record;
  for (int c = 0; c < 6; ++c) record.header.channels.push_back({fmt::format("sensor {}", c), "m"});
  record.header.sample_rate = 2000.0;
  record.samples = data::Samples::Random(1'500'000, 6);  // 72 MB
  data::write_record((folder / "long.h5").string(), record, data::RecordFormat::hdf5);
  double best = 1e9;
  for (int attempt = 0; attempt < 3 && best > busy; ++attempt) {
    Running program({"record", "convert", "long.h5", "-o", "long.uff", "--format", "uff-ascii"},
                    folder.path());
    const auto begin = Clock::now();
    std::error_code absent;
    const auto waits = [&] {
      constexpr std::uintmax_t most_of_it = 40'000'000;  // bytes
      const auto size = std::filesystem::file_size(folder / "long.uff.part", absent);
      return (absent || size < most_of_it) && since(begin) < 60.0 && !program.over();
    };
    while (waits()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (program.over()) {
      EXPECT_TRUE(program.succeeded()) << program.messages();
      std::filesystem::remove(folder / "long.uff");
      continue;
    }
    const auto sent = Clock::now();
    program.interrupt();
    while (!program.over() && program.messages().find("interrupted") == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    best = std::min(best, since(sent));
    EXPECT_THAT(program.messages(), testing::HasSubstr("interrupted"));
    program.interrupt();  // ends it at once
    while (!program.over() && since(sent) < 60.0)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_TRUE(program.over());
    EXPECT_FALSE(program.succeeded());
    for (const auto& file : std::filesystem::directory_iterator(folder.path()))
      if (file.path().filename() != "long.h5") std::filesystem::remove(file.path());
  }
  if (best < 1e9) EXPECT_LT(best, busy);
}

}  // namespace
}  // namespace hydrapod
