#include "inbox.hpp"

#include <openssl/crypto.h>

#include <algorithm>

#include "names.hpp"

namespace hydrapod::realtime {

namespace {
constexpr int window = 64;
}

/// How far `number` is ahead of the last one, the shorter way round.
std::int64_t SequenceWindow::ahead(std::uint64_t number) const {
  const int unused = 64 - bits_;
  return static_cast<std::int64_t>((number - last_) << unused) >> unused;
}

SequenceWindow::Verdict SequenceWindow::see(std::uint64_t number, std::uint64_t& lost) {
  if (!begun_) {
    begun_ = true;
    last_ = number;
    seen_ = ~std::uint64_t{0};  // what came before the first one is not for us
    return Verdict::next;
  }
  // numbers of 64 bits do not wrap: what is smaller is old
  const bool newer = bits_ == 64 ? number > last_ : ahead(number) > 0;
  const std::uint64_t apart =
      newer ? (bits_ == 64 ? number - last_ : static_cast<std::uint64_t>(ahead(number)))
            : (bits_ == 64 ? last_ - number : static_cast<std::uint64_t>(-ahead(number)));
  if (newer) {
    lost += apart - 1;
    seen_ = (apart >= window ? 0 : seen_ << apart) | 1;
    last_ += apart;
    return Verdict::next;
  }
  if (apart >= window || ((seen_ >> apart) & 1) != 0) return Verdict::duplicated;
  seen_ |= std::uint64_t{1} << apart;
  if (lost > 0) --lost;
  return Verdict::reordered;
}

int field_bits(const PacketLayout& layout, Kind kind, std::string_view name) {
  const auto known = find_name(kind, name);
  for (const Field& field : layout.fields)
    if (known && field.role == Field::Role::value && field.entry == known->entry)
      return field.type <= ValueType::i64 ? static_cast<int>(8 * size_of(field.type)) : 24;
  return 64;
}

Inbox::Inbox(const Layout& layout, const Key& key, std::uint64_t session,
             std::function<bool(const Command&)> reachable)
    : layout_(layout),
      key_(key),
      session_(session),
      reachable_(std::move(reachable)),
      has_sequence_(layout.command.has(Kind::command, "sequence")),
      window_(field_bits(layout.command, Kind::command, "sequence")) {}

/// Whole, as the layout says, and from who has the key.
bool Inbox::open(const Datagram& datagram, Command& command) {
  auto bytes = datagram.span();
  if (key_.given()) {
    if (bytes.size() != layout_.command.size + mac_size) {
      ++counters_.refused;
      return false;
    }
    const auto mac = bytes.last(mac_size);
    bytes = bytes.first(layout_.command.size);
    const auto right = authentication(key_, Kind::command, bytes);
    if (CRYPTO_memcmp(mac.data(), right.data(), mac_size) != 0) {
      ++counters_.refused;
      return false;
    }
  }
  if (decode(layout_, bytes, command) && command.mode <= static_cast<std::uint64_t>(Mode::leave))
    return true;
  ++counters_.malformed;
  return false;
}

Inbox::Verdict Inbox::take(const Datagram& datagram, bool followed) {
  Command command;
  if (!layout_.command.has(Kind::command, "displacement"))
    command.mode = static_cast<std::uint64_t>(Mode::valves);
  if (!open(datagram, command)) return Verdict::ignored;
  if (command.mode == static_cast<std::uint64_t>(Mode::hello)) {
    hello_time_ = command.time;
    return Verdict::hello;
  }
  const bool right_session = command.session == session_ || (command.session == 0 && !key_.given());
  if (!right_session || (followed && has_peer_ && datagram.peer != peer_)) {
    ++counters_.refused;
    return Verdict::ignored;
  }
  if (has_sequence_) {
    const auto verdict = window_.see(command.sequence, counters_.lost);
    if (verdict == SequenceWindow::Verdict::reordered) ++counters_.reordered;
    if (verdict == SequenceWindow::Verdict::duplicated) ++counters_.duplicated;
    if (verdict != SequenceWindow::Verdict::next)
      return has_peer_ && command.sequence == last_number_ ? Verdict::repeated : Verdict::ignored;
    last_number_ = command.sequence;
  }
  peer_ = datagram.peer;
  has_peer_ = true;
  if (!reachable_(command)) {
    ++counters_.out_of_range;
    return Verdict::unreachable;
  }
  ++counters_.accepted;
  command_ = command;
  return Verdict::accepted;
}

void Inbox::client_has_gone() {
  has_peer_ = false;
  if (!key_.given()) window_.forget();
}

}  // namespace hydrapod::realtime
