#include "hydrapod/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>

#include "damped.hpp"
#include "groups.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "reading.hpp"
#include "refit.hpp"
#include "sensor_watch.hpp"
#include "short_record.hpp"
#include "twins.hpp"

namespace hydrapod::identification {

namespace {

/// Modes × groups.
struct GroupFits {
  MatrixXd omega{}, omega_deviation{}, damping{}, damping_deviation{};
  MatrixXd excitation{};  // see WanderOptions::least_excitation; 0: the mode is not in this group
  double misfit{};        // sum over groups
};

/// Per input, mean over the half-power band of a mode and the lines nearest to it.
VectorXd density_at(const FrequencyResponses& r, const FittedMode& mode) {
  const double f = mode.omega() / two_pi, wide = mode.damping_ratio() * f;
  const auto at = [&](double x) {
    const auto line = std::ranges::lower_bound(r.frequency, x) - r.frequency.begin();
    return std::clamp<Index>(line, 0, static_cast<Index>(r.lines()) - 1);
  };
  const Index from = std::max<Index>(at(f - wide) - 1, 0), to = at(f + wide);
  VectorXd sum = VectorXd::Zero(static_cast<Index>(r.inputs.size()));
  for (Index k = from; k <= to; ++k) sum += r.input_density[static_cast<std::size_t>(k)];
  return sum / static_cast<double>(to - from + 1);
}

/// The mode of a part that is mode r of the whole: the one whose fit began there, where it stayed
/// near; else the one of like shape within reach. None: the fit went to another mode, which says
/// nothing of this one.
std::optional<std::size_t> partner_in(const std::vector<FittedMode>& part, const FittedMode& mode,
                                      std::size_t r) {
  constexpr double near = 2.0;  // half widths of the resonance
  constexpr double reach = 0.1, alike = 0.8;
  const auto off = [&](const FittedMode& m) { return std::abs(m.omega() / mode.omega() - 1.0); };
  if (off(part[r]) <= std::min(near * mode.damping_ratio(), reach)) return r;
  std::optional<std::size_t> best;
  double best_mac = alike;
  for (std::size_t k = 0; k < part.size(); ++k) {
    if (!(off(part[k]) <= reach)) continue;
    const double mac = mac_matrix({mode.shape}, {part[k].shape})(0, 0);
    if (!(mac > best_mac)) continue;
    best_mac = mac;
    best = k;
  }
  return best;
}

/// False where a channel is dead in this group.
bool add_fit(const FrequencyResponses& responses, const Identification& found,
             const IdentifyOptions& options, Index group, GroupFits& fits) {
  if (responses.outputs.size() != found.responses.outputs.size() ||
      responses.inputs.size() != found.responses.inputs.size())
    return false;
  for (auto* m : {&fits.omega, &fits.omega_deviation, &fits.damping, &fits.damping_deviation,
                  &fits.excitation})
    m->conservativeResize(std::ssize(found.modes), group + 1);
  const auto model = refitted(responses, found, options.fit, Deviations::poles);
  const std::vector<FittedMode> modes(model.modes.begin(),
                                      model.modes.begin() + std::ssize(found.modes));
  fits.misfit += model.misfit;
  for (Index r = 0; r < fits.omega.rows(); ++r) {
    const auto& whole = found.modes[static_cast<std::size_t>(r)].fit;
    const auto partner = partner_in(modes, whole, static_cast<std::size_t>(r));
    const auto& mode = modes[partner.value_or(static_cast<std::size_t>(r))];
    fits.omega(r, group) = mode.omega();
    fits.omega_deviation(r, group) = mode.omega_deviation;
    fits.damping(r, group) = mode.damping_ratio();
    fits.damping_deviation(r, group) = mode.damping_deviation;
    fits.excitation(r, group) = partner ? density_at(responses, whole)
                                              .cwiseQuotient(density_at(found.responses, whole))
                                              .minCoeff()
                                        : 0.0;
  }
  return true;
}

/// So many averages tell the errors of responses well enough.
double averages_needed(const ChannelChoice& choice, const WanderOptions& options) {
  return static_cast<double>(choice.inputs.size()) + options.least_degrees;
}

/// And so many for a sensor, whose test sums over all lines and takes no interval of any of them.
constexpr double degrees_for_sensors = 2.0;
double averages_for_sensors(const ChannelChoice& choice) {
  return static_cast<double>(choice.inputs.size()) + degrees_for_sensors;
}

/// Neighbours put together until each has averages enough; empty where there are not two such.
std::vector<CrossSpectra> large_enough(std::vector<CrossSpectra> groups, double averages) {
  const auto have_enough = [&](const std::vector<CrossSpectra>& list) {
    return std::ranges::all_of(
        list, [&](const auto& s) { return s.statistics.effective_averages >= averages; });
  };
  if (groups.size() >= 2 && have_enough(groups)) return groups;
  for (std::size_t together = 2; 2 * together <= groups.size(); together *= 2) {
    std::vector<CrossSpectra> joined;
    for (std::size_t g = 0; g + together <= groups.size(); g += together) {
      std::vector<std::size_t> picks(together);
      std::iota(picks.begin(), picks.end(), g);
      joined.push_back(averaged_spectra(groups, picks));
    }
    if (have_enough(joined)) return joined;
  }
  return {};
}

/// [s] of a record whose halves have these averages, with blocks of the same length, where one of
/// `duration` is of these groups.
double duration_for(const std::vector<CrossSpectra>& groups, double averages, double duration) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& group : groups) least = std::min(least, group.statistics.effective_averages);
  const double in_half = 0.5 * static_cast<double>(groups.size()) * least;
  constexpr double longest = 100.0;  // where hardly any block is whole
  return duration * std::clamp(averages / in_half, 1.0, longest);
}

