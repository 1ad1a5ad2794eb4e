#pragma once
/// Terms of the cost of a pair, see pairing.hpp. Private to the module.

#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::observation {

double frequency_cost(double omega, double wanted, const ObservationOptions& options);

/// `shown`: MAC with the group; `alone`: with the mode; `felt`: its energy over the group's
/// largest.
double shape_cost(double shown, double alone, double felt, const ObservationOptions& options);

/// uᴴ P u for motions A, in one metric, u of length one.
double share_shown(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& u, double weak);

/// The platform's share of the kinetic energy of a mode; `mass`: LinearModel::platform_mass.
double felt_energy(const ObservedMode& mode, const spatial::Matrix6& mass);

/// Turned so that the sum of the squares of the real parts is largest, and real.
Vector6c turned_to_real(const Vector6c& motion);

/// U with UᵀU = M, symmetric.
spatial::Matrix6 metric_root(const spatial::Matrix6& mass);

}  // namespace hydrapod::observation
