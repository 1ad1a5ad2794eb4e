#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "follower.hpp"
#include "hydrapod/base/error.hpp"
#include "inbox.hpp"
#include "pace.hpp"
#include "readings.hpp"
#include "record_queue.hpp"

namespace hydrapod::realtime {

namespace {

constexpr int most_packets = 64;      // looked at in one sample; a flood does not stop the clock
constexpr double look_around = 0.02;  // [s] between looks at the keyboard in lock-step

std::uint64_t new_session() {
  std::random_device random;
  const std::uint64_t drawn = (std::uint64_t{random()} << 32) | random();
  return drawn | 1;  // never 0
}

std::unique_ptr<Transport> open_transport(const ServeOptions& options) {
  if (!options.shared_memory.empty())
    return open_shared_memory(options.shared_memory, true, "--shm");
  Address address = options.address;
  if (!options.bind.empty()) address.host = options.bind;
  const std::string argument = options.bind.empty() ? "--udp" : "--bind";
  if (options.bind.empty() && !is_loopback(address, argument))
    base::refuse(argument, fmt::format("'{}' is beyond the loopback, expected --bind {} and --key "
                                       "FILE",
                                       address.host, address.host));
  if (!options.key.given() && !is_loopback(address, argument))
    base::refuse(argument, fmt::format("'{}' is beyond the loopback, where only packets with a key "
                                       "are accepted, expected --key FILE",
                                       address.host));
  return listen_udp(address, argument);
}

/// The machine behind its packets.
class Server {
 public:
  Server(simulation::ClosedLoop& loop, const ServeOptions& options, const OpenRecord& record)
      : loop_(loop),
        options_(options),
        layout_(options.layout.command.fields.empty()
                    ? native_layout(static_cast<int>(options.accelerometers.size()),
                                    model::leg_type(loop.plant().machine()))
                    : options.layout),
        transport_(open_transport(options)),
        inbox_(layout_, options.key, new_session(),
               [&loop](const Command& command) { return is_reachable(loop, command); }),
        follower_({options.hold, options.ramp}, options.rest),
        readings_(loop, options.accelerometers),
        pace_(loop.parameters().sample_time, options.busy) {
    require_sleep();
    require_session();
    if (!record) return;
    plain_columns_ = simulation::record_channels(loop).size();
    row_.resize(plain_columns_ + serve_channels(loop, options).size());
    queue_.emplace(record(), row_.size(), options.lock_step);
  }

  ServeResult run(const simulation::KeepGoing& keep_going) {
    keep_going_ = &keep_going;
    ServeResult result{.place = transport_->place(),
                       .lock_step = options_.lock_step,
                       .sample_time = loop_.parameters().sample_time};
    if (options_.ready) options_.ready(result.place);
    result.scheduling = schedule(options_.fifo);
    simulation::LoopSink sink;
    if (queue_) sink = [this](const simulation::LoopSample& sample) { record(sample); };
    result.run = loop_.run_with(
        [this](const auto& machine, auto& excitation) { return exchange(machine, excitation); },
        sink, keep_going);
    if (asked_) answer(inbox_.peer());
    if (result.run.end == simulation::RunEnd::stopped && over_)
      result.run.end = simulation::RunEnd::finished;
    if (queue_) queue_->finish();
    result.state = follower_.state();
    result.counters = inbox_.counters();
    result.sent = sent_;
    result.not_sent = not_sent_;
    result.rows_lost = queue_ ? queue_->lost() : 0;
    pace_.tell(result);
    return result;
  }

 private:
  void require_sleep() const {
    const double most = longest_busy * loop_.parameters().sample_time;
    if (!(options_.busy >= 0.0 && options_.busy <= most))
      base::refuse("--busy", fmt::format("{:g} ms: expected up to {:g} ms, {:g} of the sample time",
                                         1e3 * options_.busy, 1e3 * most, longest_busy));
  }

