#pragma once
/// The columns of machine_problem() and how they follow from modes. Private to the module.

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/study/study.hpp"
#include "lane_numbers.hpp"

namespace hydrapod::study {

inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Modes of the nominal machine that samples are compared with.
struct Nominal {
  dynamics::LinearModel flexible{}, rigid{};
  modal::NormalModes modes{};
  std::vector<int> followed{};
  dynamics::ModelMatrix followed_shapes{};  ///< their columns
};

/// Where a machine stands now: in its pose of that name, if it has one, else at X_BP.
inline const spatial::Pose& pose_now(const model::Machine& machine, const std::string& name,
                                     const spatial::Pose& X_BP) {
  const auto* own = model::find_pose(machine, name);
  return own == nullptr ? X_BP : own->X_BP;
}

struct Kept {
  model::Machine machine{};
  std::vector<Input> inputs{};
  MachineOptions options{};
  Nominal nominal{};
  std::shared_ptr<const Interruption> interruption{};
};

/// Throws base::ComputationError where the nominal machine has no modes.
Nominal nominal_of(const model::Machine& machine, const MachineOptions& options);

struct Layout {
  static constexpr int status = 0, lowest = 1, direction = 2, drop = 3, share = 4, peak = 5,
                       resonance = 6, resonance_drop = 12, resonance_share = 18,
                       resonance_peak = 24, condition = 30, stroke = 31, mac = 32, modes = 33;
};

/// Without extra outputs, which stand behind.
std::vector<Column> columns_of(const Kept& kept);
/// Why a machine does not have one of these; none: it has it, or it is none of these.
std::optional<std::string> why_no_column(const model::Machine& machine, dynamics::ModelKind kind,
                                         std::string_view name);

inline void set(std::span<double> outputs, Status status) {
  outputs[Layout::status] = static_cast<double>(status);
}

/// Fills all columns that follow from the modes. Buckled machines have a status alone.
void outputs_of(const Kept& kept, const dynamics::LinearModel& flexible,
                const modal::NormalModes& modes, const modal::NormalModes& rigid,
                std::span<double> outputs);
/// Puts what follows from the rigid model's modes into `found`.
void take_rigid(const Kept& kept, const modal::NormalModes& rigid, OutputNumbers<double>& found);
/// Fills the columns from what the kernels found.
void outputs_of(const Kept& kept, const OutputNumbers<double>& found, std::span<double> outputs);

}  // namespace hydrapod::study
