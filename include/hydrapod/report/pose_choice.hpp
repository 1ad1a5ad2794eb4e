#pragma once

#include <string>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

/// A pose with the name it is asked for by.
struct PoseChoice {
  std::string name{};
  spatial::Pose X_BP{};
};

}  // namespace hydrapod::report
