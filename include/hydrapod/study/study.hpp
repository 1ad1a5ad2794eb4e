#pragma once
/// Many designs of one machine: what scatter, a grid of values or a set of poses does to modes.
///
/// A study has inputs (a distribution each), a plan that places samples in them, and a model that
/// computes a row of outputs from a row of inputs. Sample i depends on the plan and on i alone, so
/// the rows are the same whatever the number of threads, of shards and of interruptions. Rows go to
/// a spool, a file of doubles with a checksum per chunk; memory does not grow with their number.
///
///     x_k = F_k⁻¹(u_k(i)),   k = 0 … d − 1
///
/// F_k: the distribution of input k; u_k(i) in (0, 1): see Design. The numbers u of Design::random
/// are those of Philox4x32-10 with the seed as key and (k, i) as counter (J. Salmon et al., SC11,
/// doi 10.1145/2063384.2063405); Design::sobol is the sequence of Boost.Random with a digital shift
/// from the seed; Design::latin permutes the N strata of each input by a keyed Feistel network with
/// cycle walking, and places the sample at random in its stratum.
///
/// Sensitivity indices (Plan::indices) are Sobol's, with two independent matrices A and B of N rows
/// and A with one column of B, A_k: N (d + 2) rows. With V the variance of f,
///
///     S_k = mean(f(B) (f(A_k) − f(A))) / V        (Saltelli et al. 2010)
///     T_k = mean((f(A) − f(A_k))²) / (2 V)        (Jansen 1999)
///
/// Their intervals are percentiles of a bootstrap over groups of samples (A. Saltelli et al.,
/// Comput. Phys. Commun. 181 (2010) 259).
///
/// Correlated inputs have a Gaussian copula: u_k = Φ(Σ_j L_kj Φ⁻¹(v_j)) with L Lᵀ = R, the stated
/// correlations, and v independent (Problem::correlation).

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/signals/signals.hpp"

namespace hydrapod::study {

enum class Shape {
  normal,      ///< a: mean, b: standard deviation
  lognormal,   ///< the same two, of the variable itself and not of its logarithm
  uniform,     ///< a … b
  triangular,  ///< a … b with the mode c
  values       ///< those of the list, equally likely, in its order
};

/// A distribution in SI. `low` and `high` truncate it: what lies beyond is not drawn.
struct Distribution {
  Shape shape{};
  double a{}, b{}, c{};
  std::optional<double> low{}, high{};
  std::vector<double> list{};
};

/// F⁻¹(u), 0 < u < 1.
double quantile(const Distribution& distribution, double u);

/// Reads "normal 5 kN/mm ± 10 %", "lognormal 5 ± 0.5 kN/mm", "uniform 4 .. 6 kN/mm", "uniform ± 10
/// %", "triangular 4 .. 5 .. 6 kN/mm", "normal ± 10 % within 4 .. 6 kN/mm" ("+-" for "±"). Numbers
/// without a unit take the one behind them, else SI. `nominal`: the mean where none is given.
/// `place` is what messages call the text. Throws base::InputError.
Distribution read_distribution(std::string_view text, std::string_view unit, double nominal,
                               const std::string& place);

struct Input {
  std::string name{};  ///< path in the machine file
  std::string unit{};  ///< SI
  Distribution distribution{};
  model::ParameterId id{};
  double correlated{};  ///< with the same number of each other leg
};

/// Which values of a column are worse than others.
enum class Worse { less, more };

struct Column {
  std::string name{}, unit{}, meaning{};
  Worse worse{Worse::less};
  /// Of the worst of several rows: taken from the row with the worst value of this column; empty:
  /// from that with its own.
  std::string worst_with{};
};

/// Fills a row of outputs from a row of inputs. What cannot be computed is NaN.
using Model = std::function<void(std::span<const double> inputs, std::span<double> outputs)>;

struct Row {
  std::span<const double> inputs{};
  std::span<double> outputs{};
};

/// Fills many rows, each as Model would alone but for rounding. Rows do not depend on those beside
/// them. Returns how many of them had to be computed alone after all.
using BatchModel = std::function<std::size_t(std::span<const Row>)>;

/// Where a model that takes long looks whether it is to end before its row is complete. From any
/// thread.
class Interruption {
 public:
  [[nodiscard]] bool is_asked() const {
    const auto* const asked = asked_.load();
    return asked != nullptr && (*asked)();
  }
  /// None: nobody asks. `asked` must live until the next call.
  void set(const std::function<bool()>* asked) { asked_ = asked; }

