#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "study_inputs.hpp"

namespace hydrapod::tasks {

namespace {

/// Throws base::InputError for a range beyond what the machine can have.
void check_range(const study::Input& change, const Varied& varied) {
  const auto& bound = model::row_of(change.id).bound;
  for (const double end : {change.distribution.a, change.distribution.b})
    if (end < bound.lowest || end > bound.highest)
      base::refuse(varied.place,
                   fmt::format("{:.6g} {} is a number that the machine cannot have; expected {}",
                               end, change.unit,
                               bound.expected.empty()
                                   ? fmt::format("{:.6g} … {:.6g}", bound.lowest, bound.highest)
                                   : std::string(bound.expected)));
}

study::Input change_of(const Machine& machine, const Varied& varied) {
  if (base::split(varied.text, ":").size() != 2)
    base::refuse(varied.place, "expected PATH=from:to, for instance \"1:50 kN/mm\"");
  auto change = input_over(machine, varied, false, false);
  check_range(change, varied);
  return change;
}

study::Aim aim_of(const study::DesignProblem& problem, const WantedAim& wanted) {
  const std::string word = wanted.maximise ? "maximise" : "minimise";
  const std::string place = "--" + word + " " + wanted.name;
  study::Aim aim{
      .text = word + " " + wanted.name, .name = wanted.name, .maximise = wanted.maximise};
  const auto change = std::ranges::find(problem.changes, wanted.name, &study::Input::name);
  if (change != problem.changes.end()) {
    aim.change = static_cast<int>(change - problem.changes.begin());
    aim.unit = change->unit;
    return aim;
  }
  const auto output = std::ranges::find(problem.outputs, wanted.name, &study::Column::name);
  if (output == problem.outputs.end()) {
    require_output(problem.machine, problem.kind, problem.outputs, wanted.name, place);
    std::vector<std::string_view> names;
    for (const auto& one : problem.outputs) names.push_back(one.name);
    for (const auto& one : problem.changes) names.push_back(one.name);
    const auto near = base::nearest(wanted.name, names);
    base::refuse(place, fmt::format("is neither an output nor a number of --change; {}known are {}",
                                    near ? fmt::format("did you mean '{}'? ", *near) : "",
                                    fmt::join(names, ", ")));
  }
  if (wanted.name == "status" || wanted.name == "direction")
    base::refuse(place, "is a number that stands for a word; it is no aim");
  aim.output = static_cast<int>(output - problem.outputs.begin());
  aim.unit = output->unit;
  return aim;
}

/// What the written file says, at every pose. Requirements that it misses make the best design
/// infeasible.
void verify(const DesignJob& job, Designed& designed) {
  auto& best = designed.result.best;
  auto problem = job.problem;
  const auto file = model::parse_machine(designed.text, job.machine.path, {}, {});
  problem.machine = file.machine;
  std::vector<double> values;
  for (const auto& change : problem.changes)
    values.push_back(find_number(file, change.name).value().value);
  std::vector<int> wanted;
  for (const auto& one : problem.requirements) wanted.push_back(one.output);
  std::vector<double> outputs(problem.outputs.size());
  for (std::size_t pose = 0; pose < problem.poses.size(); ++pose) {
    study::DesignModel(problem, problem.poses[pose], wanted).outputs(values, outputs);
    for (const auto& one : problem.requirements) {
      const double value = outputs[static_cast<std::size_t>(one.output)];
      const bool met = one.at_least ? value >= one.bound : value <= one.bound;
      best.feasible = best.feasible && met && outputs.front() == 0.0;
    }
  }
}

}  // namespace

DesignJob prepare_design(const Machine& machine, const DesignOptions& options) {
  DesignJob job{.machine = machine,
                .problem = {.machine = machine.file.machine,
                            .kind = machine.kind,
                            .poses = options.poses,
                            .own = options.own}};
  auto& problem = job.problem;
  if (problem.poses.empty()) problem.poses = {machine.pose};
  std::vector<base::Diagnostic> errors;
  const auto gather = [&](const auto& read) {
    try {
      read();
    } catch (const base::InputError& error) {
      errors.insert(errors.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  for (const auto& varied : options.change)
    gather([&] {
      auto change = change_of(machine, varied);
      if (std::ranges::count(problem.changes, change.id, &study::Input::id) > 0)
        base::refuse(varied.place, "is changed twice");
      problem.changes.push_back(std::move(change));
    });
  for (auto& error : of_other_poses(machine, problem.changes, problem.poses))
    errors.push_back(error);
  if (!errors.empty()) throw base::InputError(errors);
  if (problem.changes.empty() || options.aims.empty() || options.aims.size() > 2)
    throw std::invalid_argument("prepare_design: expected changes, and one aim or two");
  problem.outputs = study::design_outputs(problem);
  for (const auto& text : options.want)
    gather([&] {
      problem.requirements.push_back(
          requirement_of(problem.machine, problem.kind, problem.outputs, text));
    });
  for (const auto& aim : options.aims)
    gather([&] { problem.aims.push_back(aim_of(problem, aim)); });
  if (!errors.empty()) throw base::InputError(errors);
  if (problem.aims.size() == 2 && problem.aims[0].name == problem.aims[1].name)
    base::refuse("--minimise " + problem.aims[0].name, "is an aim twice");
  return job;
}

Designed run_design(const DesignJob& job, const study::DesignOptions& options,
                    const Progress& progress) {
  Designed designed{.result = study::design(job.problem, options, progress)};
  if (!designed.result.best.feasible) return designed;
  designed.text = study::machine_text(job.machine.file, job.problem.changes,
                                      designed.result.best.values, "design");
  verify(job, designed);
  if (!designed.result.best.feasible) designed.text.clear();
  return designed;
}

}  // namespace hydrapod::tasks
