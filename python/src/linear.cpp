/// Tasks on the machine near rest: modes, system, root locus, Bode, check, sensitivity.

#include "hydrapod/tasks/linear.hpp"

#include <algorithm>
#include <atomic>
#include <memory>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;

struct Modes : Result {
  /// Computes them in place: the table has some tens of kilobytes.
  Modes(const Machine& of, bool with_matrices)
      : machine(of), table(tasks::modes(*of)), matrices(with_matrices) {}
  Machine machine;
  modal::ModeTable table;
  bool matrices;
  [[nodiscard]] Json document() const override {
    auto json = report::modes_json(table);
    if (matrices) json["matrices"] = report::matrices_json(table);
    return joined(report::head_json("modes", *machine), json);
  }
};

/// Keeps the memory of one object that has gone for the next one. glibc's free() of more than 64 kB
/// empties its lists of small pieces, which the modes of the next call have to fill again: a
/// twentieth of the time of modes().
template <class T>
struct KeepOne {
  using value_type = T;
  KeepOne() = default;
  template <class Other>
  explicit KeepOne(const KeepOne<Other>& /*other*/) {}
  T* allocate(std::size_t count) {
    if (count == 1)
      if (void* const there = kept.exchange(nullptr)) return static_cast<T*>(there);
    return std::allocator<T>().allocate(count);
  }
  void deallocate(T* object, std::size_t count) {
#ifndef HYDRAPOD_SANITIZED  // which would not see that the object has gone
    void* none = nullptr;
    if (count == 1 && kept.compare_exchange_strong(none, object)) return;
#endif
    std::allocator<T>().deallocate(object, count);
  }
  template <class Other>
  bool operator==(const KeepOne<Other>& /*other*/) const {
    return true;
  }
  inline static std::atomic<void*> kept{};
};

/// One of the two models of Modes.
struct ModelModes {
  std::shared_ptr<const Modes> modes{};
  const modal::AnalysedModel* model{};
};

template <class Get>
py::array per_mode(const modal::AnalysedModel& model, Get get) {
  return array_of_each(model.modes, get);
}

/// Coordinates × modes; real where all shapes are.
py::array shapes(const modal::AnalysedModel& model) {
  const auto rows = model.linear.M.rows();
  const auto columns = static_cast<py::ssize_t>(model.modes.size());
  bool complex = false;
  for (const auto& mode : model.modes) complex = complex || mode.mode.is_complex();
  py::array_t<double> real({static_cast<py::ssize_t>(rows), columns});
  py::array_t<std::complex<double>> both({static_cast<py::ssize_t>(rows), columns});
  for (py::ssize_t k = 0; k < columns; ++k)
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto& mode = model.modes[static_cast<std::size_t>(k)].mode;
      real.mutable_at(i, k) = mode.real[i];
      both.mutable_at(i, k) = {mode.real[i], mode.is_complex() ? mode.imaginary[i] : 0.0};
    }
  return complex ? read_only(both) : read_only(real);
}

struct System : Result {
  Machine machine{};
  report::System system{};
  [[nodiscard]] Json document() const override {
    return joined(head_of_model("system", *machine), report::system_json(system));
  }
};

struct RootLocus : Result {
  Machine machine{};
  report::RootLocus locus{};
  [[nodiscard]] Json document() const override {
    return joined(head_of_model("root_locus", *machine), report::root_locus_json(locus));
  }
};

struct Bode : Result {
  Machine machine{};
  report::Bode bode{};
  [[nodiscard]] Json document() const override {
    return joined(report::head_json("bode", *machine), report::bode_json(bode));
  }
};

struct CommandResponse : Result {
  Machine machine{};
  tasks::SystemResponse found{};
  [[nodiscard]] Json document() const override {
    auto json = head_of_model("bode", *machine);
    json.update({{"input", "command"}, {"output", "displacement"}});
    return joined(json, report::command_response_json(found.response));
  }
};

