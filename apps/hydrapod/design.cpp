/// `hydrapod design`: numbers of a machine that meet requirements at every pose with the best aim.

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/command.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/tasks/study.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> poses{}, want{}, change{}, minimise{}, maximise{};
  std::string all_poses{};
  std::uint64_t samples{2048}, seed{1};
  int starts{6}, threads{};
  std::optional<int> trade_off{};
  std::string output{}, format{"table"}, plot{};
};

tasks::DesignOptions options_of(const Arguments& arguments, const model::Machine& machine) {
  tasks::DesignOptions options{.want = arguments.want,
                               .poses = poses_of(arguments.poses, arguments.all_poses, machine)};
  for (const auto& text : arguments.change) {
    const auto at = text.find('=');
    const std::string place = fmt::format("--change \"{}\"", text);
    if (at == std::string::npos || at == 0)
      base::refuse(place,
                   "expected PATH=from:to, for instance "
                   "\"legs.guide_sleeve.stiffness=1:50 kN/mm\"");
    options.change.push_back({std::string(base::trimmed(text.substr(0, at))),
                              std::string(base::trimmed(text.substr(at + 1))), place});
  }
  for (const auto& name : arguments.minimise) options.aims.push_back({name, false});
  for (const auto& name : arguments.maximise) options.aims.push_back({name, true});
  if (options.change.empty())
    base::refuse("--change", "is missing: no number of the machine may change; see --help");
  if (options.aims.empty())
    base::refuse("--minimise",
                 "is missing: many designs may meet the requirements; name an output "
                 "or a changed number with --minimise or --maximise");
  if (options.aims.size() > 2)
    base::refuse("--minimise", "more than two aims; take one as a requirement (--want)");
  if (arguments.trade_off && options.aims.size() < 2)
    base::refuse("--trade-off", "needs two aims (--minimise, --maximise)");
  return options;
}

std::string number_text(double value) {
  return std::isfinite(value) ? fmt::format("{:.5g}", value) : std::string("–");
}

using Units = report::DesignUnits;

model::WrittenUnit unit_of_bound(const std::string& requirement, const std::string& si) {
  const std::string bound(base::trimmed(requirement.substr(requirement.find_first_of("<>") + 2)));
  char* end = nullptr;
  std::strtod(bound.c_str(), &end);
  const std::string unit(base::trimmed(end));
  if (unit.empty()) return {si, 1.0};
  return {unit, base::quantity("1 " + unit, si)};
}

Units units_of(const tasks::DesignJob& job) {
  const auto& problem = job.problem;
  Units units;
  for (const auto& change : problem.changes) {
    units.changes.push_back(model::written_unit(job.machine.file.text, change.name, change.unit));
    if (units.changes.back().name.empty()) units.changes.back().name = change.unit;
  }
  for (const auto& wanted : problem.requirements)
    units.requirements.push_back(
        unit_of_bound(wanted.text, problem.outputs[static_cast<std::size_t>(wanted.output)].unit));
  for (const auto& aim : problem.aims) {
    units.aims.push_back({aim.unit, 1.0});
    if (aim.change >= 0) units.aims.back() = units.changes[static_cast<std::size_t>(aim.change)];
    for (std::size_t k = 0; k < problem.requirements.size(); ++k)
      if (problem.requirements[k].output == aim.output) units.aims.back() = units.requirements[k];
  }
  return units;
}

std::string changes_text(const tasks::DesignJob& job, const study::DesignResult& result,
                         const Units& units, const TableStyle& style) {
  Table table({"<changed", "unit", "present", "design", "from", "to"});
  for (std::size_t k = 0; k < job.problem.changes.size(); ++k) {
    const auto& change = job.problem.changes[k];
    const auto& [unit, size] = units.changes[k];
    table.add_row({change.name, unit, number_text(result.present.values[k] / size),
                   number_text(result.best.values[k] / size),
                   number_text(change.distribution.a / size),
                   number_text(change.distribution.b / size)});
  }
  return table.text(style);
}

