#include "hydrapod/command.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
constexpr double band = numerics::normal_half_width;

std::string signed_percent(double share) {
  return fmt::format("{}{:.2f} %", share < 0.0 ? "−" : "+", std::abs(100.0 * share));
}

std::string percent(double ratio) { return fmt::format("{:.3f} %", 100.0 * ratio); }

std::string cross_check_text(const std::optional<identification::CrossCheck>& cross_check) {
  if (!cross_check) return "none";
  return fmt::format("{:.4g} Hz {:.2g} %{}", cross_check->omega / two_pi,
                     100.0 * cross_check->damping_ratio, cross_check->agrees ? "" : ", differs");
}

std::string left_text(const report::ComparedModes& compared,
                      const identification::Identification& result) {
  std::string text;
  for (const int r : compared.result.measured_left) {
    const auto& fit = result.modes[static_cast<std::size_t>(r)].fit;
    text += fmt::format("Not in the model: mode {}, {} Hz, {} of critical.\n", r + 1,
                        hertz(fit.omega(), 4), percent(fit.damping_ratio()));
  }
  std::string quiet;  // modes that nobody expects to measure share a line
  for (const auto& left : compared.result.model_left) {
    const auto& mode = compared.result.model[static_cast<std::size_t>(left.model)];
    if (left.reason == observation::Unpaired::not_felt) {
      quiet += (quiet.empty() ? "" : ", ") + hertz(mode.omega(), 4);
      continue;
    }
    text += fmt::format("Not measured: {} Hz, {} of critical, {}: {}.\n", hertz(mode.omega(), 4),
                        percent(mode.damping_ratio()),
                        compared.labels[static_cast<std::size_t>(left.model)],
                        report::words(left.reason));
  }
  if (!quiet.empty()) text += fmt::format("Not measured, local seal modes: {} Hz.\n", quiet);
  return text;
}

std::string harmonic_text(const data::Harmonic& harmonic,
                          const std::vector<data::Channel>& outputs) {
  Eigen::Index largest = 0;
  const double amplitude = harmonic.amplitude.maxCoeff(&largest);
  const auto& channel = outputs[static_cast<std::size_t>(largest)];
  return fmt::format("Harmonic, not counted as a mode: {:.3f} Hz{}, amplitude {:.2g} {} in {}.\n",
                     harmonic.frequency,
                     harmonic.wander > 0.0 ? fmt::format(" ± {:.2g} Hz", harmonic.wander) : "",
                     amplitude, channel.unit, channel.name);
}

/// Does a pole lie further outside the band than the band is wide? It then stands for what goes on
/// there, as residual terms do.
bool stands_for_what_is_outside(const identification::Identification& result,
                                const identification::FittedMode& pole) {
  const double frequency = pole.omega() / two_pi, width = result.to - result.from;
  return frequency > result.to + width || frequency < result.from - width;
}

std::string untested_text(const identification::Identification& result) {
  if (!result.needed_duration) return {};
  return fmt::format(
      "Not tested: whether a sensor or a mode changed within the record. The test of sensors needs "
      "a record of {:.0f} s with blocks of this length.\n",
      std::ceil(*result.needed_duration));
}

/// What is to be known of the table of modes.
std::string notes_text(const tasks::Identified& checks) {
  const auto& result = checks.modes;
  std::string text;
  if (!result.modes.empty() && !report::have_one_unit(result.responses.outputs))
    text +=
        "Motion: each output in proportion to the size of its own responses, because the outputs "
        "have no unit in common. The shapes themselves are in the files of -o.\n";
  if (checks.bootstrap)
    text += fmt::format(
        "Bootstrap: {} resamples of {} groups of blocks, relative uncertainty {:.0f} %.\n",
        checks.bootstrap->resamples, checks.bootstrap->groups,
        100.0 / std::sqrt(2.0 * (checks.bootstrap->groups - 1.0)));
  text += untested_text(result);
  for (const auto& h : result.responses.harmonics)
    text += harmonic_text(h, result.responses.outputs);
  for (const auto& m : result.heavily_damped)
    if (!stands_for_what_is_outside(result, m))
      text += fmt::format(
          "Heavily damped pole, not counted as a mode: {:.3f} Hz, damping ratio {:.0f} %.\n",
          m.omega() / two_pi, 100.0 * m.damping_ratio());
  return text;
}

