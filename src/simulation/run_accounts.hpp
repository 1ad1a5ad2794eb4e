#pragma once
/// What a run adds up as it goes. Private to the module.

#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::simulation {

class RunAccounts {
 public:
  RunAccounts(const Plant& plant, const Pose& operating, const Vector6& settling_band);

  /// One controller sample.
  void see(const Eigen::VectorXd& x, const Vector6& applied, const Vector6& command,
           const control::ControllerState& controller, double time);
  [[nodiscard]] RunSummary finish(double time);

  RunSummary summary{};

 private:
  const Plant& plant_;
  const Pose& operating_;
  Vector6 settling_band_;
  Vector6 squares_{Vector6::Zero()};
  Vector6 lengths_{Vector6::Zero()};
};

}  // namespace hydrapod::simulation
