#pragma once
/// What `serve` and `rig --hardware` have in common: address, shared memory, layout, key.

#include "hydrapod/options.hpp"
#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::cli {

/// The layout of that file; without one, none: hydrapod's own.
realtime::Layout layout_of(const std::string& file);
realtime::Key key_of(const std::string& file);

/// The lines of a hardware rig's result: packets, and what stopped it.
std::string hardware_note(const realtime::HardwareResult& result);

}  // namespace hydrapod::cli
