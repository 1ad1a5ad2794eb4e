#include "twins.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

bool are_twins(const FittedMode& a, const FittedMode& b, const TwinOptions& options) {
  const double widths = std::abs(a.pole.real()) + std::abs(b.pole.real());
  const double reach = std::max(options.near * widths, options.apart * a.omega());
  return std::abs(a.pole.imag() - b.pole.imag()) < std::min(reach, options.closest) &&
         mac_matrix({a.shape}, {b.shape})(0, 0) > options.alike &&
         mac_matrix({a.participation}, {b.participation})(0, 0) > options.alike;
}

/// |φ| |L| by the half width: height of the resonance.
double height(const FittedMode& mode) {
  return mode.shape.norm() * mode.participation.norm() / std::abs(mode.pole.real());
}

/// False: too few responses, which have the same shape easily.
bool have_shapes(const FrequencyResponses& r) {
  constexpr Index told_by = 3;
  return std::ssize(r.outputs) * std::ssize(r.inputs) >= told_by;
}

/// [rad/s] of the widest window that is known.
double main_lobe(const FrequencyResponses& r) {
  constexpr double wide = 5.0;  // lines
  return r.lines() < 2 || !have_shapes(r)
             ? 0.0
             : wide * two_pi * (r.frequency.back() - r.frequency.front()) /
                   static_cast<double>(r.lines() - 1);
}

/// E|v|²/E|y − v|² around a mode, see MovedOptions. Averages alone know it.
double incoherence(const FrequencyResponses& r, const FittedMode& mode) {
  const double f = mode.omega() / two_pi, wide = mode.damping_ratio() * f;
  const double averages = r.degrees + static_cast<double>(r.inputs.size());
  const auto at = [&](double x) {
    const auto line = std::ranges::lower_bound(r.frequency, x) - r.frequency.begin();
    return std::min<Index>(line, static_cast<Index>(r.lines()) - 1);
  };
  VectorXd noise = VectorXd::Zero(std::ssize(r.outputs)), explained = noise;
  for (Index k = at(f - wide); k <= at(f + wide); ++k) {
    const auto line = static_cast<std::size_t>(k);
    const Eigen::LLT<MatrixXcd> Q(r.input_factor[line]);
    explained += Q.matrixL().solve(r.H[line].adjoint()).colwise().squaredNorm().transpose();
    noise += averages * r.noise[line].diagonal().real();
  }
  return noise.cwiseQuotient(explained.cwiseMax(1e-300)).minCoeff();
}

}  // namespace

std::vector<std::vector<std::size_t>> twin_groups(const std::vector<IdentifiedMode>& modes,
                                                  const TwinOptions& options) {
  std::vector<std::size_t> order(modes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t r) { return modes[r].fit.pole.imag(); });
  std::vector<std::vector<std::size_t>> groups;
  for (const auto r : order) {
    const auto own = std::ranges::find_if(groups, [&](const auto& group) {
      return are_twins(modes[group.back()].fit, modes[r].fit, options);
    });
    if (own == groups.end())
      groups.push_back({r});
    else
      own->push_back(r);
  }
  return groups;
}

Identification with_twins_merged(const Identification& found,
                                 const std::vector<std::vector<std::size_t>>& groups) {
  Identification merged = found;
  merged.modes.clear();
  for (const auto& group : groups) {
    const auto fit = [&](std::size_t r) -> const FittedMode& { return found.modes[r].fit; };
    const auto main =
        *std::ranges::max_element(group, {}, [&](std::size_t r) { return height(fit(r)); });
    auto mode = found.modes[main];
    if (group.size() > 1) {
      const auto &first = fit(group.front()), &last = fit(group.back());
      mode.fit.pole = {0.5 * (first.pole.real() + last.pole.real()) -
                           0.5 * (last.pole.imag() - first.pole.imag()),
                       0.5 * (first.pole.imag() + last.pole.imag())};
    }
    merged.modes.push_back(std::move(mode));
  }
  return merged;
}

bool has_twins(const Identification& found) {
  return std::ranges::any_of(twin_groups(found.modes, {.closest = main_lobe(found.responses)}),
                             [](const auto& group) { return group.size() > 1; });
}

namespace {

using Groups = std::vector<std::vector<std::size_t>>;

/// Names the modes of these groups, in the words of the first, where there are any.
void add_twins(ModeWarning::Kind kind, const Groups& groups, double share, Identification& result) {
  ModeWarning warning{.kind = kind, .share = share, .total = std::ssize(result.modes)};
  for (const auto& group : groups) {
    const auto &a = result.modes[group[0]].fit, &b = result.modes[group[1]].fit;
    if (warning.count == 0) {
      warning.from = a.omega() / two_pi;
      warning.to = b.omega() / two_pi;
      warning.value = 2.0 * std::abs(a.pole.imag() - b.pole.imag()) /
                      (std::abs(a.pole.real()) + std::abs(b.pole.real()));
    }
    warning.count += std::ssize(group);
  }
  if (warning.count > 0) result.warnings.push_back(warning);
}

/// Of averages of a record.
void warn_of_moved(const MovedOptions& options, Identification& result) {
  const auto& r = result.responses;
  if (!have_shapes(r) || !r.has_errors() || !(r.degrees > 0.0) || r.whole || !r.excitation.empty())
    return;
  Groups moved;
  double least = std::numeric_limits<double>::infinity();
  for (auto& group : twin_groups(result.modes, options.twins)) {
    if (group.size() < 2) continue;
    double largest = 0.0;
    for (const auto m : group) largest = std::max(largest, incoherence(r, result.modes[m].fit));
    if (!(largest > options.incoherent)) continue;
    least = std::min(least, largest);
    for (const auto m : group)
      result.modes[m].explained = std::min(result.modes[m].explained, options.quality);
    moved.push_back(std::move(group));
  }
  add_twins(ModeWarning::Kind::moved, moved, least / (1.0 + least), result);
}

}  // namespace

void warn_of_twins(const IdentifyOptions& options, Identification& result,
                   const MovedOptions& moved) {
  if (!result.errors_assumed) {
    warn_of_moved(moved, result);
    return;
  }
  constexpr double quality = 0.3;
  if (result.model.error < options.window.least_left) return;
  auto groups = twin_groups(result.modes, {.closest = main_lobe(result.responses)});
  std::erase_if(groups, [](const auto& group) { return group.size() < 2; });
  if (groups.empty()) return;
  // what made the twins is in all resonances
  for (auto& mode : result.modes) mode.explained = std::min(mode.explained, quality);
  add_twins(ModeWarning::Kind::twins, groups, 0.0, result);
}

}  // namespace hydrapod::identification
