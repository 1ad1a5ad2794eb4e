#pragma once
/// A server in a thread of the test, and a client of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>

#include "realtime/transport.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::realtime {

inline simulation::LoopOptions fixed_steps(double until = 1e4) {
  return {.integrator = {.method = simulation::Method::fixed, .fixed_step = 2e-4}, .until = until};
}

class Served {
 public:
  explicit Served(ServeOptions options, const simulation::LoopOptions& loop_options = fixed_steps(),
                  OpenRecord record = {},
                  const model::Machine& machine = simulation::machine_of("zhang-jiang-2021"))
      : machine_(machine), loop_(machine_, machine_.neutral(), loop_options), options_(options) {
    if (options_.address.port == "4747") options_.address.port = "0";
    std::promise<std::string> place;
    auto ready = place.get_future();
    options_.ready = [&place](const std::string& at) { place.set_value(at); };
    thread_ = std::thread([this, record = std::move(record)] {
      result_ = serve(loop_, options_, record, [this](double) { return !stop_.load(); });
    });
    place_ = ready.get();
  }
  ~Served() {
    stop();
    if (thread_.joinable()) thread_.join();
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  void stop() { stop_ = true; }
  /// Of a server that ends by itself, or is asked to.
  ServeResult& result() {
    if (thread_.joinable()) thread_.join();
    return result_;
  }
  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const simulation::ClosedLoop& loop() const { return loop_; }
  [[nodiscard]] const model::Machine& machine() const { return machine_; }

 private:
  model::Machine machine_;
  simulation::ClosedLoop loop_;
  ServeOptions options_;
  std::string place_{};
  std::atomic<bool> stop_{};
  ServeResult result_{};
  std::thread thread_{};
};

/// Sends what it is told, in hydrapod's layout without accelerometers.
class TestClient {
 public:
  explicit TestClient(std::unique_ptr<Transport> transport, Key key = {},
                      model::LegType legs = model::LegType::cylinder)
      : layout_(native_layout(0, legs)), transport_(std::move(transport)), key_(std::move(key)) {}
  static TestClient of(const Served& served, Key key = {}) {
    return TestClient(connect_udp(parse_address("test", served.place()), "test"), std::move(key),
                      model::leg_type(served.machine()));
  }

  void send(const Command& command) {
    std::array<std::byte, largest_packet + mac_size> bytes;
    std::size_t size = encode(layout_, command, bytes.data());
    if (key_.given()) {
      const auto mac = authentication(key_, Kind::command, {bytes.data(), size});
      std::ranges::copy(mac, bytes.begin() + static_cast<std::ptrdiff_t>(size));
      size += mac_size;
    }
    raw({bytes.data(), size});
  }
  void raw(std::span<const std::byte> bytes) { transport_->send(bytes, {}); }

  /// The next packet of sensors; false after `patience` [s].
  bool receive(Sensors& sensors, double patience = 5.0) {
    for (int k = 0; k < 1000; ++k) {
      while (transport_->receive(last_)) {
        auto bytes = last_.span();
        if (key_.given()) {
          if (bytes.size() < mac_size) continue;
          const auto body = bytes.first(bytes.size() - mac_size);
          const auto right = authentication(key_, Kind::sensors, body);
          if (!std::ranges::equal(bytes.last(mac_size), right)) continue;
          bytes = body;
        }
        if (decode(layout_, bytes, sensors)) return true;
      }
      transport_->wait(patience / 1000.0);
    }
    return false;
  }
  /// The bytes of the packet that was received last.
  [[nodiscard]] std::vector<std::byte> last_bytes() const {
    return {last_.bytes.begin(), last_.bytes.begin() + static_cast<std::ptrdiff_t>(last_.size)};
  }

  /// The machine as it is; what is sent from now on belongs to this session.
  Sensors hello() {
    Sensors sensors;
    send({.time = 4711, .mode = static_cast<std::uint64_t>(Mode::hello)});
    EXPECT_TRUE(receive(sensors));
    EXPECT_EQ(sensors.echo, 4711U);
    session = sensors.session;
    next = sensors.answered + 1;
    return sensors;
  }
  std::uint64_t command(Command command) {
    command.session = session;
    command.sequence = next++;
    send(command);
    return command.sequence;
  }

  std::uint64_t session{}, next{1};

 private:
  Layout layout_;
  std::unique_ptr<Transport> transport_;
  Key key_;
  Datagram last_{};
};

}  // namespace hydrapod::realtime
