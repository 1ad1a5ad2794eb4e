#include "editable_machine.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "fields.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::report {

namespace {

using model::ParameterRow;

constexpr std::string_view of_poses = "poses.", of_payload = "payload_modes.";

bool is_of_legs(const ParameterRow& row) {
  return row.path.starts_with(model::of_legs) || row.path.starts_with("leg.");
}

/// How often the machine has what the row says.
int places(const model::Machine& machine, const ParameterRow& row) {
  if (row.path.starts_with(of_payload)) return static_cast<int>(machine.payload_modes.size());
  return is_of_legs(row) ? model::leg_count : 1;
}

/// Every element of the row, per leg or mode of the payload, or for the machine as a whole.
Json numbers_of(model::Machine& machine, const ParameterRow& row) {
  Json list = Json::array();
  bool any = false;
  for (int of = 0; of < places(machine, row); ++of) {
    Json elements = Json::array();
    for (int element = 0; element < row.numbers; ++element) {
      const double* number = row.find(machine, of, element);
      any |= number != nullptr;
      elements.push_back(number != nullptr ? Json(*number) : Json());
    }
    list.push_back(std::move(elements));
  }
  return any ? list : Json();
}

Json words_of(const model::Machine& machine, const ParameterRow& row) {
  Json list = Json::array();
  bool any = false;
  for (int of = 0; of < (is_of_legs(row) ? model::leg_count : 1); ++of) {
    list.push_back(row.word(machine, of));
    any |= list.back() != 0;
  }
  return any ? list : Json();
}

Json place(const std::string& name, const spatial::Pose& X) {
  return {{"name", name}, {"position", written(X.p_BP)}, {"rotation", written(X.R_BP)}};
}

/// A pose of the machine by its number, another one as displacement from the neutral pose, which it
/// then moves with, as on the command line.
Json shown_pose(const model::Machine& machine, const model::NamedPose& pose) {
  const auto* known = model::find_pose(machine, pose.name);
  const auto& neutral = machine.neutral();
  Json json =
      place(pose.name, known != nullptr ? pose.X_BP
                                        : spatial::Pose{pose.X_BP.R_BP * neutral.R_BP.transpose(),
                                                        pose.X_BP.p_BP - neutral.p_BP});
  json["of"] = known != nullptr ? Json(known - machine.poses.data()) : Json();
  return json;
}

/// Of what all legs share: those legs that have no value of their own, where these are not all.
Json own_legs(const model::MachineFile& file) {
  constexpr unsigned all = (1U << model::leg_count) - 1U;
  Json json = Json::object();
  for (const auto& id : model::parameters(file.machine)) {
    const auto in_file = model::in_file(file, id);
    const unsigned legs = in_file ? in_file->legs : 0U;
    if (id.of == 0 && legs != all) json[model::path(file.machine, id)] = legs;
  }
  return json;
}

Json units_of(const model::MachineFile& file) {
  Json json = Json::object();
  for (const auto& given : file.given) {
    const auto path = model::path(file.machine, given.id);
    // a number that was overridden or fitted has the unit that it had in the file
    const auto unit = model::written_unit(file.text, given.line == 0 ? path : given.written,
                                          std::string(model::unit(file.machine, given.id)));
    if (!unit.name.empty()) json[path] = {{"name", unit.name}, {"size", unit.size}};
  }
  return json;
}

/// Units that people write, by their factor to SI.
Json scales() {
  constexpr std::array written{
      "mm",    "cm",      "um",   "m",     "g",        "kg",       "t",        "N/m",     "N/mm",
      "kN/m",  "kN/mm",   "MN/m", "GN/m",  "N s/m",    "N s/mm",   "kN s/m",   "kN s/mm", "kg m^2",
      "t m^2", "kg cm^2", "Pa",   "kPa",   "bar",      "MPa",      "GPa",      "m^3",     "l",
      "cm^3",  "mm^3",    "m^2",  "cm^2",  "mm^2",     "rad",      "deg",      "mrad",    "1",
      "%",     "m/s^2",   "m/s",  "mm/s",  "N m/rad",  "kN m/rad", "MN m/rad", "N m/deg", "s",
      "ms",    "us",      "Hz",   "rad/s", "1/s",      "m^3/s",    "l/min",    "l/s",     "N",
      "kN",    "MN",      "N m",  "kN m",  "N m s/rad"};
  std::set<std::string> units;
  for (const auto& row : model::parameter_table())
    if (!row.unit.empty()) units.insert(std::string(row.unit));
  Json json = Json::object();
  for (const auto& unit : units) {
    json[unit] = Json::object();
    for (const char* name : written)
      if (const auto one = base::read_quantity(std::string("1 ") + name, unit); one.ok())
        json[unit][name] = one.value;
  }
  return json;
}

}  // namespace

Json editable_json(const model::MachineFile& file, const std::vector<model::NamedPose>& shown,
                   dynamics::ModelKind kind) {
  auto machine = file.machine;
  static const Json all_scales = scales();
  Json json{{"numbers", Json::object()},
            {"words", Json::object()},
            {"poses", Json::array()},
            {"shown", Json::array()},
            {"own", own_legs(file)},
            {"units", units_of(file)},
            {"scales", all_scales},
            {"model", dynamics::name(kind)},
            {"frequencies", study::frequency_kind(machine)}};
  for (const auto& row : model::parameter_table()) {
    if (row.path.starts_with(of_poses)) continue;
    const std::string path(row.path);
    if (row.find != nullptr)
      if (Json numbers = numbers_of(machine, row); !numbers.is_null())
        json["numbers"][path] = std::move(numbers);
    if (row.word != nullptr)
      if (Json words = words_of(machine, row); !words.is_null())
        json["words"][path] = std::move(words);
  }
  for (const auto& pose : machine.poses) json["poses"].push_back(place(pose.name, pose.X_BP));
  for (const auto& mode : machine.payload_modes) json["payload_modes"].push_back(mode.name);
  for (const auto& pose : shown) json["shown"].push_back(shown_pose(machine, pose));
  return json;
}

}  // namespace hydrapod::report
