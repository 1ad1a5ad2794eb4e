#include "sensor_watch.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fit_covariance.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// The line of that frequency, if there is one.
std::optional<std::size_t> line_at(const FrequencyResponses& r, double frequency) {
  constexpr double same = 1e-9;
  const auto at = std::ranges::lower_bound(r.frequency, frequency * (1.0 - same));
  if (at == r.frequency.end() || *at > frequency * (1.0 + same)) return {};
  return static_cast<std::size_t>(at - r.frequency.begin());
}

/// Of a row of responses as a column.
MatrixXcd row_covariance(const FrequencyResponses& r, std::size_t line, Index output) {
  return r.noise[line](output, output).real() * r.input_factor[line].transpose();
}

/// `least`: of the density in the whole, per input.
bool is_excited(const FrequencyResponses& part, std::size_t line, const FrequencyResponses& whole,
                std::size_t of_whole, const VectorXd& least) {
  if (part.input_density.empty() || whole.input_density.empty()) return true;
  return (part.input_density[line].array() > least.array() * whole.input_density[of_whole].array())
      .all();
}

/// A part at a lower level is measured by its own: per input the density by that of the whole which
/// all but a few lines stay below, at most 1.
VectorXd level_of(const FrequencyResponses& part, const FrequencyResponses& whole, double lowest) {
  constexpr double few = 0.05;
  VectorXd level = VectorXd::Ones(std::ssize(whole.inputs));
  if (part.input_density.empty() || whole.input_density.empty()) return level;
  for (Index i = 0; i < level.size(); ++i) {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < part.lines(); ++k)
      if (const auto at = line_at(whole, part.frequency[k]);
          at && whole.input_density[*at][i] > 0.0)
        ratios.push_back(part.input_density[k][i] / whole.input_density[*at][i]);
    if (ratios.empty()) continue;
    const auto place =
        ratios.begin() + static_cast<std::ptrdiff_t>((1.0 - few) * std::ssize(ratios));
    const auto at = std::min(place, ratios.end() - 1);
    std::ranges::nth_element(ratios, at);
    level[i] = std::clamp(*at, lowest, 1.0);
  }
  return level;
}

/// Of two in the middle the one that is nearer to 1.
double middle_of(std::vector<double> values) {
  std::ranges::sort(values);
  const double upper = values[values.size() / 2], lower = values[(values.size() - 1) / 2];
  return std::abs(upper - 1.0) < std::abs(lower - 1.0) ? upper : lower;
}

/// `values` of which each is like the others in sign and, within `least_change`, in size: as many
/// as there are; of two such groups the one that is nearer to 1. Indices.
std::vector<std::size_t> largest_agreement(const std::vector<double>& values, double least_change) {
  std::vector<std::size_t> best;
  double best_distance = 0.0;
  for (const double value : values) {
    std::vector<std::size_t> like;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (values[k] / value > 0.0 &&
          std::abs(std::log(values[k] / value)) <= std::log1p(least_change))
        like.push_back(k);
    const double distance = std::abs(value - 1.0);
    if (like.size() < best.size() || (like.size() == best.size() && distance >= best_distance))
      continue;
    best = std::move(like);
    best_distance = distance;
  }
  return best;
}

}  // namespace

SensorWatch::Ratio SensorWatch::ratio_of(const FrequencyResponses& part, const VectorXd& level,
                                         Index output) const {
  const VectorXd least = options_.least_excitation * level,
                 least_of_first = options_.least_excitation * level_of_first_;
  double hh = 0.0, gg = 0.0, hg = 0.0;
  int lines = 0;
  for (std::size_t k = 0; k < first_->lines(); ++k) {
    const double f = first_->frequency[k];
    const auto other = line_at(part, f), of_whole = line_at(whole_, f);
    if (!other || !of_whole || !is_excited(*first_, k, whole_, *of_whole, least_of_first) ||
        !is_excited(part, *other, whole_, *of_whole, least))
      continue;
    const VectorXcd h = first_->H[k].row(output).transpose(),
                    g = part.H[*other].row(output).transpose();
    const MatrixXcd of_h = row_covariance(*first_, k, output),
                    of_g = row_covariance(part, *other, output);
    MatrixXcd M = of_h + of_g;
    M.diagonal().array() += std::pow(options_.finest, 2) * (h.squaredNorm() + g.squaredNorm());
    const Eigen::LLT<MatrixXcd> solver(M);
    if (solver.info() != Eigen::Success) continue;
    const VectorXcd of_first = solver.solve(h);
    hh += h.dot(of_first).real() - solver.solve(of_h).trace().real();
    gg += g.dot(solver.solve(g)).real() - solver.solve(of_g).trace().real();
    hg += g.dot(of_first).real();
    ++lines;
  }
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (lines < options_.fewest_lines || !(hh > 0.0) || !(gg > 0.0)) return {unknown, unknown, 0.0};
  const double numbers = static_cast<double>(lines) * static_cast<double>(part.inputs.size());
  const double variance =
      lines_in_step(part) *
      (0.5 / hh + 0.5 / gg + 0.25 * numbers * (1.0 / (hh * hh) + 1.0 / (gg * gg)));
  return {std::copysign(std::sqrt(gg / hh), hg), std::sqrt(variance), hg / std::sqrt(hh * gg)};
}

