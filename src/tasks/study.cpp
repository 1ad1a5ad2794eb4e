#include "study_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>

#include "commanded_motion.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/data/modal_results.hpp"

namespace hydrapod::tasks {

namespace {

namespace fs = std::filesystem;

/// How many samples make a row.
double combinations_of(const study::Problem& problem) {
  double count = 1.0;
  if (problem.beneath)
    for (std::size_t k = problem.inputs.size(); k < problem.beneath->inputs.size(); ++k)
      count *= static_cast<double>(problem.beneath->inputs[k].distribution.list.size());
  return count;
}

/// Seconds a row takes without its motion, from the first ones.
double measured_seconds(const study::Problem& problem, const study::Plan& plan,
                        std::uint64_t rows) {
  constexpr std::uint64_t enough = 512, together = 64;
  constexpr double long_enough = 0.05;  // [s]
  const std::size_t inputs = problem.inputs.size();
  const study::Interruptible motions(problem, [] { return true; });  // end where they first look
  study::Evaluator evaluator(problem);
  const auto begun = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  };
  std::vector<double> numbers(together * (inputs + problem.outputs.size()));
  std::uint64_t done = 0;
  do {
    const auto now = std::min(rows - done, done == 0 ? 1 : together);
    evaluator.rows(plan, done, std::span(numbers).first(now * (inputs + problem.outputs.size())));
    done += now;
  } while (done < std::min(rows, enough) && passed() < long_enough);
  return passed() / static_cast<double>(done);
}

std::string shard_file(const std::string& output, int shard, int shards) {
  return shards == 1 ? output + ".rows" : fmt::format("{}.rows{}of{}", output, shard, shards);
}

/// Bytes of rows that are gone on with.
double bytes_there(const StudyRunOptions& options) {
  if (!options.resume) return 0.0;
  const auto rows_file = shard_file(options.output, options.shard, options.shards);
  auto files = study::rank_files(rows_file);
  files.push_back(rows_file);
  double sum = 0.0;
  for (const auto& file : files) {
    std::error_code none;
    const auto size = fs::file_size(file, none);
    if (!none) sum += static_cast<double>(size);
  }
  return sum;
}

void require_room(const StudyJob& job, const StudyRunOptions& options) {
  std::error_code unknown;
  const auto folder = fs::absolute(options.output).parent_path();
  const auto space = fs::space(folder, unknown);
  const auto effort = study_effort(job, options);
  if (unknown || effort.bytes < static_cast<double>(space.available)) return;
  throw base::ComputationError(
      fmt::format("{}; {} has {:.3g} GB left. Take fewer samples, or --shard i/n with one part on "
                  "each of many machines",
                  effort.text, folder.string(), static_cast<double>(space.available) / 1e9));
}

std::string dependences_of(const StudyJob& job) {
  std::string text =
      fmt::format("{}\n{}\n{}\n{}\n{}", base::version, job.machine.file.text,
                  dynamics::name(job.machine.kind), job.poses, fmt::join(job.commands, "\n"));
  for (const auto& one : job.machine.file.overrides) text += "\n" + one;
  const auto& X_BP = job.machine.pose.X_BP;
  for (int k = 0; k < 3; ++k) text += fmt::format("\n{}", X_BP.p_BP[k]);
  for (int k = 0; k < 9; ++k) text += fmt::format(" {}", X_BP.R_BP.data()[k]);
  return text;
}

std::uint64_t fingerprint_of(const StudyJob& job) {
  return study::fingerprint(job.problem, job.plan, dependences_of(job));
}

/// By which results are known as those of a study; see write_results().
std::string study_word(const StudyJob& job) {
  return fmt::format("hydrapod study {:016x}", fingerprint_of(job));
}

bool are_results_of(const StudyJob& job, const std::string& path) {
  constexpr std::size_t beginning = 1U << 16U;
  std::ifstream file(path, std::ios::binary);
  std::string text(beginning, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text.find(study_word(job)) != std::string::npos;
}

/// Results of another study stay: of a run that goes on or puts parts together nobody has looked
/// yet what stands there.
void check_results(const StudyJob& job, const StudyRunOptions& options) {
  const bool writes_them = options.join || options.shards == 1;
  std::error_code none;
  if (options.replace_results || !writes_them || !fs::exists(options.output, none)) return;
  if (!are_results_of(job, options.output))
    base::refuse(options.output,
                 "is a file of something else than this study and was left as it "
                 "is; choose another name, or --force to replace it");
}

void write_results(const StudyJob& job, const study::Spool& spool, const StudyRunOptions& options,
                   bool complete) {
  data::ColumnFile file{.rows = spool.rows(), .threads = options.threads, .study = study_word(job)};
  for (std::size_t k = 0; k < job.problem.inputs.size(); ++k)
    file.columns.push_back({job.input_column(k), job.problem.inputs[k].unit, "varied"});
  for (const auto& output : job.problem.outputs)
    file.columns.push_back({output.name, output.unit, output.meaning});
  file.texts = {{"machine", job.machine.file.text},
                {"overrides", fmt::format("{}", fmt::join(job.machine.file.overrides, "\n"))},
                {"pose", job.machine.pose.name},
                {"model", dynamics::name(job.machine.kind)},
                {"frequencies", study::frequency_kind(job.machine.file.machine)},
                {"program", fmt::format("hydrapod {}", base::version)}};
  if (!options.command.empty()) file.texts["command"] = options.command;
  if (!job.commands.empty())
    file.texts["motion"] = fmt::format("{}", fmt::join(job.commands, "\n"));
  if (job.problem.beneath) {
    auto& text = file.texts["worst_over"];
    for (const auto& input :
         std::span(job.problem.beneath->inputs).subspan(job.problem.inputs.size()))
      text += fmt::format("{} [{}]: {}\n", input.name, input.unit,
                          fmt::join(input.distribution.list, ", "));
  }
  file.numbers = {{"samples", static_cast<double>(job.plan.samples)},
                  {"seed", static_cast<double>(job.plan.seed)},
                  {"rows_planned", static_cast<double>(job.rows)},
                  {"complete", complete ? 1.0 : 0.0}};
  file.each_rows = [&](const std::function<void(std::span<const double>)>& take) {
    spool.each_chunk([&](std::uint64_t, std::span<const double> rows) { take(rows); });
  };
  data::write_columns(options.output, file);
}

/// Throws base::InputError where the worst over poses is not what a requirement bounds.
void check_sense(const study::Requirement& wanted, const std::vector<study::Column>& outputs) {
  const auto& column = outputs[static_cast<std::size_t>(wanted.output)];
  const bool more = column.worse == study::Worse::more;
  if (!column.worst_with.empty())
    base::refuse("--want \"" + wanted.text + "\"",
                 fmt::format("with --worst-over {} is that of the pose with the worst {}, which "
                             "says nothing of the other poses",
                             column.name, column.worst_with));
  if (wanted.at_least == more)
    base::refuse(
        "--want \"" + wanted.text + "\"",
        fmt::format("with --worst-over {} is the {} of all poses; expected is {} {}", column.name,
                    more ? "largest" : "least", column.name, more ? "<=" : ">="));
}

/// Throws base::InputError where an input has no list of values.
void set_grid(std::span<const study::Input> inputs, study::Plan& plan) {
  plan.samples = 1;
  plan.counts.clear();
  for (const auto& input : inputs) {
    const auto& list = input.distribution.list;
    if (list.empty())
      base::refuse(input.name,
                   "a grid needs a range or a list of values, not a distribution; "
                   "`hydrapod sweep` computes grids");
    plan.counts.push_back(static_cast<int>(list.size()));
    if (__builtin_mul_overflow(plan.samples, list.size(), &plan.samples))
      plan.samples = std::numeric_limits<std::uint64_t>::max();
  }
}

/// The motion that is asked for. Throws base::InputError where the machine as it is cannot make it.
/// `seconds`: what one takes, from its beginning.
std::optional<study::Motion> motion_of(const Machine& machine, const StudyOptions& options,
                                       std::vector<std::string>& warnings, double& seconds) {
  if (options.commands.empty()) {
    if (options.until) base::refuse("--until", "is the end of a motion; add --command");
    return std::nullopt;
  }
  const auto& of = machine.file.machine;
  const double rate = 1.0 / of.controller.sample_time;
  study::Motion motion{.commands = signals::read_signals(options.commands, {.rate = rate})};
  motion.until = options.until.value_or(signals::natural_duration(motion.commands));
  try {
    simulation::ClosedLoop loop(of, machine.pose.X_BP,
                                {.kind = machine.kind, .until = motion.until});
    signals::Generator signal(motion.commands, rate);
    warnings =
        require_possible(machine, loop, options.commands, motion.commands, signal, motion.until);
    auto why = simulation::instability(loop);
    if (why.empty()) why = simulation::loss_of_rest(loop, signal, motion.until);
    if (!why.empty()) warnings.push_back(std::move(why));
    constexpr auto long_enough = std::chrono::milliseconds(100);
    const auto begun = std::chrono::steady_clock::now();
    const auto passed = [&] { return std::chrono::steady_clock::now() - begun; };
    const auto run = loop.run(
        simulation::command_source(signal), [](const simulation::LoopSample&) {},
        [&](double) { return passed() < long_enough; });
    if (run.time > 0.0)
      seconds = std::chrono::duration<double>(passed()).count() * motion.until / run.time;
  } catch (const std::length_error& error) {
    base::refuse("--until", error.what());
  }
  return motion;
}

}  // namespace

StudyJob prepare_study(const Machine& machine, const StudyOptions& options) {
  StudyJob job{.machine = machine,
               .plan = options.plan,
               .poses = options.poses,
               .commands = options.commands};
  if (options.until) job.commands.push_back(fmt::format("until {} s", *options.until));
  double seconds_of_motion = 0.0;
  auto [inputs, outer, correlation] = study_inputs(machine, options);
  if (outer == 0) throw std::invalid_argument("prepare_study: nothing varies");
  if (job.plan.design == study::Design::grid) set_grid(std::span(inputs).first(outer), job.plan);
  study::MachineOptions of_machine{
      .kind = machine.kind,
      .X_BP = machine.pose.X_BP,
      .modes = options.modes,
      .also = extra_outputs_of(machine, options),
      .motion = motion_of(machine, options, job.warnings, seconds_of_motion),
      .poses = options.poses,
      .pose = machine.pose.name};
  job.problem = study::machine_problem(machine.file.machine, inputs, of_machine);
  if (auto only = only_of(machine, options, job.problem.outputs)) {
    of_machine.only = std::move(only);
    job.problem = study::machine_problem(machine.file.machine, inputs, of_machine);
  }
  if (!options.worst_over.empty()) job.problem = worst_over(std::move(job.problem), outer);
  job.problem.correlation = std::move(correlation);
  for (const auto& text : options.want) {
    job.requirements.push_back(
        requirement_of(machine.file.machine, machine.kind, job.problem.outputs, text));
    if (job.problem.beneath) check_sense(job.requirements.back(), job.problem.outputs);
  }
  job.rows = rows_of(job.plan, job.problem.inputs.size());
  job.seconds_per_row = measured_seconds(job.problem, job.plan, job.rows) +
                        seconds_of_motion * combinations_of(job.problem);
  job.bytes = static_cast<double>(job.rows) * sizeof(double) *
              static_cast<double>(job.problem.inputs.size() + job.problem.outputs.size());
  return job;
}

namespace {

/// Throws base::InputError where ranks would have nothing to do.
void check_team(const StudyJob& job, const StudyRunOptions& options) {
  if (options.team == nullptr || options.team->size() == 1) return;
  constexpr std::uint64_t chunk = 64;
  const std::uint64_t chunks = (job.rows + chunk - 1) / chunk;
  const auto ranks = static_cast<std::uint64_t>(options.team->size());
  if (options.shards > 1 || options.join)
    base::refuse("--shard",
                 "is for runs without MPI; the ranks of a run share the work themselves");
  if (ranks > chunks)
    base::refuse(fmt::format("{} ranks", ranks),
                 fmt::format("more ranks than work: {} rows are {} chunks of {}; give at most "
                             "{} ranks, or more samples (all rows take about {:.2g} s on one core)",
                             job.rows, chunks, chunk, chunks,
                             static_cast<double>(job.rows) * job.seconds_per_row));
  if (options.resume && fs::exists(shard_file(options.output, 1, 1)))
    base::refuse(shard_file(options.output, 1, 1),
                 "holds rows of a run without MPI; go on without mpirun, or leave --resume out");
}

/// The rows of a whole study or of a shard; `files`: where they are.
study::RunResult compute(const StudyJob& job, const StudyRunOptions& options,
                         const std::string& rows_file, std::vector<std::string>& files,
                         const Progress& progress) {
  study::Team alone;
  auto* team = options.team;
  const bool of_ranks = options.resume && options.shards == 1 && !fs::exists(rows_file) &&
                        !study::rank_files(rows_file).empty();
  if (team == nullptr && of_ranks) team = &alone;
  const study::RunOptions run{
      .spool = rows_file,
      .resume = options.resume,
      .replace = options.replace_rows,
      .threads = options.threads == 0 && options.team != nullptr ? 1 : options.threads,
      .shard = options.shard,
      .shards = options.shards,
      .fingerprint = dependences_of(job)};
  if (team == nullptr) {
    files = {rows_file};
    return study::run(job.problem, job.plan, run, progress);
  }
  const auto result = study::run_as_team(*team, job.problem, job.plan, run, progress);
  team->leave();
  if (team->rank() == 0) files = study::rank_files(rows_file);
  return result;
}

/// Of a map: where what is named or required is worse between its poses. Rows that take long are
/// not looked between.
void look_between(const StudyJob& job, study::Summary& summary, const Progress& progress) {
  constexpr double long_enough = 3.0;  // [s]
  constexpr double rows = 300.0;       // of one search, about
  std::vector<std::string> names{"lowest", "drop", "condition"};
  for (const auto& extra : study::extra_outputs(job.machine.file.machine, job.machine.kind))
    names.push_back(extra.name);
  for (const auto& wanted : job.requirements)
    names.push_back(job.problem.outputs[static_cast<std::size_t>(wanted.output)].name);
  double seconds = 0.0;
  for (std::size_t k = 0; k < summary.outputs.size(); ++k) {
    const auto& column = job.problem.outputs[k];
    auto& output = summary.outputs[k];
    if (std::ranges::count(names, column.name) == 0 || output.count == 0) continue;
    seconds += rows * job.seconds_per_row;
    if (seconds > long_enough || (progress && progress(1.0))) return;
    const bool more = column.worse == study::Worse::more;
    const auto worst = study_row(job, more ? output.most_row : output.least_row);
    output.between =
        study::worst_between(job.problem, std::span(worst).first(job.problem.inputs.size()),
                             more ? output.most : output.least, static_cast<int>(k));
  }
}

}  // namespace

StudyEffort study_effort(const StudyJob& job, const StudyRunOptions& options) {
  const double part = job.bytes / options.shards;
  const int ranks = options.team != nullptr ? options.team->size() : 1;
  const int threads = options.threads > 0 ? options.threads * ranks
                      : ranks > 1         ? ranks
                                          : numerics::processor_count();
  const double there = std::min(part, bytes_there(options));
  const double rows = static_cast<double>(job.rows) / options.shards * (1.0 - there / part);
  // rows, then columns
  StudyEffort effort{.bytes = 2.0 * part - there,
                     .seconds = rows * job.seconds_per_row / threads,
                     .threads = threads};
  effort.text = fmt::format("{:.4g} rows need {:.3g} GB and about {} on {} threads", rows,
                            effort.bytes / 1e9, duration_text(effort.seconds), threads);
  return effort;
}

void check_run(const StudyJob& job, const StudyRunOptions& options) {
  check_team(job, options);
  check_results(job, options);
  if (!options.join) require_room(job, options);
}

StudyDone run_study(const StudyJob& job, const StudyRunOptions& options, const Progress& progress) {
  StudyDone done;
  std::shared_ptr<void> held;  // no other run takes the rows until they are in the results
  std::vector<std::string> files;
  if (options.join) {
    for (int k = 1; k <= options.shards; ++k) {
      files.push_back(shard_file(options.output, k, options.shards));
      if (!fs::exists(files.back()))
        base::refuse(files.back(), fmt::format("part {} of {} is not there; run it with --shard "
                                               "{}/{}, or bring its file here",
                                               k, options.shards, k, options.shards));
    }
    done.run.count = job.rows;
    check_results(job, options);
  } else {
    if (options.team == nullptr) check_run(job, options);
    done.rows_file = shard_file(options.output, options.shard, options.shards);
    done.run = compute(job, options, done.rows_file, files, progress);
    held = std::move(done.run.held);
    done.complete = done.run.complete();
    if (options.shards > 1 || done.run.done == 0) return done;
    if (options.team != nullptr && options.team->rank() > 0) return done;
  }
  const study::Spool spool(files);
  if (spool.fingerprint() != fingerprint_of(job))
    base::refuse(files.front(),
                 "is of another study than this command describes (machine, inputs, "
                 "outputs, samples, seed or program differ)");
  if (options.join) {
    done.run.done = spool.rows();
    done.complete = spool.rows() == job.rows;
    if (!done.complete)
      throw base::ComputationError(
          fmt::format("the parts hold {} of {} rows; run the last one "
                      "again with --resume",
                      spool.rows(), job.rows));
  }
  if (spool.rows() == 0) return done;
  write_results(job, spool, options, done.complete);
  std::exception_ptr not_taken;  // said when the results are there and the rows are not left over
  try {
    if (options.take)
      spool.each_chunk([&](std::uint64_t, std::span<const double> rows) { options.take(rows); });
  } catch (...) {
    not_taken = std::current_exception();
  }
  done.summary = study::summarise(spool, job.problem, job.plan, job.requirements,
                                  {.threads = options.threads, .reached = job.poses});
  if (job.poses && done.complete) look_between(job, *done.summary, progress);
  if (done.complete && !options.join) {
    for (const auto& file : files) fs::remove(file);
    done.rows_file.clear();
  }
  if (not_taken) std::rethrow_exception(not_taken);
  return done;
}

std::vector<double> study_row(const StudyJob& job, std::uint64_t row) {
  std::vector<double> values(job.problem.inputs.size() + job.problem.outputs.size());
  study::Evaluator(job.problem).rows(job.plan, row, values);
  return values;
}

}  // namespace hydrapod::tasks
