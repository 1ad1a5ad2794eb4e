#include "hydrapod/study_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace hydrapod::cli {

namespace {

std::string number_text(double value, const std::string& unit) {
  return unit == "Hz" ? fmt::format("{:.3f}", value) : fmt::format("{:.4g}", value);
}

std::string status_text(const study::Summary& summary) {
  constexpr std::array words{"computed", "with numbers that no machine can have", "out of reach",
                             "without equilibrium", "buckled"};
  std::string text;
  for (std::size_t k = 1; k < summary.statuses.size(); ++k)
    if (summary.statuses[k] > 0)
      text += fmt::format("{} of {} samples {}; they have no frequencies and miss requirements\n",
                          summary.statuses[k], summary.rows, words[k]);
  return text;
}

std::string interval_text(const std::optional<study::Interval>& interval, double scale) {
  return interval ? fmt::format("{:.4g} … {:.4g}", scale * interval->low, scale * interval->high)
                  : std::string("–");
}

std::string requirements_text(const tasks::StudyJob& job, const study::Summary& summary,
                              const TableStyle& style) {
  if (job.requirements.empty()) return {};
  Table table({"<requirement", "missed", "of", "probability %", "<95 % interval"});
  for (std::size_t k = 0; k < job.requirements.size(); ++k) {
    const auto& result = summary.requirements[k];
    table.add_row({job.requirements[k].text, std::to_string(result.missed),
                   std::to_string(result.count), fmt::format("{:.4g}", 100.0 * result.probability),
                   interval_text(result.interval, 100.0)});
  }
  return "\n" + table.text(style);
}

std::string indices_text(const tasks::StudyJob& job, const study::Summary& summary,
                         const TableStyle& style) {
  if (summary.indices.empty()) return {};
  Table table({"<output", "<input", "first order", "<95 % interval", "total", "<95 % interval"});
  for (std::size_t k = 0; k < summary.indices.size(); ++k) {
    const auto& one = summary.indices[k];
    if (static_cast<int>(k) == job.problem.status) continue;
    for (std::size_t i = 0; i < one.first.size(); ++i)
      table.add_row(
          {job.problem.outputs[k].name, job.problem.inputs[i].name,
           fmt::format("{:.3f}", one.first[i].value), interval_text(one.first[i].interval, 1.0),
           fmt::format("{:.3f}", one.total[i].value), interval_text(one.total[i].interval, 1.0)});
  }
  return "\nShares of the variance (Sobol indices)\n" + table.text(style);
}

/// "4.91 Hz", "2.81", of a drop "32.9 %".
std::string value_text(const study::Column& column, double value) {
  if (column.name.starts_with("drop")) return fmt::format("{:.4g} %", 100.0 * value);
  return fmt::format("{:.4g}{}", value, column.unit == "1" ? "" : " " + column.unit);
}

/// How many motions have no numbers, and how many have not settled in a direction.
std::string motion_text(const tasks::StudyJob& job, const study::Summary& summary) {
  const auto& outputs = job.problem.outputs;
  const auto peak = std::ranges::find(outputs, "peak_drive", &study::Column::name);
  if (job.commands.empty() || peak == outputs.end() || summary.statuses.empty()) return {};
  const auto ended = summary.outputs[static_cast<std::size_t>(peak - outputs.begin())].count;
  std::string text;
  const auto say = [&](std::uint64_t count, std::uint64_t of, const std::string& what) {
    if (count < of) text += fmt::format("{} of {} motions {}\n", of - count, of, what);
  };
  say(ended, summary.statuses.front(), "do not come to their end; they have no errors and times");
  for (std::size_t k = 0; k < outputs.size(); ++k)
    if (const std::string_view name = outputs[k].name; name.starts_with("settling_"))
      say(summary.outputs[k].count, ended,
          fmt::format("have not settled in {} at their end", name.substr(9)));
  return text;
}

/// "x = 0.1 m, rz = 0.02 rad": the inputs of a row.
std::string inputs_text(const std::vector<study::Input>& inputs, std::span<const double> values) {
  std::string text;
  for (std::size_t i = 0; i < inputs.size(); ++i)
    text += fmt::format("{}{} = {:.5g} {}", i > 0 ? ", " : "", inputs[i].name, values[i],
                        inputs[i].unit);
  return text;
}

/// A row that is worst in a column; where it is the worst over poses, the worst of these.
struct WorstRow {
  const study::Problem& problem;
  std::vector<double> values{};

