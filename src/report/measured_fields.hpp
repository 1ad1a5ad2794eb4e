#pragma once
/// Fields that responses and identified modes share. Private to the module.

#include "fields.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

template <class Warning>
std::vector<std::string> texts(const std::vector<Warning>& warnings) {
  std::vector<std::string> all;
  for (const auto& warning : warnings) all.push_back(warning_text(warning));
  return all;
}

/// The words of an enum; code() is null beyond the last value.
template <class Enum>
std::vector<const char*> all_codes(const char* (*code)(Enum)) {
  std::vector<const char*> all;
  for (int k = 0; code(static_cast<Enum>(k)) != nullptr; ++k)
    all.push_back(code(static_cast<Enum>(k)));
  return all;
}

template <class Fields>
void describe(Fields& f, data::Channel& channel) {
  std::string direction(data::direction_text(channel.direction)),
      role(data::role_text(channel.role));
  f.maybe("name", channel.name);
  f.maybe("unit", channel.unit);
  f.maybe("direction", direction);
  f.maybe("role", role);
  f.maybe("point", channel.point);
  f.unless(std::string(), "entity", channel.entity);
  f.unless(std::vector<std::string>(), "id_lines", channel.id_lines);
  if constexpr (Fields::reads) {
    channel.direction = data::direction_from_text(direction).value_or(data::Direction::none);
    channel.role = data::role_from_text(role).value_or(data::Role::other);
  }
}

}  // namespace hydrapod::report
