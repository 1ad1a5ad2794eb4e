#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "extra_outputs.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/study/study.hpp"
#include "lane_designs.hpp"
#include "lane_machine.hpp"
#include "machine_outputs.hpp"
#include "motion_outputs.hpp"

namespace hydrapod::study {

namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using dynamics::ModelMatrix;
using dynamics::NormalModes;

bool has_error(const std::vector<model::Finding>& findings) {
  return std::ranges::any_of(
      findings, [](const auto& finding) { return finding.severity == base::Severity::error; });
}

spatial::Pose displaced(const spatial::Pose& from, const std::vector<Input>& inputs,
                        std::span<const double> values) {
  spatial::Vector6 d = spatial::Vector6::Zero();
  for (std::size_t k = 0; k < inputs.size(); ++k)
    for (int i = 0; i < 6; ++i)
      if (inputs[k].name == spatial::direction_names[static_cast<std::size_t>(i)]) d[i] = values[k];
  return {spatial::rotation_from_rpy(d.tail<3>()) * from.R_BP, from.p_BP + d.head<3>()};
}

/// What check_pose() and pose_quality() see of a machine and a pose.
struct PoseNumbers {
  std::array<double, model::leg_count * 15 + 24> numbers{};

  PoseNumbers() = default;
  PoseNumbers(const model::Machine& machine, const spatial::Pose& X_BP) {
    auto at = numbers.begin();
    const auto put = [&](double number) { *at++ = number; };
    const auto put_all = [&](const auto& matrix) {
      at = std::copy_n(matrix.data(), matrix.size(), at);
    };
    for (const auto& leg : machine.legs) {
      put_all(leg.base_joint);
      put_all(leg.platform_joint);
      put_all(leg.gimbal_axis);
      put(leg.rod.length);
      put(leg.guide_sleeve.position);
      put(leg.stroke ? leg.stroke->retracted : missing);
      put(leg.stroke ? leg.stroke->length : missing);
      put(leg.joint_limits.base.value_or(missing));
      put(leg.joint_limits.platform.value_or(missing));
    }
    for (const auto* pose : {&X_BP, &machine.neutral()}) {
      put_all(pose->p_BP);
      put_all(pose->R_BP);
    }
  }
  bool operator==(const PoseNumbers& other) const {
    return std::memcmp(numbers.data(), other.numbers.data(), sizeof numbers) == 0;
  }
};

/// Makes a model where it is to stand: it is too large to be copied there.
template <class Make>
void emplace(std::optional<LinearModel>& model, const Make& make) {
  struct Made {
    const Make& make;
    operator LinearModel() const { return make(); }  // NOLINT
  };
  model.emplace(Made{make});
}

/// A sample between assembly and outputs.
struct Sample {
  std::span<double> outputs{};
  std::optional<LinearModel> flexible{}, rigid{};  ///< no rigid one: it has no equilibrium
};

/// Whether a column of which this is true is asked for.
bool is_wanted(const MachineOptions& options, bool (*is)(std::string_view)) {
  return !options.only || std::ranges::any_of(*options.only, is);
}
bool follows_modes(std::string_view name) { return name == "mac" || name.starts_with("mode"); }
bool compares_with_rigid(std::string_view name) {
  return name.starts_with("drop") || name.starts_with("share") || name.starts_with("peak");
}

LaneOptions lane_options_of(const Kept& kept) {
  auto options = lane_options(kept.machine, kept.options.resonance_share);
  options.rigid = is_wanted(kept.options, compares_with_rigid);
  return options;
}

/// One thread's machine, set anew for each sample.
class Evaluation {
 public:
  explicit Evaluation(std::shared_ptr<const Kept> kept)
      : kept_(std::move(kept)),
        machine_(kept_->machine),
        extra_(machine_, kept_->options.kind, kept_->options.also),
        motion_(kept_->options.motion, kept_->options.kind, kept_->interruption),
        designs_(usable_kernels().front(), kept_->options.kind, lane_options_of(*kept_),
                 is_wanted(kept_->options, follows_modes)
                     ? kept_->nominal.followed_shapes
                     : ModelMatrix(kept_->nominal.flexible.dof(), 0)) {
    for (const auto& input : kept_->inputs) {
      assignments_.push_back({input.id, 0.0});
      const auto pose = kept_->options.poses ? std::nullopt : pose_of(input.id);
      moves_ = moves_ || (pose && machine_.poses.at(*pose).name == kept_->options.pose);
    }
    bounds_are_enough_ = !kept_->options.poses && !has_error(model::validate(machine_)) &&
                         std::ranges::all_of(assignments_, [&](const auto& assignment) {
                           return model::stands_alone(machine_, assignment.id);
                         });
  }