struct Check : Result {
  Machine machine{};
  std::vector<report::PoseCheck> poses{};
  [[nodiscard]] Json document() const override {
    return joined(report::head_json("check", machine->file, machine->path),
                  report::check_json(poses, machine->file.machine));
  }
};

struct Sensitivity : Result {
  Machine machine{};
  calibration::Sensitivities found{};
  [[nodiscard]] Json document() const override {
    return joined(head_of_model("sensitivity", *machine), report::sensitivity_json(found));
  }
};

/// [Hz] of rates [rad/s].
py::array hertz(const std::vector<double>& omega) {
  std::vector<double> values(omega);
  for (auto& value : values) value /= base::two_pi;
  return array_of(values);
}

std::shared_ptr<Modes> modes(const Machine& machine, bool matrices) {
  return without_gil(
      [&] { return std::allocate_shared<Modes>(KeepOne<Modes>(), machine, matrices); });
}

std::shared_ptr<System> system(const Machine& machine, bool closed, int pade_order) {
  auto result = std::make_shared<System>();
  result->machine = machine;
  result->system = without_gil(
      [&] { return tasks::system(*machine, {.closed = closed, .pade_order = pade_order}); });
  return result;
}

std::shared_ptr<RootLocus> root_locus(const Machine& machine, const std::string& key, double from,
                                      double to, int count, bool closed, int pade_order,
                                      const py::object& progress) {
  auto result = std::make_shared<RootLocus>();
  result->machine = machine;
  const tasks::RootLocusOptions options{.key = key,
                                        .from = from,
                                        .to = to,
                                        .count = count,
                                        .system = {.closed = closed, .pade_order = pade_order}};
  result->locus = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::root_locus(*machine, options, watch);
  });
  return result;
}

py::object bode(const Machine& machine, const Options& asked) {
  const auto input =
      choice("input", asked.get<std::string>("input", "wrench"), {"wrench", "actuator", "command"});
  report::BodeOptions options;
  if (asked.has("from")) options.from = angular(asked["from"], "from_");
  if (asked.has("to")) options.to = angular(asked["to"], "to");
  if (options.from && options.to && *options.from >= *options.to)
    base::refuse("from_", "must be less than to");
  options.points = asked.get("points", 2000);
  if (options.points < 2 || options.points > 100000)
    throw std::invalid_argument("points: expected 2 to 100000, got " +
                                std::to_string(options.points));
  const auto output = choice("output", asked.get<std::string>("output", "displacement"),
                             {"displacement", "velocity", "acceleration"});
  if (input == 2) {
    if (output != 0 || asked.has("point"))
      base::refuse("input=command",
                   "the output is the displacement of the platform frame's origin; leave output "
                   "and point out");
    auto result = std::make_shared<CommandResponse>();
    result->machine = machine;
    result->found = without_gil([&] {
      return tasks::command_response(
          *machine, {.from = options.from, .to = options.to, .points = options.points});
    });
    return py::cast(result);
  }
  options.input = static_cast<response::Input>(input);
  options.output = static_cast<response::Output>(output);
  if (asked.has("point")) {
    const auto point = asked.get<std::vector<py::object>>("point");
    if (point.size() != 3) throw std::invalid_argument("point: expected three lengths");
    options.p_PQ =
        spatial::Vector3(quantity(point[0], "m", "point"), quantity(point[1], "m", "point"),
                         quantity(point[2], "m", "point"));
  }
  auto result = std::make_shared<Bode>();
  result->machine = machine;
  result->bode = without_gil([&] { return tasks::bode(*machine, options); });
  return py::cast(result);
}

std::shared_ptr<Check> check(const Machine& machine, bool all_poses) {
  auto result = std::make_shared<Check>();
  result->machine = machine;
  result->poses = without_gil([&] {
    return tasks::check(*machine,
                        all_poses ? machine->file.machine.poses : std::vector{machine->pose});
  });
  return result;
}

