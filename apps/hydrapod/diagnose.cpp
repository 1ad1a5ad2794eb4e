#include "hydrapod/command.hpp"

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reports.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;

struct Arguments {
  MachineArguments machine{};
  DiagnosisArguments diagnosis{};
  double frequency_error{0.2};  // [%]
  double common_share{};        // [%]
  double shape_error{5.0};      // [%]
  double response_error{10.0};  // [%]
  bool modes_only{};
  std::size_t shown{12};
  std::string format{}, output{"-"}, plot{};
};

std::string heading(const std::string& text, const TableStyle& style) {
  return "\n" + bold(text, style) + "\n";
}

/// "z (mode: x)" where what was stated contradicts the mode.
std::string direction_text(const diagnosis::MeasuredMode& mode) {
  using diagnosis::direction_name;
  if (mode.direction < 0) return "";
  if (mode.mode_direction < 0) return direction_name(mode.direction);
  return fmt::format("{} (mode: {})", direction_name(mode.direction),
                     direction_name(mode.mode_direction));
}

const char* machine_word(const diagnosis::CaseFile& file) {
  return file.fitted ? "fitted" : "nominal";
}

std::string modes_text(const diagnosis::Diagnosis& d, const model::Machine& machine,
                       const TableStyle& style) {
  Table table({"<pose", "<direction", "measured Hz", "rigid Hz", "drop", "share", "peak",
               "nominal Hz", "fitted Hz", "MAC", "<elastic energy"});
  for (const auto& m : d.modes) {
    const bool rigid = m.rigid_mac >= diagnosis::resonance_mac;
    table.add_row(
        {place_text(m.pose, m.amplitude), direction_text(m),
         fmt::format("{:.3f} ± {:.3f}", m.omega / two_pi, m.deviation / two_pi),
         rigid ? hertz(m.omega_rigid) : "", rigid ? fmt::format("{:.1f} %", 100.0 * m.drop()) : "",
         rigid ? fmt::format("{:.0f} %", 100.0 * m.rigid_mac) : "",
         rigid ? fmt::format("{:.2f}", report::peak_height(m.rigid_mac, m.omega, m.omega_rigid))
               : "",
         hertz(m.omega_stated), hertz(m.omega_best),
         m.shape_mac > 0.0 ? fmt::format("{:.2f}", m.shape_mac) : "",
         report::energy_text(m.oil, m.guide_sleeves, m.piston_rings, m.base, m.payload, m.bending,
                             m.leg_type)});
  }
  return heading("Measured modes", style) + table.text(style) + report::axial_energy_text(machine);
}

std::string ranking_text(const diagnosis::Diagnosis& d, std::size_t shown,
                         const TableStyle& style) {
  Table table(
      {"rank", "<hypothesis", "ΔBIC", "numbers", "misfit", "χ²/ν", "<values", "<contradiction"});
  std::size_t rank = 0;
  const auto add = [&](const diagnosis::Hypothesis& e) {
    const auto wrong = report::contradiction_words(d, e);
    table.add_row({fmt::format("{}", rank), report::hypothesis_name(d, e),
                   fmt::format("{:.1f}", e.bic - d.best().bic), fmt::format("{}", e.parameters),
                   fmt::format("{:.4g}", e.misfit), fmt::format("{:.2f}", goodness(d, e).reduced),
                   fmt::format("{}", fmt::join(report::parameter_words(e), "; ")),
                   wrong.empty() ? "" : wrong.front()});
  };
  for (const auto& e : d.hypotheses) {
    ++rank;
    if (rank <= shown || (e.causes.empty())) add(e);
  }
  std::size_t lines = 0;
  for (const auto& response : d.targets.responses) lines += response.s.size();
  const auto responses = lines > 0 ? fmt::format(", {} lines of responses", lines) : "";
  return heading(fmt::format("Hypotheses ({} measured values{}; up to ΔBIC {:.0f} they explain the "
                             "data equally well)",
                             d.values, responses, diagnosis::same),
                 style) +
         table.text(style);
}

