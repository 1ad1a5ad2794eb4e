/// Runs over time: simulation and the virtual test rig.

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/model_results.hpp"
#include "realtime.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

struct Simulation : Result {
  Machine machine{};
  report::Simulation found{};
  [[nodiscard]] Json document() const override {
    return joined(report::head_json("simulation", *machine), report::simulation_json(found));
  }
};

std::shared_ptr<Simulation> simulate(const Machine& machine, const Options& asked,
                                     const py::object& progress) {
  constexpr std::array methods{simulation::Method::adaptive, simulation::Method::cvode_adams,
                               simulation::Method::cvode_bdf, simulation::Method::fixed,
                               simulation::Method::exponential};
  tasks::SimulateOptions options{.commands = asked.get<Names>("commands"),
                                 .wrench = asked.get<Names>("wrench"),
                                 .initial = asked.get<std::string>("initial"),
                                 .until = asked.positive("until", "s"),
                                 .record = asked.get<std::string>("record"),
                                 .origin = origin()};
  auto& loop = options.loop;
  loop.actuators = static_cast<simulation::Actuators>(
      choice("actuators", asked.get<std::string>("actuators", "controlled"),
             {"controlled", "held", "springs"}));
  loop.integrator.method =
      methods[choice("integrator", asked.get<std::string>("integrator", "exponential"),
                     {"adaptive", "adams", "bdf", "fixed", "exponential"})];
  const double tolerance = asked.get("tolerance", 1e-6);
  if (!(tolerance >= 1e-13 && tolerance <= 1e-2))
    base::refuse("tolerance", "expected 1e-13 to 0.01");
  loop.integrator.relative_tolerance = loop.integrator.absolute_tolerance = tolerance;
  loop.integrator.fixed_step = asked.positive("step", "s").value_or(1e-4);
  loop.seed = asked.get<std::uint64_t>("seed", 1);
  loop.ideal_sensors = asked.get("ideal_sensors", false);
  loop.output_interval = asked.positive("output_interval", "s");
  options.trace_samples = asked.get<std::size_t>("trace_samples", options.trace_samples);
  auto result = std::make_shared<Simulation>();
  result->machine = machine;
  result->found = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::simulate(*machine, options, watch);
  });
  return result;
}

py::dict run_rig(const Machine& machine, const Options& asked, const py::object& progress) {
  tasks::RigOptions options{.averages = asked.get("averages", 0),
                            .record = asked.get<std::string>("record"),
                            .force = asked.get("above_limits", false),
                            .origin = origin(),
                            .hardware = hardware_of(asked)};
  auto& test = options.test;
  test.entry = static_cast<rig::Entry>(
      choice("entry", asked.get<std::string>("entry", "command"), {"command", "drive", "wrench"}));
  test.signals = signals::read_signals(asked.get<Names>("excite"),
                                       {.argument = "excite",
                                        .units = rig::units_of(test.entry),
                                        .rate = 1.0 / machine->file.machine.controller.sample_time,
                                        .excitation = true});
  test.settling = asked.at_least_zero("settling", "s").value_or(test.settling);
  test.duration = asked.positive("duration", "s").value_or(test.duration);
  if (options.hardware) test.rate = 1.0 / machine->file.machine.controller.sample_time;
  test.rate = asked.positive("rate", "Hz").value_or(test.rate);
  if (!(test.duration * test.rate >= 1.0)) base::refuse("rate", "the record would have no sample");
  test.oversampling = asked.get("oversampling", test.oversampling);
  test.repeat = asked.get("repeat", test.repeat);
  test.seed = asked.get<std::uint64_t>("seed", test.seed);
  auto& all = test.instruments;
  all.accelerometers = accelerometers_of(*machine, asked);
  const auto sensor = [&](const char* name, model::Sensor& into, const char* unit) {
    if (asked.has(name)) into = rig::parse_sensor(name, asked.get<std::string>(name), unit);
  };
  sensor("length_sensor", all.length, "m");
  sensor("pressure_sensor", all.pressure, "Pa");
  sensor("current_sensor", all.current, "1");
  sensor("torque_sensor", all.torque, "N m");
  sensor("speed_sensor", all.speed, "rad/s");
  all.drop_outs = asked.positive("drop_outs", "Hz").value_or(0.0);
  all.anti_alias = asked.get("anti_alias", true);
  const auto done = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::rig(*machine, options, watch);
  });
  Names findings;
  for (const auto& one : done.findings) findings.push_back(one.message);
  const auto& summary = done.result.summary;
  const bool finished = options.record.empty() || summary.end == simulation::RunEnd::finished;
  py::dict result;
  result["record"] = done.record;
  result["samples"] = done.result.samples;
  result["findings"] = findings;
  result["finished"] = finished;
  result["message"] = summary.end == simulation::RunEnd::stopped ? "interrupted" : summary.message;
  result["hardware"] = done.hardware ? py::object(packets_of(*done.hardware)) : py::none();
  return result;
}

}  // namespace

void add_simulation(py::module_& module) {
  auto type = py::class_<Simulation, Result, std::shared_ptr<Simulation>>(module, "Simulation");
  const auto trace = [&](const char* name, auto member) {
    type.def_property_readonly(name, [member](const py::object& self) {
      return pages_of(self.cast<const Simulation&>().found.trace.*member, self);
    });
  };
  using Trace = simulation::Trace;
  trace("command", &Trace::command);
  trace("motion", &Trace::motion);
  trace("piston", &Trace::piston);
  trace("drive", &Trace::drive);
  trace("cap_pressure", &Trace::cap_pressure);
  trace("rod_pressure", &Trace::rod_pressure);
  trace("nut", &Trace::nut);
  trace("motor_speed", &Trace::motor_speed);
  trace("torque", &Trace::torque);
  type.def_property_readonly("time",
                             [](const py::object& self) {
                               return view_of(self.cast<const Simulation&>().found.trace.time,
                                              self);
                             })
      .def_property_readonly("commands", [](const Simulation& s) { return s.found.commands; })
      .def_property_readonly("until", [](const Simulation& s) { return s.found.until; })
      .def_property_readonly("simulated", [](const Simulation& s) { return s.found.summary.time; })
      .def_property_readonly(
          "finished",
          [](const Simulation& s) { return s.found.summary.end == simulation::RunEnd::finished; })
      .def_property_readonly("message",
                             [](const Simulation& s) {
                               return s.found.summary.end == simulation::RunEnd::stopped
                                          ? std::string("interrupted")
                                          : s.found.summary.message;
                             })
      .def_property_readonly("record", [](const Simulation& s) { return s.found.record; })
      .def_property_readonly("rms_error",
                             [](const py::object& self) {
                               return view_of(
                                   self.cast<const Simulation&>().found.summary.rms_error, self);
                             })
      .def_property_readonly("peak_error",
                             [](const py::object& self) {
                               return view_of(
                                   self.cast<const Simulation&>().found.summary.peak_error, self);
                             })
      .def_property_readonly("warnings", [](const Simulation& s) { return s.found.warnings; });
  module.def("simulate",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return simulate(machine, Options(options), progress);
             });
  module.def("rig",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return run_rig(machine, Options(options), progress);
             });
}

}  // namespace hydrapod::python
