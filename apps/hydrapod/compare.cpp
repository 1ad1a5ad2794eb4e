#include "hydrapod/command.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/measurement.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
using report::ComparedThing;
using report::TestedDifference;
using Verdict = TestedDifference::Verdict;
constexpr double band = numerics::normal_half_width;

struct Arguments {
  std::vector<std::string> files{}, overrides{}, poses{};
  std::string model{}, against{"auto"};
  double level{5.0};  // [%]
  std::string format{}, output{"-"}, plot{};
};

std::string letter(std::size_t thing) {
  return std::string(1, static_cast<char>('A' + thing % 26));
}

/// "5.024 ± 0.012", "5.024"; deviations are shown as half 95 % intervals.
std::string with_interval(double value, const std::optional<double>& deviation, int decimals) {
  return deviation ? fmt::format("{:.{}f} ± {:.2g}", value, decimals, band * *deviation)
                   : fmt::format("{:.{}f}", value, decimals);
}

std::string signed_number(double value, const std::optional<double>& deviation, int decimals) {
  return (value < 0.0 ? "−" : "+") + with_interval(std::abs(value), deviation, decimals);
}

std::optional<double> scaled(const std::optional<double>& deviation, double factor) {
  return deviation ? std::optional(*deviation * factor) : deviation;
}

const char* words(Verdict verdict) {
  switch (verdict) {
    case Verdict::significant:
      return "significant";
    case Verdict::not_significant:
      return "not significant";
    case Verdict::calculated:
      return "calculated";
    case Verdict::cannot_say:
      break;
  }
  return "cannot say";
}

std::string frequency_text(const ComparedThing::Mode& mode) {
  return with_interval(mode.omega / two_pi, scaled(mode.omega_deviation, 1.0 / two_pi), 3);
}

std::string pair_table(const report::SideBySide& all, const report::ThingComparison& c,
                       const TableStyle& style) {
  const auto& first = all.things.front();
  const auto& second = all.things[static_cast<std::size_t>(c.thing)];
  const std::string b = letter(static_cast<std::size_t>(c.thing));
  Table table({"A", Column(b), "A Hz", Column(b + " Hz"), "MAC", "frequency %", "<",
               "damping % points", "<", "<motion"});
  for (const auto& pair : c.pairs) {
    const auto& a = first.modes[static_cast<std::size_t>(pair.first)];
    const auto& partner = second.modes[static_cast<std::size_t>(pair.second)];
    const double share = 100.0 / a.omega;
    table.add_row(
        {fmt::format("{}", pair.first + 1), fmt::format("{}", pair.second + 1), frequency_text(a),
         frequency_text(partner), pair.mac ? fmt::format("{:.2f}", *pair.mac) : "–",
         signed_number(share * pair.frequency.value, scaled(pair.frequency.deviation, share), 2),
         words(pair.frequency.verdict),
         signed_number(100.0 * pair.damping.value, scaled(pair.damping.deviation, 100.0), 2),
         words(pair.damping.verdict), a.label.empty() ? partner.label : a.label});
  }
  return table.text(style);
}

std::string left_text(const ComparedThing& thing, const std::vector<int>& left,
                      const std::string& name) {
  std::string text;
  for (const int k : left) {
    const auto& mode = thing.modes[static_cast<std::size_t>(k)];
    text += fmt::format("Only in {}: mode {}, {} Hz{}\n", name, k + 1, frequency_text(mode),
                        mode.label.empty() ? "" : ", " + mode.label);
  }
  return text;
}

