#include "hydrapod/rig/rig.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::rig {

namespace {

using numerics::Gaussian;
using simulation::LoopSample;

constexpr int excitations = 6, currents = 6, lengths = 6;
constexpr std::uint64_t noise_streams = 1'000'000;  ///< apart from those of the excitation

/// One channel between the plant and the record.
struct Chain {
  model::Sensor sensor{};
  double noise{};  ///< RMS at the simulation's output rate
  LowPass own{};   ///< the sensor's bandwidth
  LowPass anti_alias{};
  Gaussian random{0};
  Gaussian drop_out{0};
  std::int64_t dropped_until{};

  double filtered(double value) {
    const double seen = own(value);
    return anti_alias(noise > 0.0 ? seen + noise * random() : seen);
  }
};

class Recorder {
 public:
  Recorder(const simulation::ClosedLoop& loop, const RigOptions& options,
           data::RecordWriter& writer)
      : loop_(loop), options_(options), writer_(writer), drives_(loop.plant().layout().nuts >= 0) {
    const double fast = options.rate * options.oversampling;
    const Instruments& all = options.instruments;
    for (int i = 0; i < excitations; ++i) add({}, 0.0, {}, fast);
    for (int i = 0; i < currents; ++i) add(all.current, 0.0, {}, fast);
    for (int i = 0; i < lengths; ++i) add(all.length, 0.0, {}, fast);
    for (int i = 0; i < model::leg_count; ++i)
      for (const auto& sensor :
           drives_ ? std::array{all.torque, all.speed} : std::array{all.pressure, all.pressure})
        add(sensor, 0.0, {}, fast);
    for (const Accelerometer& one : all.accelerometers) {
      // without the filter, every sample of the record keeps the whole of it: noise of the density
      // over half of the record's rate
      const double rate = all.anti_alias ? fast : options.rate;
      const double white = one.noise_density * std::sqrt(rate / 2.0);
      add(one.sensor, white, LowPass::second_order(one.bandwidth, 0.7, fast), fast);
    }
    values_.resize(chains_.size());
    block_.resize(rows, static_cast<Eigen::Index>(chains_.size()));
    first_ = std::lround(options.settling * fast);
    wanted_ = std::lround(options.duration * options.rate);
  }

  void take(const LoopSample& sample) {
    gather(sample);
    if (seen_ == 0)
      for (std::size_t c = 0; c < chains_.size(); ++c) {
        chains_[c].own.settle(values_[c]);
        chains_[c].anti_alias.settle(values_[c]);
      }
    for (std::size_t c = 0; c < chains_.size(); ++c) values_[c] = chains_[c].filtered(values_[c]);
    const std::int64_t at = seen_++ - first_;
    if (at < 0 || at % options_.oversampling != 0 || written_ == wanted_) return;
    for (std::size_t c = 0; c < chains_.size(); ++c)
      block_(filled_, static_cast<Eigen::Index>(c)) = measured(c);
    ++written_;
    if (++filled_ == block_.rows()) flush();
  }

  void flush() {
    const Eigen::Index count = filled_;
    filled_ = 0;
    if (count > 0) writer_.append(block_.topRows(count));
  }
  [[nodiscard]] std::int64_t written() const { return written_; }

  /// The excitation of Entry::drive per direction, which LoopSample has per leg only.
  void set_drive_signal(const Vector6& signal) { drive_signal_ = signal; }

 private:
  static constexpr Eigen::Index rows = 512;

  void add(const model::Sensor& sensor, double noise, const LowPass& own, double fast) {
    Chain chain{.sensor = sensor, .noise = noise, .own = own};
    const std::uint64_t stream = noise_streams + 2 * chains_.size();
    chain.random = Gaussian(options_.seed, stream);
    chain.drop_out = Gaussian(options_.seed, stream + 1);
    const bool measured = chains_.size() >= excitations;  // excitations are known, not measured
    if (measured && options_.instruments.anti_alias && options_.oversampling > 1)
      chain.anti_alias = LowPass::butterworth(8, 0.4 * options_.rate, fast);
    chains_.push_back(std::move(chain));
  }

  void gather(const LoopSample& sample) {
    std::size_t c = 0;
    const auto& excitation = sample.excitation;
    const Vector6& excited = options_.entry == Entry::command ? excitation.command.value
                             : options_.entry == Entry::drive ? drive_signal_
                                                              : excitation.wrench;
    for (int i = 0; i < 6; ++i) values_[c++] = excited[i];
    for (int i = 0; i < 6; ++i) values_[c++] = sample.applied[i];
    for (const auto& leg : sample.plant.legs) values_[c++] = leg.length;
    for (const auto& leg : sample.plant.legs) {
      values_[c++] = drives_ ? leg.torque : leg.cap_pressure;
      values_[c++] = drives_ ? leg.motor_speed : leg.rod_pressure;
    }
    for (const Accelerometer& one : options_.instruments.accelerometers)
      values_[c++] = specific_force(one, loop_.plant().machine(), loop_.operating(), sample.plant);
  }

  /// Noise per sample, range, resolution, drop-outs.
  double measured(std::size_t c) {
    Chain& chain = chains_[c];
    const Instruments& all = options_.instruments;
    if (c < excitations) return values_[c];
    const double noise = chain.sensor.noise > 0.0 ? chain.random() : 0.0;
    const double value = simulation::shown(chain.sensor, values_[c], noise);
    if (all.drop_outs <= 0.0) return value;
    const bool begins = chain.drop_out.uniform() < all.drop_outs / options_.rate;
    if (begins)
      chain.dropped_until = written_ + std::max(1L, std::lround(all.drop_out_time * options_.rate));
    return written_ < chain.dropped_until ? std::nan("") : value;
  }