std::shared_ptr<Sensitivity> sensitivity(const Machine& machine,
                                         const std::vector<std::string>& parameters) {
  auto result = std::make_shared<Sensitivity>();
  result->machine = machine;
  result->found =
      without_gil([&] { return tasks::sensitivity(*machine, {.parameters = parameters}); });
  return result;
}

/// Poses × legs.
template <class Get>
py::array of_legs(const Check& check, Get get) {
  std::vector<double> values;
  for (const auto& pose : check.poses)
    for (const auto& leg : pose.legs) values.push_back(get(leg));
  return array_of(values, {static_cast<py::ssize_t>(check.poses.size()), model::leg_count});
}

void add_modes(py::module_& module) {
  using Model = ModelModes;
  py::class_<Model>(module, "ModelModes")
      .def_property_readonly("frequency_hz",
                             [](const Model& m) {
                               return per_mode(*m.model, [](const auto& mode) {
                                 return mode.mode.omega / base::two_pi;
                               });
                             })
      .def_property_readonly("omega",
                             [](const Model& m) {
                               return per_mode(*m.model,
                                               [](const auto& mode) { return mode.mode.omega; });
                             })
      .def_property_readonly(
          "damping_ratio",
          [](const Model& m) {
            return per_mode(*m.model, [](const auto& mode) { return mode.mode.damping_ratio; });
          })
      .def_property_readonly("poles",
                             [](const Model& m) {
                               return per_mode(*m.model,
                                               [](const auto& mode) { return mode.mode.pole; });
                             })
      .def_property_readonly("labels",
                             [](const Model& m) {
                               std::vector<std::string> labels;
                               for (const auto& mode : m.model->modes) labels.push_back(mode.label);
                               return labels;
                             })
      .def_property_readonly("moves_platform",
                             [](const Model& m) {
                               std::vector<bool> felt;
                               for (const auto& mode : m.model->modes)
                                 felt.push_back(mode.moves_platform);
                               return felt;
                             })
      .def_property_readonly("stable",
                             [](const Model& m) {
                               bool all = true;
                               for (const auto& mode : m.model->modes)
                                 all = all && mode.mode.stable;
                               return all;
                             })
      .def_property_readonly("shapes", [](const Model& m) { return shapes(*m.model); })
      .def_property_readonly("coordinates",
                             [](const Model& m) {
                               const auto& linear = m.model->linear;
                               return dynamics::coordinate_names(
                                   linear.kind, linear.base_directions, linear.payload_names);
                             })
      .def_property_readonly("M",
                             [](const py::object& self) {
                               return view_of(self.cast<const Model&>().model->linear.M, self);
                             })
      .def_property_readonly("K",
                             [](const py::object& self) {
                               return view_of(self.cast<const Model&>().model->linear.K, self);
                             })
      .def_property_readonly("C",
                             [](const py::object& self) {
                               return view_of(self.cast<const Model&>().model->linear.C, self);
                             })
      .def_property_readonly("modal_damping_ratio",
                             [](const Model& m) { return m.modes->table.ratio.value; });
  py::class_<Modes, Result, std::shared_ptr<Modes>>(module, "Modes")
      .def_property_readonly("flexible",
                             [](const std::shared_ptr<Modes>& m) {
                               return ModelModes{m, &m->table.real};
                             })
      .def_property_readonly("rigid",
                             [](const std::shared_ptr<Modes>& m) {
                               return ModelModes{m, &m->table.rigid};
                             })
      .def_property_readonly("answer", [](const Modes& m) { return report::answer_text(m.table); });
  module.def("modes", &modes, py::arg("machine"), py::arg("matrices"));
}