struct Spread {
  double mean{}, deviation{};  ///< between groups, less what the estimates scatter
  double chi_squared{};
  int degrees{};
};

Spread spread_of(const VectorXd& values, const VectorXd& deviations) {
  const VectorXd weight = deviations.cwiseAbs2().cwiseInverse();
  Spread s{.mean = weight.dot(values) / weight.sum(),
           .degrees = static_cast<int>(values.size()) - 1};
  const Eigen::ArrayXd off = values.array() - s.mean;
  s.chi_squared = (off.square() * weight.array()).sum();
  // E χ² = degrees + variance · (Σ w − Σ w²/Σ w)
  s.deviation = std::sqrt(std::max(0.0, s.chi_squared - s.degrees) /
                          (weight.sum() - weight.squaredNorm() / weight.sum()));
  return s;
}

}  // namespace

namespace {

data::ResponseWarning warning_of(const SensorWatch::Change& change, const FrequencyResponses& r) {
  using Kind = data::ResponseWarning::Kind;
  const auto& channels = change.is_input ? r.inputs : r.outputs;
  return {.kind = change.is_input ? Kind::input_changed : Kind::sensor_changed,
          .channel = channels[static_cast<std::size_t>(change.channel)].name,
          .value = change.factor,
          .count = change.changed,
          .total = std::ssize(channels)};
}

/// The same of one of `parts` of a record of this duration [s].
data::ResponseWarning warning_in(const SensorWatch::Change& change, const FrequencyResponses& r,
                                 double duration, Index parts) {
  auto warning = warning_of(change, r);
  const double length = duration / static_cast<double>(parts);
  warning.lowest = static_cast<double>(change.label) * length;
  warning.highest = warning.lowest + length;
  return warning;
}

/// The modes of `found` that wander between groups. `degrees`: of the noise estimates.
std::vector<Wandering> wandering_between(const Identification& found, const GroupFits& fits,
                                         double degrees, const WanderOptions& options) {
  std::vector<Wandering> list;
  const auto modes = std::ssize(found.modes);
  const double probability = 1.0 - options.level / static_cast<double>(modes);
  for (Index r = 0; r < modes; ++r) {
    const auto& mode = found.modes[static_cast<std::size_t>(r)].fit;
    std::vector<Index> parts;
    for (Index g = 0; g < fits.omega.cols(); ++g)
      if (fits.excitation(r, g) > options.least_excitation) parts.push_back(g);
    if (parts.size() < 2) continue;
    const VectorXd omega = fits.omega(r, parts), deviation = fits.omega_deviation(r, parts);
    if (!(deviation.minCoeff() > 0.0) || !deviation.allFinite() || !omega.allFinite()) continue;
    const auto spread = spread_of(omega, deviation);
    const double between = spread.degrees;
    if (!(spread.chi_squared / between >
          numerics::fisher_quantile(probability, between, degrees)) ||
        !(spread.deviation > options.least_spread * mode.damping_ratio() * mode.omega()))
      continue;
    const auto damping = spread_of(fits.damping(r, parts), fits.damping_deviation(r, parts));
    list.push_back({.mode = static_cast<std::size_t>(r),
                    .chi_squared = spread.chi_squared,
                    .groups = static_cast<int>(parts.size()),
                    .lowest = omega.minCoeff(),
                    .highest = omega.maxCoeff(),
                    .deviation = spread.deviation,
                    .damping_in_groups = damping.mean});
  }
  return list;
}

/// The fits of groups one by one, and what they say. Twins are also fitted as one.
class PartFits {
 public:
  PartFits(const Identification& found, const IdentifyOptions& options)
      : found_(found),
        options_(options),
        twins_(twin_groups(found.modes)),
        sensors_(found.responses) {
    if (twins_.size() < found.modes.size()) merged_ = with_twins_merged(found, twins_);
  }

