#pragma once
/// Reads the tables [controller] and [sensors]. Private to the reader.

#include "hydrapod/model/control.hpp"
#include "section.hpp"

namespace hydrapod::model {

ControlSettings read_controller(const Section& root);
Sensors read_sensors(const Section& root);

}  // namespace hydrapod::model
