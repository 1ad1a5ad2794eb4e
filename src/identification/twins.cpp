#include "twins.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

bool are_twins(const FittedMode& a, const FittedMode& b) {
  constexpr double alike = 0.98, near = 3.0;  // MAC; sums of half widths
  const double widths = std::abs(a.pole.real()) + std::abs(b.pole.real());
  return std::abs(a.pole.imag() - b.pole.imag()) < near * widths &&
         mac_matrix({a.shape}, {b.shape})(0, 0) > alike &&
         mac_matrix({a.participation}, {b.participation})(0, 0) > alike;
}

/// |φ| |L| by the half width: height of the resonance.
double height(const FittedMode& mode) {
  return mode.shape.norm() * mode.participation.norm() / std::abs(mode.pole.real());
}

/// [rad/s] of the widest window that is known; 0: too few responses, which have the same shape
/// easily.
double main_lobe(const FrequencyResponses& r) {
  constexpr double wide = 5.0;  // lines
  constexpr Index told_by = 3;
  return r.lines() < 2 || std::ssize(r.outputs) * std::ssize(r.inputs) < told_by
             ? 0.0
             : wide * two_pi * (r.frequency.back() - r.frequency.front()) /
                   static_cast<double>(r.lines() - 1);
}

}  // namespace

std::vector<std::vector<std::size_t>> twin_groups(const std::vector<IdentifiedMode>& modes,
                                                  double closest) {
  std::vector<std::size_t> order(modes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t r) { return modes[r].fit.pole.imag(); });
  std::vector<std::vector<std::size_t>> groups;
  for (const auto r : order) {
    const auto own = std::ranges::find_if(groups, [&](const auto& group) {
      const auto &a = modes[group.back()].fit, &b = modes[r].fit;
      return b.pole.imag() - a.pole.imag() < closest && are_twins(a, b);
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
  return std::ranges::any_of(twin_groups(found.modes, main_lobe(found.responses)),
                             [](const auto& group) { return group.size() > 1; });
}

void warn_of_twins(const IdentifyOptions& options, Identification& result) {
  constexpr double quality = 0.3;
  const auto& r = result.responses;
  if (!result.errors_assumed || result.model.error < options.window.least_left) return;
  ModeWarning warning{.kind = ModeWarning::Kind::twins, .total = std::ssize(result.modes)};
  for (const auto& group : twin_groups(result.modes, main_lobe(r))) {
    if (group.size() < 2) continue;
    const auto &a = result.modes[group[0]].fit, &b = result.modes[group[1]].fit;
    if (warning.count == 0) {
      warning.from = a.omega() / two_pi;
      warning.to = b.omega() / two_pi;
      warning.value = 2.0 * std::abs(a.pole.imag() - b.pole.imag()) /
                      (std::abs(a.pole.real()) + std::abs(b.pole.real()));
    }
    warning.count += std::ssize(group);
  }
  if (warning.count == 0) return;
  // what made the twins is in all resonances
  for (auto& mode : result.modes) mode.explained = std::min(mode.explained, quality);
  result.warnings.push_back(warning);
}

}  // namespace hydrapod::identification
