/// The rig on a machine behind a controller.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "client.hpp"
#include "follower.hpp"
#include "guard.hpp"
#include "hydrapod/base/error.hpp"
#include "pace.hpp"
#include "record_queue.hpp"

namespace hydrapod::realtime {

namespace {

/// What a command did, as the record has it.
struct Sent {
  std::uint64_t number{};
  Vector6 displacement{Vector6::Zero()}, drive{Vector6::Zero()};
  Vector6 excitation{Vector6::Zero()};
};

/// The excitation, growing and ending smoothly.
class Source {
 public:
  Source(const model::Machine& machine, const Pose& operating, const rig::RigOptions& options,
         double T, double ramp)
      : entry_(options.entry),
        T_(T),
        ramp_(ramp),
        end_(options.settling + options.duration),
        signals_(options.signals, 1.0 / T, options.seed),
        shares_(rig::drive_shares(rig::excitation_jacobian(machine, operating))) {}

  [[nodiscard]] bool over() const { return time() >= end_ + ramp_; }

  Command next(Sent& sent) {
    const Share grown = smooth_share(time() / ramp_), gone = smooth_share((time() - end_) / ramp_);
    const double w = grown.value - gone.value, w_rate = (grown.rate - gone.rate) / ramp_;
    const signals::Sample now = signals_.next();
    ++commands_;
    Command command;
    sent.excitation = w * now.value;
    if (entry_ == rig::Entry::command) {
      command.displacement = sent.displacement = sent.excitation;
      command.rate = w * now.rate + w_rate * now.value;
    } else {
      command.drive = sent.drive = shares_ * sent.excitation;
    }
    return command;
  }

 private:
  [[nodiscard]] double time() const { return T_ * static_cast<double>(commands_); }

  rig::Entry entry_;
  double T_, ramp_, end_;
  signals::Generator signals_;
  spatial::Matrix6 shares_;
  long commands_{};
};

class Session {
 public:
  Session(const model::Machine& machine, const Pose& operating, const rig::RigOptions& options,
          const HardwareOptions& hardware, const Layout& layout, const OpenRecord& record,
          const simulation::KeepGoing& keep_going)
      : options_(options),
        hardware_(hardware),
        record_(record),
        keep_going_(keep_going),
        drives_(model::leg_type(machine) == model::LegType::screw),
        T_(machine.controller.sample_time),
        client_(hardware, layout),
        guard_(machine, operating, hardware.limits, T_, options.instruments.accelerometers.size()),
        source_(machine, operating, options, T_, hardware.ramp),
        row_(rig::rig_channels(options).size()),
        answered_mask_(~std::uint64_t{0} >>
                       (64 - field_bits(layout.sensors, Kind::sensors, "answered"))),
        first_(std::lround(options.settling / T_)),
        wanted_(std::lround(options.duration / T_)) {}

  HardwareResult run() {
    client_.connect([this] { return goes_on(0.0); });
    if (const auto apart = guard_.at_pose(client_.sensors()); !apart.empty())
      base::refuse("--hardware", apart + "; bring the platform to the pose first");
    queue_.emplace(record_(), row_.size(), true);
    HardwareResult result;
    result.scheduling = schedule(hardware_.fifo);
    const std::string why = excite();
    result.ramped_down = !why.empty();
    if (result.ramped_down) ramp_down();
    client_.send({.mode = static_cast<std::uint64_t>(Mode::leave)});
    queue_->finish();
    auto& summary = result.rig.summary;
    summary.end = why.empty()    ? simulation::RunEnd::finished
                  : interrupted_ ? simulation::RunEnd::stopped
                                 : simulation::RunEnd::failed;
    summary.message = why;
    summary.time = T_ * static_cast<double>(samples_);
    summary.samples = samples_;
    result.rig.samples = written_;
    client_.tell(result);
    return result;
  }

