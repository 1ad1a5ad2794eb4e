/// The machine for other programs: files, state space, superelement, multibody text.

#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

std::optional<spatial::Vector3> point_of(const Options& asked) {
  if (!asked.has("point")) return {};
  const auto point = asked.get<std::vector<py::object>>("point");
  if (point.size() != 3) throw std::invalid_argument("point: expected three lengths");
  return spatial::Vector3(quantity(point[0], "m", "point"), quantity(point[1], "m", "point"),
                          quantity(point[2], "m", "point"));
}

exchange::SystemKind system_kind(const Options& asked) {
  return static_cast<exchange::SystemKind>(choice(
      "system", asked.get<std::string>("system", "mechanics"), {"mechanics", "plant", "loop"}));
}

int pade_order(const Options& asked) {
  const int order = asked.get("pade_order", simulation::default_pade_order);
  if (order < 0 || order > 8) throw std::invalid_argument("pade_order: expected 0 to 8");
  return order;
}

/// sampled: the loop as it is sampled; refuses what contradicts it.
bool is_sampled(const Options& asked, exchange::SystemKind system) {
  const bool sampled = asked.get("sampled", false);
  if (sampled && system != exchange::SystemKind::loop)
    base::refuse("sampled", "is the loop with its sampled controller; give system=\"loop\"");
  if (sampled && asked.has("sample_time"))
    base::refuse("sampled", "has the sample time of the controller; leave sample_time out");
  return sampled;
}

/// States of a balanced reduction; 0: all are kept.
int reduced_states(const Options& asked) {
  if (!asked.has("reduce")) return 0;
  if (is_sampled(asked, system_kind(asked)))
    base::refuse("reduce", "is for continuous systems; leave sampled out");
  const int states = asked.get("reduce", 0);
  if (states < 1) throw std::invalid_argument("reduce: expected 1 or more states");
  return states;
}

/// point and pade_order where a state space has no use for them, or nothing is one.
void refuse_idle(const Options& asked, bool state_space, bool superelement) {
  const bool mechanics = state_space && system_kind(asked) == exchange::SystemKind::mechanics;
  const bool loop = state_space && system_kind(asked) == exchange::SystemKind::loop;
  if (asked.has("point") && !mechanics && !superelement)
    base::refuse("point",
                 "has no meaning here: it is for state spaces of the mechanics and superelements");
  if (asked.has("pade_order") && (!loop || asked.get("sampled", false)))
    base::refuse("pade_order",
                 "is the delay of the controller in a state space; give system=\"loop\" without "
                 "sampled");
}

/// Options that another format has no use for.
void refuse_idle(const Options& asked, tasks::ExportFormat format) {
  const bool fmu = format == tasks::ExportFormat::fmu2 || format == tasks::ExportFormat::fmu3;
  const bool state_space = format <= tasks::ExportFormat::hdf5;
  const bool superelement =
      format == tasks::ExportFormat::matrix_market || format == tasks::ExportFormat::dmig;
  const auto has_meaning = [&](std::string_view name) {
    return name == "system" && (fmu || asked.get<std::string>("system") == "mechanics");
  };
  if (!state_space)
    for (const char* name : {"sample_time", "inputs", "outputs", "system", "sampled", "reduce"})
      if (asked.has(name) && !has_meaning(name))
        base::refuse(name, "has no meaning here: it is for state spaces (mat, npz, json, hdf5)");
  refuse_idle(asked, state_space, superelement);
  if (superelement) return;
  if (asked.has("leg_modes") || asked.get("free_base", false))
    base::refuse(asked.has("leg_modes") ? "leg_modes" : "free_base",
                 "has no meaning here: it is for superelements (mtx, dmig)");
}

py::list parity_of(const exchange::Parity& parity) {
  constexpr std::array words{"exact", "approximate", "absent"};
  py::list list;
  for (const auto& line : parity)
    list.append(py::make_tuple(words[static_cast<std::size_t>(line.held)], line.what, line.how));
  return list;
}

