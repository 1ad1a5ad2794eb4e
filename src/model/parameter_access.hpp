#pragma once
/// Ways from a Machine to one of its members, as functions that a table can hold. Private to the
/// module.
///
/// The way is a chain of members: `&Leg::piston_ring, &PistonRing::stiffness`. It begins in the
/// machine, in a leg, in a pose or in a mode of the payload, may go through optional parts and ends
/// at numbers, at a word, or at an element of an array, whose number then stands in the chain.

#include <optional>
#include <type_traits>
#include <vector>

#include "hydrapod/model/machine.hpp"
#include "hydrapod/model/parameters.hpp"

namespace hydrapod::model {

/// belongs_to() of every row of the table, for legs of that type.
const std::vector<bool>& rows_of(LegType type);

/// What an optional part holds, made where it is left out and `make` asks for it; else null.
template <bool make, class T>
T* held(T& object) {
  return &object;
}
template <bool make, class T>
T* held(std::optional<T>& object) {
  if constexpr (make) {
    if (!object) object.emplace();
  }
  return object ? &*object : nullptr;
}

template <bool make, auto step, auto... more, class T>
auto* reach(T& object) {
  auto& next = [&]() -> auto& {
    if constexpr (std::is_integral_v<decltype(step)>) {
      return object[step];
    } else {
      return object.*step;
    }
  }
  ();
  auto* inside = held<make>(next);
  if constexpr (sizeof...(more) == 0) {
    return inside;
  } else {
    using Result = decltype(reach<make, more...>(*inside));
    return inside != nullptr ? reach<make, more...>(*inside) : Result{};
  }
}

template <class Owner, class T>
Owner owner_type(T Owner::*);

/// The mode of the payload, made where it is left out and `make` asks for it; else null.
template <bool make>
PayloadMode* payload_mode(Machine& machine, std::size_t at) {
  auto& modes = machine.payload_modes;
  if constexpr (make) {
    while (modes.size() <= at)
      modes.push_back({.name = next_payload_mode(machine, static_cast<int>(modes.size()))});
  }
  return at < modes.size() ? &modes[at] : nullptr;
}

/// The object in which the way begins.
template <bool make, class Owner>
Owner* owner(Machine& machine, int index) {
  const auto at = static_cast<std::size_t>(index);
  if constexpr (std::is_same_v<Owner, Leg>) {
    return &machine.legs[at];
  } else if constexpr (std::is_same_v<Owner, NamedPose>) {
    return &machine.poses.at(at);
  } else if constexpr (std::is_same_v<Owner, PayloadMode>) {
    return payload_mode<make>(machine, at);
  } else {
    return &machine;
  }
}

template <bool make, auto first, auto... more>
auto* member(Machine& machine, int index) {
  auto* from = owner<make, decltype(owner_type(first))>(machine, index);
  using Result = decltype(reach<make, first, more...>(*from));
  return from != nullptr ? reach<make, first, more...>(*from) : Result{};
}

template <bool make, auto... steps>
double* number_at(Machine& machine, int index, int element) {
  auto* found = member<make, steps...>(machine, index);
  if constexpr (std::is_same_v<decltype(found), double*>) {
    return found;
  } else {
    return found != nullptr ? found->data() + element : nullptr;
  }
}

/// How many numbers stand at the end of the way.
template <auto... steps>
constexpr int numbers_at() {
  using End = std::remove_pointer_t<decltype(member<true, steps...>(std::declval<Machine&>(), 0))>;
  if constexpr (std::is_same_v<End, double>) {
    return 1;
  } else {
    return End::SizeAtCompileTime;
  }
}

template <auto... steps>
int word_at(const Machine& machine, int index) {
  const auto* found = member<false, steps...>(const_cast<Machine&>(machine), index);
  return found != nullptr ? static_cast<int>(*found) : 0;
}

template <auto... steps>
void set_word_at(Machine& machine, int index, int word) {
  auto* found = member<true, steps...>(machine, index);
  *found = static_cast<std::remove_pointer_t<decltype(found)>>(word);
}

}  // namespace hydrapod::model