 private:
  /// To the end of the excitation; empty, or why it must be ramped down.
  std::string excite() {
    send_next();
    double heard = seconds_of(CLOCK_MONOTONIC), sent = heard;
    constexpr double repetition = 0.01;  // [s] after which a command may have been lost
    while (!source_.over()) {
      const bool came = client_.receive(2.0 * T_);
      const double now = seconds_of(CLOCK_MONOTONIC);
      if (!goes_on(T_ * static_cast<double>(samples_))) {
        interrupted_ = true;
        return "interrupted";
      }
      if (!came) {
        if (now - heard > hardware_.watchdog)
          return fmt::format("no sensors for {:.0f} ms{}", 1e3 * (now - heard),
                             samples_ == 0 ? "; a machine that follows another client answers the "
                                             "hello alone"
                                           : "");
        if (now - sent > repetition) {
          client_.send_again();
          sent = now;
        }
        continue;
      }
      heard = sent = now;
      if (auto why = take_sample(); !why.empty()) return why;
      if (auto why = send_next(); !why.empty()) return why;
    }
    return {};
  }

  /// The sensors that have come; empty, or what is wrong with them.
  std::string take_sample() {
    const Sensors& now = client_.sensors();
    const Sent acting = acting_until_now();
    if (samples_ > 0) {
      finish_row(acting);
      for (std::uint64_t k = 0; k < std::min<std::uint64_t>(client_.gap(), 100'000); ++k)
        put_missing(acting);
    }
    if (auto why = other_rate(now); !why.empty()) return why;
    start_row(now);
    silent_ = now.length.allFinite() ? 0 : silent_ + 1;
    if (T_ * static_cast<double>(silent_) > hardware_.watchdog)
      return fmt::format("no leg lengths among the sensors for {:.0f} ms",
                         1e3 * T_ * static_cast<double>(silent_));
    if (client_.has("state") && acting.number > 0 &&
        (now.state == static_cast<std::uint64_t>(State::ramping) ||
         now.state == static_cast<std::uint64_t>(State::parked)))
      return "the machine has ramped down by itself: it got no commands in time";
    return guard_.see(now, acting.displacement);
  }

  /// The time stamps say how long a sample is.
  std::string other_rate(const Sensors& now) {
    constexpr double deviation = 0.05;
    const double passed = 1e-9 * static_cast<double>(now.time - last_time_);
    const bool told = samples_ > 0 && client_.has("time") && last_time_ > 0;
    last_time_ = now.time;
    const double samples = static_cast<double>(client_.gap() + 1);
    odd_ = told && std::abs(passed / samples - T_) > deviation * T_ ? odd_ + 1 : 0;
    constexpr int many = 20;
    if (odd_ < many) return {};
    return fmt::format(
        "the machine samples every {:.4g} ms, and controller.sample_time is {:.4g} ms: expected "
        "the same (--set controller.sample_time=…)",
        1e3 * passed / samples, 1e3 * T_);
  }

  /// The command of the step that ended with these sensors. Where they do not say which, the last
  /// but one: what answers the sensors of one sample acts from the next one on.
  [[nodiscard]] Sent acting_until_now() const {
    std::uint64_t number = number_ > 1 ? number_ - 1 : 0;
    if (client_.has("answered"))  // of which there may be the last bits only
      number = number_ - ((number_ - client_.sensors().answered) & answered_mask_);
    const Sent& found = sent_[number % sent_.size()];
    return found.number == number ? found : Sent{};
  }

  std::string send_next() {
    Sent sent;
    const Command command = source_.next(sent);
    if (auto why = guard_.commanded(sent.displacement); !why.empty()) return why;
    sent.number = number_ = client_.send(command);
    sent_[number_ % sent_.size()] = sent;
    last_ = sent;
    return {};
  }

  void start_row(const Sensors& now) {
    auto next = std::copy_n(now.valve.data(), 6, row_.begin() + 6);
    next = std::copy_n(now.length.data(), 6, next);
    const Vector6& first = drives_ ? now.torque : now.cap_pressure;
    const Vector6& second = drives_ ? now.motor_speed : now.rod_pressure;
    for (int leg = 0; leg < 6; ++leg) {
      *next++ = first[leg];
      *next++ = second[leg];
    }
    std::copy_n(now.accelerometer.data(), options_.instruments.accelerometers.size(), next);
    ++samples_;
  }

  void finish_row(const Sent& acting) {
    std::copy_n(acting.excitation.data(), 6, row_.begin());
    put_row();
  }

  void put_missing(const Sent& acting) {
    std::ranges::fill(row_, std::numeric_limits<double>::quiet_NaN());
    std::copy_n(acting.excitation.data(), 6, row_.begin());
    put_row();
    ++samples_;
  }

  void put_row() {
    const long at = finished_++;
    if (at < first_ || at >= first_ + wanted_) return;
    queue_->put(row_.data());
    ++written_;
  }

  /// From the last command to the pose and to no drive, whether or not sensors come.
  void ramp_down() {
    const Vector6 &from = last_.displacement, &drive = last_.drive;
    const long steps = std::max(1L, std::lround(hardware_.ramp_down / T_));
    for (long k = 1; k <= steps; ++k) {
      const Share share = smooth_share(static_cast<double>(k) / static_cast<double>(steps));
      client_.send({.displacement = (1.0 - share.value) * from,
                    .rate = -share.rate / hardware_.ramp_down * from,
                    .drive = (1.0 - share.value) * drive});
      client_.receive(T_);
    }
  }

  bool goes_on(double time) {
    if (queue_ && queue_->failed()) return false;
    return !keep_going_ || keep_going_(time);
  }

  const rig::RigOptions& options_;
  const HardwareOptions& hardware_;
  const OpenRecord& record_;
  const simulation::KeepGoing& keep_going_;
  bool drives_;  ///< electric ones
  double T_;
  Client client_;
  Guard guard_;
  Source source_;
  std::vector<double> row_;
  std::optional<RecordQueue> queue_{};
  std::uint64_t answered_mask_;
  long first_, wanted_;
  std::array<Sent, 4096> sent_{};
  Sent last_{};
  std::uint64_t number_{}, last_time_{};
  long samples_{}, finished_{};
  std::int64_t written_{};
  int silent_{}, odd_{};
  bool interrupted_{};
};

void require_sound(const rig::RigOptions& options, const HardwareOptions& hardware,
                   const Layout& layout, double T) {
  if (options.entry == rig::Entry::wrench)
    base::refuse("--entry wrench",
                 "a machine has no actuator for a wrench, expected command or drive");
  if (std::abs(options.rate * T - 1.0) > 1e-9)
    base::refuse("--rate", fmt::format("is {:g} Hz, and the machine samples at {:g} Hz: a record "
                                       "from hardware has every sample",
                                       options.rate, 1.0 / T));
  if (!(hardware.ramp <= options.settling))
    base::refuse("--ramp", fmt::format("is {:g} s and --settling {:g} s: the record begins with "
                                       "the full excitation, expected at most --settling",
                                       hardware.ramp, options.settling));
  if (!layout.sensors.has(Kind::sensors, "length"))
    base::refuse("--layout", "'sensors' has no length: without leg lengths nothing is watched");
  const char* needed = options.entry == rig::Entry::command ? "displacement" : "drive";
  if (!layout.command.has(Kind::command, needed))
    base::refuse("--layout", fmt::format("'command' has no {}, which this --entry needs", needed));
  if (hardware.key.given() &&
      !(layout.command.has(Kind::command, "mode") && layout.sensors.has(Kind::sensors, "echo") &&
        field_bits(layout.sensors, Kind::sensors, "sequence") == 64))
    base::refuse("--layout",
                 "with --key 'command' must have mode, and 'sensors' echo and a "
                 "sequence of u64: packets could be sent again otherwise");
}

}  // namespace

HardwareResult run_on_hardware(const model::Machine& machine, const Pose& operating,
                               const rig::RigOptions& options, const HardwareOptions& hardware,
                               const OpenRecord& record, const simulation::KeepGoing& keep_going) {
  const Layout layout =
      hardware.layout.command.fields.empty()
          ? native_layout(static_cast<int>(options.instruments.accelerometers.size()),
                          model::leg_type(machine))
          : hardware.layout;
  require_sound(options, hardware, layout, machine.controller.sample_time);
  return Session(machine, operating, options, hardware, layout, record, keep_going).run();
}

}  // namespace hydrapod::realtime
