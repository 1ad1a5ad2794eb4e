#pragma once
/// Studies of a machine: Monte Carlo, sweeps over parameters, maps over poses.
///
///     auto job = tasks::prepare_study(machine, {.vary = {{"legs.guide_sleeve.stiffness",
///         "normal ± 10 %"}}, .want = {"x >= 6 Hz"}, .plan = {.samples = 10000}});
///     const auto done = tasks::run_study(job, {.output = "run.h5"});
///     std::printf("%g\n", done.summary.requirements.at(0).probability);

#include "hydrapod/study/design.hpp"
#include "hydrapod/tasks/machine.hpp"

namespace hydrapod::tasks {

struct Varied {
  std::string path{};
  std::string text{};   ///< a distribution, or "from:to:count", or a list "1, 2, 5 kN/mm"
  std::string place{};  ///< what messages call it
};

/// What a user wrote, and what messages call it.
struct Asked {
  std::string text{}, place{};
};

struct StudyOptions {
  std::vector<Varied> vary{};  ///< distributions
  std::vector<Varied> over{};  ///< ranges and lists; counts make a grid
  /// The same; a row is the worst over all combinations of their values (study::worst_over()).
  std::vector<Varied> worst_over{};
  bool poses{};  ///< `over` are directions x … rz from the machine's pose
  /// "A, B = 0.6": of two that vary, the correlation of their normal scores.
  std::vector<Asked> correlate{};
  std::vector<std::string> want{};  ///< "x >= 6 Hz"
  study::Plan plan{};
  int modes{6};
  /// Outputs that there are alone besides those of `want` and `also`: words of
  /// study::columns_of_word(), or of `also`; none: all.
  std::vector<Asked> only{};
  /// study::extra_outputs() besides those of `want`: a name, or "stiffness" for all six directions.
  std::vector<Asked> also{};
  /// A motion that every sample makes (study::Motion), as of SimulateOptions; none: no simulation.
  std::vector<std::string> commands{};
  std::optional<double> until{};  ///< [s]; default: what the commands need, and a little more
};

/// A study that can be run; everything that a user said has been read.
struct StudyJob {
  Machine machine{};
  study::Problem problem{};
  study::Plan plan{};
  std::vector<study::Requirement> requirements{};
  bool poses{};
  std::vector<std::string> commands{};  ///< of the motion
  std::vector<std::string> warnings{};  ///< of the motion, for the machine as it is
  std::uint64_t rows{};
  double seconds_per_row{};  ///< one thread, measured on the first rows
  double bytes{};            ///< of the rows on the disk
  /// Name of the column of input `k`: displacements are "pose.x", for "x" is the first resonance in
  /// x.
  [[nodiscard]] std::string input_column(std::size_t k) const {
    return (poses ? "pose." : "") + problem.inputs[k].name;
  }
};

/// A study is one of three. Scatter of numbers of the file: distributions of modes, probability of
/// missing a requirement. Modes over a grid of numbers, or over values that fill it evenly. Modes
/// over the workspace. Throws base::InputError with what is wrong in a path, a distribution or a
/// requirement.
StudyJob prepare_study(const Machine& machine, const StudyOptions& options);

struct RefineOptions {
  /// Two followed modes cross where the difference of their frequencies changes its sign, and is
  /// > apart · the frequency on either side: modes of symmetric machines are equal but for
  /// rounding.
  double apart{1e-6};
  /// Modes veer where their least MAC with the nominal ones changes by more than `veers`.
  double veers{0.1};
  std::uint64_t most_rows{1'000'000};  ///< of a grid that is refined
  int threads{};                       ///< 0: one per processor
};

/// Of a grid: so many times, intervals between rows whose modes cross or veer are halved, for all
/// values of the other inputs. How many values each input got. Throws base::InputError for a grid
/// that is too large or whose values are in no order, std::invalid_argument for a study that is
/// none, base::ComputationError where progress stops it.
std::vector<int> refine_grid(StudyJob& job, int times, const Progress& progress = {},
                             const RefineOptions& options = {});

struct StudyRunOptions {
  std::string output{};   ///< HDF5 file; rows are kept beside it until they are complete
  std::string command{};  ///< that makes the same study again; the file says it
  bool resume{};
  bool replace_rows{true};     ///< of an interrupted run that is not gone on with; else an error
  bool replace_results{true};  ///< those of another study; else an error
  int threads{};
  int shard{1}, shards{1};
  bool join{};  ///< nothing is computed: the shards are put together
  study::Team*
      team{};  ///< ranks that compute it together; each has one thread where `threads` is 0
  /// Gets all rows of a whole study in their order, chunk by chunk: inputs, then outputs, row by
  /// row.
  std::function<void(std::span<const double>)> take{};
};

struct StudyDone {
  study::RunResult run{};
  bool complete{};
  std::string rows_file{};  ///< that is left: of a shard, or to go on from
  /// Nothing for a shard, and where no row was computed.
  std::optional<study::Summary> summary{};
};

/// What a run of a study, or of its shard, takes.
struct StudyEffort {
  double bytes{};  ///< on the disk, at most
  double seconds{};
  int threads{};
  std::string text{};  ///< "1e+07 rows need 7.1 GB and about 43 s on 2 threads"
};
StudyEffort study_effort(const StudyJob& job, const StudyRunOptions& options);

/// Throws base::ComputationError where the disk has no room for the rows; the message says how long
/// the study would take. base::InputError where a team has more ranks than there is work, and for
/// results that may not be replaced.
void check_run(const StudyJob& job, const StudyRunOptions& options);

/// Begins with check_run(), unless there is a team: then all ranks have to check before any begins.
/// Of a team, rank 0 alone has the results.
StudyDone run_study(const StudyJob& job, const StudyRunOptions& options,
                    const Progress& progress = {});

/// Inputs and outputs of one row of the rows that run_study() has kept or written.
std::vector<double> study_row(const StudyJob& job, std::uint64_t row);

struct WantedAim {
  std::string name{};  ///< an output, or the path of a changed number
  bool maximise{};
};

struct DesignOptions {
  std::vector<Varied> change{};           ///< "from:to", with the unit
  std::vector<std::string> want{};        ///< "x >= 6 Hz"
  std::vector<WantedAim> aims{};          ///< one, or two for a trade-off
  std::vector<model::NamedPose> poses{};  ///< none: the machine's own
  std::vector<study::OwnOutput> own{};    ///< outputs of one's own, for `want` and `aims`
};

/// A design that can be sought; everything that a user said has been read.
struct DesignJob {
  Machine machine{};
  study::DesignProblem problem{};
};

/// Numbers of a machine that meet requirements at every pose with the least or largest aim. Throws
/// base::InputError with what is wrong in a path, a range, a requirement or an aim.
DesignJob prepare_design(const Machine& machine, const DesignOptions& options);

struct Designed {
  study::DesignResult result{};
  /// The machine file with the numbers of the best design, comments kept; empty where no design
  /// meets the requirements. What it says was read back and evaluated at every pose.
  std::string text{};
};

Designed run_design(const DesignJob& job, const study::DesignOptions& options,
                    const Progress& progress = {});

/// What is evaluated, and how the files call it.
struct EvaluateOptions {
  std::string parameters{};  ///< file in Dakota's standard or aprepro format
  /// "k=legs.guide_sleeve.stiffness [kN/mm]": what a variable of that file is. Others are paths,
  /// with SI values.
  std::vector<std::string> variables{};
  std::vector<std::string> outputs{};  ///< of the functions, in their order; none: their labels
};

struct Evaluation {
  std::string text{};                         ///< the results file
  std::string failure{};                      ///< why it says FAIL; empty where it does not
  std::vector<std::string> by_differences{};  ///< outputs whose gradients are central differences
  std::string id{};                           ///< eval_id
  std::vector<std::string> frequencies{};     ///< outputs asked for that are frequencies [Hz]
};

/// One evaluation for Dakota, or for any program that speaks its files: parameters in, results out.
/// Throws base::InputError for a file that cannot be read, an unknown variable, output or request.
/// A design that has no outputs is no error: the results file says FAIL.
Evaluation evaluate(const Machine& machine, const EvaluateOptions& options);

}  // namespace hydrapod::tasks