std::string attribution_text(const diagnosis::CaseFile& file, const TableStyle& style) {
  if (file.drops.empty()) return {};
  const auto machine = machine_word(file);
  std::vector<Column> columns{"<direction", "rigid Hz", fmt::format("{} Hz", machine),
                              "drop",       "share",    "peak",
                              "<lower mode"};
  for (const auto& part : file.drops.front().parts) columns.push_back(report::part_name(part.part));
  Table table(columns);
  for (const auto& drop : file.drops) {
    const auto& r = drop.resonance;
    if (r.omega == 0.0) {
      table.add_row({r.direction, hertz(r.omega_rigid), "folds"});
      continue;
    }
    std::vector<std::string> row{
        r.direction,
        hertz(r.omega_rigid),
        hertz(r.omega),
        fmt::format("{:.2f} %", 100.0 * r.drop()),
        fmt::format("{:.0f} %", 100.0 * r.mac),
        fmt::format("{:.2f}", report::peak_height(r.mac, r.omega, r.omega_rigid)),
        r.below ? fmt::format("{} Hz, {:.0f} %", hertz(r.below->omega), 100.0 * r.below->mac) : ""};
    constexpr double least = 5e-4;  // of a smaller drop shares mean nothing
    for (const auto& part : drop.parts)
      row.push_back(std::abs(r.drop()) < least ? "" : fmt::format("{:.0f} %", 100.0 * part.share));
    table.add_row(row);
  }
  return heading(fmt::format("Share of the frequency drop of the {} machine at pose {}, with this "
                             "part alone rigid",
                             machine, file.pose),
                 style) +
         table.text(style);
}

std::string remedy_text(const diagnosis::CaseFile& file, const TableStyle& style) {
  if (!file.remedy || file.remedy->changes.empty()) return {};
  constexpr std::size_t most = 24;
  const auto machine = machine_word(file);
  Table table({"<pose", "<direction", "rigid Hz", fmt::format("{} Hz", machine), "share",
               "required Hz", "drop", "share", "peak"});
  const auto& changes = file.remedy->changes;
  for (std::size_t k = 0; k < std::min(most, changes.size()); ++k) {
    const auto& c = changes[k];
    table.add_row(
        {c.pose, report::direction_words(c.direction), hertz(c.omega_rigid),
         c.omega_today > 0.0 ? hertz(c.omega_today) : "folds",
         c.omega_today > 0.0 ? fmt::format("{:.0f} %", 100.0 * c.mac_today) : "",
         hertz(c.omega_needed),
         fmt::format("{:.1f} %", 100.0 * (1.0 - c.omega_needed / c.omega_rigid)),
         fmt::format("{:.0f} %", 100.0 * c.mac_needed),
         fmt::format("{:.2f}", report::peak_height(c.mac_needed, c.omega_needed, c.omega_rigid))});
  }
  std::string text =
      heading(
          fmt::format("First resonances of the {} machine, and with the required stiffness of the "
                      "guide sleeves ({:.3g} times the {} one)",
                      machine, file.remedy->needed.factor, machine),
          style) +
      table.text(style);
  if (changes.size() > most)
    text += fmt::format("… and {} more; --format json has all\n", changes.size() - most);
  return text;
}

std::string table_text(const Arguments& a, const model::MachineFile& file,
                       const diagnosis::CaseFile& found, const std::vector<std::string>& origins) {
  const auto style = table_style(a.output);
  std::string text = fmt::format("{}{}\n", file.machine.name,
                                 a.diagnosis.measured.empty()
                                     ? ""
                                     : fmt::format(": {}", fmt::join(a.diagnosis.measured, ", ")));
  text += state_line(file);
  for (const auto& origin : origins) text += "measured: " + origin + "\n";
  for (const auto& sentence : report::summary(found, style.brief)) text += "  " + sentence + "\n";
  if (style.brief) return text;
  if (found.diagnosis) {
    text += modes_text(*found.diagnosis, found.machine, style);
    if (found.diagnosis->hypotheses.size() > 1)
      text += ranking_text(*found.diagnosis, a.shown, style);
  }
  return text + attribution_text(found, style) + remedy_text(found, style);
}

/// Without a measurement, goal and poses are of compliant guide sleeves.
void require_sleeves(const DiagnosisArguments& asked, const tasks::Machine& machine) {
  if (!asked.measured.empty() || machine.kind != dynamics::ModelKind::rigid) return;
  constexpr auto reason =
      "is about guide sleeves, and the rigid-leg model has none; leave it out, or add "
      "--measured";
  if (asked.want != DiagnosisArguments{}.want) base::refuse("--want " + asked.want, reason);
  if (!asked.poses.empty()) base::refuse("--poses " + asked.poses, reason);
}

