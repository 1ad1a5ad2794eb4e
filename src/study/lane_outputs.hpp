#pragma once
/// What a row of a study says of the modes (machine_problem.cpp), of several designs at once.
/// Private to the kernels.
///
/// Modes stand in no order: "the lowest mode that …" is the one of least ω² among those that do.

#include "lane_eigen.hpp"

namespace hydrapod::study {

namespace {

constexpr double no_mode = 1e300;  ///< an ω² above all

template <class V>
HYDRAPOD_INLINE V or_nothing(const V& omega2) {
  return select(omega2 < no_mode, omega2, V{} / V{});
}

/// ω² of the first resonances per direction, their φ_d², and Σ φ_d² of all modes.
template <class V, int flexible>
HYDRAPOD_INLINE void resonances(const ModeNumbers<V, flexible>& modes, double share, V (&out)[6],
                                V (&of_first)[6], V (&of_all)[6]) {
  for (int d = 0; d < 6; ++d) {
    V all{}, least = V{} + no_mode, of_least{};
    for (const auto& phi : modes.shapes) all += phi[d] * phi[d];
    for (int k = 0; k < modes_of(flexible); ++k) {
      const V own = modes.shapes[k][d] * modes.shapes[k][d];
      const auto first = ~(own < share * all) & (modes.omega2[k] < least);
      least = select(first, modes.omega2[k], least);
      of_least = select(first, own, of_least);
    }
    out[d] = or_nothing(least);
    of_first[d] = of_least;
    of_all[d] = all;
  }
}

/// M of the platform alone times its part of a shape.
template <class V>
HYDRAPOD_INLINE void platform_momentum(const MachineNumbers<V>& machine, const V* phi, V (&p)[6]) {
  for (int i = 0; i < 3; ++i) {
    p[i] = machine.m * phi[i];
    V sum{};
    for (int j = 0; j < 3; ++j) sum += machine.inertia[BlockMatrix<V, 0>::below(i, j)] * phi[3 + j];
    p[3 + i] = sum;
  }
}

/// The lowest mode with platform motion: ω², main direction, momentum of the platform.
template <class V, int flexible>
HYDRAPOD_INLINE void lowest_mode(const MachineNumbers<V>& machine,
                                 const ModeNumbers<V, flexible>& modes,
                                 const V (&momentum)[modes_of(flexible)][modes_of(flexible)],
                                 double local, OutputNumbers<V>& out) {
  V least = V{} + no_mode, phi[6], p[6];
  for (int d = 0; d < 6; ++d) phi[d] = out.momentum[d] = V{};
  for (int k = 0; k < modes_of(flexible); ++k) {
    platform_momentum(machine, modes.shapes[k], p);
    V energy{};
    for (int d = 0; d < 6; ++d) energy += modes.shapes[k][d] * p[d];
    const auto lower = ~(energy < local) & (modes.omega2[k] < least);
    least = select(lower, modes.omega2[k], least);
    for (int d = 0; d < 6; ++d) {
      phi[d] = select(lower, modes.shapes[k][d], phi[d]);
      out.momentum[d] = select(lower, momentum[k][d], out.momentum[d]);
    }
  }
  out.lowest = or_nothing(least);
  platform_momentum(machine, phi, p);
  V most = phi[0] * p[0], main{};
  for (int d = 1; d < 6; ++d) {
    const auto larger_one = phi[d] * p[d] > most;
    most = select(larger_one, phi[d] * p[d], most);
    main = select(larger_one, V{} + static_cast<double>(d), main);
  }
  out.direction = main;
}

/// ω² of the mode with rigid legs that is most like the lowest one, and their MAC.
template <class V>
HYDRAPOD_INLINE void counterpart(const ModeNumbers<V, 0>& rigid, OutputNumbers<V>& out) {
  V alike = V{} - 1.0;
  for (int k = 0; k < 6; ++k) {
    V common{};
    for (int d = 0; d < 6; ++d) common += rigid.shapes[k][d] * out.momentum[d];
    const auto better = size_of(common) > alike;
    alike = select(better, size_of(common), alike);
    out.counterpart = select(better, rigid.omega2[k], k == 0 ? rigid.omega2[0] : out.counterpart);
  }
  out.counterpart_share = alike * alike;
}

/// MAC of the followed modes, a row each, with the modes.
template <class V, int flexible>
HYDRAPOD_APART void likeness(const LaneOptions& options, const BlockMatrix<V, flexible>& M,
                             const V (&momentum)[modes_of(flexible)][modes_of(flexible)],
                             V (&mac)[modes_of(flexible)][modes_of(flexible)]) {
  constexpr int size = modes_of(flexible);
  V own[2][size], with[2][size];
  for (int n = 0; n < options.followed; ++n) {
    const double* const psi = options.shapes + n * size;
    if (n % 2 == 0) {  // the last one beside itself, where it has no other
      const double* const next = n + 1 < options.followed ? psi + size : psi;
      for (int i = 0; i < size; ++i) {
        own[0][i] = V{} + psi[i];
        own[1][i] = V{} + next[i];
      }
      times_shapes<V, flexible>(M, own[0], own[1], with[0], with[1]);
    }
    V mass{};
    for (int i = 0; i < size; ++i) mass += psi[i] * with[n % 2][i];
    const V per_mass = 1.0 / mass;
    for (int k = 0; k < size; ++k) {
      V common{};
      for (int i = 0; i < size; ++i) common += psi[i] * momentum[k][i];
      mac[n][k] = common * common * per_mass;
    }
  }
}

/// The largest number of a row, and where it stands.
template <class V, int size>
HYDRAPOD_INLINE void largest_in(const V (&row)[size], V& best, V& at) {
  best = row[0];
  at = V{};
  for (int k = 1; k < size; ++k) {
    const auto better = row[k] > best;
    best = select(better, row[k], best);
    at = select(better, V{} + static_cast<double>(k), at);
  }
}

/// Pairs (nominal, mode) in falling order of MAC, one to one. Nearly always each nominal mode has a
/// mode of its own that it is most like; else pairs are taken one after the other.
template <class V, int flexible>
HYDRAPOD_APART void follow(const LaneOptions& options,
                           V (&mac)[modes_of(flexible)][modes_of(flexible)],
                           const ModeNumbers<V, flexible>& modes, OutputNumbers<V>& out) {
  constexpr int size = modes_of(flexible);
  V best[size], like[size], pair_mac[size], pair[size];
  out.mac = V{} + 1.0;
  auto shared = ~(out.mac == 1.0);
  for (int n = 0; n < options.followed; ++n) {
    largest_in(mac[n], best[n], like[n]);
    pair_mac[n] = best[n];
    pair[n] = like[n];
    for (int m = 0; m < n; ++m) shared = shared | (like[m] == like[n]);
  }
  for (int taken = 0; taken < options.followed && any(shared); ++taken) {
    V most = V{} - 3.0, row{}, column{};
    for (int n = 0; n < options.followed; ++n) {
      const auto better = best[n] > most;
      most = select(better, best[n], most);
      row = select(better, V{} + static_cast<double>(n), row);
      column = select(better, like[n], column);
    }
    for (int n = 0; n < options.followed; ++n) {
      const auto this_row = row == static_cast<double>(n);
      pair_mac[n] = select(this_row, most, pair_mac[n]);
      pair[n] = select(this_row, column, pair[n]);
      for (int k = 0; k < size; ++k)
        mac[n][k] = select(this_row, V{} - 2.0,
                           select(column == static_cast<double>(k), V{} - 1.0, mac[n][k]));
      largest_in(mac[n], best[n], like[n]);
    }
  }
  for (int n = 0; n < options.followed; ++n) {
    V omega2 = modes.omega2[0];
    for (int k = 1; k < size; ++k)
      omega2 = select(pair[n] == static_cast<double>(k), modes.omega2[k], omega2);
    out.followed[n] = omega2;
    out.mac = select(pair_mac[n] < out.mac, pair_mac[n], out.mac);
  }
}

/// 1 where two ω² count as one (modal/normal_modes.hpp).
template <class V, int flexible>
HYDRAPOD_INLINE V repeated(const ModeNumbers<V, flexible>& modes, double tolerance) {
  constexpr int size = modes_of(flexible);
  V largest{}, found{};
  for (const V& one : modes.omega2) largest = larger(size_of(one), largest);
  const V rounding = (64.0 * rounding_unit) * largest;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < i; ++j) {
      const V lower = select(modes.omega2[i] < modes.omega2[j], modes.omega2[i], modes.omega2[j]);
      const V apart = size_of(V(modes.omega2[i] - modes.omega2[j]));
      const auto near = apart < larger(V(tolerance * size_of(lower)), rounding);
      found = select(near, V{} + 1.0, found);
    }
  return found;
}

template <class V, int flexible>
HYDRAPOD_INLINE V least_of(const ModeNumbers<V, flexible>& modes) {
  V least = modes.omega2[0];
  for (const V& one : modes.omega2) least = select(one < least, one, least);
  return least;
}

}  // namespace

}  // namespace hydrapod::study
