#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <numeric>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/identification/exchange.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/report/identification_json.hpp"
#include "hydrapod/report/identification_plot.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

struct Arguments {
  MeasurementArguments measurement{};
  std::string from{}, to{};
  int order{40};
  double highest_damping{30.0};  // [%]
  bool output_only{};
  std::string format{"table"}, output{"-"}, plot{}, stabilisation{}, mac{};
};

std::optional<double> frequency(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  const double value = plain_or_quantity(option + " " + text, text, "Hz");
  if (!(value >= 0.0)) bad_argument(option + " " + text, "a frequency cannot be negative");
  return value;
}

identification::IdentifyOptions options_of(const Arguments& a) {
  identification::IdentifyOptions o;
  o.from = frequency("--from", a.from);
  o.to = frequency("--to", a.to);
  if (o.from && o.to && *o.from >= *o.to)
    bad_argument("--from " + a.from, "must be less than --to " + a.to);
  o.orders.highest = a.order;
  o.highest_damping = a.highest_damping / 100.0;
  return o;
}

/// JSON of `hydrapod frf`? Its first character tells.
bool is_json(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char first = ' ';
  file >> first;
  return file && first == '{';
}

/// By its ending a Universal File?
bool is_universal(const std::string& path) {
  return path.ends_with(".uff") || path.ends_with(".unv") || path.ends_with(".uf") ||
         path.ends_with(".UFF") || path.ends_with(".UNV");
}

bool is_record(const std::string& path) {
  try {
    data::open_record_reader(path);
    return true;
  } catch (const base::InputError&) {
    return false;
  }
}

identification::FrequencyResponses read_responses(const std::string& path) {
  constexpr std::size_t largest = std::size_t{1} << 31;
  const std::string text = base::read_file(path, largest, "frequency responses of `hydrapod frf`");
  report::Json json;
  try {
    json = report::Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    bad_argument(path, fmt::format("is no JSON: {}", error.what()));
  }
  return report::responses_from_json(json, path);
}

identification::FrequencyResponses responses_of(const Arguments& a, bool& from_legs) {
  if (is_json(a.measurement.files[0])) {
    if (a.measurement.files.size() > 1)
      bad_argument(a.measurement.files[1],
                   "frequency responses stand alone: only records are "
                   "averaged together");
    return read_responses(a.measurement.files[0]);
  }
  if (is_universal(a.measurement.files[0]) && a.measurement.files.size() == 1) {
    try {
      auto read = data::read_frequency_response(a.measurement.files[0]);
      print_diagnostics(read.notes);
      return identification::from_exchange(read.response, a.measurement.files[0]);
    } catch (const base::InputError&) {  // it may hold a record instead
      if (!is_record(a.measurement.files[0])) throw;
    }
  }
  auto m = measure(a.measurement);
  from_legs = m.from_legs;
  return std::move(m.responses);
}

/// The outputs that move most, each in proportion to the size of its own responses.
std::string shape_text(const identification::IdentifiedMode& mode, const Eigen::VectorXd& size,
                       const std::vector<data::Channel>& outputs) {
  Eigen::VectorXd share = mode.fit.shape.cwiseAbs().cwiseQuotient(size);
  share /= share.maxCoeff();
  std::vector<int> order(outputs.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](int a, int b) { return share[a] > share[b]; });
  std::string text;
  constexpr double shown = 0.2;
  constexpr std::size_t most = 4;
  for (std::size_t k = 0; k < std::min(most, order.size()) && share[order[k]] >= shown; ++k) {
    const bool opposite =
        (mode.fit.shape[order[k]] * std::conj(mode.fit.shape[order[0]])).real() < 0.0;
    text += fmt::format("{}{}{} {:.2f}", k == 0 ? "" : ", ", opposite ? "−" : "",
                        outputs[static_cast<std::size_t>(order[k])].name, share[order[k]]);
  }
  return text;
}

