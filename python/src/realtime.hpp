#pragma once
/// Options of the virtual machine in real time that the rig takes too.

#include "hydrapod/tasks/simulation.hpp"
#include "support.hpp"

namespace hydrapod::python {

/// What records say of their origin.
tasks::Origin origin();
/// Those of `accelerometers`; without it the default ones.
std::vector<rig::Accelerometer> accelerometers_of(const Subject& machine, const Options& asked);
/// None for the simulated rig.
std::optional<realtime::HardwareOptions> hardware_of(const Options& asked);
/// Packets of a rig on a real machine, and how it ended.
py::dict packets_of(const realtime::HardwareResult& result);

}  // namespace hydrapod::python
