#pragma once
/// What the kernels of lane_kernel.hpp read of a machine and what they write. Private to the
/// module.
///
/// Each struct holds nothing but T. With T = double it is one design; with T = a vector of lanes it
/// is several, number k of design d being double k * lanes + d.

namespace hydrapod::study {

inline constexpr int most_lanes = 8;
inline constexpr int leg_number = 6, platform_rows = 6;
inline constexpr int most_flexible = 4, most_modes = platform_rows + leg_number * most_flexible;
/// Modes of the nominal machine that a sample's are compared with.
inline constexpr int most_followed = most_modes;

constexpr int modes_of(int flexible) { return platform_rows + leg_number * flexible; }

/// SI; the letters of model::Leg and docs/notation.md.
template <class T>
struct LegNumbers {
  T L[3];     ///< from base to platform joint, in B
  T arm[3];   ///< from the platform's mass centre to the platform joint, in B
  T axis[3];  ///< dynamics::frame_axis()
  T l_mn, L_g;
  T m_t, r_b, I_t, I_ta, m_g, c_g, I_r, I_ra, I_c, m_a;
  T k_s, k_g;
  /// Oil with the piston at s: Σ A²/(V + V' s) of both chambers, V [m⁵/N] and V' [m⁴/N] over the
  /// bulk modulus, walls of lines included.
  T area_squared[2], volume[2], volume_slope[2];
  T gimbal_compliance;  ///< in series with the oil
  /// Where the searches for equilibrium begin: φ, u and the oil's force; that with rigid legs.
  T flexible[most_flexible], oil_force, oil_force_rigid;
};

template <class T>
struct MachineNumbers {
  T m;
  T inertia[6];  ///< of the platform about its mass centre, in B: lower triangle by rows
  T gravity[3];  ///< in B
  LegNumbers<T> legs[leg_number];
};

/// What a row of a study says of the modes.
template <class T>
struct OutputNumbers {
  T lowest;                          ///< ω² of the lowest mode with platform motion
  T direction;                       ///< its main one, 0 … 5
  T counterpart, counterpart_share;  ///< ω² of the rigid mode most like it, (ψᵀ M_r φ)²
  T resonance[platform_rows], resonance_rigid[platform_rows];  ///< ω²; NaN: there is none
  T own[platform_rows], own_rigid[platform_rows];              ///< their φ_d²
  T all[platform_rows];                                        ///< Σ φ_d² of all modes
  T followed[most_followed];                                   ///< ω²
  T mac;                                                       ///< the least of those
  T least;                                                     ///< ω² of the lowest mode
  T momentum[platform_rows];  ///< of the platform in that lowest mode: its rows of M φ
  /// 1: modes repeat, so that the numbers above are those of one basis of many; the same of the
  /// rigid model, for `counterpart` and `resonance_rigid`.
  T repeated, repeated_rigid;
  T residual;  ///< NaN: the design has to be computed alone; see lane_kernel.hpp
};

/// Undamped frequencies alone.
template <class T, int flexible>
struct FrequencyNumbers {
  T omega2[modes_of(flexible)];  ///< ascending
  T residual;                    ///< see lane_frequencies.hpp; NaN: there is no equilibrium
};

/// The modes themselves, where a design repeats some.
template <class T, int flexible>
struct ModeNumbers {
  T omega2[modes_of(flexible)];                      ///< in no order
  T shapes[modes_of(flexible)][modes_of(flexible)];  ///< [mode][row]
};

/// Blocks of a symmetric matrix of the model: legs touch each other through the platform only.
template <class T, int flexible>
struct BlockMatrix {
  static constexpr int n = flexible == 0 ? 1 : flexible;  // no arrays without elements
  T platform[platform_rows * (platform_rows + 1) / 2];    ///< lower triangle by rows
  struct Leg {
    T border[n][platform_rows];
    T own[n * (n + 1) / 2];  ///< lower triangle by rows
  };
  Leg legs[leg_number];

  [[nodiscard]] const T& rr(int i, int j) const { return platform[below(i, j)]; }
  [[nodiscard]] const T& fr(int leg, int i, int j) const { return legs[leg].border[i][j]; }
  [[nodiscard]] const T& ff(int leg, int i, int j) const { return legs[leg].own[below(i, j)]; }
  static constexpr int below(int i, int j) {
    return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
  }
};

template <class T, int flexible>
struct ModelNumbers {
  BlockMatrix<T, flexible> M, K;
  ModeNumbers<T, flexible> modes;
  BlockMatrix<T, 0> M_rigid, K_rigid;
  ModeNumbers<T, 0> rigid;
};

/// What all designs of a task have in common.
struct LaneOptions {
  bool gimbal{};                ///< model::FlexibleAxes::gimbal
  bool gravity{};               ///< else legs are straight
  double tolerance{};           ///< dynamics::StaticsOptions::tolerance
  double resonance_share{};     ///< MachineOptions::resonance_share
  double local_mode_energy{};   ///< modal::local_mode_energy
  double repeated_tolerance{};  ///< modal::repeated_tolerance
  bool rigid{true};             ///< counterparts with rigid legs are asked for
  int followed{};
  const double* shapes{};  ///< of the modes that are followed, one after the other
};

struct LaneTask {
  const double* machines{};  ///< MachineNumbers; aligned to 64 bytes, as are the next
  double* outputs{};         ///< OutputNumbers or FrequencyNumbers
  double* models{};          ///< ModelNumbers
  const LaneOptions* options{};
};

/// By flexible coordinates per leg.
struct LaneKernel {
  void (*rigid)(const LaneTask&){};
  void (*guide)(const LaneTask&){};
  void (*full)(const LaneTask&){};
};

/// The kernels of an instruction set.
struct LaneKernels {
  int lanes{};
  LaneKernel designs{}, frequencies{};
};

/// lanes = 0 where the compiler does not know the instruction set.
LaneKernels plain_kernels();
LaneKernels avx2_kernels();
LaneKernels avx512_kernels();

}  // namespace hydrapod::study
