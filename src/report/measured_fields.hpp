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

/// Null beyond the last kind.
inline const char* code(data::ResponseWarning::Kind kind) {
  using Kind = data::ResponseWarning::Kind;
  switch (kind) {
    case Kind::dead_output:
      return "dead_output";
    case Kind::dead_input:
      return "dead_input";
    case Kind::repeated_input:
      return "repeated_input";
    case Kind::clipped:
      return "clipped";
    case Kind::blocks_left_out:
      return "blocks_left_out";
    case Kind::correlated_inputs:
      return "correlated_inputs";
    case Kind::biased:
      return "biased";
    case Kind::excited_band:
      return "excited_band";
    case Kind::interrupted:
      return "interrupted";
    case Kind::lines_not_finite:
      return "lines_not_finite";
    case Kind::missing_samples:
      return "missing_samples";
    case Kind::single_block:
      return "single_block";
    case Kind::weak_excitation:
      return "weak_excitation";
    case Kind::spikes:
      return "spikes";
    case Kind::hits_left_out:
      return "hits_left_out";
    case Kind::repeated_output:
      return "repeated_output";
    case Kind::held:
      return "held";
    case Kind::drop_outs:
      return "drop_outs";
    case Kind::slow_channel:
      return "slow_channel";
    case Kind::clipped_hits:
      return "clipped_hits";
    case Kind::delayed:
      return "delayed";
    case Kind::hum:
      return "hum";
    case Kind::two_clocks:
      return "two_clocks";
    case Kind::exponential_window:
      return "exponential_window";
    case Kind::wandering_tone:
      return "wandering_tone";
    case Kind::short_record:
      return "short_record";
    case Kind::feedback:
      return "feedback";
    case Kind::motion_input:
      return "motion_input";
    case Kind::sensor_changed:
      return "sensor_changed";
  }
  return nullptr;
}

template <class Fields>
void describe(Fields& f, data::ResponseWarning& warning) {
  std::string estimator{data::estimator_text(warning.estimator)};
  f.word("kind", warning.kind, all_codes<data::ResponseWarning::Kind>(code));
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