py::tuple export_machine(const Machine& machine, const Options& asked) {
  tasks::ExportOptions options;
  options.format = static_cast<tasks::ExportFormat>(
      choice("to", asked.get<std::string>("to"),
             {tasks::export_formats.begin(), tasks::export_formats.end()}));
  refuse_idle(asked, options.format);
  options.path = asked.get<std::string>("path");
  if (asked.has("system")) options.system = system_kind(asked);
  options.pade_order = pade_order(asked);
  options.sample_time = asked.positive("sample_time", "s").value_or(0.0);
  options.sampled_controller = is_sampled(asked, system_kind(asked));
  options.inputs = asked.get<Names>("inputs");
  options.outputs = asked.get<Names>("outputs");
  options.p_PQ = point_of(asked);
  options.reduced_states = reduced_states(asked);
  options.leg_modes = asked.get("leg_modes", -1);
  options.free_base = asked.get("free_base", false);
  options.measure = asked.get("measure", true);
  options.approximate = asked.get("approximate", false);
  options.json_head = head_of_model("state_space", *machine);
  const auto done = without_gil([&] { return tasks::export_machine(*machine, options); });
  return py::make_tuple(done.files, parity_of(done.parity));
}

Names of_signals(const std::vector<exchange::Signal>& signals,
                 std::string exchange::Signal::*member) {
  Names list;
  for (const auto& one : signals) list.push_back(one.*member);
  return list;
}

py::array rest_of(const std::vector<exchange::Signal>& signals) {
  std::vector<double> values;
  for (const auto& one : signals) values.push_back(one.rest);
  return array_of(values);
}

struct StateSpace : Result {
  Machine machine{};
  exchange::StateSpace system{};
  [[nodiscard]] Json document() const override {
    return joined(head_of_model("state_space", *machine), exchange::state_space_json(system));
  }
};

std::shared_ptr<StateSpace> state_space(const Machine& machine, const Options& asked) {
  const auto system = system_kind(asked);
  refuse_idle(asked, true, false);
  const exchange::StateSpaceOptions options{
      .system = system,
      .kind = machine->kind,
      .p_PQ = point_of(asked).value_or(machine->file.machine.platform.mass_center),
      .pade_order = pade_order(asked),
      .sample_time = asked.positive("sample_time", "s").value_or(0.0),
      .sampled_controller = is_sampled(asked, system),
      .inputs = asked.get<Names>("inputs"),
      .outputs = asked.get<Names>("outputs"),
      .reduced_states = reduced_states(asked)};
  auto result = std::make_shared<StateSpace>();
  result->machine = machine;
  result->system = without_gil(
      [&] { return exchange::state_space(machine->file.machine, machine->pose.X_BP, options); });
  return result;
}

struct Superelement {
  exchange::Superelement element{};
};

std::shared_ptr<Superelement> superelement(const Machine& machine, const Options& asked) {
  const exchange::SuperelementOptions options{
      .kind = machine->kind,
      .p_PQ = point_of(asked).value_or(machine->file.machine.platform.mass_center),
      .leg_modes = asked.get("leg_modes", -1),
      .free_base = asked.get("free_base", false)};
  return without_gil([&] {
    return std::make_shared<Superelement>(
        Superelement{exchange::superelement(machine->file.machine, machine->pose.X_BP, options)});
  });
}

py::tuple multibody(const Machine& machine, const std::string& format) {
  const auto kind =
      static_cast<exchange::MultibodyFormat>(choice("format", format, {"mjcf", "sdf", "urdf"}));
  const auto file = without_gil([&] {
    return exchange::multibody_file(machine->file.machine, machine->pose.X_BP, machine->kind, kind);
  });
  return py::make_tuple(file.text, file.sidecar, parity_of(file.parity));
}