 private:
  std::atomic<const std::function<bool()>*> asked_{};
};

struct Problem {
  std::vector<Input> inputs{};
  std::vector<Column> outputs{};
  std::function<Model()> model{};       ///< for the use of one thread
  std::function<BatchModel()> batch{};  ///< for many rows at once, or none; run() prefers it
  int status{-1};  ///< column of `outputs` that is 0 for a sample that was computed; −1: none
  /// Lower triangular factor of the correlations of the inputs' normal scores; empty: independent.
  Eigen::MatrixXd correlation{};
  std::shared_ptr<const Problem> beneath{};      ///< of worst_over(): with all inputs
  std::shared_ptr<Interruption> interruption{};  ///< of models that look there
};

/// Lets a problem's model ask whether to stop, as long as it lives.
class Interruptible {
 public:
  Interruptible(const Problem& problem, std::function<bool()> asked)
      : interruption_(problem.interruption), asked_(std::move(asked)) {
    if (interruption_) interruption_->set(&asked_);
  }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible() {
    if (interruption_) interruption_->set(nullptr);
  }
  [[nodiscard]] const std::function<bool()>& asked() const { return asked_; }

 private:
  std::shared_ptr<Interruption> interruption_;
  std::function<bool()> asked_;
};

/// Of a matrix of correlations, unit diagonal. Throws base::InputError with `place` where no inputs
/// can have them.
Eigen::MatrixXd correlation_factor(const Eigen::MatrixXd& correlations, const std::string& place);
/// Makes independent numbers in (0, 1) those of correlated inputs.
void correlate(const Eigen::MatrixXd& factor, std::span<double> u);

/// The same outputs as the worst over some inputs: those of `problem` from number `outer` on, which
/// have lists of values, are left out, and a row has for each column the worst value of all their
/// combinations (see Column). A value that one combination lacks is missing. The status is
/// Status::out_of_reach if one combination has that, else the largest.
Problem worst_over(Problem problem, std::size_t outer);
/// Inputs, those left out too, and outputs of the combination that is worst in a column; none: it
/// has no value there.
std::optional<std::vector<double>> worst_row(const Problem& problem, std::span<const double> outer,
                                             int column);

enum class Design {
  random,  ///< independent samples: the only one with confidence intervals from one run
  latin,   ///< each of N strata of each input once
  sobol,   ///< Sobol sequence with a digital shift
  grid     ///< every combination of `counts` values, the last input fastest
};

struct Plan {
  Design design{Design::random};
  std::uint64_t samples{1000};  ///< N; of a grid the product of `counts`
  std::uint64_t seed{1};
  bool indices{};             ///< with the N (d + 2) rows of sensitivity indices
  std::vector<int> counts{};  ///< of a grid, per input
};

/// All rows of the plan for `inputs` inputs; 2⁶² where they are more.
std::uint64_t rows_of(const Plan& plan, std::size_t inputs);

/// u of sample `row`, one for each input.
void place(const Plan& plan, std::uint64_t row, std::span<double> u);

/// A problem's model for one thread.
class Evaluator {
 public:
  explicit Evaluator(const Problem& problem);
  /// Rows of the plan from `first` on, inputs and outputs, as many as `numbers` has room for. How
  /// many of them a batch had to compute alone; none: `stop`, asked after some, was true.
  std::optional<std::size_t> rows(const Plan& plan, std::uint64_t first, std::span<double> numbers,
                                  const std::function<bool()>& stop = {});

