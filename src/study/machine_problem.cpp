#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using dynamics::ModelMatrix;
using dynamics::ModelVector;
using dynamics::NormalModes;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

double hertz(double omega) { return omega / base::two_pi; }

/// Share of a mode's kinetic energy that the platform has; φᵀ M φ = 1.
double platform_share(const LinearModel& model, const NormalModes& modes, int k) {
  const spatial::Vector6 phi = modes.shapes.col(k).head<6>();
  return phi.dot(model.platform_mass * phi);
}

/// Lowest mode with the share of (M⁻¹)_dd in direction d; −1: none.
int first_resonance(const NormalModes& modes, int d, double share) {
  const double all = modes.shapes.row(d).squaredNorm();
  for (int k = 0; k < modes.size(); ++k)
    if (std::pow(modes.shapes(d, k), 2) >= share * all) return k;
  return -1;
}

/// Frequency of the rigid mode that holds most of a flexible mode's momentum.
double rigid_counterpart(const LinearModel& flexible, const ModelVector& phi,
                         const NormalModes& rigid) {
  const int base = flexible.base_count();
  ModelVector momentum(6 + base);
  momentum.head<6>() = flexible.M.topRows<6>() * phi;
  momentum.tail(base) = flexible.M.bottomRows(base) * phi;
  int best = 0;
  const ModelVector common = rigid.shapes.transpose() * momentum;
  common.cwiseAbs().maxCoeff(&best);
  return rigid.omega(best);
}

/// Modes of the nominal machine that samples are compared with.
struct Nominal {
  LinearModel flexible{}, rigid{};
  NormalModes modes{};
  std::vector<int> followed{};
  spatial::Pose X_BP{};
};

struct Kept {
  model::Machine machine{};
  std::vector<Input> inputs{};
  MachineOptions options{};
  Nominal nominal{};
};

/// Pairs (nominal, mode) in falling order of MAC, one to one. φ_n is normalised in the nominal mass
/// matrix, φ in that of the sample: both enter the denominator.
struct Followed {
  std::vector<int> mode{};
  double least_mac{1.0};
};

Followed follow(const Nominal& nominal, const LinearModel& model, const NormalModes& modes) {
  const auto count = static_cast<int>(nominal.followed.size());
  Followed result{.mode = std::vector<int>(nominal.followed.size(), -1)};
  if (model.dof() != nominal.flexible.dof()) return result;
  Eigen::MatrixXd mac(count, modes.size());
  for (int n = 0; n < count; ++n) {
    const ModelVector phi = nominal.modes.shapes.col(nominal.followed[static_cast<std::size_t>(n)]);
    const ModelVector momentum = model.M * phi;
    const ModelVector common = modes.shapes.transpose() * momentum;
    mac.row(n) = common.cwiseAbs2().transpose() / phi.dot(momentum);
  }
  for (int taken = 0; taken < count; ++taken) {
    int n = 0, k = 0;
    const double best = mac.maxCoeff(&n, &k);
    result.mode[static_cast<std::size_t>(n)] = k;
    result.least_mac = std::min(result.least_mac, best);
    mac.row(n).setConstant(-1.0);
    mac.col(k).setConstant(-1.0);
  }
  return result;
}

struct Layout {
  static constexpr int status = 0, lowest = 1, direction = 2, drop = 3, resonance = 4,
                       resonance_drop = 10, condition = 16, stroke = 17, mac = 18, modes = 19;
};

