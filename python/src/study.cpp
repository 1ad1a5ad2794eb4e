/// Studies: Monte Carlo, sweeps, maps. Their rows as one array.

#include "hydrapod/tasks/study.hpp"

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/report/model_results.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;

struct Study : Result {
  std::string kind{};
  tasks::StudyJob job{};
  tasks::StudyDone done{};
  std::pair<int, int> shard{1, 1};  ///< part i of n
  std::vector<double> rows{};
  [[nodiscard]] std::size_t inputs() const { return job.problem.inputs.size(); }
  [[nodiscard]] std::size_t width() const { return inputs() + job.problem.outputs.size(); }
  [[nodiscard]] std::size_t count() const { return rows.size() / width(); }
  [[nodiscard]] const study::Summary& summary() const {
    if (!done.summary)
      throw base::ComputationError(
          "a part of a study has no summary; join the parts when all of them are there");
    return *done.summary;
  }
  [[nodiscard]] Json document() const override {
    return joined(head_of_model(kind.c_str(), job.machine),
                  report::study_json(job.problem, job.plan, job.requirements, summary()));
  }
};

/// A dict of path: text.
std::vector<tasks::Varied> varied(const Options& asked, const char* name) {
  std::vector<tasks::Varied> list;
  for (const auto& [path, text] : asked.get<py::dict>(name)) {
    const auto key = text_of(path, name);
    list.push_back({key, text_of(text, key), std::string(name) + " " + key});
  }
  return list;
}

std::vector<tasks::Asked> texts(const Options& asked, const char* name) {
  std::vector<tasks::Asked> list;
  for (const auto& text : asked.get<Names>(name))
    list.push_back({text, fmt::format("{} {}", name, base::printable(text))});
  return list;
}

tasks::StudyOptions study_options(const std::string& kind, const Options& asked) {
  tasks::StudyOptions options{.vary = varied(asked, "vary"),
                              .over = varied(asked, "over"),
                              .worst_over = varied(asked, "worst_over"),
                              .poses = kind == "map",
                              .correlate = texts(asked, "correlate"),
                              .want = asked.get<Names>("want"),
                              .modes = asked.get("modes", 6),
                              .only = texts(asked, "only"),
                              .also = texts(asked, "also"),
                              .commands = asked.get<Names>("commands"),
                              .until = asked.positive("until", "s")};
  if (asked.get("buckling", false)) options.also.push_back({"buckling", "buckling"});
  if (options.vary.empty() && options.over.empty())
    base::refuse(kind == "montecarlo" ? "vary" : "over",
                 "expected at least one number that varies");
  if (options.modes < 1 || options.modes > dynamics::max_dof)
    throw std::invalid_argument(
        fmt::format("modes: expected 1 to {}, got {}", dynamics::max_dof, options.modes));
  auto& plan = options.plan;
  const bool random = kind == "montecarlo";
  plan.design = static_cast<study::Design>(
      choice("design", asked.get<std::string>("design", random ? "random" : "grid"),
             {"random", "latin", "sobol", "grid"}));
  plan.samples = asked.get<std::uint64_t>("samples", 10000);
  if (plan.samples < 2) throw std::invalid_argument("samples: expected at least 2");
  plan.seed = asked.get<std::uint64_t>("seed", 1);
  plan.indices = asked.get("indices", false);
  return options;
}

std::shared_ptr<Study> run_study(const Machine& machine, const std::string& kind,
                                 const Options& asked, const py::object& progress) {
  const auto options = study_options(kind, asked);
  const int refine = asked.get("refine", 0);
  if (refine < 0 || refine > 12)
    throw std::invalid_argument("refine: expected 0 to 12, got " + std::to_string(refine));
  if (refine > 0 && options.plan.design != study::Design::grid)
    base::refuse("refine", "halves intervals of a grid; leave design out");
  const bool needless_samples =
      kind == "sweep" && asked.has("samples") && options.plan.design == study::Design::grid;
  auto result = std::make_shared<Study>();
  result->kind = kind;
  tasks::StudyRunOptions running{.output = asked.get<std::string>("results"),
                                 .resume = asked.get("resume", false),
                                 .threads = asked.get("threads", 0),
                                 .join = asked.get("join", false)};
  if (asked.has("shard")) {
    const auto pair = asked.get<std::pair<int, int>>("shard");
    if (pair.first < 1 || pair.second < pair.first || pair.second > 100000)
      throw std::invalid_argument("shard: expected (i, n) with 1 ≤ i ≤ n");
    std::tie(running.shard, running.shards) = pair;
    if (!running.join) result->shard = pair;
  }
  running.take = [&rows = result->rows](std::span<const double> some) {
    rows.insert(rows.end(), some.begin(), some.end());
  };
  at_work(progress, [&](const numerics::Progress& watch) {
    result->job = tasks::prepare_study(*machine, options);
    if (needless_samples)
      base::refuse(fmt::format("samples={}", options.plan.samples),
                   fmt::format("a grid has one row per point, here {}; leave it out, or choose "
                               "design=\"latin\" or \"sobol\"",
                               result->job.rows));
    if (refine > 0) tasks::refine_grid(result->job, refine, watch, {.threads = running.threads});
    result->done = tasks::run_study(result->job, running, watch);
    return 0;
  });
  if (result->done.run.done == 0 && !result->done.complete)
    throw base::ComputationError("interrupted before the first row");
  return result;
}

std::vector<study::Column> columns(const Study& study) {
  std::vector<study::Column> all;
  for (std::size_t k = 0; k < study.inputs(); ++k)
    all.push_back({study.job.input_column(k), study.job.problem.inputs[k].unit, "varied"});
  all.insert(all.end(), study.job.problem.outputs.begin(), study.job.problem.outputs.end());
  return all;
}

