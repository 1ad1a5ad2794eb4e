#include "hydrapod/reports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::cli {

namespace {

using namespace calibration;
using observation::ModeTarget;
using observation::Targets;

using base::two_pi;

std::string combinations_text(const Calibration& result, const TableStyle& style) {
  if (result.candidates.size() < 2) return {};
  Table table({"<combination", "rms diff", "max diff Hz", "rad/s", "<admissible", "starts"});
  for (const auto& c : result.candidates) {
    if (!c.fitted) {
      table.add_row({c.name, "-", "-", "-", c.problem});
      continue;
    }
    const double rms = std::sqrt(c.misfit / static_cast<double>(c.targets.size()));
    table.add_row({c.name, fmt::format("{:.3g} σ", rms), fmt::format("{:.4g}", c.worst / two_pi),
                   fmt::format("{:.4g}", c.worst), c.admissible() ? "yes" : "no",
                   fmt::format("{} of {}", c.starts_that_agree, c.starts)});
  }
  std::string text = table.text(style);
  for (const auto& c : result.candidates) {
    if (!c.unbound) continue;
    const double rms = std::sqrt(c.unbound->misfit / static_cast<double>(c.targets.size()));
    constexpr double better = 0.5;  // of the misfit
    if (c.unbound->misfit > better * c.misfit) {
      text +=
          fmt::format("\n{}: no values outside the bounds or conditions fit much better\n", c.name);
      continue;
    }
    text += fmt::format("\n{}: without bounds and conditions, {:.3g} σ", c.name, rms);
    if (c.unbound->violated.empty()) {
      text += ", outside the bounds\n";
      continue;
    }
    text += ", which violates:\n";
    for (const auto& what : c.unbound->violated) text += "  - " + what + "\n";
  }
  return bold("Combinations, best first", style) + "\n" + text + "\n";
}

/// Of which modes the frequencies are.
std::string frequencies_text(const Targets& targets) {
  const bool amplitudes =
      std::ranges::any_of(targets.modes, [](const auto& mode) { return mode.amplitude > 0.0; });
  const char* end = amplitudes ? "; at an amplitude those of the harmonic balance\n" : "\n";
  const auto damped = std::ranges::count_if(targets.modes, &ModeTarget::damped);
  if (damped == std::ssize(targets.modes)) return std::string("Hz: |λ| of damped modes") + end;
  if (damped == 0) return std::string("Hz: of undamped modes") + end;
  return fmt::format("Hz: |λ| of damped modes in {} targets, of undamped modes in {}{}", damped,
                     std::ssize(targets.modes) - damped, end);
}

std::string targets_text(const Candidate& best, const Targets& targets, const TableStyle& style) {
  const bool damping = std::any_of(targets.modes.begin(), targets.modes.end(),
                                   [](const ModeTarget& t) { return t.damping.has_value(); });
  const bool shapes = std::any_of(targets.modes.begin(), targets.modes.end(),
                                  [](const ModeTarget& t) { return t.shape.has_value(); });
  std::vector<Column> columns{"<target",  "<pose",   "mode",  "target Hz",
                              "model Hz", "diff Hz", "diff σ"};
  if (damping) columns.insert(columns.end(), {"target ζ %", "model ζ %"});
  if (shapes) columns.push_back("MAC");
  columns.push_back("<");
  Table table(columns);
  for (std::size_t i = 0; i < best.targets.size(); ++i) {
    const auto& target = targets.modes[i];
    const auto& fit = best.targets[i];
    std::vector<std::string> row{target.name,
                                 place_text(target.pose, target.amplitude),
                                 fmt::format("{}", fit.mode + 1),
                                 hertz(target.omega, 4),
                                 hertz(fit.omega, 4),
                                 fmt::format("{:+.4f}", (fit.omega - target.omega) / two_pi),
                                 fmt::format("{:+.2f}", fit.difference)};
    if (damping) {
      row.push_back(target.damping ? fmt::format("{:.3g}", 100.0 * *target.damping) : "");
      row.push_back(target.damping ? fmt::format("{:.3g}", 100.0 * fit.damping) : "");
    }
    if (shapes) row.push_back(target.shape ? fmt::format("{:.3f}", fit.shape_mac) : "");
    row.push_back(fit.outlier ? "outlier, left out" : "");
    table.add_row(row);
  }
  return bold("Targets", style) + "\n" + table.text(style) + frequencies_text(targets);
}

/// As the machine file writes the number, of one leg as that of all legs where it writes none of
/// this leg; else in SI.
model::WrittenUnit unit_of(const FittedParameter& p, const std::string& machine_text) {
  const std::string& path = p.paths.front();
  auto unit = model::written_unit(machine_text, path, p.unit);
  constexpr std::string_view of_one_leg = "leg.";
  if (unit.name.empty() && path.starts_with(of_one_leg))
    if (const auto rest = path.find('.', of_one_leg.size()); rest != std::string::npos)
      unit = model::written_unit(machine_text, "legs" + path.substr(rest), p.unit);
  if (unit.name.empty() && p.unit != "1") unit.name = p.unit;
  return unit;
}

std::string interval_text(const FittedParameter& p, double size) {
  if (!std::isfinite(p.interval_high) || !std::isfinite(p.interval_low)) return "";
  return fmt::format("{:.4g} … {:.4g}", p.interval_low / size, p.interval_high / size);
}

std::string parameters_text(const Candidate& best, const std::string& machine_text,
                            const TableStyle& style) {
  Table table({"<parameter", "start", "value", "<unit", "± ", "95 % interval", "<"});
  for (const auto& p : best.parameters) {
    const auto unit = unit_of(p, machine_text);
    const bool known = p.verdict == calibration::Verdict::determined ||
                       p.verdict == calibration::Verdict::by_prior;
    table.add_row({fmt::format("{}", fmt::join(p.paths, " = ")),
                   fmt::format("{:.4g}", p.start / unit.size),
                   fmt::format("{:.6g}", p.value / unit.size), unit.name,
                   known ? fmt::format("{:.2g}", p.deviation / unit.size) : "",
                   known ? interval_text(p, unit.size) : "", report::verdict_word(p.verdict)});
  }
  return bold("Parameters", style) + "\n" + table.text(style);
}

std::string correlations_text(const Candidate& best) {
  constexpr double strong = 0.9;
  std::string text;
  const auto& C = best.identifiability.correlations;
  for (Eigen::Index a = 0; a < C.rows(); ++a)
    for (Eigen::Index b = 0; b < a; ++b)
      if (std::abs(C(a, b)) > strong &&
          best.parameters[static_cast<std::size_t>(a)].verdict == Verdict::determined &&
          best.parameters[static_cast<std::size_t>(b)].verdict == Verdict::determined)
        text += fmt::format("  - {} and {} are correlated by {:+.2f}\n",
                            best.parameters[static_cast<std::size_t>(b)].paths.front(),
                            best.parameters[static_cast<std::size_t>(a)].paths.front(), C(a, b));
  return text;
}

/// "+0.71 xx, −0.52 stiffness": what a direction mostly consists of.
std::string direction_text(const Candidate& best, const Eigen::VectorXd& direction) {
  constexpr double worth_naming = 0.15;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(direction.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(direction[a]) > std::abs(direction[b]);
  });
  std::string text;
  const double sign = direction[order.front()] < 0.0 ? -1.0 : 1.0;
  for (const auto j : order) {
    const double part = sign * direction[j];
    if (std::abs(part) < worth_naming) break;
    text += fmt::format("{}{} {:.2f} {}", text.empty() ? "" : " ", part < 0.0 ? "−" : "+",
                        std::abs(part), best.parameters[static_cast<std::size_t>(j)].paths.front());
  }
  return text;
}

