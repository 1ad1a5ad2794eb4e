/// `hydrapod montecarlo`, `sweep` and `map`: one machinery, three ways to place samples.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <span>

#include "hydrapod/base/text.hpp"
#include "hydrapod/command.hpp"
#include "hydrapod/model/section.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/study_picture.hpp"
#include "hydrapod/study_rows.hpp"
#include "hydrapod/study_text.hpp"
#include "hydrapod/tasks/study.hpp"
#include "hydrapod/team.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> vary{}, over{}, worst_over{}, correlate{}, want{}, only{}, also{},
      command{};
  std::string until{};
  std::string samples{}, seed{};
  std::string design{};
  bool indices{}, buckling{}, resume{}, join{}, poses{}, no_mpi{}, force{};
  int threads{}, modes{6}, refine{};
  std::string shard{}, format{}, output{"-"}, results{"study.h5"}, csv{}, worst{}, plot{};
  std::string value{"lowest"};
};

tasks::Varied varied(const std::string& option, const std::string& text) {
  const auto at = text.find('=');
  const std::string place = fmt::format("{} \"{}\"", option, base::printable(text, 100));
  if (at == std::string::npos || at == 0)
    base::refuse(place, option == "--vary" ? "expected PATH=DISTRIBUTION, for instance "
                                             "legs.guide_sleeve.stiffness=\"normal ± 10 %\""
                                           : "expected PATH=from:to:count, or PATH= and a list");
  return {std::string(base::trimmed(text.substr(0, at))),
          std::string(base::trimmed(text.substr(at + 1))), place};
}

std::pair<int, int> shard_of(const std::string& text, bool join) {
  if (text.empty()) return {1, 1};
  const auto parts = base::split(text, "/");
  const auto number = [](std::string_view part) {
    constexpr int most = 100000;
    int value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return error == std::errc{} && end == part.data() + part.size() && value >= 1 && value <= most
               ? value
               : 0;
  };
  if (join && parts.size() == 1 && number(parts[0]) > 0) return {1, number(parts[0])};
  const int part = parts.size() == 2 ? number(parts[0]) : 0;
  const int all = parts.size() == 2 ? number(parts[1]) : 0;
  if (part < 1 || all < part) base::refuse("--shard " + text, "expected i/n with 1 ≤ i ≤ n");
  return {part, all};
}

std::vector<NamedFile> outputs_of(const Arguments& arguments) {
  return {{"--results", arguments.results},
          {"--csv", arguments.csv},
          {"--worst", arguments.worst},
          {"--plot", arguments.plot},
          {"-o", arguments.output}};
}

/// Machine files have none of these tables and names.
bool is_study_file(const std::string& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;
  const auto text = base::read_file(path, 1U << 20U, "a machine or study file");
  const auto parsed = model::parse_tree(text, 0);
  if (const auto* root = std::get_if<model::Node>(&parsed))
    return root->find("vary") != nullptr || root->find("machine") != nullptr;
  return text.find("\n[vary]") != std::string::npos || text.starts_with("[vary]");
}

/// What a study file says goes below what the command line says.
void take_study_file(Arguments& arguments, tasks::StudyOptions& options) {
  const std::string path = arguments.machine.file;
  if (!is_study_file(path)) return;
  const auto study = study::read_study_file(path);
  if (!study.machine)
    base::refuse(path,
                 "has no `machine`; expected the path of a machine file, from the study file");
  arguments.machine.file =
      (std::filesystem::path(path).parent_path() / *study.machine).lexically_normal().string();
  const NamedFile machine{"machine of " + path, arguments.machine.file};
  check_outputs({machine}, outputs_of(arguments), true);
  note_input(machine.option, machine.path);
  arguments.machine.overrides.insert(arguments.machine.overrides.begin(), study.set.begin(),
                                     study.set.end());
  if (study.pose && arguments.machine.pose == "neutral") arguments.machine.pose = *study.pose;
  for (const auto& given : study.vary) options.vary.push_back({given.key, given.text, given.place});
  for (const auto& given : study.want) options.want.push_back(given.text);
  for (const auto& given : study.correlate) options.correlate.push_back({given.text, given.place});
  for (const auto& name : study.only) options.only.push_back({name, path + ": only"});
  for (const auto& name : study.also) options.also.push_back({name, path + ": also"});
  options.commands = study.command;
  options.until = study.until;
  if (arguments.samples.empty() && study.samples)
    arguments.samples = std::to_string(*study.samples);
  if (arguments.seed.empty() && study.seed) arguments.seed = std::to_string(*study.seed);
  if (study.design && arguments.design.empty()) options.plan.design = *study.design;
  arguments.indices = arguments.indices || study.indices;
  arguments.buckling = arguments.buckling || study.buckling;
}

