#include "state_space.hpp"

#include <Eigen/Cholesky>

namespace hydrapod::response {

StateSpace state_space(const ResponseModel& model, Output output) {
  const Eigen::Index n = model.M.rows();
  const Eigen::LLT<ModelMatrix> llt(model.M);
  StateSpace system;
  system.A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  system.A.topRightCorner(n, n).setIdentity();
  system.A.bottomLeftCorner(n, n) = -llt.solve(model.K);
  system.A.bottomRightCorner(n, n) = -llt.solve(damping_matrix(model));
  system.B = Eigen::MatrixXd::Zero(2 * n, 6);
  system.B.bottomRows(n) = llt.solve(model.loads);
  system.C = Eigen::MatrixXd::Zero(6, 2 * n);
  system.D = Eigen::MatrixXd::Zero(6, 6);
  switch (output) {
    case Output::displacement:
      system.C.leftCols(6).setIdentity();
      break;
    case Output::velocity:
      system.C.middleCols(n, 6).setIdentity();
      break;
    case Output::acceleration:
      system.C = system.A.middleRows(n, 6);
      system.D = system.B.middleRows(n, 6);
      break;
  }
  return system;
}

}  // namespace hydrapod::response
