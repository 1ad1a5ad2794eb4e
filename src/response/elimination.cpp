#include "elimination_kernel.hpp"

namespace hydrapod::response {

void eliminate(const ResponseModel& model, std::span<const double> omega, std::span<Matrix6c> out) {
  if (!model.arms.empty()) return eliminate_relaxing(model, omega, out);
  eliminate_lanes(model, omega, out, [](const Frequencies& f) -> const Frequencies& { return f; });
}

}  // namespace hydrapod::response
