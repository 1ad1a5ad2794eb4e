#pragma once
/// All of hydrapod behind one header: everything that the command line can do, as calls.
///
///     const auto machine = hydrapod::tasks::read_machine({.file = "machine.toml"});
///     for (const auto& mode : hydrapod::tasks::modes(machine).real.modes)
///       std::printf("%.3f Hz  %s\n", mode.mode.omega / hydrapod::base::two_pi,
///       mode.label.c_str());
///
/// A task takes options and returns a result. Numbers are SI and radians. Tasks that take long tell
/// their progress and can be stopped (tasks/machine.hpp). Results become JSON, pictures and pages
/// by the functions of `report`. Numbered programs: examples/cpp.

#include "hydrapod/base/units.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/tasks/study.hpp"