void add_system(py::module_& module) {
  auto type = py::class_<System, Result, std::shared_ptr<System>>(module, "System");
  const auto matrix = [&](const char* name, auto get) {
    type.def_property_readonly(name, [get](const py::object& self) {
      return view_of(get(self.cast<const System&>().system.linear), self);
    });
  };
  using Linear = simulation::LinearSystem;
  matrix("A", [](const Linear& s) -> const Eigen::MatrixXd& { return s.A; });
  matrix("B_command", [](const Linear& s) -> const Eigen::MatrixXd& { return s.B_command; });
  matrix("B_velocity", [](const Linear& s) -> const Eigen::MatrixXd& { return s.B_velocity; });
  matrix("B_valve", [](const Linear& s) -> const Eigen::MatrixXd& { return s.B_valve; });
  matrix("B_wrench", [](const Linear& s) -> const Eigen::MatrixXd& { return s.B_wrench; });
  matrix("C", [](const Linear& s) -> const Eigen::MatrixXd& { return s.C; });
  matrix("C_ground", [](const Linear& s) -> const Eigen::MatrixXd& { return s.C_ground; });
  matrix("sampled", [](const Linear& s) -> const Eigen::MatrixXd& { return s.sampled; });
  type.def_property_readonly("states", [](const System& s) { return s.system.linear.states; })
      .def_property_readonly("delay", [](const System& s) { return s.system.linear.delay; })
      .def_property_readonly("sample_time",
                             [](const System& s) { return s.system.linear.sample_time; })
      .def_property_readonly("closed", [](const System& s) { return s.system.closed; })
      .def_property_readonly("stable",
                             [](const System& s) {
                               return s.system.closed ? s.system.poles.sampled_stable
                                                      : s.system.poles.stable;
                             })
      .def_property_readonly("verdict",
                             [](const System& s) { return report::verdict_text(s.system.poles); })
      .def_property_readonly("poles",
                             [](const System& s) {
                               std::vector<std::complex<double>> poles;
                               for (const auto& pole : s.system.poles.poles)
                                 poles.push_back(pole.pole);
                               return array_of(poles);
                             })
      .def_property_readonly("damping_ratio",
                             [](const System& s) {
                               std::vector<double> ratios;
                               for (const auto& pole : s.system.poles.poles)
                                 ratios.push_back(pole.damping_ratio);
                               return array_of(ratios);
                             })
      .def_property_readonly("participation", [](const System& s) {
        std::vector<std::string> words;
        for (const auto& pole : s.system.poles.poles)
          words.push_back(report::participation_text(pole));
        return words;
      });
  module.def("system", &system, py::arg("machine"), py::arg("closed"), py::arg("pade_order"));
  py::class_<RootLocus, Result, std::shared_ptr<RootLocus>>(module, "RootLocus")
      .def_property_readonly("key", [](const RootLocus& r) { return r.locus.key; })
      .def_property_readonly("values", [](const RootLocus& r) { return array_of(r.locus.values); })
      .def_property_readonly("limits", [](const RootLocus& r) { return array_of(r.locus.limits); })
      .def_property_readonly("poles", [](const RootLocus& r) {
        py::list all;
        for (const auto& one : r.locus.poles) {
          std::vector<std::complex<double>> poles;
          for (const auto& pole : one.poles) poles.push_back(pole.pole);
          all.append(array_of(poles));
        }
        return all;
      });
  module.def("root_locus", &root_locus, py::arg("machine"), py::arg("key"), py::arg("start"),
             py::arg("stop"), py::arg("count"), py::arg("closed"), py::arg("pade_order"),
             py::arg("progress"));
}

}  // namespace