/// Of an output that is named although there is no picture, what is wrong with it is said.
bool shows_value(const Arguments& arguments) {
  return !arguments.plot.empty() || arguments.value != Arguments{}.value;
}

/// A picture has the end of the stroke besides its output.
void add_what_is_shown(const Arguments& arguments, const tasks::Machine& machine,
                       std::vector<tasks::Asked>& only) {
  if (shows_value(arguments))
    only.push_back({arguments.value, "--value " + base::printable(arguments.value)});
  if (!arguments.plot.empty() &&
      !study::why_no_output(machine.file.machine, machine.kind, "stroke"))
    only.push_back({"stroke", "--plot"});
}

/// What is asked of the results, looked at before the work begins.
void require_results(const Arguments& arguments, const tasks::StudyJob& job) {
  const bool grid = job.plan.design == study::Design::grid;
  const auto& outputs = job.problem.outputs;
  if (grid && !arguments.samples.empty())
    base::refuse("--samples " + arguments.samples,
                 fmt::format("a grid has one row per point, here {}; leave it out", job.rows));
  if (!arguments.worst.empty() && job.requirements.empty())
    base::refuse("--worst " + arguments.worst,
                 "which sample is worst follows from the first --want");
  if (shows_value(arguments) &&
      std::ranges::find(outputs, arguments.value, &study::Column::name) == outputs.end()) {
    std::vector<std::string_view> names;
    for (const auto& output : outputs) names.push_back(output.name);
    const auto why =
        study::why_no_output(job.machine.file.machine, job.machine.kind, arguments.value);
    base::refuse(
        "--value " + arguments.value,
        why.value_or(fmt::format("unknown output; accepted are {}", fmt::join(names, ", "))));
  }
  if (arguments.plot.empty()) {
    if (arguments.value != Arguments{}.value)
      base::refuse("--value " + arguments.value, "is what --plot shows; add --plot FILE");
    return;
  }
  if (job.problem.inputs.size() != 2 || !grid)
    base::refuse("--plot " + arguments.plot, "a heat map needs a grid over exactly two inputs");
}

void write_worst(const tasks::StudyJob& job, const study::Summary& summary,
                 const std::string& path) {
  if (!summary.requirements.front().worst)
    base::refuse("--worst " + path, "no sample was computed");
  const auto values = tasks::study_row(job, *summary.requirements.front().worst);
  write_output(path, study::machine_text(job.machine.file, job.problem.inputs,
                                         std::span(values).first(job.problem.inputs.size()),
                                         "worst sample"));
}

/// Which motion every sample makes; of none empty.
std::string motion_line(const tasks::StudyJob& job) {
  return job.commands.empty() ? std::string()
                              : fmt::format("motion: {}\n", fmt::join(job.commands, "; "));
}

void report_study(const Arguments& arguments, const tasks::StudyJob& job,
                  const tasks::StudyDone& done, StudyRows& rows, std::size_t format,
                  const char* kind, int ranks) {
  const auto& run = done.run;
  if (run.seconds > 0.0)
    print_note(fmt::format("{} rows in {:.3g} s{}, {:.4g} rows/s; {} computed one at a time",
                           run.done - run.resumed, run.seconds,
                           ranks > 1
                               ? fmt::format(" by {} ranks ({} hand-outs, {:.3g} s of rank 0)",
                                             ranks, run.handed_out, run.serving)
                               : "",
                           static_cast<double>(run.done - run.resumed) / run.seconds, run.alone));
  if (!done.summary) return print_written(done.rows_file);
  print_written(arguments.results);
  rows.close_csv(done.complete);
  if (!arguments.worst.empty()) write_worst(job, *done.summary, arguments.worst);
  draw(arguments.plot,
       [&](const auto& path) { plot_map(job, arguments.over, arguments.value, rows, path); });
  const auto style = table_style(arguments.output);
  const auto no_drop = study::why_no_output(job.machine.file.machine, job.machine.kind, "drop");
  if (format == 1)
    return write_output(
        arguments.output,
        json_text(head_of_model(kind, job.machine),
                  report::study_json(job.problem, job.plan, job.requirements, *done.summary)));
  write_result(arguments.output, format,
               fmt::format("{}, pose {}, {} model\n{}{}{}"
                           "{} rows, seed {}\n\n",
                           bold(job.machine.file.machine.name, style), job.machine.pose.name,
                           dynamics::name(job.machine.kind), mechanics_state_line(job.machine.file),
                           frequencies_line(job.machine.file.machine), motion_line(job),
                           done.summary->rows, job.plan.seed) +
                   summary_text(job, *done.summary, style) +
                   (no_drop ? fmt::format("\nLeft out: drop {}.\n", *no_drop) : "") + "\n" +
                   extremes_text(job, *done.summary) + worst_text(job, *done.summary));
}

