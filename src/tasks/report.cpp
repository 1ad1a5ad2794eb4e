#include "hydrapod/tasks/fit.hpp"

#include <algorithm>

#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::tasks {

namespace {

/// The poses as `machine` has them: those of its file by name, others as displacements.
void place(const model::Machine& machine, std::vector<model::NamedPose>& poses) {
  for (auto& pose : poses)
    if (pose.name.find('=') != std::string::npos || find_pose(machine, pose.name) != nullptr)
      pose = pose_of(machine, pose.name);
}

}  // namespace

Report report_document(const Machine& given, const ReportOptions& options,
                       const Progress& progress) {
  Report result;
  auto machine = given;
  auto page = options.page;
  auto poses = options.poses.empty() ? std::vector{given.pose} : options.poses;
  machine.pose = poses.front();
  const auto warn = [&](const std::vector<base::Diagnostic>& more) {
    result.warnings.insert(result.warnings.end(), more.begin(), more.end());
  };
  report::Json diagnosis;
  if (options.diagnosis) {
    const auto found = diagnose(machine, *options.diagnosis, progress);
    warn(found.warnings);
    diagnosis = report::diagnosis_json(found.file);
    if (const auto& d = *found.file.diagnosis; !d.equivalent.empty()) {
      machine.file = diagnosis::file_of(machine.file, d.hypotheses[d.equivalent.front()]);
      machine.file.machine.state = "best hypothesis of the diagnosis: " +
                                   report::hypothesis_name(d, d.hypotheses[d.equivalent.front()]);
      machine.kind = d.hypotheses[d.equivalent.front()].kind;
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
  document["check"]["verdict"] = report::verdict_text(checked);
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
  return result;
}

}  // namespace hydrapod::tasks
