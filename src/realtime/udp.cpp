#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "hydrapod/base/error.hpp"
#include "transport.hpp"

namespace hydrapod::realtime {

namespace {

struct Resolved {
  int family{};
  sockaddr_storage address{};
  socklen_t size{};
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

Resolved resolve(const Address& address, const std::string& argument) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int error = ::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list);
  if (error != 0)
    base::refuse(argument,
                 fmt::format("'{}' is no address: {}", address.host, ::gai_strerror(error)));
  Resolved found{.family = list->ai_family, .size = list->ai_addrlen};
  std::memcpy(&found.address, list->ai_addr, list->ai_addrlen);
  ::freeaddrinfo(list);
  return found;
}

std::string text_of(const sockaddr_storage& address) {
  char host[INET6_ADDRSTRLEN] = "?";
  if (address.ss_family == AF_INET6) {
    const auto& six = reinterpret_cast<const sockaddr_in6&>(address);
    ::inet_ntop(AF_INET6, &six.sin6_addr, host, sizeof host);
    return fmt::format("[{}]:{}", host, ntohs(six.sin6_port));
  }
  const auto& four = reinterpret_cast<const sockaddr_in&>(address);
  ::inet_ntop(AF_INET, &four.sin_addr, host, sizeof host);
  return fmt::format("{}:{}", host, ntohs(four.sin_port));
}

class Udp : public Transport {
 public:
  Udp(const Address& address, const std::string& argument, bool listens) : connected_(!listens) {
    const Resolved at = resolve(address, argument);
    socket_ = ::socket(at.family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const bool ready = socket_ >= 0 && (listens ? ::bind(socket_, at.get(), at.size)
                                                : ::connect(socket_, at.get(), at.size)) == 0;
    if (!ready) {
      const int cause = errno;
      if (socket_ >= 0) ::close(socket_);
      base::refuse(argument, fmt::format("cannot {} {}:{}: {}", listens ? "listen at" : "reach",
                                         address.host, address.port, std::strerror(cause)));
    }
    sockaddr_storage own{};
    socklen_t size = sizeof own;
    if (listens)
      ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size);
    else
      own = at.address;
    place_ = text_of(own);
  }
  ~Udp() override { ::close(socket_); }

  bool receive(Datagram& datagram) override {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    ssize_t count = 0;
    do {  // a packet that nobody took is reported here, once, and is no packet
      count = ::recvfrom(socket_, datagram.bytes.data(), datagram.bytes.size(), 0,
                         reinterpret_cast<sockaddr*>(&from), &size);
    } while (count < 0 && (errno == EINTR || errno == ECONNREFUSED));
    if (count < 0) return false;
    datagram.size = static_cast<std::size_t>(count);
    datagram.peer = {};
    if (connected_ || size > datagram.peer.address.size()) return true;
    datagram.peer.size = size;
    std::memcpy(datagram.peer.address.data(), &from, size);
    return true;
  }

  void wait(double seconds) override {
    pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
    timespec limit{};
    limit.tv_sec = static_cast<time_t>(seconds);
    limit.tv_nsec = static_cast<long>((seconds - std::floor(seconds)) * 1e9);
    ::ppoll(&one, 1, &limit, nullptr);
  }

  bool send(std::span<const std::byte> bytes, const Peer& peer) override {
    for (int attempt = 0; attempt < 2; ++attempt) {
      const ssize_t sent =
          connected_ ? ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                     : ::sendto(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
                                reinterpret_cast<const sockaddr*>(peer.address.data()), peer.size);
      if (sent == static_cast<ssize_t>(bytes.size())) return true;
      if (errno != ECONNREFUSED && errno != EINTR) return false;  // of an earlier packet
    }
    return false;
  }

  [[nodiscard]] std::string place() const override { return place_; }

 private:
  bool connected_;
  int socket_{-1};
  std::string place_{};
};

}  // namespace

std::unique_ptr<Transport> listen_udp(const Address& address, const std::string& argument) {
  return std::make_unique<Udp>(address, argument, true);
}
std::unique_ptr<Transport> connect_udp(const Address& address, const std::string& argument) {
  return std::make_unique<Udp>(address, argument, false);
}

bool is_loopback(const Address& address, const std::string& argument) {
  const Resolved at = resolve(address, argument);
  if (at.family == AF_INET6)
    return IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(at.address).sin6_addr);
  constexpr std::uint32_t loopback = 127;
  return ntohl(reinterpret_cast<const sockaddr_in&>(at.address).sin_addr.s_addr) >> 24 == loopback;
}

}  // namespace hydrapod::realtime
