#include "study_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/data/modal_results.hpp"

namespace hydrapod::tasks {

namespace {

namespace fs = std::filesystem;

constexpr int most_of_a_range = 1'000'000;

double number_of(const std::string& text, const std::string& unit, const std::string& place) {
  const auto read = base::read_plain_or_quantity(text, unit);
  if (!read.ok()) base::refuse(place, fmt::format("'{}': {}", text, read.problem));
  return read.value;
}

/// "4:6:11 kN/mm": from, to, count; the unit may stand behind any number.
study::Distribution range_of(const Varied& varied, const std::string& unit, bool grid) {
  auto parts = base::split(varied.text, ":");
  const auto last = parts.back();
  const auto blank = last.find(' ');
  const std::string behind = blank == std::string::npos ? "" : last.substr(blank);
  const std::size_t wanted = grid ? 3 : 2;
  if (parts.size() != wanted)
    base::refuse(varied.place,
                 grid ? "expected from:to:count, for instance \"2:20:10 kN/mm\", or a list"
                      : "expected from:to; the number of values is that of --samples");
  const auto with_unit = [&](const std::string& part) {
    return number_of(part.find_first_of(" %") == std::string::npos ? part + behind : part, unit,
                     varied.place);
  };
  const double from = with_unit(parts[0]), to = with_unit(parts[1]);
  if (from == to) base::refuse(varied.place, "both ends are equal");
  if (!grid)
    return {.shape = study::Shape::uniform, .a = std::min(from, to), .b = std::max(from, to)};
  const auto count = base::read_quantity(std::string_view(last).substr(0, blank), "1");
  if (!count.ok() || count.value != std::floor(count.value) || count.value < 2 ||
      count.value > most_of_a_range)
    base::refuse(varied.place,
                 fmt::format("'{}' is not a count; expected a whole number from 2 to {}", last,
                             most_of_a_range));
  study::Distribution d{.shape = study::Shape::values};
  for (int k = 0; k < static_cast<int>(count.value); ++k)
    d.list.push_back(from + (to - from) * k / (count.value - 1.0));
  return d;
}

/// "1, 2, 5 kN/mm"
study::Distribution list_of(const Varied& varied, const std::string& unit) {
  const auto parts = base::split(varied.text, ",");
  const auto blank = parts.back().find(' ');
  const std::string behind = blank == std::string::npos ? "" : parts.back().substr(blank);
  study::Distribution d{.shape = study::Shape::values};
  for (const auto& part : parts)
    d.list.push_back(
        number_of(part.find(' ') == std::string::npos ? part + behind : part, unit, varied.place));
  return d;
}

}  // namespace

model::FileNumber number_at(const Machine& machine, const std::string& path,
                            const std::string& place) {
  if (auto number = find_number(machine.file, path)) return *number;
  const std::string near = nearest_parameter(machine.file, path);
  base::refuse(place, "the machine file has no such number" +
                          (near.empty() ? "" : fmt::format("; did you mean `{}`?", near)));
}

study::Input input_over(const Machine& machine, const Varied& varied, bool poses, bool grid) {
  study::Input input{.name = varied.path};
  if (poses) {
    const auto direction = spatial::direction_from_name(varied.path);
    if (!direction)
      base::refuse(varied.place, "unknown direction; directions are x, y, z, rx, ry, rz");
    input.unit = *direction < 3 ? "m" : "rad";
  } else {
    const auto number = number_at(machine, varied.path, varied.place);
    input.unit = number.unit;
    input.id = number.id;
  }
  input.distribution = varied.text.find(':') == std::string::npos
                           ? list_of(varied, input.unit)
                           : range_of(varied, input.unit, grid);
  return input;
}

std::vector<base::Diagnostic> of_other_poses(const Machine& machine,
                                             const std::vector<study::Input>& inputs,
                                             const std::vector<model::NamedPose>& poses) {
  std::vector<base::Diagnostic> errors;
  std::vector<std::string_view> names;
  for (const auto& pose : poses) names.push_back(pose.name);
  for (const auto& input : inputs) {
    const auto number = study::pose_of(input.id);
    if (!number) continue;
    const auto& name = machine.file.machine.poses.at(*number).name;
    if (std::ranges::count(names, name) == 0)
      errors.push_back({.file = input.name,
                        .message = fmt::format("has no effect at pose {}; expected is a number of "
                                               "that pose, or --pose {}",
                                               fmt::join(names, ", "), name)});
  }
  return errors;
}

std::optional<std::string> no_output_text(const model::Machine& machine, dynamics::ModelKind kind,
                                          const std::vector<study::Column>& outputs,
                                          std::string_view name) {
  const auto why = study::why_no_output(machine, kind, name);
  if (!why) return std::nullopt;
  std::vector<std::string_view> names;
  for (const auto& one : outputs) names.push_back(one.name);
  return fmt::format("{} {}; outputs of this machine are {}", name, *why, fmt::join(names, ", "));
}

void require_output(const model::Machine& machine, dynamics::ModelKind kind,
                    const std::vector<study::Column>& outputs, std::string_view name,
                    const std::string& place) {
  if (const auto text = no_output_text(machine, kind, outputs, name)) base::refuse(place, *text);
}

study::Requirement requirement_of(const model::Machine& machine, dynamics::ModelKind kind,
                                  const std::vector<study::Column>& outputs,
                                  const std::string& text) {
  const auto place = "--want \"" + text + "\"";
  const auto name = base::trimmed(std::string_view(text).substr(0, text.find_first_of("<>")));
  const bool known = std::ranges::find(outputs, name, &study::Column::name) != outputs.end();
  if (!known) require_output(machine, kind, outputs, name, place);
  return study::read_requirement(text, outputs, place);
}

std::string duration_text(double seconds) {
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 172800) return fmt::format("{:.1f} h", seconds / 3600);
  return fmt::format("{:.0f} days", seconds / 86400);
}