 private:
  const Problem& problem_;
  Model model_{};
  BatchModel batch_{};
  std::vector<Row> rows_{};
  std::size_t together_{64};  ///< rows between two questions whether to stop
};

struct RunOptions {
  std::string spool{};        ///< file of rows, see Spool
  bool resume{};              ///< go on with what the file holds; else it is begun anew
  bool replace{true};         ///< begun anew although there are rows; else an error
  int threads{};              ///< 0: one per processor
  int shard{1}, shards{1};    ///< of all rows, the part 1 … shards
  std::string fingerprint{};  ///< what the rows depend on besides inputs, outputs and plan
};

struct RunResult {
  std::uint64_t first{}, count{};   ///< rows that the shard consists of
  std::uint64_t done{}, resumed{};  ///< that are in the spool; that were there before
  std::uint64_t alone{};            ///< rows of a batch that had to be computed alone, of this run
  double seconds{};
  std::uint64_t handed_out{};    ///< of a team: ranges of chunks that rank 0 gave to other ranks
  double serving{};              ///< [s] processor time of rank 0 for that, waiting included
  std::shared_ptr<void> held{};  ///< while it lives, no other run writes the spool
  [[nodiscard]] bool complete() const { return done == count; }
};

/// Everything that the rows depend on, as one number; `more`: see RunOptions.
std::uint64_t fingerprint(const Problem& problem, const Plan& plan, const std::string& more);

/// Computes the rows into the spool. After a kill what the spool holds up to its last whole chunk
/// is good. Throws base::InputError where the spool is of another study, of another run, a link or
/// no file of rows; base::ComputationError where it cannot be written.
RunResult run(const Problem& problem, const Plan& plan, const RunOptions& options,
              const numerics::Progress& progress = {});

/// Programs on one machine or many that compute one study together (MPI). Rank 0 hands out chunks.
class Team {
 public:
  Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  virtual ~Team() = default;
  [[nodiscard]] virtual int rank() const { return 0; }
  [[nodiscard]] virtual int size() const { return 1; }
  /// The least of the values of all ranks; each waits for all.
  virtual std::int64_t least(std::int64_t value) { return value; }
  /// What rank 0 answers to another rank's request.
  virtual std::int64_t ask(std::int64_t request) { return request; }
  /// Of rank 0: answers one request of another rank, if one waits; whether one did.
  virtual bool answer(const std::function<std::int64_t(std::int64_t)>&) { return false; }
  /// No more is said; ranks may end.
  virtual void leave() {}
};

/// run() by a team: each rank appends what it computed to a file of its own, `spool`.RANK, so that
/// a rank that ends loses the chunks in work at most. To resume, the team may have another size.
/// The result of rank 0 is that of all ranks.
RunResult run_as_team(Team& team, const Problem& problem, const Plan& plan,
                      const RunOptions& options, const numerics::Progress& progress = {});

/// Files of ranks beside `spool`, in the order of their numbers.
std::vector<std::string> rank_files(const std::string& spool);

/// Rows of spools, one spool after the other: inputs, then outputs. Of files of ranks: all rows
/// before the first chunk that none of them has.
class Spool {
 public:
  /// Throws base::InputError for files that are no spools, of several studies, or not all shards of
  /// one in their order.
  explicit Spool(std::vector<std::string> paths);
  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::uint64_t fingerprint() const { return fingerprint_; }
  /// Calls `take` with the rows of a chunk, row by row, and the number of the first.
  void each_chunk(const std::function<void(std::uint64_t, std::span<const double>)>& take) const;
  [[nodiscard]] std::vector<double> row(std::uint64_t index) const;

