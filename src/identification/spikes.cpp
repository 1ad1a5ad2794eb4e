#include "spikes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "names.hpp"
#include "response_checks.hpp"
#include "sample_sums.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index beside_spike = 4;  // samples on either side in the median

using SpikeColumn = Eigen::Ref<const VectorXd, 0, Eigen::InnerStride<>>;

/// The value that a share of the finite ones exceeds; none: there are too few of them.
std::optional<double> exceeded_by(double share, std::vector<double> values, std::int64_t least) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  if (std::ssize(values) < least) return {};
  const auto at = values.end() - 1 - std::lround(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// d_t; not finite where the sample is not.
double deviation_from_median(const SpikeColumn& x, Index t) {
  std::array<double, 2 * beside_spike + 1> near{};
  std::size_t count = 0;
  for (Index s = std::max<Index>(0, t - beside_spike);
       s <= std::min(x.size() - 1, t + beside_spike); ++s)
    if (std::isfinite(x[s])) near[count++] = x[s];
  const auto end = near.begin() + static_cast<std::ptrdiff_t>(count),
             middle = near.begin() + count / 2;
  std::nth_element(near.begin(), middle, end);
  return std::abs(x[t] - *middle);
}

/// Of all samples of a channel in a file; `step`: the least between two of them.
struct ChannelMoments : SampleSums {
  double last{std::numeric_limits<double>::quiet_NaN()};
  double step{std::numeric_limits<double>::infinity()};

  void add_next(double x) {
    add(x);
    if (const double by = std::abs(x - last); by > 0.0) step = std::min(step, by);
    last = x;
  }
};

/// ChannelMoments per file and channel.
using MomentsOfFiles = std::vector<std::vector<ChannelMoments>>;

MomentsOfFiles moments_of(data::RecordSet& records, const std::vector<std::size_t>& channels) {
  MomentsOfFiles all(records.files().size(), std::vector<ChannelMoments>(channels.size()));
  records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    for (std::size_t c = 0; c < channels.size(); ++c)
      for (const double x : block.col(static_cast<Index>(channels[c]))) all[file][c].add_next(x);
    return true;
  });
  return all;
}

struct SpikeCandidate {
  Spike spike{};
  double value{}, deviation{};
};

/// Samples of a file stream past a few hundred on either side of the one that is looked at.
class SpikeWatch {
 public:
  SpikeWatch(const std::vector<std::size_t>& channels, const SpikeOptions& options)
      : channels_(channels), options_(options) {}

  void begin(std::size_t file, const std::vector<ChannelMoments>& moments) {
    file_ = file;
    moments_ = &moments;
    rows_ = looked_ = 0;
    first_ = 0;
  }

  void add(const Eigen::Ref<const data::Samples>& block) {
    const auto width = static_cast<Index>(channels_.size());
    if (buffer_.rows() < rows_ + block.rows() || buffer_.cols() != width)
      buffer_.conservativeResize(rows_ + block.rows(), width);
    for (Index c = 0; c < width; ++c)
      buffer_.col(c).segment(rows_, block.rows()) =
          block.col(static_cast<Index>(channels_[static_cast<std::size_t>(c)]));
    rows_ += block.rows();
    look(rows_ - reach());
    const Index from = std::max<Index>(0, looked_ - reach()), kept = rows_ - from;
    buffer_.topRows(kept) = buffer_.middleRows(from, kept).eval();
    rows_ = kept;
    looked_ -= from;
    first_ += from;
  }

  void end() { look(rows_); }

  std::vector<SpikeCandidate> found{};

 private:
  [[nodiscard]] Index reach() const { return options_.reach + 2 * beside_spike; }

  /// Samples up to `to`.
  void look(Index to) {
    for (; looked_ < to; ++looked_)
      for (std::size_t c = 0; c < channels_.size(); ++c) {
        const auto& moments = (*moments_)[c];
        if (std::abs(buffer_(looked_, static_cast<Index>(c)) - moments.mean()) >
            options_.looked_at * moments.rms())
          judge(static_cast<Index>(c), looked_);
      }
  }

  /// use(values of t before a sample, and of those after it), the nearest ones left out.
  template <class Value>
  std::pair<std::vector<double>, std::vector<double>> beside(Index t, const Value& value) const {
    std::vector<double> before, after;
    for (Index s = std::max<Index>(0, t - options_.reach); s < t - beside_spike; ++s)
      before.push_back(value(s));
    for (Index s = t + beside_spike + 1; s < std::min(rows_, t + options_.reach); ++s)
      after.push_back(value(s));
    return {std::move(before), std::move(after)};
  }

  void judge(Index c, Index t) {
    const SpikeColumn x = buffer_.col(c).head(rows_);
    const double d = deviation_from_median(x, t);
    const auto [before, after] = beside(t, [&](Index s) {
      return std::isfinite(x[s]) ? deviation_from_median(x, s)
                                 : std::numeric_limits<double>::quiet_NaN();
    });
    const auto one = exceeded_by(options_.rare, before, options_.least_reach),
               other = exceeded_by(options_.rare, after, options_.least_reach);
    if (!one || !other) return;
    const double usual = std::max(*one, *other);
    if (!(d > options_.of_usual * usual) || is_hit(t)) return;
    add(c, t, d, d / std::max(usual, 1e-12 * d));
    for (Index s = std::max<Index>(0, t - beside_spike); s <= std::min(rows_ - 1, t + beside_spike);
         ++s)
      if (s != t && deviation_from_median(x, s) > options_.beside * usual)
        add(c, s, deviation_from_median(x, s), 0.0);
  }

  void add(Index c, Index t, double d, double height) {
    found.push_back({.spike = {.place = {.file = file_,
                                         .sample = first_ + t,
                                         .channel = channels_[static_cast<std::size_t>(c)]},
                               .height = height},
                     .value = buffer_(t, c),
                     .deviation = d});
  }

