// The kernel for every processor.
#include "lane_kernel.hpp"

namespace hydrapod::modal {

LaneKernels plain_kernels() { return kernels<One<2>>(); }

}  // namespace hydrapod::modal
