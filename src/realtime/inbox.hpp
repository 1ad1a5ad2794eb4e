#pragma once
/// Which of the packets that came in count. Private to the module.

#include "hydrapod/realtime/realtime.hpp"
#include "transport.hpp"

namespace hydrapod::realtime {

/// Unwraps numbers of fewer than 64 bits, and tells old from new.
class SequenceWindow {
 public:
  explicit SequenceWindow(int bits) : bits_(bits) {}

  enum class Verdict { next, reordered, duplicated };
  /// Of the number as it stands in the packet. Numbers that are left out are added to `lost`, and
  /// taken from it when they come late.
  Verdict see(std::uint64_t number, std::uint64_t& lost);
  [[nodiscard]] std::uint64_t last() const { return last_; }
  void forget() { *this = SequenceWindow(bits_); }

 private:
  [[nodiscard]] std::int64_t ahead(std::uint64_t number) const;

  int bits_;
  bool begun_{};
  std::uint64_t last_{};
  std::uint64_t seen_{};  ///< bit i: last − i has come
};

/// Of a whole number in packets; 64 where there is no such field.
int field_bits(const PacketLayout& layout, Kind kind, std::string_view name);

/// Takes packets of commands.
class Inbox {
 public:
  Inbox(const Layout& layout, const Key& key, std::uint64_t session,
        std::function<bool(const Command&)> reachable);

  enum class Verdict {
    ignored,
    accepted,
    unreachable,  ///< sound, and the legs cannot do it
    hello,
    repeated  ///< the last one again
  };
  /// `followed`: a client is being followed, whose packets alone count.
  Verdict take(const Datagram& datagram, bool followed);

  [[nodiscard]] const Command& command() const { return command_; }  ///< the last accepted one
  [[nodiscard]] const Peer& peer() const { return peer_; }           ///< who sent it
  [[nodiscard]] bool has_peer() const { return has_peer_; }
  [[nodiscard]] std::uint64_t last() const { return window_.last(); }
  [[nodiscard]] std::uint64_t session() const { return session_; }
  [[nodiscard]] std::uint64_t hello_time() const { return hello_time_; }
  Counters& counters() { return counters_; }
  /// The client has gone: without a key the next one may count from anywhere.
  void client_has_gone();

 private:
  bool open(const Datagram& datagram, Command& command);

  const Layout& layout_;
  const Key& key_;
  std::uint64_t session_;
  std::function<bool(const Command&)> reachable_;
  bool has_sequence_;
  SequenceWindow window_;
  std::uint64_t last_number_{};  ///< as it stood in the packet
  Command command_{};
  Peer peer_{};
  bool has_peer_{};
  std::uint64_t hello_time_{};
  Counters counters_{};
};

}  // namespace hydrapod::realtime