  void operator()(std::span<const double> inputs, std::span<double> outputs) {
    if (const auto X_BP = begin(inputs, outputs)) compute_alone(*X_BP, outputs);
    add_behind(inputs, outputs);
  }

  /// Several samples, in SIMD lanes; how many of them had to be computed alone.
  std::size_t operator()(std::span<const Row> rows) {
    std::size_t alone = 0;
    int waiting = 0;
    for (const auto& row : rows) {
      const auto X_BP = begin(row.inputs, row.outputs);
      if (!X_BP) continue;
      if (!fits_lanes(machine_) || machine_.gravity.isZero(0.0) == designs_.options().gravity) {
        compute_alone(*X_BP, row.outputs);
        ++alone;
        continue;
      }
      const auto& nominal = kept_->nominal;
      designs_.put(waiting, lane_numbers(machine_, *X_BP, start(nominal.flexible.statics),
                                         start(nominal.rigid.statics)));
      waiting_[static_cast<std::size_t>(waiting)] = row;
      if (++waiting == designs_.lanes()) alone += finish(std::exchange(waiting, 0));
    }
    alone += finish(waiting);
    for (const auto& row : rows) add_behind(row.inputs, row.outputs);
    return alone;
  }

 private:
  /// Where the search for equilibrium begins: none for straight legs.
  const dynamics::StaticEquilibrium* start(const dynamics::StaticEquilibrium& nominal) const {
    return !kept_->options.poses && !moves_ && nominal.iterations > 0 ? &nominal : nullptr;
  }

  /// Sets the machine; where it stands.
  spatial::Pose stand(std::span<const double> inputs) {
    const auto& X_BP = kept_->options.X_BP;
    if (kept_->options.poses) return displaced(X_BP, kept_->inputs, inputs);
    for (std::size_t k = 0; k < inputs.size(); ++k) assignments_[k].value = inputs[k];
    model::assign(machine_, assignments_);
    return moves_ ? pose_now(machine_, kept_->options.pose, X_BP) : X_BP;
  }

  /// Everything before the model; the pose. None: there is no model, the status is set.
  std::optional<spatial::Pose> begin(std::span<const double> inputs, std::span<double> outputs) {
    std::ranges::fill(outputs, missing);
    const auto X_BP = stand(inputs);
    const auto refused = refusal(X_BP);
    set(outputs, refused);
    if (refused != Status::not_allowed) outputs[Layout::stroke] = stroke_left_;
    if (refused != Status::computed) return {};
    outputs[Layout::condition] = condition_;
    return X_BP;
  }

  bool allowed() const {
    if (kept_->options.poses) return true;
    if (!bounds_are_enough_) return !has_error(model::validate(machine_));
    return std::ranges::all_of(assignments_, model::within_bound);
  }

  /// What is wrong before any computation; most samples of a study stand where the last one did.
  Status refusal(const spatial::Pose& X_BP) {
    if (!allowed()) return Status::not_allowed;
    const PoseNumbers now(machine_, X_BP);
    if (!checked_ || !(now == *checked_)) {
      reached_ = !has_error(kinematics::check_pose(machine_, X_BP, ""));
      if (reached_) condition_ = kinematics::pose_condition(machine_, X_BP);
      stroke_left_ = kinematics::stroke_left(machine_, X_BP);
      checked_ = now;
    }
    return reached_ ? Status::computed : Status::out_of_reach;
  }

