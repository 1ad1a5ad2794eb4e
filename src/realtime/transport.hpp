#pragma once
/// Where packets come from and go to: a socket, or shared memory. Private to the module.

#include <memory>

#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

/// Who sent a packet; empty in shared memory, where there is one client.
struct Peer {
  std::array<std::byte, 28> address{};  ///< a sockaddr_in6 is the longest
  unsigned size{};
  bool operator==(const Peer&) const = default;
};

struct Datagram {
  std::array<std::byte, 2048> bytes{};  ///< more than the largest packet, so that longer ones show
  std::size_t size{};
  Peer peer{};
  [[nodiscard]] std::span<const std::byte> span() const { return {bytes.data(), size}; }
};

class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;
  /// The next packet that is there; false: none.
  virtual bool receive(Datagram& datagram) = 0;
  /// Until a packet is there, at most so long [s].
  virtual void wait(double seconds) = 0;
  /// False: it could not be sent now.
  virtual bool send(std::span<const std::byte> bytes, const Peer& peer) = 0;
  [[nodiscard]] virtual std::string place() const = 0;
};

/// Listens. Throws base::InputError, which calls the address `argument`.
std::unique_ptr<Transport> listen_udp(const Address& address, const std::string& argument);
/// Sends to one address, of which it takes packets alone.
std::unique_ptr<Transport> connect_udp(const Address& address, const std::string& argument);
bool is_loopback(const Address& address, const std::string& argument);

/// `serves`: makes the memory and removes it at the end; else opens that of a server.
std::unique_ptr<Transport> open_shared_memory(const std::string& name, bool serves,
                                              const std::string& argument);

}  // namespace hydrapod::realtime
