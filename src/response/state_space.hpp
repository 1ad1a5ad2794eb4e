#pragma once
/// The linear model as a state space, for controllers and other programs:
///
///     ẋ = A x + B u,   z = C x + D u,   x = (y; ẏ; η)
///
/// y: coordinates of the model with the platform's taken at the point Q of the ResponseModel; u:
/// its six inputs (force [N] and moment [N m] at Q, or actuator forces mapped there); z: six
/// outputs, displacement, velocity or acceleration of the platform at Q. C (jωI − A)⁻¹ B + D is
/// frequency_response. η [m]: one per arm of chambers that relax (dynamics::RelaxingArm).

#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::response {

struct StateSpace {
  Eigen::MatrixXd A{};  ///< square, 2n rows for n degrees of freedom and one per arm
  Eigen::MatrixXd B{};  ///< with 6 columns
  Eigen::MatrixXd C{};  ///< with 6 rows
  Eigen::MatrixXd D{};  ///< 6×6, zero but for accelerations
};

/// Modal ratios are in A as the damping matrix M Φ diag(2ζω) Φᵀ M.
StateSpace state_space(const ResponseModel& model, Output output = Output::displacement);

}  // namespace hydrapod::response
