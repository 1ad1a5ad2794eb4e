/// Under the client's clock the served machine is the simulated one, bit for bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "served.hpp"
#include "support/other_legs.hpp"

namespace hydrapod::realtime {
namespace {

using simulation::LoopSample;

struct Seen {
  control::Measurement measured{};
  Vector6 platform{}, spool{}, torque{}, motor_speed{}, nut{};
  bool oil{true};
};

/// Noise in all directions, forces and drives besides.
struct Scenario {
  signals::Generator commands, drives, forces;
  static signals::Signal noise(double size, double to) {
    signals::Signal signal{.form = signals::Noise{.to = to}};
    signal.size.setConstant(size);
    return signal;
  }
  Scenario()
      : commands({noise(1.3e-3, 20.0)}, 1e3, 3),
        drives({noise(0.011, 60.0)}, 1e3, 4),
        forces({noise(170.0, 50.0)}, 1e3, 5) {}
};

model::Machine hydraulic_machine() { return simulation::machine_of("zhang-jiang-2021"); }

std::vector<Seen> simulated(const simulation::LoopOptions& options,
                            const model::Machine& machine = hydraulic_machine()) {
  simulation::ClosedLoop loop(machine, machine.neutral(), options);
  Scenario scenario;
  simulation::LookAhead forces(scenario.forces);
  std::vector<Seen> seen;
  const auto summary = loop.run(
      [&](double, simulation::Excitation& excitation) {
        excitation.command = scenario.commands.next();
        excitation.drive = scenario.drives.next().value;
        forces.fill(excitation);
      },
      [&](const LoopSample& sample) {
        Seen one{sample.measured,
                 simulation::displacement_between(loop.operating(), sample.plant.X_BP)};
        one.oil = model::leg_type(machine) == model::LegType::cylinder;
        for (int i = 0; i < 6; ++i) {
          const auto& leg = sample.plant.legs[static_cast<std::size_t>(i)];
          one.spool[i] = leg.spool;
          one.torque[i] = leg.torque;
          one.motor_speed[i] = leg.motor_speed;
          one.nut[i] = leg.nut;
        }
        seen.push_back(one);
      });
  EXPECT_EQ(summary.end, simulation::RunEnd::finished) << summary.message;
  return seen;
}

void expect_same(const Sensors& sensors, const Seen& seen, std::size_t k) {
  ASSERT_EQ(sensors.length, seen.measured.length) << k;
  if (seen.oil) {
    ASSERT_EQ(sensors.cap_pressure, seen.measured.cap_pressure) << k;
    ASSERT_EQ(sensors.rod_pressure, seen.measured.rod_pressure) << k;
  }
  ASSERT_EQ(sensors.platform, seen.platform) << k;
  ASSERT_EQ(sensors.spool, seen.spool) << k;
  ASSERT_EQ(sensors.torque, seen.torque) << k;
  ASSERT_EQ(sensors.motor_speed, seen.motor_speed) << k;
  ASSERT_EQ(sensors.nut, seen.nut) << k;
}

void drive_through(TestClient& client, const std::vector<Seen>& reference) {
  Scenario scenario;
  expect_same(client.hello(), reference[0], 0);
  Vector6 force = scenario.forces.next().value;
  for (std::size_t k = 0; k + 1 < reference.size(); ++k) {
    const auto now = scenario.commands.next();
    const Vector6 next_force = scenario.forces.next().value;
    const auto number = client.command({.flags = next_wrench_given,
                                        .displacement = now.value,
                                        .rate = now.rate,
                                        .drive = scenario.drives.next().value,
                                        .wrench = force,
                                        .next_wrench = next_force});
    force = next_force;
    Sensors sensors;
    ASSERT_TRUE(client.receive(sensors)) << k;
    EXPECT_EQ(sensors.answered, number);
    EXPECT_EQ(sensors.time, 1'000'000 * (k + 1));
    expect_same(sensors, reference[k + 1], k + 1);
  }
}

TEST(LockStep, ByUdpIsTheSimulationBitForBit) {
  auto options = fixed_steps(0.4);
  options.seed = 17;
  const auto reference = simulated(options);
  ASSERT_EQ(reference.size(), 401U);
  Served served({.lock_step = true}, options);
  auto client = TestClient::of(served);
  drive_through(client, reference);
  client.command({});  // the last sample has a command too, and an answer although it is the end
  Sensors last;
  EXPECT_TRUE(client.receive(last));
  EXPECT_EQ(served.result().run.end, simulation::RunEnd::finished);
  EXPECT_EQ(served.result().counters.accepted, 401U);
  EXPECT_EQ(served.result().counters.missed, 0U);
  EXPECT_EQ(served.result().run.samples, 401);
}

/// Drives come a sample late, so that the torque before a command is that after it.
TEST(LockStep, OfElectricCylindersIsTheSimulationBitForBit) {
  const auto machine = test::machine_of(test::screw_file);
  ASSERT_EQ(machine.controller.delay, 1.0);
  auto options = fixed_steps(0.2);
  options.seed = 29;
  const auto reference = simulated(options, machine);
  ASSERT_EQ(reference.size(), 201U);
  EXPECT_GT(reference.back().motor_speed.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_GT((reference.back().torque - reference.front().torque).cwiseAbs().maxCoeff(), 1e-3);
  Served served({.lock_step = true}, options, {}, machine);
  auto client = TestClient::of(served);
  drive_through(client, reference);
  // a little more than six motors can push
  const double push = 6.0 * 37.0 * machine.legs[0].screw->ratio();
  client.command({.wrench = Vector6::Unit(2) * 1.01 * push});
  Sensors last;
  EXPECT_TRUE(client.receive(last));
  EXPECT_EQ(served.result().run.end, simulation::RunEnd::finished);
  EXPECT_EQ(served.result().counters.accepted, 200U);
  EXPECT_EQ(served.result().counters.out_of_range, 1U);
}

TEST(LockStep, BySharedMemoryIsTheSame) {
  auto options = fixed_steps(0.05);
  options.integrator = {};  // of its own size of steps
  const auto reference = simulated(options);
  const std::string name = "hydrapod-test-" + std::to_string(::getpid());
  {
    Served served({.shared_memory = name, .lock_step = true}, options);
    EXPECT_TRUE(std::filesystem::exists("/dev/shm/" + name));
    EXPECT_EQ(std::filesystem::status("/dev/shm/" + name).permissions(),
              std::filesystem::perms(0600));
    EXPECT_THROW(open_shared_memory(name, true, "--shm"), base::InputError);  // it has a server
    TestClient client(open_shared_memory(name, false, "--shm"));
    drive_through(client, reference);
    served.stop();
  }
  EXPECT_FALSE(std::filesystem::exists("/dev/shm/" + name));
  EXPECT_THROW(open_shared_memory(name, false, "--shm"), base::InputError);
  EXPECT_THROW(open_shared_memory("a/b", true, "--shm"), base::InputError);
}

/// The controller runs in the client and sends drives: the same run again. Sensors without noise,
/// as the closed loop starts its controller with the true values.
TEST(LockStep, TheControllerMayBeTheClients) {
  auto options = fixed_steps(0.3);
  options.ideal_sensors = true;
  const auto machine = simulation::machine_of("zhang-jiang-2021");
  simulation::ClosedLoop loop(machine, machine.neutral(), options);
  Scenario scenario;
  std::vector<Seen> reference;
  loop.run(simulation::command_source(scenario.commands), [&](const LoopSample& sample) {
    reference.push_back(
        {sample.measured, simulation::displacement_between(loop.operating(), sample.plant.X_BP)});
  });
  Served served({.lock_step = true}, options);
  auto client = TestClient::of(served);
  Sensors sensors = client.hello();
  control::Controller controller(machine, loop.parameters());
  const auto measured = [&] {
    return control::Measurement{sensors.length, sensors.cap_pressure, sensors.rod_pressure,
                                sensors.piston_acceleration};
  };
  controller.reset(machine.neutral(), measured());
  controller.take_over(loop.rest().input.command);
  Scenario again;
  for (std::size_t k = 0; k + 1 < reference.size(); ++k) {
    const auto drives = controller.step(
        measured(), simulation::command_at(machine.neutral(), again.commands.next()));
    client.command({.mode = static_cast<std::uint64_t>(Mode::valves), .drive = drives});
    ASSERT_TRUE(client.receive(sensors));
    ASSERT_EQ(sensors.length, reference[k + 1].measured.length) << k;
    ASSERT_EQ(sensors.platform, reference[k + 1].platform) << k;
  }
  EXPECT_GT(reference.back().platform.cwiseAbs().maxCoeff(), 1e-5);
}

TEST(LockStep, ACommandThatComesTwiceIsOneStepWithOneAnswer) {
  Served served({.lock_step = true, .once = true});
  auto client = TestClient::of(served);
  client.hello();
  Command command{.session = client.session, .sequence = 1};
  command.displacement[2] = 1e-3;
  Sensors sensors;
  client.send(command);
  ASSERT_TRUE(client.receive(sensors));
  const auto answer = client.last_bytes();
  client.send(command);
  ASSERT_TRUE(client.receive(sensors));
  EXPECT_EQ(client.last_bytes(), answer);
  EXPECT_EQ(sensors.time, 1'000'000U);
  // what the legs cannot reach is a step too, under the command before it
  command.sequence = 2;
  command.displacement[2] = 9.0;
  client.send(command);
  ASSERT_TRUE(client.receive(sensors));
  EXPECT_EQ(sensors.time, 2'000'000U);
  EXPECT_EQ(sensors.counters.out_of_range, 1U);
  EXPECT_EQ(sensors.answered, 2U);
  client.send(
      {.session = client.session, .sequence = 3, .mode = static_cast<std::uint64_t>(Mode::leave)});
  ASSERT_TRUE(client.receive(sensors));
  const auto& result = served.result();  // it ends, ramped down
  EXPECT_EQ(result.state, State::parked);
  EXPECT_EQ(result.counters.duplicated, 1U);
  EXPECT_EQ(result.counters.trips, 0U);
  EXPECT_NEAR(result.run.time, 0.002 + 1.0, 2e-3);
}

/// By the wall clock, as time stands still.
TEST(LockStep, WithoutAClientThePlatformIsRampedDown) {
  Served served({.lock_step = true, .once = true, .ramp = 0.5, .patience = 0.1});
  auto client = TestClient::of(served);
  client.hello();
  Command command;
  command.displacement[0] = 2e-3;
  Sensors sensors;
  for (int k = 0; k < 100; ++k) {
    client.command(command);
    ASSERT_TRUE(client.receive(sensors));
  }
  EXPECT_GT(sensors.platform[0], 5e-4);
  const auto& result = served.result();
  EXPECT_EQ(result.counters.trips, 1U);
  EXPECT_EQ(result.state, State::parked);
  EXPECT_NEAR(result.run.time, 0.1 + 0.5, 2e-3);
  EXPECT_LT(result.run.final_error.cwiseAbs().maxCoeff(), 2e-4);  // of 2 mm, and settling
}

}  // namespace
}  // namespace hydrapod::realtime
