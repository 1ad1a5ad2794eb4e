#include "hydrapod/response/frequency_response.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hydrapod::response {

namespace {

constexpr int directions = 6;

/// φᵀ C φ of mode k, modal ratio included: 2ζω of a mode that is not coupled by dampers.
double modal_damping(const ResponseModel& model, int k) {
  const auto phi = model.modes.shapes.col(k);
  double damping = 2.0 * model.modal_ratio * model.modes.omega(k) + phi.dot(model.C * phi);
  for (const auto& arm : model.arms)
    damping += damper_at(arm, model.modes.omega(k)) * std::pow(phi.dot(arm.s_y), 2);
  return damping;
}

/// ω² of mode k with what the chambers relax there.
double relaxed_omega2(const ResponseModel& model, int k) {
  double omega2 = model.modes.omega2[k];
  if (!(omega2 > 0.0)) return omega2;
  const auto phi = model.modes.shapes.col(k);
  for (const auto& arm : model.arms)
    omega2 -= softening_at(arm, model.modes.omega(k)) * std::pow(phi.dot(arm.s_y), 2);
  return omega2;
}

/// Where mode k has its peak; 0 where it has none.
double peak_frequency(const ResponseModel& model, int k) {
  const double omega2 = relaxed_omega2(model, k);
  return omega2 > 0.0 ? std::sqrt(omega2) : 0.0;
}

/// Drops points that lie closer to their neighbour than `spacing` times their frequency: between
/// such the response differs by less than its rounding, and a bracket of them need not hold the
/// top.
void thin_out(std::vector<double>& grid, double spacing) {
  size_t kept = 0;
  for (size_t i = 1; i < grid.size(); ++i)
    if (grid[i] - grid[kept] > spacing * grid[i]) grid[++kept] = grid[i];
  grid.resize(kept + 1);
}

/// A logarithmic grid with, around every mode, points as dense as its half-power bandwidth asks.
std::vector<double> peak_grid(const ResponseModel& model, const PeakOptions& options) {
  std::vector<double> grid = log_space(options.from, options.to, 2000);
  double narrowest = 1.0;  // half bandwidth over frequency
  for (int k = 0; k < model.modes.size(); ++k) {
    const double omega = peak_frequency(model, k);
    if (omega <= 0.0) continue;
    const double half_band = std::max(0.5 * modal_damping(model, k), 1e-6 * omega);
    narrowest = std::min(narrowest, half_band / omega);
    constexpr int per_side = 40;
    for (int j = -per_side; j <= per_side; ++j) {
      const double at = omega + 0.2 * half_band * j;
      if (at > options.from && at < options.to) grid.push_back(at);
    }
  }
  std::sort(grid.begin(), grid.end());
  thin_out(grid, 0.01 * narrowest);
  return grid;
}

double magnitude_at(const ResponseModel& model, double omega, int direction, Output output) {
  return std::abs(frequency_response(model, {&omega, 1}, output)[0](direction, direction));
}

/// Where the magnitude is largest inside [low, high].
double refine(const ResponseModel& model, double low, double high, int direction, Output output) {
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  // a tolerance is one of the place in the bracket, which is narrow
  const auto loss = [&](double place) {
    return -magnitude_at(model, middle + half * place, direction, output);
  };
  constexpr int bits = std::numeric_limits<double>::digits / 2;
  return middle + half * boost::math::tools::brent_find_minima(loss, -1.0, 1.0, bits).first;
}

/// Height above the higher of the lowest points towards higher ground on either side; a side that
/// never rises above the peak does not count, as long as one side does.
double prominence(const std::vector<double>& magnitude, size_t peak) {
  const double height = magnitude[peak];
  double base = 0.0;
  double lowest = height;
  for (size_t i = peak; i-- > 0;) {
    lowest = std::min(lowest, magnitude[i]);
    if (magnitude[i] > height) {
      base = std::max(base, lowest);
      break;
    }
  }
  lowest = height;
  for (size_t i = peak + 1; i < magnitude.size(); ++i) {
    lowest = std::min(lowest, magnitude[i]);
    if (magnitude[i] > height) {
      base = std::max(base, lowest);
      break;
    }
  }
  if (base == 0.0) return std::numeric_limits<double>::infinity();
  return 20.0 * std::log10(height / base);
}

/// Without damping a direction has an unbounded peak at every mode that takes part in it; those
/// that hold less than 1e-4 of its static compliance are not felt in it.
std::vector<Peak> undamped_peaks(const ResponseModel& model, const PeakOptions& options) {
  constexpr double least_share = 1e-4;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const auto& modes = model.modes;
  std::vector<Peak> peaks;
  for (int d = 0; d < directions; ++d) {
    const dynamics::ModelVector compliance =
        modes.shapes.row(d).transpose().cwiseAbs2().cwiseQuotient(modes.omega2).cwiseAbs();
    for (int k = 0; k < modes.size(); ++k) {
      const double omega = modes.omega(k);
      if (omega <= options.from || omega >= options.to) continue;
      if (compliance[k] < least_share * compliance.sum()) continue;
      peaks.push_back({d, omega, infinite, infinite, k, model.mode_direction[k] == d});
    }
  }
  return peaks;
}

}  // namespace