/// What stands in a study file counts where the command line says nothing: so it is read here.
std::uint64_t whole_number(const std::string& option, const std::string& text, std::uint64_t least,
                           std::uint64_t otherwise) {
  if (text.empty()) return otherwise;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    base::refuse(option + " " + text, "expected a whole number");
  if (value < least) base::refuse(option + " " + text, fmt::format("must be at least {}", least));
  return value;
}

tasks::StudyOptions options_of(Arguments& arguments, study::Design design, const char* kind) {
  tasks::StudyOptions options{.poses = arguments.poses};
  options.plan.design = design;
  if (!arguments.design.empty())
    options.plan.design = static_cast<study::Design>(
        choose_word("--design", arguments.design, {"random", "latin", "sobol", "grid"}));
  if (kind == std::string_view("montecarlo"))
    take_study_file(arguments, options);
  else if (is_study_file(arguments.machine.file))
    base::refuse(
        arguments.machine.file,
        fmt::format("is a study file, which `hydrapod montecarlo` reads; {} takes a machine "
                    "file and --over",
                    kind));
  for (const auto& text : arguments.vary) options.vary.push_back(varied("--vary", text));
  for (const auto& text : arguments.over) options.over.push_back(varied("--over", text));
  for (const auto& text : arguments.worst_over)
    options.worst_over.push_back(varied("--worst-over", text));
  for (const auto& text : arguments.correlate)
    options.correlate.push_back(
        {text, fmt::format("--correlate \"{}\"", base::printable(text, 100))});
  for (const auto& name : arguments.only)
    options.only.push_back({name, "--only " + base::printable(name)});
  for (const auto& name : arguments.also)
    options.also.push_back({name, "--also " + base::printable(name)});
  if (arguments.buckling) options.also.push_back({"buckling", "--buckling"});
  if (!arguments.command.empty()) options.commands = arguments.command;
  if (!arguments.until.empty())
    options.until =
        positive_quantity("--until", arguments.until, "s", "expected a time of more than 0 s");
  options.want.insert(options.want.end(), arguments.want.begin(), arguments.want.end());
  if (options.vary.empty() && options.over.empty())
    base::refuse(kind == std::string_view("montecarlo") ? "--vary" : "--over",
                 "is missing: nothing would vary; see --help for examples");
  options.plan.samples = whole_number("--samples", arguments.samples, 2, 10000);
  options.plan.seed = whole_number("--seed", arguments.seed, 0, 1);
  options.plan.indices = arguments.indices;
  options.modes = arguments.modes;
  return options;
}

/// Before work that people wait for.
void say_effort(const tasks::StudyJob& job, const tasks::StudyRunOptions& options) {
  constexpr double noticed = 10.0;  // [s]
  if (options.join || (options.team != nullptr && options.team->rank() > 0)) return;
  const auto effort = tasks::study_effort(job, options);
  if (effort.seconds > noticed) print_note(effort.text);
}

/// Halves intervals of the grid, as often as is asked for, and says which input got how many
/// values.
void refine(const Arguments& arguments, bool is_first_rank, tasks::StudyJob& job) {
  if (arguments.refine == 0) return;
  if (job.plan.design != study::Design::grid)
    base::refuse(fmt::format("--refine {}", arguments.refine),
                 "halves intervals of a grid; leave --design out");
  const auto added = with_progress("refining", [&](const numerics::Progress& progress) {
    return tasks::refine_grid(job, arguments.refine, progress, {.threads = arguments.threads});
  });
  if (!is_first_rank) return;
  if (std::ranges::all_of(added, [](int count) { return count == 0; }))
    print_note(
        "from value to value the followed modes keep their order and shapes: the grid stays as it "
        "is");
  for (std::size_t k = 0; k < added.size(); ++k)
    if (added[k] > 0)
      print_note(fmt::format("{}: {} values became {}, between which modes cross or veer",
                             job.problem.inputs[k].name, job.plan.counts[k] - added[k],
                             job.plan.counts[k]));
}

