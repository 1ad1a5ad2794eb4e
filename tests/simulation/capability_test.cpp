/// What a machine can do from rest: the plant reaches it within 3 %, and not 5 % more.

#include "hydrapod/simulation/capability.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation {
namespace {

using dynamics::ModelKind;
using Eigen::VectorXd;
using spatial::Vector3;

constexpr double reached = 0.97, not_beyond = 1.05;

Capability capability_of(const model::Machine& machine) {
  const auto found = capability(machine, machine.neutral(), ModelKind::rigid);
  EXPECT_TRUE(found);
  return found.value_or(Capability{});
}

/// The leg's part in a motion, by differences of the lengths.
Vector6 leg_rates(const model::Machine& machine, int direction) {
  const auto& X = machine.neutral();
  const Vector3 C = X.R_BP * machine.platform.mass_center;
  constexpr double h = 1e-6;
  const auto lengths = [&](double by) {
    Pose moved = X;
    if (direction < 3) {
      moved.p_BP[direction] += by;
    } else {  // about C
      const auto R = spatial::rotation_from_rpy(by * Vector3::Unit(direction - 3));
      moved.R_BP = R * X.R_BP;
      moved.p_BP += C - R * C;
    }
    return kinematics::leg_lengths(machine, moved);
  };
  return (lengths(h) - lengths(-h)) / (2.0 * h);
}

TEST(Capability, ForcesLoadOneLegToItsLimitAndNoneBeyond) {
  const auto machine = machine_of("heavy-platform");
  const auto able = capability_of(machine);
  for (int d = 0; d < 6; ++d)
    for (int sign = 0; sign < 2; ++sign) {
      const auto& reach = able.of(Ability::force, d, sign);
      // forces of the legs that balance it: Jᵀ f = e λ, J by differences
      Eigen::Matrix<double, 6, 6> J;
      for (int k = 0; k < 6; ++k) J.col(k) = leg_rates(machine, k);
      const Vector6 more = J.transpose().fullPivLu().solve(
          Vector6((sign == 0 ? reach.value : -reach.value) * Vector6::Unit(d)));
      int at_limit = 0;
      for (int i = 0; i < 6; ++i) {
        const auto& leg = able.legs[static_cast<std::size_t>(i)];
        const double f = leg.force + more[i];
        const double most = leg.column ? std::min(leg.push, leg.column->strength) : leg.push;
        EXPECT_LE(f, most * (1.0 + 1e-6));
        EXPECT_GE(f, -leg.pull * (1.0 + 1e-6));
        if (f > most * (1.0 - 1e-6) || f < -leg.pull * (1.0 - 1e-6)) ++at_limit;
      }
      EXPECT_GE(at_limit, 1) << d;
    }
}

/// Speed of a leg once the transients are gone, all valves at `opening`. The platform's would
/// change with the Jacobian on the way.
double steady_leg_speed(const model::Machine& machine, double opening) {
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant);
  run.start(0.0, rest.x);
  PlantInput input;
  input.command.setConstant(opening);
  // The platform nears the speed with a time constant of some 40 ms (its mass over the slope of the
  // force over the speed); mean over a period of its oscillation on the oil.
  constexpr int from = 190, to = 250;  // [ms]
  double sum = 0.0;
  for (int k = 1; k <= to; ++k) {
    run.advance(1e-3 * k, input);
    if (k > from) sum += plant.outputs(run.state().data(), input).legs[0].length_rate;
  }
  return sum / (to - from);
}

/// Without limits of stroke and pump in the short way of the test.
model::Machine with_long_strokes() {
  auto machine = machine_of("heavy-platform");
  machine.hydraulics.supply.pump_flow.reset();
  return machine;
}

