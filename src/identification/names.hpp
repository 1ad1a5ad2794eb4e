#pragma once
/// Short names that the sources of the module share. Private to the module.

#include <Eigen/Core>
#include <complex>

#include "hydrapod/base/units.hpp"

namespace hydrapod::identification {

using base::two_pi;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

}  // namespace hydrapod::identification
