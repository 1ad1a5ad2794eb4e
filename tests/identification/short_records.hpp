#pragma once
/// Records of a few seconds, of masses between springs and dampers that stand here and in
/// gapped.hpp and foreign_loop.hpp. Shared by the short and the long test.

#include "exact/modal_system.hpp"
#include "foreign_loop.hpp"
#include "gapped.hpp"
#include "hydrapod/identification/identify.hpp"
#include "support/identification_score.hpp"

namespace hydrapod::identification {

/// Two rows of three unequal masses that weak springs join: six modes in three pairs, 5.5 Hz to
/// 20.5 Hz, of which the nearest are 4 % apart. Two forces, six motions.
test::ModalSystem two_rows();

/// M, D, K of masses in a row as a modal system. The masses of `pushed` have a force each.
test::ModalSystem row_of_masses(const Eigen::VectorXd& mass, const Eigen::VectorXd& spring,
                                const Eigen::VectorXd& damper, const std::vector<int>& pushed);

struct ShortRecordCase {
  double duration{10.0};      ///< [s]
  double sample_rate{200.0};  ///< [Hz]
  double noise{0.01};         ///< of each output's RMS
  double forces{};            ///< RMS of white forces that nobody measured, of those that were
  double hum{};               ///< amplitude at 15.7 Hz in all outputs, of their RMS
  bool from_rest{};           ///< the record begins with the excitation
  double band{};              ///< [Hz] where forces end (fourth order); 0: they are white
  bool sweeps{};              ///< one force after the other sweeps from 2 Hz to 25 Hz, from rest
};

/// Forces are held between samples.
data::Record short_record(const test::ModalSystem& system, const ShortRecordCase& e,
                          std::uint64_t seed);

struct ShortResult {
  Measurement measured{};
  Identification found{};
};

/// As `hydrapod identify --whole-record` does it, without any other option.
ShortResult identified_record(const std::vector<data::Record>& records,
                              const MeasureOptions& options = {});

/// The textbook: a VARX model whose order Akaike's criterion chooses up to 30, a realisation with
/// the states whose singular values are above a hundredth of the largest, and its poles with less
/// than 30 % damping. `inputs` columns of the record come first.
std::vector<test::FoundMode> textbook_record_modes(const data::Record& record, Eigen::Index inputs,
                                                   double highest);

}  // namespace hydrapod::identification
