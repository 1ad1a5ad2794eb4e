#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "instance.hpp"

namespace hydrapod::fmu {

namespace {

constexpr std::array<char, 8> mark{'h', 'y', 'd', 'r', 'f', 'm', 'u', '3'};

/// The numbers of a state that have a fixed place.
struct Head {
  std::array<char, 8> begin;
  std::array<char, 40> token;  // ends with zeros
  std::int64_t mode, flags, parameters, inputs, states, loop;
  double time, start, stop, tolerance;
};

/// All lists, in the order in which they are written.
template <class State>
auto lists(State& state) {
  return std::array{&state.parameters, &state.at_rest, &state.inputs, &state.x, &state.loop};
}

std::array<char, 40> padded(const std::string& token) {
  std::array<char, 40> text{};
  std::copy_n(token.begin(), std::min(token.size(), text.size() - 1), text.begin());
  return text;
}

bool finite(const std::vector<double>* values) {
  return std::ranges::all_of(*values, [](double value) { return std::isfinite(value); });
}

}  // namespace

std::size_t SavedState::bytes() const {
  std::size_t numbers = 0;
  for (const auto* list : lists(*this)) numbers += list->size();
  return sizeof(Head) + numbers * sizeof(double);
}

void SavedState::write(char* to) const {
  const auto size = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
  const Head head{mark,
                  padded(token),
                  mode,
                  (has_stop ? 1 : 0) + (ready ? 2 : 0),
                  size(parameters),
                  size(inputs),
                  size(x),
                  size(loop),
                  time,
                  start,
                  stop,
                  tolerance};
  std::memcpy(to, &head, sizeof head);
  to += sizeof head;
  for (const auto* list : lists(*this)) {
    std::memcpy(to, list->data(), list->size() * sizeof(double));
    to += list->size() * sizeof(double);
  }
}

SavedState SavedState::read(const char* from, std::size_t size, const SavedState& like) {
  Head head{};
  SavedState state{.token = like.token,
                   .parameters = like.parameters,
                   .at_rest = like.at_rest,
                   .inputs = like.inputs,
                   .x = like.x,
                   .loop = {}};
  const std::size_t least = state.bytes();
  if (size < least)
    throw Misuse("a serialized state of this FMU has " + std::to_string(least) +
                 " bytes or more, got " + std::to_string(size));
  std::memcpy(&head, from, sizeof head);
  const auto same = [](std::int64_t count, const auto& list) {
    return count == static_cast<std::int64_t>(list.size());
  };
  const bool whole = head.loop >= 0 && (size - least) % sizeof(double) == 0 &&
                     (size - least) / sizeof(double) == static_cast<std::size_t>(head.loop);
  if (head.begin == mark && head.token != padded(like.token))
    throw Misuse("this serialized state is of another FMU: its token is " +
                 std::string(head.token.data(), strnlen(head.token.data(), head.token.size())) +
                 ", that of this one " + like.token);
  if (head.begin != mark || head.flags < 0 || head.flags > 3 ||
      !same(head.parameters, state.parameters) || !same(head.inputs, state.inputs) ||
      !same(head.states, state.x) || !whole ||
      (head.loop > 0 && !Loop::fits(static_cast<std::size_t>(head.loop))))
    throw Misuse("these bytes are no serialized state of this FMU");
  state.loop.resize(static_cast<std::size_t>(head.loop));
  from += sizeof head;
  for (auto* list : lists(state)) {
    std::memcpy(list->data(), from, list->size() * sizeof(double));
    from += list->size() * sizeof(double);
  }
  if (!std::ranges::all_of(lists(state), finite) || !std::isfinite(head.time))
    throw Misuse("this serialized state has numbers that are not finite");
  state.mode = head.mode;
  state.has_stop = (head.flags & 1) != 0;
  state.ready = (head.flags & 2) != 0;
  state.time = head.time;
  state.start = head.start;
  state.stop = head.stop;
  state.tolerance = head.tolerance;
  return state;
}

}  // namespace hydrapod::fmu
