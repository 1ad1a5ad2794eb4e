/// `hydrapod serve` and `hydrapod rig --hardware`, and clients in other languages.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "hydrapod/data/record_io.hpp"
#include "realtime/transport.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

/// A program beside the test, with its output in files of the folder.
class Beside {
 public:
  Beside(std::vector<std::string> words, const std::filesystem::path& folder, std::string name)
      : folder_(folder), name_(std::move(name)) {
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    for (const char* ending : {".out", ".err"}) write_text(folder_ / (name_ + ending), "");
    child_ = ::fork();
    if (child_ != 0) return;
    ::signal(SIGINT, SIG_DFL);
    if (::chdir(folder_.c_str()) != 0) ::_exit(127);
    for (const auto& [ending, number] : {std::pair{".out", 1}, {".err", 2}})
      ::dup2(::open((name_ + ending).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), number);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  ~Beside() {
    if (!reaped_) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  void signal(int number) const { ::kill(child_, number); }
  /// Exit code; −1 where it did not end within a minute.
  int wait() {
    for (int k = 0; k < 6000 && !reaped_; ++k) {
      reaped_ = ::waitpid(child_, &status_, WNOHANG) != 0;
      if (!reaped_) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (!reaped_) return -1;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }
  [[nodiscard]] std::string out() const { return read_text(folder_ / (name_ + ".out")); }
  [[nodiscard]] std::string err() const { return read_text(folder_ / (name_ + ".err")); }

 private:
  std::filesystem::path folder_;
  std::string name_;
  pid_t child_{};
  int status_{};
  bool reaped_{};
};

class Serve : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::unique_ptr<Beside> server;
  std::string machine = source_file("models/zhang-jiang-2021.toml").string();

  [[nodiscard]] std::string file(const std::string& name) const { return folder / name; }
  RunResult run(std::vector<std::string> arguments) const {
    return run_hydrapod(arguments, {.folder = folder.path()});
  }
  /// Starts a server; its port.
  std::string start(std::vector<std::string> arguments) {
    std::vector<std::string> words{hydrapod_program().string(), "serve", machine, "--udp", "0"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    server = std::make_unique<Beside>(words, folder.path(), "server");
    const std::string sign = "listening at ";
    for (int k = 0; k < 3000; ++k) {
      const std::string err = server->err();
      const auto at = err.find(sign), end = err.find('\n', at);
      if (at != err.npos && end != err.npos) {
        const std::string place = err.substr(at + sign.size(), end - at - sign.size());
        return place.substr(place.find(':') + 1);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << server->err();
    return "1";
  }
  RunResult client(const std::vector<std::string>& words) const {
    return run_program(words[0], {words.begin() + 1, words.end()}, {.folder = folder.path()});
  }
};

/// Every channel that both records have, bit for bit.
void expect_same(const std::string& simulated, const std::string& served) {
  const auto a = data::read_record(simulated).record, b = data::read_record(served).record;
  EXPECT_EQ(a.samples.rows(), b.samples.rows());
  for (std::size_t c = 0; c < a.header.channels.size(); ++c) {
    const auto& name = a.header.channels[c].name;
    const auto other = data::find_channel(b.header, name);
    ASSERT_TRUE(other) << name;
    EXPECT_EQ(a.samples.col(static_cast<Eigen::Index>(c)),
              b.samples.col(static_cast<Eigen::Index>(*other)))
        << name;
  }
  EXPECT_GE(a.header.channels.size(), 60U);
}

/// The loop is closed through UDP between two processes.
TEST_F(Serve, InLockStepIsSimulateBitForBit) {
  const std::string command = "noise x=1.3 mm, z=2 mm, ry=0.1 deg, to=15";
  ASSERT_EQ(run({"simulate", machine, "--command", command, "--until", "0.7", "-o", "simulated.h5",
                 "--seed", "5"})
                .exit_code,
            0);
  const auto port = start({"--lock-step", "--seed", "5", "--duration", "0.7", "--accelerometer",
                           "none", "-o", "served.h5"});
  const auto socket = realtime::connect_udp({.host = "127.0.0.1", .port = port}, "test");
  const auto layout = realtime::native_layout(0);
  signals::Generator signal(signals::read_signals({command}, {.rate = 1e3}), 1e3, 5);
  realtime::Datagram datagram;
  for (std::uint64_t k = 1; k <= 701; ++k) {
    const auto now = signal.next();
    std::array<std::byte, realtime::largest_packet> bytes;
    const std::size_t size = realtime::encode(
        layout, {.sequence = k, .displacement = now.value, .rate = now.rate}, bytes.data());
    socket->send({bytes.data(), size}, {});
    realtime::Sensors sensors;
    for (int patience = 0; !socket->receive(datagram) && patience < 100; ++patience)
      socket->wait(0.1);
    ASSERT_TRUE(realtime::decode(layout, datagram.span(), sensors)) << k;
    ASSERT_EQ(sensors.answered, k);
  }
  EXPECT_EQ(server->wait(), 0) << server->err();
  expect_same(file("simulated.h5"), file("served.h5"));
}

/// Demand and motion of the last line of a client's table: back at zero, and 2 mm in between.
void expect_motion(const std::string& table) {
  std::istringstream lines(table);
  std::string line, cell;
  double most = 0.0, last = 1.0;
  int count = 0;
  std::getline(lines, line);
  EXPECT_EQ(line, "time,demand_mm,platform_mm,leg1_mm");
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::getline(cells, cell, ',');
    std::getline(cells, cell, ',');
    std::getline(cells, cell, ',');
    last = std::stod(cell);
    most = std::max(most, last);
    ++count;
  }
  EXPECT_GE(count, 199);
  EXPECT_NEAR(most, 2.0, 0.05);
  EXPECT_NEAR(last, 0.0, 0.05);
}

TEST_F(Serve, APythonClientMovesThePlatform) {
  const auto port = start({"--lock-step", "--once", "--ramp", "0.1"});
  const auto done =
      client({"python3", source_file("examples/realtime/client.py").string(), "127.0.0.1", port});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  expect_motion(done.out);
  EXPECT_EQ(server->wait(), 0) << server->err();
  EXPECT_THAT(server->out(), HasSubstr("platform parked"));
}

TEST_F(Serve, APythonClientHasAKey) {
  write_text(file("key"), "not a very good secret, but long");
  ::chmod(file("key").c_str(), 0600);
  const auto port = start({"--lock-step", "--once", "--ramp", "0.1", "--key", "key"});
  const auto done = client({"python3", source_file("examples/realtime/client.py").string(),
                            "127.0.0.1", port, file("key")});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  expect_motion(done.out);
  EXPECT_EQ(server->wait(), 0) << server->err();
}

TEST_F(Serve, ACClientMovesThePlatformOnTheWallClock) {
  const auto compiled =
      client({"cc", "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror",
              source_file("examples/realtime/client.c").string(), "-lm", "-o", "client"});
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  const auto port = start({"--once", "--hold", "1 s", "--ramp", "0.1"});
  const auto done = client({"./client", "127.0.0.1", port});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(server->wait(), 0) << server->err();
  EXPECT_THAT(server->out(),
              testing::AllOf(HasSubstr("platform parked"), HasSubstr("deadline misses: "),
                             HasSubstr("begin of a sample after its time")));
}

TEST_F(Serve, AShellClientMovesThePlatform) {
  const auto port = start({"--lock-step", "--once", "--ramp", "0.1", "--patience", "5 s",
                           "--layout", source_file("examples/realtime/integers.toml").string()});
  const auto done =
      client({source_file("examples/realtime/client.sh").string(), "127.0.0.1", port});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("step,demand_um,platform_um,leg1_um"));
  int step = 0, demand = 0, platform = 0, leg = 0;
  const auto last = done.out.rfind('\n', done.out.size() - 2);
  ASSERT_EQ(std::sscanf(done.out.c_str() + last, "%d,%d,%d,%d", &step, &demand, &platform, &leg),
            4);
  EXPECT_EQ(step, 200);
  EXPECT_EQ(demand, 1000);
  EXPECT_NEAR(platform, 1000, 300);  // 5 mm/s against a loop of some hertz
  EXPECT_GT(leg, 500'000);
  EXPECT_EQ(server->wait(), 0) << server->err();
}

TEST_F(Serve, AClientThatIsKilledLeavesThePlatformDownAndTheRecordReadable) {
  const auto port =
      start({"--once", "--hold", "2", "--ramp", "0.3", "-o", "run.h5", "--format", "json"});
  {
    // a client held up by a busy machine for less than the two seconds is no end
    Beside victim(
        {"python3", "-u", source_file("examples/realtime/client.py").string(), "127.0.0.1", port},
        folder.path(), "victim");
    const auto lines = [&] { return std::ranges::count(victim.out(), '\n'); };
    for (int k = 0; k < 10'000 && lines() < 70; ++k)  // 0.7 s after its start
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    victim.signal(SIGKILL);
    EXPECT_EQ(victim.wait(), 128 + SIGKILL);
  }
  ASSERT_EQ(server->wait(), 0) << server->err();
  const auto result = json::parse(server->out());
  EXPECT_EQ(result["kind"], "serve");
  EXPECT_EQ(result["state"], "parked");
  EXPECT_EQ(result["commands"]["trips"], 1);
  EXPECT_NEAR(result["lateness"]["samples"].get<double>(), result["samples"].get<double>(), 1.0);
  const auto record = data::read_record(file("run.h5")).record;
  EXPECT_EQ(record.samples.rows(), result["samples"].get<Eigen::Index>());
  const auto z = record.samples.col(
      static_cast<Eigen::Index>(*data::find_channel(record.header, "platform.z")));
  EXPECT_GT(z.maxCoeff(), 1e-4);
  EXPECT_NEAR(z[z.size() - 1], 0.0, 1e-4);
  const auto misses = record.samples.col(
      static_cast<Eigen::Index>(*data::find_channel(record.header, "serve.deadline_misses")));
  // the sample in which the end is seen may miss its deadline too, and has no row
  EXPECT_NEAR(misses[misses.size() - 1] + 0.5, result["deadline_misses"].get<double>(), 0.5);
  EXPECT_EQ(run({"record", "verify", "run.h5"}).exit_code, 0);
}

TEST_F(Serve, EndsAtOnceWithTheRecordWhenAskedTo) {
  for (const auto& more : {std::vector<std::string>{}, {"--lock-step"}}) {
    auto arguments = more;
    arguments.insert(arguments.end(), {"-o", "asked.h5", "--force"});
    start(arguments);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto asked = Clock::now();
    server->signal(SIGINT);
    EXPECT_EQ(server->wait(), 0) << server->err();
    // 0.3 s are promised; a busy machine gets ten times as much
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - asked).count(), 3.0);
    const auto rows = data::read_record(file("asked.h5")).record.samples.rows();
    if (more.empty()) EXPECT_GE(rows, 200);
  }
}

TEST_F(Serve, SharedMemoryOfAKilledServerIsTakenOver) {
  const std::string name = fmt::format("hydrapod-cli-{}", ::getpid());
  start({"--shm", name});
  const auto place = std::filesystem::path("/dev/shm") / name;
  EXPECT_TRUE(std::filesystem::exists(place));
  EXPECT_THAT(run({"serve", machine, "--shm", name, "--duration", "0.01"}).err,
              HasSubstr("another server has the shared memory"));
  server->signal(SIGKILL);
  EXPECT_EQ(server->wait(), 128 + SIGKILL);
  EXPECT_TRUE(std::filesystem::exists(place));
  EXPECT_EQ(run({"serve", machine, "--shm", name, "--duration", "0.01"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(place));
}

TEST_F(Serve, WrongUseIsTold) {
  const auto told = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"serve", machine, "--duration", "0.01"};
    words.insert(words.end(), more.begin(), more.end());
    const auto done = run(words);
    EXPECT_EQ(done.exit_code, 2) << done.err;
    return done.err;
  };
  EXPECT_THAT(told({"--udp", "99999"}), HasSubstr("--udp: error: is \"99999\", expected a port"));
  EXPECT_THAT(told({"--udp", "0.0.0.0:0"}), HasSubstr("expected --bind 0.0.0.0 and --key FILE"));
  EXPECT_THAT(told({"--bind", "0.0.0.0"}), HasSubstr("--bind: error: '0.0.0.0' is beyond"));
  EXPECT_THAT(told({"--bind", "127.0.0.1", "--shm", "x"}), HasSubstr("shared memory has no"));
  EXPECT_THAT(told({"--shm", "a/b"}), HasSubstr("--shm: error: 'a/b' is no name"));
  EXPECT_THAT(told({"--hold", "0"}), HasSubstr("--hold"));
  EXPECT_THAT(told({"--ramp", "-1 s"}), HasSubstr("--ramp"));
  EXPECT_THAT(told({"--rest", "z=5 m"}), HasSubstr("--rest z=5 m"));
  EXPECT_THAT(told({"--integrator", "euler"}), HasSubstr("--integrator"));
  EXPECT_THAT(told({"--layout", "none.toml"}), HasSubstr("none.toml"));
  EXPECT_THAT(told({"--key", machine}), HasSubstr("can be read or written by others"));
  const auto port = start({});
  EXPECT_THAT(told({"--udp", port}), HasSubstr("Address already in use"));
}

TEST_F(Serve, ThePrintedLayoutIsTheOneThatIsUsed) {
  const auto printed = run({"serve", machine, "--print-layout"});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  write_text(file("own.toml"), printed.out);
  EXPECT_EQ(run({"serve", machine, "--print-layout", "--layout", "own.toml"}).out, printed.out);
  const auto port = start({"--lock-step", "--once", "--ramp", "0.1", "--layout", "own.toml"});
  EXPECT_EQ(
      client({"python3", source_file("examples/realtime/client.py").string(), "127.0.0.1", port})
          .exit_code,
      0);
}

/// Modes of a machine behind UDP, as `identify` finds them: those of the simulated rig, and the
/// calculated ones of the plant.
TEST_F(Serve, AMachineBehindUdpIsIdentified) {
  const std::vector<std::string> test{
      "--duration",      "40",  "--settling", "1", "--excite", "noise all=0.1 mm, to=60",
      "--accelerometer", "none"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), test.begin(), test.end());
    return words;
  };
  const auto port = start({"--lock-step", "--once", "--accelerometer", "none"});
  const auto hardware =
      run(with({"rig", machine, "--hardware", port, "--watchdog", "5 s", "-o", "hardware.h5"}));
  ASSERT_EQ(hardware.exit_code, 0) << hardware.err;
  EXPECT_THAT(hardware.err, HasSubstr("wrote hardware.h5: 40000 samples"));
  // on a busy computer a command may be sent again; then the second answer to it comes late
  EXPECT_THAT(hardware.err, HasSubstr(" 0 lost, "));
  EXPECT_THAT(hardware.err, HasSubstr(" 0 malformed, 0 refused"));
  const auto simulated = run(with({"rig", machine, "-o", "simulated.h5"}));
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  // the oil modes; those of the seals are hidden in the loop's noise in both records, and those of x
  // and y nearly so, which their quality says
  const auto oil_modes_of = [&](const char* record) {
    const auto found = run({"identify", record, "--format", "json"});
    EXPECT_EQ(found.exit_code, 0) << found.err;
    std::map<std::string, double> modes;
    const auto document = json::parse(found.out);
    for (const auto& pair : document["comparison"]["pairs"]) {
      const std::string label = pair["model"]["label"];
      if (label.find("oil springs") == label.npos) continue;
      const auto number = pair["mode"].get<std::size_t>() - 1;
      if (document["modes"][number]["quality"].get<double>() < 0.5) continue;
      EXPECT_LT(std::abs(pair["frequency_difference_percent"].get<double>()), 0.4) << label;
      EXPECT_GT(pair["mac"].get<double>(), 0.99) << label;
      const double frequency = pair["model"]["frequency_hz"];
      modes[label] = frequency * (1.0 + pair["frequency_difference_percent"].get<double>() / 100.0);
    }
    return modes;
  };
  const auto measured = oil_modes_of("hardware.h5"), expected = oil_modes_of("simulated.h5");
  EXPECT_GE(measured.size(), 4U);
  EXPECT_EQ(measured.size(), expected.size());
  for (const auto& [label, frequency] : expected)
    EXPECT_NEAR(measured.at(label) / frequency, 1.0, 0.003) << label;
}

/// Before clients can come, and in the result and the record.
TEST_F(Serve, WarnsWhereTheMachineDoesNotStayAtItsPose) {
  const auto heavy = source_file("models/heavy-platform.toml").string();
  const auto served = [&](const std::string& setting) {
    return run({"serve", heavy, "--set", setting, "--udp", "0", "--duration", "0.02", "--format",
                "json", "--force", "-o", "served.h5"});
  };
  for (const auto& [setting, reason] :
       {std::pair{"platform.mass=18 t", "the static equilibrium is unstable"},
        {"controller.gain=40", "the closed loop is unstable: it oscillates at "}}) {
    const auto done = served(setting);
    const auto warning = done.err.find("warning: "), listening = done.err.find("listening at ");
    EXPECT_LT(warning, listening) << done.err;
    EXPECT_THAT(done.err.substr(warning, listening - warning), HasSubstr(reason));
    const auto told = json::parse(done.out)["warnings"];
    ASSERT_EQ(told.size(), 1U);
    EXPECT_THAT(told[0].get<std::string>(), HasSubstr(reason));
    EXPECT_THAT(data::read_record(file("served.h5")).record.header.notes, HasSubstr(reason));
  }
  const auto sound = served("platform.mass=14 t");
  EXPECT_THAT(sound.err, testing::Not(HasSubstr("warning")));
  EXPECT_TRUE(json::parse(sound.out)["warnings"].empty());
}

TEST_F(Serve, HardwareOptionsBelongToHardware) {
  const auto told = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"rig", machine, "-o", "r.h5"};
    words.insert(words.end(), more.begin(), more.end());
    const auto done = run(words);
    EXPECT_EQ(done.exit_code, 2) << done.err;
    EXPECT_FALSE(std::filesystem::exists(file("r.h5")));
    return done.err;
  };
  EXPECT_THAT(told({"--limit", "length=3 mm"}), HasSubstr("--limit: error: belongs to --hardware"));
  EXPECT_THAT(told({"--hardware", "1", "--drop-outs", "1"}),
              HasSubstr("--drop-outs: error: belongs to the simulated rig"));
  EXPECT_THAT(told({"--hardware", "1", "--limit", "lenght=3 mm"}), HasSubstr("length"));
  EXPECT_THAT(told({"--hardware", "1", "--limit", "error=-3 mm"}),
              HasSubstr("error must be more than 0"));
  EXPECT_THAT(told({"--hardware", "192.0.2.1:4747"}), HasSubstr("expected --key FILE"));
}

}  // namespace
}  // namespace hydrapod::test