std::string requirements_text(const tasks::DesignJob& job, const study::DesignResult& result,
                              const Units& units, const TableStyle& style) {
  Table table({"<aim or requirement", "unit", "present", "design", "<worst at", "<"});
  const auto& problem = job.problem;
  for (std::size_t k = 0; k < problem.aims.size(); ++k)
    table.add_row({problem.aims[k].text, units.aims[k].name,
                   number_text(result.present.aims[k] / units.aims[k].size),
                   number_text(result.best.aims[k] / units.aims[k].size)});
  for (std::size_t k = 0; k < problem.requirements.size(); ++k) {
    const auto& wanted = problem.requirements[k];
    const double value = result.best.worst[k];
    const bool met = wanted.at_least ? value >= wanted.bound : value <= wanted.bound;
    const auto& [unit, size] = units.requirements[k];
    table.add_row({wanted.text, unit, number_text(result.present.worst[k] / size),
                   number_text(value / size),
                   problem.poses[static_cast<std::size_t>(result.best.pose[k])].name,
                   met ? "met" : "missed"});
  }
  return "\n" + table.text(style);
}

std::string limit_text(const study::DesignProblem& problem, const Units& units,
                       const study::Limit& limit) {
  using Kind = study::Limit::Kind;
  const auto& aim = problem.aims.front();
  const auto price = [&](const model::WrittenUnit& unit) {
    if (!limit.price) return std::string();
    const auto& own = units.aims.front();
    return fmt::format("; {} changes by {:.4g} {} per {}", aim.name,
                       *limit.price * unit.size / own.size, own.name == "1" ? "" : own.name,
                       unit.name == "1" ? "unit of it" : unit.name);
  };
  const auto* change =
      limit.change < 0 ? nullptr : &problem.changes[static_cast<std::size_t>(limit.change)];
  const auto* wanted = limit.requirement < 0
                           ? nullptr
                           : &problem.requirements[static_cast<std::size_t>(limit.requirement)];
  const auto bound = static_cast<std::size_t>(limit.requirement);
  if (limit.kind == Kind::requirement)
    return fmt::format("{} at pose {}{}", wanted->text,
                       problem.poses[static_cast<std::size_t>(limit.pose)].name,
                       price(units.requirements[bound]));
  if (limit.kind != Kind::jump)
    return fmt::format("{} is at its {} bound{}", change->name,
                       limit.kind == Kind::lower_bound ? "lower" : "upper",
                       aim.change == limit.change
                           ? ""
                           : price(units.changes[static_cast<std::size_t>(limit.change)]));
  if (wanted == nullptr)
    return fmt::format(
        "a little beyond this value of {} the machine has no modes at one of the "
        "poses (not allowed, out of reach, no equilibrium or buckled)",
        change->name);
  const auto& output = problem.outputs[static_cast<std::size_t>(wanted->output)];
  return fmt::format(
      "{} jumps to {:.5g} {} a little beyond this value of {}, at pose {}: another "
      "mode becomes the one that counts",
      output.name, limit.beyond / units.requirements[bound].size, units.requirements[bound].name,
      change->name, problem.poses[static_cast<std::size_t>(limit.pose)].name);
}

std::string limits_text(const study::DesignProblem& problem, const study::DesignResult& result,
                        const Units& units) {
  if (!result.best.feasible || !result.front.empty() || result.interrupted) return {};
  if (result.limits.empty())
    return "\nNo requirement and no bound is active: an optimum between the bounds\n";
  std::string text = "\nWhat limits the aim:\n";
  for (const auto& limit : result.limits) text += "  " + limit_text(problem, units, limit) + "\n";
  return text;
}

std::string front_text(const study::DesignProblem& problem, const study::DesignResult& result,
                       const Units& units, const TableStyle& style) {
  if (result.front.empty()) return {};
  std::vector<Column> columns;
  for (std::size_t k = 0; k < problem.aims.size(); ++k)
    columns.emplace_back(fmt::format("{} [{}]", problem.aims[k].name, units.aims[k].name));
  const auto is_aim = [&](const study::Input& change) {
    return std::ranges::count(problem.aims, change.name, &study::Aim::name) > 0;
  };
  for (std::size_t k = 0; k < problem.changes.size(); ++k)
    if (!is_aim(problem.changes[k]))
      columns.emplace_back(fmt::format("{} [{}]", problem.changes[k].name, units.changes[k].name));
  Table table(columns);
  for (const auto& point : result.front) {
    std::vector<std::string> cells;
    for (std::size_t k = 0; k < point.aims.size(); ++k)
      cells.push_back(number_text(point.aims[k] / units.aims[k].size));
    for (std::size_t k = 0; k < point.values.size(); ++k)
      if (!is_aim(problem.changes[k]))
        cells.push_back(number_text(point.values[k] / units.changes[k].size));
    table.add_row(cells);
  }
  return "\nTrade-off: no design was found that is better in both aims\n" + table.text(style) +
         "\nThe design above is the point nearest to the best of both aims, each as a share of its "
         "range\n";
}

