#pragma once
/// Studies of a machine: Monte Carlo, sweeps over parameters, maps over poses.
///
///     auto job = tasks::prepare_study(machine, {.vary = {{"legs.guide_sleeve.stiffness",
///         "normal ± 10 %"}}, .want = {"x >= 6 Hz"}, .plan = {.samples = 10000}});
///     const auto done = tasks::run_study(job, {.output = "run.h5"});
///     std::printf("%g\n", done.summary.requirements.at(0).probability);

#include "hydrapod/study/study.hpp"
#include "hydrapod/tasks/machine.hpp"

namespace hydrapod::tasks {

struct Varied {
  std::string path{};
  std::string text{};   ///< a distribution, or "from:to:count", or a list "1, 2, 5 kN/mm"
  std::string place{};  ///< what messages call it
};

struct StudyOptions {
  std::vector<Varied> vary{};       ///< distributions
  std::vector<Varied> over{};       ///< ranges and lists; counts make a grid
  bool poses{};                     ///< `over` are directions x … rz from the machine's pose
  std::vector<std::string> want{};  ///< "x >= 6 Hz"
  study::Plan plan{};
  int modes{6};
  bool buckling{};
};

/// A study that can be run; everything that a user said has been read.
struct StudyJob {
  Machine machine{};
  study::Problem problem{};
  study::Plan plan{};
  std::vector<study::Requirement> requirements{};
  bool poses{};
  std::uint64_t rows{};
  double seconds_per_row{};  ///< one thread, measured on the first rows
  std::uint64_t bytes{};     ///< of the rows on the disk
  /// Name of the column of input `k`: displacements are "pose.x", for "x" is the first resonance in
  /// x.
  [[nodiscard]] std::string input_column(std::size_t k) const {
    return (poses ? "pose." : "") + problem.inputs[k].name;
  }
};

/// Throws base::InputError with what is wrong in a path, a distribution or a requirement.
StudyJob prepare_study(const Machine& machine, const StudyOptions& options);

struct StudyRunOptions {
  std::string output{};  ///< HDF5 file; rows are kept beside it until they are complete
  bool resume{};
  int threads{};
  int shard{1}, shards{1};
  bool join{};  ///< nothing is computed: the shards are put together
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

/// Throws base::ComputationError before the work begins where the disk has no room for the rows;
/// the message says how long the study would take.
StudyDone run_study(const StudyJob& job, const StudyRunOptions& options,
                    const Progress& progress = {});

/// Inputs and outputs of one row of the rows that run_study() has kept or written.
std::vector<double> study_row(const StudyJob& job, std::uint64_t row);

}  // namespace hydrapod::tasks
