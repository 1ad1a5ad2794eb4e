#pragma once
/// Records of outputs alone, of systems that are written down here: masses, springs and dampers, or
/// poles and shapes; and the plain textbook method on them.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/identify.hpp"
#include "support/identification_score.hpp"

namespace hydrapod::test {

/// Masses in a row, spring and damper k between mass k − 1 and k; the first and the last to ground.
struct Chain {
  Eigen::VectorXd masses{}, springs{}, dampers{};  ///< [kg], [N/m], [Ns/m]; one more of the latter
};

Eigen::MatrixXd chain_matrix(const Eigen::VectorXd& links);

/// Modes of M q̈ + C q̇ + K q = f with outputs q: residues φ φᵀ/(φᵀ (2 λ M + C) φ).
ModalSystem modes_of(const Chain& chain);

struct Tone {
  double frequency{};
  Eigen::VectorXd amplitude{};  ///< of each output, over the RMS of what noise excites there
};

struct OutputExperiment {
  double sample_rate{100.0};
  int samples{60000};
  double noise{0.05};  ///< of sensors, over the RMS of each output
  double colour{0.0};  ///< [Hz] of a low-pass of first order that forces go through; 0: none
  std::vector<Tone> tones{};
  std::uint64_t seed{1};
};

/// Forces on all inputs, independent and Gaussian; only the outputs are recorded.
data::Record outputs_of(const ModalSystem& system, const OutputExperiment& e);

/// Blocks as measure_outputs takes them.
identification::CrossSpectra output_spectra(const data::Record& record, int block);

std::vector<int> all_channels(const data::Record& record);

identification::Identification identified_outputs(const data::Record& record, int block);

/// Covariance-driven subspace identification as textbooks have it: sample covariances, one Hankel
/// matrix, orders 4 … 40, and a mode where five orders in a row have a pole that is the same as one
/// of the order before within 1 % in frequency, 5 % in damping and 2 % in MAC.
std::vector<FoundMode> textbook_output_modes(const data::Record& record);

/// One class of data.
struct OutputClass {
  const char* name{};
  ModalSystem system{};
  OutputExperiment experiment{};
  int block{8192};
};

/// Five unequal masses, light proportional and one extra damper; 2.1 … 10 Hz.
OutputClass unequal_chain();

/// Accelerations of three masses, 90 s; 4.11, 16.2 and 22.6 Hz, the first one damped by 0.38 %: it
/// decays by e^(−0.4) within half a block.
OutputClass sharp_chain();

/// Eight outputs; two pairs that are 1.4 % and 2.3 % apart, with complex shapes.
OutputClass close_pairs();

/// Three masses under coloured forces, and a machine that turns: 23.7 Hz and its double.
OutputClass chain_with_tones();

}  // namespace hydrapod::test