/// What the verdicts of a comparison mean.
std::string notes(const report::SideBySide& all, const report::ThingComparison& c) {
  const auto any = [&](Verdict verdict) {
    return std::ranges::any_of(c.pairs, [&](const auto& pair) {
      return pair.frequency.verdict == verdict || pair.damping.verdict == verdict;
    });
  };
  std::string text = "Hz: |λ| of damped modes. Shapes: " + c.shapes + ".\n";
  if (any(Verdict::significant) || any(Verdict::not_significant))
    text += fmt::format("Significant: {}; ± is half the 95 % interval.\n", report::test_text(all));
  if (any(Verdict::calculated))
    text += "Calculated: both values are calculated and have no measurement uncertainty.\n";
  if (any(Verdict::cannot_say))
    text += "Cannot say: the uncertainty of a measured value is not known.\n";
  return text;
}

std::string table_text(const report::SideBySide& all, const TableStyle& style) {
  std::string text, verdicts;
  for (std::size_t k = 0; k < all.things.size(); ++k)
    text += fmt::format("{}  {}\n   {}\n", bold(letter(k), style), all.things[k].name,
                        all.things[k].description);
  for (const auto& c : all.comparisons) {
    const auto second = static_cast<std::size_t>(c.thing);
    text += "\n" + pair_table(all, c, style) + left_text(all.things.front(), c.first_left, "A") +
            left_text(all.things[second], c.second_left, letter(second)) + notes(all, c);
    verdicts += report::verdict_text(all, c) + "\n";
  }
  return text + "\n" + verdicts;
}

void run(const Arguments& a) {
  const size_t format = result_format(a.format, a.output, {"table", "json", "csv"});
  if (!a.plot.empty()) report::require_picture(a.plot);
  const auto compared = with_progress("comparing", [&](const auto& progress) {
    return tasks::compare({.files = a.files,
                           .overrides = a.overrides,
                           .poses = a.poses,
                           .model = model_kind(a.model),
                           .observed = observed_system(a.against),
                           .level = a.level / 100.0},
                          progress);
  });
  print_diagnostics(compared.warnings);
  const auto& result = compared.result;
  draw(a.plot, [&](const auto& path) { report::plot_side_by_side(result, path); });
  write_result(a.output, format,
               format == 0 ? table_text(result, table_style(a.output))
               : format == 1
                   ? json_text({{"kind", "comparison"}}, report::side_by_side_json(result))
                   : report::side_by_side_csv(result));
}

}  // namespace

void add_compare(Command app) {
  Command command = app.add_command(
      "compare",
      "Machines, poses, records and identified modes side by side: modes matched by shape, "
      "differences and whether they are significant",
      {{"compare machine.toml --set legs.guide_sleeve.stiffness=\"2e6 N/m\"",
        "the machine without and with the change"},
       {"compare machine.toml --pose neutral --pose \"z=50 mm\"", "two poses of one machine"},
       {"compare before.h5 after.h5 --plot differences.svg", "before and after a repair"},
       {"compare machine.toml run.h5 -o comparison.json", "the machine and a measurement"}});
  auto& a = command.calls(&run);
  command.add_options(
      {{"THING", a.files,
        "Machine files, each perhaps with a pose (machine.toml@low); identified modes (JSON, CSV, "
        "Universal File); records or frequency responses, of which modes are identified. All are "
        "compared with the first",
        reads_required},
       {"--set", a.overrides,
        "PATH=VALUE for every machine file; of one machine file alone, the file is compared with "
        "the changed machine; may be repeated",
        one_each_as("PATH=VALUE")},
       {"--pose", a.poses,
        "Pose of machine files that say none; of one machine file alone given several times: these "
        "poses are compared",
        one_each},
       {"--model", a.model, "rigid, guide or full; default: what the file describes"},
       {"--against", a.against,
        "Model of machine files: auto (what was measured, else mechanics), mechanics, plant or "
        "system"},
       {"--level", a.level, "Level of the tests in %", range(0.01, 50.0)},
       {"--plot", a.plot,
        "Picture of differences and overlaid Bode diagrams to write, .svg, .png or .pdf", writes},
       {"--format", a.format, "table, json or csv; default: by the ending of -o, else table"},
       {"-o,--output", a.output, "File to write; - prints", writes}});
}

}  // namespace hydrapod::cli
