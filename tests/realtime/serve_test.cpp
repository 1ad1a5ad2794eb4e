/// On the wall clock: clients that come, go, are killed, and are not what they seem.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>

#include "served.hpp"
#include "support/random.hpp"

namespace hydrapod::realtime {
namespace {

using testing::HasSubstr;

Command at_x(double x) {
  Command command;
  command.displacement[0] = x;
  return command;
}

/// Answers `samples` packets of sensors with the command.
void follow(TestClient& client, const Command& command, int samples, Sensors& sensors) {
  client.command(command);
  for (int k = 0; k < samples; ++k) {
    ASSERT_TRUE(client.receive(sensors)) << k;
    client.command(command);
  }
}

/// Holding is what a sample does that the client was too late for.
bool is_followed(const Sensors& sensors) {
  return sensors.state == static_cast<std::uint64_t>(State::following) ||
         sensors.state == static_cast<std::uint64_t>(State::holding);
}

data::Channel channel(const data::RecordHeader& header, const char* name) {
  const auto found = data::find_channel(header, name);
  EXPECT_TRUE(found.has_value()) << name;
  return header.channels[found.value_or(0)];
}

TEST(Serve, AClientThatIsKilledLeavesThePlatformDownAndTheRecordReadable) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  std::unique_ptr<data::RecordWriter> writer;
  ServeOptions options{.once = true, .hold = 0.2, .ramp = 0.3};
  options.rest[2] = 1.5e-3;
  {
    Served served(options, fixed_steps(), [&]() -> data::RecordWriter& {
      const auto machine = simulation::machine_of("zhang-jiang-2021");
      simulation::ClosedLoop loop(machine, machine.neutral(), fixed_steps());
      data::RecordHeader header{.channels = simulation::record_channels(loop), .sample_rate = 1e3};
      for (const auto& more : serve_channels(loop, options)) header.channels.push_back(more);
      return *(writer = data::open_record_writer(file, header));
    });
    auto client = TestClient::of(served);
    client.hello();
    Sensors sensors;
    follow(client, at_x(2e-3), 300, sensors);
    EXPECT_NEAR(sensors.platform[0], 2e-3, 2e-4);
    EXPECT_TRUE(is_followed(sensors));
    // and not a word more
    const auto& result = served.result();
    EXPECT_EQ(result.run.end, simulation::RunEnd::finished);
    EXPECT_EQ(result.state, State::parked);
    EXPECT_EQ(result.counters.trips, 1U);
    EXPECT_EQ(result.counters.lost, 0U);
    EXPECT_GE(result.counters.missed, 200U);
    EXPECT_GE(result.lateness.samples, result.run.samples);  // the last one only ends the run
    EXPECT_LE(result.lateness.samples, result.run.samples + 1);
    EXPECT_GT(result.step.p50, 1e-6);
    EXPECT_GE(result.step.worst, result.step.p99_99);
  }
  writer->close();
  const auto record = data::read_record(file).record;
  const auto column = [&](const char* name) {
    channel(record.header, name);
    return record.samples.col(static_cast<Eigen::Index>(*data::find_channel(record.header, name)));
  };
  const auto state = column("serve.state");
  EXPECT_LE(state[0], 1.0);  // waiting, unless the client was faster than the first sample
  EXPECT_GE((state.array() == 1.0).count(), 150);  // unless the client had missed samples
  EXPECT_GE((state.array() == 2.0).count(), 199);  // 200 ms
  EXPECT_NEAR(static_cast<double>((state.array() == 3.0).count()), 300.0, 2.0);
  EXPECT_LT((column("command.age").array()).maxCoeff(), 0.202);
  EXPECT_GE(column("serve.lateness").minCoeff(), 0.0);
  EXPECT_GE(column("serve.deadline_misses").minCoeff(), 0.0);
  const Eigen::Index last = record.samples.rows() - 1;
  EXPECT_NEAR(column("platform.x")[last], 0.0, 1e-4);
  EXPECT_NEAR(column("platform.z")[last], 1.5e-3, 1e-4);
  EXPECT_NEAR(column("platform.x").maxCoeff(), 2.3e-3, 4e-4);  // overshoots
}

TEST(Serve, TheNextClientMayComeWhenThePlatformIsDown) {
  Served served({.hold = 0.3, .ramp = 0.05});
  Sensors sensors;
  {
    auto first = TestClient::of(served);
    first.hello();
    follow(first, at_x(1e-3), 20, sensors);
    auto second = TestClient::of(served);
    second.hello();  // it may look
    second.next = 1000;
    second.command(at_x(-1e-3));  // and not touch
    follow(first, at_x(1e-3), 20, sensors);
    EXPECT_EQ(sensors.counters.refused, 1U);
    first.command({.mode = static_cast<std::uint64_t>(Mode::leave)});
  }
  auto third = TestClient::of(served);
  for (int k = 0; k < 200; ++k) {
    if (third.hello().state == static_cast<std::uint64_t>(State::parked)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  follow(third, at_x(5e-4), 20, sensors);
  EXPECT_TRUE(is_followed(sensors));
  served.stop();
  EXPECT_EQ(served.result().counters.trips, 0U);
}

TEST(Serve, NoiseFromTheNetworkChangesNothing) {
  Served served({.hold = 0.5});
  auto client = TestClient::of(served), other = TestClient::of(served);
  Sensors sensors;
  client.hello();
  follow(client, at_x(1e-3), 30, sensors);
  test::Random random(5);
  std::vector<std::byte> bytes;
  std::uint64_t sent = 0;
  for (int k = 0; k < 1500; ++k) {
    bytes.resize(static_cast<std::size_t>(random.uniform(0.0, 2048.0)));
    for (auto& byte : bytes) byte = static_cast<std::byte>(random.uniform(0.0, 256.0));
    other.raw(bytes);
    ++sent;
    if (k % 15 == 0) follow(client, at_x(1e-3), 1, sensors);
  }
  follow(client, at_x(1e-3), 60, sensors);
  // the kernel drops what a busy server has not taken
  EXPECT_LE(sensors.counters.malformed, sent);
  EXPECT_GE(sensors.counters.malformed, sent / 3);
  EXPECT_EQ(sensors.counters.trips, 0U);
  EXPECT_NEAR(sensors.platform[0], 1e-3, 2e-4);
  for (const double wild : {1e300, -1e300, 1e9, 0.4}) {
    Command command = at_x(1e-3);
    for (Vector6* vector : {&command.displacement, &command.rate, &command.wrench}) {
      const Vector6 kept = *vector;
      vector->setConstant(wild == 0.4 && vector != &command.displacement ? 1e9 : wild);
      client.command(command);
      *vector = kept;
    }
  }
  follow(client, at_x(1e-3), 60, sensors);
  EXPECT_EQ(sensors.counters.out_of_range, 12U);
  EXPECT_NEAR(sensors.platform[0], 1e-3, 2e-4);
  served.stop();
  EXPECT_EQ(served.result().run.end, simulation::RunEnd::stopped);
}

TEST(Serve, WithAKeyOnlyWhoHasItIsHeard) {
  const Key key{"sixteen or more bytes"};
  Served served({.key = key});
  auto deaf = TestClient::of(served), liar = TestClient::of(served, {"another sixteen bytes"});
  Sensors sensors;
  for (auto* client : {&deaf, &liar}) {
    client->send({.mode = static_cast<std::uint64_t>(Mode::hello)});
    client->command(at_x(3e-3));
    EXPECT_FALSE(client->receive(sensors, 0.1));
  }
  auto client = TestClient::of(served, key);
  EXPECT_EQ(client.hello().counters.refused, 4U);
  EXPECT_NE(client.session, 0U);
  follow(client, at_x(1e-3), 50, sensors);
  EXPECT_TRUE(is_followed(sensors));
  served.stop();
}

TEST(Serve, ListensBeyondTheLoopbackWithAKeyOnly) {
  const auto machine = simulation::machine_of("zhang-jiang-2021");
  simulation::ClosedLoop loop(machine, machine.neutral(), fixed_steps(0.002));
  const auto told = [&](const ServeOptions& options) -> std::string {
    try {
      return serve(loop, options).place;
    } catch (const base::InputError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(told({.address = {"0.0.0.0", "0"}}),
              HasSubstr("--udp: error: '0.0.0.0' is beyond the loopback, expected --bind 0.0.0.0"));
  EXPECT_THAT(told({.address = {"127.0.0.1", "0"}, .bind = "0.0.0.0"}),
              HasSubstr("--bind: error: '0.0.0.0' is beyond the loopback, where only packets with "
                        "a key are accepted, expected --key FILE"));
  const Key key{"sixteen or more bytes"};
  EXPECT_THAT(told({.address = {"127.0.0.1", "0"}, .bind = "0.0.0.0", .key = key}),
              testing::StartsWith("0.0.0.0:"));
  EXPECT_THAT(told({.address = {"127.0.0.1", "0"}, .bind = "no.such.host.invalid", .key = key}),
              HasSubstr("is no address"));
  EXPECT_THAT(told({.address = {"127.0.0.1", "0"},
                    .layout = parse_layout("command = [ { name = \"drive\", type = \"f64\" } ]\n"
                                           "sensors = [ { name = \"length\", type = \"f64\" } ]",
                                           "vendor.toml"),
                    .key = key}),
              HasSubstr("must have session and sequence, both u64"));
}

TEST(Serve, WaitsAwakeForAsLongAsItIsTold) {
  const auto processor_time = [](double busy) {
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    Served served({.busy = busy}, fixed_steps(0.4));
    const auto& result = served.result();
    ::getrusage(RUSAGE_SELF, &after);
    EXPECT_EQ(result.run.samples, 401);  // with that at 0 s
    EXPECT_GE(result.lateness.p50, 0.0);
    const auto of = [](const rusage& usage) {
      return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
             1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    };
    return of(after) - of(before);
  };
  // 0.7 of 0.4 s, less what other programs take of them
  EXPECT_GT(processor_time(0.7e-3), processor_time(0.0) + 0.05);
  for (const double busy : {0.91e-3, -1e-6, std::nan("")}) {
    const auto machine = simulation::machine_of("zhang-jiang-2021");
    simulation::ClosedLoop loop(machine, machine.neutral(), fixed_steps(0.01));
    const ServeOptions options{.address = {"127.0.0.1", "0"}, .busy = busy};
    EXPECT_THROW(serve(loop, options, {}, {}), base::InputError) << busy;
  }
}

TEST(Key, IsAFileOfItsOwnerAlone) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "key";
  test::write_text(file, "0123456789abcdef");
  ::chmod(file.c_str(), 0644);
  EXPECT_THROW(read_key(file), base::InputError);
  ::chmod(file.c_str(), 0600);
  EXPECT_EQ(read_key(file).bytes, "0123456789abcdef");
  test::write_text(file, "0123456789abcde");
  EXPECT_THROW(read_key(file), base::InputError);
  EXPECT_THROW(read_key(folder / "none"), base::InputError);
}

}  // namespace
}  // namespace hydrapod::realtime
