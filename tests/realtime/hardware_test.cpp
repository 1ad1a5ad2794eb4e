/// The rig on "hardware": the virtual machine behind UDP.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "served.hpp"
#include "support/other_legs.hpp"

namespace hydrapod::realtime {
namespace {

using simulation::RunEnd;
using testing::HasSubstr;

class Hardware : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  std::string file = folder / "run.h5";
  model::Machine machine = simulation::machine_of("zhang-jiang-2021");
  rig::RigOptions options = [this] {
    rig::RigOptions rig;
    signals::Signal noise{.form = signals::Noise{.to = 40.0}};
    noise.size.setConstant(8e-5);
    rig.signals = {noise};
    rig.settling = 0.3;
    rig.duration = 0.8;
    rig.instruments.accelerometers = rig::default_accelerometers(machine);
    rig.instruments.accelerometers.resize(4);
    return rig;
  }();
  HardwareOptions hardware{.ramp = 0.2, .watchdog = 1.0, .connect = 1.0};

  ServeOptions server() const {
    return {.lock_step = true, .once = true, .accelerometers = options.instruments.accelerometers};
  }
  HardwareResult run(const Served& served, const simulation::KeepGoing& keep_going = {}) {
    hardware.address = parse_address("test", served.place());
    std::unique_ptr<data::RecordWriter> writer;
    const auto result = run_on_hardware(
        machine, machine.neutral(), options, hardware,
        [&]() -> data::RecordWriter& {
          return *(writer = data::open_record_writer(
                       file, {.channels = rig::rig_channels(options, model::leg_type(machine)),
                              .sample_rate = 1e3}));
        },
        keep_going);
    writer->close();
    return result;
  }
  std::string refused(const Served& served) {
    try {
      run(served);
    } catch (const base::InputError& error) {
      EXPECT_FALSE(std::filesystem::exists(file));
      return error.what();
    }
    return "nothing";
  }
  [[nodiscard]] data::Record record() const { return data::read_record(file).record; }
};

/// The simulated rig with the same commands measures the same, but for the growing excitation and
/// the accelerometers' own noise.
TEST_F(Hardware, IsMeasuredAsTheMachineInTheProgramIs) {
  Served served(server());
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::finished) << result.rig.summary.message;
  EXPECT_FALSE(result.ramped_down);
  EXPECT_EQ(result.lost, 0U);
  EXPECT_EQ(result.rig.samples, 800);
  EXPECT_EQ(served.result().state, State::parked);
  const auto found = record();
  ASSERT_EQ(found.samples.rows(), 800);
  ASSERT_TRUE(found.samples.allFinite());
  // the same run again, in this program
  simulation::ClosedLoop loop(machine, machine.neutral(), fixed_steps(1.3));
  std::vector<Vector6> commanded, lengths, applied;
  signals::Generator signal(options.signals, 1e3, options.seed);
  const auto share = [&](double t) {  // of the excitation, of its time from 0 to 0.2 s
    const double tau = std::min(t / hardware.ramp, 1.0);
    return tau * tau * tau * (10.0 - 15.0 * tau + 6.0 * tau * tau);
  };
  long k = 0;
  loop.run(
      [&](double, simulation::Excitation& excitation) {
        const auto now = signal.next();
        const double t = 1e-3 * static_cast<double>(k++), h = 1e-7;
        const double w = share(t);
        const double rate = t < hardware.ramp ? (share(t + h) - share(std::max(t - h, 0.0))) /
                                                    (t > 0.0 ? 2.0 * h : h)
                                              : 0.0;
        excitation.command = {.value = w * now.value, .rate = w * now.rate + rate * now.value};
      },
      [&](const simulation::LoopSample& sample) {
        commanded.push_back(sample.excitation.command.value);
        lengths.push_back(sample.measured.length);
        applied.push_back(sample.applied);
      });
  // row k is the machine's sample first + k: the first command acted from the sample before 0 on
  Eigen::Index shift = -1;
  for (Eigen::Index at = 295; at < 305; ++at)
    if ((found.samples.row(0).head<6>().transpose() - commanded[static_cast<std::size_t>(at)])
            .norm() < 1e-15)
      shift = at;
  ASSERT_GE(shift, 0);
  for (Eigen::Index row = 0; row < 800; ++row) {
    const auto at = static_cast<std::size_t>(shift + row);
    const auto sample = found.samples.row(row).transpose();
    ASSERT_LT((sample.head<6>() - commanded[at]).norm(), 1e-15) << row;
    // rates of the growing share are differences above, so that the last bits differ until then and
    // the sensors' steps of 1 µm fall otherwise now and then
    ASSERT_LT((sample.segment<6>(12) - lengths[at]).cwiseAbs().maxCoeff(), 3e-6) << row;
    ASSERT_LT((sample.segment<6>(6) - applied[at]).cwiseAbs().maxCoeff(), 1e-5) << row;
  }
  EXPECT_GT(found.samples.col(30).cwiseAbs().maxCoeff(), 0.01);  // accelerometers measure
}

