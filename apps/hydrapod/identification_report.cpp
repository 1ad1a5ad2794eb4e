#include "hydrapod/reports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
constexpr double band = numerics::normal_half_width;

/// The outputs that move most, each in proportion to the size of its own responses.
std::string shape_text(const identification::IdentifiedMode& mode, const Eigen::VectorXd& size,
                       const std::vector<data::Channel>& outputs) {
  // of repeated modes the fit has some mixture
  const auto& shape = mode.repeated > 1 ? mode.displacement : mode.fit.shape;
  Eigen::VectorXd share = shape.cwiseAbs().cwiseQuotient(size);
  share /= share.maxCoeff();
  std::vector<int> order(outputs.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](int a, int b) { return share[a] > share[b]; });
  std::string text;
  constexpr double shown = 0.2;
  constexpr std::size_t most = 4;
  for (std::size_t k = 0; k < std::min(most, order.size()) && share[order[k]] >= shown; ++k) {
    const bool opposite = (shape[order[k]] * std::conj(shape[order[0]])).real() < 0.0;
    text += fmt::format("{}{}{} {:.2f}", k == 0 ? "" : ", ", opposite ? "−" : "",
                        outputs[static_cast<std::size_t>(order[k])].name, share[order[k]]);
  }
  return text;
}

std::string signed_percent(double share) {
  return fmt::format("{}{:.2f} %", share < 0.0 ? "−" : "+", std::abs(100.0 * share));
}

std::string hertz(double omega) { return fmt::format("{:.4f}", omega / two_pi); }

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
                        hertz(fit.omega()), percent(fit.damping_ratio()));
  }
  std::string quiet;  // modes that nobody expects to measure share a line
  for (const auto& left : compared.result.model_left) {
    const auto& mode = compared.result.model[static_cast<std::size_t>(left.model)];
    if (left.reason == observation::Unpaired::not_felt) {
      quiet += (quiet.empty() ? "" : ", ") + hertz(mode.omega());
      continue;
    }
    text += fmt::format("Not measured: {} Hz, {} of critical, {}: {}.\n", hertz(mode.omega()),
                        percent(mode.damping_ratio()),
                        compared.labels[static_cast<std::size_t>(left.model)],
                        report::words(left.reason));
  }
  if (!quiet.empty()) text += fmt::format("Not measured, local seal modes: {} Hz.\n", quiet);
  return text;
}

}  // namespace

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
  Eigen::VectorXd size =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(result.responses.outputs.size()));
  for (const auto& H : result.responses.H) size += H.rowwise().squaredNorm();
  size = size.cwiseSqrt().cwiseMax(1e-300);
  for (std::size_t r = 0; r < result.modes.size(); ++r) {
    const auto& m = result.modes[r];
    std::vector<std::string> row{fmt::format("{}", r + 1),
                                 hertz(m.fit.omega()),
                                 fmt::format("{:.2g}", band * m.fit.omega_deviation / two_pi),
                                 percent(m.fit.damping_ratio()),
                                 fmt::format("{:.2g} %", 100.0 * band * m.fit.damping_deviation),
                                 shape_text(m, size, result.responses.outputs),
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
  text += "\n" + table.text(style.colour, style.width);
  text += fmt::format("\n± is half the 95 % interval. Error of the synthesised responses: {:.2g} %",
                      100.0 * result.model.error);
  if (result.model.misfit > 0.0)
    text += fmt::format(", {:.2f} times their noise (mean square)", result.model.misfit);
  text += ".\n";
  if (checks.bootstrap)
    text += fmt::format(
        "Bootstrap: {} resamples of {} groups of blocks, relative uncertainty {:.0f} %.\n",
        checks.bootstrap->resamples, checks.bootstrap->groups,
        100.0 / std::sqrt(2.0 * (checks.bootstrap->groups - 1.0)));
  for (const auto& m : result.heavily_damped)
    text += fmt::format(
        "Heavily damped pole, not counted as a mode: {:.3f} Hz, damping ratio {:.0f} %.\n",
        m.omega() / two_pi, 100.0 * m.damping_ratio());
  return text;
}

std::string comparison_text(const report::ComparedModes& compared,
                            const identification::Identification& result, const TableStyle& style) {
  std::string text = fmt::format("\nCompared with {}\n", report::comparison_heading(compared));
  const auto& c = compared.result;
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
      table.add_row({fmt::format("{}", p.measured + 1), hertz(fit.omega()), hertz(mode.omega()),
                     signed_percent(p.frequency_difference), percent(fit.damping_ratio()),
                     percent(mode.damping_ratio()), signed_percent(p.damping_difference),
                     p.mac ? fmt::format("{:.3f}", *p.mac) : "–",
                     compared.labels[static_cast<std::size_t>(p.model)]});
    }
    text += "\n" + table.text(style.colour, style.width);
  }
  return text + "\n" + left_text(compared, result);
}

std::string output_only_text(const std::vector<identification::OutputOnlyMode>& modes,
                             std::size_t outputs, int block, const TableStyle& style) {
  std::string text = fmt::format(
      "{} outputs, no input: covariance-driven subspace identification, blocks of {} samples\n",
      outputs, block);
  if (modes.empty()) return text + "\nno stable pole\n";
  Table table({"mode", "Hz", "scatter", "damping", "scatter", "MPC", "quality"});
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const auto& mode = modes[r];
    const double omega = std::abs(mode.pole);
    table.add_row({fmt::format("{}", r + 1), hertz(omega), hertz(mode.frequency_scatter * omega),
                   percent(-mode.pole.real() / omega), percent(mode.damping_scatter),
                   fmt::format("{:.3f}", mode.mpc), fmt::format("{:.2f}", mode.persistence)});
  }
  return text + "\n" + table.text(style.colour, style.width) +
         "\nscatter: over model orders; this is not a confidence interval\n";
}

}  // namespace hydrapod::cli
