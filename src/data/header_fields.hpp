#pragma once
/// What HDF5 and MAT files of hydrapod hold of a record besides its samples. Private to the module.

#include <string>
#include <vector>

#include "formats.hpp"

namespace hydrapod::data {

/// Tells `sink` every field, until it says false: attribute(name, text or number) short ones,
/// text(name, text) those of several lines, channels(name, texts or points) those of the channels.
template <class Sink>
bool put_header(const RecordHeader& header, Sink&& sink) {
  std::vector<std::string> name, unit, direction, role;
  std::vector<int> point;
  for (const Channel& channel : header.channels) {
    name.push_back(channel.name);
    unit.push_back(channel.unit);
    direction.emplace_back(direction_text(channel.direction));
    role.emplace_back(role_text(channel.role));
    point.push_back(channel.point);
  }
  return sink.attribute("format", std::string(record_mark)) &&
         sink.attribute("format_version", record_version) &&
         sink.attribute("title", header.title) &&
         sink.attribute("sample_rate_hz", header.sample_rate) &&
         sink.attribute("start_s", header.start) && sink.attribute("date", header.date) &&
         sink.attribute("repeat", header.repeat) && sink.text("notes", header.notes) &&
         sink.text("experiment", experiment_json(header.experiment)) &&
         sink.text("machine", header.experiment.machine) && sink.channels("name", name) &&
         sink.channels("unit", unit) && sink.channels("direction", direction) &&
         sink.channels("role", role) && sink.channels("point", point);
}

}  // namespace hydrapod::data