std::string reach_text(const study::DesignProblem& problem, const study::DesignResult& result,
                       const Units& units) {
  if (result.reach.empty()) return {};
  std::string text = fmt::format(
      "\nNo design was found that meets all requirements, among {} that were evaluated\n",
      result.evaluations);
  constexpr std::array words{"computed", "with a number that the machine cannot have",
                             "out of reach at a pose", "without equilibrium at a pose",
                             "buckled at a pose"};
  for (std::size_t k = 1; k < words.size(); ++k)
    if (result.statuses[k] > 0)
      text += fmt::format("  {} of {} samples {}\n", result.statuses[k], result.samples, words[k]);
  bool each = true;
  for (std::size_t k = 0; k < result.reach.size(); ++k) {
    const auto& wanted = problem.requirements[k];
    const auto& reach = result.reach[k];
    const auto& output = problem.outputs[static_cast<std::size_t>(wanted.output)];
    each = each && reach.enough;
    text += std::isfinite(reach.value)
                ? fmt::format("  {}: without the other requirements {} comes to {} {:.5g} {}\n",
                              wanted.text, output.name, wanted.at_least ? "at most" : "at least",
                              reach.value / units.requirements[k].size, units.requirements[k].name)
                : fmt::format("  {}: {} has a value in no design that was evaluated\n", wanted.text,
                              output.name);
  }
  if (each)
    text +=
        "  each can be met alone, not all of them together; the table shows the least "
        "violation that was found\n";
  return text;
}

std::string report_text(const tasks::DesignJob& job, const study::DesignResult& result) {
  const auto style = table_style("-");
  const auto units = units_of(job);
  std::string poses;
  for (const auto& pose : job.problem.poses) poses += (poses.empty() ? "" : ", ") + pose.name;
  return fmt::format(
             "{}, {} {}, {} model\n{}{}{} designs, each at every pose; {} of {} samples "
             "meet the requirements\n\n",
             bold(job.machine.file.machine.name, style),
             job.problem.poses.size() == 1 ? "pose" : "poses", poses,
             dynamics::name(job.machine.kind), mechanics_state_line(job.machine.file),
             frequencies_line(job.machine.file.machine), result.evaluations,
             result.feasible_samples, result.samples) +
         changes_text(job, result, units, style) + requirements_text(job, result, units, style) +
         limits_text(job.problem, result, units) + front_text(job.problem, result, units, style) +
         reach_text(job.problem, result, units);
}

void plot(const Arguments& arguments, const tasks::DesignJob& job,
          const study::DesignResult& result, const std::string& path) {
  const auto& problem = job.problem;
  const std::string subtitle =
      fmt::format("{} {}, {} model; machine: {}; {} frequencies", problem.poses.size(),
                  problem.poses.size() == 1 ? "pose" : "poses", dynamics::name(job.machine.kind),
                  report::mechanics_state_text(job.machine.file),
                  study::frequency_kind(job.machine.file.machine));
  const auto units = units_of(job);
  if (!result.front.empty())
    return report::plot_trade_off(problem, result, units,
                                  fmt::format("{}: {} against {}", job.machine.file.machine.name,
                                              problem.aims[0].text, problem.aims[1].text),
                                  subtitle, path);
  if (problem.requirements.empty())
    base::refuse("--plot " + arguments.plot,
                 "shows requirements or two aims, and there are neither");
  constexpr int points = 161;
  report::plot_design_slices(
      problem, result, units, design_slices(problem, result.best, points),
      fmt::format("{}: {}", job.machine.file.machine.name, problem.aims[0].text), subtitle, path);
}