  void compute_alone(const spatial::Pose& X_BP, std::span<double> outputs) {
    sample_.outputs = outputs;
    if (assemble(X_BP, sample_)) finish_alone(sample_);
  }

  bool assemble(const spatial::Pose& X_BP, Sample& sample) {
    const auto& options = kept_->options;
    try {
      emplace(sample.flexible, [&] {
        return dynamics::linear_model(machine_, X_BP, options.kind,
                                      start(kept_->nominal.flexible.statics));
      });
    } catch (const base::ComputationError&) {
      set(sample.outputs, Status::no_equilibrium);
      return false;
    }
    try {
      emplace(sample.rigid, [&] {
        return dynamics::linear_model(machine_, X_BP, ModelKind::rigid,
                                      start(kept_->nominal.rigid.statics));
      });
    } catch (const base::ComputationError&) {
      sample.rigid.reset();
    }
    return true;
  }

  /// The first `count` lanes.
  std::size_t finish(int count) {
    if (count == 0) return 0;
    std::size_t alone = 0;
    designs_.solve(count);
    for (int lane = 0; lane < count; ++lane) {
      const Row& row = waiting_[static_cast<std::size_t>(lane)];
      if (!designs_.sound(lane)) {
        if (const auto X_BP = begin(row.inputs, row.outputs)) compute_alone(*X_BP, row.outputs);
        ++alone;
        continue;
      }
      auto numbers = designs_.outputs(lane);
      if (numbers.repeated == 0.0 || numbers.least <= 0.0) {
        if (numbers.repeated_rigid != 0.0) take_rigid(*kept_, designs_.rigid_modes(lane), numbers);
        outputs_of(*kept_, numbers, row.outputs);
        continue;
      }
      designs_.model(lane, repeating_);
      outputs_of(*kept_, repeating_, designs_.modes(lane), designs_.rigid_modes(lane), row.outputs);
    }
    return alone;
  }

  void finish_alone(Sample& sample) {
    try {
      const auto modes = modal::modes_with_elastomers(machine_, *sample.flexible);
      if (modes.omega2[0] > 0.0 && !sample.rigid)
        return set(sample.outputs, Status::no_equilibrium);
      outputs_of(*kept_, *sample.flexible, modes,
                 sample.rigid ? modal::normal_modes(*sample.rigid) : NormalModes{}, sample.outputs);
    } catch (const base::ComputationError&) {
      set(sample.outputs, Status::no_equilibrium);
    }
  }

  /// What stands behind the modes. What has none has the payload at which it buckles, at most.
  void add_behind(std::span<const double> inputs, std::span<double> outputs) {
    const std::size_t extra = extra_.columns().size(), motion = motion_.columns().size();
    const double status = outputs[Layout::status];
    if (extra + motion == 0 || status == static_cast<double>(Status::not_allowed) ||
        status == static_cast<double>(Status::out_of_reach))
      return;
    const auto X_BP = stand(inputs);
    const auto behind = outputs.last(extra + motion);
    extra_(machine_, X_BP, behind.first(extra));
    if (status == 0.0)
      motion_(machine_, X_BP, behind.last(motion));
    else
      extra_.only_buckling(behind.first(extra));
  }

  std::shared_ptr<const Kept> kept_;
  model::Machine machine_;
  std::vector<model::Assignment> assignments_;
  bool moves_{};              ///< inputs are of the pose
  bool bounds_are_enough_{};  ///< to know that a machine is sound
  ExtraOutputs extra_;
  MotionOutputs motion_;
  LaneDesigns designs_;
  std::array<Row, most_lanes> waiting_{};
  LinearModel repeating_{};  ///< of a lane whose modes repeat
  Sample sample_{};
  std::optional<PoseNumbers> checked_{};  ///< what the next three belong to
  bool reached_{};
  double condition_{}, stroke_left_{};
};

/// The columns that are taken of rows of all columns.
struct Selection {
  std::vector<std::size_t> columns{};
  std::size_t all{};

