#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/identification/exchange.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/identification_report.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/report/identification_files.hpp"
#include "hydrapod/report/identification_json.hpp"
#include "hydrapod/report/identification_plot.hpp"
#include "hydrapod/report/mode_comparison.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

const std::vector<std::string_view> against_words{"auto", "mechanics", "plant", "system", "none"};

struct Arguments {
  MeasurementArguments measurement{};
  std::string from{}, to{};
  int order{40};
  double highest_damping{30.0};  // [%]
  bool output_only{};
  std::string against{"auto"};
  std::string format{}, output{"-"}, plot{}, stabilisation{}, mac{}, cross_mac{};
};

enum Format : std::size_t { table, json, csv, uff, mat };

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

/// What is identified, and what is known of where it comes from.
struct Source {
  identification::FrequencyResponses responses{};
  std::optional<data::RecordHeader> header{};
  std::string frame{"outputs as measured"};  ///< how they were brought to directions
};

Source read_responses(const std::string& path) {
  constexpr std::size_t largest = std::size_t{1} << 31;
  const std::string text = base::read_file(path, largest, "frequency responses of `hydrapod frf`");
  report::Json json;
  try {
    json = report::Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    bad_argument(path, fmt::format("is no JSON: {}", error.what()));
  }
  return {.responses = report::responses_from_json(json, path),
          .header = report::record_origin_from_json(json)};
}

Source source_of(const Arguments& a) {
  const std::string& first = a.measurement.files[0];
  if (is_json(first)) {
    if (a.measurement.files.size() > 1)
      bad_argument(a.measurement.files[1],
                   "frequency responses stand alone: only records are "
                   "averaged together");
    return read_responses(first);
  }
  if (is_universal(first) && a.measurement.files.size() == 1) {
    try {
      auto read = data::read_frequency_response(first);
      print_diagnostics(read.notes);
      return {.responses = identification::from_exchange(read.response, first)};
    } catch (const base::InputError&) {  // it may hold a record instead
      if (!is_record(first)) throw;
    }
  }
  auto m = measure(a.measurement);
  Source source{.responses = std::move(m.responses), .header = std::move(m.header)};
  if (m.from_legs) source.frame = "leg lengths brought to platform directions";
  return source;
}

/// What the inputs see: the plant from the drives on, else the machine as it stands, which is under
/// its controller in a record of the rig.
comparison::Source model_source(const Arguments& a, const Source& source) {
  const auto word = choose_word("--against", a.against, against_words);
  if (word > 0) return static_cast<comparison::Source>(word - 1);
  if (!source.header || !is_rig_record(*source.header)) return comparison::Source::mechanics;
  const bool drives = std::ranges::all_of(
      source.responses.inputs, [](const auto& c) { return c.role == data::Role::drive; });
  return drives ? comparison::Source::plant : comparison::Source::system;
}

/// Modes beside those of the machine that is known; none where there is no machine. A model that
/// cannot be computed is a warning: the modes were found all the same.
std::optional<report::ComparedModes> compared_modes(const Arguments& a, const Source& source,
                                                    const identification::Identification& result) {
  if (a.against == "none" || result.modes.empty()) return {};
  const auto machine = measured_machine(a.measurement, source.header ? &*source.header : nullptr);
  if (!machine) {
    if (a.against != "auto" || !a.cross_mac.empty())
      bad_argument(a.cross_mac.empty() ? "--against " + a.against : "--cross-mac " + a.cross_mac,
                   "there is no machine to compare with: add --machine FILE");
    return {};
  }
  report::ComparedModes compared{.source = model_source(a, source),
                                 .kind = machine->kind,
                                 .machine = machine->file.machine.name,
                                 .pose = machine->pose.name};
  try {
    compared.result = comparison::compare_modes(
        result,
        comparison::model_modes(machine->file.machine, machine->pose.X_BP, machine->kind,
                                compared.source),
        {machine->file.machine, machine->pose.X_BP, measured_point(a.measurement, *machine)},
        a.highest_damping / 100.0);
  } catch (const base::ComputationError& error) {
    print_warnings(machine->name, {fmt::format("not compared with the model: {}", error.what())});
    return {};
  }
  return compared;
}

