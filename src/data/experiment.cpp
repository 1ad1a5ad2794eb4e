/// How a record was made, as JSON and out of the notes of older records.

#include "experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "hydrapod/base/text.hpp"
#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& member, const std::string& expected) {
  throw std::invalid_argument(fmt::format("{} is not {}", member, expected));
}

template <class Numbers>
void read_numbers(const char* member, const Json& json, Numbers& to) {
  const auto is_number = [](const Json& one) { return one.is_number(); };
  const auto count = static_cast<std::size_t>(to.size());
  if (!json.is_array() || json.size() != count || !std::ranges::all_of(json, is_number))
    refuse(member, fmt::format("a list of {} numbers", count));
  for (std::size_t i = 0; i < count; ++i) *(to.data() + i) = json[i].template get<double>();
}

/// Takes the members off a JSON object; what is left is unknown.
class Members {
 public:
  explicit Members(Json json) : json_(std::move(json)) {
    if (!json_.is_object()) refuse("the experiment", "a JSON object");
  }

  void text(const char* member, std::string& to) {
    take(member, [&](const Json& json) {
      if (!json.is_string()) refuse(member, "a text");
      to = json.get<std::string>();
    });
  }
  void texts(const char* member, std::vector<std::string>& to) {
    take(member, [&](const Json& json) {
      const auto is_text = [](const Json& one) { return one.is_string(); };
      if (!json.is_array() || !std::ranges::all_of(json, is_text))
        refuse(member, "a list of texts");
      to = json.get<std::vector<std::string>>();
    });
  }
  template <class Numbers>
  void numbers(const char* member, Numbers& to) {
    take(member, [&](const Json& json) { read_numbers(member, json, to); });
  }
  template <class Use>
  void object(const char* member, const Use& use) {
    take(member, [&](const Json& json) {
      Members inner(json);
      use(inner);
    });
  }
  template <class Use>
  void take(const char* member, const Use& use) {
    const auto at = json_.find(member);
    if (at == json_.end()) return;
    use(*at);
    json_.erase(at);
  }
  [[nodiscard]] std::string left() const { return json_.empty() ? "" : json_.dump(); }

 private:
  Json json_;
};

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
  if (json.is_discarded()) refuse("the experiment", "JSON");
  Members members(std::move(json));
  Experiment e;
  members.text("program", e.program);
  members.texts("command", e.command);
  members.texts("overrides", e.overrides);
  members.text("pose", e.pose_name);
  members.take("pose_xyz_rpy",
               [&](const Json& pose) { read_numbers("pose_xyz_rpy", pose, e.pose.emplace()); });
  members.text("model", e.model);
  members.take("seed", [&](const Json& seed) {
    if (!seed.is_number_unsigned()) refuse("seed", "a whole number");
    e.seed = seed.get<std::uint64_t>();
  });
  members.object("excitation", [&](Members& inner) {
    auto& excitation = e.excitation.emplace();
    inner.text("entry", excitation.entry);
    inner.texts("signals", excitation.signals);
    inner.numbers("level_rms", excitation.level);
    inner.take("period_s", [&](const Json& period) {
      if (!period.is_number()) refuse("period_s", "a number");
      excitation.period = period.get<double>();
    });
  });
  members.text("controller", e.controller);
  members.take("sensors", [&](const Json& sensors) {
    if (!sensors.is_array()) refuse("sensors", "a list");
    for (const Json& one : sensors) {
      Members inner(one);
      auto& sensor = e.sensors.emplace_back();
      inner.text("name", sensor.name);
      inner.numbers("position_m", sensor.position);
      inner.numbers("axis", sensor.axis);
    }
  });
  e.others = members.left();
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