  /// Does a channel move more after the sample than before?
  [[nodiscard]] bool is_hit(Index t) const {
    constexpr double tenth = 0.1;
    for (Index c = 0; c < buffer_.cols(); ++c) {
      const auto [before, after] = beside(t, [&](Index s) { return buffer_(s, c); });
      const auto spread = [&](const std::vector<double>& values) {
        const auto high = exceeded_by(tenth, values, options_.least_reach),
                   low = exceeded_by(1.0 - tenth, values, options_.least_reach);
        return high && low ? *high - *low : 0.0;
      };
      if (spread(after) > options_.rises * spread(before)) return true;
    }
    return false;
  }

  const std::vector<std::size_t>& channels_;
  const SpikeOptions& options_;
  const std::vector<ChannelMoments>* moments_{};
  data::Samples buffer_{};
  std::size_t file_{};
  Index rows_{}, looked_{};
  std::int64_t first_{};  // sample of the file in row 0
};

/// Those that stand out from all that is no candidate in their channel and file.
std::vector<Spike> judged_spikes(std::vector<SpikeCandidate> list, ChannelMoments moments,
                                 const SpikeOptions& options) {
  for (const auto& candidate : list) moments.add(candidate.value, -1);
  const double least = std::max(options.of_rms * moments.rms(), options.of_step * moments.step);
  std::size_t spikes = 0;
  for (const auto& candidate : list) {
    if (!(candidate.spike.height > 0.0)) continue;
    if (!(candidate.deviation > least)) return {};
    ++spikes;
  }
  if (spikes > options.most) return {};
  std::vector<Spike> result;
  for (const auto& candidate : list) result.push_back(candidate.spike);
  return result;
}

}  // namespace

bool may_have_spikes(const CrossSpectra& spectra, const SpikeOptions& options) {
  if (spectra.blocks == 0) return true;
  for (std::size_t c = 0; c < spectra.health.size(); ++c) {
    const auto& health = spectra.health[c];
    const double half = 0.5 * (health.highest - health.lowest);
    if (half > options.conspicuous * rms_in(spectra, static_cast<int>(c))) return true;
  }
  return false;
}

std::vector<Spike> find_spikes(data::RecordSet& records, const std::vector<std::size_t>& channels,
                               const SpikeOptions& options) {
  const auto moments = moments_of(records, channels);
  SpikeWatch watch(channels, options);
  std::optional<std::size_t> current;
  records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    if (current != file) {
      if (current) watch.end();
      watch.begin(file, moments[file]);
    }
    current = file;
    watch.add(block);
    return true;
  });
  if (current) watch.end();
  // of a sample that two spikes have beside them the first finding stands
  std::map<std::pair<std::size_t, std::size_t>, std::map<std::int64_t, SpikeCandidate>> of_channel;
  for (const auto& candidate : watch.found) {
    const auto& place = candidate.spike.place;
    auto& known = of_channel[{place.file, place.channel}][place.sample];
    if (!(known.spike.height > 0.0)) known = candidate;
  }
  std::vector<Spike> spikes;
  for (const auto& [where, candidates] : of_channel) {
    std::vector<SpikeCandidate> list;
    for (const auto& [sample, candidate] : candidates) list.push_back(candidate);
    const auto c = std::ranges::find(channels, where.second) - channels.begin();
    for (auto& spike :
         judged_spikes(std::move(list), moments[where.first][static_cast<std::size_t>(c)], options))
      spikes.push_back(spike);
  }
  // what several channels show at once came in through the excitation
  const auto at_once = [&](const SpikePlace& a) {
    return std::ranges::any_of(spikes, [&](const Spike& spike) {
      const SpikePlace& b = spike.place;
      return b.file == a.file && b.channel != a.channel &&
             std::abs(b.sample - a.sample) <= options.at_once;
    });
  };
  std::vector<Spike> single;
  for (const Spike& spike : spikes)
    if (!at_once(spike.place)) single.push_back(spike);
  return single;
}

std::vector<data::RecordSet::Stretch> stretches_of(const std::vector<Spike>& spikes) {
  std::vector<data::RecordSet::Stretch> stretches;
  for (const auto& [place, ratio] : spikes)
    stretches.push_back({place.file, place.channel, place.sample, place.sample + 1});
  return stretches;
}

std::vector<Spike> leave_out_spikes(data::RecordSet& records,
                                    const std::vector<std::size_t>& channels,
                                    const SpikeOptions& options) {
  std::vector<Spike> all;
  for (int round = 0; round < options.rounds; ++round) {
    const auto more = find_spikes(records, channels, options);
    if (more.empty()) break;
    all.insert(all.end(), more.begin(), more.end());
    records.take_as_missing(stretches_of(all));
  }
  std::ranges::sort(all, {}, &Spike::place);
  return all;
}

std::vector<data::ResponseWarning> warnings_of_spikes(const std::vector<Spike>& spikes,
                                                      const data::RecordHeader& header) {
  std::map<std::size_t, data::ResponseWarning> of_channel;
  for (const auto& spike : spikes) {
    auto& warning = of_channel[spike.place.channel];
    if (warning.count++ == 0) {
      warning.kind = data::ResponseWarning::Kind::spikes;
      warning.channel = header.channels[spike.place.channel].name;
      warning.value = static_cast<double>(spike.place.sample) / header.sample_rate;
    }
    warning.highest = std::max(warning.highest, spike.height);
  }
  std::vector<data::ResponseWarning> warnings;
  for (auto& [channel, warning] : of_channel) warnings.push_back(std::move(warning));
  return warnings;
}

}  // namespace hydrapod::identification