void draw(const Arguments& a, const identification::Identification& result,
          const std::optional<report::ComparedModes>& compared) {
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
  if (!a.cross_mac.empty()) {
    if (!compared) bad_argument("--cross-mac " + a.cross_mac, "there is nothing to compare");
    report::plot_cross_mac(*compared, result, {text.title, report::comparison_heading(*compared)},
                           a.cross_mac);
    wrote(a.cross_mac);
  }
}

void run_output_only(const Arguments& a, size_t format) {
  for (const auto* path : {&a.plot, &a.stabilisation, &a.mac, &a.cross_mac})
    if (!path->empty()) bad_argument("--output-only", "has no responses to plot");
  if (format > Format::csv)
    bad_argument("--output-only", "its modes are written as table, json or csv");
  const auto m = measure(a.measurement, true);
  const double highest = frequency("--to", a.to).value_or(0.45 * m.spectra.sample_rate);
  const auto modes = identification::identify_outputs(m.spectra, m.outputs, highest);
  if (format == Format::table)
    return base::write_file_whole(
        a.output, output_only_text(modes, m.outputs.size(), m.spectra.options.block_length,
                                   table_style(a.output)));
  if (format == Format::csv)
    return base::write_file_whole(a.output, report::output_only_csv(modes));
  base::write_file_whole(a.output, report::Json{{"kind", "output_only_modes"},
                                                {"records", a.measurement.files},
                                                {"modes", report::output_only_json(modes)}}
                                           .dump(1) +
                                       "\n");
}

void write_result(const Arguments& a, size_t format, const Source& source,
                  const identification::Identification& result,
                  const std::optional<report::ComparedModes>& compared) {
  const std::string title = a.measurement.files[0];
  if (format == Format::uff)
    return report::write_modes_uff(a.output, result, title,
                                   source.header ? source.header->date : "");
  if (format == Format::mat) return report::write_modes_mat(a.output, result);
  std::string text;
  if (format == Format::json) {
    report::Json json{{"kind", "identified_modes"}, {"records", a.measurement.files}};
    json.update(report::identification_json(result));
    if (compared) json["comparison"] = report::comparison_json(*compared, result);
    text = json.dump(1) + "\n";
  } else if (format == Format::csv) {
    text = report::identified_modes_csv(result);
  } else {
    const auto style = table_style(a.output);
    text = modes_text(result, measurement_text(source.responses), source.frame, style);
    if (compared) text += comparison_text(*compared, result, style);
  }
  base::write_file_whole(a.output, text);
}

void run(const Arguments& a) {
  const size_t format = result_format(a.format, a.output, {"table", "json", "csv", "uff", "mat"});
  choose_word("--against", a.against, against_words);
  const auto options = options_of(a);
  if (a.output_only) return run_output_only(a, format);
  for (const auto* path : {&a.plot, &a.stabilisation, &a.mac, &a.cross_mac})
    if (!path->empty()) report::require_picture(*path);
  const auto source = source_of(a);
  identification::Identification result;
  {
    ProgressLine line("identifying");
    result = identification::identify_modes(source.responses, options,
                                            [&](double share) { line.update(share); });
  }
  print_warnings(a.measurement.files[0], result.warnings);
  const auto compared = compared_modes(a, source, result);
  draw(a, result, compared);
  write_result(a, format, source, result, compared);
}

}  // namespace

void add_identify(CLI::App& app) {
  CLI::App* command = add_command(
      app, "identify", "Modes from records or from frequency responses, with their uncertainty",
      {{"identify run.h5", "modes, damping, shapes, without a setting"},
       {"identify run.h5 --plot fit.svg --stabilisation chart.svg", "with the pictures to it"},
       {"identify frf.json --from 2 --to 30", "from responses that `hydrapod frf` wrote"},
       {"identify run.h5 --machine machine.toml", "beside the modes of a machine file"},
       {"identify run.h5 -o modes.json", "for other programs; also .csv, .uff and .mat"}});
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
  command->add_option("--cross-mac", a->cross_mac,
                      "Picture of the MAC of measured and model modes to write");
  command
      ->add_option("--against", a->against,
                   "Model to compare with: auto, mechanics (on oil springs), plant (with "
                   "hydraulics), system (with controller too) or none")
      ->capture_default_str();
  command->add_option("--format", a->format,
                      "table, json, csv, uff (dataset 55) or mat; default: by the ending of -o, "
                      "else table");
  command->add_option("-o,--output", a->output, "File to write; - prints")->capture_default_str();
  command->callback([a] { run(*a); });
}

}  // namespace hydrapod::cli