namespace {

std::vector<study::Input> inputs_of(const Machine& machine, const StudyOptions& options) {
  std::vector<study::Input> inputs;
  std::vector<base::Diagnostic> errors;
  const auto gather = [&](const auto& read) {
    try {
      for (auto& input : read()) inputs.push_back(std::move(input));
    } catch (const base::InputError& error) {
      errors.insert(errors.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  for (const auto& varied : options.vary)
    gather([&] {
      return study::read_variation(machine.file, varied.path, varied.text, varied.place);
    });
  const bool grid = options.plan.design == study::Design::grid;
  for (const auto& varied : options.over)
    gather([&] { return std::vector{input_over(machine, varied, options.poses, grid)}; });
  for (std::size_t k = 0; k < inputs.size(); ++k)
    for (std::size_t other = 0; other < k; ++other)
      if (inputs[k].name == inputs[other].name ||
          (!options.poses && inputs[k].id == inputs[other].id))
        errors.push_back({.file = inputs[k].name, .message = "is varied twice"});
  if (!options.poses)
    for (auto& error : of_other_poses(machine, inputs, {machine.pose})) errors.push_back(error);
  if (!errors.empty()) throw base::InputError(errors);
  return inputs;
}

/// Seconds a row takes, from the first ones.
double measured_seconds(const study::Problem& problem, const study::Plan& plan,
                        std::uint64_t rows) {
  constexpr std::uint64_t enough = 512, together = 64;
  constexpr double long_enough = 0.05;  // [s]
  const std::size_t inputs = problem.inputs.size();
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
  std::string text = fmt::format("{}\n{}\n{}\n{}", base::version, job.machine.file.text,
                                 dynamics::name(job.machine.kind), job.poses);
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
  file.numbers = {{"samples", static_cast<double>(job.plan.samples)},
                  {"seed", static_cast<double>(job.plan.seed)},
                  {"rows_planned", static_cast<double>(job.rows)},
                  {"complete", complete ? 1.0 : 0.0}};
  file.each_rows = [&](const std::function<void(std::span<const double>)>& take) {
    spool.each_chunk([&](std::uint64_t, std::span<const double> rows) { take(rows); });
  };
  data::write_columns(options.output, file);
}

}  // namespace

StudyJob prepare_study(const Machine& machine, const StudyOptions& options) {
  StudyJob job{.machine = machine, .plan = options.plan, .poses = options.poses};
  auto inputs = inputs_of(machine, options);
  if (inputs.empty()) throw std::invalid_argument("prepare_study: nothing varies");
  const bool grid = job.plan.design == study::Design::grid;
  for (const auto& input : inputs)
    if (grid && input.distribution.list.empty())
      base::refuse(input.name,
                   "a grid needs a range or a list of values, not a distribution; "
                   "`hydrapod sweep` computes grids");
  if (grid) {
    job.plan.samples = 1;
    job.plan.counts.clear();
    for (const auto& input : inputs) {
      job.plan.counts.push_back(static_cast<int>(input.distribution.list.size()));
      if (__builtin_mul_overflow(job.plan.samples, input.distribution.list.size(),
                                 &job.plan.samples))
        job.plan.samples = std::numeric_limits<std::uint64_t>::max();
    }
  }
  job.problem = study::machine_problem(machine.file.machine, std::move(inputs),
                                       {.kind = machine.kind,
                                        .X_BP = machine.pose.X_BP,
                                        .modes = options.modes,
                                        .buckling = options.buckling,
                                        .poses = options.poses,
                                        .pose = machine.pose.name});
  if (options.buckling)
    require_output(machine.file.machine, machine.kind, job.problem.outputs, "buckling",
                   "--buckling");
  for (const auto& text : options.want)
    job.requirements.push_back(
        requirement_of(machine.file.machine, machine.kind, job.problem.outputs, text));
  job.rows = rows_of(job.plan, job.problem.inputs.size());
  job.seconds_per_row = measured_seconds(job.problem, job.plan, job.rows);
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
    for (int k = 1; k <= options.shards; ++k)
      files.push_back(shard_file(options.output, k, options.shards));
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
                                  {.threads = options.threads});
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
