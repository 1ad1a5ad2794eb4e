#pragma once
/// Measured responses of the platform beside those of hypotheses, for pictures.
///
/// A curve is the size of the motion in one direction: of forces and commands in the six directions
/// the direct response, else the root of the sum of squares over all inputs. Predictions are made
/// at the measured lines s, with the window of the measurement, as the diagnosis compares them.
///
/// Forces are known, and their curves stand as they are. What a valve lets through for a command,
/// and what a controller makes of one, is known worse than how the platform then moves: such a
/// prediction is multiplied by one factor over all lines, which makes the mean difference of the
/// logarithms zero.

#include <string>
#include <vector>

#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis {

struct ResponseCurve {
  int direction{};                 ///< of the motion, 0…5
  std::vector<double> measured{};  ///< per line [m or rad, per input]
  /// Per hypothesis asked for, and line; empty where its machine has no such response.
  std::vector<std::vector<double>> predicted{};
};

struct ResponseOverlay {
  std::string pose{};
  observation::Entry entry{};
  bool direct{};                ///< response to the input of the same direction, else of all inputs
  bool scaled{};                ///< predictions are multiplied by one factor per curve
  std::vector<double> omega{};  ///< [rad/s]
  std::vector<ResponseCurve> curves{};  ///< x … rz
};

/// One per pose and entry of `measured`, whose lines reach from half the lowest measured mode to
/// one and a half times the highest; every second, … of them where there are more than `most`.
/// `stated`: model of the nominal machine. `hypotheses`: indices into Diagnosis::hypotheses.
std::vector<ResponseOverlay> response_overlays(const model::MachineFile& file,
                                               const observation::Targets& measured,
                                               dynamics::ModelKind stated, const Diagnosis& found,
                                               const std::vector<std::size_t>& hypotheses,
                                               std::size_t most = 300);

}  // namespace hydrapod::diagnosis
