#include "state_space.hpp"

#include <Eigen/Cholesky>

namespace hydrapod::response {

StateSpace state_space(const ResponseModel& model, Output output) {
  const Eigen::Index n = model.M.rows(), arms = static_cast<Eigen::Index>(model.arms.size());
  const Eigen::LLT<ModelMatrix> llt(model.M);
  StateSpace system;
  system.A = Eigen::MatrixXd::Zero(2 * n + arms, 2 * n + arms);
  system.A.block(0, n, n, n).setIdentity();
  system.A.block(n, 0, n, n) = -llt.solve(model.K);
  system.A.block(n, n, n, n) = -llt.solve(damping_matrix(model));
  for (Eigen::Index j = 0; j < arms; ++j) {
    const auto& arm = model.arms[static_cast<std::size_t>(j)];
    const dynamics::ModelVector pushed = llt.solve(arm.s_y);
    system.A.col(2 * n + j).segment(n, n) = arm.stiffness * pushed;
    system.A.row(2 * n + j).head(n) = arm.rate * arm.s_y.transpose();
    system.A(2 * n + j, 2 * n + j) = -arm.rate;
  }
  system.B = Eigen::MatrixXd::Zero(2 * n + arms, 6);
  system.B.middleRows(n, n) = llt.solve(model.loads);
  system.C = Eigen::MatrixXd::Zero(6, 2 * n + arms);
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
