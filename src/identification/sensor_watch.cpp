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

/// A row of responses as a column, or a column, and its covariance.
struct PartOfLine {
  VectorXcd values{};
  MatrixXcd covariance{};
};

PartOfLine row_at(const FrequencyResponses& r, std::size_t line, Index output) {
  return {r.H[line].row(output).transpose(),
          r.noise[line](output, output).real() * r.input_factor[line].transpose()};
}

/// `weight`: per output.
PartOfLine column_at(const FrequencyResponses& r, std::size_t line, Index input,
                     const VectorXd& weight) {
  return {weight.cwiseProduct(r.H[line].col(input)),
          r.input_factor[line](input, input).real() *
              MatrixXcd(weight.asDiagonal() * r.noise[line] * weight.asDiagonal())};
}

/// Per output, 1 by its size.
VectorXd weight_of(const FrequencyResponses& r) {
  VectorXd power = VectorXd::Zero(std::ssize(r.outputs));
  for (const auto& H : r.H) power += H.rowwise().squaredNorm();
  return power.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
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
                                         Side side, Index channel) const {
  const auto at = [&](const FrequencyResponses& r, std::size_t line) {
    return side == Side::outputs ? row_at(r, line, channel) : column_at(r, line, channel, weight_);
  };
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
    const auto [h, of_h] = at(*first_, k);
    const auto [g, of_g] = at(part, *other);
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
  if (lines < options_.fewest_lines || !(hh > 0.0) || !(gg > 0.0))
    return {unknown, unknown, 0.0, 0.0};
  const auto entries = side == Side::outputs ? part.inputs.size() : part.outputs.size();
  const double numbers = static_cast<double>(lines) * static_cast<double>(entries);
  const double variance =
      lines_in_step(part) *
      (0.5 / hh + 0.5 / gg + 0.25 * numbers * (1.0 / (hh * hh) + 1.0 / (gg * gg)));
  return {std::copysign(std::sqrt(gg / hh), hg), std::sqrt(variance), hg / std::sqrt(hh * gg), hh};
}

void SensorWatch::add(const FrequencyResponses& part, std::size_t label) {
  if (part.outputs.size() != whole_.outputs.size() || part.inputs.size() != whole_.inputs.size() ||
      !part.has_errors() || (first_ && part.shift != first_->shift))
    return;
  const auto in_band = within(part, whole_.frequency.front(), whole_.frequency.back());
  const VectorXd level = level_of(in_band, whole_, options_.lowest_level);
  const Ratio same{1.0, 0.0, 1.0, 0.0};
  std::vector<Ratio> outputs(part.outputs.size(), same), inputs(part.inputs.size(), same);
  if (first_) {
    for (std::size_t o = 0; o < outputs.size(); ++o)
      outputs[o] = ratio_of(in_band, level, Side::outputs, static_cast<Index>(o));
    for (std::size_t i = 0; i < inputs.size(); ++i)
      inputs[i] = ratio_of(in_band, level, Side::inputs, static_cast<Index>(i));
  } else {
    first_ = in_band;
    level_of_first_ = level;
    weight_ = weight_of(in_band);
  }
  of_outputs_.push_back(std::move(outputs));
  of_inputs_.push_back(std::move(inputs));
  labels_.push_back(label);
}

/// Each by what most parts say. A part within which the sensor changed says what neither side of it
/// does, so that a median of all parts may be that of nobody.
SensorWatch::Ratios SensorWatch::against_most(Side side) const {
  auto all = side == Side::outputs ? of_outputs_ : of_inputs_;
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

void SensorWatch::look_at(std::size_t part, const std::vector<Ratio>& ratios, Side side,
                          double largest, std::vector<Change>& changes) const {
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
  const bool is_input = side == Side::inputs;
  const auto is_gain = [&](const Ratio& ratio) {
    const double of_damping = 1.0 - 1.0 / std::cosh(std::log(std::abs(ratio.alpha)));
    return 1.0 - std::abs(ratio.likeness) < options_.pure * of_damping;
  };
  const bool is_only_input = is_input && ratios.size() == 1;
  if (is_only_input) common = 1.0;
  for (std::size_t o = 0; o < ratios.size(); ++o) {
    const auto& ratio = ratios[o];
    if (!std::isfinite(ratio.alpha)) continue;
    const double gain = std::abs(ratio.alpha) / common;
    const bool turned =
        ratio.alpha < 0.0 && ratio.likeness < -options_.opposite && ratio.deviation * largest < 1.0;
    const bool scaled = std::abs(ratio.likeness) > options_.alike && differs(gain) &&
                        std::abs(std::log(gain)) > largest * ratio.deviation &&
                        (!is_only_input || is_gain(ratio));
    if (!turned && !scaled) continue;
    const double factor = std::copysign(gain, ratio.alpha);
    changes.push_back({labels_[part], is_input, static_cast<Index>(o),
                       is_input ? 1.0 / factor : factor, 0, ratio.deviation});
  }
}

SensorWatch::Found SensorWatch::find(Side side, double largest) const {
  Found found;
  const auto all = against_most(side);
  double left = 0.0, total = 0.0;
  for (std::size_t part = 0; part < all.size(); ++part) {
    const std::size_t before = found.changes.size();
    look_at(part, all[part], side, largest, found.changes);
    std::vector<char> changed(all[part].size());
    for (std::size_t k = before; k < found.changes.size(); ++k)
      changed[static_cast<std::size_t>(found.changes[k].channel)] = 1;
    for (std::size_t c = 0; c < changed.size(); ++c) {
      const auto& r = all[part][c];
      if (!std::isfinite(r.alpha)) continue;
      const double squares = 1.0 + r.alpha * r.alpha;
      left += r.size * (changed[c] ? 2.0 * r.alpha * r.alpha * (1.0 - std::abs(r.likeness))
                                   : squares - 2.0 * r.likeness * std::abs(r.alpha));
      total += r.size * squares;
    }
  }
  found.left = left / std::max(total, 1e-300);
  return found;
}

namespace {

std::int64_t channels_in(const std::vector<SensorWatch::Change>& changes) {
  std::vector<Index> channels;
  for (const auto& change : changes) channels.push_back(change.channel);
  std::ranges::sort(channels);
  return std::unique(channels.begin(), channels.end()) - channels.begin();
}

}  // namespace

std::optional<SensorWatch::Change> SensorWatch::result() const {
  if (labels_.size() < 2) return {};
  const double tests =
      static_cast<double>(labels_.size() * (whole_.outputs.size() + whole_.inputs.size()));
  const double largest =
      std::sqrt(numerics::chi_squared_quantile(1.0 - options_.chance / tests, 1));
  const auto outputs = find(Side::outputs, largest), inputs = find(Side::inputs, largest);
  if (outputs.changes.empty() && inputs.changes.empty()) return {};
  const auto of_outputs = channels_in(outputs.changes), of_inputs = channels_in(inputs.changes);
  const bool alike = std::abs(inputs.left - outputs.left) < options_.as_good;
  const bool is_input =
      of_outputs == 0 ||
      (of_inputs > 0 && (alike ? of_inputs < of_outputs : inputs.left < outputs.left));
  // another sign is further than any gain; of such, a part with both signs in it is the uncertain
  // one
  Change worst = *std::ranges::max_element(
      is_input ? inputs.changes : outputs.changes, {}, [](const Change& c) {
        const bool turned = c.factor < 0.0;
        return std::pair(turned, turned ? -c.deviation : std::abs(std::log(c.factor)));
      });
  worst.changed = is_input ? of_inputs : of_outputs;
  return worst;
}

}  // namespace hydrapod::identification