int mode_behind(const ResponseModel& model, double omega, int output, int input) {
  const ModelMatrix& Phi = model.modes.shapes;
  int leader = -1, nearest = 0;
  double largest = 0.0, least_distance = std::numeric_limits<double>::infinity();
  for (int k = 0; k < model.modes.size(); ++k) {
    const auto phi = Phi.col(k);
    const double gamma = modal_damping(model, k);
    const double distance = std::abs(peak_frequency(model, k) - omega);
    if (distance < least_distance) {
      least_distance = distance;
      nearest = k;
    }
    if (distance > 3.0 * gamma + 0.01 * omega) continue;
    const double term =
        std::abs(phi[output] * phi[input]) /
        std::hypot(relaxed_omega2(model, k) - omega * omega, gamma * omega + 1e-300);
    if (term > largest) {
      largest = term;
      leader = k;
    }
  }
  return leader >= 0 ? leader : nearest;
}

std::vector<LinePeak> line_peaks(const std::vector<double>& magnitude, double min_prominence_db) {
  std::vector<LinePeak> peaks;
  for (size_t i = 1; i + 1 < magnitude.size(); ++i) {
    if (!(magnitude[i] > magnitude[i - 1] && magnitude[i] >= magnitude[i + 1])) continue;
    const double height = prominence(magnitude, i);
    if (height >= min_prominence_db) peaks.push_back({i, height});
  }
  return peaks;
}

std::vector<Peak> find_peaks(const ResponseModel& model, const PeakOptions& options) {
  if (!(options.from > 0.0) || !(options.to > options.from))
    throw std::invalid_argument("find_peaks: needs 0 < from < to");
  if (model.modal_ratio == 0.0 && model.C.isZero(0.0) && model.arms.empty())
    return undamped_peaks(model, options);
  const auto grid = peak_grid(model, options);
  const auto H = frequency_response(model, grid, options.output);
  std::vector<Peak> peaks;
  std::vector<double> magnitude(grid.size());
  for (int d = 0; d < directions; ++d) {
    for (size_t i = 0; i < grid.size(); ++i) magnitude[i] = std::abs(H[i](d, d));
    for (const auto& [i, height] : line_peaks(magnitude, options.min_prominence_db)) {
      const double omega = refine(model, grid[i - 1], grid[i + 1], d, options.output);
      const int mode = mode_behind(model, omega, d, d);
      peaks.push_back({d, omega, magnitude_at(model, omega, d, options.output), height, mode,
                       model.mode_direction[mode] == d});
    }
  }
  return peaks;
}

int count_own(const std::vector<Peak>& peaks, int direction) {
  return static_cast<int>(std::count_if(peaks.begin(), peaks.end(), [&](const Peak& peak) {
    return peak.own && peak.direction == direction;
  }));
}

}  // namespace hydrapod::response
