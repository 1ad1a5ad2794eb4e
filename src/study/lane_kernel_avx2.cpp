// The kernel for processors with AVX2 with FMA; compiled with the flags for them (CMakeLists.txt).
#include "lane_numbers.hpp"

#if defined(__AVX2__) && defined(__FMA__)
#include "lane_kernel.hpp"

namespace hydrapod::study {

LaneKernels avx2_kernels() { return kernels<Pair<4>>(); }

}  // namespace hydrapod::study
#else
namespace hydrapod::study {

LaneKernels avx2_kernels() { return {}; }

}  // namespace hydrapod::study
#endif