TEST_F(Hardware, TheExcitationGrowsAndEnds) {
  options.settling = 0.2;
  options.duration = 0.1;
  Served served(server());
  run(served);
  EXPECT_LT(served.result().run.final_error.cwiseAbs().maxCoeff(), 5e-5);
  const auto& summary = served.result().run;
  // settling 0.2, record 0.1, end 0.2; then the server's second
  EXPECT_NEAR(summary.time, 0.5 + 1.0, 5e-3);
}

TEST_F(Hardware, DrivesMayBeExcited) {
  options.entry = rig::Entry::drive;
  options.signals[0].size.setConstant(0.01);
  Served served(server());
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::finished) << result.rig.summary.message;
  const auto samples = record().samples;
  EXPECT_NEAR(std::sqrt(samples.col(2).squaredNorm() / 800.0), 0.01, 3e-3);
  EXPECT_GT(samples.col(6).cwiseAbs().maxCoeff(), 5e-3);
}

/// The motors hold the weight on average, and turn.
TEST_F(Hardware, OfElectricCylindersIsMeasuredByItsMotors) {
  machine = test::machine_of(test::screw_file);
  options.signals[0].size.setConstant(2e-5);
  Served served(server(), fixed_steps(), {}, machine);
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::finished) << result.rig.summary.message;
  const auto found = record();
  ASSERT_EQ(found.samples.rows(), 800);
  ASSERT_TRUE(found.samples.allFinite());
  const simulation::Plant plant(machine, dynamics::ModelKind::guide);
  const auto rest = plant.equilibrium(machine.neutral());
  const auto held = plant.motor_torques(rest.x.data(), Vector6::Zero());
  for (int leg = 0; leg < 6; ++leg) {
    const int torque = 18 + 2 * leg, speed = torque + 1;
    EXPECT_EQ(found.header.channels[static_cast<std::size_t>(torque)].unit, "N m");
    EXPECT_EQ(found.header.channels[static_cast<std::size_t>(speed)].unit, "rad/s");
    EXPECT_NEAR(found.samples.col(torque).mean(), held[leg], 1.0);
    EXPECT_GT(found.samples.col(speed).cwiseAbs().maxCoeff(), 0.1);
    EXPECT_LT(std::abs(found.samples.col(speed).mean()), 0.1);
  }
}

TEST_F(Hardware, OfTheOtherKindOfActuatorIsRefused) {
  auto open_server = server();
  open_server.once = false;
  const Served served(open_server, fixed_steps(), {}, test::machine_of(test::screw_file));
  hardware.connect = 0.3;
  EXPECT_THAT(refused(served), HasSubstr("cylinders where the file has screws"));
}

TEST_F(Hardware, IsRampedDownAtALimit) {
  hardware.limits.velocity = 0.002;
  Served served(server());
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::failed);
  EXPECT_TRUE(result.ramped_down);
  EXPECT_THAT(result.rig.summary.message,
              testing::AllOf(HasSubstr("moves at"), HasSubstr("the limit is 0.002 m/s")));
  EXPECT_LT(result.rig.samples, 800);
  EXPECT_EQ(record().samples.rows(), result.rig.samples);
  EXPECT_EQ(served.result().state, State::parked);
}

TEST_F(Hardware, IsRampedDownWhenAskedToStop) {
  Served served(server());
  const auto result = run(served, [](double time) { return time < 0.7; });
  EXPECT_EQ(result.rig.summary.end, RunEnd::stopped);
  EXPECT_TRUE(result.ramped_down);
  EXPECT_NEAR(static_cast<double>(result.rig.samples), 400.0, 5.0);
  EXPECT_EQ(record().samples.rows(), result.rig.samples);
  EXPECT_EQ(served.result().state, State::parked);
  // 0.2 s of ramp down, which the server has followed
  EXPECT_NEAR(served.result().run.time, 0.7 + 0.2 + 1.0, 0.01);
}

