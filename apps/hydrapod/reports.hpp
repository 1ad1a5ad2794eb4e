#pragma once
/// Results as people read them.

#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// A line below a heading: "machine: calibrated, with platform.mass=4 t".
std::string state_line(const model::MachineFile& file);
/// What the frequencies of `modes` and `sensitivity` are, with the line end.
inline constexpr const char* damped_frequencies =
    "natural frequencies |λ| of the damped modes, as they are measured\n";
/// The same of studies: "frequencies are those of undamped modes".
std::string frequencies_line(const model::Machine& machine);
/// The same behind the examples in the help of their commands.
inline constexpr const char* study_frequencies =
    "\n\nFrequencies:\n"
    "  Outputs in Hz are frequencies of undamped modes; where seals are elastomers, of damped "
    "modes.\n"
    "  `hydrapod modes` and `hydrapod check` print |λ| of the damped modes.";
/// "neutral"; of a mode measured at an amplitude [m] "neutral, 0.2 mm".
std::string place_text(const std::string& pose, double amplitude);
std::string mechanics_state_line(const model::MachineFile& file);  ///< of mechanics alone

/// Machine, pose, model and assumptions in two lines.
std::string heading(const tasks::Machine& machine, const TableStyle& style);

/// The table of `table`; with `before`, also the change of every mode against it.
std::string mode_text(const modal::ModeTable& table, const modal::ModeTable* before,
                      const TableStyle& style);

/// One line per mode, all fields; a header line names them with units.
std::string mode_csv(const modal::ModeTable& table);

/// What was swept, and the peaks of the six direct responses, flexible and rigid.
std::string peak_text(const report::Bode& bode, const TableStyle& style);

/// Title and assumptions for a plot.
report::PlotText plot_text(const tasks::Machine& machine, const report::Bode& bode);

/// Combinations, targets against model, parameters, what is determined and what is not, remarks.
/// Parameters in the units of the machine file.
std::string calibration_text(const calibration::Calibration& result,
                             const observation::Targets& targets,
                             const std::vector<calibration::Profile>& profiles,
                             const std::string& machine_text, const TableStyle& style);

/// Modes across, parameters downwards, in per cent per per cent, the most important first.
std::string sensitivity_text(const calibration::Sensitivities& sensitivities,
                             const TableStyle& style);
std::string sensitivity_csv(const calibration::Sensitivities& sensitivities);

}  // namespace hydrapod::cli
