#pragma once
/// Reading a targets file: tables of TOML, rows of CSV. Private to the module.

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/model/section.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::calibration {

using observation::default_deviation;
using observation::ModeTarget;
using observation::MotionAgainst;
using observation::Targets;
using spatial::Vector6;

/// Everything of a TOML targets file; mistakes go to `faults`.
TargetsFile read_target_tables(const model::Node& root, const std::string& file,
                               const std::vector<std::string>& poses, model::Faults& faults);

/// What is wrong with the name of a pose; empty: nothing, or the poses are not known.
std::string pose_fault(const std::string& pose, const std::vector<std::string>& poses);

/// Targets from the text of a CSV file. Throws base::InputError with every mistake.
Targets parse_target_csv(const std::string& text, const std::string& file,
                         const std::vector<std::string>& poses);

/// The frequency [rad/s] that `text` is ("11.3 Hz", "71 rad/s"), or a plain number in
/// `plain_unit` ("Hz", "rad/s", or empty: plain numbers are refused). Empty `problem` when read.
struct Frequency {
  double omega{};
  std::string problem{};
};
Frequency read_frequency(const std::string& text, bool plain, double number,
                         const std::string& plain_unit);

/// What no target can be, by its key: frequencies, deviations and dampings out of all proportion.
struct TargetFault {
  std::string key{};
  std::string message{};
};
std::vector<TargetFault> target_faults(const ModeTarget& mode);

/// Index of a direction x…rz; −1 when it is none.
int direction_index(std::string_view name);

using spatial::direction_names;

}  // namespace hydrapod::calibration