 private:
  std::vector<std::string> paths_;
  std::vector<std::uint64_t> counts_;
  std::uint64_t rows_{}, fingerprint_{};
  std::size_t width_{};
  struct Place {
    std::uint32_t file{}, record{};
  };
  std::vector<Place> places_{};  ///< per chunk, of files of ranks
  void index_ranks();
  void each_ranked_chunk(
      const std::function<void(std::uint64_t, std::span<const double>)>& take) const;
};

/// "x >= 6 Hz": a bound for an output, in the unit of its column.
struct Requirement {
  std::string text{};
  int output{};
  bool at_least{};
  double bound{};
};

/// Throws base::InputError for an unknown output and for a quantity of another dimension.
Requirement read_requirement(const std::string& text, const std::vector<Column>& outputs,
                             const std::string& place);

struct Interval {
  double low{}, high{};
};

struct QuantileEstimate {
  double probability{};
  double value{};
  /// Order statistics around it with a coverage of at least 95 %; none where the plan has no
  /// independent samples or too few.
  std::optional<Interval> interval{};
};

/// The worst value that was found between the rows of a grid, and the inputs there.
struct WorstBetween {
  double value{};
  std::vector<double> inputs{};
};

struct OutputSummary {
  std::uint64_t count{};  ///< finite values
  double mean{}, deviation{}, least{}, most{};
  std::uint64_t least_row{}, most_row{};    ///< the first ones with these
  std::optional<Interval> mean_interval{};  ///< Student, 95 %
  std::vector<QuantileEstimate> quantiles{};
  std::optional<WorstBetween> between{};  ///< of maps, where it is worse than that of all rows
};

struct RequirementSummary {
  std::uint64_t count{}, missed{};  ///< samples without a value miss it
  double probability{};
  std::optional<Interval> interval{};    ///< Clopper–Pearson, 95 %
  std::optional<std::uint64_t> worst{};  ///< row with a value, farthest on the wrong side
};

struct Index {
  double value{};
  Interval interval{};  ///< 95 %
};

struct Indices {
  std::vector<Index> first{}, total{};  ///< per input; empty where the output does not vary
  std::uint64_t used{};                 ///< of the N samples, those with all d + 2 values
};

/// What part of a grid of poses legs and joints reach. A cell between neighbours is reached where
/// all its corners are; it is in part where one is.
struct ReachedPart {
  double least{}, most{}, whole{};  ///< length, area or volume of the cells reached whole, in part;
                                    ///< of all cells
  std::string unit{};               ///< "m^2", "m rad"
};

struct Summary {
  std::uint64_t rows{};
  std::vector<std::uint64_t> statuses{};  ///< rows per status; empty without one
  std::vector<OutputSummary> outputs{};
  std::vector<RequirementSummary> requirements{};
  std::vector<Indices> indices{};        ///< per output
  std::optional<ReachedPart> reached{};  ///< of a whole grid of poses
};

/// From a row of a grid, with `inputs` and `value` in column `column`, to where that is worse
/// nearby: steps of half the distance to the next rows and of halves of it, down to 1/1000, within
/// the grid. None: nothing there is worse.
std::optional<WorstBetween> worst_between(const Problem& problem, std::span<const double> inputs,
                                          double value, int column);

struct SummaryOptions {
  std::vector<double> probabilities{0.01, 0.05, 0.5, 0.95, 0.99};
  int replicates{400};  ///< of the bootstrap
  int threads{};        ///< 0: one per processor
  bool reached{};       ///< of a grid of poses, with the part that is reached
};

/// In a fixed number of passes over the spool, exact order statistics among them; memory is bounded
/// whatever the number of rows. With Plan::indices distributions are those of the rows of A and B.
Summary summarise(const Spool& spool, const Problem& problem, const Plan& plan,
                  const std::vector<Requirement>& requirements, const SummaryOptions& options = {});

/// What became of a sample: values of the column `status`.
enum class Status {
  computed = 0,
  not_allowed = 1,     ///< a number that the machine cannot have (a stiffness below 0)
  out_of_reach = 2,    ///< a pose beyond strokes, joint angles or at a singularity
  no_equilibrium = 3,  ///< the legs do not hold the machine under gravity
  buckled = 4          ///< a mode below zero
};

/// A motion that every sample makes under its controller, with the sensors' noise of seed 1. Its
/// outputs, for each direction: `rms_error_x`, `peak_error_x` (command less motion),
/// `peak_motion_x` (from the pose) and, of a direction with steps, `settling_x` (from the last one
/// until the motion stays within 2 % of it); `peak_speed` of a piston, `peak_drive` and `limited`
/// (share of the controller's samples with a drive at its limit), of the leg with most. A run that
/// does not come to its end has none.
struct Motion {
  std::vector<signals::Signal> commands{};
  double until{};  ///< [s]
};

struct MachineOptions {
  dynamics::ModelKind kind{};
  spatial::Pose X_BP{};  ///< nominal
  /// A mode resonates in a direction when it holds this share of (M⁻¹)_dd, the sum of φ_d² over all
  /// modes: five per cent is a peak that a frequency response shows beside the main one.
  double resonance_share{0.05};
  int modes{6};  ///< lowest platform modes that are followed
  /// Names of extra_outputs() that are computed too.
  std::vector<std::string> also{};
  /// Of the columns of modes and pose these alone, and `status`; what only the others need is not
  /// computed. None: all of them.
  std::optional<std::vector<std::string>> only{};
  std::optional<Motion> motion{};  ///< with its outputs
  bool poses{};                    ///< inputs are displacements from X_BP, with names x … rz
  std::string pose{};  ///< name of X_BP, if it is one of the machine's poses: X_BP follows inputs
};

/// Outputs that a study has where they are asked for, those of them that the machine has:
/// `buckling` (payload at which the legs buckle), `power` of the pump, `sag` (largest static offset
/// of a rod at its guide sleeve), `oil_force` (largest static one of a leg, of a strut or screw
/// where it has no oil), `stiffness_x` … `stiffness_rz` (static, 1/(K⁻¹)_dd), and `force_x` …
/// `excursion_rz` (simulation/capability.hpp, the smaller of both senses). Microseconds to
/// milliseconds a sample.
std::vector<Column> extra_outputs(const model::Machine& machine, dynamics::ModelKind kind);

/// Columns of machine_problem() that one word stands for: "frequencies", "modes", "drops", or a
/// column and what is said together with it, a drop with frequency, share and peak. Empty: no such
/// column.
std::vector<std::string> columns_of_word(const std::vector<Column>& columns, std::string_view word);

/// Number of the pose that a number of a machine belongs to, from 0; none: it is of no pose.
std::optional<std::size_t> pose_of(const model::ParameterId& id);

/// Lowest platform mode, first resonances, drop, followed modes and pose quality of machines that
/// differ from `machine` in the inputs. Modes are followed by shape: each mode of the nominal
/// machine goes to that mode of the sample with the largest MAC, most alike first, one to one.
/// Throws base::ComputationError where the nominal machine has no modes.
Problem machine_problem(const model::Machine& machine, std::vector<Input> inputs,
                        const MachineOptions& options);

/// Frequencies of many designs of one machine at one pose, several at a time in SIMD lanes; for one
/// thread. They are those of modal::modes_with_elastomers() but for rounding (1e-12 of each; 5e-11
/// under gravity beside nearly rigid sleeves), whatever designs are beside. `pose`: MachineOptions.
class DesignFrequencies {
 public:
  DesignFrequencies(const model::Machine& machine, const spatial::Pose& X_BP,
                    dynamics::ModelKind kind, const std::vector<model::ParameterId>& ids,
                    std::string pose = {});
  DesignFrequencies(DesignFrequencies&&) noexcept;
  ~DesignFrequencies();

