/// The machine inside an FMU: numbers and words by the rows of the parameter table, SI units.

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fmu_interface.hpp"

namespace hydrapod::exchange {

namespace {

using Json = nlohmann::ordered_json;
using model::ParameterRow;

constexpr const char* format_name = "hydrapod machine of an FMU, version 1";
constexpr std::string_view of_poses = "poses.";

bool is_of_legs(const ParameterRow& row) {
  return row.path.starts_with(model::of_legs) || row.path.starts_with("leg.");
}

int places(const ParameterRow& row, const model::Machine& machine) {
  if (row.path.starts_with("payload_modes.")) return static_cast<int>(machine.payload_modes.size());
  return is_of_legs(row) ? model::leg_count : 1;
}

bool holds_numbers(const ParameterRow& row) {
  return row.find != nullptr && !row.path.starts_with(of_poses);
}

/// Per leg or once, a list of elements; null where nothing is held.
Json numbers_json(model::Machine& machine, const ParameterRow& row) {
  Json list = Json::array();
  bool any = false;
  for (int of = 0; of < places(row, machine); ++of) {
    Json elements = Json::array();
    for (int element = 0; element < row.numbers; ++element) {
      const double* number = row.find(machine, of, element);
      any = any || number != nullptr;
      elements.push_back(number != nullptr ? Json(*number) : Json());
    }
    list.push_back(std::move(elements));
  }
  return any ? list : Json();
}

Json words_json(const model::Machine& machine, const ParameterRow& row) {
  Json list = Json::array();
  for (int of = 0; of < places(row, machine); ++of) list.push_back(row.word(machine, of));
  return list;
}

void take_numbers(const Json& list, const ParameterRow& row, model::Machine& machine) {
  for (int of = 0; of < static_cast<int>(list.size()); ++of)
    for (int element = 0; element < row.numbers; ++element) {
      const auto& value =
          list.at(static_cast<std::size_t>(of)).at(static_cast<std::size_t>(element));
      if (value.is_null()) continue;
      if (row.set != nullptr)
        row.set(machine, of, element, value.get<double>());
      else
        *row.make(machine, of, element) = value.get<double>();
    }
}

/// The first word of a row is its default, also of parts that the machine does not have.
void take_words(const Json& list, const ParameterRow& row, model::Machine& machine) {
  for (int of = 0; of < places(row, machine); ++of)
    if (const int word = list.at(static_cast<std::size_t>(of)).get<int>(); word != 0)
      row.set_word(machine, of, word);
}

Json pose_json(const model::NamedPose& pose) {
  Json json{{"name", pose.name}, {"position", Json::array()}, {"rotation", Json::array()}};
  for (int i = 0; i < 3; ++i) json["position"].push_back(pose.X_BP.p_BP[i]);
  for (int i = 0; i < 9; ++i) json["rotation"].push_back(pose.X_BP.R_BP(i / 3, i % 3));
  return json;
}

model::NamedPose pose_of(const Json& json) {
  model::NamedPose pose{json.at("name").get<std::string>(), {}};
  for (int i = 0; i < 3; ++i)
    pose.X_BP.p_BP[i] = json.at("position").at(static_cast<std::size_t>(i)).get<double>();
  for (int i = 0; i < 9; ++i)
    pose.X_BP.R_BP(i / 3, i % 3) =
        json.at("rotation").at(static_cast<std::size_t>(i)).get<double>();
  return pose;
}

}  // namespace

std::string fmu_machine_text(const FmuMachine& of) {
  auto machine = of.machine;
  Json json{{"format", format_name},         {"token", of.token},
            {"name", machine.name},          {"model", static_cast<int>(of.kind)},
            {"hydraulics", of.hydraulics},   {"controller", of.controlled},
            {"input_start", of.input_start}, {"poses", Json::array()},
            {"words", Json::object()},       {"numbers", Json::object()}};
  for (const auto& pose : machine.poses) json["poses"].push_back(pose_json(pose));
  for (const auto& row : model::parameter_table()) {
    if (row.word != nullptr) json["words"][std::string(row.path)] = words_json(machine, row);
    if (!holds_numbers(row)) continue;
    if (auto numbers = numbers_json(machine, row); !numbers.is_null())
      json["numbers"][std::string(row.path)] = std::move(numbers);
  }
  return json.dump(1) + "\n";
}

FmuMachine read_fmu_machine(const std::string& text) {
  const auto json = Json::parse(text);
  if (json.at("format") != format_name)
    throw std::invalid_argument(std::string("expected the format \"") + format_name + "\"");
  FmuMachine result{.kind = static_cast<dynamics::ModelKind>(json.at("model").get<int>()),
                    .hydraulics = json.at("hydraulics").get<bool>(),
                    .controlled = json.at("controller").get<bool>(),
                    .token = json.at("token").get<std::string>(),
                    .input_start = json.at("input_start").get<std::vector<double>>()};
  auto& machine = result.machine;
  machine.name = json.at("name").get<std::string>();
  for (const auto& pose : json.at("poses")) machine.poses.push_back(pose_of(pose));
  if (machine.poses.empty() ||
      result.input_start.size() != static_cast<std::size_t>(result.inputs()))
    throw std::invalid_argument("expected a pose and a start of each input");
  for (const auto& row : model::parameter_table()) {
    const std::string path(row.path);
    if (holds_numbers(row) && json.at("numbers").contains(path))
      take_numbers(json["numbers"][path], row, machine);
    if (row.word != nullptr && json.at("words").contains(path))
      take_words(json["words"][path], row, machine);
  }
  return result;
}

}  // namespace hydrapod::exchange
