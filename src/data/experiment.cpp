/// How a record was made, as JSON and out of the notes of older records.

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "formats.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::data {

namespace {

using Json = nlohmann::ordered_json;

/// Takes a member off `json`, if it is there. Throws std::invalid_argument for another type.
template <class Value>
void take(Json& json, const char* member, Value& to) {
  const auto at = json.find(member);
  if (at == json.end()) return;
  if constexpr (std::is_integral_v<Value>) {
    const bool fits =
        at->is_number_unsigned()
            ? std::in_range<Value>(at->template get<std::uint64_t>())
            : at->is_number_integer() && std::in_range<Value>(at->template get<std::int64_t>());
    if (!fits)
      throw std::invalid_argument(fmt::format("{}: must be a whole number from {} to {}", member,
                                              std::numeric_limits<Value>::min(),
                                              std::numeric_limits<Value>::max()));
  }
  try {
    at->get_to(to);
  } catch (const Json::exception& error) {
    const std::string_view what = error.what();  // "[json.exception.…] type must be …"
    throw std::invalid_argument(fmt::format("{}: {}", member, what.substr(what.find(']') + 2)));
  }
  json.erase(at);
}

/// The same for one that may be missing.
template <class Value>
void take(Json& json, const char* member, std::optional<Value>& to) {
  if (json.contains(member)) take(json, member, to.emplace());
}

Eigen::Vector3d take_vector(Json& json, const char* member) {
  std::array<double, 3> numbers{};
  take(json, member, numbers);
  return {numbers[0], numbers[1], numbers[2]};
}

Json list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::optional<Eigen::Vector3d> three_numbers(const std::string& text) {
  std::istringstream stream(text);
  Eigen::Vector3d v;
  stream >> v.x() >> v.y() >> v.z();
  return stream ? std::optional(v) : std::nullopt;
}

}  // namespace

std::string experiment_json(const Experiment& e) {
  Json json = Json::object();
  const auto put = [&](const char* member, const auto& value) {
    if (!value.empty()) json[member] = value;
  };
  put("program", e.program);
  put("command", e.command);
  put("overrides", e.overrides);
  put("pose", e.pose_name);
  if (e.pose) json["pose_xyz_rpy"] = *e.pose;
  put("model", e.model);
  if (e.seed) json["seed"] = *e.seed;
  if (e.excitation) {
    Json& excitation = json["excitation"] = {{"entry", e.excitation->entry},
                                             {"signals", e.excitation->signals},
                                             {"level_rms", e.excitation->level}};
    if (e.excitation->period) excitation["period_s"] = *e.excitation->period;
  }
  put("controller", e.controller);
  for (const auto& s : e.sensors)
    json["sensors"].push_back(
        {{"name", s.name}, {"position_m", list(s.position)}, {"axis", list(s.axis)}});
  if (!e.others.empty()) json.update(Json::parse(e.others));
  try {
    return json.empty() ? "" : json.dump();
  } catch (const Json::exception&) {
    throw std::invalid_argument("record: what its experiment says is not UTF-8");
  }
}

namespace {

Experiment experiment_from_json(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw std::invalid_argument("it is no JSON object");
  Experiment e;
  take(json, "program", e.program);
  take(json, "command", e.command);
  take(json, "overrides", e.overrides);
  take(json, "pose", e.pose_name);
  take(json, "pose_xyz_rpy", e.pose);
  take(json, "model", e.model);
  take(json, "seed", e.seed);
  take(json, "controller", e.controller);
  std::optional<Json> excitation;
  take(json, "excitation", excitation);
  if (excitation) {
    auto& to = e.excitation.emplace();
    take(*excitation, "entry", to.entry);
    take(*excitation, "signals", to.signals);
    take(*excitation, "level_rms", to.level);
    take(*excitation, "period_s", to.period);
  }
  std::vector<Json> sensors;
  take(json, "sensors", sensors);
  for (Json& sensor : sensors) {
    auto& to = e.sensors.emplace_back();
    take(sensor, "name", to.name);
    to.position = take_vector(sensor, "position_m");
    to.axis = take_vector(sensor, "axis");
  }
  if (!json.empty()) e.others = json.dump();
  return e;
}

Experiment experiment_from_notes(const std::string& notes) {
  Experiment e;
  if (!notes.starts_with("test rig of hydrapod")) return e;
  e.excitation.emplace();
  for (const std::string& line : base::split(notes, "\n")) {
    const auto after = [&](std::string_view key) {
      return line.starts_with(key) ? line.substr(key.size()) : std::string();
    };
    if (const auto pose = after("pose: "); !pose.empty()) e.pose_name = pose;
    if (const auto model = after("model: "); !model.empty()) e.model = model;
    if (const auto change = after("--set "); !change.empty()) e.overrides.push_back(change);
    // names may hold anything, so what follows them is looked for from the end
    const std::string sensor = after("sensor: ");
    const auto at = sensor.rfind(" at="), along = sensor.rfind(" along=");
    if (at == sensor.npos || along == sensor.npos || along < at) continue;
    const auto position = three_numbers(sensor.substr(at + 4, along - at - 4));
    const auto axis = three_numbers(sensor.substr(along + 7));
    if (position && axis) e.sensors.push_back({sensor.substr(0, at), *position, *axis});
  }
  return e;
}

}  // namespace

Experiment read_experiment(const std::string& json, const std::string& notes) {
  return json.empty() ? experiment_from_notes(notes) : experiment_from_json(json);
}

void settle_experiment(const std::string& json, Notes& notes, RecordHeader& header) {
  const std::string machine = std::move(header.experiment.machine);
  try {
    header.experiment = read_experiment(json, header.notes);
  } catch (const std::invalid_argument& error) {
    notes.add(
        fmt::format("how the record was made cannot be read: {}; it is left out", error.what()));
    header.experiment = {};
  }
  header.experiment.machine = machine;
}

}  // namespace hydrapod::data
