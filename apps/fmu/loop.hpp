#pragma once
/// The controller inside an FMU, as simulation::ClosedLoop has it: at every sample t_k = start + k
/// T it reads the sensors, here without their faults, and computes drives, which reach the valves
/// at t_k + delay · T and stay until the next ones do.

#include <deque>
#include <vector>

#include "hydrapod/control/controller.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::fmu {

using spatial::Vector6;

class Loop {
 public:
  /// Tuned for the plant's machine at `operating`, from which commands are displacements. Throws
  /// base::ComputationError where it cannot be tuned.
  Loop(const simulation::Plant& plant, const spatial::Pose& operating);

  /// Takes over the machine at rest at `time`.
  void start(double time, const simulation::Plant& plant, const simulation::Plant::Rest& rest);

  /// The time of the next sample, or of the next drive that reaches the valves.
  [[nodiscard]] double next() const;
  [[nodiscard]] bool is_due(double time) const { return next() <= time + slack_; }
  /// All that is due at `time`. `commands`: displacement x … rz and its rates, twelve numbers.
  /// Throws base::ComputationError where the controller finds no pose.
  void pass(double time, const simulation::Plant& plant, const double* x, const double* commands,
            const Vector6& wrench);

  [[nodiscard]] const Vector6& applied() const { return applied_; }

  [[nodiscard]] std::vector<double> save() const;
  /// Can so many numbers be what save() gives?
  static bool fits(std::size_t count);
  /// What save() gave.
  void restore(const std::vector<double>& numbers);

 private:
  struct Pending {
    double time{};
    Vector6 drives{Vector6::Zero()};
  };
  [[nodiscard]] double sample_time() const { return controller_.parameters().sample_time; }
  [[nodiscard]] double tick_time() const { return start_ + sample_time() * ticks_; }
  void apply_due(double time);

  spatial::Pose operating_;
  control::Controller controller_;
  double slack_;  ///< instants closer than this are one
  double start_{}, ticks_{};
  Vector6 applied_{Vector6::Zero()};
  std::deque<Pending> pending_{};
};

}  // namespace hydrapod::fmu
