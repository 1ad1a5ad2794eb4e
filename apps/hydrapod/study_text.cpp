#include "hydrapod/study_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
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

/// "x = 0.1 m, rz = 0.02 rad": the inputs of a row.
std::string inputs_text(const tasks::StudyJob& job, std::span<const double> values) {
  std::string text;
  for (std::size_t i = 0; i < job.problem.inputs.size(); ++i)
    text += fmt::format("{}{} = {:.5g} {}", i > 0 ? ", " : "", job.problem.inputs[i].name,
                        values[i], job.problem.inputs[i].unit);
  return text;
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
  return table.text(style) + status_text(summary) + requirements_text(job, summary, style) +
         indices_text(job, summary, style);
}

std::string extremes_text(const tasks::StudyJob& job, const study::Summary& summary) {
  if (!job.poses) return {};
  const auto& outputs = job.problem.outputs;
  std::string text;
  const auto add = [&](const char* name, bool most, const auto& words) {
    const auto column = std::ranges::find(outputs, name, &study::Column::name);
    if (column == outputs.end()) return;
    const auto& found = summary.outputs[static_cast<std::size_t>(column - outputs.begin())];
    if (found.count == 0) return;
    const auto row = most ? found.most_row : found.least_row;
    const auto values = tasks::study_row(job, row);
    const auto of = [&](const char* other) {
      const auto at = std::ranges::find(outputs, other, &study::Column::name) - outputs.begin();
      return values[job.problem.inputs.size() + static_cast<std::size_t>(at)];
    };
    text += fmt::format("{} at {} (row {})\n", words(of), inputs_text(job, values), row);
  };
  const auto one = [](const char* words, const char* name, const char* unit) {
    return [=](const auto& of) { return fmt::format("{}: {:.4g}{}", words, of(name), unit); };
  };
  add("lowest", false, one("lowest frequency", "lowest", " Hz"));
  add("drop", true, [](const auto& of) {
    return fmt::format(
        "largest drop: {:.3g} % to {:.4g} Hz, {:.3g} % of the motion, peak {:.3g} "
        "times as high,",
        100.0 * of("drop"), of("lowest"), 100.0 * of("share"), of("peak"));
  });
  add("condition", true, one("largest condition", "condition", ""));
  add("stroke", false, [](const auto& of) {
    const double left = of("stroke");
    return left < 0.0 ? fmt::format("farthest beyond the stroke: {:.4g} m", -left)
                      : fmt::format("least stroke left: {:.4g} m", left);
  });
  add("buckling", false, one("least buckling payload", "buckling", " kg"));
  return text.empty() ? text : text + "\n";
}

std::string worst_text(const tasks::StudyJob& job, const study::Summary& summary) {
  std::string text;
  for (std::size_t k = 0; k < job.requirements.size(); ++k) {
    const auto& worst = summary.requirements[k].worst;
    if (!worst) continue;
    const auto values = tasks::study_row(job, *worst);
    const std::size_t inputs = job.problem.inputs.size();
    const auto output = static_cast<std::size_t>(job.requirements[k].output);
    text += fmt::format("worst for {}: row {}, {} = {:.4g} {}, with {}\n", job.requirements[k].text,
                        *worst, job.problem.outputs[output].name, values[inputs + output],
                        job.problem.outputs[output].unit, inputs_text(job, values));
  }
  return text;
}

}  // namespace hydrapod::cli
