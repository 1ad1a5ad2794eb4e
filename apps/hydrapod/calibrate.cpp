#include "hydrapod/command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <optional>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/tasks/measurement.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::string targets{};
  std::vector<std::string> free{}, priors{}, tries{}, profiles{};
  std::string loss{};
  int starts{};
  std::uint64_t seed{};
  int threads{};
  std::string output{};
  std::string format{"table"};
  std::string plot{};
};

/// PATH[,PATH…][=LOW..HIGH]
calibration::FreeParameter free_parameter(const std::string& text) {
  const auto equals = text.find('=');
  calibration::FreeParameter free{.paths = base::split(text.substr(0, equals), ","),
                                  .origin = {.file = "--free " + text}};
  if (equals == std::string::npos) return free;
  const auto bounds = base::split(text.substr(equals + 1), "..");
  if (bounds.size() != 2 || bounds[0].empty() || bounds[1].empty())
    base::refuse("--free " + text,
                 "expected PATH or PATH=LOWEST..HIGHEST, for instance "
                 "\"legs.rod.mass=1 kg..20 kg\"");
  free.lower = bounds[0];
  free.upper = bounds[1];
  return free;
}

/// PATH=VALUE+-SPREAD, or with ±
tasks::KnownParameter prior(const std::string& text) {
  const auto equals = text.find('=');
  const std::string right = equals == std::string::npos ? "" : text.substr(equals + 1);
  auto parts = base::split(right, "+-");
  if (parts.size() != 2) parts = base::split(right, "±");
  if (parts.size() != 2)
    base::refuse("--prior " + text,
                 "expected PATH=VALUE+-SPREAD, for instance \"legs.rod.mass=22 kg+-2 kg\"");
  return {std::string(base::trimmed(text.substr(0, equals))), {parts[0], parts[1]}};
}

/// PATH=VALUE[; PATH=VALUE…], to be tried and left alone
calibration::Alternative alternative(const std::string& text) {
  calibration::Alternative made{.name = "with " + text, .origin = {.file = "--try " + text}};
  made.choices = {{"no", {}}, {"yes", base::split(text, ";")}};
  return made;
}

tasks::CalibrateOptions options_of(const Arguments& arguments) {
  tasks::CalibrateOptions options{.targets = arguments.targets, .profiles = arguments.profiles};
  auto& plan = options.plan;
  for (const auto& text : arguments.free) plan.free.push_back(free_parameter(text));
  for (const auto& text : arguments.priors) options.priors.push_back(prior(text));
  for (const auto& text : arguments.tries) plan.alternatives.push_back(alternative(text));
  if (arguments.starts > 0) options.starts = arguments.starts;
  if (arguments.seed > 0) options.seed = arguments.seed;
  if (!arguments.loss.empty())
    options.loss = static_cast<calibration::Loss>(
        choose_word("--loss", arguments.loss, {"automatic", "squares", "cauchy"}));
  plan.options.threads = arguments.threads;
  return options;
}

std::string calibration_json(const tasks::Machine& machine, const tasks::Calibrated& found) {
  auto head = report::head_json("calibration", machine.file, machine.path);
  head["model"] = dynamics::name(machine.kind);
  auto json = report::calibration_json(found.result, found.targets);
  json["profiles"] = report::Json::array();
  for (const auto& profile : found.profiles)
    json["profiles"].push_back(report::profile_json(profile, found.result.best()));
  return json_text(head, json);
}

void run(const Arguments& arguments) {
  const auto format = choose_word("--format", arguments.format, {"table", "json"});
  if (arguments.output == "-")
    base::refuse("-o -", "the report goes to the standard output; give a file");
  require_ending("-o of calibrate", arguments.output, ".toml");
  if (!arguments.plot.empty()) report::require_picture_ending(arguments.plot);
  const auto machine = load(arguments.machine);
  const auto options = options_of(arguments);
  const auto found = with_progress("calibrating", [&](const auto& progress) {
    return tasks::calibrate(machine, options, progress);
  });
  print_diagnostics(found.warnings);
  print_text(format == 0 ? machine.file.machine.name + "\n" + state_line(machine.file) + "\n" +
                               calibration_text(found.result, found.targets, found.profiles,
                                                machine.file.text, table_style("-"))
                         : calibration_json(machine, found));
  draw(arguments.plot, [&](const auto& path) {
    report::plot_calibration(
        found.result, found.targets,
        {.title = machine.file.machine.name + ": " + found.targets.title,
         .subtitle = "machine: " + report::state_text(machine.file) + "; fitted"},
        path);
  });
  const auto& best = found.result.best();
  if (arguments.output.empty())
    calibration::require_possible_targets(best, found.targets);
  else
    write_output(arguments.output, calibration::calibrated_text(machine.file, best, found.targets));
  if (found.interrupted)
    throw base::ComputationError(
        fmt::format("interrupted: the report{} the best so far",
                    arguments.output.empty() ? " shows" : " and " + arguments.output + " hold"));
}

}  // namespace

void add_calibrate(Command app) {
  Command command = app.add_command(
      "calibrate", "Fit parameters of a machine file to measured or published modes",
      {{"calibrate machine.toml --targets modes.csv --free legs.guide_sleeve.stiffness "
        "-o calibrated.toml",
        "stiffness of the guide sleeves from measured frequencies"},
       {"calibrate machine.toml --targets modes.toml --free \"legs.rod.mass=5 kg..30 kg\" --prior "
        "\"legs.rod.mass=22 kg+-2 kg\"",
        "with bounds and prior knowledge"},
       {"calibrate machine.toml --targets modes.toml --try model.flexible_axes=gimbal",
        "two alternatives"}});
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  add_model_option(command, arguments.machine);
  command.add_options(
      {{"--targets", arguments.targets, "Target modes, TOML or CSV (docs/howto/calibrate.md)",
        reads_required},
       {"--free", arguments.free,
        "Free parameter: PATH or PATH=LOWEST..HIGHEST; PATH,PATH ties several to one "
        "value; may be repeated"},
       {"--prior", arguments.priors,
        "Prior of a free parameter: PATH=VALUE+-SPREAD; may be repeated"},
       {"--try", arguments.tries,
        "Alternative: PATH=VALUE[; PATH=VALUE]; fits with and without it; may be "
        "repeated, all combinations are fitted"},
       {"--profile", arguments.profiles,
        "Also compute the misfit as a function of this parameter, with all others fitted"},
       {"--loss", arguments.loss, "automatic, squares, or cauchy (little weight of outliers)"},
       {"--starts", arguments.starts, "Starts per combination, all but one random",
        range(1, 10000)},
       {"--seed", arguments.seed, "Seed of the random starts",
        range(std::uint64_t{1}, std::uint64_t{1000000000000})},
       {"--threads", arguments.threads, "Threads; 0: one per core", range(0, 256)},
       {"-o,--output", arguments.output, "Calibrated machine file to write; comments are kept",
        writes},
       {"--format", arguments.format, "Report as table or json"},
       {"--plot", arguments.plot, "Picture of targets and model to write: .svg, .png or .pdf",
        writes}});
  command.add_extent_options();
}

}  // namespace hydrapod::cli