/// A slow sine at the drives is stopped near its top, and no drive of the machine jumps.
TEST_F(Hardware, ItsDrivesAreRampedDownToo) {
  options.entry = rig::Entry::drive;
  options.signals[0].form = signals::Sine{.frequency = 1.3};
  options.signals[0].size.setConstant(0.03);
  const std::string served_file = folder / "served.h5";
  std::unique_ptr<data::RecordWriter> writer;
  {
    Served served(server(), fixed_steps(), [&]() -> data::RecordWriter& {
      simulation::ClosedLoop loop(machine, machine.neutral(), fixed_steps());
      data::RecordHeader header{.channels = simulation::record_channels(loop), .sample_rate = 1e3};
      for (const auto& more : serve_channels(loop, server())) header.channels.push_back(more);
      return *(writer = data::open_record_writer(served_file, header));
    });
    const auto result = run(served, [](double time) { return time < 0.95; });
    EXPECT_TRUE(result.ramped_down);
    EXPECT_EQ(served.result().state, State::parked);
  }
  writer->close();
  const auto served = data::read_record(served_file).record;
  const auto column = data::find_channel(served.header, "leg1.drive");
  ASSERT_TRUE(column.has_value());
  const auto drive = served.samples.col(static_cast<Eigen::Index>(*column));
  EXPECT_GT(drive.head(900).cwiseAbs().maxCoeff(), 0.01);
  const Eigen::Index n = drive.size();
  EXPECT_LT((drive.tail(n - 901) - drive.segment(900, n - 901)).cwiseAbs().maxCoeff(), 1.5e-3);
}

TEST_F(Hardware, ThatFallsSilentEndsTheRun) {
  hardware.watchdog = 0.08;
  Served served(server());
  const auto result = run(served, [&](double time) {
    if (time > 0.6) served.stop();
    return true;
  });
  EXPECT_EQ(result.rig.summary.end, RunEnd::failed);
  EXPECT_THAT(result.rig.summary.message, HasSubstr("no sensors for"));
  EXPECT_THAT(result.rig.summary.message, testing::EndsWith(" ms"));
  EXPECT_GT(result.rig.samples, 250);
  EXPECT_EQ(record().samples.rows(), result.rig.samples);
}

TEST_F(Hardware, ThatFollowsAnotherClientIsToldSo) {
  hardware.watchdog = 1.2;
  auto open_server = server();
  open_server.once = false;
  Served served(open_server);
  auto other = TestClient::of(served);
  Command stay;
  stay.mode = static_cast<std::uint64_t>(Mode::pose);
  stay.sequence = 1;
  other.send(stay);
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::failed);
  EXPECT_THAT(result.rig.summary.message,
              testing::ContainsRegex("no sensors for [0-9]+ ms; a machine that follows another"));
}

TEST_F(Hardware, MustBeAtThePose) {
  auto server_options = server();
  server_options.once = false;
  auto moved = fixed_steps();
  moved.initial[2] = 0.012;
  Served served(server_options, moved);
  EXPECT_THAT(refused(served), testing::AllOf(HasSubstr("--hardware: error: leg "),
                                              HasSubstr("bring the platform to the pose first")));
}

TEST_F(Hardware, MustSampleAsTheFileSays) {
  machine.controller.sample_time = 2e-3;
  options.rate = 500.0;
  Served served(server());
  EXPECT_THAT(run(served).rig.summary.message,
              HasSubstr("the machine samples every 1 ms, and controller.sample_time is 2 ms"));
}

TEST_F(Hardware, ThatIsNotThereIsToldSo) {
  std::string place;
  {
    Served gone(server());
    place = gone.place();
  }
  hardware.connect = 0.3;
  hardware.address = parse_address("test", place);
  try {
    run_on_hardware(machine, machine.neutral(), options, hardware,
                    []() -> data::RecordWriter& { throw std::logic_error("no record to open"); });
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no answer for 0.3 s; 0 packets came"));
  }
}

