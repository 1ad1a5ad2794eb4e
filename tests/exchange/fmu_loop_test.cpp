/// FMUs with the controller inside, against simulation::ClosedLoop.

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "exchange/fmu_subject.hpp"

namespace hydrapod::test {
namespace {

using simulation::ClosedLoop;

const char* const delay = "controller.delay=1.37";  // samples: drives come between two of them

/// A command that moves all directions, with its rate.
signals::Sample command_at_time(double time) {
  signals::Sample command;
  for (int k = 0; k < 6; ++k) {
    const double omega = 9.0 + 2.3 * k, size = k < 3 ? 7e-3 : 5e-3;
    command.value[k] = size * (1.0 - std::cos(omega * time));
    command.rate[k] = size * omega * std::sin(omega * time);
  }
  return command;
}

struct Controlled {
  explicit Controlled(FmuVersion version, std::vector<std::string> more = {delay})
      : machine(machine_of("heavy-platform", std::move(more))),
        fmu(archive_of(machine, {.version = version, .controlled = true})),
        plant(machine, dynamics::ModelKind::guide) {
    for (const char* front : {"command.", "command_rate."})
      for (int k = 0; k < 6; ++k)
        inputs.push_back(fmu.reference(std::string(front) + spatial::direction_name(k)));
    for (const auto& name : plant.state_names()) states.push_back(fmu.reference(name));
    for (int i = 1; i <= 6; ++i)
      drives.push_back(fmu.reference("leg" + std::to_string(i) + ".valve_command"));
  }

  static std::vector<double> commands(double time) {
    const auto command = command_at_time(time);
    std::vector<double> values(12);
    Eigen::Map<Vector6> value(values.data()), rate(values.data() + 6);
    value = command.value;
    rate = command.rate;
    return values;
  }
  using Vector6 = spatial::Vector6;

  /// The states at the samples, by `simulate` with sensors without faults.
  [[nodiscard]] std::vector<Eigen::VectorXd> expected(int samples) const {
    ClosedLoop loop(machine, machine.neutral(),
                    {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10},
                     .until = sample * samples,
                     .ideal_sensors = true});
    std::vector<Eigen::VectorXd> poses;
    loop.run([](double time,
                simulation::Excitation& excitation) { excitation.command = command_at_time(time); },
             [&](const simulation::LoopSample& at) {
               Eigen::VectorXd row(18);
               row << at.plant.X_BP.p_BP, spatial::rpy_from_rotation(at.plant.X_BP.R_BP),
                   at.applied, at.plant.legs[0].cap_pressure, at.plant.legs[3].rod_pressure,
                   at.plant.twist.head<4>();
               poses.push_back(row);
             });
    return poses;
  }

  [[nodiscard]] Eigen::VectorXd row(const Slave& slave) const {
    Eigen::VectorXd found(18);
    for (int k = 0; k < 6; ++k)
      found[k] = slave.get("pose." + std::string(spatial::direction_name(k)));
    const auto applied = slave.get(drives);
    for (int k = 0; k < 6; ++k) found[6 + k] = applied[static_cast<std::size_t>(k)];
    found[12] = slave.get("leg1.p_cap");
    found[13] = slave.get("leg4.p_rod");
    found[14] = slave.get("vx");
    found[15] = slave.get("vy");
    found[16] = slave.get("vz");
    found[17] = slave.get("wx");
    return found;
  }

  model::Machine machine;
  Unpacked fmu;
  Plant plant;
  std::vector<unsigned> inputs{}, states{}, drives{};
};

/// Of the range that each number goes through.
double worst(const std::vector<Eigen::VectorXd>& expected,
             const std::vector<Eigen::VectorXd>& found) {
  Eigen::VectorXd low = expected[0], high = expected[0], error = Eigen::VectorXd::Zero(18);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    low = low.cwiseMin(expected[k]);
    high = high.cwiseMax(expected[k]);
    error = error.cwiseMax((expected[k] - found[k]).cwiseAbs());
  }
  EXPECT_GT((high - low).minCoeff(), 0.0);
  return error.cwiseQuotient(high - low).maxCoeff();
}

class ControlledFmu : public testing::TestWithParam<FmuVersion> {};

/// The drives of a sample that are applied there are seen after it, in the next step.
TEST_P(ControlledFmu, MovesAsSimulateDoes) {
  const Controlled subject(GetParam());
  constexpr int samples = 400;
  const auto expected = subject.expected(samples);
  const Slave slave(subject.fmu, true, true, 1e-10);
  std::vector<Eigen::VectorXd> found{subject.row(slave)};
  for (int k = 0; k < samples; ++k) {
    ASSERT_EQ(ok, slave.set(subject.inputs, Controlled::commands(sample * k)));
    ASSERT_EQ(ok, slave.step(sample * k, sample * (k + 1) - sample * k));
    found.push_back(subject.row(slave));
  }
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_LT(worst(expected, found), 1e-6);
}

