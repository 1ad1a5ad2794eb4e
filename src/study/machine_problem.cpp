#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/study/study.hpp"
#include "lane_solve.hpp"

namespace hydrapod::study {

namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using dynamics::ModelMatrix;
using dynamics::ModelVector;
using dynamics::NormalModes;
/// A row per followed mode, a column per mode of a sample.
using MacMatrix = ModelMatrix;
using MacVector = ModelVector;

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
  ModelMatrix followed_shapes{};  ///< their columns
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

/// Shapes of the followed modes times M, and those times the shapes of a sample.
template <int dof>
MacMatrix squared_products(const ModelMatrix& nominal, const LinearModel& model,
                           const NormalModes& modes, MacVector& mass) {
  using Square = Eigen::Matrix<double, dof, dof>;
  using Columns = Eigen::Matrix<double, dof, Eigen::Dynamic, 0, dof, dynamics::max_dof>;
  const Eigen::Map<const Square> M(model.M.data()), shapes(modes.shapes.data());
  const Eigen::Map<const Columns> psi(nominal.data(), dof, nominal.cols());
  const Columns momentum = M.lazyProduct(psi);
  mass = psi.cwiseProduct(momentum).colwise().sum().transpose();
  const MacMatrix common = momentum.transpose().lazyProduct(shapes);
  return common.cwiseAbs2();
}

MacMatrix squared_products(const Nominal& nominal, const LinearModel& model,
                           const NormalModes& modes, MacVector& mass) {
  const ModelMatrix& psi = nominal.followed_shapes;
  switch (model.dof()) {
    case 6:
      return squared_products<6>(psi, model, modes, mass);
    case 18:
      return squared_products<18>(psi, model, modes, mass);
    case 30:
      return squared_products<30>(psi, model, modes, mass);
    default:
      break;
  }
  const ModelMatrix momentum = model.M * psi;
  mass = psi.cwiseProduct(momentum).colwise().sum().transpose();
  const MacMatrix common = momentum.transpose() * modes.shapes;
  return common.cwiseAbs2();
}

Followed follow(const Nominal& nominal, const LinearModel& model, const NormalModes& modes) {
  const auto count = static_cast<int>(nominal.followed.size());
  Followed result{.mode = std::vector<int>(nominal.followed.size(), -1)};
  if (model.dof() != nominal.flexible.dof()) return result;
  MacVector mass;
  MacMatrix mac = squared_products(nominal, model, modes, mass);
  for (int n = 0; n < count; ++n) mac.row(n) /= mass[n];
  std::array<int, dynamics::max_dof> like;  // per followed mode, the mode most like it
  for (int n = 0; n < count; ++n) mac.row(n).maxCoeff(&like[n]);
  for (int taken = 0; taken < count; ++taken) {
    int n = 0;
    for (int m = 1; m < count; ++m)
      if (mac(m, like[m]) > mac(n, like[n])) n = m;
    const int k = like[n];
    result.mode[static_cast<std::size_t>(n)] = k;
    result.least_mac = std::min(result.least_mac, mac(n, k));
    mac.row(n).setConstant(-2.0);
    mac.col(k).setConstant(-1.0);
    mac(n, k) = -2.0;
    for (int m = 0; m < count; ++m)
      if (like[m] == k) mac.row(m).maxCoeff(&like[m]);
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

/// One thread's machine, set anew for each sample.
class Evaluation {
 public:
  explicit Evaluation(std::shared_ptr<const Kept> kept)
      : kept_(std::move(kept)), machine_(kept_->machine) {
    for (const auto& input : kept_->inputs) assignments_.push_back({input.id, 0.0});
  }

  void operator()(std::span<const double> inputs, std::span<double> outputs) {
    Sample& sample = samples_[0];
    sample.outputs = outputs;
    if (begin(inputs, sample)) finish_alone(sample);
  }

  /// Several samples, their modes in SIMD lanes; how many of them had to be solved alone.
  std::size_t operator()(std::span<const Row> rows) {
    std::size_t alone = 0, waiting = 0;
    for (const auto& row : rows) {
      Sample& sample = samples_[waiting];
      sample.outputs = row.outputs;
      if (begin(row.inputs, sample) && ++waiting == samples_.size())
        alone += finish(std::exchange(waiting, 0));
    }
    return alone + finish(waiting);
  }

 private:
  static void set(Sample& sample, Status status) {
    sample.outputs[Layout::status] = static_cast<double>(status);
  }

  /// Everything before the modes. False: there are none, the status is set.
  bool begin(std::span<const double> inputs, Sample& sample) {
    std::ranges::fill(sample.outputs, missing);
    spatial::Pose X_BP = kept_->options.X_BP;
    if (kept_->options.poses) {
      X_BP = displaced(X_BP, kept_->inputs, inputs);
    } else {
      for (std::size_t k = 0; k < inputs.size(); ++k) assignments_[k].value = inputs[k];
      model::assign(machine_, assignments_);
    }
    const auto refused = refusal(X_BP);
    set(sample, refused);
    if (refused != Status::computed) return false;
    sample.outputs[Layout::condition] = condition_;
    sample.outputs[Layout::stroke] = stroke_left_;
    return assemble(X_BP, sample);
  }

  /// What is wrong before any computation; most samples of a study stand where the last one did.
  Status refusal(const spatial::Pose& X_BP) {
    if (!kept_->options.poses && has_error(model::validate(machine_))) return Status::not_allowed;
    const PoseNumbers now(machine_, X_BP);
    if (!checked_ || !(now == *checked_)) {
      reached_ = !has_error(kinematics::check_pose(machine_, X_BP, ""));
      if (reached_) condition_ = kinematics::pose_quality(machine_, X_BP).condition;
      stroke_left_ = stroke_left(machine_, X_BP);
      checked_ = now;
    }
    return reached_ ? Status::computed : Status::out_of_reach;
  }

  bool assemble(const spatial::Pose& X_BP, Sample& sample) {
    const auto& options = kept_->options;
    const auto& nominal = kept_->nominal;
    const bool near = !options.poses && nominal.flexible.statics.iterations > 0;
    try {
      emplace(sample.flexible, [&] {
        return dynamics::linear_model(machine_, X_BP, options.kind,
                                      near ? &nominal.flexible.statics : nullptr);
      });
    } catch (const base::ComputationError&) {
      set(sample, Status::no_equilibrium);
      return false;
    }
    if (options.buckling) buckling(X_BP, sample.outputs);
    try {
      assemble_rigid(X_BP, near, sample);
    } catch (const base::ComputationError&) {
      sample.rigid.reset();
    }
    return true;
  }

  void assemble_rigid(const spatial::Pose& X_BP, bool near, Sample& sample) const {
    if (machine_.base_mount || !machine_.gravity.isZero(0.0))
      return emplace(sample.rigid, [&] {
        return dynamics::linear_model(machine_, X_BP, ModelKind::rigid,
                                      near ? &kept_->nominal.rigid.statics : nullptr);
      });
    // Without preload the rigid model is the platform's part of the flexible one.
    if (!sample.rigid) sample.rigid.emplace();
    sample.rigid->kind = ModelKind::rigid;
    sample.rigid->M = sample.flexible->M.topLeftCorner<6, 6>();
    sample.rigid->K = sample.flexible->K.topLeftCorner<6, 6>();
  }

  /// The first `count` samples.
  std::size_t finish(std::size_t count) {
    std::array<const LinearModel*, at_once> flexible{}, rigid{};
    std::array<std::size_t, at_once> which{};
    std::array<bool, at_once> sound{}, rigid_sound{};
    std::size_t alone = 0, in_lanes = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Sample& sample = samples_[k];
      if (!sample.rigid || sample.flexible->base_count() > 0) {
        finish_alone(samples_[k]);
        ++alone;
        continue;
      }
      flexible[in_lanes] = &*sample.flexible;
      rigid[in_lanes] = &*sample.rigid;
      which[in_lanes++] = k;
    }
    modes_in_lanes(std::span(flexible).first(in_lanes), std::span(modes_).first(in_lanes),
                   std::span(sound).first(in_lanes));
    modes_in_lanes(std::span(rigid).first(in_lanes), std::span(rigid_modes_).first(in_lanes),
                   std::span(rigid_sound).first(in_lanes));
    for (std::size_t k = 0; k < in_lanes; ++k) {
      if (sound[k] && rigid_sound[k]) {
        outputs_of(samples_[which[k]], modes_[k], rigid_modes_[k]);
      } else {
        finish_alone(samples_[which[k]]);
        ++alone;
      }
    }
    return alone;
  }

  void finish_alone(Sample& sample) {
    try {
      const auto modes = modal::normal_modes(*sample.flexible);
      if (modes.omega2[0] > 0.0 && !sample.rigid) return set(sample, Status::no_equilibrium);
      outputs_of(sample, modes, sample.rigid ? modal::normal_modes(*sample.rigid) : NormalModes{});
    } catch (const base::ComputationError&) {
      set(sample, Status::no_equilibrium);
    }
  }

  void outputs_of(Sample& sample, const NormalModes& modes, const NormalModes& rigid) const {
    if (modes.omega2[0] <= 0.0) return set(sample, Status::buckled);
    const auto& outputs = sample.outputs;
    lowest_mode(*sample.flexible, modes, rigid, outputs);
    resonances(modes, rigid, outputs);
    const auto followed = follow(kept_->nominal, *sample.flexible, modes);
    outputs[Layout::mac] = followed.least_mac;
    for (std::size_t k = 0; k < followed.mode.size(); ++k)
      if (followed.mode[k] >= 0) outputs[Layout::modes + k] = hertz(modes.omega(followed.mode[k]));
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

  static constexpr std::size_t at_once = 8;  ///< the lanes of AVX-512
  std::shared_ptr<const Kept> kept_;
  model::Machine machine_;
  std::vector<model::Assignment> assignments_;
  std::vector<Sample> samples_ = std::vector<Sample>(at_once);
  std::array<NormalModes, at_once> modes_{}, rigid_modes_{};
  std::optional<PoseNumbers> checked_{};  ///< what the next three belong to
  bool reached_{};
  double condition_{}, stroke_left_{};
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
  nominal.followed_shapes.resize(nominal.flexible.dof(), nominal.followed.size());
  for (std::size_t n = 0; n < nominal.followed.size(); ++n)
    nominal.followed_shapes.col(n) = nominal.modes.shapes.col(nominal.followed[n]);
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
  problem.batch = [kept = std::shared_ptr<const Kept>(kept)]() -> BatchModel {
    return [evaluation = Evaluation(kept)](std::span<const Row> rows) mutable {
      return evaluation(rows);
    };
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
