#include "hydrapod/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "evidence.hpp"
#include "predictions.hpp"

namespace hydrapod::diagnosis {

namespace {

using observation::Entry;
using observation::ResponseTarget;
using Columns = std::array<Eigen::Index, 6>;

/// Columns of forces and moments in the six directions; none where one is missing.
std::optional<Columns> direct_columns(const ResponseTarget& target) {
  if (target.entry != Entry::forces) return std::nullopt;
  Columns columns{};
  columns.fill(-1);
  for (Eigen::Index i = 0; i < target.inputs.cols(); ++i) {
    const spatial::Vector6 input = target.inputs.col(i).cwiseAbs();
    // a force beside the measured point is a moment there too
    const bool turns = input.head<3>().isZero(0.0);
    const spatial::Vector3 part = turns ? input.tail<3>() : input.head<3>();
    Eigen::Index axis = 0;
    if (part.maxCoeff(&axis) == 1.0 && part.sum() == 1.0)
      columns[static_cast<std::size_t>(axis + (turns ? 3 : 0))] = i;
  }
  if (std::ranges::count(columns, Eigen::Index{-1}) > 0) return std::nullopt;
  return columns;
}

/// Size of the motion in each direction.
spatial::Vector6 sizes(const Eigen::MatrixXcd& H, const std::optional<Columns>& direct) {
  spatial::Vector6 size = H.rowwise().norm();
  for (std::size_t d = 0; d < 6 && direct; ++d) {
    const auto row = static_cast<Eigen::Index>(d);
    size[row] = std::abs(H(row, (*direct)[d]));
  }
  return size;
}

/// As response_rest() of the calibration has it, before the factor.
Eigen::MatrixXcd predicted(const observation::Observation& seen, const ResponseTarget& target,
                           std::size_t line) {
  spatial::Matrix6 to_point = spatial::Matrix6::Identity();
  to_point.topRightCorner<3, 3>() =
      -spatial::skew(seen.mechanics.X_BP * target.point - seen.mechanics.p_BC);
  const Eigen::MatrixXd inputs =
      target.entry == Entry::forces ? to_point.transpose() * target.inputs : target.inputs;
  return to_point.cast<std::complex<double>>() *
         seen.response(target.s[line], target.entry, target.against,
                       target.window ? &*target.window : nullptr) *
         inputs.cast<std::complex<double>>();
}

/// The lines that are shown.
std::vector<std::size_t> lines_of(const ResponseTarget& target,
                                  const observation::Targets& measured, std::size_t most) {
  constexpr double below = 0.5, above = 1.5;
  double from = std::numeric_limits<double>::infinity(), to = 0.0;
  for (const auto& mode : measured.modes)
    if (mode.pose == target.pose) {
      from = std::min(from, below * mode.omega);
      to = std::max(to, above * mode.omega);
    }
  std::vector<std::size_t> inside, shown;
  for (std::size_t line = 0; line < target.s.size(); ++line)
    if (const double omega = target.s[line].imag(); omega >= from && omega <= to)
      inside.push_back(line);
  const std::size_t every = (inside.size() + most - 1) / std::max<std::size_t>(most, 1);
  for (std::size_t k = 0; k < inside.size(); k += every) shown.push_back(inside[k]);
  return shown;
}

/// exp of the mean of ln(measured/predicted).
double common_factor(const std::vector<double>& measured, const std::vector<double>& predicted) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < measured.size(); ++k)
    if (measured[k] > 0.0 && predicted[k] > 0.0) {
      sum += std::log(measured[k] / predicted[k]);
      ++count;
    }
  return count > 0 ? std::exp(sum / count) : 1.0;
}

void add_prediction(const observation::Observation& seen, const ResponseTarget& target,
                    const std::vector<std::size_t>& lines, const std::optional<Columns>& direct,
                    ResponseOverlay& overlay) {
  for (auto& curve : overlay.curves) curve.predicted.back().reserve(lines.size());
  for (const auto line : lines) {
    const auto size = sizes(predicted(seen, target, line), direct);
    for (auto& curve : overlay.curves) curve.predicted.back().push_back(size[curve.direction]);
  }
  if (!overlay.scaled) return;
  for (auto& curve : overlay.curves) {
    const double factor = common_factor(curve.measured, curve.predicted.back());
    for (double& value : curve.predicted.back()) value *= factor;
  }
}

}  // namespace

std::vector<ResponseOverlay> response_overlays(const model::MachineFile& file,
                                               const observation::Targets& measured,
                                               dynamics::ModelKind stated, const Diagnosis& found,
                                               const std::vector<std::size_t>& hypotheses,
                                               std::size_t most) {
  Predictions predictions(file, measured, stated);
  std::vector<ResponseOverlay> overlays;
  for (const auto& target : measured.responses) {
    const auto* pose = find_pose(file.machine, target.pose);
    const auto lines = lines_of(target, measured, most);
    if (pose == nullptr || lines.empty() || !can_enter(measured.observed, target.entry)) continue;
    const auto direct = direct_columns(target);
    ResponseOverlay overlay{.pose = target.pose,
                            .entry = target.entry,
                            .direct = direct.has_value(),
                            .scaled = target.entry != Entry::forces};
    for (int d = 0; d < 6; ++d) overlay.curves.push_back({.direction = d});
    for (const auto line : lines) {
      overlay.omega.push_back(target.s[line].imag());
      const auto size = sizes(target.H[line], direct);
      for (auto& curve : overlay.curves) curve.measured.push_back(size[curve.direction]);
    }
    for (const auto k : hypotheses) {
      const auto& hypothesis = found.hypotheses[k];
      for (auto& curve : overlay.curves) curve.predicted.emplace_back();
      if (hypothesis.by_mechanics && measured.observed != observation::Observed::mechanics)
        continue;
      const bool possible = if_possible([&] {
        const auto seen = predictions.seen(machine_of(file, hypothesis), hypothesis.kind, *pose);
        add_prediction(seen, target, lines, direct, overlay);
      });
      if (!possible)
        for (auto& curve : overlay.curves) curve.predicted.back().clear();
    }
    overlays.push_back(std::move(overlay));
  }
  return overlays;
}

}  // namespace hydrapod::diagnosis
