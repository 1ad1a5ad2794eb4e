#pragma once
/// What packets can hold, by name. Private to the module.

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

/// Either `whole` or `real` gives the place of the first of `count` numbers.
template <class Packet>
struct Entry {
  std::string_view name;
  int count{1};
  bool directions{};           ///< components x … rz, else numbers from 1
  std::string_view unit{"1"};  ///< of x, y, z, or of all
  std::string_view angular{};  ///< of rx, ry, rz
  std::uint64_t* (*whole)(Packet&){};
  double* (*real)(Packet&){};
};

std::span<const Entry<Command>> entries(const Command*);
std::span<const Entry<Sensors>> entries(const Sensors*);

/// Of a row of the table: what messages and descriptions need.
struct Name {
  int entry{};
  std::string_view name{};
  int count{};
  bool directions{}, whole{};
  std::string_view unit{}, angular{};
  [[nodiscard]] std::string component(int i) const;
  [[nodiscard]] std::string_view unit_of(int i) const;
};
Name name_at(Kind kind, int entry);
std::optional<Name> find_name(Kind kind, std::string_view name);
std::vector<std::string_view> names_of(Kind kind);

std::string_view type_name(ValueType type);
inline constexpr std::array<ValueType, 10> all_types{
    ValueType::u8,  ValueType::u16, ValueType::u32, ValueType::u64, ValueType::i8,
    ValueType::i16, ValueType::i32, ValueType::i64, ValueType::f32, ValueType::f64};

}  // namespace hydrapod::realtime
