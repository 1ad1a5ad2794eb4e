#include "hydrapod/measured_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/nearest.hpp"
#include "hydrapod/calibration/targets_file.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/diagnosis/responses.hpp"
#include "hydrapod/identification/exchange.hpp"
#include "hydrapod/identification_run.hpp"
#include "hydrapod/report/diagnosis.hpp"
#include "hydrapod/report/identification_json.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

constexpr std::size_t largest = std::size_t{1} << 31;

/// Modes as a person or a spreadsheet lists them?
bool is_mode_list(data::FileKind kind) {
  return kind == data::FileKind::toml || kind == data::FileKind::mode_table;
}

observation::Targets identified(const identification::FrequencyResponses& responses,
                                const std::string& path, const model::MachineFile& file,
                                const diagnosis::MeasuredAt& at) {
  identification::Identification found;
  {
    ProgressLine line("identifying");
    found =
        identification::identify_modes(responses, {}, [&](double share) { line.update(share); });
  }
  print_warnings(path, found.warnings);
  if (found.modes.empty())
    bad_argument(path,
                 "no mode was found in it; a longer record, or one with more excitation, shows "
                 "more (`hydrapod identify` says what was tried)");
  auto targets = diagnosis::measured_modes(found, file.machine, at);
  if (auto all = diagnosis::measured_responses(responses, file.machine, at))
    targets.responses.push_back(std::move(*all));
  return targets;
}

/// Where a record says it: what its inputs see, and the point that forces of the rig act at.
void look_into(const data::Experiment* experiment,
               const identification::FrequencyResponses& responses, diagnosis::MeasuredAt& at) {
  if (!at.observed) at.observed = seen_in_rig(responses, experiment);
  if (experiment == nullptr || !experiment->excitation || experiment->machine.empty()) return;
  if (const auto machine = record_machine(experiment, "the record", "", "", ""))
    at.force_point = machine->file.machine.platform.mass_center;
}

observation::Targets from_json(const std::string& path, const model::MachineFile& file,
                               diagnosis::MeasuredAt at) {
  const std::string text =
      base::read_file(path, largest, "JSON of `hydrapod identify` or `hydrapod frf`");
  report::Json json;
  try {
    json = report::Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    bad_argument(path, fmt::format("is no JSON: {}", error.what()));
  }
  if (json.contains("modes")) return report::modes_from_json(json, path, file.machine, at);
  const auto responses = report::responses_from_json(json, path);
  const auto header = report::record_origin_from_json(json, path);
  look_into(header ? &header->experiment : nullptr, responses, at);
  return identified(responses, path, file, at);
}

/// Of one file.
observation::Targets read_one(const std::string& path, const MachineArguments& arguments,
                              const model::MachineFile& file, const std::string& pose,
                              std::optional<observation::Observed> observed) {
  const auto kind = data::file_kind(path);
  if (is_mode_list(kind)) {
    auto targets = calibration::read_targets(path).targets;
    targets.observed = observed.value_or(targets.observed);
    return targets;
  }
  diagnosis::MeasuredAt at{
      .pose = pose, .point = file.machine.platform.mass_center, .observed = observed};
  if (kind == data::FileKind::json) return from_json(path, file, at);
  if (kind == data::FileKind::frequency_responses) {
    const auto read = data::read_frequency_response(path);
    print_diagnostics(read.notes);
    return identified(identification::from_exchange(read.response, path), path, file, at);
  }
  MeasurementArguments measurement{.files = {path}};
  measurement.machine = arguments.file;
  measurement.pose = pose == "as_measured" ? arguments.pose : pose;
  measurement.p_PQ = file.machine.platform.mass_center;
  auto records = open_records(measurement);
  const auto measured = measure(records, measurement);
  look_into(&records.experiment(), measured.responses, at);
  return identified(measured.responses, path, file, at);
}

/// "run.h5@low".
struct MeasuredFile {
  std::string option{};  ///< as messages call it
  std::string path{};
  std::string pose{};
  bool says_pose{};
};

/// The file and the pose; a file whose own name has an @ is taken as it is.
MeasuredFile file_and_pose(const std::string& text, const model::Machine& machine,
                           const std::string& pose) {
  MeasuredFile file{.option = "--measured " + text, .path = text, .pose = pose};
  const auto at = text.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(text)) return file;
  file.path = text.substr(0, at);
  file.pose = text.substr(at + 1);
  file.says_pose = true;
  if (file.path.empty()) bad_argument(file.option, "names no file; expected FILE or FILE@POSE");
  std::vector<std::string_view> names;
  for (const auto& known : machine.poses) names.push_back(known.name);
  if (std::ranges::find(names, file.pose) != names.end()) return file;
  const auto near = base::nearest(file.pose, names);
  bad_argument(
      file.option,
      fmt::format("after the @ comes a pose of the machine file by its name, where the "
                  "machine stood; {}it has {}",
                  near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(names, ", ")));
}

const char* origin(observation::Observed observed) {
  constexpr std::array words{"holds modes or responses of mechanics alone",
                             "was measured from the drives of the valves",
                             "was measured on the machine under its controller"};
  return words[static_cast<std::size_t>(observed)];
}

void add_measured(observation::Targets one, const MeasuredFile& file, const std::string& first,
                  observation::Targets& all) {
  if (one.observed != all.observed)
    bad_argument(file.option,
                 fmt::format("it {}, and {} {}: they cannot be compared together, diagnose from "
                             "one of them",
                             origin(one.observed), first, origin(all.observed)));
  all.deviations_given = all.deviations_given && one.deviations_given;
  for (auto& mode : one.modes) all.modes.push_back(std::move(mode));
  for (auto& response : one.responses) all.responses.push_back(std::move(response));
}

}  // namespace

observation::Targets read_measured(const std::vector<std::string>& files,
                                   const MachineArguments& arguments,
                                   const model::MachineFile& file, const std::string& pose,
                                   const std::string& against) {
  std::optional<observation::Observed> observed;
  if (const auto word = choose_word("--against", against, {"auto", "mechanics", "plant", "system"});
      word > 0)
    observed = static_cast<observation::Observed>(word - 1);
  std::vector<MeasuredFile> measured;  // all looked at before the first, which may take long
  for (const auto& text : files) {
    auto one = file_and_pose(text, file.machine, pose);
    if (std::ranges::count(measured, one.path, &MeasuredFile::path) > 0)
      bad_argument(one.option, fmt::format("{} is given twice; it would count twice", one.path));
    if (one.says_pose && is_mode_list(data::file_kind(one.path)))
      bad_argument(one.option,
                   "a list of modes says itself at which pose each was measured (pose = \"low\", "
                   "or a column \"pose\"); give the file without @POSE");
    measured.push_back(std::move(one));
  }
  std::optional<observation::Targets> all;
  for (const auto& one : measured) {
    auto targets = read_one(one.path, arguments, file, one.pose, observed);
    if (all)
      add_measured(std::move(targets), one, files.front(), *all);
    else
      all = std::move(targets);
  }
  return std::move(all).value();
}

}  // namespace hydrapod::cli
