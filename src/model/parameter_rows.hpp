#pragma once
/// What the rows of the parameter table are written with, and the parts of it. Private to the
/// module.

#include <cmath>
#include <numbers>

#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/section.hpp"
#include "parameter_access.hpp"

// A namespace of its own, because many rows want short names.
namespace hydrapod::model::rows {

// The parts of the table.
std::span<const ParameterRow> bodies();
std::span<const ParameterRow> legs();
std::span<const ParameterRow> leg_hydraulics();
std::span<const ParameterRow> single_legs_and_damping();
std::span<const ParameterRow> supply_and_control();
std::span<const ParameterRow> payload_modes();
std::span<const ParameterRow> poses();

// ---- Bounds ---------------------------------------------------------------------------------

inline constexpr Bound any{};
inline constexpr Bound positive{.lowest = 0.0, .more_than_lowest = true};
inline constexpr Bound not_negative{.lowest = 0.0};

inline constexpr Bound spring_rate{.lowest = 0.0,
                                   .highest = stiffest,
                                   .more_than_lowest = true,
                                   .expected = "no more than 1e+15, or \"rigid\""};
static_assert(stiffest == 1e15);

inline constexpr Bound below_one{.lowest = 0.0, .highest = 1.0, .less_than_highest = true};
inline constexpr Bound up_to_one{.lowest = 0.0, .highest = 1.0, .more_than_lowest = true};
inline constexpr Bound polytropic{
    .lowest = 1.0, .highest = 2.0, .expected = "1 (slow) to about 1.4 (fast)"};

/// What machines have: numbers outside are asked about, not refused.
constexpr Bound usual(double least, double most, Bound bound) {
  bound.usual_least = least;
  bound.usual_most = most;
  return bound;
}

// ---- Kinds of rows --------------------------------------------------------------------------

/// Must a key be there, and what holds where it is left out?
struct Presence {
  bool required{};
  std::string_view otherwise{};
};
inline constexpr Presence required{.required = true};
inline constexpr Presence optional{};
inline constexpr Presence standard{};  ///< the default of the struct
constexpr Presence otherwise(std::string_view what) { return {.otherwise = what}; }

/// What the starter file has: a value, or one in a comment; else the default in a comment.
struct Example {
  std::string_view value{};
  bool in_use{};
};
constexpr Example given(std::string_view value) { return {value, true}; }
constexpr Example shown(std::string_view value) { return {value, false}; }

constexpr ParameterRow row(Kind kind, std::string_view path, std::string_view unit,
                           Presence presence, Bound bound, std::string_view meaning,
                           Example example) {
  return {.path = path,
          .unit = unit,
          .kind = kind,
          .required = presence.required,
          .otherwise = presence.otherwise,
          .bound = bound,
          .meaning = meaning,
          .example = example.value,
          .in_use = example.in_use};
}

constexpr ParameterRow table(std::string_view path, Presence presence, std::string_view meaning,
                             std::string_view heading = {}) {
  auto made = row(Kind::table, path, {}, presence, {}, meaning, {});
  made.heading = heading;
  return made;
}

/// A table whose numbers only simulations and checks use.
constexpr ParameterRow simulation(std::string_view path, std::string_view meaning,
                                  std::string_view heading = {}) {
  auto made = table(path, optional, meaning, heading);
  made.mechanics = false;
  return made;
}

constexpr ParameterRow text(std::string_view path, Presence presence, std::string_view meaning,
                            Example example) {
  return row(Kind::text, path, {}, presence, {}, meaning, example);
}

/// Is the member at the end of the way an optional one?
template <auto first, auto... more>
constexpr bool ends_optional() {
  if constexpr (sizeof...(more) > 0) {
    return ends_optional<more...>();
  } else if constexpr (std::is_integral_v<decltype(first)>) {
    return true;  // springs of a mount, the only array of numbers with keys
  } else {
    return []<class Owner, class T>(T Owner::*) {
      return !std::is_same_v<T, std::remove_pointer_t<decltype(held<true>(std::declval<T&>()))>>;
    }(first);
  }
}

/// A number, or the numbers of an array, that the machine holds at `steps`.
template <auto... steps>
constexpr ParameterRow number(std::string_view path, std::string_view unit, Presence presence,
                              Bound bound, std::string_view meaning, Example example = {}) {
  constexpr int numbers = numbers_at<steps...>();
  auto made =
      row(numbers == 6 ? Kind::six : Kind::number, path, unit, presence, bound, meaning, example);
  made.numbers = numbers;
  made.optional = ends_optional<steps...>();
  made.find = number_at<false, steps...>;
  made.make = number_at<true, steps...>;
  return made;
}

template <auto... steps>
constexpr ParameterRow word(std::string_view path, std::span<const std::string_view> words,
                            std::string_view meaning) {
  auto made = row(Kind::word, path, {}, standard, {}, meaning, {});
  made.words = words;
  made.word = word_at<steps...>;
  made.set_word = set_word_at<steps...>;
  return made;
}

/// A number that the linear models of the mechanism do not know.
constexpr ParameterRow not_mechanical(ParameterRow made) {
  made.mechanics = false;
  return made;
}

/// No condition of validate() relates it to another number.
constexpr ParameterRow alone(ParameterRow made) {
  made.alone = true;
  return made;
}

/// Without one of these numbers it has no effect.
constexpr ParameterRow used_with(std::string_view one, ParameterRow made,
                                 std::string_view other = {}) {
  made.used_with = {one, other};
  return made;
}

constexpr ParameterRow in_code(ParameterRow made) {
  made.in_code = true;
  return made;
}

constexpr ParameterRow instead_of(void (*other)(Machine&, int), ParameterRow made) {
  made.instead = other;
  return made;
}

}  // namespace hydrapod::model::rows
