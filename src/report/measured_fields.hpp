#pragma once
/// Fields that responses and identified modes share. Private to the module.

#include <array>

#include "fields.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

template <class Warning>
std::vector<std::string> texts(const std::vector<Warning>& warnings) {
  std::vector<std::string> all;
  for (const auto& warning : warnings) all.push_back(warning_text(warning));
  return all;
}

/// In the order of data::ResponseWarning::Kind.
inline constexpr std::array response_warning_words{"dead_output",
                                                   "dead_input",
                                                   "repeated_input",
                                                   "clipped",
                                                   "blocks_left_out",
                                                   "correlated_inputs",
                                                   "biased",
                                                   "excited_band",
                                                   "interrupted",
                                                   "lines_not_finite",
                                                   "missing_samples",
                                                   "single_block",
                                                   "weak_excitation",
                                                   "spikes",
                                                   "hits_left_out",
                                                   "repeated_output",
                                                   "held",
                                                   "drop_outs",
                                                   "slow_channel",
                                                   "clipped_hits",
                                                   "delayed",
                                                   "hum",
                                                   "two_clocks",
                                                   "exponential_window",
                                                   "wandering_tone",
                                                   "short_record",
                                                   "feedback",
                                                   "motion_input",
                                                   "sensor_changed",
                                                   "lines_zero",
                                                   "two_sided",
                                                   "input_changed",
                                                   "lost_rows"};
static_assert(response_warning_words.size() ==
              static_cast<std::size_t>(data::ResponseWarning::Kind::lost_rows) + 1);

template <class Fields>
void describe(Fields& f, data::ResponseWarning& warning) {
  std::string estimator{data::estimator_text(warning.estimator)};
  f.word("kind", warning.kind, response_warning_words);
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