TEST(Capability, TheValvesWideOpenGiveTheStatedSpeed) {
  const auto machine = with_long_strokes();
  const auto able = capability_of(machine);
  const double rate = leg_rates(machine, 2)[0];  // of leg 1 per speed of the platform
  const double up = rate * able.of(Ability::velocity, 2, 0).value;
  const double down = rate * able.of(Ability::velocity, 2, 1).value;
  EXPECT_EQ(able.of(Ability::velocity, 2, 0).limit, Limit::extending);
  EXPECT_EQ(able.of(Ability::velocity, 2, 1).limit, Limit::retracting);
  for (const auto& [stated, measured] :
       {std::pair{up, steady_leg_speed(machine, 1.0)}, {down, -steady_leg_speed(machine, -1.0)}}) {
    EXPECT_GE(measured, reached * stated);
    EXPECT_LE(measured, not_beyond * stated);
  }
}

/// The neutral pose moved by `by` along or about an axis of the base through C.
Pose moved_by(const model::Machine& machine, int direction, double by) {
  Pose X = machine.neutral();
  if (direction < 3) {
    X.p_BP[direction] += by;
    return X;
  }
  const Vector3 C = X.R_BP * machine.platform.mass_center;
  const auto R = spatial::rotation_from_rpy(by * Vector3::Unit(direction - 3));
  X.R_BP = R * X.R_BP;
  X.p_BP += C - R * C;
  return X;
}

/// Lengths of the legs per motion of the platform where it is.
Vector6 leg_rates_at(const model::Machine& machine, const PlantOutput& out, int direction) {
  const auto geometry = kinematics::inverse_kinematics(machine, out.X_BP);
  return kinematics::leg_jacobian(geometry, out.p_BC).col(direction);
}

/// Mean speed in one direction while the platform goes through the neutral pose. The leg that the
/// limit is of has its valve wholly open, the others as far as their part in the motion needs.
double speed_at_neutral(const model::Machine& machine, const Capability& able, int direction,
                        int sign) {
  const double wanted =
      (sign == 0 ? 1.0 : -1.0) * able.of(Ability::velocity, direction, sign).value;
  constexpr int run_up = 440, averaged = 60;  // [ms]: its slowest part has a time of 60 ms
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(moved_by(machine, direction, -1e-3 * (run_up - 10) * wanted));
  Integrator run(plant);
  run.start(0.0, rest.x);
  PlantInput input;
  const int limiting = able.of(Ability::velocity, direction, sign).leg;
  constexpr int settled = 250;   // [ms]: what is left is of friction and loads on the way
  constexpr double slow = 5e-3;  // slower than the oscillation on the oil
  Vector6 held = Vector6::Zero();
  double sum = 0.0;
  for (int k = 1; k <= run_up + averaged / 2; ++k) {
    const auto before = plant.outputs(run.state().data(), input);
    const Vector6 rates = leg_rates_at(machine, before, direction) * wanted;
    for (int i = 0; i < 6; ++i) {
      const auto& leg = able.legs[static_cast<std::size_t>(i)];
      const double top = rates[i] > 0.0 ? leg.extending : leg.retracting;
      if (k > settled)
        held[i] += slow * (rates[i] - before.legs[static_cast<std::size_t>(i)].length_rate) / top;
      const double opening =
          i == limiting ? std::copysign(1.0, rates[i]) : rates[i] / top + held[i];
      input.command[i] = std::clamp(opening, -1.0, 1.0);
    }
    run.advance(1e-3 * k, input);
    if (k > run_up - averaged / 2) sum += plant.outputs(run.state().data(), input).twist[direction];
  }
  return (sign == 0 ? 1.0 : -1.0) * sum / averaged;
}

TEST(Capability, ThePlatformReachesTheStatedSpeedAlongYAndAboutZ) {
  auto machine = with_long_strokes();
  for (auto& leg : machine.legs) leg.stroke->length += 0.23;  // for the way that it takes
  const auto able = capability_of(machine);
  for (const auto& [direction, sign] : {std::pair{1, 0}, {5, 1}}) {
    const double stated = able.of(Ability::velocity, direction, sign).value;
    const double measured = speed_at_neutral(machine, able, direction, sign);
    EXPECT_GE(measured, reached * stated) << direction;
    EXPECT_LE(measured, not_beyond * stated) << direction;
  }
}