std::string identifiability_text(const Candidate& best, const TableStyle& style) {
  const auto& found = best.identifiability;
  std::string text = bold("Identifiability", style) + "\n";
  text += fmt::format(
      "{} of {} combinations of the parameters {} known within ± {:g} %. {} {} an effect on the "
      "data.\nEach line: relative uncertainty, and the combination as a weighted sum of relative "
      "changes:\n",
      found.rank, best.parameters.size(), found.rank == 1 ? "is" : "are", 100.0 * free_above,
      found.numerical_rank, found.numerical_rank == 1 ? "has" : "have");
  for (int k = 0; k < found.numerical_rank; ++k)
    text += fmt::format("  ± {:<9} {}\n",
                        fmt::format("{:.2g} %", 100.0 * best.scatter / found.singular_values[k]),
                        direction_text(best, found.directions.col(k)));
  if (!found.trades.empty()) text += "Not determined:\n";
  constexpr std::size_t most = 12;
  for (std::size_t k = 0; k < std::min(most, found.trades.size()); ++k)
    text += "  - " + found.trades[k].words + "\n";
  if (found.trades.size() > most)
    text += fmt::format("  - and {} more (--format json has all)\n", found.trades.size() - most);
  const auto correlations = correlations_text(best);
  if (!correlations.empty()) text += "Correlated parameters:\n" + correlations;
  return text;
}

