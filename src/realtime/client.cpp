#include "client.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "pace.hpp"

namespace hydrapod::realtime {

namespace {

std::uint64_t now_in_nanoseconds() {
  return static_cast<std::uint64_t>(seconds_of(CLOCK_MONOTONIC) * 1e9);
}

std::unique_ptr<Transport> open(const HardwareOptions& options) {
  if (!options.shared_memory.empty())
    return open_shared_memory(options.shared_memory, false, "--hardware");
  if (!options.key.given() && !is_loopback(options.address, "--hardware"))
    base::refuse("--hardware",
                 fmt::format("'{}' is beyond the loopback, where only packets with a key are "
                             "accepted, expected --key FILE",
                             options.address.host));
  return connect_udp(options.address, "--hardware");
}

}  // namespace

Client::Client(const HardwareOptions& options, const Layout& layout)
    : options_(options),
      layout_(layout),
      transport_(open(options)),
      window_(field_bits(layout.sensors, Kind::sensors, "sequence")),
      greets_(layout.command.has(Kind::command, "mode")) {}

void Client::send_bytes() { transport_->send({sent_.data(), sent_size_}, {}); }

std::uint64_t Client::send(Command command) {
  const bool hello = command.mode == static_cast<std::uint64_t>(Mode::hello);
  command.session = session_;
  command.sequence = hello ? 0 : next_++;
  command.time = now_in_nanoseconds();
  if (hello) hello_time_ = command.time;
  sent_size_ = encode(layout_, command, sent_.data());
  if (options_.key.given()) {
    const auto mac = authentication(options_.key, Kind::command, {sent_.data(), sent_size_});
    std::ranges::copy(mac, sent_.begin() + static_cast<std::ptrdiff_t>(sent_size_));
    sent_size_ += mac_size;
  }
  send_bytes();
  return command.sequence;
}

void Client::send_again() {
  ++resent_;
  send_bytes();
}

bool Client::take() {
  auto bytes = datagram_.span();
  if (options_.key.given()) {
    const std::size_t size = layout_.sensors.size;
    const bool sized = bytes.size() == size + mac_size;
    const auto right = authentication(options_.key, Kind::sensors, bytes.first(sized ? size : 0));
    if (!sized || CRYPTO_memcmp(bytes.last(mac_size).data(), right.data(), mac_size) != 0) {
      ++refused_;
      return false;
    }
    bytes = bytes.first(size);
  }
  Sensors fresh;
  fresh.length.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!decode(layout_, bytes, fresh)) {
    ++malformed_;
    return false;
  }
  // an old answer, sent again by another, does not name this hello
  const bool right_session = connected_ ? fresh.session == session_
                                        : !greets_ || !has("echo") || fresh.echo == hello_time_;
  if (!right_session) {
    ++refused_;
    return false;
  }
  const std::uint64_t before = lost_;
  if (has("sequence") && window_.see(fresh.sequence, lost_) != SequenceWindow::Verdict::next) {
    ++late_;
    return false;
  }
  gap_ = lost_ - std::min(lost_, before);
  ++received_;
  sensors_ = fresh;
  return true;
}

bool Client::receive(double seconds) {
  const double end = seconds_of(CLOCK_MONOTONIC) + seconds;
  for (;;) {
    constexpr int many = 64;  // between looks at the clock
    for (int k = 0; k < many && transport_->receive(datagram_); ++k)
      if (take()) return true;
    const double left = end - seconds_of(CLOCK_MONOTONIC);
    if (left <= 0.0) return false;
    transport_->wait(left);
  }
}

void Client::connect(const std::function<bool()>& goes_on) {
  const double end = seconds_of(CLOCK_MONOTONIC) + options_.connect;
  while (seconds_of(CLOCK_MONOTONIC) < end && goes_on()) {
    // without a mode there is no hello, and the machine is asked to stay where it is
    send({.mode = static_cast<std::uint64_t>(greets_ ? Mode::hello : Mode::pose)});
    if (!receive(0.1)) continue;
    connected_ = true;
    window_.forget();  // between this answer and the first sample much may pass
    lost_ = 0;
    session_ = sensors_.session;
    if (greets_) next_ = sensors_.answered + 1;
    return;
  }
  base::refuse("--hardware " + transport_->place(),
               fmt::format("no answer for {:g} s; {} packets came, {} of them malformed (another "
                           "layout, another number of accelerometers, or cylinders where the "
                           "file has screws?), {} refused (another key?)",
                           options_.connect, received_ + malformed_ + refused_ + late_, malformed_,
                           refused_));
}

void Client::tell(HardwareResult& result) const {
  result.received = received_;
  result.lost = lost_;
  result.late = late_;
  result.malformed = malformed_;
  result.refused = refused_;
  result.resent = resent_;
  result.last = sensors_;
}

}  // namespace hydrapod::realtime