TEST(Capability, AnAskedSpeedBeyondThePumpIsThePumps) {
  auto machine = with_long_strokes();
  machine.hydraulics.supply.pump_flow = 7.3e-4;
  const auto able = capability_of(machine);
  const auto& up = able.of(Ability::velocity, 2, 0);
  EXPECT_EQ(up.limit, Limit::pump);
  EXPECT_EQ(up.leg, -1);
  // six equal pistons share what the valves' leakage leaves; that is a per cent of a rated flow
  const Plant plant(machine, ModelKind::rigid);
  double drawn = 0.0;
  const Vector6 rates = leg_rates(machine, 2);
  for (int i = 0; i < 6; ++i) drawn += plant.axis(i).area.piston * rates[i] * up.value;
  EXPECT_LT(drawn, 7.3e-4);
  EXPECT_GT(drawn, 0.5 * 7.3e-4);
}

/// The largest acceleration along z after the valves opened at once.
double largest_rise(const model::Machine& machine, double opening) {
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant, {.relative_tolerance = 1e-7, .absolute_tolerance = 1e-7});
  run.start(0.0, rest.x);
  PlantInput input;
  input.command.setConstant(opening);
  double largest = 0.0;
  for (int k = 1; k <= 400; ++k) {
    run.advance(5e-5 * k, input);
    const auto out = plant.outputs(run.state().data(), input);
    // of the oil force alone: what friction of the seals takes at speed is not in the limit
    if (std::abs(out.legs[0].piston_rate) > 0.25) break;
    largest = std::max(largest, std::copysign(1.0, opening) * out.acceleration[2]);
  }
  return largest;
}

/// Without friction, and with pressures that are there long before the platform moves.
model::Machine with_large_valves() {
  auto machine = with_long_strokes();
  for (auto& leg : machine.legs) {
    auto& valve = leg.hydraulics.valve;
    valve.rated_flow = 1.0;
    valve.natural_frequency = 6e3;
    valve.rate_limit = 1e6;
    leg.hydraulics.friction.coulomb = 0.0;
    leg.hydraulics.friction.breakaway = 0.0;
    leg.hydraulics.friction.viscous = 0.0;
  }
  return machine;
}

TEST(Capability, LargeValvesGiveTheStatedAcceleration) {
  const auto machine = with_large_valves();
  const auto able = capability_of(machine);
  for (int sign = 0; sign < 2; ++sign) {
    const double stated = able.of(Ability::acceleration, 2, sign).value;
    const double measured = largest_rise(machine, sign == 0 ? 1.0 : -1.0);
    EXPECT_GE(measured, reached * stated) << sign;
    EXPECT_LE(measured, not_beyond * stated) << sign;
  }
}