  /// Per design: a number for each id [SI] from `values`, the frequencies [rad/s, ascending] to
  /// `omega`: 0 below buckling, NaN where there is no equilibrium.
  void operator()(std::span<const double> values, std::span<double> omega);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The machine of a row of inputs.
model::Machine machine_of(const model::Machine& machine, const std::vector<Input>& inputs,
                          std::span<const double> values);

/// Its file: the numbers set, everything else as it was.
std::string machine_text(const model::MachineFile& file, const std::vector<Input>& inputs,
                         std::span<const double> values, const std::string& label);

/// PATH="DISTRIBUTION" as inputs, six of them for a path of all legs whose text has "per leg" at
/// its end, or "per leg correlated 0.6" (Input::correlated). Throws base::InputError.
std::vector<Input> read_variation(const model::MachineFile& file, const std::string& path,
                                  const std::string& text, const std::string& place);

/// Frequencies of studies: "undamped"; with elastomers "damped", as all of `hydrapod modes` are.
std::string frequency_kind(const model::Machine& machine);

/// Why this machine lacks an output that others have; none: it has it, or no machine does.
std::optional<std::string> why_no_output(const model::Machine& machine, dynamics::ModelKind kind,
                                         std::string_view name);

/// A number from −1 to 1. Throws base::InputError.
double read_correlation(std::string_view text, const std::string& place);

/// What a study file (TOML) says.
struct StudyFile {
  std::string text{};
  std::optional<std::string> machine{}, pose{};  ///< `machine`: path from the study file
  std::vector<std::string> set{};
  struct Given {
    std::string key{}, text{}, place{};
  };
  std::vector<Given> vary{}, want{}, correlate{};
  std::vector<std::string> only{}, also{}, command{};
  std::optional<double> until{};
  std::optional<std::uint64_t> samples{}, seed{};
  std::optional<Design> design{};
  bool indices{}, buckling{};
};

/// Throws base::InputError with all mistakes, with line and column.
StudyFile read_study_file(const std::string& path);

}  // namespace hydrapod::study
