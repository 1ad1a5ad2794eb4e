/// The virtual machine in real time, and the rig on a real one.

#include "realtime.hpp"

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

struct Served : Result {
  Machine machine{};
  tasks::Served done{};
  [[nodiscard]] Json document() const override {
    return joined(report::head_json("serve", *machine), report::serve_json(done.result));
  }
};

realtime::Layout layout_of(const Options& asked) {
  return asked.has("layout") ? realtime::read_layout(asked.get<std::string>("layout"))
                             : realtime::Layout{};
}

realtime::Key key_of(const Options& asked) {
  return asked.has("key") ? realtime::read_key(asked.get<std::string>("key")) : realtime::Key{};
}

std::optional<int> priority_of(const Options& asked) {
  if (!asked.has("fifo")) return {};
  const int priority = asked.get<int>("fifo");
  if (priority < 1 || priority > 99) throw std::invalid_argument("fifo: expected 1 to 99");
  return priority;
}

realtime::ServeOptions server_of(const Machine& machine, const Options& asked) {
  realtime::ServeOptions options;
  if (asked.has("shared_memory") && asked.has("bind"))
    base::refuse("bind", "shared memory has no address, expected shared_memory or bind");
  options.address = realtime::parse_address("address", asked.get<std::string>("address", "4747"));
  options.bind = asked.get<std::string>("bind");
  options.shared_memory = asked.get<std::string>("shared_memory");
  options.layout = layout_of(asked);
  options.key = key_of(asked);
  options.lock_step = asked.get("lock_step", false);
  options.once = asked.get("once", false);
  options.hold = asked.positive("hold", "s").value_or(options.hold);
  options.ramp = asked.positive("ramp", "s").value_or(options.ramp);
  options.patience = asked.positive("patience", "s").value_or(options.patience);
  options.fifo = priority_of(asked);
  options.busy = asked.positive("busy", "s").value_or(options.busy);
  options.accelerometers = accelerometers_of(*machine, asked);
  return options;
}

simulation::LoopOptions loop_of(const Options& asked) {
  constexpr std::array methods{simulation::Method::exponential, simulation::Method::fixed,
                               simulation::Method::adaptive, simulation::Method::cvode_adams,
                               simulation::Method::cvode_bdf};
  simulation::LoopOptions loop;
  auto& integrator = loop.integrator;
  integrator.method =
      methods[choice("integrator", asked.get<std::string>("integrator", "exponential"),
                     {"exponential", "fixed", "adaptive", "adams", "bdf"})];
  integrator.fixed_step = asked.positive("step", "s").value_or(2e-4);
  const double tolerance = asked.get("tolerance", 1e-6);
  if (!(tolerance >= 1e-13 && tolerance <= 1e-2))
    base::refuse("tolerance", "expected 1e-13 to 0.01");
  integrator.relative_tolerance = integrator.absolute_tolerance = tolerance;
  loop.seed = asked.get<std::uint64_t>("seed", 1);
  loop.ideal_sensors = asked.get("ideal_sensors", false);
  return loop;
}

std::shared_ptr<Served> serve(const Machine& machine, const Options& asked, const py::object& ready,
                              const py::object& progress) {
  tasks::ServeOptions options{.server = server_of(machine, asked),
                              .rest = asked.get<std::string>("rest"),
                              .duration = asked.positive("duration", "s"),
                              .loop = loop_of(asked),
                              .record = asked.get<std::string>("record"),
                              .origin = origin()};
  if (!options.record.empty()) data::format_of_ending(options.record);
  if (!ready.is_none())
    options.server.ready = [&](const std::string& place) {
      const py::gil_scoped_acquire acquire;
      ready(place);
    };
  auto result = std::make_shared<Served>();
  result->machine = machine;
  result->done = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::serve(*machine, options, watch);
  });
  return result;
}

std::string packet_layout(const Machine& machine, const Options& asked) {
  const auto accelerometers = accelerometers_of(*machine, asked);
  return realtime::layout_text(realtime::native_layout(static_cast<int>(accelerometers.size()),
                                                       model::leg_type(machine->file.machine)));
}

}  // namespace

tasks::Origin origin() { return {"hydrapod " + std::string(base::version) + ", Python", {}}; }

std::vector<rig::Accelerometer> accelerometers_of(const Subject& machine, const Options& asked) {
  if (!asked.has("accelerometers")) return rig::default_accelerometers(machine.file.machine);
  std::vector<rig::Accelerometer> all;
  for (const auto& text : asked.get<Names>("accelerometers"))
    all.push_back(rig::parse_accelerometer(text));
  return all;
}

std::optional<realtime::HardwareOptions> hardware_of(const Options& asked) {
  if (!asked.has("hardware") && !asked.has("shared_memory")) return {};
  realtime::HardwareOptions options;
  if (asked.has("hardware"))
    options.address = realtime::parse_address("hardware", asked.get<std::string>("hardware"));
  options.shared_memory = asked.get<std::string>("shared_memory");
  options.layout = layout_of(asked);
  options.key = key_of(asked);
  if (asked.has("limits"))
    options.limits = tasks::limits_of("limits", asked.get<std::string>("limits"));
  options.fifo = priority_of(asked);
  options.ramp = asked.positive("ramp", "s").value_or(options.ramp);
  options.ramp_down = asked.positive("ramp_down", "s").value_or(options.ramp_down);
  options.watchdog = asked.positive("watchdog", "s").value_or(options.watchdog);
  return options;
}

py::dict packets_of(const realtime::HardwareResult& result) {
  py::dict packets;
  packets["received"] = result.received;
  packets["lost"] = result.lost;
  packets["late"] = result.late;
  packets["malformed"] = result.malformed;
  packets["refused"] = result.refused;
  packets["resent"] = result.resent;
  packets["ramped_down"] = result.ramped_down;
  packets["scheduling"] = result.scheduling;
  return packets;
}

void add_realtime(py::module_& module) {
  using Run = simulation::RunEnd;
  py::class_<Served, Result, std::shared_ptr<Served>>(module, "Served")
      .def_property_readonly("place", [](const Served& s) { return s.done.result.place; })
      .def_property_readonly("samples", [](const Served& s) { return s.done.result.run.samples; })
      .def_property_readonly("time", [](const Served& s) { return s.done.result.run.time; })
      .def_property_readonly("sample_time",
                             [](const Served& s) { return s.done.result.sample_time; })
      .def_property_readonly("state",
                             [](const Served& s) { return realtime::name(s.done.result.state); })
      .def_property_readonly("finished",
                             [](const Served& s) { return s.done.result.run.end == Run::finished; })
      .def_property_readonly("message",
                             [](const Served& s) {
                               return s.done.result.run.end == Run::stopped
                                          ? std::string("interrupted")
                                          : s.done.result.run.message;
                             })
      .def_property_readonly("record", [](const Served& s) { return s.done.record; })
      .def_property_readonly("deadline_misses",
                             [](const Served& s) { return s.done.result.misses; })
      .def_property_readonly("warnings", [](const Served& s) { return s.done.result.warnings; });
  module.def("serve", [](const Machine& machine, const py::dict& options, const py::object& ready,
                         const py::object& progress) {
    return serve(machine, Options(options), ready, progress);
  });
  module.def("packet_layout", [](const Machine& machine, const py::dict& options) {
    return packet_layout(machine, Options(options));
  });
}

}  // namespace hydrapod::python
