// The kernel for every processor.
#include "lane_kernel.hpp"

namespace hydrapod::study {

LaneKernels plain_kernels() { return kernels<One<2>>(); }

}  // namespace hydrapod::study