  const simulation::ClosedLoop& loop_;
  const RigOptions& options_;
  data::RecordWriter& writer_;
  bool drives_;  ///< electric ones
  std::vector<Chain> chains_{};
  std::vector<double> values_{};
  data::Samples block_{};
  Eigen::Index filled_{};
  std::int64_t seen_{}, first_{}, written_{}, wanted_{};
  Vector6 drive_signal_{Vector6::Zero()};
};

/// The excitation at controller samples.
class Source {
 public:
  Source(const simulation::ClosedLoop& loop, const RigOptions& options)
      : entry_(options.entry),
        signals_(options.signals, 1.0 / loop.parameters().sample_time, options.seed),
        shares_(drive_shares(excitation_jacobian(loop.plant().machine(), loop.operating()))) {
    if (entry_ == Entry::wrench) forces_.emplace(signals_);
  }

  void fill(simulation::Excitation& out, Recorder& recorder) {
    if (forces_) return forces_->fill(out);
    const signals::Sample now = signals_.next();
    if (entry_ == Entry::command) {
      out.command = now;
    } else {
      out.drive = shares_ * now.value;
      recorder.set_drive_signal(now.value);
    }
  }

 private:
  Entry entry_;
  signals::Generator signals_;
  std::optional<simulation::LookAhead> forces_{};  ///< of Entry::wrench
  spatial::Matrix6 shares_;
};

}  // namespace

spatial::Matrix6 excitation_jacobian(const model::Machine& machine, const spatial::Pose& pose) {
  return kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, pose), pose.p_BP);
}

spatial::Matrix6 drive_shares(const spatial::Matrix6& J) {
  spatial::Matrix6 shares = J;
  for (int i = 0; i < 6; ++i) shares.col(i) /= J.col(i).cwiseAbs().maxCoeff();
  return shares;
}

std::vector<signals::Signal> default_signals(Entry entry) {
  signals::Signal noise{.form = signals::White{}};
  if (entry == Entry::command) noise.size.setConstant(1e-4);
  if (entry == Entry::drive) noise.size.setConstant(0.02);
  if (entry == Entry::wrench) noise.size << 100.0, 100.0, 100.0, 50.0, 50.0, 50.0;
  return {noise};
}

const signals::Units& units_of(Entry entry) {
  if (entry == Entry::drive) return signals::drive_units;
  return entry == Entry::wrench ? signals::wrench_units : signals::displacement_units;
}

std::vector<data::Channel> rig_channels(const RigOptions& options, model::LegType legs) {
  using data::Direction;
  using data::Role;
  std::vector<data::Channel> list;
  for (int i = 0; i < 6; ++i) {
    list.push_back({fmt::format("excitation {}", spatial::direction_name(i)),
                    units_of(options.entry)[static_cast<std::size_t>(i)],
                    static_cast<Direction>(i + 1), Role::excitation, 0});
  }
  const bool drives = legs == model::LegType::screw;
  const auto per_leg = [&](int leg, const std::string& name, const char* unit, Role role) {
    list.push_back({name, unit, data::leg_direction(leg), role, leg});
  };
  for (int leg = 1; leg <= 6; ++leg)
    per_leg(leg, drives ? fmt::format("motor {} drive", leg) : fmt::format("valve {} current", leg),
            "1", Role::drive);
  for (int leg = 1; leg <= 6; ++leg)
    per_leg(leg, fmt::format("leg {} length", leg), "m", Role::response);
  for (int leg = 1; leg <= 6; ++leg) {
    if (drives) {
      per_leg(leg, fmt::format("motor {} torque", leg), "N m", Role::response);
      per_leg(leg, fmt::format("motor {} speed", leg), "rad/s", Role::response);
      continue;
    }
    for (const char* side : {"cap", "rod"})
      per_leg(leg, fmt::format("leg {} {} pressure", leg, side), "Pa", Role::response);
  }
  for (const Accelerometer& one : options.instruments.accelerometers)
    list.push_back({one.name, "m/s^2", one.direction, Role::response, one.point});
  return list;
}

simulation::LoopOptions loop_options(const RigOptions& options) {
  const auto sound = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!sound(options.rate)) throw std::invalid_argument("rig: the rate must be positive");
  if (!sound(options.duration)) throw std::invalid_argument("rig: the duration must be positive");
  if (!(options.settling >= 0.0)) throw std::invalid_argument("rig: settling must be 0 or more");
  if (options.oversampling < 1 || options.oversampling > 64)
    throw std::invalid_argument("rig: oversampling must be 1 to 64");
  simulation::LoopOptions loop = options.loop;
  loop.output_interval = 1.0 / (options.rate * options.oversampling);
  loop.until = options.settling + options.duration;
  loop.seed = options.seed;
  return loop;
}

RigResult run_rig(simulation::ClosedLoop& loop, const RigOptions& options,
                  data::RecordWriter& writer, const simulation::KeepGoing& keep_going) {
  Recorder recorder(loop, options, writer);
  Source source(loop, options);
  RigResult result;
  result.summary =
      loop.run([&](double /*time*/,
                   simulation::Excitation& excitation) { source.fill(excitation, recorder); },
               [&](const LoopSample& sample) { recorder.take(sample); }, keep_going);
  recorder.flush();
  result.samples = recorder.written();
  return result;
}

}  // namespace hydrapod::rig
