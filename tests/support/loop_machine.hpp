#pragma once
/// Machines of models/ for tests of the closed loop.

#include <string>
#include <vector>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/run_program.hpp"

namespace hydrapod::simulation {

inline model::Machine machine_of(const std::string& name,
                                 const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(test::source_file("models/" + name + ".toml").string(), overrides,
                                  kinematics::check_machine)
      .machine;
}

/// Everything that is not smooth taken out: for comparisons with linear theory.
inline const std::vector<std::string> smooth{"controller.output.resolution=0"};

}  // namespace hydrapod::simulation
