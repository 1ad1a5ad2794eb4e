#include "mode_differences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hydrapod/base/units.hpp"

namespace hydrapod::tasks {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Verdict = report::TestedDifference::Verdict;

/// Shapes of both sides on the same outputs, in units of one metric.
struct SharedShapes {
  MatrixXcd first{}, second{};
  std::string text{};
};

MatrixXcd columns_of(const Side& side, const std::vector<int>& outputs) {
  MatrixXcd shapes(static_cast<Index>(outputs.size()), static_cast<Index>(side.modal.modes.size()));
  for (Index k = 0; k < shapes.cols(); ++k)
    shapes.col(k) = side.modal.modes[static_cast<std::size_t>(k)].shape(outputs);
  return shapes;
}

/// What the outputs `channels` would show of a calculated side.
MatrixXcd shown_by(const Side& side, const std::vector<data::Channel>& channels,
                   const MatrixXd& map) {
  MatrixXcd shapes(map.rows(), static_cast<Index>(side.base.size()));
  for (Index k = 0; k < shapes.cols(); ++k)
    for (Index o = 0; o < map.rows(); ++o) {
      const auto mode = static_cast<std::size_t>(k);
      const observation::Vector6c motion =
          data::against_ground(channels[static_cast<std::size_t>(o)])
              ? observation::Vector6c(side.modal.modes[mode].shape)
              : side.base[mode];
      shapes(o, k) = map.row(o).cast<std::complex<double>>() * motion;
    }
  return shapes;
}

MatrixXd metric_at(const observation::ComparisonFrame& frame, const MatrixXd& map) {
  return observation::output_metric(
      map,
      observation::platform_metric(frame.machine, frame.X_BP, frame.machine.platform.mass_center));
}

/// Where no machine is known: outputs of one unit in proportion to the motions in that unit, of all
/// modes of both sides with shapes of length one.
MatrixXd metric_of_units(const std::vector<data::Channel>& channels, const MatrixXcd& a,
                         const MatrixXcd& b) {
  std::map<std::string, double> squares;
  for (const auto* shapes : {&a, &b}) {
    const MatrixXcd unit = shapes->colwise().normalized();
    for (Index o = 0; o < unit.rows(); ++o)
      squares[channels[static_cast<std::size_t>(o)].unit] += unit.row(o).squaredNorm();
  }
  MatrixXd root = MatrixXd::Zero(a.rows(), a.rows());
  for (Index o = 0; o < a.rows(); ++o) {
    const double square = squares[channels[static_cast<std::size_t>(o)].unit];
    root(o, o) = square > 0.0 ? 1.0 / std::sqrt(square) : 0.0;
  }
  return root;
}

/// A machine beside a measurement: on its outputs that see the platform.
SharedShapes on_measured_outputs(const Side& machine, const Side& measured) {
  const auto& all = measured.modal.outputs;
  const MatrixXd map = observation::output_map(all, *machine.frame);
  std::vector<int> outputs;
  std::vector<data::Channel> channels;
  for (Index o = 0; o < map.rows(); ++o)
    if (map.row(o).allFinite()) {
      outputs.push_back(static_cast<int>(o));
      channels.push_back(all[static_cast<std::size_t>(o)]);
    }
  if (outputs.empty())
    return {.text = "no shapes: no output has a direction of the platform or a leg"};
  const MatrixXd some = map(outputs, Eigen::all), root = metric_at(*machine.frame, some);
  return {root * shown_by(machine, channels, some), root * columns_of(measured, outputs),
          fmt::format("{} outputs, in the metric of the platform's mass", outputs.size())};
}

/// On outputs of the same name and unit.
SharedShapes on_common_outputs(const Side& a, const Side& b) {
  std::vector<int> of_a, of_b;
  std::vector<data::Channel> channels;
  for (std::size_t i = 0; i < a.modal.outputs.size(); ++i)
    for (std::size_t j = 0; j < b.modal.outputs.size(); ++j)
      if (a.modal.outputs[i].name == b.modal.outputs[j].name) {
        of_a.push_back(static_cast<int>(i));
        of_b.push_back(static_cast<int>(j));
        channels.push_back(a.modal.outputs[i]);
      }
  if (channels.size() < 2) return {.text = "no shapes: fewer than two outputs have the same name"};
  const MatrixXcd first = columns_of(a, of_a), second = columns_of(b, of_b);
  for (const auto* frame : {&a.frame, &b.frame}) {
    if (!*frame) continue;
    const MatrixXd map = observation::output_map(channels, **frame);
    if (!map.allFinite()) continue;
    const MatrixXd root = metric_at(**frame, map);
    return {root * first, root * second,
            fmt::format("{} outputs, in the metric of the platform's mass", channels.size())};
  }
  const MatrixXd root = metric_of_units(channels, first, second);
  return {root * first, root * second,
          fmt::format("{} outputs, each unit in proportion to its motions", channels.size())};
}

SharedShapes shared_shapes(const Side& a, const Side& b) {
  if (a.calculated && !b.calculated && a.frame) return on_measured_outputs(a, b);
  if (b.calculated && !a.calculated && b.frame) {
    auto shapes = on_measured_outputs(b, a);
    std::swap(shapes.first, shapes.second);
    return shapes;
  }
  return on_common_outputs(a, b);
}

std::vector<std::complex<double>> poles_of(const Side& side) {
  std::vector<std::complex<double>> poles;
  for (const auto& mode : side.modal.modes) poles.push_back(mode.pole);
  return poles;
}

report::TestedDifference difference(double first, double second, bool first_calculated,
                                    bool second_calculated, std::optional<double> first_deviation,
                                    std::optional<double> second_deviation) {
  report::TestedDifference d{.value = second - first};
  if (first_calculated && second_calculated) {
    d.verdict = Verdict::calculated;
    return d;
  }
  if ((!first_calculated && !first_deviation) || (!second_calculated && !second_deviation))
    return d;
  d.deviation = std::hypot(first_deviation.value_or(0.0), second_deviation.value_or(0.0));
  d.p = std::erfc(std::abs(d.value / *d.deviation) / std::sqrt(2.0));
  d.verdict = Verdict::not_significant;
  return d;
}

/// Holm's method.
void judge(std::vector<report::TestedDifference*> tests, double level) {
  std::erase_if(tests, [](const auto* test) { return !test->p; });
  std::ranges::sort(tests, {}, [](const auto* test) { return *test->p; });
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (*tests[i]->p > level / static_cast<double>(tests.size() - i)) return;
    tests[i]->verdict = Verdict::significant;
  }
}

