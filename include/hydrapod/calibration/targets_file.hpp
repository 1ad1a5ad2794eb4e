#pragma once
/// A file of targets, and of what a calibration to them may change.
///
/// From TOML (docs/howto/calibrate.md), or from CSV with a title row such as
/// `frequency [Hz],direction,deviation [Hz],damping [%],pose,x,y,z,rx,ry,rz`, which has targets
/// alone.

#include "hydrapod/calibration/plan.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::calibration {

struct TargetsFile {
  observation::Targets targets{};
  Plan plan{};
};

/// Reads `path`; CSV where it ends in .csv, else TOML. Throws base::InputError with every mistake.
TargetsFile read_targets(const std::string& path);

/// The same from text; `file_name` decides between CSV and TOML and is what messages call it.
TargetsFile parse_targets(const std::string& text, const std::string& file_name);

}  // namespace hydrapod::calibration
