// Rows of the machine file: modes of the payload.
#include "parameter_rows.hpp"

namespace hydrapod::model::rows {

namespace {

/// Read by code of its own, like poses.
template <auto... steps>
constexpr ParameterRow of_mode(std::string_view path, std::string_view unit, Presence presence,
                               Bound bound, std::string_view meaning) {
  return in_code(number<steps...>(path, unit, presence, bound, meaning));
}

constexpr std::string_view origin = "`[0, 0, 0]`";

constexpr ParameterRow payload_rows[]{
    table(
        "payload_modes.*", optional,
        "a mode of the payload, with the platform's joints held; names are free",
        R"(# ---- Modes of the payload: a cabin, a frame, a test piece that is not rigid -------------------
# What swings is part of platform.mass and platform.inertia. Up to six modes, under any name:
#
# [payload_modes.cabin]
# frequency = "11 Hz"                   # with the platform's joints held
# damping_ratio = "3 %"                 # on top of [damping]; default 0
# mass = "120 kg"                       # that swings
# position = [0, 0, "0.7 m"]            # of that mass in the platform frame; default [0, 0, 0]
# direction = [1, 0, 0]                 # in which it swings
#
# Instead of mass, position and direction, of a finite-element model: `participation` [kg] and
# `participation_moment` [kg m], for a modal mass of 1 kg (docs/howto/machine-file.md).
)"),
    of_mode<&PayloadMode::frequency>("payload_modes.*.frequency", "Hz", required,
                                     usual(0.1, 1e3, positive),
                                     "natural frequency with the platform's joints held"),
    of_mode<&PayloadMode::damping_ratio>("payload_modes.*.damping_ratio", "1", otherwise("0"),
                                         below_one, "of this mode, on top of `[damping]`"),
    of_mode<&PayloadMode::mass>("payload_modes.*.mass", "kg", otherwise("that of `participation`"),
                                usual(0.1, 1e6, positive), "that swings; part of `platform.mass`"),
    of_mode<&PayloadMode::position>("payload_modes.*.position", "m", otherwise(origin),
                                    usual(1e-4, 50.0, any),
                                    "`[x, y, z]` of that mass in the platform frame"),
    of_mode<&PayloadMode::direction>("payload_modes.*.direction", "1", otherwise("`[1, 0, 0]`"),
                                     any,
                                     "in which the mass swings, in the platform frame; of any "
                                     "length"),
    of_mode<&PayloadMode::participation>(
        "payload_modes.*.participation", "kg", otherwise("that of `mass`"), usual(1e-4, 1e4, any),
        "instead of `mass`: Σ m φ of the mode's shape φ over its masses m, for a modal mass "
        "Σ m φ² of 1 kg, in the platform frame"),
    of_mode<&PayloadMode::participation_moment>(
        "payload_modes.*.participation_moment", "kg m", otherwise(origin), usual(1e-4, 1e5, any),
        "the same for moments, Σ m r × φ about the origin of the platform frame"),
};

}  // namespace

std::span<const ParameterRow> payload_modes() { return payload_rows; }

}  // namespace hydrapod::model::rows
