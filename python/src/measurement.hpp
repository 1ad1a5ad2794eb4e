#pragma once
/// Options of measurements, which the tasks that explain them take too.

#include "hydrapod/tasks/measurement.hpp"
#include "support.hpp"

namespace hydrapod::python {

tasks::MeasureOptions measure_options(const Options& asked);
tasks::IdentifyOptions identify_options(const Options& asked);
/// None for "auto" and "none".
std::optional<observation::Observed> observed_system(const std::string& word);

}  // namespace hydrapod::python
