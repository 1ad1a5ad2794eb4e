#pragma once
/// Results as people read them.

#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Machine, pose, model and assumptions in two lines.
std::string heading(const tasks::Machine& machine, const TableStyle& style);

/// The table of `table`; with `before`, also the change of every mode against it.
std::string mode_text(const modal::ModeTable& table, const modal::ModeTable* before,
                      const TableStyle& style);

/// One line per mode, all fields; a header line names them with units.
std::string mode_csv(const modal::ModeTable& table);

/// What was swept, and the peaks of the six direct responses, flexible and rigid.
std::string peak_text(const report::Bode& bode, const TableStyle& style);

/// Bandwidths, peaks and couplings of the response from command to pose.
std::string command_text(const report::CommandResponse& response, const TableStyle& style);

/// Title and assumptions for a plot.
report::PlotText plot_text(const tasks::Machine& machine, const report::Bode& bode);

/// Machine, commands, controller and how the run ended; then per direction and per leg what
/// happened.
std::string simulation_text(const model::Machine& machine, const model::NamedPose& pose,
                            const report::Simulation& simulation, const TableStyle& style);

/// The controller's numbers, with where they come from.
std::string controller_text(const model::Machine& machine,
                            const control::ControllerParameters& parameters,
                            double lowest_oil_mode);

/// What a plot says about the run in one line.
std::string simulation_subtitle(const model::NamedPose& pose, const report::Simulation& simulation);

std::string modes_text(const tasks::Identified& found, const TableStyle& style);

std::string comparison_text(const report::ComparedModes& compared,
                            const identification::Identification& result, const TableStyle& style);

std::string output_only_text(const std::vector<identification::OutputOnlyMode>& modes,
                             std::size_t outputs, int block, const TableStyle& style);

/// Combinations, targets against model, parameters, what is determined and what is not, remarks.
std::string calibration_text(const calibration::Calibration& result,
                             const observation::Targets& targets,
                             const std::vector<calibration::Profile>& profiles,
                             const TableStyle& style);

/// Modes across, parameters downwards, in per cent per per cent, the most important first.
std::string sensitivity_text(const calibration::Sensitivities& sensitivities,
                             const TableStyle& style);
std::string sensitivity_csv(const calibration::Sensitivities& sensitivities);

}  // namespace hydrapod::cli