void add_linear(py::module_& module) {
  add_modes(module);
  add_system(module);
  py::class_<Bode, Result, std::shared_ptr<Bode>>(module, "Bode")
      .def_property_readonly(
          "omega",
          [](const py::object& self) { return view_of(self.cast<const Bode&>().bode.omega, self); })
      .def_property_readonly("frequency_hz", [](const Bode& b) { return hertz(b.bode.omega); })
      .def_property_readonly("stable",
                             [](const Bode& b) {
                               return std::ranges::all_of(
                                   b.bode.table.real.modes,
                                   [](const auto& mode) { return mode.mode.stable; });
                             })
      .def_property_readonly(
          "H",
          [](const py::object& self) { return pages_of(self.cast<const Bode&>().bode.real, self); })
      .def_property_readonly("H_rigid", [](const py::object& self) {
        return pages_of(self.cast<const Bode&>().bode.rigid, self);
      });
  py::class_<CommandResponse, Result, std::shared_ptr<CommandResponse>>(module, "CommandResponse")
      .def_property_readonly("omega",
                             [](const py::object& self) {
                               return view_of(
                                   self.cast<const CommandResponse&>().found.response.omega, self);
                             })
      .def_property_readonly("frequency_hz",
                             [](const CommandResponse& r) { return hertz(r.found.response.omega); })
      .def_property_readonly("H",
                             [](const py::object& self) {
                               return pages_of(self.cast<const CommandResponse&>().found.response.H,
                                               self);
                             })
      .def_property_readonly(
          "stable", [](const CommandResponse& r) { return r.found.system.poles.sampled_stable; });
  module.def("bode", [](const Machine& machine, const py::dict& options) {
    return bode(machine, Options(options));
  });
  py::class_<Check, Result, std::shared_ptr<Check>>(module, "Check")
      .def_property_readonly("poses",
                             [](const Check& c) {
                               std::vector<std::string> names;
                               for (const auto& one : c.poses) names.push_back(one.pose.name);
                               return names;
                             })
      .def_property_readonly(
          "sound",
          [](const Check& c) { return report::is_sound(c.poses, c.machine->file.machine); })
      .def_property_readonly(
          "verdict",
          [](const Check& c) { return report::verdict_text(c.poses, c.machine->file.machine); })
      .def_property_readonly(
          "warnings",
          [](const Check& c) {
            std::vector<std::string> all;
            for (const auto& one : c.poses)
              for (const auto& warning : one.warnings)
                all.push_back(one.pose.name + ": " + report::warning_text(warning));
            return all;
          })
      .def_property_readonly(
          "lengths", [](const Check& c) { return of_legs(c, [](auto& l) { return l.length; }); })
      .def_property_readonly(
          "axial_force",
          [](const Check& c) { return of_legs(c, [](auto& l) { return l.axial_force; }); })
      .def_property_readonly(
          "oil_stiffness",
          [](const Check& c) { return of_legs(c, [](auto& l) { return l.oil_stiffness; }); })
      .def_property_readonly(
          "tilt", [](const Check& c) { return of_legs(c, [](auto& l) { return l.tilt; }); })
      .def_property_readonly("buckling_payload", [](const Check& c) {
        std::vector<double> loads;
        for (const auto& one : c.poses)
          loads.push_back(one.buckling_sought &&
                                  one.buckling.status != dynamics::BucklingStatus::not_found
                              ? one.buckling.payload
                              : std::numeric_limits<double>::quiet_NaN());
        return array_of(loads);
      });
  module.def("check", &check, py::arg("machine"), py::arg("all_poses"));
  py::class_<Sensitivity, Result, std::shared_ptr<Sensitivity>>(module, "Sensitivity")
      .def_property_readonly("parameters",
                             [](const Sensitivity& s) {
                               std::vector<std::string> paths;
                               for (const auto& one : s.found.parameters) paths.push_back(one.path);
                               return paths;
                             })
      .def_property_readonly("omega",
                             [](const py::object& self) {
                               return view_of(self.cast<const Sensitivity&>().found.omega, self);
                             })
      .def_property_readonly("percent_per_percent", [](const py::object& self) {
        return view_of(self.cast<const Sensitivity&>().found.percent_per_percent, self);
      });
  module.def("sensitivity", &sensitivity, py::arg("machine"), py::arg("parameters"));
}

}  // namespace hydrapod::python
