#include "elimination_kernel.hpp"

namespace hydrapod::response {

void eliminate(const ResponseModel& model, std::span<const double> omega, std::span<Matrix6c> out) {
  if (!model.arms.empty()) return eliminate_relaxing(model, omega, out);
  for (size_t first = 0; first < omega.size(); first += lanes) {
    const size_t count = std::min<size_t>(lanes, omega.size() - first);
    Frequencies f;
    for (size_t k = 0; k < lanes; ++k)
      f.omega[static_cast<Eigen::Index>(k)] = omega[first + std::min(k, count - 1)];
    f.omega2 = f.omega.square();
    const Block<6, 6> H = solve(model, f);
    for (size_t k = 0; k < count; ++k)
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r)
          out[first + k](r, c) = Complex(H[r][c].re[static_cast<Eigen::Index>(k)],
                                         H[r][c].im[static_cast<Eigen::Index>(k)]);
  }
}

}  // namespace hydrapod::response
