#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/study/study.hpp"
#include "lane_designs.hpp"
#include "lane_machine.hpp"
#include "machine_outputs.hpp"

namespace hydrapod::study {

struct DesignFrequencies::Implementation {
  model::Machine machine;
  spatial::Pose X_BP;
  std::string pose;  ///< its name
  dynamics::ModelKind kind;
  std::vector<model::Assignment> assignments;
  LaneDesigns designs;
  dynamics::StaticEquilibrium nominal{};      ///< where searches for equilibrium begin
  std::array<double*, most_lanes> waiting{};  ///< where their frequencies go
  std::array<const double*, most_lanes> values{};

  [[nodiscard]] std::size_t modes() const {
    return static_cast<std::size_t>(dynamics::degrees_of_freedom(machine, kind));
  }

  void assign(const double* numbers) {
    for (auto& assignment : assignments) assignment.value = *numbers++;
    model::assign(machine, assignments);
    X_BP = pose_now(machine, pose, X_BP);
  }

  void put(const dynamics::NormalModes& found, double* omega) const {
    for (std::size_t k = 0; k < modes(); ++k) omega[k] = found.omega(static_cast<int>(k));
  }

  void alone(double* omega) const {
    try {
      const auto model = dynamics::linear_model(machine, X_BP, kind);
      put(modal::modes_with_elastomers(machine, model), omega);
    } catch (const base::ComputationError&) {
      std::fill_n(omega, modes(), std::numeric_limits<double>::quiet_NaN());
    }
  }

  /// Of the first `count` lanes: without shapes where that is exact enough, else with shapes, else
  /// one at a time.
  void finish(int count) {
    if (count == 0) return;
    std::array<bool, most_lanes> left{};
    designs.solve_frequencies(count);
    for (int lane = 0; lane < count; ++lane) {
      const auto at = static_cast<std::size_t>(lane);
      left[at] = !designs.frequencies(lane, waiting[at]);
      if (left[at]) continue;
      for (std::size_t k = 0; k < modes(); ++k)
        waiting[at][k] = std::sqrt(std::max(waiting[at][k], 0.0));
    }
    if (std::ranges::count(left, true) == 0) return;
    designs.solve(count);
    for (int lane = 0; lane < count; ++lane) {
      const auto at = static_cast<std::size_t>(lane);
      if (!left[at]) continue;
      if (designs.sound(lane)) {
        put(designs.modes(lane), waiting[at]);
      } else {
        assign(values[at]);
        alone(waiting[at]);
      }
    }
  }
};

DesignFrequencies::DesignFrequencies(const model::Machine& machine, const spatial::Pose& X_BP,
                                     dynamics::ModelKind kind,
                                     const std::vector<model::ParameterId>& ids, std::string pose)
    : implementation_(
          new Implementation{.machine = machine,
                             .X_BP = X_BP,
                             .pose = std::move(pose),
                             .kind = kind,
                             .assignments = {},
                             .designs = {usable_kernels().front(),
                                         kind,
                                         lane_options(machine, MachineOptions{}.resonance_share),
                                         {}}}) {
  for (const auto& id : ids) implementation_->assignments.push_back({id, 0.0});
}
DesignFrequencies::DesignFrequencies(DesignFrequencies&&) noexcept = default;
DesignFrequencies::~DesignFrequencies() = default;

void DesignFrequencies::operator()(std::span<const double> values, std::span<double> omega) {
  auto& of = *implementation_;
  const std::size_t columns = of.assignments.size(), modes = of.modes();
  int waiting = 0;
  for (std::size_t at = 0; at * modes < omega.size(); ++at) {
    const double* numbers = values.data() + at * columns;
    double* out = omega.data() + at * modes;
    of.assign(numbers);
    if (!fits_lanes(of.machine) || of.machine.gravity.isZero(0.0) == of.designs.options().gravity) {
      of.alone(out);
      continue;
    }
    of.designs.put(waiting, lane_numbers(of.machine, of.X_BP, nullptr, nullptr));
    of.values[static_cast<std::size_t>(waiting)] = numbers;
    of.waiting[static_cast<std::size_t>(waiting)] = out;
    if (++waiting == of.designs.lanes()) of.finish(std::exchange(waiting, 0));
  }
  of.finish(waiting);
}

}  // namespace hydrapod::study