std::string modes_text(const tasks::Identified& checks, const TableStyle& style) {
  const auto& result = checks.modes;
  const auto& measured = checks.measured;
  std::string text =
      fmt::format("{}\nband {:.4g} Hz to {:.4g} Hz, model orders up to {}, {}\n",
                  report::measurement_text(measured.responses()), result.from, result.to,
                  result.chart.empty() ? 0 : result.chart.back().order,
                  report::frame_text(measured.measurement.from_legs, measured.from_accelerometers));
  if (result.modes.empty()) return text + "\nno mode in this band\n";
  std::vector<Column> columns{"mode",    "Hz",  "±",   "damping", "±",
                              "<motion", "MPC", "MPD", "quality"};
  if (checks.bootstrap) {
    columns.push_back("bootstrap ± Hz");
    columns.push_back("± damping");
  }
  if (!checks.cross_checks.empty()) columns.push_back("<ERA");
  Table table(columns);
  const auto motions = report::motion_words(result);
  for (std::size_t r = 0; r < result.modes.size(); ++r) {
    const auto& m = result.modes[r];
    std::vector<std::string> row{fmt::format("{}", r + 1),
                                 hertz(m.fit.omega(), 4),
                                 fmt::format("{:.2g}", band * m.fit.omega_deviation / two_pi),
                                 percent(m.fit.damping_ratio()),
                                 fmt::format("{:.2g} %", 100.0 * band * m.fit.damping_deviation),
                                 motions[r],
                                 fmt::format("{:.3f}", m.mpc),
                                 fmt::format("{:.1f}°", m.mpd * 180.0 / std::numbers::pi),
                                 fmt::format("{:.2f}", m.quality())};
    if (checks.bootstrap) {
      const auto k = static_cast<Eigen::Index>(r);
      row.push_back(fmt::format("{:.2g}", band * checks.bootstrap->omega_deviation[k] / two_pi));
      row.push_back(fmt::format("{:.2g} %", 100.0 * band * checks.bootstrap->damping_deviation[k]));
    }
    if (r < checks.cross_checks.size()) row.push_back(cross_check_text(checks.cross_checks[r]));
    table.add_row(row);
  }
  text += "\n" + table.text(style);
  text += fmt::format(
      "\nHz: |λ| of damped modes. ± is half the 95 % interval. Error of the synthesised responses: "
      "{:.2g} %",
      100.0 * result.model.error);
  if (result.model.misfit > 0.0)
    text += fmt::format(", {:.2f} times their noise (mean square)", result.model.misfit);
  text += ".\n";
  if (style.brief) return text;
  return text + notes_text(checks);
}

/// "5 of 6 modes are in the model; largest difference of a frequency −1.20 % (mode 3), lowest MAC
/// 0.971 (mode 2)."
std::string comparison_verdict(const observation::ModeComparison& c, std::size_t modes) {
  std::string text = fmt::format("{} of {} modes are in the model", c.pairs.size(), modes);
  if (c.pairs.empty()) return text + ".\n";
  const auto& apart = *std::ranges::max_element(
      c.pairs, {}, [](const auto& pair) { return std::abs(pair.frequency_difference); });
  text += fmt::format("; largest difference of a frequency {} (mode {})",
                      signed_percent(apart.frequency_difference), apart.measured + 1);
  const auto& unlike = *std::ranges::min_element(
      c.pairs, {}, [](const auto& pair) { return pair.mac.value_or(2.0); });
  if (unlike.mac)
    text += fmt::format(", lowest MAC {:.3f} (mode {})", *unlike.mac, unlike.measured + 1);
  return text + ".\n";
}

std::string comparison_text(const report::ComparedModes& compared,
                            const identification::Identification& result, const TableStyle& style) {
  std::string text = fmt::format("\nCompared with {}\n", report::comparison_heading(compared));
  const auto& c = compared.result;
  const std::string verdict = "\n" + comparison_verdict(c, result.modes.size());
  if (style.brief) return text + verdict.substr(1);
  if (c.outputs.empty())
    text +=
        "No output has a direction of the platform or a leg: frequencies alone determine the "
        "pairs.\n";
  if (!c.pairs.empty()) {
    Table table({"mode", "Hz", "model Hz", "differs", "damping", "model", "differs", "MAC",
                 "<mode of the model"});
    for (const auto& p : c.pairs) {
      const auto& fit = result.modes[static_cast<std::size_t>(p.measured)].fit;
      const auto& mode = c.model[static_cast<std::size_t>(p.model)];
      table.add_row({fmt::format("{}", p.measured + 1), hertz(fit.omega(), 4),
                     hertz(mode.omega(), 4), signed_percent(p.frequency_difference),
                     percent(fit.damping_ratio()), percent(mode.damping_ratio()),
                     signed_percent(p.damping_difference),
                     p.mac ? fmt::format("{:.3f}", *p.mac) : "–",
                     compared.labels[static_cast<std::size_t>(p.model)]});
    }
    text += "\n" + table.text(style);
  }
  return text + "\n" + left_text(compared, result) + verdict;
}

