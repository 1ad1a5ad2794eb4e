// The kernel for processors with AVX-512; compiled with the flags for them (CMakeLists.txt).
#include "lane_numbers.hpp"

#if defined(__AVX512F__)
#include "lane_kernel.hpp"

namespace hydrapod::study {

LaneKernels avx512_kernels() { return kernels<One<8>>(); }

}  // namespace hydrapod::study
#else
namespace hydrapod::study {

LaneKernels avx512_kernels() { return {}; }

}  // namespace hydrapod::study
#endif
