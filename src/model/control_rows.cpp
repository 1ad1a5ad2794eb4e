// Rows of the machine file: supply, controller and sensors.
#include "parameter_rows.hpp"

namespace hydrapod::model::rows {

namespace {

constexpr Bound share{.lowest = 0.0, .highest = 1.0};
constexpr Bound up_to(double highest) { return {.lowest = 0.0, .highest = highest}; }

/// Feedback of an acceleration has its gain in s.
constexpr ParameterRow of_feedback(ParameterRow made) {
  made.other_unit = [](const Machine& machine, std::string_view unit) {
    return machine.controller.feedback == DampingFeedback::acceleration ? std::string_view{"s"}
                                                                        : unit;
  };
  return made;
}

/// The ends of what a sensor can show.
template <bool make, Sensor Sensors::*sensor>
double* range_end(Machine& machine, int, int element) {
  Sensor& of = machine.sensors.*sensor;
  return held<make>(element == 0 ? of.low : of.high);
}

template <Sensor Sensors::*sensor>
constexpr ParameterRow resolution(std::string_view path, std::string_view unit,
                                  Example example = {}) {
  return number<&Machine::sensors, sensor, &Sensor::resolution>(path, unit, standard, not_negative,
                                                                "step; 0: none", example);
}

template <Sensor Sensors::*sensor>
constexpr ParameterRow noise(std::string_view path, std::string_view unit, Example example = {}) {
  return number<&Machine::sensors, sensor, &Sensor::noise>(
      path, unit, standard, not_negative, "RMS of white noise from sample to sample", example);
}

template <Sensor Sensors::*sensor>
constexpr ParameterRow range(std::string_view path, std::string_view unit, Example example) {
  auto made = row(Kind::number, path, unit, otherwise("any"), {}, "`[lowest, highest]`", example);
  made.numbers = 2;
  made.optional = true;
  made.find = range_end<false, sensor>;
  made.make = range_end<true, sensor>;
  return made;
}

void drop_bandwidth(Machine& machine, int) { machine.controller.bandwidth.reset(); }
void drop_gain(Machine& machine, int) { machine.controller.gain.reset(); }

constexpr std::string_view space_words[]{"pose", "leg"};
constexpr std::string_view feedback_words[]{"pressure", "acceleration", "none"};
constexpr std::string_view compensation_words[]{"load", "asymmetry", "none"};

constexpr auto supply = &Hydraulics::supply;
constexpr auto lines = &Hydraulics::lines;
constexpr auto controller = &Machine::controller;
constexpr auto output = &ControlSettings::output;

constexpr ParameterRow control_rows[]{
    simulation(
        "supply", "pressure for all legs",
        R"(# ---- Supply, controller and sensors, for `hydrapod simulate` and `hydrapod modes --system` --------
# All of it is optional; what is not given follows from the machine.
)"),
    number<&Machine::hydraulics, supply, &Supply::pressure>("supply.pressure", "Pa", standard,
                                                            usual(1e5, 1e8, positive),
                                                            "p_s, absolute", shown("140 bar")),
    number<&Machine::hydraulics, supply, &Supply::return_pressure>(
        "supply.return_pressure", "Pa", standard, usual(1e3, 1e7, positive), "p_r, absolute",
        shown("5 bar")),
    number<&Machine::hydraulics, supply, &Supply::pump_flow>(
        "supply.pump_flow", "m^3/s", otherwise("any"), positive,
        "largest flow of a pressure-controlled pump; without it the supply pressure is "
        "constant",
        shown("100 l/min")),
    used_with("supply.pump_flow",
              number<&Machine::hydraulics, supply, &Supply::line_volume>(
                  "supply.line_volume", "m^3", standard, positive,
                  "oil between pump and valves; used with `pump_flow`", shown("1 l"))),
    number<&Machine::hydraulics, &Hydraulics::cavitation_pressure>(
        "supply.cavitation_pressure", "Pa", standard, positive,
        "about which a chamber fills with vapour, less than the return pressure", shown("0.5 bar")),
    simulation("supply.accumulator", "gas-charged, with `pump_flow` only"),
    number<&Machine::hydraulics, supply, &Supply::accumulator, &Accumulator::gas_volume>(
        "supply.accumulator.gas_volume", "m^3", required, positive, "at the precharge",
        shown("10 l")),
    number<&Machine::hydraulics, supply, &Supply::accumulator, &Accumulator::precharge>(
        "supply.accumulator.precharge", "Pa", required, usual(1e5, 1e8, positive), "absolute",
        shown("90 bar")),
    number<&Machine::hydraulics, supply, &Supply::accumulator, &Accumulator::polytropic>(
        "supply.accumulator.polytropic", "1", standard, polytropic,
        "exponent n of p Vⁿ: 1 for slow changes, 1.4 for fast ones"),
    simulation("lines",
               "between valves and chambers: waves in all that have a `cap_line_length` or a "
               "`rod_line_length`"),
    number<&Machine::hydraulics, lines, &Lines::segments>(
        "lines.segments", "1", standard,
        {.lowest = 0.0,
         .highest = most_line_segments,
         .expected = "0 (dead ends) or a whole number of segments up to 8"},
        "0: the oil of a line has the inertia of a dead end and no waves; 1 to 8: each line is a "
        "chain of as many segments, with waves and with the valve open or shut"),
    number<&Machine::hydraulics, lines, &Lines::modes>(
        "lines.modes", "1", standard,
        {.lowest = 0.0,
         .highest = most_line_segments,
         .expected = "0 (none) or a whole number of modes up to 8"},
        "in place of `segments`: 1 to 8 modes of each line, the first of which is the column; as "
        "many states and far closer to the uniform line"),
    used_with("lines.segments",
              number<&Machine::hydraulics, lines, &Lines::viscosity>(
                  "lines.viscosity", "Pa s", standard, usual(1e-4, 10.0, not_negative),
                  "μ of the oil, for the laminar loss in lines with segments or modes",
                  shown("40 mPa s")),
              "lines.modes"),
    simulation("controller", "from pose errors to valve drives"),
    word<controller, &ControlSettings::space>(
        "controller.space", space_words,
        "`\"pose\"`: errors of the pose, from the leg lengths by forward kinematics; "
        "`\"leg\"`: errors of the leg lengths"),
    instead_of(drop_bandwidth, number<controller, &ControlSettings::gain>(
                                   "controller.gain", "1/s", standard, not_negative,
                                   "six proportional gains; instead of `bandwidth`")),
    instead_of(drop_gain,
               number<controller, &ControlSettings::bandwidth>(
                   "controller.bandwidth", "rad/s",
                   otherwise("0.3 of the lowest oil mode, without pressure feedback 0.05"),
                   positive, "one gain for all", shown("20 rad/s"))),
    number<controller, &ControlSettings::integral_time>(
        "controller.integral_time", "s", otherwise("8 / smallest gain"), not_negative,
        "T_i of the integral part; 0 switches it off", shown("0.4 s")),
    number<controller, &ControlSettings::velocity_feedforward>(
        "controller.velocity_feedforward", "1", standard, any,
        "share of the commanded velocity that is fed forward"),
    word<controller, &ControlSettings::feedback>(
        "controller.feedback", feedback_words,
        "what damps the oil modes: `\"pressure\"` (load force from the chamber "
        "pressures), `\"acceleration\"` (of the pistons), both high-passed; `\"none\"`"),
    number<controller, &ControlSettings::feedback_damping>(
        "controller.feedback_damping", "1", standard, up_to(2.0),
        "damping ratio that pressure feedback gives to the lowest oil mode, "
        "acceleration feedback to the highest; 2 or less"),
    of_feedback(number<controller, &ControlSettings::feedback_gain>(
        "controller.feedback_gain", "m/(N s)", otherwise("from `feedback_damping`"), any,
        "the gain itself; in s with acceleration feedback")),
    number<controller, &ControlSettings::feedback_corner>(
        "controller.feedback_corner", "rad/s", otherwise("0.1 of the lowest oil mode"),
        not_negative, "of the high pass", shown("6 rad/s")),
    number<controller, &ControlSettings::sample_time>("controller.sample_time", "s", standard,
                                                      {.lowest = 1e-5, .highest = 1.0},
                                                      "10 µs to 1 s", shown("1 ms")),
    number<controller, &ControlSettings::delay>(
        "controller.delay", "1", standard, {.lowest = 0.0, .highest = 100.0, .shown_in = "samples"},
        "samples from reading the sensors to the new drive, fractions allowed, 100 or "
        "less"),
    word<controller, &ControlSettings::compensation>(
        "controller.compensation", compensation_words,
        "speed of the cylinder per drive, by which drives are corrected: `\"load\"`, "
        "at the present load (from the pressure sensors); `\"asymmetry\"`, of extending "
        "and of retracting under the load of the neutral pose; `\"none\"`, their mean"),
    number<controller, &ControlSettings::overlap_compensation>(
        "controller.overlap_compensation", "1", standard,
        {.lowest = 0.0, .highest = 1.0, .expected = "1 or less"},
        "share of the valve's overlap that the drive jumps over, 0 to 1"),
    simulation("controller.output", "in shares of full drive"),
    number<controller, output, &DriveOutput::limit>("controller.output.limit", "1", standard,
                                                    up_to_one,
                                                    "largest drive, more than 0, no more than 1"),
    number<controller, output, &DriveOutput::resolution>(
        "controller.output.resolution", "1", standard, share,
        "step of the converter (16 bits over ±1); 0: none"),
    number<controller, output, &DriveOutput::scale>("controller.output.scale", "1", standard, any,
                                                    "six factors, one per leg"),
    number<controller, output, &DriveOutput::offset>(
        "controller.output.offset", "1", standard,
        {.lowest = -1.0,
         .highest = 1.0,
         .more_than_lowest = true,
         .less_than_highest = true,
         .expected = "a share of full drive: more than -1, less than 1"},
        "six offsets, one per leg, added last: the valves' nulls"),
    simulation("sensors.length", "leg lengths"),
    resolution<&Sensors::length>("sensors.length.resolution", "m", shown("5 um")),
    noise<&Sensors::length>("sensors.length.noise", "m", shown("2 um")),
    range<&Sensors::length>("sensors.length.range", "m", shown("[\"1.2 m\", \"2 m\"]")),
    simulation("sensors.pressure", "chamber pressures"),
    resolution<&Sensors::pressure>("sensors.pressure.resolution", "Pa", shown("2 kPa")),
    noise<&Sensors::pressure>("sensors.pressure.noise", "Pa", shown("5 kPa")),
    range<&Sensors::pressure>("sensors.pressure.range", "Pa", shown("[\"0 bar\", \"250 bar\"]")),
    simulation("sensors.acceleration", "of the pistons along the cylinders"),
    resolution<&Sensors::acceleration>("sensors.acceleration.resolution", "m/s^2"),
    noise<&Sensors::acceleration>("sensors.acceleration.noise", "m/s^2"),
    range<&Sensors::acceleration>("sensors.acceleration.range", "m/s^2",
                                  shown("[\"-50 m/s^2\", \"50 m/s^2\"]")),
};

}  // namespace

std::span<const ParameterRow> supply_and_control() { return control_rows; }

}  // namespace hydrapod::model::rows