TEST_F(Hardware, OfAnotherLayoutOrKeyIsToldSo) {
  auto open_server = server();
  open_server.once = false;
  Served served(open_server);
  hardware.connect = 0.3;
  options.instruments.accelerometers.resize(3);
  EXPECT_THAT(refused(served), testing::ContainsRegex("[1-9][0-9]* of them malformed"));
  options.instruments.accelerometers = rig::default_accelerometers(machine);
  options.instruments.accelerometers.resize(4);
  hardware.key.bytes = "sixteen or more bytes";
  EXPECT_THAT(refused(served), HasSubstr("0 packets came"));
}

TEST_F(Hardware, ImpossibleWishesAreRefused) {
  auto open_server = server();
  open_server.once = false;
  Served served(open_server);
  options.entry = rig::Entry::wrench;
  EXPECT_THAT(refused(served), HasSubstr("--entry wrench: error: a machine has no actuator"));
  options.entry = rig::Entry::command;
  options.rate = 200.0;
  EXPECT_THAT(refused(served), HasSubstr("--rate: error: is 200 Hz"));
  options.rate = 1000.0;
  hardware.ramp = 0.5;
  EXPECT_THAT(refused(served), HasSubstr("--ramp: error: is 0.5 s and --settling 0.3 s"));
  hardware.ramp = 0.2;
  hardware.layout = parse_layout(
      "command = [ { name = \"drive\", type = \"f64\" } ]\n"
      "sensors = [ { name = \"length\", type = \"f64\" } ]",
      "vendor.toml");
  EXPECT_THAT(refused(served), HasSubstr("'command' has no displacement"));
}

/// Packets of a vendor: no mode, no session, short numbers that go round, lengths in micrometres.
TEST_F(Hardware, OfAVendorIsADescription) {
  const std::string text =
      "byte_order = \"big\"\n"
      "command = [ { name = \"constant\", type = \"u8\", value = 253 },\n"
      "  { name = \"sequence\", type = \"u8\" }, { name = \"displacement\", type = \"f32\" },\n"
      "  { name = \"rate\", type = \"f32\" },\n"
      "  { name = \"crc16\", type = \"u16\", from = 1, extra = 50 } ]\n"
      "sensors = [ { name = \"constant\", type = \"u8\", value = 254 },\n"
      "  { name = \"sequence\", type = \"u16\" }, { name = \"answered\", type = \"u8\" },\n"
      "  { name = \"length\", type = \"u32\", unit = \"um\" },\n"
      "  { name = \"valve\", type = \"i16\", factor = 1e-4 },\n"
      "  { name = \"crc16\", type = \"u16\" } ]\n";
  auto vendor = server();
  vendor.accelerometers.clear();
  options.instruments.accelerometers.clear();
  vendor.layout = hardware.layout = parse_layout(text, "vendor.toml");
  vendor.patience = 0.3;  // there is no word for leaving
  Served served(vendor);
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::finished) << result.rig.summary.message;
  EXPECT_EQ(result.lost, 0U);
  const auto samples = record().samples;
  ASSERT_EQ(samples.rows(), 800);
  const Vector6 rest = kinematics::leg_lengths(machine, machine.neutral());
  EXPECT_LT((samples.middleCols(12, 6).rowwise() - rest.transpose()).cwiseAbs().maxCoeff(), 5e-3);
  EXPECT_NEAR(std::sqrt(samples.col(0).squaredNorm() / 800.0), 8e-5, 2.5e-5);
  EXPECT_EQ(served.result().state, State::parked);
  EXPECT_EQ(served.result().counters.lost, 0U);
}

/// On the wall clock, with both ends in a hurry on a machine that may have other work: nothing is
/// claimed of times, and everything of safety and of what is in the record.
TEST_F(Hardware, OnTheWallClockIsMeasuredToo) {
  auto live = server();
  live.lock_step = false;
  live.hold = 1.0;
  Served served(live);
  const auto result = run(served);
  EXPECT_EQ(result.rig.summary.end, RunEnd::finished) << result.rig.summary.message;
  const auto samples = record().samples;
  ASSERT_EQ(samples.rows(), 800);
  EXPECT_TRUE(samples.leftCols(6).allFinite());
  EXPECT_EQ(served.result().state, State::parked);
  EXPECT_EQ(served.result().counters.malformed, 0U);
  EXPECT_EQ(served.result().counters.refused, 0U);
}

}  // namespace
}  // namespace hydrapod::realtime