void SensorWatch::add(const FrequencyResponses& part, std::size_t label) {
  if (part.outputs.size() != whole_.outputs.size() || part.inputs.size() != whole_.inputs.size() ||
      !part.has_errors() || (first_ && part.shift != first_->shift))
    return;
  const auto in_band = within(part, whole_.frequency.front(), whole_.frequency.back());
  const VectorXd level = level_of(in_band, whole_, options_.lowest_level);
  std::vector<Ratio> ratios(part.outputs.size(), Ratio{1.0, 0.0, 1.0});
  if (first_) {
    for (std::size_t o = 0; o < ratios.size(); ++o)
      ratios[o] = ratio_of(in_band, level, static_cast<Index>(o));
  } else {
    first_ = in_band;
    level_of_first_ = level;
  }
  parts_.push_back(std::move(ratios));
  labels_.push_back(label);
}

/// Each by what most parts say. A part within which the sensor changed says what neither side of it
/// does, so that a median of all parts may be that of nobody.
std::vector<std::vector<SensorWatch::Ratio>> SensorWatch::against_most() const {
  auto all = parts_;
  for (std::size_t o = 0; o < all[0].size(); ++o) {
    std::vector<double> known, deviations, right_ones;
    for (const auto& part : all) {
      if (!std::isfinite(part[o].alpha)) continue;
      known.push_back(part[o].alpha);
      deviations.push_back(part[o].deviation);
    }
    double worst = 0.0;
    for (const std::size_t k : largest_agreement(known, options_.least_change)) {
      right_ones.push_back(known[k]);
      worst = std::max(worst, deviations[k]);
    }
    const double right = middle_of(right_ones);  // the first part is known
    for (auto& part : all) {
      part[o].alpha /= right;
      part[o].likeness *= std::copysign(1.0, right);
      if (right != 1.0) part[o].deviation = std::hypot(part[o].deviation, worst);
    }
  }
  return all;
}

void SensorWatch::look_at(std::size_t part, const std::vector<Ratio>& ratios, double largest,
                          std::vector<Change>& changes) const {
  std::vector<double> gains;
  for (const auto& ratio : ratios)
    if (std::isfinite(ratio.alpha)) gains.push_back(std::abs(ratio.alpha));
  if (gains.empty()) return;
  const auto differs = [&](double gain) {
    return std::abs(std::log(gain)) > std::log1p(options_.least_change);
  };
  double common = middle_of(gains);
  const bool have_one = std::ranges::none_of(gains, [&](double g) { return differs(g / common); });
  if (!have_one && std::abs(std::log(common)) > std::log(options_.common)) common = 1.0;
  for (std::size_t o = 0; o < ratios.size(); ++o) {
    const auto& ratio = ratios[o];
    if (!std::isfinite(ratio.alpha)) continue;
    const double gain = std::abs(ratio.alpha) / common;
    const bool turned =
        ratio.alpha < 0.0 && ratio.likeness < -options_.opposite && ratio.deviation * largest < 1.0;
    const bool scaled = std::abs(ratio.likeness) > options_.alike && differs(gain) &&
                        std::abs(std::log(gain)) > largest * ratio.deviation;
    if (turned || scaled)
      changes.push_back({labels_[part], static_cast<Index>(o), std::copysign(gain, ratio.alpha), 0,
                         ratio.deviation});
  }
}

std::optional<SensorWatch::Change> SensorWatch::result() const {
  if (parts_.size() < 2) return {};
  const double tests = static_cast<double>(parts_.size() * parts_[0].size());
  const double largest =
      std::sqrt(numerics::chi_squared_quantile(1.0 - options_.chance / tests, 1));
  std::vector<Change> changes;
  const auto all = against_most();
  for (std::size_t part = 0; part < all.size(); ++part) look_at(part, all[part], largest, changes);
  if (changes.empty()) return {};
  // another sign is further than any gain; of such, a part with both signs in it is the uncertain
  // one
  Change worst = *std::ranges::max_element(changes, {}, [](const Change& c) {
    const bool turned = c.factor < 0.0;
    return std::pair(turned, turned ? -c.deviation : std::abs(std::log(c.factor)));
  });
  std::vector<Index> outputs;
  for (const auto& change : changes) outputs.push_back(change.output);
  std::ranges::sort(outputs);
  worst.outputs = std::unique(outputs.begin(), outputs.end()) - outputs.begin();
  return worst;
}

}  // namespace hydrapod::identification