void run(const Arguments& arguments) {
  const auto format = choose_word("--format", arguments.format, {"table", "json"});
  if (arguments.output == "-")
    base::refuse("-o -", "the report goes to the standard output; give a file");
  require_ending("-o of design", arguments.output, ".toml");
  if (!arguments.plot.empty()) report::require_picture_ending(arguments.plot);
  const auto machine = load(arguments.machine);
  const auto job = tasks::prepare_design(machine, options_of(arguments, machine.file.machine));
  const auto done = with_progress("designs", [&](const numerics::Progress& progress) {
    return tasks::run_design(job,
                             {.samples = arguments.samples,
                              .seed = arguments.seed,
                              .starts = arguments.starts,
                              .front = arguments.trade_off.value_or(11),
                              .threads = arguments.threads},
                             progress);
  });
  const auto& result = done.result;
  auto head = report::head_json("design", machine.file, machine.path);
  head["model"] = dynamics::name(machine.kind);
  print_text(format == 0 ? report_text(job, result)
                         : json_text(head, report::design_json(job.problem, result)));
  if (!arguments.output.empty() && !done.text.empty()) write_output(arguments.output, done.text);
  draw(arguments.plot, [&](const auto& path) { plot(arguments, job, result, path); });
  if (result.interrupted)
    throw base::ComputationError(
        fmt::format("interrupted: this is the best of {} designs", result.evaluations));
  if (!result.best.feasible)
    throw base::ComputationError(
        arguments.output.empty()
            ? "no design was found that meets all requirements"
            : fmt::format("no design was found that meets all requirements; {} is not written",
                          arguments.output));
}

}  // namespace

void add_design(Command app) {
  Command command = app.add_command(
      "design",
      "Numbers of a machine that meet requirements at every pose with the least or largest aim",
      {{"design machine.toml --change \"legs.guide_sleeve.stiffness=1:50 kN/mm\" --want \"x >= 6 "
        "Hz\" --minimise legs.guide_sleeve.stiffness -o design.toml",
        "softest seals that are stiff enough"},
       {"design machine.toml --poses all --change \"platform.mass=800:1200 kg\" --want \"drop <= 2 "
        "%\" --maximise platform.mass",
        "worst case over all poses of the file"},
       {"design machine.toml --change \"legs.guide_sleeve.stiffness=1:50 kN/mm\" --change "
        "\"platform.mass=800:1200 kg\" --maximise lowest --maximise platform.mass --plot front.svg",
        "trade-off between two aims"}},
      study_frequencies);
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  command.add_options(
      {{"--pose", arguments.poses,
        "Pose of the file, or displacements \"z=50 mm\"; may be repeated: the worst counts",
        one_each},
       {"--poses", arguments.all_poses, "all: every pose of the file"}});
  add_model_option(command, arguments.machine);
  command.add_options(
      {{"--change", arguments.change,
        "PATH=from:to, a number that may change and its bounds; may be repeated",
        one_each_as("PATH=RANGE")},
       {"--want", arguments.want, "Requirement for an output: \"x >= 6 Hz\"; may be repeated",
        one_each},
       {"--minimise", arguments.minimise, "Output or changed number that is to be small", one_each},
       {"--maximise", arguments.maximise, "Output or changed number that is to be large", one_each},
       {"--trade-off", arguments.trade_off, "Points of the curve between two aims; default: 11",
        range(3, 1000)},
       {"--samples", arguments.samples, "Sobol points at which the search begins",
        range(std::uint64_t{16}, std::uint64_t{10000000})},
       {"--starts", arguments.starts, "Local searches from the best samples", range(1, 1000)},
       {"--seed", arguments.seed, "Seed of the Sobol points"},
       {"--threads", arguments.threads, "Threads; default: one per processor", range(0, 1024)},
       {"-o,--output", arguments.output, "Machine file of the design; comments are kept", writes},
       {"--format", arguments.format, "Report as table or json"},
       {"--plot", arguments.plot,
        "Requirements over each change, or the trade-off: .svg, .png or .pdf", writes}});
}

}  // namespace hydrapod::cli
