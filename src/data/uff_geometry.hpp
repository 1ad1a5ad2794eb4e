#pragma once
/// What Universal Files say of units and of the places of nodes: datasets 164, 15, 2411, 2412 and
/// 82.
///
/// Layouts: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File
/// Formats for Modal Analysis Testing", datasets 15, 82 and 164; datasets 2411 and 2412 as
/// programs for finite elements write them.

#include <functional>
#include <string>
#include <vector>

#include "uff_fields.hpp"

namespace hydrapod::data {

inline constexpr int uff_nodes = 15, uff_nodes_double = 2411, uff_trace_line = 82,
                     uff_elements = 2412;

/// The next line of the dataset; false at its end.
using UffNextLine = std::function<bool(std::string_view&)>;

/// Dataset 164. Factors that contradict the units code make the units unusable, with a note, and so
/// do factors that are not there, unless the code tells them. Throws Unusable.
UffUnits read_uff_units(const UffNextLine& next, Notes& notes);

/// Dataset 15 or 2411: nodes behind those that are there, in the units of the file. Throws
/// Unusable.
void read_uff_nodes(const UffNextLine& next, bool in_double, std::vector<Node>& nodes);

/// Dataset 82. Throws Unusable.
TraceLine read_uff_trace_line(const UffNextLine& next);

/// Dataset 2412: its rods and beams, each a line of its own. Throws Unusable.
TraceLine read_uff_rods(const UffNextLine& next);

/// Nodes (2411) and rods along the lines (2412).
std::string uff_elements_text(const Geometry& geometry);

/// Datasets of all nodes (15, or 2411 where six digits are too few) and lines (82).
std::string uff_geometry_text(const Geometry& geometry);

}  // namespace hydrapod::data
