#pragma once
/// Modes of several designs at once, one design per SIMD lane. Private to the module.
///
/// The kernel is lane_kernel.hpp, a template over the vector type and the flexible coordinates per
/// leg. It is compiled once per instruction set (lane_kernel_*.cpp); which one runs is decided by
/// the processor. Each lane computes what it would compute alone: the modes of a design do not
/// depend on the designs beside it.
///
/// M and K come packed: the lower triangle of the platform's block by rows (21 numbers), then per
/// leg its rows against the platform (flexible × 6) and the lower triangle of its own block.

namespace hydrapod::study {

inline constexpr int most_lanes = 8;

constexpr int packed_numbers(int flexible) {
  return 21 + 6 * (6 * flexible + flexible * (flexible + 1) / 2);
}

/// Number k of design d stands at [k * lanes + d]. Everything is aligned to 64 bytes.
struct LaneTask {
  const double* M{};
  const double* K{};
  double* omega2{};    ///< [mode], in no order
  double* shapes{};    ///< [mode][row]
  double* residual{};  ///< one number; see lane_kernel.hpp. NaN where the design failed
};

struct LaneKernels {
  int lanes{};
  void (*rigid)(const LaneTask&){};
  void (*guide)(const LaneTask&){};
  void (*full)(const LaneTask&){};
};

/// Those of an instruction set; lanes = 0 where the compiler does not know it.
LaneKernels plain_kernels();
LaneKernels avx2_kernels();
LaneKernels avx512_kernels();

}  // namespace hydrapod::study
