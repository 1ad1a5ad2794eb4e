#include "measure_hits.hpp"

#include <algorithm>
#include <limits>

#include "alignment.hpp"
#include "bridge.hpp"
#include "channel_watch.hpp"
#include "held_values.hpp"
#include "hits.hpp"
#include "response_checks.hpp"
#include "sample_sums.hpp"

namespace hydrapod::identification {

std::optional<std::vector<data::Samples>> whole_records(data::RecordSet& records,
                                                        const std::vector<std::size_t>& channels,
                                                        std::int64_t most) {
  const std::vector<Index> columns(channels.begin(), channels.end());
  std::int64_t total = 0;
  std::vector<data::Samples> all;
  for (std::size_t k = 0; k < records.files().size(); ++k) {
    const std::int64_t count = records.count_samples(k);
    total += count;
    if (total > most) return {};
    all.emplace_back(count, static_cast<Index>(columns.size()));
  }
  std::vector<Index> filled(all.size());
  records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    // a file may grow while it is read
    const Index count = std::min(block.rows(), all[file].rows() - filled[file]);
    all[file].middleRows(filled[file], count) = block(Eigen::seqN(0, count), columns);
    filled[file] += count;
    return true;
  });
  for (std::size_t k = 0; k < all.size(); ++k)
    all[k].conservativeResize(filled[k], Eigen::NoChange);
  return all;
}

namespace {

/// With straight lines over spikes.
void bridge_spikes(const std::vector<Spike>& spikes, const std::vector<std::size_t>& used,
                   std::vector<data::Samples>& records) {
  for (const auto& spike : spikes) {
    auto column =
        records[spike.place.file].col(std::ranges::find(used, spike.place.channel) - used.begin());
    column = bridged(column);
  }
}

/// Of the input; a warning for each tone.
void take_out_hum(std::vector<data::Samples>& records, int input, const data::RecordHeader& header,
                  const std::string& name, std::vector<data::ResponseWarning>& warnings) {
  for (auto& samples : records) {
    std::vector<Hum> hum;
    auto column = samples.col(input);
    const double largest = (column.array() - column.mean()).abs().maxCoeff();
    column = without_hum(column, hum);
    for (const auto& tone : hum) {
      const double frequency = tone.omega * header.sample_rate / two_pi;
      const auto same = std::ranges::find_if(warnings, [&](const data::ResponseWarning& w) {
        return std::abs(w.value - frequency) * static_cast<double>(samples.rows()) <
               2.0 * header.sample_rate;
      });
      if (same != warnings.end()) {
        same->share = std::max(same->share, tone.amplitude / largest);
        continue;
      }
      warnings.push_back({.kind = data::ResponseWarning::Kind::hum,
                          .channel = name,
                          .value = frequency,
                          .share = tone.amplitude / largest});
    }
  }
}

/// Of all channels.
std::vector<ChannelHealth> health_of(const std::vector<data::Samples>& records) {
  std::vector<ChannelHealth> health;
  for (Index c = 0; c < records.front().cols(); ++c) {
    ChannelWatch watch;
    for (const auto& samples : records)
      watch.add(samples.col(c), samples.col(c).minCoeff(), samples.col(c).maxCoeff());
    health.push_back(watch.health());
  }
  return health;
}

VectorXd rms_of(const std::vector<data::Samples>& records) {
  VectorXd rms(records.front().cols());
  for (Index c = 0; c < rms.size(); ++c) {
    SampleSums sums;
    for (const auto& samples : records)
      for (const double x : samples.col(c)) sums.add(x);
    rms[c] = sums.rms();
  }
  return rms;
}

/// Of channels that are clipped; in the others nothing is cut off.
std::vector<data::ResponseWarning> take_clipped(const std::vector<data::Samples>& records,
                                                const ChannelChoice& choice,
                                                CrossSpectra& spectra) {
  std::vector<data::ResponseWarning> warnings;
  const VectorXd rms = rms_of(records);
  warn_of_limits(spectra, rms, choice.inputs, warnings);
  warn_of_limits(spectra, rms, choice.outputs, warnings);
  for (std::size_t c = 0; c < spectra.health.size(); ++c)
    if (std::ranges::find(warnings, spectra.channels[c].name, &data::ResponseWarning::channel) ==
        warnings.end())
      spectra.health[c].cut_below = spectra.health[c].cut_above =
          std::numeric_limits<double>::quiet_NaN();
  return warnings;
}

/// Where nothing that is cut off was used, it is said of the hits and not of the channels.
void say_what_is_clipped(const std::vector<data::ResponseWarning>& clipped, bool without_cut,
                         std::vector<data::ResponseWarning>& warnings) {
  if (!without_cut) {
    warnings.insert(warnings.end(), clipped.begin(), clipped.end());
    return;
  }
  for (auto& warning : warnings) {
    if (warning.kind != data::ResponseWarning::Kind::clipped_hits) continue;
    warning.channel = clipped.front().channel;
    warning.value = static_cast<double>(clipped.size());
  }
}

void warn_of_same_samples(const std::vector<data::Samples>& records, const ChannelChoice& choice,
                          Measurement& m) {
  for (std::size_t b = 1; b < choice.outputs.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      const int one = choice.outputs[b], other = choice.outputs[a];
      if (!std::ranges::all_of(records, [&](const data::Samples& samples) {
            return samples.col(one) == samples.col(other);
          }))
        continue;
      const auto& channels = m.spectra.channels;
      m.responses.warnings.push_back({.kind = data::ResponseWarning::Kind::repeated_output,
                                      .channel = channels[static_cast<std::size_t>(one)].name,
                                      .other = channels[static_cast<std::size_t>(other)].name});
      break;
    }
}

}  // namespace

