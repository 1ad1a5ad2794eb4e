#pragma once
/// What an FMU shows of a machine: its variables, what depends on what, and their values.
///
/// Written by the exporter into modelDescription.xml, and used by the shared object of the FMU
/// (apps/fmu), so that both mean the same. Needs nothing of the library but the machine and the
/// plant.
///
/// Variables stand in this order, and a variable's place is its value reference: time, inputs,
/// states, derivatives (of the states, in their order), outputs, event indicators, parameters, and
/// with the controller its drives. Some states are outputs as well.
///
/// Inputs are the commands of the valves or of electric drives, or without either the axial forces
/// on the pistons, then the wrench on the platform about its mass centre. With the controller
/// inside, the commanded displacement and its rate stand in the place of these commands, which are
/// outputs then.
/// Parameters are the numbers of the machine file that the plant depends on; what stands for all
/// legs there is a parameter of each leg here. Those that enter the equations alone, and not what
/// the states mean, can be tuned during a simulation.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/model/parameters.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::exchange {

/// What stands in resources/machine.json. The last pose is the reference pose.
struct FmuMachine {
  model::Machine machine{};
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  bool hydraulics{true};              ///< the actuators are inside, electric ones too
  bool controlled{};                  ///< the controller is inside; with actuators only
  std::string token{};                ///< the FMU's guid or instantiation token
  std::vector<double> input_start{};  ///< what holds the machine at rest

  [[nodiscard]] const spatial::Pose& reference() const { return machine.poses.back().X_BP; }
  [[nodiscard]] simulation::PlantOptions options() const {
    return {.hydraulics = hydraulics, .oil_springs = false};
  }
  /// Motors and screws are inside.
  [[nodiscard]] bool drives() const {
    return hydraulics && model::leg_type(machine) == model::LegType::screw;
  }
  /// How the command of an actuator is called, behind its leg.
  [[nodiscard]] const char* command_name() const {
    return drives() ? "drive_command" : "valve_command";
  }
  /// The first input of the wrench.
  [[nodiscard]] int wrench_input() const { return controlled ? 12 : 6; }
  [[nodiscard]] int inputs() const { return wrench_input() + 6; }
};

std::string fmu_machine_text(const FmuMachine& machine);
/// Throws std::exception for a text that is none of these.
FmuMachine read_fmu_machine(const std::string& text);

enum class FmuRole { time, input, state, derivative, output, indicator, parameter, drive };

struct FmuVariable {
  FmuRole role{};
  int index{};         ///< within its role
  std::string name{};  ///< after the structured naming convention
  std::string unit{};
  std::string description{};
  bool is_output{};  ///< of a state
  bool tunable{};    ///< of a parameter
  std::optional<double> low{}, high{}, nominal{};
  std::optional<double> start{};

  /// In FMI 3.0 it can be set or got within a step of co-simulation.
  [[nodiscard]] bool is_intermediate() const {
    return role == FmuRole::input || role == FmuRole::output || is_output;
  }
};

struct FmuInterface {
  std::vector<FmuVariable> variables{};
  std::vector<model::ParameterId> parameters{};
  std::vector<int> indicators{};  ///< numbers of the plant's event functions
  int wrench_input{};             ///< the first input of the wrench
  bool controlled{};

  [[nodiscard]] int first(FmuRole role) const;
  [[nodiscard]] int count(FmuRole role) const;
};

FmuInterface fmu_interface(const FmuMachine& machine, const simulation::Plant& plant);

/// The units that variables have: powers of kg, m, s and rad. Throws std::invalid_argument for a
/// unit that is none.
struct FmuUnit {
  int kg{}, m{}, s{}, rad{};
};
FmuUnit fmu_unit(std::string_view unit);

/// A known that an unknown depends on.
struct FmuDependency {
  int variable{};
  bool constant{};  ///< a constant factor
};

/// Of a derivative, an output (or a state that is one) or an indicator: states and inputs, in
/// order.
std::vector<FmuDependency> fmu_dependencies(const FmuInterface& interface,
                                            const simulation::Plant& plant, int variable);

/// `drives`: of the controller inside, where there is one.
simulation::PlantInput fmu_plant_input(const FmuMachine& machine, const std::vector<double>& inputs,
                                       const spatial::Vector6& drives);

/// Outputs (those that are no states) at x, in order. Throws base::ComputationError where x is no
/// state.
std::vector<double> fmu_outputs(const simulation::Plant& plant, const double* x,
                                const simulation::PlantInput& input);

/// Event indicators at x, in order.
std::vector<double> fmu_indicators(const FmuInterface& interface, const simulation::Plant& plant,
                                   const double* x);

}  // namespace hydrapod::exchange