std::vector<Column> columns_of(const Kept& kept) {
  std::vector<Column> columns{
      {"status", "1",
       "0 computed, 1 number not allowed, 2 pose out of reach, 3 no equilibrium, 4 buckled"},
      {"lowest", "Hz", "lowest mode with platform motion"},
      {"direction", "1", "its main direction, 1 … 6 for x … rz"},
      {"drop", "1", "its frequency against that of its counterpart with rigid legs, share lost"}};
  for (const char* name : spatial::direction_names)
    columns.push_back({name, "Hz", fmt::format("first resonance in {}", name)});
  for (const char* name : spatial::direction_names)
    columns.push_back({fmt::format("drop_{}", name), "1",
                       fmt::format("first resonance in {} against rigid legs, share lost", name)});
  columns.push_back({"condition", "1", "condition of the Jacobian"});
  columns.push_back({"stroke", "m", "least stroke left of any leg"});
  columns.push_back({"mac", "1", "least MAC of the followed modes with the nominal ones"});
  for (std::size_t k = 0; k < kept.nominal.followed.size(); ++k)
    columns.push_back({fmt::format("mode{}", k + 1), "Hz",
                       fmt::format("mode that is like mode {} of the nominal machine, {:.4g} Hz",
                                   kept.nominal.followed[k] + 1,
                                   hertz(kept.nominal.modes.omega(kept.nominal.followed[k])))});
  if (kept.options.buckling)
    columns.push_back({"buckling", "kg", "payload at which the legs buckle; none: not found"});
  return columns;
}

/// Least stroke left in either direction; NaN for legs without a stroke.
double stroke_left(const model::Machine& machine, const spatial::Pose& X_BP) {
  const spatial::Vector6 lengths = kinematics::leg_lengths(machine, X_BP);
  double least = missing;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[static_cast<std::size_t>(i)];
    if (!leg.stroke) continue;
    const double inwards = lengths[i] - leg.rod.length - leg.stroke->retracted;
    least = std::fmin(least, std::min(inwards, leg.stroke->length - inwards));
  }
  return least;
}

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

/// One thread's machine, set anew for each sample.
class Evaluation {
 public:
  explicit Evaluation(std::shared_ptr<const Kept> kept)
      : kept_(std::move(kept)), machine_(kept_->machine) {
    for (const auto& input : kept_->inputs) assignments_.push_back({input.id, 0.0});
  }

  void operator()(std::span<const double> inputs, std::span<double> outputs) {
    std::ranges::fill(outputs, missing);
    spatial::Pose X_BP = kept_->options.X_BP;
    if (kept_->options.poses) {
      X_BP = displaced(X_BP, kept_->inputs, inputs);
    } else {
      for (std::size_t k = 0; k < inputs.size(); ++k) assignments_[k].value = inputs[k];
      model::assign(machine_, assignments_);
    }
    outputs[Layout::status] = static_cast<double>(compute(X_BP, outputs));
  }

 private:
  Status compute(const spatial::Pose& X_BP, std::span<double> outputs) {
    if (!kept_->options.poses && has_error(model::validate(machine_))) return Status::not_allowed;
    if (has_error(kinematics::check_pose(machine_, X_BP, ""))) return Status::out_of_reach;
    outputs[Layout::condition] = kinematics::pose_quality(machine_, X_BP).condition;
    outputs[Layout::stroke] = stroke_left(machine_, X_BP);
    const auto& options = kept_->options;
    const auto& nominal = kept_->nominal;
    try {
      const bool near = !options.poses && nominal.flexible.statics.iterations > 0;
      const auto flexible = dynamics::linear_model(machine_, X_BP, options.kind,
                                                   near ? &nominal.flexible.statics : nullptr);
      const auto modes = modal::normal_modes(flexible);
      if (options.buckling) buckling(X_BP, outputs);
      if (modes.omega2[0] <= 0.0) return Status::buckled;
      const auto rigid = modal::normal_modes(dynamics::linear_model(
          machine_, X_BP, ModelKind::rigid, near ? &nominal.rigid.statics : nullptr));
      lowest_mode(flexible, modes, rigid, outputs);
      resonances(modes, rigid, outputs);
      const auto followed = follow(nominal, flexible, modes);
      outputs[Layout::mac] = followed.least_mac;
      for (std::size_t k = 0; k < followed.mode.size(); ++k)
        if (followed.mode[k] >= 0)
          outputs[Layout::modes + k] = hertz(modes.omega(followed.mode[k]));
    } catch (const base::ComputationError&) {
      return Status::no_equilibrium;
    }
    return Status::computed;
  }

