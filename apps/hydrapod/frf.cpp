#include <algorithm>
#include <optional>

#include "hydrapod/command.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MeasurementArguments measurement{};
  std::string format{}, output{"-"}, plot{}, coherence_plot{};
};

std::string channel_table(const identification::FrequencyResponses& r,
                          const tasks::ResponseSummary& summary, const TableStyle& style) {
  Table table({"<output", "<unit", "coherence, median", "lowest", "<largest response", "Hz",
               "error there"});
  for (std::size_t o = 0; o < summary.outputs.size(); ++o) {
    const auto& found = summary.outputs[o];
    const bool coherent = !r.multiple_coherence.empty();
    table.add_row({r.outputs[o].name, r.outputs[o].unit,
                   coherent ? fmt::format("{:.4f}", found.median_coherence) : "",
                   coherent ? fmt::format("{:.4f}", found.lowest_coherence) : "",
                   fmt::format("{:.3e} from {}", found.magnitude, r.inputs[found.input].name),
                   fmt::format("{:.3f}", r.frequency[found.line]),
                   r.has_errors() && found.magnitude > 0.0
                       ? fmt::format("{:.1f} %", 100.0 * found.deviation / found.magnitude)
                       : ""});
  }
  return table.text(style);
}

/// [Hz]; lines may have been left out in between.
std::optional<double> line_spacing(const identification::FrequencyResponses& r) {
  if (r.lines() < 2) return {};
  double spacing = r.frequency[1] - r.frequency[0];
  for (std::size_t k = 2; k < r.lines(); ++k)
    spacing = std::min(spacing, r.frequency[k] - r.frequency[k - 1]);
  return spacing;
}

std::string table_text(const Arguments& arguments, const tasks::Measured& measured,
                       const identification::FrequencyResponses& r) {
  const auto style = table_style(arguments.output);
  const auto& m = measured.measurement;
  std::string text = report::measurement_text(r) + "\n";
  if (measured.records)
    text += fmt::format(
        "blocks of {} samples ({}), lines {:.4g} Hz apart\n", m.spectra.options.block_length,
        m.spectra.options.periodic ? "one period each"
        : m.responses.shift > 0.0 && m.reading == nullptr
            ? "exponential window"
            : fmt::format("{} window, {:.0f} % overlap", window_text(m.spectra.options.window),
                          100.0 * m.spectra.options.overlap),
        line_spacing(r).value_or(m.spectra.frequency(1)));
  if (m.from_legs) text += "leg lengths were transformed to platform directions\n";
  if (measured.from_accelerometers)
    text += "accelerometers were transformed to platform directions\n";
  const auto summary = tasks::summary_of(r);
  if (!r.condition.empty())
    text += fmt::format("condition of the input matrix: median {:.3g}, largest {:.3g}\n",
                        summary.median_condition, summary.largest_condition);
  if (m.h1_against_instrument)
    text += fmt::format(
        "Difference of H1 from the instrumental estimate: {:.2g} % (median), outside its 95 % band "
        "at {:.0f} % of the lines\n",
        100.0 * m.h1_against_instrument->median, 100.0 * m.h1_against_instrument->share);
  return text + "\n" + channel_table(r, summary, style);
}

void run(const Arguments& arguments) {
  enum Format : std::size_t { table, json, csv, uff, mat, h5 };
  const auto format = result_format(arguments.format, arguments.output,
                                    {"table", "json", "csv", "uff", "mat", "h5"});
  for (const auto* path : {&arguments.plot, &arguments.coherence_plot})
    if (!path->empty()) report::require_picture(*path);
  const auto options = measure_options(arguments.measurement);
  const auto measured =
      with_progress("reading", [&](const auto& progress) { return tasks::frf(options, progress); });
  print_diagnostics(measured.warnings);
  const auto shared = tasks::shared_responses(measured);
  const auto r = data::brought_to_axis(shared);
  const std::string title = options.files.front();
  const auto text = measured_plot_text(options.files, measured, r);
  draw(arguments.plot, [&](const auto& path) { report::plot_responses(r, nullptr, text, path); });
  draw(arguments.coherence_plot, [&](const auto& path) { report::plot_coherence(r, text, path); });
  if (format == mat || format == uff || format == h5) {
    auto titled = shared;
    titled.title = title;
    if (format == mat) data::write_mat_variables(arguments.output, data::response_arrays(titled));
    if (format == h5) data::write_hdf5_variables(arguments.output, data::response_arrays(titled));
    if (format == uff) data::write_frequency_responses(arguments.output, titled);
    return print_written(arguments.output);
  }
  if (format == csv) return write_output(arguments.output, data::response_table(shared));
  if (format == table)
    return write_result(arguments.output, format, table_text(arguments, measured, r));
  report::Json document{{"kind", "frf"}, {"records", options.files}};
  if (measured.header) document["record"] = report::record_origin_json(*measured.header);
  write_output(arguments.output, json_text(document, report::responses_json(shared), -1));
}

}  // namespace

void add_frf(Command app) {
  Command command = app.add_command(
      "frf", "Frequency responses from records, with coherence and errors",
      {{"frf run.h5", "from the excitations to the outputs, a summary"},
       {"frf run.h5 --plot bode.svg --coherence coherence.svg", "as pictures"},
       {"frf run.h5 --from-excitation", "from the commands: the machine with its controller"},
       {"frf run1.h5 run2.h5 --format json -o frf.json", "several records, for `identify`"},
       {"frf test.csv --inputs force --outputs a1,a2 --block 4096", "channels by name"}});
  auto& arguments = command.calls(&run);
  command.add_options(
      {{"RECORD", arguments.measurement.files, "Records, averaged together", reads_required}});
  add_measurement_options(command, arguments.measurement);
  command.add_options(
      {{"--plot", arguments.plot, "Bode diagram to write, .svg, .png or .pdf", writes},
       {"--coherence", arguments.coherence_plot, "Picture of coherence and condition to write",
        writes},
       {"--format", arguments.format,
        "table (a summary), json, csv, uff, mat or h5 (the whole response); default: by "
        "the ending of -o, else table"},
       {"-o,--output", arguments.output, "File to write; - prints", writes}});
}

}  // namespace hydrapod::cli
