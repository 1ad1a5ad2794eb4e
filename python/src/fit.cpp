/// Calibration, diagnosis, the report.

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "measurement.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

struct Calibrated : Result {
  Machine machine{};
  tasks::Calibrated found{};
  [[nodiscard]] Json document() const override {
    auto json = report::calibration_json(found.result, found.targets);
    json["profiles"] = Json::array();
    for (const auto& profile : found.profiles)
      json["profiles"].push_back(report::profile_json(profile, found.result.best()));
    auto head = report::head_json("calibration", machine->file, machine->path);
    head["model"] = dynamics::name(machine->kind);
    return joined(head, json);
  }
};

struct Diagnosed : Result {
  Machine machine{};
  std::string measured{};
  tasks::Diagnosed found{};
  [[nodiscard]] Json document() const override {
    auto head = report::head_json("diagnosis", machine->file, machine->path);
    head["model"] = dynamics::name(machine->kind);
    head["measured"] = measured;
    return joined(head, report::diagnosis_json(found.file));
  }
};

struct Report : Result {
  tasks::Report found{};
  report::Theme theme{};
  [[nodiscard]] Json document() const override { return found.document; }
};

std::string number_text(const py::handle& value) {
  return py::isinstance<py::str>(value)
             ? text_of(value, "a quantity")
             : py::repr(py::float_(py::reinterpret_borrow<py::object>(value))).cast<std::string>();
}

/// A dict or a list: paths ("a" or "a, b" tied), with (low, high) or None.
std::vector<calibration::FreeParameter> free_parameters(const py::object& given) {
  std::vector<calibration::FreeParameter> list;
  const auto add = [&](const std::string& paths, const py::object& bounds) {
    calibration::FreeParameter free{.paths = base::split(paths, ","),
                                    .origin = {.file = "free " + paths}};
    if (!bounds.is_none()) {
      const auto pair = bounds.cast<std::vector<py::object>>();
      if (pair.size() != 2)
        throw std::invalid_argument("free: bounds of " + paths + " are a pair (lowest, highest)");
      free.lower = number_text(pair[0]);
      free.upper = number_text(pair[1]);
    }
    list.push_back(free);
  };
  if (py::isinstance<py::dict>(given))
    for (const auto& [key, value] : given.cast<py::dict>())
      add(text_of(key, "free"), py::reinterpret_borrow<py::object>(value));
  else if (py::isinstance<py::str>(given))
    add(text_of(given, "free"), py::none());
  else
    for (const auto& path : read_as<Names>(given, "free")) add(path, py::none());
  return list;
}

std::shared_ptr<Calibrated> calibrate(const Machine& machine, const Options& asked,
                                      const py::object& progress) {
  tasks::CalibrateOptions options{.targets = asked.get<std::string>("targets"),
                                  .profiles = asked.get<Names>("profiles")};
  auto& plan = options.plan;
  if (asked.has("free")) plan.free = free_parameters(asked["free"]);
  if (asked.has("priors"))
    for (const auto& [key, value] : asked.get<py::dict>("priors")) {
      const auto pair = value.cast<std::vector<py::object>>();
      if (pair.size() != 2) throw std::invalid_argument("priors: expected PATH: (value, spread)");
      options.priors.push_back(
          {text_of(key, "priors"), {number_text(pair[0]), number_text(pair[1])}});
    }
  for (const auto& text : asked.get<Names>("alternatives")) {
    calibration::Alternative made{.name = "with " + text, .origin = {.file = "--try " + text}};
    made.choices = {{"no", {}}, {"yes", base::split(text, ";")}};
    plan.alternatives.push_back(made);
  }
  if (asked.has("starts")) options.starts = asked.get<int>("starts");
  if (options.starts && (*options.starts < 1 || *options.starts > 10000))
    throw std::invalid_argument("starts: expected 1 to 10000");
  if (asked.has("seed")) options.seed = asked.get<std::uint64_t>("seed");
  if (asked.has("loss"))
    options.loss = static_cast<calibration::Loss>(
        choice("loss", asked.get<std::string>("loss"), {"automatic", "squares", "cauchy"}));
  plan.options.threads = asked.get("threads", 0);
  auto result = std::make_shared<Calibrated>();
  result->machine = machine;
  result->found = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::calibrate(*machine, options, watch);
  });
  return result;
}