std::vector<int> left_over(std::size_t count, const std::vector<observation::ListedPair>& pairs,
                           int observation::ListedPair::*which) {
  std::vector<int> left;
  for (int k = 0; k < static_cast<int>(count); ++k)
    if (std::ranges::none_of(pairs, [&](const auto& pair) { return pair.*which == k; }))
      left.push_back(k);
  return left;
}

}  // namespace

double frequency_deviation(const data::ModalResult& mode, double line_spacing) {
  constexpr double of_a_line = 0.05;
  const double mixed =
      (1.0 - data::modal_phase_collinearity(mode.shape)) * mode.damping_ratio() * mode.omega();
  return std::hypot(mode.omega_deviation, mixed, of_a_line * base::two_pi * line_spacing);
}

report::ThingComparison compare_sides(const Side& first, const Side& second, double level) {
  const auto shapes = shared_shapes(first, second);
  observation::ObservationOptions options;
  // Calculated shapes are exact: the frequency of a mode may move by a factor three before it
  // counts as another one.
  constexpr double wide = 0.3;
  if (first.calculated && second.calculated && shapes.first.rows() > 0)
    options.frequency_scale = wide;
  const auto pairs = observation::pair_lists({poles_of(first), shapes.first},
                                             {poles_of(second), shapes.second}, options);
  report::ThingComparison comparison{.shapes = shapes.text};
  for (const auto& pair : pairs) {
    const auto& a = first.thing.modes[static_cast<std::size_t>(pair.first)];
    const auto& b = second.thing.modes[static_cast<std::size_t>(pair.second)];
    comparison.pairs.push_back(
        {.first = pair.first,
         .second = pair.second,
         .mac = pair.mac,
         .frequency = difference(a.omega, b.omega, first.calculated, second.calculated,
                                 a.omega_deviation, b.omega_deviation),
         .damping = difference(a.damping_ratio, b.damping_ratio, first.calculated,
                               second.calculated, a.damping_deviation, b.damping_deviation)});
  }
  std::vector<report::TestedDifference*> tests;
  for (auto& pair : comparison.pairs) {
    tests.push_back(&pair.frequency);
    tests.push_back(&pair.damping);
  }
  judge(tests, level);
  using observation::ListedPair;
  comparison.first_left = left_over(first.thing.modes.size(), pairs, &ListedPair::first);
  comparison.second_left = left_over(second.thing.modes.size(), pairs, &ListedPair::second);
  return comparison;
}

}  // namespace hydrapod::tasks
