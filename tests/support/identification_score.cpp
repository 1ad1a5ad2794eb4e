#include "support/identification_score.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace hydrapod::test {

namespace {

constexpr double normal_95 = 1.959964;

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? std::nan("") : *std::ranges::max_element(values);
}

double damping_ratio(std::complex<double> pole) { return -pole.real() / std::abs(pole); }

double share(int part, int whole) {
  return whole == 0 ? std::nan("") : static_cast<double>(part) / whole;
}

/// Radius, in standard deviations √E|φ̂ − φ|², that a complex normal number stays in with 95 %.
const double complex_95 = std::sqrt(-std::log(0.05));

}  // namespace

void ClassScore::add(const std::vector<TrueMode>& truth, const std::vector<FoundMode>& modes,
                     const SameMode& same) {
  ++seeds;
  wanted += static_cast<int>(truth.size());
  struct Pair {
    double apart;
    std::size_t t, m;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < truth.size(); ++t)
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const double apart = std::abs(std::abs(modes[m].pole) / std::abs(truth[t].pole) - 1.0);
      if (apart <= same.frequency) pairs.push_back({apart, t, m});
    }
  std::ranges::sort(pairs, {}, &Pair::apart);
  std::vector<bool> true_taken(truth.size(), false), taken(modes.size(), false);
  for (const auto& [apart, t, m] : pairs) {
    if (true_taken[t] || taken[m]) continue;
    true_taken[t] = taken[m] = true;
    ++found;
    const auto& mode = modes[m];
    const double omega = std::abs(truth[t].pole), zeta = damping_ratio(truth[t].pole);
    const double omega_off = std::abs(std::abs(mode.pole) - omega),
                 zeta_off = std::abs(damping_ratio(mode.pole) - zeta);
    frequency_errors.push_back(omega_off / omega);
    damping_errors.push_back(zeta_off / zeta);
    if (mode.omega_deviation > 0.0) {
      ++intervals;
      frequency_covered += omega_off <= normal_95 * mode.omega_deviation ? 1 : 0;
      damping_covered += zeta_off <= normal_95 * mode.damping_deviation ? 1 : 0;
    }
    const auto& shape = truth[t].shape;
    if (shape.size() == 0 || mode.shape.size() != shape.size() ||
        mode.shape_deviation.size() != shape.size())
      continue;
    // both scaled to 1 at the output where the true shape is largest, which then is no test
    Eigen::Index at = 0;
    shape.cwiseAbs().maxCoeff(&at);
    const auto found_at = mode.shape[at];
    for (Eigen::Index o = 0; o < shape.size(); ++o) {
      if (o == at) continue;
      const double off = std::abs(mode.shape[o] / found_at - shape[o] / shape[at]);
      // to first order, and without the correlation of the two, which the result does not tell
      const double deviation =
          std::hypot(mode.shape_deviation[o],
                     mode.shape_deviation[at] * std::abs(mode.shape[o] / found_at)) /
          std::abs(found_at);
      ++shape_intervals;
      shape_covered += off <= complex_95 * deviation ? 1 : 0;
    }
  }
  false_modes += static_cast<int>(std::ranges::count(taken, false));
}

double ClassScore::found_share() const { return share(found, wanted); }
double ClassScore::false_per_seed() const { return share(false_modes, seeds); }
double ClassScore::median_frequency_error() const { return median(frequency_errors); }
double ClassScore::largest_frequency_error() const { return largest(frequency_errors); }
double ClassScore::median_damping_error() const { return median(damping_errors); }
double ClassScore::largest_damping_error() const { return largest(damping_errors); }
double ClassScore::frequency_coverage() const { return share(frequency_covered, intervals); }
double ClassScore::damping_coverage() const { return share(damping_covered, intervals); }
double ClassScore::shape_coverage() const { return share(shape_covered, shape_intervals); }

std::string class_row(const std::string& name, const std::string& method, const ClassScore& s) {
  const auto percent = [](double x) {
    return std::isnan(x) ? std::string("–") : fmt::format("{:.3g}", 100.0 * x);
  };
  return fmt::format("| {} | {} | {} | {} of {} | {:.2f} | {} ({}) | {} ({}) | {} | {} | {} |",
                     name, method, s.seeds, s.found, s.wanted, s.false_per_seed(),
                     percent(s.median_frequency_error()), percent(s.largest_frequency_error()),
                     percent(s.median_damping_error()), percent(s.largest_damping_error()),
                     percent(s.frequency_coverage()), percent(s.damping_coverage()),
                     percent(s.shape_coverage()));
}

void print_class(const std::string& name, const std::string& method, const ClassScore& score) {
  fmt::print("{}\n", class_row(name, method, score));
  std::fflush(stdout);
}

std::vector<FoundMode> found_modes(const identification::Identification& identified) {
  std::vector<FoundMode> list;
  for (const auto& mode : identified.modes)
    list.push_back({mode.fit.pole, mode.fit.omega_deviation, mode.fit.damping_deviation,
                    mode.fit.shape, mode.fit.shape_deviation});
  return list;
}

std::vector<TrueMode> true_modes(const ModalSystem& system) {
  std::vector<TrueMode> list;
  for (const auto& mode : system.modes) list.push_back({mode.pole, mode.shape});
  return list;
}

std::vector<TrueMode> within_band(std::vector<TrueMode> modes, double from, double to) {
  std::erase_if(modes, [&](const TrueMode& mode) {
    const double f = std::abs(mode.pole) / (2.0 * std::numbers::pi);
    return f < from || f > to;
  });
  return modes;
}

void expect_honest(const ClassScore& score) {
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  EXPECT_GE(score.frequency_coverage(), 0.9);
  EXPECT_GE(score.damping_coverage(), 0.9);
}

}  // namespace hydrapod::test