void run_with(Arguments arguments, study::Design design, const char* kind) {
  const auto team = arguments.no_mpi ? nullptr : team_of_ranks();
  std::size_t format = 0;
  tasks::StudyRunOptions running{.team = team.get()};
  const auto job = together(team.get(), [&] {
    format = result_format(arguments.format, arguments.output, {"table", "json"});
    auto options = options_of(arguments, design, kind);
    const auto [shard, shards] = shard_of(arguments.shard, arguments.join);
    require_ending("--results", arguments.results, "h5");
    require_ending("--csv", arguments.csv, "csv");
    require_ending("--worst", arguments.worst, ".toml");
    running.output = arguments.results;
    running.command = study_command();
    running.resume = arguments.resume;
    running.replace_rows = arguments.force;
    running.replace_results = arguments.force || arguments.results == Arguments{}.results;
    running.threads = arguments.threads;
    running.shard = shard;
    running.shards = shards;
    running.join = arguments.join;
    const auto machine = load(arguments.machine);
    const auto extra = study::extra_outputs(machine.file.machine, machine.kind);
    if (std::ranges::count(extra, arguments.value, &study::Column::name) > 0)
      options.also.push_back({arguments.value, "--value " + arguments.value});
    if (!options.only.empty()) add_what_is_shown(arguments, machine, options.only);
    auto prepared = tasks::prepare_study(machine, options);
    require_results(arguments, prepared);
    refine(arguments, !team || team->rank() == 0, prepared);
    tasks::check_run(prepared, running);
    return prepared;
  });
  StudyRows rows(job, arguments.csv, arguments.plot.empty() ? "" : arguments.value,
                 comments_of(job, running.command));
  for (const auto& warning : job.warnings) print_note("warning: " + warning);
  say_effort(job, running);
  if (rows.are_wanted()) running.take = [&](std::span<const double> some) { rows.take(some); };
  const auto done = with_progress(
      "samples",
      [&](const numerics::Progress& progress) { return tasks::run_study(job, running, progress); },
      static_cast<double>(job.rows));
  if (team && team->rank() > 0) return;
  report_study(arguments, job, done, rows, format, kind, team ? team->size() : 1);
  const auto& run = done.run;
  if (!done.complete)
    throw base::ComputationError(
        fmt::format("interrupted after {} of {} rows ({:.3g} %); the same command with "
                    "--resume goes on",
                    run.done, run.count,
                    100.0 * static_cast<double>(run.done) / static_cast<double>(run.count)));
}

void add_common(Command command, Arguments& arguments) {
  command.add_options(
      {{"--want", arguments.want, "Requirement for an output: \"x >= 6 Hz\"; may be repeated",
        one_each},
       {"--samples", arguments.samples, "Number of samples (not of a grid); default: 10000",
        shown_as("NUMBER")},
       {"--seed", arguments.seed, "Seed; sample i depends on seed and i alone; default: 1",
        shown_as("NUMBER")},
       {"--only", arguments.only,
        "Output that is computed, and none that is not named: frequencies, modes, drops, x, …; may "
        "be repeated",
        one_each},
       {"--also", arguments.also,
        "Output that is computed where it is asked for: stiffness, force, sag, buckling, …; may be "
        "repeated",
        one_each},
       {"--buckling", arguments.buckling, "The same as --also buckling"},
       {"--command", arguments.command,
        "Motion that every sample makes, as of simulate: its errors, settling times, speeds; may "
        "be "
        "repeated",
        reads_each_as("COMMAND")},
       {"--until", arguments.until,
        "End of the motion, s or with a unit; default: shortly after it"},
       {"--modes", arguments.modes, "Platform modes that are followed by shape",
        range(1, dynamics::max_dof)},
       {"--threads", arguments.threads, "Threads; default: one per processor", range(1, 1024)},
       {"--resume", arguments.resume, "Go on with the rows of an interrupted run"},
       {"--shard", arguments.shard, "i/n: compute part i of n; with --join: n"},
       {"--join", arguments.join, "Put the parts of --shard together instead of computing"},
       {"--no-mpi", arguments.no_mpi, "Run alone, also where mpirun has started the program"},
       {"--results", arguments.results,
        "HDF5 file of all rows; study.h5 is replaced, another file that exists with --force only"},
       {"--csv", arguments.csv, "All rows as CSV too", writes},
       {"--format", arguments.format, "table or json; default: by the ending of -o, else table"},
       {"-o,--output", arguments.output, "File of the summary; - prints", writes}});
  command.also_writes(
      [&arguments] {
        const bool goes_on = arguments.resume || arguments.join || !arguments.shard.empty();
        const bool is_named = arguments.results != Arguments{}.results;
        return std::vector<NamedFile>{{"--results", arguments.results,
                                       is_named && !goes_on ? Existing::kept : Existing::judged}};
      },
      &arguments.force);
}

