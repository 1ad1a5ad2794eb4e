#pragma once
/// Designs from their numbers to the outputs of a study, several at once: assembly and equilibrium
/// (lane_assembly.hpp), modes (lane_eigen.hpp), outputs (lane_outputs.hpp). Each lane computes what
/// it would compute alone.
///
/// Included once by each lane_kernel_*.cpp, which are compiled for different processors.

#include "lane_assembly.hpp"
#include "lane_frequencies.hpp"
#include "lane_outputs.hpp"

namespace hydrapod::study {

namespace {

/// Modes of the rigid model. Without preload it is the platform's part of the flexible one.
template <class V, int flexible>
V rigid_modes(const MachineNumbers<V>& machine, const LaneOptions& options,
              ModelNumbers<V, flexible>& model) {
  V momentum[6][6], failed{};
  if (options.gravity) {
    failed = assemble<V, 0>(machine, options, model.M_rigid, model.K_rigid);
  } else {
    for (int k = 0; k < 21; ++k) {
      model.M_rigid.platform[k] = model.M.platform[k];
      model.K_rigid.platform[k] = model.K.platform[k];
    }
  }
  return modes_of_lanes<V, 0>(model.M_rigid, model.K_rigid, model.rigid, momentum) + failed;
}

/// Where it is asked for, and for lanes whose modes repeat: their outputs follow from both models.
template <class V, int flexible>
HYDRAPOD_INLINE void compare_with_rigid(const MachineNumbers<V>& machine,
                                        const LaneOptions& options,
                                        ModelNumbers<V, flexible>& model, OutputNumbers<V>& out) {
  const auto repeat = ~(out.repeated == 0.0);
  const V one = V{} + 1.0;
  if (!options.rigid && !any(repeat)) {
    out.repeated_rigid = V{};
    out.counterpart = out.counterpart_share = one;
    for (int d = 0; d < 6; ++d) out.resonance_rigid[d] = out.own_rigid[d] = one;
    return;
  }
  const V of_rigid = rigid_modes<V, flexible>(machine, options, model);
  const V both = larger(out.residual, of_rigid) + 0.0 * (out.residual + of_rigid);
  out.residual = options.rigid ? both : select(repeat, both, out.residual);
  out.repeated_rigid = repeated<V, 0>(model.rigid, options.repeated_tolerance);
  V all_rigid[6];
  resonances<V, 0>(model.rigid, options.resonance_share, out.resonance_rigid, out.own_rigid,
                   all_rigid);
  counterpart<V>(model.rigid, out);
}

template <class V, int flexible>
void designs_of_lanes(const LaneTask& task) {
  const auto& machine = *reinterpret_cast<const MachineNumbers<V>*>(task.machines);
  const auto& options = *task.options;
  auto& model = *reinterpret_cast<ModelNumbers<V, flexible>*>(task.models);
  auto& out = *reinterpret_cast<OutputNumbers<V>*>(task.outputs);
  V momentum[modes_of(flexible)][modes_of(flexible)];
  const V failed = assemble<V, flexible>(machine, options, model.M, model.K);
  const V residual = modes_of_lanes<V, flexible>(model.M, model.K, model.modes, momentum) + failed;
  out.residual = residual;
  out.least = least_of<V, flexible>(model.modes);
  out.repeated = repeated<V, flexible>(model.modes, options.repeated_tolerance);
  resonances<V, flexible>(model.modes, options.resonance_share, out.resonance, out.own, out.all);
  lowest_mode<V, flexible>(machine, model.modes, momentum, options.local_mode_energy, out);
  compare_with_rigid<V, flexible>(machine, options, model, out);
  V mac[modes_of(flexible)][modes_of(flexible)];
  likeness<V, flexible>(options, model.M, momentum, mac);
  follow<V, flexible>(options, mac, model.modes, out);
}

/// `width` doubles.
template <int width>
using One = typename LaneTypes<width>::Vector;
/// Twice as many.
template <int width>
using Pair = Two<One<width>, typename LaneTypes<width>::Mask>;

template <class V>
LaneKernels kernels() {
  return {static_cast<int>(sizeof(V) / sizeof(double)),
          {designs_of_lanes<V, 0>, designs_of_lanes<V, 2>, designs_of_lanes<V, 4>},
          {frequencies_of_lanes<V, 0>, frequencies_of_lanes<V, 2>, frequencies_of_lanes<V, 4>}};
}

#undef HYDRAPOD_APART
#undef HYDRAPOD_INLINE

}  // namespace

}  // namespace hydrapod::study
