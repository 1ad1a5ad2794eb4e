/// Electric drives in the plant and in the loop around it, against closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/capability.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/other_legs.hpp"
#include "support/random.hpp"
#include "support/symmetric_screws.hpp"

namespace hydrapod::simulation {
namespace {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using test::rise;
using test::smooth;
using test::symmetric_screws;
using test::ugly_screws;
using testing::HasSubstr;
using S = test::SymmetricScrews;

VectorXcd eigenvalues(const MatrixXd& A) {
  return Eigen::EigenSolver<MatrixXd>(A, false).eigenvalues();
}

double distance(const VectorXcd& poles, std::complex<double> pole) {
  return (poles.array() - pole).abs().minCoeff();
}

PlantInput speeds(double command) { return {.command = Vector6::Constant(command)}; }

/// p F/2π of the weight's share m g/6n_z; nothing moves then.
TEST(Drives, HoldTheLoadByTheTorqueOfTheScrew) {
  constexpr double g = 9.81;
  const auto machine = symmetric_screws(g);
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  const double force = S::mass * g / (6.0 * rise(machine));
  const auto out = plant.outputs(rest.x.data(), rest.input);
  for (const auto& leg : out.legs) {
    EXPECT_NEAR(leg.torque, force / S::ratio, 1e-9 * force / S::ratio);
    EXPECT_NEAR(leg.oil_force, force, 1e-9 * force);
    EXPECT_NEAR(leg.nut - leg.piston, force / S::k_a, 1e-12);
    EXPECT_EQ(leg.motor_speed, 0.0);
    EXPECT_EQ(leg.cap_pressure, 0.0);
  }
  EXPECT_TRUE(rest.input.command.isZero(0.0));
  const auto ugly = ugly_screws();
  for (const auto kind : {ModelKind::rigid, ModelKind::guide}) {
    const Plant loaded(ugly, kind);
    const auto still = loaded.equilibrium(ugly.neutral());
    VectorXd rate(loaded.layout().size);
    ASSERT_TRUE(loaded.derivative(0.0, still.x.data(), still.input, rate.data()));
    EXPECT_LT(rate.cwiseQuotient(loaded.scales()).cwiseAbs().maxCoeff(), 1e-5);
    // gimbals yield between piston and joint, not between nut and piston
    for (const auto& leg : loaded.outputs(still.x.data(), still.input).legs)
      EXPECT_NEAR(leg.nut - leg.piston, leg.oil_force / S::k_a, 1e-12);
  }
}

/// Motors that are not controlled are the free motors of the linear system.
TEST(Drives, WithoutSpeedLoopsAreFreeMotors) {
  const auto machine = ugly_screws();
  for (const auto kind : {ModelKind::rigid, ModelKind::guide}) {
    const Plant plant(machine, kind, {.friction = Friction::viscous, .speed_loops = false});
    const auto rest = plant.equilibrium(machine.neutral());
    const auto found = eigenvalues(plant.linearise(rest.x, rest.input).A);
    const auto expected = eigenvalues(screw_system(machine, machine.neutral(), kind).A);
    ASSERT_EQ(found.size(), expected.size() + 6);  // torques that stay
    for (const auto pole : expected)
      EXPECT_LT(distance(found, pole), 1e-5 * std::abs(pole) + 1e-3) << pole;
  }
}

/// z, s_n, their rates, T_i: m z̈ = q F, m_r s̈_n = (2π/p) T_i − slow ṡ_n − F.
VectorXcd poles_of_two_masses(const model::Machine& machine, double gain, double integral_time) {
  constexpr double c_a = S::c_a;
  const double n_z = rise(machine), m = S::mass, q = 6.0 * n_z, m_r = S::reflected;
  const double slow = (S::b + gain) * S::ratio * S::ratio;
  Eigen::Matrix<double, 5, 5> A;
  A << 0, 0, 1, 0, 0, 0, 0, 0, 1, 0,                                              //
      -q * n_z * S::k_a / m, q * S::k_a / m, -q * n_z * c_a / m, q * c_a / m, 0,  //
      n_z * S::k_a / m_r, -S::k_a / m_r, n_z * c_a / m_r, -(c_a + slow) / m_r, S::ratio / m_r, 0, 0,
      0, -gain * S::ratio / integral_time, 0;
  return eigenvalues(A);
}

/// Platform in heave, rotors and their speed loops, as they are without keys and with them.
TEST(Drives, HaveThePolesOfTwoMassesAndASpeedLoop) {
  struct Given {
    std::optional<double> bandwidth, integral_time;
    double gain, t_i;
  };
  constexpr double turn = 2.0 * std::numbers::pi, J = S::inertia;
  for (const auto& given : {Given{{}, {}, turn * 50.0 * J, 4.0 / (turn * 50.0)},
                            Given{83.0, {}, turn * 83.0 * J, 4.0 / (turn * 83.0)},
                            Given{31.0, 0.0071, turn * 31.0 * J, 0.0071}}) {
    auto machine = test::damped_screws();
    for (auto& leg : machine.legs) {
      if (given.bandwidth) leg.screw->speed_bandwidth = *given.bandwidth;
      leg.screw->speed_integral_time = given.integral_time;
    }
    const auto loop = speed_loop(*machine.legs[0].screw);
    EXPECT_NEAR(loop.gain, given.gain, 1e-12);
    EXPECT_NEAR(loop.integral_time, given.t_i, 1e-12);
    const Plant plant(machine, ModelKind::rigid, {.friction = Friction::viscous});
    const auto rest = plant.equilibrium(machine.neutral());
    const auto found = eigenvalues(plant.linearise(rest.x, rest.input).A);
    for (const auto pole : poles_of_two_masses(machine, given.gain, given.t_i))
      EXPECT_LT(distance(found, pole), 1e-6 * std::abs(pole) + 1e-3) << pole;
  }
}

/// p u ω_max/2π along every leg, with the load's torque once the speed is reached.
TEST(Drives, ReachTheSpeedOfTheirCommand) {
  const auto machine = symmetric_screws(9.81);
  const Plant plant(machine, ModelKind::rigid);
  for (const double command : {0.071, -0.043}) {
    const auto rest = plant.equilibrium(machine.neutral());
    Integrator run(plant);
    run.start(0.0, rest.x);
    run.advance(0.4, speeds(command));
    const double speed = command * S::speed / S::ratio;
    const auto out = plant.outputs(run.state().data(), speeds(command));
    for (const auto& leg : out.legs) {
      EXPECT_NEAR(leg.motor_speed, command * S::speed, 1e-3 * std::abs(command) * S::speed);
      EXPECT_NEAR(leg.length_rate, speed, 1e-3 * std::abs(speed));
      // at a constant speed the load, which turns with the pose, and the friction
      EXPECT_NEAR(leg.torque, leg.oil_force / S::ratio + std::copysign(S::friction, command),
                  0.01 * S::friction);
    }
  }
}

/// At its limit the torque accelerates platform and rotors as `capability` says, and the integral
/// does not wind up beyond it.
TEST(Drives, AccelerateByTheirLargestTorque) {
  const auto machine = symmetric_screws(9.81);
  const Plant plant(machine, ModelKind::rigid);
  const auto able = capability(machine, machine.neutral(), ModelKind::rigid);
  ASSERT_TRUE(able);
  const double n_z = rise(machine);
  const double period =
      2.0 * std::numbers::pi / std::sqrt(S::k_a * (6.0 * n_z * n_z / S::mass + 1.0 / S::reflected));
  for (const int sign : {0, 1}) {
    const auto input = speeds(sign == 0 ? 1.0 : -1.0);
    const auto rest = plant.equilibrium(machine.neutral());
    Integrator run(plant);
    run.start(0.0, rest.x);
    const auto speed_at = [&](double time) {
      run.advance(time, input);
      const auto out = plant.outputs(run.state().data(), input);
      for (const auto& leg : out.legs) EXPECT_EQ(std::abs(leg.torque), S::torque) << time;
      return std::abs(out.twist[2]);
    };
    const double first = speed_at(period), last = speed_at(3.0 * period);
    const double expected = able->of(Ability::acceleration, 2, sign).value;
    EXPECT_NEAR((last - first) / (2.0 * period), expected, 0.03 * expected);
    run.advance(6.0 * period, input);
    for (int i = 0; i < 6; ++i)
      EXPECT_LE(std::abs(run.state()[plant.layout().nut(i) + 2]), S::torque * (1.0 + 1e-9));
  }
}

/// In motion, off rest in everything, torques within their limits.
TEST(Drives, AreLinearisedAsTheyChange) {
  test::Random random(90);
  const auto machine = ugly_screws();
  for (const auto kind : {ModelKind::rigid, ModelKind::guide}) {
    const Plant plant(machine, kind);
    const auto& layout = plant.layout();
    auto rest = plant.equilibrium(machine.neutral());
    for (int k = layout.velocity(); k < layout.nuts; ++k) rest.x[k] = random.uniform(-0.02, 0.02);
    for (int i = 0; i < 6; ++i) {
      rest.x[layout.nut(i)] += random.uniform(-1e-5, 1e-5);
      rest.x[layout.nut(i) + 1] = random.uniform(-0.004, 0.004);
      rest.x[layout.nut(i) + 2] = random.uniform(-9.0, 9.0);
      rest.input.command[i] = random.uniform(-0.02, 0.02);
    }
    const auto torques = plant.motor_torques(rest.x.data(), rest.input.command);
    ASSERT_LT(torques.cwiseAbs().maxCoeff(), 30.0);
    const auto linear = plant.linearise(rest.x, rest.input);
    VectorXd scales(layout.tangent()), change(layout.tangent());
    scales << plant.scales().head(3), plant.scales().tail(layout.size - 4);
    for (int k = 0; k < change.size(); ++k)
      change[k] = 1e-6 * scales[k] * random.uniform(-1.0, 1.0);
    VectorXd high(layout.size), low(layout.size), rate_high(layout.size), rate_low(layout.size);
    plant.displace(rest.x.data(), change.data(), high.data());
    plant.displace(rest.x.data(), VectorXd(-change).data(), low.data());
    ASSERT_TRUE(plant.derivative(0.0, high.data(), rest.input, rate_high.data()));
    ASSERT_TRUE(plant.derivative(0.0, low.data(), rest.input, rate_low.data()));
    const VectorXd expected = linear.A * change, found = 0.5 * (rate_high - rate_low);
    for (int k = 7; k < layout.size; ++k)
      EXPECT_NEAR(found[k], expected[k - 1],
                  1e-6 * linear.A.row(k - 1).cwiseAbs().dot(change.cwiseAbs()) + 1e-12)
          << plant.state_names()[static_cast<std::size_t>(k)];
    EXPECT_EQ(linear.C.rows(), std::ssize(plant.linear_output_names()));
    EXPECT_EQ(std::ssize(plant.state_units()), layout.size);
    EXPECT_EQ(plant.state_names()[static_cast<std::size_t>(layout.nut(2) + 2)],
              "leg3.torque_integral");
    // torques answer to commands within the limit
    const double per_command =
        speed_loop(*machine.legs[0].screw).gain * 2900.0 / 60.0 * 2.0 * std::numbers::pi;
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(linear.D(18 + 2 * i, i), per_command, 1e-7 * per_command);
  }
}

/// What motors put in, less friction and dampers, is what platform, rotors and springs have more.
TEST(Drives, KeepTheWorkOfTheMotors) {
  const auto machine = ugly_screws();
  const Plant plant(machine, ModelKind::guide);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  run.start(0.0, rest.x);
  PlantInput input = rest.input;
  for (int i = 0; i < 6; ++i) input.command[i] = 0.011 * std::cos(1.0 + 2.0 * i);
  const auto energy = [](const PlantOutput& out) {
    return out.energies.total() + out.oil_spring_energy + out.motor_energy;
  };
  const auto power = [](const PlantOutput& out) { return out.motor_power - out.dissipation; };
  const auto first = plant.outputs(rest.x.data(), input);
  constexpr int samples = 4000;
  constexpr double interval = 5e-5;
  double work = power(first), put_in = 0.0, most_torque = 0.0;
  for (int k = 1; k <= samples; ++k) {
    run.advance(k * interval, input);
    const auto out = plant.outputs(run.state().data(), input);
    work += (k == samples ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * power(out);
    put_in += interval * std::abs(out.motor_power);
    for (const auto& leg : out.legs) most_torque = std::max(most_torque, std::abs(leg.torque));
  }
  work *= interval / 3.0;
  ASSERT_LT(most_torque, 37.0);  // at a limit the power has a corner
  const double gained = energy(plant.outputs(run.state().data(), input)) - energy(first);
  EXPECT_NEAR(work, gained, 1e-6 * put_in);
}

/// The nonlinear machine under the real controller, for a step of 20 µm, against the sampled linear
/// loop, sample by sample.
TEST(DrivesInTheLoop, FollowTheLinearLoop) {
  const auto machine = smooth(ugly_screws());
  ClosedLoop loop(machine, machine.neutral(),
                  {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10},
                   .until = 0.5,
                   .ideal_sensors = true});
  EXPECT_EQ(loop.parameters().feedback, model::DampingFeedback::none);
  const auto system = linear_system(machine, machine.neutral());
  EXPECT_TRUE(system_poles(system).sampled_stable);
  const auto n = loop.plant().layout().tangent();
  for (const int direction : {0, 2, 5}) {
    const Vector6 size = 2e-5 * Vector6::Unit(direction);
    signals::Generator step({{.size = size, .form = signals::Step{.at = 0.0}}},
                            1.0 / loop.parameters().sample_time);
    VectorXd w = VectorXd::Zero(system.sampled.rows());
    double worst = 0.0;
    const auto summary = loop.run(command_source(step), [&](const LoopSample& sample) {
      const Vector6 linear = system.C.leftCols(n) * w.head(n);
      const Vector6 real = displacement_between(loop.operating(), sample.plant.X_BP);
      worst = std::max(worst, (linear - real).norm());
      w = (system.sampled * w + system.sampled_command * size).eval();
    });
    EXPECT_EQ(summary.end, RunEnd::finished) << summary.message;
    EXPECT_LT(worst, 1e-3 * 2e-5) << direction;
  }
}

/// A gain that is too high: what oscillates grows as the sampled poles say.
TEST(DrivesInTheLoop, GrowAsThePolesSay) {
  auto machine = smooth(ugly_screws());
  machine.controller.integral_time = 0.0;
  std::complex<double> pole;
  for (double gain = 40.0; pole.real() < 15.0 && gain < 1e4; gain *= 1.03) {
    machine.controller.gain = Vector6::Constant(gain);
    pole = system_poles(linear_system(machine, machine.neutral())).sampled.front();
  }
  ASSERT_LT(pole.real(), 30.0) << pole;
  ASSERT_GT(pole.imag(), 0.0) << pole;
  ClosedLoop loop(machine, machine.neutral(),
                  {.integrator = {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11},
                   .until = 3.0,
                   .ideal_sensors = true});
  EXPECT_THAT(instability(loop), HasSubstr("the closed loop is unstable: it oscillates at"));
  signals::Generator step({{.size = Vector6::Constant(1e-8), .form = signals::Step{.at = 0.0}}},
                          1.0 / loop.parameters().sample_time);
  // Beyond the steps of forward kinematics (1 nm), below the limits of the torque.
  constexpr double low = 1e-6, high = 2e-5;
  double from = 0.0, to = 0.0;
  loop.run(
      command_source(step),
      [&](const LoopSample& sample) {
        const double size = displacement_between(loop.operating(), sample.plant.X_BP).norm();
        if (size > low && from == 0.0) from = sample.time;
        if (size > high && to == 0.0) to = sample.time;
      },
      [&](double) { return to == 0.0; });
  ASSERT_GT(to, from);
  // the next pole grows a little too, and a peak comes up to half a period late
  EXPECT_NEAR(std::log(high / low) / (to - from), pole.real(), 0.12 * pole.real()) << pole;
}

/// Accounts of a run: speed, torque, and the share of the time at the limit.
TEST(DrivesInTheLoop, SayWhenTheTorqueIsAtItsLimit) {
  const auto machine = symmetric_screws(9.81);
  const auto account = [&](double size) {
    ClosedLoop loop(machine, machine.neutral(), {.kind = ModelKind::rigid, .until = 0.6});
    signals::Generator step({{.size = size * Vector6::Unit(2), .form = signals::Step{}}},
                            1.0 / loop.parameters().sample_time);
    TraceRecorder recorder(loop, 0.6);
    const auto channels = record_channels(loop);
    std::vector<double> row(channels.size());
    auto summary = loop.run(command_source(step), [&](const LoopSample& sample) {
      recorder(sample);
      record_row(loop, sample, row.data());
    });
    EXPECT_EQ(summary.end, RunEnd::finished) << summary.message;
    EXPECT_EQ(recorder.trace().torque.size(), recorder.trace().time.size());
    EXPECT_TRUE(recorder.trace().cap_pressure.empty());
    const auto at = [&](const std::string& name) {
      for (std::size_t k = 0; k < channels.size(); ++k)
        if (channels[k].name == name) return row[k];
      ADD_FAILURE() << name;
      return 0.0;
    };
    EXPECT_NEAR(at("leg1.torque") * S::ratio, at("leg1.screw_force"), 1.1 * S::friction * S::ratio);
    EXPECT_GT(at("leg1.nut"), 0.0);
    return summary;
  };
  const auto small = account(1e-4), large = account(0.02);
  EXPECT_EQ(small.torque_limited[0], 0);
  EXPECT_LT(small.peak_torque[0], S::torque);
  EXPECT_GT(large.torque_limited[0], 0);
  EXPECT_EQ(large.peak_torque[0], S::torque);
}

std::string refusal(const model::Machine& machine) {
  try {
    const Plant plant(machine, ModelKind::rigid);
    static_cast<void>(plant.equilibrium(machine.neutral()));
  } catch (const base::InputError& error) {
    return error.what();
  } catch (const base::ComputationError& error) {
    return error.what();
  }
  return {};
}

TEST(Drives, NeedTheLimitsOfTheirMotors) {
  auto machine = symmetric_screws(9.81);
  EXPECT_EQ(refusal(machine), "");
  machine.legs[3].screw->speed_limit.reset();
  EXPECT_THAT(refusal(machine), HasSubstr("legs.screw.speed_limit: error: is missing"));
  machine.legs[3].screw->torque_limit.reset();
  EXPECT_THAT(refusal(machine), HasSubstr("legs.screw.torque_limit: error: is missing"));
  // mechanics with locked motors need none
  EXPECT_NO_THROW(Plant(machine, ModelKind::rigid, {.hydraulics = false}));
  auto weak = symmetric_screws(9.81);
  for (auto& leg : weak.legs) leg.screw->torque_limit = 3.1;
  EXPECT_THAT(refusal(weak), HasSubstr("leg 1: the motor needs"));
}

}  // namespace
}  // namespace hydrapod::simulation