  /// `fit`: or only the sensors are looked at.
  void add(CrossSpectra&& part, const ChannelChoice& choice, Estimator estimator, bool fit = true) {
    degrees_ += part.statistics.effective_averages - static_cast<double>(choice.inputs.size());
    const auto label = static_cast<std::size_t>(added_++);
    try {
      const auto responses = responses_for_modes(part, choice, estimator);
      part = {};  // no longer needed, and large
      sensors_.add(responses, label);
      if (!fit || !add_fit(responses, found_, options_, fitted_, fits_)) return;
      if (merged_) add_fit(responses, *merged_, options_, fitted_, merged_fits_);
      ++fitted_;
    } catch (const base::ComputationError&) {  // this part has too little in it
    }
  }

  /// Of a record of this duration [s].
  [[nodiscard]] std::optional<data::ResponseWarning> changed_channel(double duration) const {
    const auto change = sensors_.result();
    if (!change) return {};
    return warning_in(*change, found_.responses, duration, added_);
  }

  [[nodiscard]] std::vector<Wandering> wandering(const WanderOptions& options) const {
    if (fitted_ < 2) return {};
    auto list = wandering_between(found_, fits_, degrees_, options);
    auto twins = wandering_twins(options);
    std::erase_if(list, [&](const Wandering& w) {
      return std::ranges::any_of(twins, [&](const auto& twin) { return twin.mode == w.mode; });
    });
    list.insert(list.end(), twins.begin(), twins.end());
    return list;
  }

  /// Those that are one resonance in each part, and another one.
  [[nodiscard]] std::vector<Wandering> wandering_twins(const WanderOptions& options) const {
    // in each part one pole is as good as two: there never were two resonances at a time
    constexpr double as_good = 1.2;
    if (fitted_ < 2 || !merged_ || !(merged_fits_.misfit < as_good * fits_.misfit)) return {};
    std::vector<Wandering> list;
    for (auto one : wandering_between(*merged_, merged_fits_, degrees_, options)) {
      const auto& members = twins_[one.mode];
      if (members.size() < 2) continue;
      for (const auto member : members) {
        one.mode = member;
        list.push_back(one);
      }
    }
    return list;
  }

 private:
  const Identification& found_;
  const IdentifyOptions& options_;
  std::vector<std::vector<std::size_t>> twins_;
  std::optional<Identification> merged_{};  // a resonance that became several is one
  GroupFits fits_{}, merged_fits_{};
  SensorWatch sensors_;
  Index fitted_{}, added_{};
  double degrees_{};  // of the noise estimates
};

}  // namespace