/// Acceleration in one direction, each leg's valve held so that its oil gives what the
/// motion in this direction alone needs of it: the leg that the limit is of has it wholly open.
double held_acceleration(const model::Machine& machine, const Capability& able, int direction,
                         int sign) {
  const double side = sign == 0 ? 1.0 : -1.0;
  const auto& reach = able.of(Ability::acceleration, direction, sign);
  const Vector3 C = kinematics::mass_center(machine, machine.neutral());
  const auto geometry = kinematics::inverse_kinematics(machine, machine.neutral());
  const Vector6 more =
      kinematics::leg_jacobian(geometry, C)
          .transpose()
          .fullPivLu()
          .solve(Vector6(side * reach.value *
                         dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid)
                             .M.col(direction)));
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant, {.relative_tolerance = 1e-6, .absolute_tolerance = 1e-6});
  run.start(0.0, rest.x);
  PlantInput input;
  // forces are there within a few ms: slower than the spool, and before the platform is fast
  constexpr double gain = 0.02, per_step = 0.0015;
  constexpr int steps = 700, averaged = 100;  // of 50 us
  Vector6 held = Vector6::Zero();
  double sum = 0.0;
  for (int k = 1; k <= steps; ++k) {
    const auto out = plant.outputs(run.state().data(), input);
    for (int i = 0; i < 6; ++i) {
      const auto& leg = out.legs[static_cast<std::size_t>(i)];
      const auto& can = able.legs[static_cast<std::size_t>(i)];
      const double missing = can.force + more[i] - leg.oil_force;
      const double share = missing / (can.push + can.pull);
      held[i] += per_step * share;
      input.command[i] = std::clamp(held[i] + gain * share, -1.0, 1.0);
    }
    const double opening = std::copysign(1.0, more[reach.leg]);
    input.command[reach.leg] = opening;
    run.advance(5e-5 * k, input);
    if (k > steps - averaged)
      sum += plant.outputs(run.state().data(), input).acceleration[direction];
  }
  return side * sum / averaged;
}

TEST(Capability, LargeValvesGiveTheStatedAccelerationAlongYAndAboutZ) {
  const auto machine = with_large_valves();
  const auto able = capability_of(machine);
  for (const auto& [direction, sign] : {std::pair{1, 0}, {5, 1}}) {
    const double stated = able.of(Ability::acceleration, direction, sign).value;
    const double measured = held_acceleration(machine, able, direction, sign);
    EXPECT_GE(measured, reached * stated) << direction;
    EXPECT_LE(measured, not_beyond * stated) << direction;
  }
}

TEST(Capability, TheFirstJerkIsThatOfOpenSpools) {
  const auto machine = with_long_strokes();
  const auto able = capability_of(machine);
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  for (int sign = 0; sign < 2; ++sign) {
    VectorXd x = rest.x;
    PlantInput input;
    input.command.setConstant(sign == 0 ? 1.0 : -1.0);
    for (int i = 0; i < 6; ++i) x[plant.layout().spool(i)] = input.command[i];
    // over a hundredth of the oil's time the pressures change in proportion
    constexpr double h = 1e-6;
    const double before = plant.outputs(x.data(), input).acceleration[2];
    Integrator run(plant, {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12});
    run.start(0.0, x);
    run.advance(h, input);
    const double after = plant.outputs(run.state().data(), input).acceleration[2];
    const double measured = std::abs(after - before) / h;
    const double stated = able.of(Ability::jerk, 2, sign).value;
    EXPECT_NEAR(measured, stated, 0.01 * stated) << sign;  // one leg's friction less
  }
}

TEST(Capability, ExcursionsEndWhereAStrokeEnds) {
  const auto machine = machine_of("heavy-platform");
  const auto able = capability_of(machine);
  for (int d = 0; d < 3; ++d)
    for (int sign = 0; sign < 2; ++sign) {
      const auto& reach = able.of(Ability::excursion, d, sign);
      if (d == 2 && sign == 1) continue;  // downwards the joints of the base end it
      ASSERT_TRUE(reach.limit == Limit::stroke_out || reach.limit == Limit::stroke_in);
      auto X = machine.neutral();
      X.p_BP[d] += (sign == 0 ? 1.0 : -1.0) * reach.value;
      const Vector6 lengths = kinematics::leg_lengths(machine, X);
      const auto& leg = machine.legs[static_cast<std::size_t>(reach.leg)];
      const double end =
          leg.stroke->retracted + (reach.limit == Limit::stroke_out ? leg.stroke->length : 0.0);
      EXPECT_NEAR(lengths[reach.leg] - leg.rod.length, end, 1e-9);
      for (int i = 0; i < 6; ++i) {
        const double s = lengths[i] - leg.rod.length;
        EXPECT_GE(s, leg.stroke->retracted - 1e-9);
        EXPECT_LE(s, leg.stroke->retracted + leg.stroke->length + 1e-9);
      }
    }
}