/// Text of the machine file, names, frequencies [Hz], damping ratios, participations (modes × 3),
/// mass [kg], first mode that is left out [Hz], coupling of two modes by damping: share, [Hz],
/// [Hz].
py::tuple attach(const Machine& machine, const Options& asked) {
  tasks::AttachOptions options{.stiffness = asked.get<std::string>("stiffness"),
                               .mass = asked.get<std::string>("mass"),
                               .damping = asked.get<std::string>("damping"),
                               .universal = asked.get("universal", false),
                               .grid = asked.get("grid", exchange::dmig_platform)};
  options.p_PI = point_of(asked).value_or(spatial::Vector3::Zero());
  const auto there = static_cast<int>(machine->file.machine.payload_modes.size());
  options.modes = asked.get("modes", model::most_payload_modes - there);
  options.damping_ratio = asked.at_least_zero("damping_ratio", "1").value_or(0.0);
  options.add_mass = asked.get("add_mass", false);
  const auto attached = without_gil([&] { return tasks::attach_payload(*machine, options); });
  const auto& payload = attached.payload;
  Names names;
  std::vector<double> frequencies, ratios, participations;
  for (const auto& mode : payload.modes) {
    names.push_back(mode.name);
    frequencies.push_back(mode.frequency);
    ratios.push_back(mode.damping_ratio);
    for (const double part : *mode.participation) participations.push_back(part);
  }
  const auto& coupling = payload.coupling;
  return py::make_tuple(
      attached.file.text, names, array_of(frequencies), array_of(ratios),
      array_of(participations, {static_cast<py::ssize_t>(names.size()), 3}), payload.mass(0, 0),
      payload.first_left_out / base::two_pi,
      py::make_tuple(coupling.share, coupling.omega / base::two_pi, coupling.other / base::two_pi));
}

}  // namespace

void add_exchange(py::module_& module) {
  auto type =
      py::class_<StateSpace, Result, std::shared_ptr<StateSpace>>(module, "MachineStateSpace");
  const auto matrix = [&](const char* name, auto member) {
    type.def_property_readonly(name, [member](const py::object& self) {
      return view_of(self.cast<const StateSpace&>().system.*member, self);
    });
  };
  matrix("A", &exchange::StateSpace::A);
  matrix("B", &exchange::StateSpace::B);
  matrix("C", &exchange::StateSpace::C);
  matrix("D", &exchange::StateSpace::D);
  const auto signals = [&](const std::string& name, auto member) {
    type.def_property_readonly(name.c_str(), [member](const StateSpace& s) {
      return of_signals(s.system.*member, &exchange::Signal::name);
    });
    const auto one = name.substr(0, name.size() - 1);
    type.def_property_readonly((one + "_units").c_str(), [member](const StateSpace& s) {
      return of_signals(s.system.*member, &exchange::Signal::unit);
    });
    type.def_property_readonly((one + "_rest").c_str(),
                               [member](const StateSpace& s) { return rest_of(s.system.*member); });
  };
  signals("states", &exchange::StateSpace::states);
  signals("inputs", &exchange::StateSpace::inputs);
  signals("outputs", &exchange::StateSpace::outputs);
  type.def_property_readonly("sample_time",
                             [](const StateSpace& s) { return s.system.sample_time; })
      .def_property_readonly("delay", [](const StateSpace& s) { return s.system.delay; })
      .def_property_readonly("pade_order", [](const StateSpace& s) { return s.system.pade_order; });
  module.def("machine_state_space", [](const Machine& machine, const py::dict& options) {
    return state_space(machine, Options(options));
  });
  auto element = py::class_<Superelement, std::shared_ptr<Superelement>>(module, "Superelement");
  const auto part = [&](const char* name, auto member) {
    element.def_property_readonly(name, [member](const py::object& self) {
      return view_of(self.cast<const Superelement&>().element.*member, self);
    });
  };
  part("M", &exchange::Superelement::M);
  part("K", &exchange::Superelement::K);
  part("C", &exchange::Superelement::C);
  element
      .def_property_readonly("coordinates",
                             [](const Superelement& s) {
                               return of_signals(s.element.coordinates, &exchange::Signal::name);
                             })
      .def_property_readonly("units",
                             [](const Superelement& s) {
                               return of_signals(s.element.coordinates, &exchange::Signal::unit);
                             })
      .def_property_readonly("first_left_out",
                             [](const Superelement& s) { return s.element.first_left_out; });
  module.def("superelement", [](const Machine& machine, const py::dict& options) {
    return superelement(machine, Options(options));
  });
  module.def("export_machine", [](const Machine& machine, const py::dict& options) {
    return export_machine(machine, Options(options));
  });
  module.def("attach", [](const Machine& machine, const py::dict& options) {
    return attach(machine, Options(options));
  });
  module.def("multibody", &multibody, py::arg("machine"), py::arg("format"));
}

}  // namespace hydrapod::python
