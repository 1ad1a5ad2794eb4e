#pragma once
/// Designs of one study, as many at once as there are SIMD lanes: from a machine to the outputs
/// that follow from its modes. Private to the module.
///
/// The method is that of dynamics::linear_model() and modal::normal_modes(), and so is the result
/// but for rounding. The kernel is lane_kernel.hpp, a template over the vector type and the
/// flexible coordinates per leg. It is compiled once per instruction set (lane_kernel_*.cpp); which
/// one runs is decided by the processor. What a design has does not depend on the designs beside
/// it.

#include <cstddef>
#include <memory>
#include <span>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "lane_numbers.hpp"

namespace hydrapod::study {

/// Those that this processor can run, the fastest first.
std::span<const LaneKernels> usable_kernels();

class LaneDesigns {
 public:
  /// `followed`: shapes of the modes that samples are compared with, a column each.
  LaneDesigns(const LaneKernels& kernels, dynamics::ModelKind kind, const LaneOptions& options,
              const dynamics::ModelMatrix& followed);
  LaneDesigns(LaneDesigns&&) noexcept;
  ~LaneDesigns();

  [[nodiscard]] int lanes() const { return kernels_.lanes; }
  [[nodiscard]] const LaneOptions& options() const { return options_; }
  void put(int lane, const MachineNumbers<double>& numbers);
  /// The designs of the first `count` lanes.
  void solve(int count);
  /// Their frequencies alone: after this only the next is to be asked.
  void solve_frequencies(int count);
  /// ω² of design `lane`, ascending, to `omega2`. False where they are not known to 1e-12 of each:
  /// sums of eigenvalues that must hold do not, or ω² is below 3e-4 of the largest, of whose
  /// rounding unit all have an error.
  [[nodiscard]] bool frequencies(int lane, double* omega2) const;

  /// Whether an equilibrium was found and ‖D^-½ (K φ − ω² M φ)‖ ≤ 1e-12 ω²_max and
  /// |φᵀ M φ − 1| ≤ 1e-12 hold for every mode (D: the diagonal of M), of the rigid model too. Where
  /// they do not, the design must be computed alone.
  [[nodiscard]] bool sound(int lane) const;
  [[nodiscard]] OutputNumbers<double> outputs(int lane) const;
  /// The modes as normal_modes() gives them, and what linear_model() gives of M and K.
  [[nodiscard]] modal::NormalModes modes(int lane) const;
  [[nodiscard]] modal::NormalModes rigid_modes(int lane) const;
  /// M, masses of the platform and kind: what is needed beside the modes.
  void model(int lane, dynamics::LinearModel& model) const;
  [[nodiscard]] dynamics::ModelMatrix mass(int lane) const;
  [[nodiscard]] dynamics::ModelMatrix stiffness(int lane) const;

 private:
  struct Buffers;
  void run(const LaneKernel& kernel, int count);
  /// Lane `lane` of the member of ModelNumbers at `offset` bytes.
  [[nodiscard]] const double* at(std::size_t offset, int lane) const;
  LaneKernels kernels_;
  dynamics::ModelKind kind_;
  LaneOptions options_;
  dynamics::ModelMatrix followed_;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace hydrapod::study