void run(const Arguments& a) {
  const auto format = result_format(a.format, a.output, {"table", "json"});
  if (!a.plot.empty()) report::require_picture_ending(a.plot);
  auto asked = a.diagnosis;
  auto& rules = asked.options;
  rules.frequency_error = a.frequency_error / 100.0;
  rules.common_share = a.common_share / 100.0;
  rules.shape_error = a.shape_error / 100.0;
  rules.response_error = a.response_error / 100.0;
  rules.responses = !a.modes_only;
  auto subject = a.machine;
  const bool pose_given = !subject.pose.empty();
  if (!pose_given) subject.pose = "neutral";
  const auto machine = load(subject);
  auto options = diagnose_options(asked, machine.file.machine);
  options.measured.pose_given = pose_given;
  require_sleeves(asked, machine);
  const auto found = with_progress("diagnosing", [&](const auto& progress) {
    return tasks::diagnose(machine, options, progress);
  });
  print_diagnostics(found.warnings);
  std::string text;
  if (format == 0) {
    text = table_text(a, machine.file, found.file, found.origins);
  } else {
    auto json = report::head_json("diagnosis", machine.file, machine.path);
    json["model"] = dynamics::name(machine.kind);
    json["measured"] = fmt::format("{}", fmt::join(a.diagnosis.measured, ", "));
    if (!found.origins.empty()) json["measured_at"] = found.origins;
    text = json_text(json, report::diagnosis_json(found.file));
  }
  write_result(a.output, format, text);
  draw(a.plot, [&](const auto& path) {
    report::plot_diagnosis(
        found.file,
        fmt::format("machine: {}; {} model", report::mechanics_state_text(machine.file),
                    dynamics::name(machine.kind)),
        path);
  });
  if (found.file.diagnosis && found.file.diagnosis->interrupted)
    throw base::ComputationError("interrupted: the result contains the hypotheses tried so far");
}

}  // namespace

void add_diagnose(Command app) {
  Command command = app.add_command(
      "diagnose", "Cause of low frequencies, its uncertainty, and the required stiffness",
      {{"diagnose machine.toml --measured modes.csv",
        "hypotheses for the measured modes, ranked, and the required stiffness"},
       {"diagnose machine.toml --measured run.h5 --pose high", "the same from a record"},
       {"diagnose machine.toml --measured neutral.h5 --measured high.h5@high",
        "from records at several poses"},
       {"diagnose machine.toml --want \"x=5 Hz\" --poses workspace",
        "without a measurement: shares of the frequency drop, and the required stiffness in the "
        "whole workspace"},
       {"diagnose machine.toml --measured modes.csv --plot why.svg --format json -o why.json",
        "as a picture and as JSON"}});
  auto& a = command.calls(&run);
  a.machine.pose.clear();  // then a record counts at the pose that it states
  add_machine_options(command, a.machine);
  command.add_options(
      {{"--pose", a.machine.pose,
        "Pose of the file, or displacements from the neutral pose: \"z=50 mm, ry=5 deg\"; default: "
        "that of the record, else neutral"}});
  add_model_option(command, a.machine);
  command.add_options(
      {{"--measured", a.diagnosis.measured,
        "Modes (TOML, CSV, JSON of `hydrapod identify`), responses (JSON of `hydrapod "
        "frf`, Universal File) or a record; FILE@POSE names its pose; may be repeated; "
        "default: no measurement",
        reads_each_as("RECORD|FRF|MODES")},
       {"--against", a.diagnosis.against,
        "Measured system: mechanics (oil springs, closed valves), plant (inputs are the "
        "valve drives) or system (with its controller); auto: as the file states, else "
        "plant for drives and mechanics for other inputs"}});
  add_diagnosis_options(command, a.diagnosis);
  command.add_options(
      {{"--model-error", a.frequency_error,
        "Model uncertainty of frequencies, %, added to that of the measurement",
        range(0.001, 20.0)},
       {"--common-share", a.common_share,
        "Share of the variance of --model-error that all frequencies have in common, %",
        range(0.0, 95.0)},
       {"--shape-error", a.shape_error, "Model uncertainty of shapes, % of their magnitude",
        range(0.1, 50.0)},
       {"--response-error", a.response_error,
        "Model uncertainty of frequency responses, % of their magnitude at each line",
        range(0.1, 100.0)},
       {"--modes-only", a.modes_only, "Compare modes only, not the frequency responses"},
       {"--damping", a.diagnosis.options.damping,
        "Compare damping ratios too (the dampers of the file are those of the machine)"},
       {"--threads", a.diagnosis.options.threads, "Threads; 0: one per core", range(0, 256)},
       {"--show", a.shown, "Number of hypotheses in the table", range(1, 1000)},
       {"--plot", a.plot, "Picture to write, .svg, .png or .pdf (needs gnuplot)", writes},
       {"--format", a.format, "table or json; default: by the ending of -o, else table"},
       {"-o,--output", a.output, "File to write; - prints", writes}});
  command.add_extent_options();
}

}  // namespace hydrapod::cli