std::vector<Wandering> wandering_modes(std::vector<CrossSpectra> groups,
                                       const ChannelChoice& choice, Estimator estimator,
                                       const Identification& found, const IdentifyOptions& identify,
                                       const WanderOptions& options) {
  if (found.modes.empty()) return {};
  PartFits parts(found, identify);
  for (auto& part : large_enough(std::move(groups), averages_needed(choice, options)))
    parts.add(std::move(part), choice, estimator);
  return parts.wandering(options);
}

namespace {

/// Between records, which may be of any length.
std::optional<data::ResponseWarning> changed_between(data::RecordSet& records,
                                                     const Measurement& measured,
                                                     const MeasureOptions& measure,
                                                     const FrequencyResponses& whole,
                                                     const numerics::Progress& progress) {
  SensorWatch sensors(whole);
  each_record(records, measured, measure, progress, whole.frequency.back(),
              [&](std::size_t record, CrossSpectra&& spectra, const ChannelChoice& choice,
                  Estimator estimator) {
                if (spectra.statistics.effective_averages < averages_for_sensors(choice)) return;
                try {
                  sensors.add(responses_for_modes(spectra, choice, estimator), record);
                } catch (const base::ComputationError&) {  // this record has too little in it
                }
              });
  const auto change = sensors.result();
  if (!change) return {};
  auto warning = warning_of(*change, whole);
  warning.other = std::filesystem::path(records.files()[change->label]).filename().string();
  return warning;
}

}  // namespace

namespace {

/// Halves of the records in blocks as short as it takes to have so many averages, for records with
/// too few of the usual length. None: there are too few of these blocks too, or the options say how
/// long blocks are.
std::optional<GroupedSpectra> halves_in_shorter_blocks(data::RecordSet& records,
                                                       const Measurement& measured,
                                                       const MeasureOptions& measure,
                                                       double degrees, double to,
                                                       const numerics::Progress& progress) {
  constexpr int halvings = 4, shortest = 64, halves = 2;  // 64 samples have the fewest lines
  if (asks_for_blocks(measure) || measured.reading == nullptr) return {};
  int block = measured.reading->spectrum.block_length;
  for (int n = 0; n < halvings && block / 2 >= shortest; ++n) {
    block /= 2;
    auto all = measure_groups_in_blocks(records, measured, measure, block, halves, progress, to);
    const double averages = static_cast<double>(all.choice.inputs.size()) + degrees;
    all.groups = large_enough(std::move(all.groups), averages);
    if (!all.groups.empty()) return all;
  }
  return {};
}

/// Channels are compared, and modes are not, so that what leaks is the same in both halves. False:
/// that cannot be.
bool compare_in_shorter_blocks(data::RecordSet& records, const Measurement& measured,
                               const MeasureOptions& measure, double from, double to,
                               double duration, const numerics::Progress& progress,
                               PartsFinding& finding) try {
  const auto all =
      halves_in_shorter_blocks(records, measured, measure, degrees_for_sensors, to, progress);
  if (!all) return false;
  const auto& parts = all->groups;
  const auto whole = within(
      responses_for_modes(averaged_spectra(parts, {0, 1}), all->choice, all->estimator), from, to);
  if (whole.lines() == 0) return false;
  SensorWatch watch(whole);
  for (std::size_t g = 0; g < parts.size(); ++g)
    watch.add(responses_for_modes(parts[g], all->choice, all->estimator), g);
  if (const auto change = watch.result())
    finding.changed = warning_in(*change, whole, duration, std::ssize(parts));
  return true;
} catch (const base::ComputationError&) {  // a half has too little in it
  return false;
}

/// What leaks is more than in the blocks that the modes were found in, and alike in both halves.
std::vector<Wandering> wandering_in_shorter_blocks(
    data::RecordSet& records, const Measurement& measured, const MeasureOptions& measure,
    const Identification& found, const IdentifyOptions& identify, const WanderOptions& options,
    const numerics::Progress& progress) try {
  PartFits parts(found, identify);
  auto all = halves_in_shorter_blocks(records, measured, measure, options.least_degrees, found.to,
                                      progress);
  if (!all) return {};
  for (auto& part : all->groups) parts.add(std::move(part), all->choice, all->estimator);
  return parts.wandering(options);
} catch (const base::ComputationError&) {  // a half has too little in it
  return {};
}

}  // namespace