  /// A key is worth nothing where packets can be sent again.
  void require_session() const {
    if (!options_.key.given()) return;
    for (const auto& [packet, kind, key] : {std::tuple{&layout_.command, Kind::command, "command"},
                                            std::tuple{&layout_.sensors, Kind::sensors, "sensors"}})
      if (!packet->has(kind, "session") || !packet->has(kind, "sequence") ||
          field_bits(*packet, kind, "session") != 64 || field_bits(*packet, kind, "sequence") != 64)
        base::refuse("--layout", fmt::format("with --key '{}' must have session and sequence, both "
                                             "u64: packets could be sent again otherwise",
                                             key));
    if (!layout_.command.has(Kind::command, "mode"))
      base::refuse("--layout",
                   "with --key 'command' must have mode: the answer to a hello tells the session");
  }

  bool exchange(const simulation::SampledMachine& machine, simulation::Excitation& excitation) {
    pace_.work_ends();
    if (!options_.lock_step) {
      pace_.wait_for_next();
      pace_.work_begins();
    }
    take_stock(machine);
    const bool goes_on =
        (options_.lock_step ? wait_for_step(machine.time) : take_commands(machine.time)) &&
        !(queue_ && queue_->failed());
    if (options_.lock_step) pace_.work_begins();
    follower_.fill(machine.time, excitation);
    return goes_on;
  }

  void take_stock(const simulation::SampledMachine& machine) {
    readings_.read(machine, sensors_);
    sensors_.session = inbox_.session();
    ++sensors_.sequence;
    sensors_.deadline_misses = pace_.misses();
    update();
  }

  /// What depends on the commands so far.
  void update() {
    sensors_.answered = inbox_.last();
    sensors_.echo = inbox_.command().time;
    sensors_.state = static_cast<std::uint64_t>(follower_.state());
    sensors_.counters = inbox_.counters();
  }

  void send(const Sensors& sensors, const Peer& peer) {
    std::array<std::byte, largest_packet + mac_size> bytes;
    std::size_t size = encode(layout_, sensors, bytes.data());
    if (options_.key.given()) {
      const auto mac = authentication(options_.key, Kind::sensors, {bytes.data(), size});
      std::ranges::copy(mac, bytes.begin() + static_cast<std::ptrdiff_t>(size));
      size += mac_size;
    }
    ++(transport_->send({bytes.data(), size}, peer) ? sent_ : not_sent_);
  }

  void greet(const Peer& peer) {
    Sensors hello = sensors_;
    hello.echo = inbox_.hello_time();
    hello.answered = inbox_.last();
    hello.counters = inbox_.counters();
    send(hello, peer);
  }

  /// On the wall clock: sensors out, commands in. False ends the run.
  bool take_commands(double time) {
    if (inbox_.has_peer()) send(sensors_, inbox_.peer());
    bool fresh = false;
    for (int k = 0; k < most_packets && transport_->receive(datagram_); ++k) {
      switch (inbox_.take(
          datagram_, follower_.state() != State::waiting && follower_.state() != State::parked)) {
        case Inbox::Verdict::hello:
          greet(datagram_.peer);
          break;
        case Inbox::Verdict::accepted:
          if (follower_.state() == State::ramping) {  // not before it is down
            --inbox_.counters().accepted;
            ++inbox_.counters().refused;
            break;
          }
          if (fresh) ++inbox_.counters().superseded;
          fresh = true;
          break;
        default:
          break;
      }
    }
    return act(fresh, time);
  }

  /// On the last command, if it is `fresh`.
  bool act(bool fresh, double time) {
    if (fresh && inbox_.command().mode != static_cast<std::uint64_t>(Mode::leave)) {
      follower_.follow(inbox_.command(), time);
      return true;
    }
    if (fresh) follower_.ramp_down(time, sensors_.platform);
    follower_.go_on(time, sensors_.platform, inbox_.counters());
    const bool down =
        follower_.state() == State::parked || (fresh && follower_.state() == State::waiting);
    return !(down && client_gone());
  }

  /// Makes room for another client; whether the run is over.
  bool client_gone() {
    if (!inbox_.has_peer()) return false;
    inbox_.client_has_gone();
    over_ = options_.once;
    return over_;
  }

