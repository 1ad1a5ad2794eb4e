#pragma once
/// A small sound machine file whose line numbers the tests know, and ways to spoil it.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::model {

inline const std::string sound_machine_file = R"(name = "Sound"
[environment]
gravity = 9.81
[base.joints]
circle = { radius = 1.1, spacing = 0.25 }
[platform.joints]
circle = { radius = 0.8, spacing = 0.25 }
[platform]
mass = 1500
mass_center = [0, 0, 0.2]
inertia = { xx = 500, yy = 550, zz = 800 }
[legs]
gimbal_axis = [0, 1, 0]
[legs.case]
mass = 35
mass_center = 0.5
transverse_inertia = 3
[legs.rod]
length = 1.05
mass = 22
mass_center = 0.5
transverse_inertia = 2
[legs.guide_sleeve]
position = 1.0
stiffness = "5 kN/mm"
[legs.stroke]
retracted = 0.25
length = 0.6
[legs.oil_spring.cylinder]
bore = "80 mm"
rod_diameter = "56 mm"
bulk_modulus = "1.4 GPa"
cap_dead_volume = "100 cm^3"
rod_dead_volume = "100 cm^3"
[leg.3.guide_sleeve]
stiffness = "4 kN/mm"
[model]
flexible_axes = "transverse"
[poses.neutral]
position = [0, 0, 1.4]
[poses.tilted]
position = [0, 0, 1.4]
rotation = ["10 deg", 0, 0]
)";

/// Text that is replaced once, and what replaces it.
using Edit = std::pair<std::string, std::string>;

/// The sound file with the first occurrence of each text replaced. Throws if a text is not there.
inline std::string edited(const std::vector<Edit>& edits) {
  std::string text = sound_machine_file;
  for (const auto& [from, to] : edits) {
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("not in the sound file: " + from);
    text.replace(at, from.size(), to);
  }
  return text;
}

/// All that is wrong with `text` as the file m.toml; empty when nothing is.
inline std::string complaint_about(const std::string& text,
                                   const std::vector<std::string>& overrides = {}) {
  try {
    parse_machine(text, "m.toml", overrides);
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace hydrapod::model