PartsFinding compare_parts(data::RecordSet& records, const Measurement& measured,
                           const MeasureOptions& measure, const Identification& found,
                           const IdentifyOptions& identify, const WanderOptions& options,
                           const numerics::Progress& progress) {
  if (measured.responses.lines() == 0) return {};
  constexpr int most_parts = 4;
  bool stopped = false, large = true;
  const auto watched = [&](double share) { return stopped = progress && progress(share); };
  PartsFinding finding;
  const bool several = records.files().size() > 1, no_mode = found.modes.empty();
  // an input that was turned round may leave nothing in the mean over the record
  const auto& whole = no_mode ? measured.responses : found.responses;
  const double duration = static_cast<double>(measured.samples) / records.header().sample_rate;
  const auto in_shorter_blocks = [&] {
    const double from = no_mode ? 0.0 : found.from;
    const double to = no_mode ? 0.5 * records.header().sample_rate : found.to;
    return !several && compare_in_shorter_blocks(records, measured, measure, from, to, duration,
                                                 watched, finding);
  };
  if (measured.record != nullptr || (no_mode && !several)) {
    in_shorter_blocks();
    return stopped ? PartsFinding() : finding;
  }
  if (several) finding.changed = changed_between(records, measured, measure, whole, watched);
  if (stopped || no_mode) return stopped ? PartsFinding() : finding;
  PartFits parts(found, identify);
  each_group(records, measured, measure, most_parts, watched, found.to,
             [&](CrossSpectra&& part, const ChannelChoice& choice, Estimator estimator) {
               large =
                   large && part.statistics.effective_averages >= averages_needed(choice, options);
               if (large && !stopped) parts.add(std::move(part), choice, estimator);
             });
  if (stopped) return {};
  const auto say = [&](const PartFits& fits) {
    finding.wandering = fits.wandering(options);
    if (!several) finding.changed = fits.changed_channel(duration);
  };
  if (large) {
    say(parts);
    return finding;
  }
  // neighbours are put together, for which all are needed
  auto all = measure_groups(records, measured, measure, most_parts, watched, found.to);
  if (stopped) return {};
  auto halves = large_enough(all.groups, averages_needed(all.choice, options));
  const bool fit = !halves.empty();
  const double needed = averages_for_sensors(all.choice);
  if (!fit && !several) halves = large_enough(all.groups, needed);
  if (halves.empty() && !several && !in_shorter_blocks())
    finding.needed_duration = duration_for(all.groups, needed, duration);
  if (!halves.empty()) {
    PartFits joined(found, identify);
    for (auto& part : halves) joined.add(std::move(part), all.choice, all.estimator, fit);
    say(joined);
  }
  if (!fit)
    finding.wandering =
        wandering_in_shorter_blocks(records, measured, measure, found, identify, options, watched);
  return stopped ? PartsFinding() : finding;
}

void add_changed_channel(const data::ResponseWarning& changed, Identification& found) {
  const double same = 1.0 - static_cast<double>(changed.count) / static_cast<double>(changed.total);
  for (auto& mode : found.modes) mode.explained = std::min(mode.explained, same);
  found.responses.warnings.push_back(changed);
}

void add_wandering(const std::vector<Wandering>& wandering, Identification& found) {
  for (const auto& w : wandering) {
    auto& mode = found.modes.at(w.mode);
    const double half_width = mode.fit.damping_ratio() * mode.fit.omega();
    // one resonance that is elsewhere in each part: no mode is where the twins are
    const bool is_twin = std::ranges::any_of(wandering, [&](const Wandering& other) {
      return other.mode != w.mode && other.chi_squared == w.chi_squared;
    });
    mode.steadiness = is_twin ? 0.0 : half_width / (half_width + w.deviation);
    found.warnings.push_back(
        {.kind = ModeWarning::Kind::wanders,
         .value = mode.fit.omega() / two_pi,
         .from = w.lowest / two_pi,
         .to = w.highest / two_pi,
         .share = mode.fit.damping_ratio() / std::max(w.damping_in_groups, 1e-12) - 1.0,
         .count = w.groups});
  }
}

}  // namespace hydrapod::identification
