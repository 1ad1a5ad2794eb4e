#pragma once
/// Simulated runs as people read them.

#include <string>

#include "hydrapod/report/model_results.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Machine, commands, controller and how the run ended; then per direction and per leg what
/// happened.
std::string simulation_text(const model::Machine& machine, const model::NamedPose& pose,
                            const report::Simulation& simulation, bool colour,
                            std::size_t width = Table::unlimited);

/// The controller's numbers, with where they come from.
std::string controller_text(const model::Machine& machine,
                            const control::ControllerParameters& parameters,
                            double lowest_oil_mode);

/// What a plot says about the run in one line.
std::string simulation_subtitle(const model::NamedPose& pose, const report::Simulation& simulation);

}  // namespace hydrapod::cli