diagnosis::RemedyGoal goal_of(const Options& asked) {
  diagnosis::RemedyGoal goal;
  if (!asked.has("want")) {
    goal.drop = 0.02;
    return goal;
  }
  const py::object given = asked["want"];
  if (py::isinstance<py::str>(given)) {
    const auto text = text_of(given, "want");
    return tasks::read_goal(text, "want=" + text);
  }
  const double frequency = quantity(given, "Hz", "want");
  if (!(frequency >= 1.0))
    base::refuse("want=" + digits_of(frequency),
                 "a number is a lowest frequency in Hz, as a text without a unit is; below 1 give "
                 "the unit: \"2 %\" is a largest drop, \"0.5 Hz\" a frequency");
  goal.omega = base::two_pi * frequency;
  return goal;
}

tasks::DiagnoseOptions diagnose_options(const Machine& machine, const Options& asked) {
  // one after the other: where a later member of nested braces throws, GCC 12 destroys twice
  tasks::DiagnoseOptions options;
  options.measured.files = asked.get<Names>("measured");
  options.measured.observed = observed_system(asked.get<std::string>("against", "auto"));
  options.goal = goal_of(asked);
  auto& rules = options.rules;
  const auto error = [&](const char* name, double& value, double lowest, double highest) {
    const auto given = asked.amount(name, "1");
    if (!given) return;
    if (!(*given >= lowest && *given <= highest))
      base::refuse(name, "out of range: is a share (0.002 or \"0.2 %\")");
    value = *given;
  };
  error("model_error", rules.frequency_error, 1e-5, 0.2);
  error("common_share", rules.common_share, 0.0, 0.95);
  error("shape_error", rules.shape_error, 1e-3, 0.5);
  error("response_error", rules.response_error, 1e-3, 1.0);
  rules.responses = !asked.get("modes_only", false);
  rules.damping = asked.get("damping", false);
  rules.threads = asked.get("threads", 0);
  if (asked.has("poses")) {
    const auto& given = asked["poses"];
    if (py::isinstance<py::str>(given) && text_of(given, "poses") == "workspace")
      options.poses = diagnosis::workspace_poses(machine->file.machine);
    else
      for (const auto& pose : read_as<Names>(given, "poses"))
        options.poses.push_back(tasks::pose_of(machine->file.machine, pose));
  }
  return options;
}

std::shared_ptr<Diagnosed> diagnose(const Machine& machine, const Options& asked,
                                    const py::object& progress) {
  const auto options = diagnose_options(machine, asked);
  auto result = std::make_shared<Diagnosed>();
  result->machine = machine;
  for (const auto& file : options.measured.files)
    result->measured += (result->measured.empty() ? "" : ", ") + file;
  result->found = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::diagnose(*machine, options, watch);
  });
  return result;
}

std::shared_ptr<Report> make_report(const Machine& machine, const Options& asked,
                                    const py::object& progress) {
  tasks::ReportOptions options;
  options.page.title = asked.get<std::string>("title");
  options.page.theme =
      std::array{report::Theme::automatic, report::Theme::light, report::Theme::dark}[choice(
          "theme", asked.get<std::string>("theme", "auto"), {"auto", "light", "dark"})];
  options.page.modes = asked.get<std::vector<int>>("modes");
  options.page.points = asked.get("points", 600);
  if (options.page.points < 2 || options.page.points > 20000)
    throw std::invalid_argument("points: expected 2 to 20000");
  for (const auto& pose : asked.get<Names>("poses"))
    options.poses.push_back(tasks::pose_of(machine->file.machine, pose));
  if (asked.has("commands")) {
    auto& simulation = options.simulation.emplace();
    simulation.commands = asked.get<Names>("commands");
    const int samples = asked.get("samples", 1500);
    if (samples < 2 || samples > 100'000)
      throw std::invalid_argument("samples: expected 2 to 100000");
    simulation.trace_samples = static_cast<std::size_t>(samples);
    auto& integrator = simulation.loop.integrator;
    integrator.relative_tolerance = integrator.absolute_tolerance = 1e-6;  // as simulate has it
    simulation.until = asked.positive("until", "s");
  }
  if (asked.has("identification"))
    options.identification = identify_options(Options(asked.get<py::dict>("identification")));
  if (options.identification) options.identification->cross_check = false;
  if (asked.has("diagnosis"))
    options.diagnosis = diagnose_options(machine, Options(asked.get<py::dict>("diagnosis")));
  options.comparison = asked.get<std::string>("comparison");
  auto result = std::make_shared<Report>();
  result->theme = options.page.theme;
  result->found = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::report_document(*machine, options, watch);
  });
  return result;
}

