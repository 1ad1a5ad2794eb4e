#include "hydrapod/command.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/reports.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments : IdentificationArguments {
  bool output_only{};
  int bootstrap{};  ///< draws
  std::string format{}, output{"-"}, plot{}, stabilisation{}, mac{}, cross_mac{};
};

enum Format : std::size_t { table, json, csv, uff, mat };

void draw_all(const Arguments& a, const tasks::Identified& found) {
  const auto& result = found.modes;
  const report::PlotText text{a.measurement.files[0],
                              report::measurement_text(found.measured.responses())};
  draw(a.plot, [&](const auto& path) {
    report::plot_responses(result.responses, result.modes.empty() ? nullptr : &result.model, text,
                           path);
  });
  draw(a.stabilisation, [&](const auto& path) { report::plot_stabilisation(result, text, path); });
  draw(a.mac, [&](const auto& path) {
    if (result.modes.empty()) base::refuse("--mac " + path, "there is no mode to compare");
    report::plot_mac(result, text, path);
  });
  draw(a.cross_mac, [&](const auto& path) {
    report::plot_cross_mac(*found.compared, result,
                           {text.title, report::comparison_heading(*found.compared)}, path);
  });
}

void run_output_only(const Arguments& a, size_t format) {
  for (const auto* path : {&a.plot, &a.stabilisation, &a.mac, &a.cross_mac})
    if (!path->empty()) base::refuse("--output-only", "has no responses to plot");
  if (format > Format::csv)
    base::refuse("--output-only", "its modes are written as table, json or csv");
  const auto options = identify_options(a);
  const auto measured = with_progress("reading", [&](const auto& progress) {
    return tasks::measure_outputs(options.measure, progress);
  });
  print_diagnostics(measured.warnings);
  const auto& m = measured.measurement;
  const auto modes = tasks::identify_outputs(measured, options.modes.to);
  if (format == Format::table)
    return base::write_file_whole(
        a.output, output_only_text(modes, m.outputs.size(), m.spectra.options.block_length,
                                   table_style(a.output)));
  if (format == Format::csv)
    return base::write_file_whole(a.output, report::output_only_csv(modes));
  base::write_file_whole(
      a.output, json_text({{"kind", "output_only_modes"}, {"records", a.measurement.files}},
                          {{"modes", report::output_only_json(modes)}}));
}

void write_result(const Arguments& a, size_t format, const tasks::Identified& found) {
  const auto& result = found.modes;
  const std::string title = a.measurement.files[0];
  if (format == Format::uff)
    return report::write_modes_uff(a.output, result, title,
                                   found.measured.header ? found.measured.header->date : "");
  if (format == Format::mat) return report::write_modes_mat(a.output, result);
  std::string text;
  if (format == Format::json) {
    report::Json json{{"kind", "identified_modes"}, {"records", a.measurement.files}};
    if (found.measured.header) json["record"] = report::record_origin_json(*found.measured.header);
    json.update(report::identification_json(result));
    report::add_cross_checks(found.cross_checks, json);
    if (found.bootstrap) report::add_bootstrap(*found.bootstrap, json);
    if (found.compared) json["comparison"] = report::comparison_json(*found.compared, result);
    text = json.dump(1) + "\n";
  } else if (format == Format::csv) {
    text = report::identified_modes_csv(result, tasks::observed_in(found.measured));
  } else {
    const auto style = table_style(a.output);
    text = modes_text(found, style);
    if (found.compared) text += comparison_text(*found.compared, result, style);
  }
  base::write_file_whole(a.output, text);
}

void run(const Arguments& a) {
  const size_t format = result_format(a.format, a.output, {"table", "json", "csv", "uff", "mat"});
  auto options = identify_options(a);
  if (a.output_only && a.bootstrap > 0)
    base::refuse("--bootstrap", "output-only modes have no intervals to check");
  if (a.output_only) return run_output_only(a, format);
  for (const auto* path : {&a.plot, &a.stabilisation, &a.mac, &a.cross_mac})
    if (!path->empty()) report::require_picture(*path);
  options.bootstrap = a.bootstrap;
  options.cross_check = format != Format::uff && format != Format::mat;
  const auto found = with_progress(
      "identifying", [&](const auto& progress) { return tasks::identify(options, progress); });
  print_diagnostics(found.warnings);
  if (!found.compared && !a.cross_mac.empty())
    base::refuse("--cross-mac " + a.cross_mac,
                 "there is nothing to compare with: add --machine FILE");
  draw_all(a, found);
  write_result(a, format, found);
}

}  // namespace

void add_identify(Command app) {
  Command command = add_command(
      app, "identify", "Modes from records or from frequency responses, with their uncertainty",
      {{"identify run.h5", "modes, damping ratios and shapes with default settings"},
       {"identify run.h5 --plot fit.svg --stabilisation chart.svg", "with pictures"},
       {"identify frf.json --from 2 --to 30", "from responses of `hydrapod frf`"},
       {"identify run.h5 --machine machine.toml", "compared with the modes of a machine file"},
       {"identify run.h5 -o modes.json", "for other programs; also .csv, .uff and .mat"}});
  auto& a = command.calls(&run);
  command.add_options({{"RECORD|FRF", a.measurement.files,
                        "Records, averaged together, or JSON of `hydrapod frf`", required}});
  add_identification_options(command, a);
  command.add_options(
      {{"--output-only", a.output_only,
        "Modes from the outputs alone, for records without measured excitation"},
       {"--bootstrap", a.bootstrap,
        "Number of bootstrap resamples to check the intervals, for instance 50; 0: none",
        OptionRule{.shows_zero = true, .range = std::pair(0, 10000)}},
       {"--plot", a.plot, "Bode diagram of measurement and fit to write, .svg, .png or .pdf"},
       {"--stabilisation", a.stabilisation, "Stabilisation chart with mode indicator to write"},
       {"--mac", a.mac, "Picture of the MAC matrix to write"},
       {"--cross-mac", a.cross_mac, "Picture of the MAC of measured and model modes to write"},
       {"--format", a.format,
        "table, json, csv, uff (dataset 55) or mat; default: by the ending of -o, "
        "else table"},
       {"-o,--output", a.output, "File to write; - prints"}});
}

}  // namespace hydrapod::cli