void run_montecarlo(const Arguments& arguments) {
  run_with(arguments, study::Design::random, "montecarlo");
}
void run_sweep(const Arguments& arguments) { run_with(arguments, study::Design::grid, "sweep"); }
void run_map(const Arguments& given) {
  Arguments arguments = given;
  arguments.poses = true;
  run_with(arguments, study::Design::grid, "map");
}

}  // namespace

void add_montecarlo(Command app) {
  Command command = app.add_command(
      "montecarlo",
      "Scatter of parameters: distributions of modes, probability of missing a requirement",
      {{"montecarlo machine.toml --vary \"legs.guide_sleeve.stiffness=normal ± 10 % per leg\" "
        "--want \"x >= 6 Hz\"",
        "scatter of the seals"},
       {"montecarlo machine.toml --vary \"platform.mass=uniform 850 .. 950 kg\" --indices",
        "with Sobol indices"},
       {"montecarlo machine.toml --vary \"legs.guide_sleeve.stiffness=normal ± 10 % per leg "
        "correlated 0.7\"",
        "seals of one batch: their numbers are alike"},
       {"montecarlo study.toml --samples 1000 --results run.h5", "from a study file"}},
      study_frequencies);
  auto& arguments = command.calls(&run_montecarlo);
  add_subject_options(command, arguments.machine);
  command.add_options({{"--vary", arguments.vary,
                        "PATH=DISTRIBUTION (normal, lognormal, uniform, triangular); may "
                        "be repeated",
                        one_each_as("PATH=DISTRIBUTION")},
                       {"--correlate", arguments.correlate,
                        "\"PATH, PATH = 0.6\": correlation of two that vary; may be repeated",
                        one_each_as("PATH, PATH = NUMBER")},
                       {"--design", arguments.design, "random, latin or sobol"},
                       {"--indices", arguments.indices, "Sobol indices, with d + 2 rows a sample"},
                       {"--worst", arguments.worst,
                        "Machine file of the worst sample for the first --want", writes}});
  add_common(command, arguments);
}

void add_sweep(Command app) {
  Command command = app.add_command(
      "sweep", "Modes over a grid of parameters, or over values that fill it evenly",
      {{"sweep machine.toml --over \"legs.guide_sleeve.stiffness=2:20:10 kN/mm\"", "ten values"},
       {"sweep machine.toml --over \"platform.mass=800:1000 kg\" --design sobol --samples 4096",
        "a Sobol sequence"},
       {"sweep machine.toml --over \"platform.mass=700:900:3 kg\" --command \"step z=1 mm\" "
        "--until 1",
        "each value makes a step: error, overshoot, settling time"}},
      study_frequencies);
  auto& arguments = command.calls(&run_sweep);
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--over", arguments.over, "PATH=from:to:count, or PATH= and a list; may be repeated",
        one_each_as("PATH=RANGE")},
       {"--design", arguments.design, "grid, latin or sobol"},
       {"--refine", arguments.refine,
        "Halve intervals of the grid between which modes cross or veer, so many times",
        range(0, 12)},
       {"--plot", arguments.plot, "Heat map over two parameters, .svg, .png or .pdf", writes},
       {"--value", arguments.value, "Output that it shows"}});
  add_common(command, arguments);
}

void add_map(Command app) {
  Command command = app.add_command(
      "map", "Modes over the workspace",
      {{"map machine.toml --over \"x=-100:100:21 mm\" --over \"z=-100:100:21 mm\" --plot map.png",
        "lowest mode over x and z"},
       {"map machine.toml --over \"rx=-10:10:21 deg\" --over \"ry=-10:10:21 deg\" --want \"lowest "
        ">= 5 Hz\"",
        "poses below 5 Hz"},
       {"map machine.toml --over \"x=-50:50:11 mm\" --over \"z=-50:50:11 mm\" --worst-over "
        "\"rx=-5:5:3 deg\" --also stiffness",
        "lowest mode and stiffness over three inclinations"}},
      study_frequencies);
  auto& arguments = command.calls(&run_map);
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--over", arguments.over,
        "DIRECTION=from:to:count, from the pose; two or three of x, y, z, rx, ry, rz",
        one_each_as("RANGE")},
       {"--worst-over", arguments.worst_over,
        "DIRECTION=from:to:count or a list: every pose has the worst over these displacements; may "
        "be repeated",
        one_each_as("RANGE")},
       {"--refine", arguments.refine,
        "Halve intervals of the grid between which modes cross or veer, so many times",
        range(0, 12)},
       {"--plot", arguments.plot, "Heat map over two directions, .svg, .png or .pdf", writes},
       {"--value", arguments.value, "Output that it shows"}});
  add_common(command, arguments);
}

}  // namespace hydrapod::cli