std::optional<Measurement> measure_hits(data::RecordSet& records, Plan plan,
                                        const MeasureOptions& options,
                                        const std::vector<Spike>& spikes, Beginning& beginning) {
  if (plan.choice.inputs.size() != 1 || plan.estimator != Estimator::h1 || options.block_length ||
      options.overlap || options.period || options.settling > 0.0 || options.platform ||
      options.outputs_to_platform || options.window != Window::hann)
    return {};
  const VectorXd& as_read = beginning.of(plan.choice.inputs[0]);
  std::vector<Hum> hum;
  const auto hits = hits_in(without_hum(spikes.empty() ? as_read : bridged(as_read), hum));
  if (hits.empty() || (hits.size() > 1 && excitation_period(records, plan.choice, beginning) > 0))
    return {};
  Measurement m{.header = records.header()};
  const auto used = used_channels(plan.choice);
  auto all = whole_records(records, used, HitOptions{}.most);
  if (!all) return {};
  bridge_spikes(spikes, used, *all);
  std::vector<data::ResponseWarning> hums;
  if (!hum.empty())
    take_out_hum(*all, plan.choice.inputs[0], m.header,
                 m.header.channels[used[static_cast<std::size_t>(plan.choice.inputs[0])]].name,
                 hums);
  for (const auto& samples : *all) m.samples += samples.rows();
  m.notes = records.notes();
  const double rate = m.header.sample_rate;
  const auto channel = [&](int c) { return m.header.channels[used[static_cast<std::size_t>(c)]]; };
  for (const std::size_t c : used) m.spectra.channels.push_back(m.header.channels[c]);
  m.spectra.sample_rate = rate;
  m.spectra.health = health_of(*all);
  const auto clipped = take_clipped(*all, plan.choice, m.spectra);
  std::vector<data::ResponseWarning> slow;
  leave_out_slow(m.spectra, plan.choice, slow);
  std::vector<data::Channel> outputs;
  for (const int o : plan.choice.outputs) outputs.push_back(channel(o));
  auto found = responses_of_hits(*all, outputs, plan.choice, rate, m.spectra.health);
  if (!found) return {};
  m.responses = std::move(found->responses);
  for (const int i : plan.choice.inputs) m.responses.inputs.push_back(channel(i));
  without_hold(m.spectra, m.responses);
  align_outputs(m.responses);
  m.spectra.options = {.block_length = static_cast<int>(found->samples),
                       .overlap = 0.0,
                       .window = Window::rectangular};
  auto& warnings = m.responses.warnings;
  say_what_is_clipped(clipped, found->without_cut, warnings);
  warnings.insert(warnings.end(), slow.begin(), slow.end());
  warnings.insert(warnings.end(), hums.begin(), hums.end());
  warn_of_same_samples(*all, plan.choice, m);
  m.choice = std::move(plan.choice);
  return m;
}

}  // namespace hydrapod::identification
