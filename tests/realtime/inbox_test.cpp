/// Which packets count: lost, late, doubled, broken and false ones.

#include <gtest/gtest.h>

#include <algorithm>

#include "realtime/inbox.hpp"

namespace hydrapod::realtime {
namespace {

using Verdict = Inbox::Verdict;

/// Packets of clients with everything that can happen to them.
class Inboxes : public testing::Test {
 protected:
  static constexpr std::uint64_t session = 0x1234567;
  Layout layout = native_layout(0);
  Key key{}, other_key{"another secret of 24 b."};
  Inbox inbox{layout, key, session, [](const Command& c) { return c.displacement[2] < 0.5; }};

  static Datagram packed(const Layout& layout, const Key& key, const Command& command,
                         std::uint8_t client = 1) {
    Datagram datagram;
    datagram.size = encode(layout, command, datagram.bytes.data());
    datagram.peer.size = 1;
    datagram.peer.address[0] = std::byte{client};
    if (!key.given()) return datagram;
    const auto mac = authentication(key, Kind::command, datagram.span());
    std::ranges::copy(mac, datagram.bytes.begin() + static_cast<std::ptrdiff_t>(datagram.size));
    datagram.size += mac_size;
    return datagram;
  }
  static Command numbered(std::uint64_t sequence) {
    Command command{.session = session, .sequence = sequence};
    command.displacement[0] = 1e-6 * static_cast<double>(sequence);
    return command;
  }
  Verdict take(std::uint64_t sequence, bool followed = true) {
    return inbox.take(packed(layout, key, numbered(sequence)), followed);
  }
};

TEST_F(Inboxes, LostReorderedAndDuplicatedOnesAreCounted) {
  for (const std::uint64_t number : {5, 6, 9}) EXPECT_EQ(take(number), Verdict::accepted);
  EXPECT_EQ(inbox.counters().lost, 2U);
  EXPECT_EQ(take(7), Verdict::ignored);  // late: a newer one has acted
  EXPECT_EQ(inbox.counters().lost, 1U);
  EXPECT_EQ(inbox.counters().reordered, 1U);
  EXPECT_EQ(take(7), Verdict::ignored);
  EXPECT_EQ(take(6), Verdict::ignored);
  EXPECT_EQ(take(9), Verdict::repeated);
  EXPECT_EQ(take(4), Verdict::ignored);  // before the first one
  EXPECT_EQ(inbox.counters().duplicated, 4U);
  EXPECT_EQ(inbox.command().sequence, 9U);
  EXPECT_EQ(take(109), Verdict::accepted);
  EXPECT_EQ(inbox.counters().lost, 1U + 99U);
  EXPECT_EQ(take(40), Verdict::ignored);  // too old to tell
  EXPECT_EQ(inbox.counters().duplicated, 5U);
  EXPECT_EQ(inbox.counters().accepted, 4U);
  EXPECT_EQ(inbox.last(), 109U);
}

TEST_F(Inboxes, BrokenOnesAreMalformed) {
  Datagram datagram = packed(layout, key, numbered(1));
  datagram.bytes[40] ^= std::byte{1};
  EXPECT_EQ(inbox.take(datagram, false), Verdict::ignored);
  datagram.size = 0;
  EXPECT_EQ(inbox.take(datagram, false), Verdict::ignored);
  datagram.size = datagram.bytes.size();
  EXPECT_EQ(inbox.take(datagram, false), Verdict::ignored);
  Command strange = numbered(1);
  strange.mode = 4;
  EXPECT_EQ(inbox.take(packed(layout, key, strange), false), Verdict::ignored);
  EXPECT_EQ(inbox.counters().malformed, 4U);
  EXPECT_FALSE(inbox.has_peer());
}

TEST_F(Inboxes, WhatTheLegsCannotReachIsNotUsed) {
  EXPECT_EQ(take(1), Verdict::accepted);
  Command far_away = numbered(2);
  far_away.displacement[2] = 0.6;
  EXPECT_EQ(inbox.take(packed(layout, key, far_away), true), Verdict::unreachable);
  EXPECT_EQ(inbox.command().sequence, 1U);
  EXPECT_EQ(inbox.last(), 2U);  // it is answered all the same
  EXPECT_EQ(inbox.counters().out_of_range, 1U);
}

TEST_F(Inboxes, OneClientAtATime) {
  EXPECT_EQ(take(10), Verdict::accepted);
  EXPECT_EQ(inbox.take(packed(layout, key, numbered(11), 2), true), Verdict::ignored);
  EXPECT_EQ(inbox.counters().refused, 1U);
  inbox.client_has_gone();
  EXPECT_EQ(inbox.take(packed(layout, key, numbered(1), 2), false), Verdict::accepted);
  EXPECT_EQ(inbox.counters().lost, 0U);
}

TEST_F(Inboxes, AHelloIsNoCommand) {
  Command hello{.time = 99, .mode = static_cast<std::uint64_t>(Mode::hello)};
  EXPECT_EQ(inbox.take(packed(layout, key, hello), false), Verdict::hello);
  EXPECT_EQ(inbox.hello_time(), 99U);
  EXPECT_EQ(inbox.counters().accepted, 0U);
}

TEST_F(Inboxes, WithAKeyNothingElseCounts) {
  key.bytes = "a secret of twenty bytes";
  EXPECT_EQ(inbox.take(packed(layout, Key{}, numbered(1)), false), Verdict::ignored);
  EXPECT_EQ(inbox.take(packed(layout, other_key, numbered(1)), false), Verdict::ignored);
  Command of_another_session = numbered(1);
  of_another_session.session = session + 1;  // recorded before the server started
  EXPECT_EQ(inbox.take(packed(layout, key, of_another_session), false), Verdict::ignored);
  of_another_session.session = 0;
  EXPECT_EQ(inbox.take(packed(layout, key, of_another_session), false), Verdict::ignored);
  EXPECT_EQ(inbox.counters().refused, 4U);
  const Datagram sound = packed(layout, key, numbered(1));
  Datagram touched = sound;
  touched.bytes[touched.size - 1] ^= std::byte{0x80};
  EXPECT_EQ(inbox.take(touched, false), Verdict::ignored);
  EXPECT_EQ(inbox.counters().refused, 5U);
  EXPECT_EQ(inbox.take(sound, false), Verdict::accepted);
  EXPECT_EQ(take(2), Verdict::accepted);
  inbox.client_has_gone();  // a packet is worth nothing a second time, also then
  EXPECT_EQ(inbox.take(sound, false), Verdict::ignored);
  EXPECT_EQ(inbox.counters().duplicated, 1U);
  EXPECT_EQ(inbox.counters().accepted, 2U);
}

TEST(SequenceWindow, ShortNumbersGoRound) {
  SequenceWindow window(8);
  std::uint64_t lost = 0;
  for (int k = 0; k < 1000; ++k)
    ASSERT_EQ(window.see(static_cast<std::uint64_t>(k) & 0xff, lost),
              SequenceWindow::Verdict::next);
  EXPECT_EQ(lost, 0U);
  EXPECT_EQ(window.last(), 999U);
  EXPECT_EQ(window.see((999 + 3) & 0xff, lost), SequenceWindow::Verdict::next);
  EXPECT_EQ(lost, 2U);
  EXPECT_EQ(window.see((999 + 1) & 0xff, lost), SequenceWindow::Verdict::reordered);
  EXPECT_EQ(window.see((999 + 1) & 0xff, lost), SequenceWindow::Verdict::duplicated);
  EXPECT_EQ(lost, 1U);
}

TEST(SequenceWindow, LongNumbersDoNot) {
  SequenceWindow window(64);
  std::uint64_t lost = 0;
  constexpr std::uint64_t most = ~std::uint64_t{0};
  EXPECT_EQ(window.see(3, lost), SequenceWindow::Verdict::next);
  EXPECT_EQ(window.see(most, lost), SequenceWindow::Verdict::next);
  EXPECT_EQ(lost, most - 4);
  EXPECT_EQ(window.see(0, lost), SequenceWindow::Verdict::duplicated);
  EXPECT_EQ(window.see(5, lost), SequenceWindow::Verdict::duplicated);
}

}  // namespace
}  // namespace hydrapod::realtime
