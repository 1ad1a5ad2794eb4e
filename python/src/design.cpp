/// Designs that meet requirements.

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/study_results.hpp"
#include "hydrapod/tasks/study.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

struct Designed : Result {
  tasks::DesignJob job{};
  tasks::Designed done{};
  [[nodiscard]] Json document() const override {
    return joined(
        [&] {
          auto head = report::head_json("design", job.machine.file, job.machine.path);
          head["model"] = dynamics::name(job.machine.kind);
          return head;
        }(),
        report::design_json(job.problem, done.result));
  }
};

tasks::DesignOptions design_options(const Machine& machine, const Options& asked) {
  tasks::DesignOptions options{.want = asked.get<Names>("want")};
  for (const auto& [path, text] : asked.get<py::dict>("change")) {
    const auto key = path.cast<std::string>();
    options.change.push_back({key, text.cast<std::string>(), "change " + key});
  }
  for (const auto& name : asked.get<Names>("minimise")) options.aims.push_back({name, false});
  for (const auto& name : asked.get<Names>("maximise")) options.aims.push_back({name, true});
  if (options.change.empty())
    base::refuse("change",
                 "expected at least one number that may change, {PATH: \"from:to unit\"}");
  if (options.aims.empty() || options.aims.size() > 2)
    base::refuse("minimise", "expected one aim, or two for a trade-off, of minimise and maximise");
  const auto& model = machine->file.machine;
  for (const auto& pose : asked.get<Names>("poses"))
    options.poses.push_back(tasks::pose_of(model, pose));
  if (asked.get("all_poses", false)) options.poses = model.poses;
  return options;
}

std::shared_ptr<Designed> run_design(const Machine& machine, const Options& asked,
                                     const py::object& progress) {
  const auto options = design_options(machine, asked);
  study::DesignOptions search{.samples = asked.get<std::uint64_t>("samples", 2048),
                              .seed = asked.get<std::uint64_t>("seed", 1),
                              .starts = asked.get("starts", 6),
                              .front = asked.get("trade_off", 11),
                              .threads = asked.get("threads", 0)};
  if (search.samples < 16) throw std::invalid_argument("samples: expected at least 16");
  if (search.starts < 1) throw std::invalid_argument("starts: expected at least 1");
  if (search.front < 3) throw std::invalid_argument("trade_off: expected at least 3 points");
  auto result = std::make_shared<Designed>();
  at_work(progress, [&](const numerics::Progress& watch) {
    result->job = tasks::prepare_design(*machine, options);
    result->done = tasks::run_design(result->job, search, watch);
    return 0;
  });
  return result;
}

Names changes(const Designed& design) {
  Names names;
  for (const auto& change : design.job.problem.changes) names.push_back(change.name);
  return names;
}

/// points × numbers of each
py::array front(const Designed& design, std::vector<double> study::DesignPoint::*member,
                std::size_t width) {
  std::vector<double> values;
  for (const auto& point : design.done.result.front)
    values.insert(values.end(), (point.*member).begin(), (point.*member).end());
  return array_of(values, {static_cast<py::ssize_t>(design.done.result.front.size()),
                           static_cast<py::ssize_t>(width)});
}

}  // namespace

void add_design(py::module_& module) {
  py::class_<Designed, Result, std::shared_ptr<Designed>>(module, "Designed", py::dynamic_attr())
      .def_property_readonly("feasible",
                             [](const Designed& d) { return d.done.result.best.feasible; })
      .def_property_readonly("interrupted",
                             [](const Designed& d) { return d.done.result.interrupted; })
      .def_property_readonly("names", &changes)
      .def_property_readonly("values",
                             [](const Designed& d) { return array_of(d.done.result.best.values); })
      .def_property_readonly("aims",
                             [](const Designed& d) { return array_of(d.done.result.best.aims); })
      .def_property_readonly("requirements",
                             [](const Designed& d) {
                               Names list;
                               for (const auto& one : d.job.problem.requirements)
                                 list.push_back(one.text);
                               return list;
                             })
      .def_property_readonly("worst",
                             [](const Designed& d) { return array_of(d.done.result.best.worst); })
      .def_property_readonly("front_aims",
                             [](const Designed& d) {
                               return front(d, &study::DesignPoint::aims,
                                            d.job.problem.aims.size());
                             })
      .def_property_readonly("front_values",
                             [](const Designed& d) {
                               return front(d, &study::DesignPoint::values,
                                            d.job.problem.changes.size());
                             })
      .def_property_readonly("machine_text", [](const Designed& d) {
        if (d.done.text.empty())
          base::refuse("machine_text", "no design was found that meets all requirements");
        return d.done.text;
      });
  module.def("design",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return run_design(machine, Options(options), progress);
             });
}

}  // namespace hydrapod::python
