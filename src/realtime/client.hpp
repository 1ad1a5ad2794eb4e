#pragma once
/// The other end of a server or of a machine's controller. Private to the module.

#include "hydrapod/realtime/realtime.hpp"
#include "inbox.hpp"
#include "transport.hpp"

namespace hydrapod::realtime {

class Client {
 public:
  explicit Client(const HardwareOptions& options, const Layout& layout);

  /// Says hello until there is an answer, which becomes sensors(). Throws base::InputError.
  void connect(const std::function<bool()>& goes_on);

  /// Numbers and sends the command; returns its number.
  std::uint64_t send(Command command);
  /// The last one again, for what got lost.
  void send_again();

  /// The next packet of sensors that counts, waiting at most so long [s].
  bool receive(double seconds);
  [[nodiscard]] const Sensors& sensors() const { return sensors_; }
  /// Packets of sensors between this one and the one before it that never came.
  [[nodiscard]] std::uint64_t gap() const { return gap_; }
  [[nodiscard]] bool has(std::string_view name) const {
    return layout_.sensors.has(Kind::sensors, name);
  }
  void tell(HardwareResult& result) const;

 private:
  bool take();
  void send_bytes();

  const HardwareOptions& options_;
  const Layout& layout_;
  std::unique_ptr<Transport> transport_;
  SequenceWindow window_;
  std::array<std::byte, largest_packet + mac_size> sent_{};
  std::size_t sent_size_{};
  Sensors sensors_{};
  Datagram datagram_{};
  std::uint64_t session_{}, next_{1}, hello_time_{};
  bool greets_, connected_{};
  std::uint64_t gap_{};
  std::uint64_t received_{}, lost_{}, late_{}, malformed_{}, refused_{}, resent_{};
};

}  // namespace hydrapod::realtime