  WorstRow(const tasks::StudyJob& job, std::uint64_t row, int column)
      : problem(job.problem.beneath ? *job.problem.beneath : job.problem),
        values(tasks::study_row(job, row)) {
    const auto outer = std::span(values).first(job.problem.inputs.size());
    if (auto found = study::worst_row(job.problem, outer, column)) values = std::move(*found);
  }
  [[nodiscard]] double of(std::string_view name) const {
    const auto at =
        std::ranges::find(problem.outputs, name, &study::Column::name) - problem.outputs.begin();
    return values[problem.inputs.size() + static_cast<std::size_t>(at)];
  }
  [[nodiscard]] std::string inputs() const { return inputs_text(problem.inputs, values); }
};

/// "; between the poses 4.91 Hz at x = 0.01 m": where it is worse there.
std::string between_text(const tasks::StudyJob& job, const study::OutputSummary& output,
                         const study::Column& column) {
  if (!output.between) return {};
  const auto& [value, inputs] = *output.between;
  return fmt::format("; between the poses {} at {}", value_text(column, value),
                     inputs_text(job.problem.inputs, inputs));
}

/// "12 % to 34 % of 0.56 m^2"
std::string reached_text(const std::optional<study::ReachedPart>& part) {
  if (!part) return {};
  const auto share = [&](double size) { return 100.0 * size / part->whole; };
  if (part->least == part->whole)
    return fmt::format("reached: all of {:.4g} {}\n", part->whole, part->unit);
  return fmt::format("reached: {:.4g} to {:.4g} {}, {:.3g} to {:.3g} % of the map\n", part->least,
                     part->most, part->unit, share(part->least), share(part->most));
}

}  // namespace

std::string summary_text(const tasks::StudyJob& job, const study::Summary& summary,
                         const TableStyle& style) {
  Table table({"<output", "unit", "mean", "deviation", "least", "1 %", "5 %", "50 %", "95 %",
               "99 %", "most", "<95 % interval of 5 %"});
  for (std::size_t k = 0; k < summary.outputs.size(); ++k) {
    const auto& output = summary.outputs[k];
    const auto& column = job.problem.outputs[k];
    if (static_cast<int>(k) == job.problem.status || output.count == 0) continue;
    if (column.name == "direction") continue;
    std::vector<std::string> cells{column.name, column.unit, number_text(output.mean, column.unit),
                                   fmt::format("{:.3g}", output.deviation),
                                   number_text(output.least, column.unit)};
    for (const auto& quantile : output.quantiles)
      cells.push_back(number_text(quantile.value, column.unit));
    cells.push_back(number_text(output.most, column.unit));
    cells.push_back(interval_text(output.quantiles[1].interval, 1.0));
    table.add_row(cells);
  }
  return table.text(style) + status_text(summary) + motion_text(job, summary) +
         requirements_text(job, summary, style) + indices_text(job, summary, style);
}

std::string extremes_text(const tasks::StudyJob& job, const study::Summary& summary) {
  if (!job.poses) return {};
  const auto& outputs = job.problem.outputs;
  std::string text = reached_text(summary.reached);
  const auto add = [&](const char* name, const auto& words) {
    const auto column = std::ranges::find(outputs, name, &study::Column::name);
    if (column == outputs.end()) return;
    const auto k = static_cast<int>(column - outputs.begin());
    const auto& found = summary.outputs[static_cast<std::size_t>(k)];
    if (found.count == 0) return;
    const auto row = column->worse == study::Worse::more ? found.most_row : found.least_row;
    const WorstRow worst(job, row, k);
    text += fmt::format("{} at {} (row {}){}\n",
                        words([&](const char* other) { return worst.of(other); }), worst.inputs(),
                        row, between_text(job, found, *column));
  };
  const auto one = [](const char* words, const char* name, const char* unit) {
    return [=](const auto& of) { return fmt::format("{}: {:.4g}{}", words, of(name), unit); };
  };
  add("lowest", one("lowest frequency", "lowest", " Hz"));
  add("drop", [](const auto& of) {
    return fmt::format(
        "largest drop: {:.3g} % to {:.4g} Hz, {:.3g} % of the motion, peak {:.3g} "
        "times as high,",
        100.0 * of("drop"), of("lowest"), 100.0 * of("share"), of("peak"));
  });
  add("condition", one("largest condition", "condition", ""));
  add("stroke", [](const auto& of) {
    const double left = of("stroke");
    return left < 0.0 ? fmt::format("farthest beyond the stroke: {:.4g} m", -left)
                      : fmt::format("least stroke left: {:.4g} m", left);
  });
  const auto& machine = job.machine;
  for (const auto& column : study::extra_outputs(machine.file.machine, machine.kind)) {
    const char* end = column.worse == study::Worse::more ? "largest" : "least";
    add(column.name.c_str(), [&](const auto& of) {
      return fmt::format("{} {}: {}", end, column.name,
                         value_text(column, of(column.name.c_str())));
    });
  }
  return text.empty() ? text : text + "\n";
}

std::string worst_text(const tasks::StudyJob& job, const study::Summary& summary) {
  std::string text;
  for (std::size_t k = 0; k < job.requirements.size(); ++k) {
    const auto& worst = summary.requirements[k].worst;
    if (!worst) continue;
    const auto& column = job.problem.outputs[static_cast<std::size_t>(job.requirements[k].output)];
    const WorstRow row(job, *worst, job.requirements[k].output);
    const auto& output = summary.outputs[static_cast<std::size_t>(job.requirements[k].output)];
    const bool same_sense = job.requirements[k].at_least == (column.worse == study::Worse::less);
    text += fmt::format("worst for {}: row {}, {} = {}, with {}{}\n", job.requirements[k].text,
                        *worst, column.name, value_text(column, row.of(column.name)), row.inputs(),
                        same_sense ? between_text(job, output, column) : "");
  }
  return text;
}

}  // namespace hydrapod::cli