  void answer(const Peer& peer) {
    update();
    last_answer_ = sensors_;
    send(last_answer_, peer);
    asked_ = false;
  }

  /// In lock-step: the answer to the last command, then the next one. False ends the run.
  bool wait_for_step(double time) {
    if (asked_) answer(inbox_.peer());
    if (follower_.state() == State::ramping) return act(false, time);
    for (double waited = 0.0;; waited = seconds_of(CLOCK_MONOTONIC) - wait_began_) {
      if (waited == 0.0) wait_began_ = seconds_of(CLOCK_MONOTONIC);
      for (int k = 0; k < most_packets && transport_->receive(datagram_); ++k)
        if (const auto step = step_of(time)) return *step;
      if (*keep_going_ && !(*keep_going_)(time)) return false;
      if (follower_.followed() && waited > options_.patience) {
        ++inbox_.counters().trips;
        follower_.ramp_down(time, sensors_.platform);
        return true;
      }
      transport_->wait(look_around);
    }
  }

  /// Whether the packet is a step, and then whether the run goes on.
  std::optional<bool> step_of(double time) {
    switch (inbox_.take(datagram_, follower_.followed())) {
      case Inbox::Verdict::hello:
        greet(datagram_.peer);
        return std::nullopt;
      case Inbox::Verdict::repeated:
        send(last_answer_, datagram_.peer);
        return std::nullopt;
      case Inbox::Verdict::ignored:
        return std::nullopt;
      case Inbox::Verdict::unreachable:
        asked_ = true;
        return true;  // the last command stays
      case Inbox::Verdict::accepted:
        break;
    }
    asked_ = true;
    return act(true, time);
  }

  void record(const simulation::LoopSample& sample) {
    simulation::record_row(loop_, sample, row_.data());
    double* next = std::copy_n(sensors_.accelerometer.data(), options_.accelerometers.size(),
                               row_.data() + plain_columns_);
    const bool acts = follower_.followed();
    for (const double value :
         {acts ? follower_.age(sample.time) : 0.0, static_cast<double>(follower_.state()),
          options_.lock_step ? 0.0 : pace_.lateness(), static_cast<double>(pace_.misses())})
      *next++ = value;
    queue_->put(row_.data());
  }

  simulation::ClosedLoop& loop_;
  const ServeOptions& options_;
  Layout layout_;
  std::unique_ptr<Transport> transport_;
  Inbox inbox_;
  Follower follower_;
  Readings readings_;
  Pace pace_;
  const simulation::KeepGoing* keep_going_{};
  Sensors sensors_{}, last_answer_{};
  Datagram datagram_{};
  bool asked_{};  ///< a command waits for its answer
  bool over_{};   ///< the client has gone, and only one was wanted
  double wait_began_{};
  std::uint64_t sent_{}, not_sent_{};
  std::size_t plain_columns_{};
  std::vector<double> row_{};
  std::optional<RecordQueue> queue_{};
};

}  // namespace

std::vector<data::Channel> serve_channels(const simulation::ClosedLoop&,
                                          const ServeOptions& options) {
  std::vector<data::Channel> channels;
  for (const auto& one : options.accelerometers)
    channels.push_back({one.name, "m/s^2", one.direction, data::Role::response, one.point});
  for (const auto& [name, unit] : {std::pair{"command.age", "s"},
                                   {"serve.state", "1"},
                                   {"serve.lateness", "s"},
                                   {"serve.deadline_misses", "1"}})
    channels.push_back({name, unit, data::Direction::none, data::Role::other});
  return channels;
}

ServeResult serve(simulation::ClosedLoop& loop, const ServeOptions& options,
                  const OpenRecord& record, const simulation::KeepGoing& keep_going) {
  if (options.accelerometers.size() > most_accelerometers)
    base::refuse("--accelerometer",
                 fmt::format("{} are given, expected at most {}", options.accelerometers.size(),
                             most_accelerometers));
  return Server(loop, options, record).run(keep_going);
}

}  // namespace hydrapod::realtime