Names texts_of(const Study& study, std::string study::Column::*member) {
  Names list;
  for (const auto& column : columns(study)) list.push_back(column.*member);
  return list;
}

std::size_t row_of(const Study& study, std::int64_t row) {
  const auto count = static_cast<std::int64_t>(study.count());
  if (row < -count || row >= count)
    throw py::index_error("row " + std::to_string(row) + " of " + std::to_string(count));
  return static_cast<std::size_t>(row < 0 ? row + count : row);
}

/// The machine of a row: its file and, of a map, its pose.
std::shared_ptr<Subject> machine_of(const Study& study, std::int64_t row) {
  const auto at = row_of(study, row);
  const std::span values(study.rows.data() + at * study.width(), study.inputs());
  const auto& job = study.job;
  const auto& inputs = job.problem.inputs;
  if (!job.poses) {
    std::vector<std::string> paths;
    for (const auto& input : inputs) paths.push_back(input.name);
    return changed_machine(job.machine, paths, values, job.machine.pose.name);
  }
  if (job.machine.pose.name != "neutral")
    base::refuse("machine(row)", "a map from a pose other than neutral has no text for its poses");
  std::string pose;
  for (std::size_t k = 0; k < values.size(); ++k)
    pose += (k > 0 ? ", " : "") + inputs[k].name + "=" + digits_of(values[k]);
  return changed_machine(job.machine, {}, {}, pose);
}

py::array of_requirements(const Study& study, double study::RequirementSummary::*member) {
  std::vector<double> values;
  for (const auto& one : study.summary().requirements) values.push_back(one.*member);
  return array_of(values);
}

/// requirements × 2
py::array intervals(const Study& study) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values;
  for (const auto& one : study.summary().requirements) {
    values.push_back(one.interval ? one.interval->low : unknown);
    values.push_back(one.interval ? one.interval->high : unknown);
  }
  return array_of(values, {static_cast<py::ssize_t>(values.size() / 2), 2});
}

/// Text of the results file, why it says FAIL, outputs with gradients by differences, eval_id.
py::tuple evaluate(const std::shared_ptr<Subject>& machine, const std::string& parameters,
                   const Names& variables, const Names& outputs) {
  const auto done = without_gil([&] {
    return tasks::evaluate(*machine,
                           {.parameters = parameters, .variables = variables, .outputs = outputs});
  });
  return py::make_tuple(done.text, done.failure, done.by_differences, done.id);
}

}  // namespace

void add_study(py::module_& module) {
  py::class_<Study, Result, std::shared_ptr<Study>>(module, "Study", py::dynamic_attr())
      .def_property_readonly("values",
                             [](const py::object& self) {
                               const auto& study = self.cast<const Study&>();
                               constexpr auto size = static_cast<py::ssize_t>(sizeof(double));
                               const auto width = static_cast<py::ssize_t>(study.width());
                               return view<double>(study.rows.data(),
                                                   {static_cast<py::ssize_t>(study.count()), width},
                                                   {size * width, size}, self);
                             })
      .def_property_readonly("kind", [](const Study& s) { return s.kind; })
      .def_property_readonly("names",
                             [](const Study& s) { return texts_of(s, &study::Column::name); })
      .def_property_readonly("units",
                             [](const Study& s) { return texts_of(s, &study::Column::unit); })
      .def_property_readonly("meanings",
                             [](const Study& s) { return texts_of(s, &study::Column::meaning); })
      .def_property_readonly("input_count", [](const Study& s) { return s.inputs(); })
      .def_property_readonly("shape",
                             [](const Study& s) {
                               return s.job.plan.design == study::Design::grid
                                          ? s.job.plan.counts
                                          : std::vector{static_cast<int>(s.count())};
                             })
      .def_property_readonly("complete", [](const Study& s) { return s.done.complete; })
      .def_property_readonly(
          "part",
          [](const Study& s) { return s.shard.second > 1 ? std::optional(s.shard) : std::nullopt; })
      .def_property_readonly("rows_file", [](const Study& s) { return s.done.rows_file; })
      .def_property_readonly("seconds", [](const Study& s) { return s.done.run.seconds; })
      .def_property_readonly("requirements",
                             [](const Study& s) {
                               Names list;
                               for (const auto& one : s.job.requirements) list.push_back(one.text);
                               return list;
                             })
      .def_property_readonly("probability_of_missing",
                             [](const Study& s) {
                               return of_requirements(s, &study::RequirementSummary::probability);
                             })
      .def_property_readonly("probability_interval", &intervals)
      .def_property_readonly(
          "worst_rows",
          [](const Study& s) {
            std::vector<std::int64_t> list;
            for (const auto& one : s.summary().requirements)
              list.push_back(one.worst ? static_cast<std::int64_t>(*one.worst) : -1);
            return array_of(list);
          })
      .def("core_machine", &machine_of)
      .def("machine_text", [](const Study& s, std::int64_t row, const std::string& label) {
        if (s.job.poses) base::refuse("machine_text", "rows of a map are poses, not machine files");
        const auto at = row_of(s, row);
        return study::machine_text(s.job.machine.file, s.job.problem.inputs,
                                   std::span(s.rows.data() + at * s.width(), s.inputs()), label);
      });
  module.def("evaluate", &evaluate);
  module.def("study", [](const Machine& machine, const std::string& kind, const py::dict& options,
                         const py::object& progress) {
    return run_study(machine, kind, Options(options), progress);
  });
}

}  // namespace hydrapod::python
