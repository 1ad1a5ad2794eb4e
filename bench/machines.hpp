#pragma once
/// The machines of models/ that the benchmarks run on.

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "models.hpp"

namespace hydrapod::bench {

/// The machine of models/`name`.toml, with overrides as on the command line.
inline model::Machine machine(const std::string& name,
                              const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(model_file(name + ".toml"), overrides, kinematics::check_machine)
      .machine;
}

/// The published machine, as in Table 2 of the paper: gimbal axes, no gravity.
inline model::Machine published() { return machine("zhang-jiang-2021"); }

}  // namespace hydrapod::bench