struct Arguments : IdentificationArguments {
  bool output_only{};
  int bootstrap{};  ///< draws
  std::string format{}, output{"-"}, plot{}, stabilisation{}, mac{}, cross_mac{};
};

enum Format : std::size_t { table, json, csv, uff, mat };

void draw_all(const Arguments& a, const tasks::Identified& found) {
  const auto& result = found.modes;
  const auto text =
      measured_plot_text(a.measurement.files, found.measured, found.measured.responses());
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

void write_modes(const Arguments& a, size_t format, const tasks::Identified& found) {
  const auto& result = found.modes;
  const std::string title = a.measurement.files[0];
  if (format == Format::uff)
    report::write_modes_uff(a.output, result, title,
                            found.measured.header ? found.measured.header->date : "");
  if (format == Format::mat) report::write_modes_mat(a.output, result);
  if (format == Format::uff || format == Format::mat) return print_written(a.output);
  std::string text;
  if (format == Format::json) {
    report::Json json = report::identification_json(result);
    if (found.measured.header) json["record"] = report::record_origin_json(*found.measured.header);
    report::add_cross_checks(found.cross_checks, json);
    if (found.bootstrap) report::add_bootstrap(*found.bootstrap, json);
    if (found.compared) json["comparison"] = report::comparison_json(*found.compared, result);
    text = json_text({{"kind", "identified_modes"}, {"records", a.measurement.files}}, json);
  } else if (format == Format::csv) {
    text = report::identified_modes_csv(result, tasks::observed_in(found.measured),
                                        found.measured.experiment());
  } else {
    const auto style = table_style(a.output);
    text = modes_text(found, style);
    if (found.compared) text += comparison_text(*found.compared, result, style);
  }
  write_result(a.output, format, text);
}

void run(const Arguments& a) {
  const size_t format = result_format(a.format, a.output, {"table", "json", "csv", "uff", "mat"});
  auto options = identify_options(a);
  options.measure.output_only = a.output_only;
  if (a.output_only && a.bootstrap > 0)
    base::refuse("--bootstrap",
                 "resamples inputs and outputs; with --output-only there is no input");
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
  write_modes(a, format, found);
}

}  // namespace

void add_identify(Command app) {
  Command command = app.add_command(
      "identify", "Modes from records or from frequency responses, with their uncertainty",
      {{"identify run.h5", "modes, damping ratios and shapes with default settings"},
       {"identify run.h5 --plot fit.svg --stabilisation chart.svg", "with pictures"},
       {"identify frf.json --from 2 --to 30", "from responses of `hydrapod frf`"},
       {"identify run.h5 --machine machine.toml", "compared with the modes of a machine file"},
       {"identify run.h5 -o modes.json", "for other programs; also .csv, .uff and .mat"}});
  auto& a = command.calls(&run);
  command.add_options(
      {{"RECORD|FRF", a.measurement.files,
        "Records, averaged together, or frequency responses: JSON of `hydrapod frf`, "
        "Universal File, table of text, MAT or HDF5",
        reads_required}});
  add_identification_options(command, a);
  command.add_options(
      {{"--output-only", a.output_only,
        "Modes from the outputs alone, for records without measured excitation; it must be "
        "broad-band"},
       {"--bootstrap", a.bootstrap,
        "Number of bootstrap resamples to check the intervals, for instance 50; 0: none",
        OptionRule{.shows_zero = true, .range = std::pair(0, 10000)}},
       {"--plot", a.plot, "Bode diagram of measurement and fit to write, .svg, .png or .pdf",
        writes},
       {"--stabilisation", a.stabilisation, "Stabilisation chart with mode indicator to write",
        writes},
       {"--mac", a.mac, "Picture of the MAC matrix to write", writes},
       {"--cross-mac", a.cross_mac, "Picture of the MAC of measured and model modes to write",
        writes},
       {"--format", a.format,
        "table, json, csv, uff (dataset 55) or mat; default: by the ending of -o, "
        "else table"},
       {"-o,--output", a.output, "File to write; - prints", writes}});
  command.add_extent_options();
}

}  // namespace hydrapod::cli
