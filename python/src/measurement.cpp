/// Frequency responses, identified modes.

#include "measurement.hpp"

#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/rig/rig.hpp"

namespace hydrapod::python {

tasks::MeasureOptions measure_options(const Options& asked) {
  tasks::MeasureOptions options{.files = asked.get<std::vector<std::string>>("files"),
                                .sample_rate = asked.positive("rate", "Hz"),
                                .accelerometers = asked.get("accelerometers", false),
                                .output_only = asked.get("output_only", false),
                                .machine = asked.get<std::string>("machine_file"),
                                .pose = asked.get<std::string>("pose")};
  for (const auto& record :
       asked.get<std::vector<std::shared_ptr<data::Record>>>("records_in_memory"))
    options.records.push_back(record);
  if (options.files.empty()) base::refuse("files", "expected a record or a file of responses");
  if (asked.has("machine")) options.known = *asked.get<std::shared_ptr<Subject>>("machine");
  if (asked.has("model"))
    options.model = static_cast<dynamics::ModelKind>(
        choice("model", asked.get<std::string>("model"), {"rigid", "guide", "full"}));
  options.exponential_window = asked.positive("exponential_window", "s");
  auto& estimate = options.estimate;
  using Names = std::vector<std::string>;
  estimate.inputs = asked.get<Names>("inputs");
  estimate.outputs = asked.get<Names>("outputs");
  estimate.instruments = asked.get<Names>("instruments");
  if (asked.has("input_from")) {
    const auto role =
        choice("input_from", asked.get<std::string>("input_from"), {"drive", "excitation"});
    estimate.input_role = role == 0 ? data::Role::drive : data::Role::excitation;
  }
  const auto estimator = choice("estimator", asked.get<std::string>("estimator", "auto"),
                                {"auto", "h1", "h2", "hv", "iv"});
  if (estimator > 0) estimate.estimator = static_cast<identification::Estimator>(estimator - 1);
  estimate.window = static_cast<identification::Window>(
      choice("window", asked.get<std::string>("window", "hann"),
             {"hann", "rectangular", "hamming", "blackman-harris", "flat-top", "blackman"}));
  if (asked.has("block")) {
    const int block = asked.get<int>("block");
    if (block < 16 || block % 2 != 0)
      base::refuse("block=" + std::to_string(block),
                   "a block has an even number of samples, at least 16");
    estimate.block_length = block;
  }
  if (const auto overlap = asked.amount("overlap", "1")) {
    if (!(*overlap >= 0.0 && *overlap < 1.0))
      base::refuse("overlap", "must be from 0 to below 1 (or a text such as \"50 %\")");
    estimate.overlap = *overlap;
  }
  estimate.period = asked.at_least_zero("period", "s");
  if (asked.get("whole_record", false)) {
    if (estimate.block_length || asked.has("overlap") || estimate.period || estimator > 0 ||
        estimate.window != identification::Window::hann)
      base::refuse("whole_record",
                   "takes no blocks: leave block, overlap, window, estimator and period out");
    estimate.whole_record = true;
  }
  estimate.settling = asked.at_least_zero("settling", "s").value_or(0.0);
  for (const auto& text : asked.get<Names>("sensors")) {
    const auto sensor = rig::parse_accelerometer(text);
    options.sensors.push_back({sensor.name, sensor.p_P, sensor.e_P});
  }
  if (asked.has("point")) {
    const auto point = asked.get<std::vector<py::object>>("point");
    if (point.size() != 3) throw std::invalid_argument("point: expected three lengths");
    options.p_PQ =
        spatial::Vector3(quantity(point[0], "m", "point"), quantity(point[1], "m", "point"),
                         quantity(point[2], "m", "point"));
  }
  return options;
}

std::optional<observation::Observed> observed_system(const std::string& word) {
  const auto chosen = choice("against", word, {"auto", "mechanics", "plant", "system", "none"});
  if (chosen == 0 || chosen > 3) return {};
  return static_cast<observation::Observed>(chosen - 1);
}

tasks::IdentifyOptions identify_options(const Options& asked) {
  const auto against = asked.get<std::string>("against", "auto");
  tasks::IdentifyOptions options{.measure = measure_options(asked),
                                 .bootstrap = asked.get("bootstrap", 0),
                                 .cross_check = true,
                                 .compare = against != "none",
                                 .against = observed_system(against)};
  auto& modes = options.modes;
  modes.from = asked.at_least_zero("from", "Hz");
  modes.to = asked.at_least_zero("to", "Hz");
  if (modes.from && modes.to && *modes.from >= *modes.to)
    base::refuse("from_", "must be less than to");
  modes.orders.highest = asked.get("order", 0);
  if (asked.has("highest_damping")) {
    modes.highest_damping = quantity(asked["highest_damping"], "1", "highest_damping");
    if (!(modes.highest_damping >= 0.001 && modes.highest_damping <= 0.9))
      base::refuse("highest_damping", "must be from 0.001 to 0.9 (or a text such as \"30 %\")");
  }
  if (options.bootstrap < 0 || options.bootstrap > 10000)
    throw std::invalid_argument("bootstrap: expected 0 to 10000");
  if (options.measure.output_only && options.bootstrap > 0)
    base::refuse("bootstrap", "resamples inputs and outputs; with output_only there is no input");
  return options;
}

namespace {

struct Frf : Result {
  std::vector<std::string> files{};
  tasks::Measured measured{};
  identification::FrequencyResponses shared{};
  [[nodiscard]] Json document() const override {
    Json json{{"kind", "frf"}, {"records", files}};
    if (measured.header) json["record"] = report::record_origin_json(*measured.header);
    return joined(json, report::responses_json(shared));
  }
};

struct Identified : Result {
  std::vector<std::string> files{};
  tasks::Identified found{};
  [[nodiscard]] Json document() const override {
    Json json = report::identification_json(found.modes);
    if (found.measured.header) json["record"] = report::record_origin_json(*found.measured.header);
    report::add_cross_checks(found.cross_checks, json);
    if (found.bootstrap) report::add_bootstrap(*found.bootstrap, json);
    if (found.compared) json["comparison"] = report::comparison_json(*found.compared, found.modes);
    return joined({{"kind", "identified_modes"}, {"records", files}}, json);
  }
};

/// Lines × rows × columns.
template <class Matrix>
py::array per_line(const data::PerLine<Matrix>& pages) {
  using Scalar = typename Matrix::Scalar;
  if (pages.empty()) return py::array_t<Scalar>(std::vector<py::ssize_t>{0, 0, 0});
  const auto rows = pages.front().rows(), columns = pages.front().cols();
  py::array_t<Scalar> result({static_cast<py::ssize_t>(pages.size()),
                              static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
  Scalar* out = result.mutable_data();
  for (const auto& page : pages)
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index j = 0; j < columns; ++j) *out++ = page(i, j);
  return read_only(result);
}

/// Lines × outputs × inputs; without lines where no errors are known.
py::array deviations(const identification::FrequencyResponses& r) {
  const auto outputs = static_cast<Eigen::Index>(r.outputs.size());
  const auto inputs = static_cast<Eigen::Index>(r.inputs.size());
  std::vector<double> all;
  if (!r.has_errors()) return array_of(all, std::vector<py::ssize_t>{0, outputs, inputs});
  for (std::size_t k = 0; k < r.lines(); ++k)
    for (Eigen::Index o = 0; o < outputs; ++o)
      for (Eigen::Index i = 0; i < inputs; ++i) all.push_back(std::sqrt(r.variance(k, o, i)));
  return array_of(all, {static_cast<py::ssize_t>(r.lines()), outputs, inputs});
}

py::array copied(const Eigen::MatrixXd& matrix) {
  py::array_t<double> array(std::vector<py::ssize_t>{matrix.rows(), matrix.cols()});
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) array.mutable_at(i, j) = matrix(i, j);
  return read_only(array);
}

std::vector<std::string> names(const std::vector<data::Channel>& channels) {
  std::vector<std::string> list;
  for (const auto& channel : channels) list.push_back(channel.name);
  return list;
}

template <class Get>
py::array per_mode(const Identified& result, Get get) {
  return array_of_each(result.found.modes.modes, get);
}

/// Outputs × modes.
py::array shapes(const Identified& result) {
  const auto& modes = result.found.modes.modes;
  const auto rows = modes.empty() ? py::ssize_t{0} : py::ssize_t{modes.front().displacement.size()};
  py::array_t<std::complex<double>> all({rows, static_cast<py::ssize_t>(modes.size())});
  for (std::size_t k = 0; k < modes.size(); ++k)
    for (py::ssize_t i = 0; i < rows; ++i)
      all.mutable_at(i, static_cast<py::ssize_t>(k)) = modes[k].displacement[i];
  return read_only(all);
}

/// Responses of the identified modes at the measured lines; NaN where there is no mode.
py::array modal_response(const Identified& result) {
  const auto& r = result.found.modes.responses;
  const auto& model = result.found.modes.model;
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto outputs = static_cast<Eigen::Index>(r.outputs.size());
  const auto inputs = static_cast<Eigen::Index>(r.inputs.size());
  data::PerLine<Eigen::MatrixXcd> pages;
  for (const double frequency : r.frequency)
    pages.push_back(model.residuals.empty() || model.modes.empty()
                        ? Eigen::MatrixXcd::Constant(outputs, inputs, {unknown, unknown})
                        : identification::synthesised(model, frequency, r.shift));
  return per_line(pages);
}

std::shared_ptr<Frf> frf(const Options& asked, const py::object& progress) {
  const auto options = measure_options(asked);
  auto result = std::make_shared<Frf>();
  result->files = options.files;
  result->measured = at_work(progress, [&](const numerics::Progress& watch) {
    auto measured = tasks::frf(options, watch);
    result->shared = tasks::shared_responses(measured);
    return measured;
  });
  return result;
}

std::shared_ptr<Identified> identify(const Options& asked, const py::object& progress) {
  const auto options = identify_options(asked);
  auto result = std::make_shared<Identified>();
  result->files = options.measure.files;
  result->found = at_work(
      progress, [&](const numerics::Progress& watch) { return tasks::identify(options, watch); });
  return result;
}

/// Which of `formats` the ending of a path is.
std::size_t format_of(const std::string& path, const std::vector<std::string_view>& formats) {
  auto ending = std::filesystem::path(path).extension().string();
  if (ending == ".unv" || ending == ".uf") ending = ".uff";
  if (ending == ".hdf5") ending = ".h5";
  return choice("path", ending.empty() ? ending : ending.substr(1), formats);
}

/// As `hydrapod frf -o PATH` does.
void write_responses(const Frf& result, const py::object& file) {
  const auto path = path_of(file, "path");
  const auto format = format_of(path, {"json", "csv", "uff", "mat", "h5"});
  without_gil([&] {
    auto titled = result.shared;
    titled.title = result.files.front();
    if (format == 0) base::write_file_whole(path, result.document().dump());
    if (format == 1) base::write_file_whole(path, data::response_table(result.shared));
    if (format == 2) data::write_frequency_responses(path, titled);
    if (format == 3) data::write_mat_variables(path, data::response_arrays(titled));
    if (format == 4) data::write_hdf5_variables(path, data::response_arrays(titled));
    return 0;
  });
}

/// As `hydrapod identify -o PATH` does.
void write_modes(const Identified& result, const py::object& file) {
  const auto path = path_of(file, "path");
  const auto format = format_of(path, {"json", "csv", "uff", "mat"});
  const auto& [measured, modes] = std::tie(result.found.measured, result.found.modes);
  without_gil([&] {
    if (format == 0) base::write_file_whole(path, result.document().dump());
    if (format == 1)
      base::write_file_whole(path, report::identified_modes_csv(modes, tasks::observed_in(measured),
                                                                measured.experiment()));
    if (format == 2)
      report::write_modes_uff(path, modes, result.files.front(),
                              measured.header ? measured.header->date : "");
    if (format == 3) report::write_modes_mat(path, modes);
    return 0;
  });
}

}  // namespace

void add_measurement(py::module_& module) {
  py::class_<Frf, Result, std::shared_ptr<Frf>>(module, "Frf")
      .def_property_readonly("frequency_hz",
                             [](const py::object& self) {
                               return view_of(self.cast<const Frf&>().shared.frequency, self);
                             })
      .def_property_readonly(
          "H", [](const Frf& f) { return per_line(data::brought_to_axis(f.shared).H); })
      .def_property_readonly("coherence", [](const Frf& f) { return per_line(f.shared.coherence); })
      .def_property_readonly("deviation", [](const Frf& f) { return deviations(f.shared); })
      .def_property_readonly("inputs", [](const Frf& f) { return names(f.shared.inputs); })
      .def_property_readonly("outputs", [](const Frf& f) { return names(f.shared.outputs); })
      .def_property_readonly("warnings", [](const Frf& f) { return texts(f.measured.warnings); })
      .def("write", &write_responses, py::arg("path"));
  module.def("frf", [](const py::dict& options, const py::object& progress) {
    return frf(Options(options), progress);
  });
  using Mode = identification::IdentifiedMode;
  py::class_<Identified, Result, std::shared_ptr<Identified>>(module, "Identified")
      .def_property_readonly("frequency_hz",
                             [](const Identified& r) {
                               return per_mode(
                                   r, [](const Mode& m) { return m.fit.omega() / base::two_pi; });
                             })
      .def_property_readonly(
          "frequency_deviation_hz",
          [](const Identified& r) {
            return per_mode(r, [](const Mode& m) { return m.fit.omega_deviation / base::two_pi; });
          })
      .def_property_readonly("damping_ratio",
                             [](const Identified& r) {
                               return per_mode(r,
                                               [](const Mode& m) { return m.fit.damping_ratio(); });
                             })
      .def_property_readonly("damping_deviation",
                             [](const Identified& r) {
                               return per_mode(
                                   r, [](const Mode& m) { return m.fit.damping_deviation; });
                             })
      .def_property_readonly("quality",
                             [](const Identified& r) {
                               return per_mode(r, [](const Mode& m) { return m.quality(); });
                             })
      .def_property_readonly("shapes", &shapes)
      .def_property_readonly(
          "outputs", [](const Identified& r) { return names(r.found.modes.responses.outputs); })
      .def_property_readonly(
          "motion", [](const Identified& r) { return report::motion_words(r.found.modes); })
      .def_property_readonly(
          "inputs", [](const Identified& r) { return names(r.found.modes.responses.inputs); })
      .def_property_readonly(
          "line_frequency_hz",
          [](const py::object& self) {
            return view_of(self.cast<const Identified&>().found.modes.responses.frequency, self);
          })
      .def_property_readonly(
          "H", [](const Identified& r) { return per_line(r.found.modes.responses.H); })
      .def_property_readonly(
          "deviation", [](const Identified& r) { return deviations(r.found.modes.responses); })
      .def_property_readonly("radius_95",
                             [](const Identified& r) {
                               return identification::confidence_radius(
                                   0.95, r.found.modes.responses.degrees);
                             })
      .def_property_readonly("H_modes", &modal_response)
      .def_property_readonly(
          "mode_indicator",
          [](const Identified& r) {
            return copied(identification::mode_indicator(r.found.modes.responses));
          })
      .def_property_readonly("warnings",
                             [](const Identified& r) { return texts(r.found.warnings); })
      .def("write", &write_modes, py::arg("path"));
  module.def("identify", [](const py::dict& options, const py::object& progress) {
    return identify(Options(options), progress);
  });
}

}  // namespace hydrapod::python