/// Model exchange: the environment's own Runge–Kutta steps, cut at the time events.
TEST_P(ControlledFmu, HasTimeEventsInModelExchange) {
  const Controlled subject(GetParam());
  const bool three = subject.fmu.three;
  constexpr int samples = 40;
  const auto expected = subject.expected(samples);
  const Slave slave(subject.fmu, false);
  const std::size_t n = subject.states.size();
  struct {
    int need, terminate, nominals, values, defined;
    double next;
  } info{};
  const auto update = [&] {
    if (three) {
      bool flags[5]{};
      EXPECT_EQ(ok, slave.call("fmi3UpdateDiscreteStates", &flags[0], &flags[1], &flags[2],
                               &flags[3], &flags[4], &info.next));
      info.defined = flags[4] ? 1 : 0;
    } else {
      EXPECT_EQ(ok, slave.call("fmi2NewDiscreteStates", static_cast<void*>(&info)));
    }
    EXPECT_EQ(1, info.defined);
  };
  std::vector<double> x(n), k1(n), k2(n), k3(n), k4(n);
  double time = 0.0;
  const auto rates = [&](double at, const std::vector<double>& state, std::vector<double>& out) {
    EXPECT_EQ(ok, slave.call(three ? "fmi3SetTime" : "fmi2SetTime", at));
    EXPECT_EQ(ok, slave.set_states(state));
    EXPECT_EQ(ok, slave.derivatives(out.data(), n));
  };
  const auto moved = [&](const std::vector<double>& by, double h) {
    auto state = x;
    for (std::size_t i = 0; i < n; ++i) state[i] += h * by[i];
    return state;
  };
  ASSERT_EQ(ok, slave.states(x.data(), n));
  std::vector<Eigen::VectorXd> found{subject.row(slave)};
  int events = 0;
  for (int k = 0; k < samples;) {
    ASSERT_EQ(ok, slave.set(subject.inputs, Controlled::commands(sample * k)));
    update();
    slave.enter_continuous_time();
    const double until = info.next;
    const int steps = std::max(1, static_cast<int>(std::ceil((until - time) / 2e-5)));
    const double h = (until - time) / steps;
    for (int s = 0; s < steps; ++s) {
      rates(time, x, k1);
      rates(time + 0.5 * h, moved(k1, 0.5 * h), k2);
      rates(time + 0.5 * h, moved(k2, 0.5 * h), k3);
      rates(time + h, moved(k3, h), k4);
      for (std::size_t i = 0; i < n; ++i) x[i] += h / 6.0 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
      time += h;
    }
    time = until;
    EXPECT_EQ(ok, slave.call(three ? "fmi3SetTime" : "fmi2SetTime", time));
    EXPECT_EQ(ok, slave.set_states(x));
    if (std::abs(time - sample * (k + 1)) < 1e-9) {
      found.push_back(subject.row(slave));
      ++k;
    }
    ASSERT_EQ(ok, slave.call(three ? "fmi3EnterEventMode" : "fmi2EnterEventMode"));
    ++events;
  }
  EXPECT_GT(events, samples + samples / 2);  // samples, and drives that come between them
  EXPECT_LT(worst({expected.begin(), expected.begin() + samples + 1}, found), 1e-6);
}

/// The state of the controller, drives on their way and pose included, goes through bytes.
TEST_P(ControlledFmu, SavedStatesContinueBitByBit) {
  const Controlled subject(GetParam(), {delay, "controller.feedback=\"acceleration\""});
  const Slave slave(subject.fmu, true), other(subject.fmu, true, false);
  constexpr double step = 0.7e-3;  // not the controller's
  const auto run = [&](const Slave& on, int from, int to) {
    for (int k = from; k < to; ++k) {
      EXPECT_EQ(ok, on.set(subject.inputs, Controlled::commands(step * k)));
      EXPECT_EQ(ok, on.step(step * k, step));
    }
    auto all = on.get(subject.states);
    for (const double drive : on.get(subject.drives)) all.push_back(drive);
    return all;
  };
  run(slave, 0, 33);
  void* state = nullptr;
  ASSERT_EQ(ok, slave.save(&state));
  const auto first = run(slave, 33, 60);
  ASSERT_EQ(ok, slave.restore(state));
  EXPECT_EQ(first, run(slave, 33, 60));

  auto bytes = slave.bytes_of(state);
  void* copy = nullptr;
  ASSERT_EQ(ok, other.state_from(bytes, &copy));
  ASSERT_EQ(ok, other.restore(copy));
  EXPECT_EQ(first, run(other, 33, 60));
  ASSERT_EQ(ok, slave.release(&state));
  ASSERT_EQ(ok, other.release(&copy));
  bytes.resize(bytes.size() - 8);
  EXPECT_EQ(error, other.state_from(bytes, &copy));
}

TEST_P(ControlledFmu, HasTheNumbersOfTheControllerAsParameters) {
  const Controlled subject(GetParam(), {"controller.bandwidth=5.1"});
  Slave slave(subject.fmu, true, false);
  EXPECT_EQ(ok, slave.set("controller.bandwidth", 0.05));
  EXPECT_EQ(ok, slave.set("controller.velocity_feedforward", 0.0));
  slave.begin(1e-6);
  EXPECT_EQ(ok, slave.set(subject.inputs, Controlled::commands(0.1)));
  const double before = slave.get("pose.z");
  for (int k = 0; k < 50; ++k) EXPECT_EQ(ok, slave.step(sample * k, sample));
  EXPECT_NEAR(before, slave.get("pose.z"), 1e-4);  // it does not follow
  const Slave as_it_is(subject.fmu, true);
  EXPECT_EQ(ok, as_it_is.set(subject.inputs, Controlled::commands(0.1)));
  for (int k = 0; k < 50; ++k) EXPECT_EQ(ok, as_it_is.step(sample * k, sample));
  EXPECT_GT(std::abs(as_it_is.get("pose.z") - before), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Fmu, ControlledFmu, testing::Values(FmuVersion::fmi2, FmuVersion::fmi3),
                         [](const auto& of) {
                           return std::string(of.param == FmuVersion::fmi2 ? "Fmi2" : "Fmi3");
                         });

}  // namespace
}  // namespace hydrapod::test