  void lowest_mode(const LinearModel& flexible, const NormalModes& modes, const NormalModes& rigid,
                   std::span<double> outputs) const {
    int k = 0;
    while (k < modes.size() && platform_share(flexible, modes, k) < modal::local_mode_energy) ++k;
    if (k == modes.size()) return;
    outputs[Layout::lowest] = hertz(modes.omega(k));
    const spatial::Vector6 phi = modes.shapes.col(k).head<6>();
    int main = 0;
    (phi.array() * (flexible.platform_mass * phi).array()).maxCoeff(&main);
    outputs[Layout::direction] = main + 1;
    outputs[Layout::drop] =
        1.0 - modes.omega(k) / rigid_counterpart(flexible, modes.shapes.col(k), rigid);
  }

  void resonances(const NormalModes& modes, const NormalModes& rigid,
                  std::span<double> outputs) const {
    for (int d = 0; d < 6; ++d) {
      const double share = kept_->options.resonance_share;
      const int k = first_resonance(modes, d, share), r = first_resonance(rigid, d, share);
      if (k < 0 || r < 0) continue;
      outputs[static_cast<std::size_t>(Layout::resonance + d)] = hertz(modes.omega(k));
      outputs[static_cast<std::size_t>(Layout::resonance_drop + d)] =
          1.0 - modes.omega(k) / rigid.omega(r);
    }
  }

  void buckling(const spatial::Pose& X_BP, std::span<double> outputs) const {
    const auto found = dynamics::buckling_payload(machine_, X_BP, kept_->options.kind);
    if (found.status != dynamics::BucklingStatus::not_found) outputs.back() = found.payload;
  }

  std::shared_ptr<const Kept> kept_;
  model::Machine machine_;
  std::vector<model::Assignment> assignments_;
};

Nominal nominal_of(const model::Machine& machine, const MachineOptions& options) {
  Nominal nominal{.flexible = dynamics::linear_model(machine, options.X_BP, options.kind),
                  .rigid = dynamics::linear_model(machine, options.X_BP, ModelKind::rigid),
                  .X_BP = options.X_BP};
  nominal.modes = modal::normal_modes(nominal.flexible);
  for (int k = 0; k < nominal.modes.size(); ++k)
    if (static_cast<int>(nominal.followed.size()) < options.modes &&
        platform_share(nominal.flexible, nominal.modes, k) >= modal::local_mode_energy)
      nominal.followed.push_back(k);
  if (nominal.modes.omega2[0] <= 0.0)
    throw base::ComputationError(
        "the nominal machine is buckled, so that its modes cannot be followed; `hydrapod check` "
        "shows the payload at which it buckles");
  return nominal;
}

}  // namespace

Problem machine_problem(const model::Machine& machine, std::vector<Input> inputs,
                        const MachineOptions& options) {
  auto kept = std::make_shared<Kept>();
  kept->machine = machine;
  kept->inputs = inputs;
  kept->options = options;
  kept->nominal = nominal_of(machine, options);
  Problem problem{
      .inputs = std::move(inputs), .outputs = columns_of(*kept), .status = Layout::status};
  problem.model = [kept = std::shared_ptr<const Kept>(kept)]() -> Model {
    return Evaluation(kept);
  };
  return problem;
}

model::Machine machine_of(const model::Machine& machine, const std::vector<Input>& inputs,
                          std::span<const double> values) {
  std::vector<model::Assignment> assignments;
  for (std::size_t k = 0; k < inputs.size(); ++k) assignments.push_back({inputs[k].id, values[k]});
  return model::with(machine, assignments);
}

}  // namespace hydrapod::study