  void take(std::span<const double> row, std::span<double> outputs) const {
    for (std::size_t k = 0; k < columns.size(); ++k) outputs[k] = row[columns[k]];
  }
};

Model selected(Model model, const Selection& selection) {
  return [model = std::move(model), selection, row = std::vector<double>(selection.all)](
             std::span<const double> inputs, std::span<double> outputs) mutable {
    model(inputs, row);
    selection.take(row, outputs);
  };
}

BatchModel selected(BatchModel model, const Selection& selection) {
  return [model = std::move(model), selection,
          numbers = std::vector<double>()](std::span<const Row> rows) mutable {
    numbers.resize(rows.size() * selection.all);
    std::vector<Row> whole;
    for (std::size_t k = 0; k < rows.size(); ++k)
      whole.push_back(
          {rows[k].inputs, std::span(numbers).subspan(k * selection.all, selection.all)});
    const std::size_t alone = model(whole);
    for (std::size_t k = 0; k < rows.size(); ++k) selection.take(whole[k].outputs, rows[k].outputs);
    return alone;
  };
}

/// The same problem without what the machine does not have, and without those of the first `own`
/// columns that are not asked for.
Problem without_absent(Problem problem, const Kept& kept, std::size_t own) {
  Selection selection{.all = problem.outputs.size()};
  std::vector<Column> outputs;
  const auto& only = kept.options.only;
  for (std::size_t k = 0; k < problem.outputs.size(); ++k) {
    const auto& name = problem.outputs[k].name;
    if (why_no_column(kept.machine, kept.options.kind, name)) continue;
    if (only && k < own && k != Layout::status && std::ranges::count(*only, name) == 0) continue;
    selection.columns.push_back(k);
    outputs.push_back(problem.outputs[k]);
  }
  if (outputs.size() == problem.outputs.size()) return problem;
  Problem less{.inputs = problem.inputs,
               .outputs = std::move(outputs),
               .status = problem.status,
               .interruption = problem.interruption};
  less.model = [make = problem.model, selection] { return selected(make(), selection); };
  less.batch = [make = problem.batch, selection] { return selected(make(), selection); };
  return less;
}

}  // namespace

Problem machine_problem(const model::Machine& machine, std::vector<Input> inputs,
                        const MachineOptions& options) {
  auto kept = std::make_shared<Kept>();
  kept->machine = machine;
  kept->inputs = inputs;
  kept->options = options;
  kept->options.X_BP = pose_now(machine, options.pose, options.X_BP);
  kept->nominal = nominal_of(machine, options);
  Problem problem{
      .inputs = std::move(inputs), .outputs = columns_of(*kept), .status = Layout::status};
  kept->interruption = problem.interruption = std::make_shared<Interruption>();
  const std::size_t own = problem.outputs.size();
  const ExtraOutputs extra(machine, options.kind, options.also);
  const MotionOutputs motion(options.motion, options.kind, {});
  for (const auto* columns : {&extra.columns(), &motion.columns()})
    problem.outputs.insert(problem.outputs.end(), columns->begin(), columns->end());
  problem.model = [kept = std::shared_ptr<const Kept>(kept)]() -> Model {
    return [evaluation = std::make_shared<Evaluation>(kept)](std::span<const double> row,
                                                             std::span<double> outputs) {
      (*evaluation)(row, outputs);
    };
  };
  problem.batch = [kept = std::shared_ptr<const Kept>(kept)]() -> BatchModel {
    return [evaluation = std::make_shared<Evaluation>(kept)](std::span<const Row> rows) {
      return (*evaluation)(rows);
    };
  };
  return without_absent(std::move(problem), *kept, own);
}

model::Machine machine_of(const model::Machine& machine, const std::vector<Input>& inputs,
                          std::span<const double> values) {
  std::vector<model::Assignment> assignments;
  for (std::size_t k = 0; k < inputs.size(); ++k) assignments.push_back({inputs[k].id, values[k]});
  return model::with(machine, assignments);
}

}  // namespace hydrapod::study
