/// Designs: numbers of a machine that meet requirements at every pose with the best aim.

#include <fmt/format.h>

#include <limits>
#include <span>

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/tasks/study.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

struct Designed : Result {
  tasks::DesignJob job{};
  tasks::Designed done{};
  [[nodiscard]] const study::DesignResult& found() const { return done.result; }
  [[nodiscard]] Json document() const override {
    auto head = report::head_json("design", job.machine.file, job.machine.path);
    head["model"] = dynamics::name(job.machine.kind);
    return joined(head, report::design_json(job.problem, found()));
  }
};

/// A Python object for threads that do not hold the GIL.
std::shared_ptr<py::object> shared(const py::handle& object) {
  return {new py::object(py::reinterpret_borrow<py::object>(object)), [](py::object* kept) {
            const py::gil_scoped_acquire python;
            delete kept;
          }};
}

/// Outputs that are functions of a machine in Python, which give a number or None.
void add_own_outputs(const Machine& machine, const Options& asked, tasks::DesignOptions& options) {
  Names paths;
  for (const auto& change : options.change) paths.push_back(change.path);
  for (const auto& [name, call] : asked.get<py::dict>("outputs")) {
    options.own.push_back(
        {.column = {text_of(name, "outputs"), "1", "a function"},
         .of = [machine, paths, function = shared(call)](std::span<const double> values,
                                                         const model::NamedPose& pose) {
           const py::gil_scoped_acquire python;
           const auto found = (*function)(changed_machine(*machine, paths, values, pose.name));
           return found.is_none() ? std::numeric_limits<double>::quiet_NaN() : found.cast<double>();
         }});
  }
}

tasks::DesignOptions options_of(const Machine& machine, const Options& asked) {
  tasks::DesignOptions options{.want = asked.get<Names>("want")};
  for (const auto& [path, text] : asked.get<py::dict>("change")) {
    const auto key = text_of(path, "change");
    options.change.push_back({key, text_of(text, key), "change " + key});
  }
  for (const auto& name : asked.get<Names>("minimise")) options.aims.push_back({name, false});
  for (const auto& name : asked.get<Names>("maximise")) options.aims.push_back({name, true});
  for (const auto& name : asked.get<Names>("poses"))
    options.poses.push_back(tasks::pose_of(machine->file.machine, name));
  if (options.change.empty())
    base::refuse("change", "expected at least one number that may change");
  if (options.aims.empty() || options.aims.size() > 2)
    base::refuse("minimise",
                 "expected one aim, or two for a trade-off, in minimise and maximise together");
  add_own_outputs(machine, asked, options);
  return options;
}

study::DesignOptions search_of(const Options& asked) {
  const auto within = [&](const char* name, int otherwise, int least, int most) {
    const int value = asked.get(name, otherwise);
    if (value < least || value > most)
      throw std::invalid_argument(
          fmt::format("{}: expected {} to {}, got {}", name, least, most, value));
    return value;
  };
  return {.samples = static_cast<std::uint64_t>(within("samples", 2048, 16, 10000000)),
          .seed = asked.get<std::uint64_t>("seed", 1),
          .starts = within("starts", 6, 1, 1000),
          .front = within("trade_off", 11, 3, 1000),
          .threads = within("threads", 0, 0, 1024)};
}

std::shared_ptr<Designed> run_design(const Machine& machine, const Options& asked,
                                     const py::object& progress) {
  const auto options = options_of(machine, asked);
  const auto search = search_of(asked);
  auto result = std::make_shared<Designed>();
  at_work(progress, [&](const numerics::Progress& watch) {
    result->job = tasks::prepare_design(*machine, options);
    result->done = tasks::run_design(result->job, search, watch);
    return 0;
  });
  return result;
}

/// The machine whose file has the numbers of the best design.
Machine machine_of(const Designed& design) {
  if (design.done.text.empty())
    throw base::ComputationError("no design was found that meets all requirements");
  tasks::MachineOptions options{.text = design.done.text};
  options.pose = design.job.machine.pose.name;
  options.model = design.job.machine.kind;
  return without_gil([&] { return std::make_shared<Subject>(tasks::read_machine(options)); });
}

/// Points of the trade-off × aims, or × changes.
py::array front_of(const Designed& design, std::vector<double> study::DesignPoint::*member,
                   std::size_t columns) {
  std::vector<double> values;
  for (const auto& point : design.found().front)
    values.insert(values.end(), (point.*member).begin(), (point.*member).end());
  return array_of(values, {static_cast<py::ssize_t>(design.found().front.size()),
                           static_cast<py::ssize_t>(columns)});
}

template <class List, class Get>
Names names_in(const List& list, const Get& get) {
  Names names;
  for (const auto& one : list) names.push_back(get(one));
  return names;
}

Names worst_poses(const Designed& design) {
  return names_in(design.found().best.pose, [&](int pose) {
    return design.job.problem.poses[static_cast<std::size_t>(pose)].name;
  });
}

}  // namespace

void add_design(py::module_& module) {
  using D = Designed;
  py::class_<D, Result, std::shared_ptr<D>>(module, "Design")
      .def_property_readonly("feasible", [](const D& d) { return d.found().best.feasible; })
      .def_property_readonly("interrupted", [](const D& d) { return d.found().interrupted; })
      .def_property_readonly("evaluations", [](const D& d) { return d.found().evaluations; })
      .def_property_readonly("paths",
                             [](const D& d) {
                               return names_in(d.job.problem.changes,
                                               [](const auto& c) { return c.name; });
                             })
      .def_property_readonly("units",
                             [](const D& d) {
                               return names_in(d.job.problem.changes,
                                               [](const auto& c) { return c.unit; });
                             })
      .def_property_readonly("values", [](const D& d) { return array_of(d.found().best.values); })
      .def_property_readonly("present",
                             [](const D& d) { return array_of(d.found().present.values); })
      .def_property_readonly("aims",
                             [](const D& d) {
                               return names_in(d.job.problem.aims,
                                               [](const auto& a) { return a.text; });
                             })
      .def_property_readonly("aim_values", [](const D& d) { return array_of(d.found().best.aims); })
      .def_property_readonly("aim_present",
                             [](const D& d) { return array_of(d.found().present.aims); })
      .def_property_readonly("requirements",
                             [](const D& d) {
                               return names_in(d.job.problem.requirements,
                                               [](const auto& r) { return r.text; });
                             })
      .def_property_readonly("worst", [](const D& d) { return array_of(d.found().best.worst); })
      .def_property_readonly("worst_present",
                             [](const D& d) { return array_of(d.found().present.worst); })
      .def_property_readonly("worst_poses", &worst_poses)
      .def_property_readonly("front_aims",
                             [](const D& d) {
                               return front_of(d, &study::DesignPoint::aims,
                                               d.job.problem.aims.size());
                             })
      .def_property_readonly("front_values",
                             [](const D& d) {
                               return front_of(d, &study::DesignPoint::values,
                                               d.job.problem.changes.size());
                             })
      .def_property_readonly("text", [](const D& d) { return d.done.text; })
      .def("core_machine", &machine_of);
  module.def("design",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return run_design(machine, Options(options), progress);
             });
}

}  // namespace hydrapod::python
