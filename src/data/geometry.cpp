#include "geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "channel_units.hpp"

namespace hydrapod::data {

namespace {

using Json = nlohmann::ordered_json;

/// JSON of texts of a file, whose bytes need not be UTF-8.
std::string dumped(const Json& json) {
  try {
    return json.dump();
  } catch (const Json::exception&) {
    throw std::invalid_argument("record: what is said of its measuring points is not UTF-8");
  }
}

/// Calls `read`; what nlohmann-json finds wrong becomes std::invalid_argument.
template <class Read>
auto with_reasons(const Read& read) {
  try {
    return read();
  } catch (const Json::exception& error) {
    const std::string_view what = error.what();  // "[json.exception.…] type must be …"
    throw std::invalid_argument(clean_text(what.substr(what.find(']') + 2)));
  }
}

}  // namespace

std::string geometry_json(const Geometry& geometry) {
  if (geometry.empty()) return "";
  Json nodes = Json::array(), lines = Json::array();
  for (const Node& n : geometry.nodes) {
    Json node{{"number", n.number},
              {"position_m", {n.position.x(), n.position.y(), n.position.z()}}};
    if (n.position_system != 0 || n.motion_system != 0 || n.color != 0)
      node["systems_and_color"] = {n.position_system, n.motion_system, n.color};
    nodes.push_back(node);
  }
  for (const TraceLine& line : geometry.lines)
    lines.push_back({{"name", line.name}, {"nodes", line.nodes}, {"color", line.color}});
  return dumped({{"nodes", nodes}, {"lines", lines}});
}

namespace {

/// json.get<int>() would wrap.
int whole_number(const Json& json) {
  const bool fits = json.is_number_unsigned()
                        ? std::in_range<int>(json.get<std::uint64_t>())
                        : json.is_number_integer() && std::in_range<int>(json.get<std::int64_t>());
  if (!fits)
    throw std::invalid_argument(
        fmt::format("expected a whole number up to {}", std::numeric_limits<int>::max()));
  return json.get<int>();
}

std::vector<int> whole_numbers(const Json& json) {
  std::vector<int> all;
  for (const Json& number : json) all.push_back(whole_number(number));
  return all;
}

}  // namespace

Geometry read_geometry(const std::string& text) {
  Geometry geometry;
  if (text.empty()) return geometry;
  return with_reasons([&] {
    const Json json = Json::parse(text);
    for (const Json& node : json.value("nodes", Json::array())) {
      const auto p = node.at("position_m").get<std::array<double, 3>>();
      Node& to =
          geometry.nodes.emplace_back(Node{whole_number(node.at("number")), {p[0], p[1], p[2]}});
      if (!node.contains("systems_and_color")) continue;
      const auto numbers = whole_numbers(node["systems_and_color"]);
      if (numbers.size() != 3) throw std::invalid_argument("systems_and_color: expected 3 numbers");
      to.position_system = numbers[0];
      to.motion_system = numbers[1];
      to.color = numbers[2];
    }
    for (const Json& line : json.value("lines", Json::array()))
      geometry.lines.push_back({line.value("name", std::string()), whole_numbers(line.at("nodes")),
                                whole_number(line.value("color", Json(0)))});
    return geometry;
  });
}

std::string channel_texts_json(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    if (channel.entity.empty() && channel.id_lines.empty()) continue;
    Json& entry = list.emplace_back(Json{{"channel", channel.name}});
    if (!channel.entity.empty()) entry["entity"] = channel.entity;
    if (!channel.id_lines.empty()) entry["id_lines"] = channel.id_lines;
  }
  return list.empty() ? "" : dumped(list);
}

namespace {

void take_channel_texts(const std::string& text, std::vector<Channel>& channels) {
  if (text.empty()) return;
  with_reasons([&] {
    for (const Json& entry : Json::parse(text)) {
      const auto name = entry.at("channel").get<std::string>();
      const auto at = std::ranges::find(channels, name, &Channel::name);
      if (at == channels.end()) continue;  // the channel was left out
      at->entity = entry.value("entity", std::string());
      at->id_lines = entry.value("id_lines", std::vector<std::string>());
    }
    return true;
  });
}

}  // namespace

void settle_geometry(const std::string& geometry, const std::string& channel_texts, Notes& notes,
                     RecordHeader& header) {
  try {
    header.geometry = read_geometry(geometry);
    take_channel_texts(channel_texts, header.channels);
  } catch (const std::invalid_argument& error) {
    notes.add(fmt::format("what is said of the measuring points cannot be read: {}; it is left out",
                          error.what()));
  }
}

}  // namespace hydrapod::data