template <class Get>
py::array per_parameter(const Calibrated& result, Get get) {
  std::vector<double> values;
  for (const auto& one : result.found.result.best().parameters) values.push_back(get(one));
  return array_of(values);
}

}  // namespace

void add_fit(py::module_& module) {
  using Parameter = calibration::FittedParameter;
  py::class_<Calibrated, Result, std::shared_ptr<Calibrated>>(module, "Calibrated")
      .def_property_readonly("parameters",
                             [](const Calibrated& c) {
                               Names names;
                               for (const auto& one : c.found.result.best().parameters) {
                                 std::string joined_paths;
                                 for (const auto& path : one.paths)
                                   joined_paths += (joined_paths.empty() ? "" : ", ") + path;
                                 names.push_back(joined_paths);
                               }
                               return names;
                             })
      .def_property_readonly("units",
                             [](const Calibrated& c) {
                               Names units;
                               for (const auto& one : c.found.result.best().parameters)
                                 units.push_back(one.unit);
                               return units;
                             })
      .def_property_readonly("values",
                             [](const Calibrated& c) {
                               return per_parameter(c, [](const Parameter& p) { return p.value; });
                             })
      .def_property_readonly("deviations",
                             [](const Calibrated& c) {
                               return per_parameter(c,
                                                    [](const Parameter& p) { return p.deviation; });
                             })
      .def_property_readonly("verdicts",
                             [](const Calibrated& c) {
                               Names words;
                               for (const auto& one : c.found.result.best().parameters)
                                 words.emplace_back(report::verdict_word(one.verdict));
                               return words;
                             })
      .def_property_readonly("misfit",
                             [](const Calibrated& c) { return c.found.result.best().misfit; })
      .def_property_readonly("interrupted", [](const Calibrated& c) { return c.found.interrupted; })
      .def_property_readonly("remarks",
                             [](const Calibrated& c) {
                               return report::calibration_remarks(c.found.result, c.found.targets);
                             })
      .def_property_readonly("text",
                             [](const Calibrated& c) {
                               return calibration::calibrated_text(
                                   c.machine->file, c.found.result.best(), c.found.targets);
                             })
      .def_property_readonly("warnings",
                             [](const Calibrated& c) { return texts(c.found.warnings); });
  module.def("calibrate",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return calibrate(machine, Options(options), progress);
             });
  py::class_<Diagnosed, Result, std::shared_ptr<Diagnosed>>(module, "Diagnosed")
      .def_property_readonly("summary",
                             [](const Diagnosed& d) { return report::summary(d.found.file); })
      .def_property_readonly("finding",
                             [](const Diagnosed& d) -> std::optional<std::string> {
                               if (!d.found.file.diagnosis) return {};
                               return report::finding_word(d.found.file.diagnosis->finding);
                             })
      .def_property_readonly(
          "hypotheses",
          [](const Diagnosed& d) {
            Names names;
            if (d.found.file.diagnosis)
              for (const auto& one : d.found.file.diagnosis->hypotheses)
                names.push_back(report::hypothesis_name(*d.found.file.diagnosis, one));
            return names;
          })
      .def_property_readonly("bic",
                             [](const Diagnosed& d) {
                               std::vector<double> values;
                               if (d.found.file.diagnosis)
                                 for (const auto& one : d.found.file.diagnosis->hypotheses)
                                   values.push_back(one.bic);
                               return array_of(values);
                             })
      .def_property_readonly("warnings",
                             [](const Diagnosed& d) { return texts(d.found.warnings); });
  module.def("diagnose",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return diagnose(machine, Options(options), progress);
             });
  py::class_<Report, Result, std::shared_ptr<Report>>(module, "Report")
      .def_property_readonly(
          "html",
          [](const Report& r) {
            return without_gil([&] { return report::html_page(r.found.document, r.theme); });
          })
      .def("write",
           [](const Report& r, const py::object& path) {
             const auto file = path_of(path, "path");
             without_gil([&] {
               base::write_file_whole(file, report::html_page(r.found.document, r.theme));
               return 0;
             });
           })
      .def_property_readonly("warnings", [](const Report& r) { return texts(r.found.warnings); });
  module.def("report",
             [](const Machine& machine, const py::dict& options, const py::object& progress) {
               return make_report(machine, Options(options), progress);
             });
}

}  // namespace hydrapod::python
