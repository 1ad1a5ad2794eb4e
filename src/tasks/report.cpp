#include "hydrapod/tasks/measurement.hpp"

#include <algorithm>
#include <optional>

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "measured_files.hpp"

namespace hydrapod::tasks {

namespace {

/// The poses as `machine` has them: those of its file by name, others as displacements.
void place(const model::Machine& machine, std::vector<model::NamedPose>& poses) {
  for (auto& pose : poses)
    if (pose.name.find('=') != std::string::npos || find_pose(machine, pose.name) != nullptr)
      pose = pose_of(machine, pose.name);
}

report::SideBySide comparison_in(const std::string& path) {
  auto compared = report::side_by_side_from_json(parsed_json(path, {"\"comparison\""}), path);
  if (compared.comparisons.empty())
    base::refuse(path, "compares nothing; `hydrapod compare A B -o FILE.json` writes such a file");
  return compared;
}

/// Predictions of the hypotheses that the page lists, beside what was measured.
report::Json overlays_of(const Diagnosed& found) {
  constexpr std::size_t most = 12;
  const auto& d = *found.file.diagnosis;
  std::vector<std::size_t> listed;
  for (std::size_t k = 0; k < d.hypotheses.size(); ++k)
    if (k < most || d.hypotheses[k].causes.empty()) listed.push_back(k);
  return report::response_overlays_json(
      diagnosis::response_overlays(found.machine.file, found.measured, found.machine.kind, d,
                                   listed),
      listed);
}

}  // namespace

Report report_document(const Machine& given, const ReportOptions& options,
                       const Progress& progress) {
  Report result;
  std::optional<report::SideBySide> compared;  // read first: the rest takes longer
  if (!options.comparison.empty()) compared = comparison_in(options.comparison);
  auto machine = given;
  auto page = options.page;
  auto poses = options.poses.empty() ? std::vector{given.pose} : options.poses;
  machine.pose = poses.front();
  const auto warn = [&](const std::vector<base::Diagnostic>& more) {
    for (const auto& one : more) {  // a record may be identified and diagnosed
      const auto said = [&](const base::Diagnostic& other) { return other.text() == one.text(); };
      if (std::ranges::none_of(result.warnings, said)) result.warnings.push_back(one);
    }
  };
  report::Json diagnosis;
  if (options.diagnosis) {
    const auto found = diagnose(machine, *options.diagnosis, progress);
    warn(found.warnings);
    diagnosis = report::diagnosis_json(found.file);
    diagnosis["responses"] = overlays_of(found);
    if (const auto& d = *found.file.diagnosis; !d.equivalent.empty()) {
      machine.file = diagnosis::file_of(machine.file, d.hypotheses[d.equivalent.front()]);
      machine.file.machine.state = "best hypothesis of the diagnosis: " +
                                   report::hypothesis_name(d, d.hypotheses[d.equivalent.front()]);
      // with stiff sleeves as rigid legs, the page would show modes and axes up to thousands of Hz
      const auto& best = d.hypotheses[d.equivalent.front()];
      machine.kind = best.rigid ? dynamics::ModelKind::rigid : best.kind;
      const int identified = identified_mode(d, found.file.pose);
      if (page.modes.empty() && identified > 0) page.modes = {identified};
      place(machine.file.machine, poses);
    }
  }
  page.kind = machine.kind;
  auto& document = result.document;
  document = report::report_json(machine.file, machine.path, poses, page);
  // of the best hypothesis of a diagnosis, no overrides lead to its numbers
  if (!options.diagnosis) document["editable"]["overrides"] = machine.file.overrides;
  const auto checked = check(machine, poses);
  document["check"] = report::check_json(checked, machine.file.machine);
  document["check"]["verdict"] = report::verdict_text(checked, machine.file.machine);
  machine.pose = poses.front();
  if (options.simulation)
    document["simulation"] = report::simulation_section(
        simulate(machine, *options.simulation, progress), machine.file.machine, machine.pose,
        dynamics::linear_model(machine.file.machine, machine.pose.X_BP, machine.kind));
  if (options.identification) {
    auto asked = *options.identification;
    asked.measure.known = machine;
    const auto found = identify(asked, progress);
    warn(found.warnings);
    document["identification"] = report::identification_section(
        found.modes, found.compared,
        {asked.measure.files, report::measurement_text(found.measured.responses()),
         report::frame_text(found.measured.measurement.from_legs,
                            found.measured.from_accelerometers)});
  }
  if (!diagnosis.is_null()) document["diagnosis"] = diagnosis;
  if (compared) document["comparison"] = report::comparison_section(*compared);
  return result;
}

}  // namespace hydrapod::tasks