std::string table_text(const Arguments& a, const identification::Identification& result,
                       const std::string& measured, bool from_legs) {
  const bool printed = a.output == "-";
  const bool colour = printed && has_colour(stdout);
  std::string text =
      fmt::format("{}\nband {:.4g} Hz to {:.4g} Hz, model orders up to {}, {}\n", measured,
                  result.from, result.to, result.chart.empty() ? 0 : result.chart.back().order,
                  from_legs ? "leg lengths brought to platform directions" : "outputs as measured");
  if (result.modes.empty()) return text + "\nno mode in this band\n";
  Table table({{"mode"},
               {"Hz"},
               {"±"},
               {"damping"},
               {"±"},
               {"what moves", Align::left},
               {"MPC"},
               {"MPD"},
               {"quality"}});
  Eigen::VectorXd size =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(result.responses.outputs.size()));
  for (const auto& H : result.responses.H) size += H.rowwise().squaredNorm();
  size = size.cwiseSqrt().cwiseMax(1e-300);
  for (std::size_t r = 0; r < result.modes.size(); ++r) {
    const auto& m = result.modes[r];
    table.add_row({fmt::format("{}", r + 1), fmt::format("{:.4f}", m.fit.omega() / two_pi),
                   fmt::format("{:.4f}", 1.96 * m.fit.omega_deviation / two_pi),
                   fmt::format("{:.3f} %", 100.0 * m.fit.damping_ratio()),
                   fmt::format("{:.3f} %", 196.0 * m.fit.damping_deviation),
                   shape_text(m, size, result.responses.outputs), fmt::format("{:.3f}", m.mpc),
                   fmt::format("{:.1f}°", m.mpd * 180.0 / std::numbers::pi),
                   fmt::format("{:.2f}", m.quality())});
  }
  text += "\n" + table.text(colour, printed ? terminal_width() : Table::unlimited);
  text += fmt::format("\n± is 95 %. The modes give the responses back to {:.2g} %",
                      100.0 * result.model.error);
  if (result.model.misfit > 0.0)
    text +=
        fmt::format(", {:.2f} times what their noise explains (mean square)", result.model.misfit);
  text += ".\n";
  for (const auto& m : result.heavily_damped)
    text += fmt::format("Heavily damped pole, no mode: {:.3f} Hz, {:.0f} % of critical.\n",
                        m.omega() / two_pi, 100.0 * m.damping_ratio());
  return text;
}

void draw(const Arguments& a, const identification::Identification& result) {
  const report::PlotText text{a.measurement.files[0], measurement_text(result.responses)};
  const auto wrote = [](const std::string& path) { fmt::print(stderr, "wrote {}\n", path); };
  if (!a.plot.empty()) {
    report::plot_responses(result.responses, result.modes.empty() ? nullptr : &result.model, text,
                           a.plot);
    wrote(a.plot);
  }
  if (!a.stabilisation.empty()) {
    report::plot_stabilisation(result, text, a.stabilisation);
    wrote(a.stabilisation);
  }
  if (!a.mac.empty()) {
    if (result.modes.empty()) bad_argument("--mac " + a.mac, "there is no mode to compare");
    report::plot_mac(result, text, a.mac);
    wrote(a.mac);
  }
}

std::string output_only_text(const Arguments& a, const identification::Measurement& m,
                             const std::vector<identification::OutputOnlyMode>& modes) {
  const bool printed = a.output == "-";
  std::string text = fmt::format(
      "{} outputs, no input: covariance-driven subspace identification, blocks of {} samples\n",
      m.outputs.size(), m.spectra.options.block_length);
  if (modes.empty()) return text + "\nno mode comes back whatever the model order\n";
  Table table({{"mode"}, {"Hz"}, {"scatter"}, {"damping"}, {"scatter"}, {"MPC"}, {"quality"}});
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const auto& mode = modes[r];
    const double omega = std::abs(mode.pole);
    table.add_row({fmt::format("{}", r + 1), fmt::format("{:.4f}", omega / two_pi),
                   fmt::format("{:.4f}", mode.frequency_scatter * omega / two_pi),
                   fmt::format("{:.3f} %", -100.0 * mode.pole.real() / omega),
                   fmt::format("{:.3f} %", 100.0 * mode.damping_scatter),
                   fmt::format("{:.3f}", mode.mpc), fmt::format("{:.2f}", mode.persistence)});
  }
  return text + "\n" +
         table.text(printed && has_colour(stdout), printed ? terminal_width() : Table::unlimited) +
         "\nscatter: over model orders; it is no interval of confidence\n";
}

