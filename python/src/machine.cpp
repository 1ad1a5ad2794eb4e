/// Machines: reading, overriding, numbers by path.

#include "hydrapod/tasks/machine.hpp"

#include <algorithm>
#include <ctime>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/study/study.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "support.hpp"

namespace hydrapod::python {

std::string digits_of(double value) { return py::repr(py::float_(value)).cast<std::string>(); }

std::shared_ptr<Subject> changed_machine(const Subject& machine,
                                         const std::vector<std::string>& paths,
                                         std::span<const double> values, const std::string& pose) {
  tasks::MachineOptions options{.file = machine.path, .text = machine.file.text};
  options.overrides = machine.file.overrides;
  for (std::size_t k = 0; k < paths.size(); ++k)
    options.overrides.push_back(paths[k] + "=" + digits_of(values[k]));
  options.pose = pose;
  options.model = machine.kind;
  return without_gil([&] { return std::make_shared<Subject>(tasks::read_machine(options)); });
}

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::shared_ptr<Subject> read(const std::string& file, const std::optional<std::string>& text,
                              const std::vector<std::string>& overrides, const std::string& pose,
                              const std::optional<std::string>& model) {
  tasks::MachineOptions options{.file = file, .text = text, .overrides = overrides, .pose = pose};
  if (model)
    options.model =
        static_cast<dynamics::ModelKind>(choice("model", *model, {"rigid", "guide", "full"}));
  return without_gil([&] { return std::make_shared<Subject>(tasks::read_machine(options)); });
}

model::ParameterId found(const Subject& machine, const std::string& path) {
  const auto id = model::find_parameter(machine.file, path);
  if (id) return *id;
  const auto near = model::nearest_parameter(machine.file, path);
  base::refuse(machine.path, "'" + path + "' is no number of this machine" +
                                 (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

/// Its pose where the design has it.
const spatial::Pose& pose_of(const model::Machine& design, const Subject& machine) {
  const auto* pose = model::find_pose(design, machine.pose.name);
  return pose != nullptr ? pose->X_BP : machine.pose.X_BP;
}

/// Whether machines may have such numbers at `ids`: studies refuse the same ones.
class Allowed {
 public:
  Allowed(const Subject& machine, const std::vector<model::ParameterId>& ids)
      : machine_(machine),
        ids_(ids),
        bounds_are_enough_(std::ranges::all_of(
            ids, [&](const auto& id) { return model::stands_alone(machine.file.machine, id); })) {}

  bool operator()(const double* numbers) const {
    if (bounds_are_enough_) {
      for (std::size_t c = 0; c < ids_.size(); ++c)
        if (!model::within_bound({ids_[c], numbers[c]})) return false;
      return true;
    }
    const auto design = model::with(machine_.file.machine, assignments(ids_, numbers));
    return !has_error(model::validate(design)) &&
           !has_error(kinematics::check_pose(design, pose_of(design, machine_), ""));
  }

  static std::vector<model::Assignment> assignments(const std::vector<model::ParameterId>& ids,
                                                    const double* numbers) {
    std::vector<model::Assignment> all;
    all.reserve(ids.size());
    for (std::size_t c = 0; c < ids.size(); ++c) all.push_back({ids[c], numbers[c]});
    return all;
  }

 private:
  static bool has_error(const std::vector<model::Finding>& findings) {
    return std::ranges::any_of(
        findings, [](const auto& finding) { return finding.severity == base::Severity::error; });
  }

  const Subject& machine_;
  const std::vector<model::ParameterId>& ids_;
  bool bounds_are_enough_{};
};

/// Frequencies [Hz] of modal::modes_with_elastomers() of the design with `numbers` at `ids`; NaN
/// where it is not allowed or does not stand.
void design_frequencies(const Subject& machine, const std::vector<model::ParameterId>& ids,
                        const double* numbers, double* out, int modes) {
  if (!Allowed(machine, ids)(numbers)) {
    std::fill(out, out + modes, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  try {
    const auto design = model::with(machine.file.machine, Allowed::assignments(ids, numbers));
    const auto model = dynamics::linear_model(design, pose_of(design, machine), machine.kind);
    const auto found = modal::modes_with_elastomers(design, model);
    for (int m = 0; m < modes; ++m) out[m] = found.omega(m) / base::two_pi;
  } catch (const base::ComputationError&) {
    std::fill(out, out + modes, std::numeric_limits<double>::quiet_NaN());
  }
}

/// Row k of the result has the frequencies of the design with the numbers of row k of `values`.
py::array frequencies(const Subject& machine, const std::vector<std::string>& paths,
                      const Doubles& values, int threads, const py::object& progress) {
  if (values.ndim() != 2 || values.shape(1) != static_cast<py::ssize_t>(paths.size()))
    throw std::invalid_argument("values: expected one row per design and one column per path (" +
                                std::to_string(paths.size()) + ")");
  std::vector<model::ParameterId> ids;
  for (const auto& path : paths) ids.push_back(found(machine, path));
  const auto count = static_cast<std::size_t>(values.shape(0));
  const auto columns = ids.size();
  const double* numbers = values.data();
  for (std::size_t k = 0; k < count * columns; ++k)
    if (!std::isfinite(numbers[k]))
      throw std::invalid_argument("values: a number is not finite, in row " +
                                  std::to_string(k / columns));
  const int modes = dynamics::degrees_of_freedom(machine.file.machine, machine.kind);
  py::array_t<double> result({static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(modes)});
  double* out = result.mutable_data();
  const auto width = static_cast<std::size_t>(modes);
  const Allowed allowed(machine, ids);
  constexpr std::size_t block = 512;  // designs between two looks at signals
  const bool all = at_work(progress, [&](const numerics::Progress& watch) {
    return numerics::parallel_for(
        (count + block - 1) / block, threads,
        [&](std::size_t b) {
          const std::size_t first = b * block, here = std::min(block, count - first);
          study::DesignFrequencies of(machine.file.machine, machine.pose.X_BP, machine.kind, ids,
                                      machine.pose.name);
          double* const to = out + first * width;
          of({numbers + first * columns, here * columns}, {to, here * width});
          for (std::size_t k = 0; k < here * width; ++k) to[k] /= base::two_pi;
          for (std::size_t k = 0; k < here; ++k)
            if (!allowed(numbers + (first + k) * columns))
              std::fill_n(to + k * width, width, std::numeric_limits<double>::quiet_NaN());
        },
        watch);
  });
  if (!all) throw base::ComputationError("interrupted before all designs were computed");
  return result;
}

/// The same of one design, {path: float}; none where a value is no finite float.
std::optional<py::array> one_design(const Subject& machine, const py::dict& design) {
  std::vector<model::ParameterId> ids;
  std::vector<double> numbers;
  for (const auto& [path, value] : design) {
    if (!py::isinstance<py::str>(path) || !PyFloat_CheckExact(value.ptr()) ||
        !std::isfinite(PyFloat_AS_DOUBLE(value.ptr())))
      return {};
    ids.push_back(found(machine, text_of(path, "designs")));
    numbers.push_back(PyFloat_AS_DOUBLE(value.ptr()));
  }
  const int modes = dynamics::degrees_of_freedom(machine.file.machine, machine.kind);
  py::array_t<double> result({py::ssize_t{1}, static_cast<py::ssize_t>(modes)});
  double* out = result.mutable_data();
  without_gil([&] {
    design_frequencies(machine, ids, numbers.data(), out, modes);
    return 0;
  });
  return result;
}

/// Processor time [s] of one call, of `count` calls in C++: what bench/python.py compares the calls
/// from Python with.
double seconds_of_calls(const Subject& machine, const std::string& task, const std::string& path,
                        int count) {
  const auto which = choice("task", task, {"modes", "frequencies"});
  const std::vector ids{found(machine, path)};
  const double number = model::value(machine.file.machine, ids.front()).value_or(0.0);
  const int modes = dynamics::degrees_of_freedom(machine.file.machine, machine.kind);
  std::vector<double> out(static_cast<std::size_t>(modes));
  return without_gil([&] {
    const auto begun = std::clock();
    for (int k = 0; k < count; ++k)
      if (which == 0)
        out.front() = tasks::modes(machine).real.modes.front().mode.omega;
      else
        design_frequencies(machine, ids, &number, out.data(), modes);
    return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC / count;
  });
}

}  // namespace

void add_machine(py::module_& module) {
  py::class_<Subject, std::shared_ptr<Subject>>(module, "Machine")
      .def_property_readonly("name", [](const Subject& m) { return m.file.machine.name; })
      .def_property_readonly("description",
                             [](const Subject& m) { return m.file.machine.description; })
      .def_readonly("path", &Subject::path)
      .def_property_readonly("text", [](const Subject& m) { return m.file.text; })
      .def_property_readonly(
          "applied_text",
          [](const Subject& m) {
            return model::edited_file(
                m.file.text, model::edits_of_overrides(m.file.text, m.file.overrides), "override");
          })
      .def_property_readonly("overrides", [](const Subject& m) { return m.file.overrides; })
      .def_property_readonly("pose", [](const Subject& m) { return m.pose.name; })
      .def_property_readonly("model", [](const Subject& m) { return dynamics::name(m.kind); })
      .def_property_readonly("warnings", [](const Subject& m) { return texts(m.file.warnings); })
      .def_property_readonly("poses",
                             [](const Subject& m) {
                               std::vector<std::string> names;
                               for (const auto& pose : m.file.machine.poses)
                                 names.push_back(pose.name);
                               return names;
                             })
      .def_property_readonly("paths",
                             [](const Subject& m) {
                               std::vector<std::string> paths;
                               for (const auto& id : model::parameters(m.file.machine))
                                 paths.push_back(model::path(m.file.machine, id));
                               return paths;
                             })
      .def("value",
           [](const Subject& m, const std::string& path) {
             const auto value = model::value(m.file.machine, found(m, path));
             if (!value) base::refuse(m.path, "'" + path + "' is not given in this machine");
             return *value;
           })
      .def("unit", [](const Subject& m, const std::string& path) {
        return std::string(model::unit(m.file.machine, found(m, path)));
      });
  module.def("read_machine", &read, py::arg("file"), py::arg("text"), py::arg("overrides"),
             py::arg("pose"), py::arg("model"));
  module.def("frequencies", &frequencies, py::arg("machine"), py::arg("paths"), py::arg("values"),
             py::arg("threads"), py::arg("progress"));
  module.def("one_design", &one_design, py::arg("machine"), py::arg("design"));
  module.def("seconds_of_calls", &seconds_of_calls, py::arg("machine"), py::arg("task"),
             py::arg("path"), py::arg("count"));
  module.def("starter_machine_file", &model::starter_machine_file);
  module.def("parameter_reference", &model::parameter_reference);
  module.def("quantity", [](const py::object& value, const char* unit, const std::string& name) {
    return quantity(value, unit, name);
  });
}

}  // namespace hydrapod::python
