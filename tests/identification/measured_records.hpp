#pragma once
/// Records measured as a user does it, without any option: written to files and read again.

#include <string>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/responses.hpp"
#include "support/run_program.hpp"

namespace hydrapod::identification {

Measurement measured(const std::vector<data::Record>& list, const MeasureOptions& options = {});

}  // namespace hydrapod::identification
