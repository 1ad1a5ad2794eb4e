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

template <class Fields>
void describe(Fields& f, data::ResponseWarning& warning) {
  std::string estimator{data::estimator_text(warning.estimator)};
  f.word("kind", warning.kind, data::response_warning_names);
  f("channel", warning.channel);
  f("other", warning.other);
  f("value", warning.value);
  f("share", warning.share);
  f("lowest", warning.lowest);
  f("highest", warning.highest);
  f("count", warning.count);
  f("total", warning.total);
  f("estimator", estimator);
  if constexpr (Fields::reads)
    warning.estimator = data::estimator_from_text(estimator).value_or(data::Estimator::h1);
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
