#include "readings.hpp"

#include <cmath>
#include <numbers>

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::realtime {

namespace {
constexpr std::uint64_t accelerometer_streams = 2'000'000;  // apart from those of rig and loop

/// What all legs together can push [N].
double strongest_push(const simulation::ClosedLoop& loop) {
  double push = 0.0;
  const auto& axes = loop.parameters().axes;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& screw = loop.plant().machine().legs[i].screw;
    push += screw ? screw->ratio() * screw->torque_limit.value()
                  : axes[i].supply_pressure * axes[i].piston_area;
  }
  return push;
}

}  // namespace

Readings::Readings(const simulation::ClosedLoop& loop, const std::vector<rig::Accelerometer>& list)
    : loop_(loop) {
  const double rate = 1.0 / loop.parameters().sample_time;
  for (const auto& one : list)
    chains_.push_back(
        {one, rig::LowPass::second_order(one.bandwidth, 0.7, rate),
         numerics::Gaussian(loop.options().seed, accelerometer_streams + chains_.size()),
         one.noise_density * std::sqrt(rate / 2.0)});
}

void Readings::read(const simulation::SampledMachine& machine, Sensors& sensors) {
  const auto out = machine.plant.outputs(machine.x.data(), machine.input);
  sensors.time = static_cast<std::uint64_t>(std::llround(machine.time * 1e9));
  sensors.length = machine.measured.length;
  sensors.cap_pressure = machine.measured.cap_pressure;
  sensors.rod_pressure = machine.measured.rod_pressure;
  sensors.piston_acceleration = machine.measured.acceleration;
  sensors.valve = machine.applied;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = out.legs[static_cast<std::size_t>(i)];
    sensors.spool[i] = leg.spool;
    sensors.torque[i] = leg.torque;
    sensors.motor_speed[i] = leg.motor_speed;
    sensors.nut[i] = leg.nut;
  }
  sensors.platform = simulation::displacement_between(loop_.operating(), out.X_BP);
  sensors.velocity = out.twist;
  sensors.acceleration = out.acceleration;
  sensors.supply_pressure = out.supply_pressure;
  for (std::size_t a = 0; a < chains_.size(); ++a) {
    Chain& chain = chains_[a];
    const double value =
        rig::specific_force(chain.one, machine.plant.machine(), loop_.operating(), out);
    if (!settled_) chain.bandwidth.settle(value);
    const double noise = chain.noise > 0.0 ? chain.noise * chain.random() : 0.0;
    const double own = chain.one.sensor.noise > 0.0 ? chain.random() : 0.0;
    sensors.accelerometer[a] =
        simulation::shown(chain.one.sensor, chain.bandwidth(value) + noise, own);
  }
  settled_ = true;
}

bool is_reachable(const simulation::ClosedLoop& loop, const Command& command) {
  constexpr double fastest = 100.0, most_drive = 10.0;  // [m/s, rad/s], shares
  if (!(command.rate.cwiseAbs().maxCoeff() <= fastest)) return false;
  if (!(command.drive.cwiseAbs().maxCoeff() <= most_drive)) return false;
  const auto& plant = loop.plant();
  const double strongest = strongest_push(loop);
  for (const Vector6* wrench : {&command.wrench, &command.next_wrench})
    if (!(wrench->cwiseAbs().maxCoeff() <= strongest)) return false;
  if (command.mode != static_cast<std::uint64_t>(Mode::pose)) return true;
  if (!(command.displacement.tail<3>().cwiseAbs().maxCoeff() <= std::numbers::pi)) return false;
  const auto lengths = kinematics::leg_lengths(
      plant.machine(),
      simulation::command_at(loop.operating(), {.value = command.displacement}).X_BP);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& stops = plant.axis(i).stops;
    const double piston = lengths[i] - plant.machine().legs[static_cast<std::size_t>(i)].rod.length;
    if (!std::isfinite(piston)) return false;
    if (stops.high > stops.low && !(piston >= stops.low && piston <= stops.high)) return false;
  }
  return true;
}

}  // namespace hydrapod::realtime
