#pragma once
/// Outputs alone whose excitation moves through the band, as in a run-up or a coast-down. Private
/// to the module.
///
/// Modes of outputs alone take the excitation for noise that is there all the time. A vibration
/// that sweeps from one frequency to another leaves spectra with ends there, and ends look like
/// modes.
///
/// The record is divided into T parts of equal length and the lines into bands. The power of a
/// band, each output in proportion to its own, is p_1 … p_T with the sum 1, and its brevity is the
/// smallest share of the parts that together hold ½. Noise has some 0.4, a resonance that rings for
/// longer than a part 0.19 (½ = x (1 − ln x), as its power is exponentially distributed). A
/// vibration that passes the band has little more than its share of the sweep. Hits are as brief,
/// but at the same time in all bands: the mean of p over the bands is as brief then.

#include <optional>

#include "tones.hpp"

namespace hydrapod::identification {

struct RunUpOptions {
  int parts{40};                ///< T
  int short_part{256};          ///< [samples] of a part: with fewer, T is half of that
  int shortest{64};             ///< blocks, at most as long as a part, half of them apart [samples]
  int longest{4096};            ///< more has no use
  Index lines_per_band{2};      ///< at least
  Index most_bands{128};        ///< …
  double brief{0.1};            ///< brevity < brief: a vibration passes the band
  std::size_t fewest_bands{6};  ///< it passes, which are
  double of_bands{0.6};         ///< … at least this share of those between the first and the last
  double apart{2.5};  ///< brevity of the mean over them > apart · that of a band (median)
  std::size_t most_outputs{4};  ///< that are looked at
};

struct RunUp {
  double lowest{}, highest{};  ///< [Hz] that the vibration passes
  double brevity{};            ///< median over the bands
};

/// `used`, `outputs`: as find_wandering_tones(). Records that are too short have none.
std::optional<RunUp> find_run_up(data::RecordSet& records, const std::vector<std::size_t>& used,
                                 std::int64_t settling, const CrossSpectra& spectra,
                                 const std::vector<int>& outputs, const RunUpOptions& options = {});

}  // namespace hydrapod::identification
