#include "hydrapod/calibration/observation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::calibration {

namespace {

using Complex = std::complex<double>;

/// Plant::scales for small changes of the state, which have three rotations for the quaternion.
Eigen::VectorXd tangent_scales(const simulation::Plant& plant) {
  const Eigen::VectorXd scales = plant.scales();
  Eigen::VectorXd tangent(scales.size() - 1);
  tangent << scales.head<3>(), scales.segment<3>(4), scales.tail(scales.size() - 7);
  return tangent;
}

/// Motion of the base at the origin of B in the modes `V`, columns in units of the states.
Eigen::Matrix<Complex, 6, Eigen::Dynamic> base_motion(const simulation::Plant& plant,
                                                      const Eigen::MatrixXcd& V,
                                                      const Eigen::VectorXd& scales) {
  Eigen::Matrix<Complex, 6, Eigen::Dynamic> motion =
      Eigen::Matrix<Complex, 6, Eigen::Dynamic>::Zero(6, V.cols());
  const auto& base = plant.base();
  const int first = plant.layout().base - 1;  // a small change has one state less
  for (int k = 0; k < base.count; ++k)
    motion.row(base.directions[static_cast<std::size_t>(k)]) = scales[first + k] * V.row(first + k);
  return motion;
}

}  // namespace

Eigen::Matrix<Complex, 6, 6> Observation::response(Complex s, MotionAgainst against) const {
  const auto& motion = against == MotionAgainst::ground ? to_ground : output;
  return motion * (s - poles.array()).inverse().matrix().asDiagonal() * input;
}

Observation observe_plant(const model::Machine& machine, const spatial::Pose& X_BP,
                          dynamics::ModelKind kind) {
  const simulation::Plant plant(machine, kind, {.friction = simulation::Friction::viscous}, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  const auto linear = plant.linearise(rest.x, rest.input);
  const Eigen::VectorXd scales = tangent_scales(plant);
  const Eigen::MatrixXd A = scales.cwiseInverse().asDiagonal() * linear.A * scales.asDiagonal();
  if (!A.allFinite()) throw base::ComputationError("the plant is not finite with these values");
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success)
    throw base::ComputationError("the poles of the plant could not be computed");
  const Eigen::MatrixXcd V = solver.eigenvectors();

  Observation seen{.mechanics = dynamics::linear_model(machine, X_BP, kind)};
  const int dof = seen.mechanics.dof();
  seen.poles = solver.eigenvalues();
  const Eigen::MatrixXcd motion = scales.head(dof).asDiagonal() * V.topRows(dof);
  seen.output = motion.topRows<6>();
  seen.input = V.partialPivLu().solve(
      (scales.cwiseInverse().asDiagonal() * linear.B.leftCols<6>()).cast<Complex>());
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.topRightCorner<3, 3>() = -spatial::skew(seen.mechanics.p_BC);
  const auto base = base_motion(plant, V, scales);
  seen.to_ground = seen.output + to_center.cast<Complex>() * base;
  for (Eigen::Index k = 0; k < seen.poles.size(); ++k) {
    if (!(seen.poles[k].imag() > 0.0)) continue;
    ObservedMode mode{
        .pole = seen.poles[k], .shape = motion.col(k), .against_base = motion.col(k).head<6>()};
    mode.shape.head<6>() += to_center.cast<Complex>() * base.col(k);
    const Eigen::VectorXcd momentum = seen.mechanics.M.cast<Complex>() * mode.shape;
    const double energy = mode.shape.dot(momentum).real();
    if (!(energy > 0.0)) continue;  // oil and valves alone
    mode.shape /= std::sqrt(energy);
    mode.against_base /= std::sqrt(energy);
    mode.input = seen.input.row(k) * std::sqrt(energy);
    seen.modes.push_back(std::move(mode));
  }
  std::ranges::sort(seen.modes, {}, &ObservedMode::omega);
  return seen;
}

}  // namespace hydrapod::calibration
