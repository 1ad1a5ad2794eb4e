#pragma once
/// Three masses between springs and dampers, moved by forces of a sampled controller with a delay:
///
///     M q̈ + D q̇ + K q = u + d,   y = q + sensor noise,
///     u(k) = P e(k) + I Σ e T + V (e(k) − e(k − 1))/T,   e(k) = r(k) − y(k − 2)
///
/// or with excitation at the drive e = −y, u + r. d: forces that nobody measured. Forces are held
/// between samples. The modes that are looked for are those of M, D, K; the loop has others.
/// Shared by the short and the long test.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"
#include "measured_records.hpp"
#include "support/identification_score.hpp"
#include "tones.hpp"

namespace hydrapod::identification {

/// Poles, shapes and participations of M q̈ + D q̇ + K q = u with outputs q.
test::ModalSystem masses_and_springs(const Eigen::Matrix3d& M, const Eigen::Matrix3d& D,
                                     const Eigen::Matrix3d& K);

/// 5.48, 7.65 and 12.35 Hz, damped by 1.44, 2.37 and 3.51 %.
test::ModalSystem foreign_plant();

enum class Excitation { white, noise, sweep, multisine, drive };

struct ForeignLoop {
  Excitation excitation{};
  double from{0.9}, to{17.3};  ///< [Hz] of noise, sweep and multisine
  double level{1e-3};          ///< RMS of r [m]
  double sensors{2e-6};        ///< RMS of the noise on y [m]
  double forces{0.02};         ///< RMS of d [N]
  double integral{1.0};        ///< times I; the loop is stable below 4.21
  double duration{205.0};      ///< [s]
  std::vector<LoopTone> tones{};
  int drifting{-1};    ///< mode whose pole drifts during the record; −1: none
  double drift{0.02};  ///< from the beginning to the end, by its mean, linear in time
  std::uint64_t seed{1};
};

constexpr double foreign_rate = 250.0;    // [Hz]
constexpr double foreign_period = 8.192;  // [s] of a multisine

/// Mains hum in what is fed back and in what is recorded of the drives, and the ripple of nine
/// pistons in the forces, at 7.70 Hz beside the mode at 7.65 Hz. `level`: power by that of the
/// channel's noise in one line of 16 s.
ForeignLoop loop_with_tones(double level, double wander, ForeignLoop e);

/// White noise through a windowed sinc of 4 s, RMS 1.
Eigen::VectorXd noise_in_band(Eigen::Index samples, double from, double to, test::Random& random);

/// One axis after the other is swept, logarithmically, with rounded ends.
Eigen::VectorXd sweep(Eigen::Index samples, Eigen::Index axis, double from, double to);

/// Random phases; in experiment e axis i is turned by 120° i e, so that three of them are
/// orthogonal.
Eigen::VectorXd multisine(Eigen::Index samples, Eigen::Index axis, int experiment,
                          const ForeignLoop& e);

Eigen::MatrixXd excitation_of(const ForeignLoop& e, Eigen::Index samples, int experiment,
                              test::Random& random);

/// Channels r1 … r3 (excitation), y1 … y3, u1 … u3 (drive).
data::Record foreign_loop_record(const test::ModalSystem& plant, const ForeignLoop& e,
                                 int experiment = 0);

/// As a user measures and identifies it, without any option.
Measurement foreign_measurement(const test::ModalSystem& plant, const ForeignLoop& e);

inline const IdentifyOptions foreign_band{.to = 16.0};

void add_modes(const test::ModalSystem& plant, const FrequencyResponses& responses,
               test::ClassScore& score);

/// S_yr S_ur⁻¹ line by line from the same spectra, and the same search for poles.
FrequencyResponses textbook(const Measurement& m);

}  // namespace hydrapod::identification