std::string profiles_text(const std::vector<Profile>& profiles, const Candidate& best,
                          const std::string& machine_text, const TableStyle& style) {
  std::string text;
  for (const auto& profile : profiles) {
    const auto& p = best.parameters[static_cast<std::size_t>(profile.parameter)];
    const auto unit = unit_of(p, machine_text);
    const auto end = [&](double value) {
      return std::isfinite(value) ? fmt::format("{:.5g}", value / unit.size)
                                  : std::string("no limit within its bounds");
    };
    text += "\n" + bold("Profile of " + p.paths.front(), style) + "\n";
    text +=
        fmt::format("95 %: from {} to {}\n", end(profile.interval_low), end(profile.interval_high));
    Table table({{unit.name.empty() ? "value" : unit.name}, "misfit"});
    for (const auto& point : profile.points)
      table.add_row(
          {fmt::format("{:.6g}", point.value / unit.size), fmt::format("{:.4g}", point.misfit)});
    text += table.text(style);
  }
  return text;
}

}  // namespace

std::string calibration_text(const Calibration& result, const Targets& targets,
                             const std::vector<Profile>& profiles, const std::string& machine_text,
                             const TableStyle& style) {
  const auto& best = result.best();
  std::string text;
  if (!targets.title.empty()) text += bold(targets.title, style) + "\n\n";
  text += combinations_text(result, style);
  if (result.candidates.size() > 1) text += "Below: " + best.name + "\n\n";
  text += targets_text(best, targets, style) + "\n";
  text += parameters_text(best, machine_text, style) + "\n";
  text += style.detail(identifiability_text(best, style));
  text += style.detail(profiles_text(profiles, best, machine_text, style));
  const auto remarks = report::calibration_remarks(result, targets);
  if (!remarks.empty()) text += "\n" + bold("Mind", style) + "\n";
  for (const auto& remark : remarks) text += "  - " + remark + "\n";
  return text;
}

std::string sensitivity_text(const Sensitivities& s, const TableStyle& style) {
  std::vector<Column> columns{"<% of ω per % of"};
  for (const double omega : s.omega) columns.push_back(fmt::format("{:.2f} Hz", omega / two_pi));
  Table table(columns);
  std::vector<Eigen::Index> order(s.parameters.size());
  std::iota(order.begin(), order.end(), 0);
  const auto weight = [&](Eigen::Index j) {
    double most = 0.0;
    for (const double value : s.percent_per_percent.col(j))
      if (!std::isnan(value)) most = std::max(most, std::abs(value));
    return most;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return weight(a) > weight(b); });
  for (const auto j : order) {
    std::vector<std::string> row{s.parameters[static_cast<std::size_t>(j)].path};
    for (Eigen::Index k = 0; k < s.omega.size(); ++k) {
      const double value = s.percent_per_percent(k, j);
      row.push_back(std::isnan(value)        ? (s.omega[k] > 0.0 ? "overdamped" : "buckled")
                    : std::abs(value) < 5e-5 ? "·"
                                             : fmt::format("{:+.4f}", value));
    }
    table.add_row(row);
  }
  return table.text(style);
}

std::string sensitivity_csv(const Sensitivities& s) {
  std::string text = "mode,omega_rad_s,frequency_hz";
  for (const auto& p : s.parameters) text += "," + p.path;
  text += "\n";
  for (Eigen::Index k = 0; k < s.omega.size(); ++k) {
    text += fmt::format("{},{:.12g},{:.12g}", k + 1, s.omega[k], s.omega[k] / two_pi);
    for (Eigen::Index j = 0; j < s.percent_per_percent.cols(); ++j)
      text += fmt::format(",{:.9g}", s.percent_per_percent(k, j));
    text += "\n";
  }
  return text;
}

}  // namespace hydrapod::cli