TEST(Capability, AThinRodEndsForcesAndAFoldedMachineHasNone) {
  auto machine = machine_of("heavy-platform");
  const auto before = capability_of(machine);
  for (auto& leg : machine.legs) {
    leg.rod.wall.reset();
    leg.rod.diameter = 0.021;
  }
  const auto thin = capability(machine, machine.neutral(), ModelKind::rigid);
  const double strength = before.legs[0].push;
  if (thin) {
    ASSERT_LT(thin->legs[0].column->strength, strength);
    EXPECT_EQ(thin->of(Ability::force, 2, 0).limit, Limit::column);
    EXPECT_LT(thin->of(Ability::force, 2, 0).value, before.of(Ability::force, 2, 0).value);
  }
  for (auto& leg : machine.legs) leg.rod.diameter = 0.006;
  EXPECT_FALSE(capability(machine, machine.neutral(), ModelKind::rigid));
}

/// Growth [1/s] of the nonlinear machine under proportional position control alone.
double growth(double gain) {
  auto overrides = smooth;
  overrides.insert(overrides.end(), {"controller.integral_time=0", "controller.feedback=\"none\"",
                                     fmt::format("controller.gain={:.17g}", gain)});
  const auto machine = machine_of("heavy-platform", overrides);
  constexpr double first = 8.0, second = 18.0;
  ClosedLoop loop(machine, machine.neutral(),
                  {.kind = ModelKind::rigid,
                   .plant = {.friction = Friction::viscous},
                   .integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12},
                   .until = second + 1.0,
                   .ideal_sensors = true});
  const Vector6 size = (Vector6() << 1.1, 0.9, 1.3, 0.8, 1.2, 0.7).finished() * 1e-7;
  const signals::Trajectory pulse{.times = {0.0, 0.01, 0.02},
                                  .points = {Vector6::Zero(), size, Vector6::Zero()}};
  signals::Generator kick({{.form = pulse}}, 1.0 / loop.parameters().sample_time);
  std::array<double, 2> sums{};
  Vector6 last = Vector6::Zero();
  loop.run(command_source(kick), [&](const LoopSample& sample) {
    // differences from sample to sample leave slow drift out
    const Vector6 moved = displacement_between(loop.operating(), sample.plant.X_BP);
    const double size_of_change = (moved - last).squaredNorm();
    last = moved;
    if (sample.time > first && sample.time <= first + 1.0) sums[0] += size_of_change;
    if (sample.time > second && sample.time <= second + 1.0) sums[1] += size_of_change;
  });
  return 0.5 * std::log(sums[1] / sums[0]) / (second - first);
}

TEST(Capability, TheGainLimitIsWhereTheSimulatedMachineBeginsToGrow) {
  const auto machine = machine_of("heavy-platform", smooth);
  const auto able = capability_of(machine);
  ASSERT_TRUE(able.gain_limit);
  EXPECT_LT(growth(0.95 * *able.gain_limit), 0.0);
  EXPECT_GT(growth(1.05 * *able.gain_limit), 0.0);
}

/// The file states no stroke. The one that is assumed ends above this pose.
TEST(Capability, BeyondAssumedStopsOnlyTheGainLimitIsLost) {
  const auto machine = machine_of("zhang-jiang-2021-transverse");
  auto X = machine.neutral();
  X.p_BP.z() -= 0.24;
  const auto able = capability(machine, X, ModelKind::guide);
  ASSERT_TRUE(able);
  EXPECT_FALSE(able->gain_limit);
  for (int d = 0; d < 6; ++d) EXPECT_GT(able->of(Ability::force, d, 0).value, 0.0);
  EXPECT_LT(able->of(Ability::excursion, 2, 1).value, 1e-9);
  EXPECT_TRUE(capability(machine, machine.neutral(), ModelKind::guide)->gain_limit);
}

}  // namespace
}  // namespace hydrapod::simulation
