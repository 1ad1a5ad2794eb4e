#pragma once
/// validate() with a choice for machines of which parts could not be read. Private to the module.

#include <vector>

#include "hydrapod/model/validation.hpp"

namespace hydrapod::model {

enum class NonFinite {
  report,
  ignore  ///< NaN stands for a value whose absence has been reported
};

std::vector<Finding> validate_values(const Machine& machine, NonFinite non_finite);

class ValueChecks;

/// What the table cannot say: conditions between numbers. Keys of a leg are relative to it.
void check_sensors(const Sensors& sensors, ValueChecks& checks);
void check_leg_hydraulics(const Leg& leg, ValueChecks& checks);
void check_supply(const Hydraulics& hydraulics, ValueChecks& checks);

/// The findings about one leg (0…5), with keys relative to it (`rod.length`).
std::vector<Finding> leg_findings(const Machine& machine, int leg, NonFinite non_finite);

}  // namespace hydrapod::model