void run_output_only(const Arguments& a, size_t format) {
  for (const auto* path : {&a.plot, &a.stabilisation, &a.mac})
    if (!path->empty()) bad_argument("--output-only", "has no responses to plot");
  const auto m = measure(a.measurement, true);
  const double highest = frequency("--to", a.to).value_or(0.45 * m.spectra.sample_rate);
  const auto modes = identification::identify_outputs(m.spectra, m.outputs, highest);
  if (format == 0)
    base::write_file_whole(a.output, output_only_text(a, m, modes));
  else
    base::write_file_whole(a.output, format == 1
                                         ? report::Json{{"kind", "output_only_modes"},
                                                        {"records", a.measurement.files},
                                                        {"modes", report::output_only_json(modes)}}
                                                   .dump(1) +
                                               "\n"
                                         : report::output_only_csv(modes));
}

void run(const Arguments& a) {
  const size_t format = choose_word("--format", a.format, {"table", "json", "csv"});
  const auto options = options_of(a);
  if (a.output_only) return run_output_only(a, format);
  for (const auto* path : {&a.plot, &a.stabilisation, &a.mac})
    if (!path->empty()) report::require_picture(*path);
  bool from_legs = false;
  const auto responses = responses_of(a, from_legs);
  identification::Identification result;
  {
    ProgressLine line("identifying");
    result = identification::identify_modes(responses, options,
                                            [&](double share) { line.update(share); });
  }
  print_warnings(a.measurement.files[0], result.warnings);
  draw(a, result);
  if (format == 1) {
    report::Json json{{"kind", "identified_modes"}, {"records", a.measurement.files}};
    json.update(report::identification_json(result));
    base::write_file_whole(a.output, json.dump(1) + "\n");
  } else {
    base::write_file_whole(
        a.output, format == 0 ? table_text(a, result, measurement_text(responses), from_legs)
                              : report::identified_modes_csv(result));
  }
}

}  // namespace

void add_identify(CLI::App& app) {
  CLI::App* command = add_command(
      app, "identify", "Modes from records or from frequency responses, with their uncertainty",
      {{"identify run.h5", "modes, damping, shapes, without a setting"},
       {"identify run.h5 --plot fit.svg --stabilisation chart.svg", "with the pictures to it"},
       {"identify frf.json --from 2 --to 30", "from responses that `hydrapod frf` wrote"},
       {"identify run.h5 --machine machine.toml --format json -o modes.json",
        "leg lengths as platform directions, for other programs"}});
  auto a = std::make_shared<Arguments>();
  command
      ->add_option("RECORD|FRF", a->measurement.files,
                   "Records that are averaged together, or JSON of `hydrapod frf`")
      ->required();
  add_measurement_options(*command, a->measurement);
  command->add_option("--from", a->from, "Lowest frequency, Hz or with a unit; default: found out");
  command->add_option("--to", a->to, "Highest frequency, Hz or with a unit; default: found out");
  command->add_option("--order", a->order, "Highest model order")
      ->check(CLI::Range(4, 100))
      ->capture_default_str();
  command
      ->add_option("--highest-damping", a->highest_damping,
                   "Damping in per cent of critical above which a pole is no mode")
      ->check(CLI::Range(0.1, 90.0))
      ->capture_default_str();
  command->add_flag("--output-only", a->output_only,
                    "The excitation was not measured: modes from the responses alone");
  command->add_option("--plot", a->plot, "Bode diagram with the fit to write, .svg, .png or .pdf");
  command->add_option("--stabilisation", a->stabilisation,
                      "Stabilisation chart with mode indicator to write");
  command->add_option("--mac", a->mac, "Picture of the MAC matrix to write");
  command->add_option("--format", a->format, "table, json or csv")->capture_default_str();
  command->add_option("-o,--output", a->output, "File to write; - prints")->capture_default_str();
  command->callback([a] { run(*a); });
}

}  // namespace hydrapod::cli
