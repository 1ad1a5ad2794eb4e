#include "reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "background.hpp"
#include "block_length.hpp"
#include "groups.hpp"
#include "held.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Of all channels: a thread begins in some 50 µs.
constexpr std::int64_t samples_worth_a_thread = 1 << 17;

/// [samples]; 0: the excitation does not repeat, or that does not count. `shortest`: samples of the
/// shortest record, here and below.
std::int64_t period_to_use(data::RecordSet& records, const Plan& plan,
                           const MeasureOptions& options, std::int64_t shortest,
                           Beginning& beginning) {
  const double rate = records.header().sample_rate;
  if (options.period && !(*options.period * rate <= static_cast<double>(shortest)))
    base::refuse(records.files()[0],
                 fmt::format("the period of {:g} s is longer than the record of {:g} s",
                             *options.period, static_cast<double>(shortest) / rate));
  const std::int64_t period = options.period ? std::llround(*options.period * rate)
                              : options.block_length
                                  ? 0
                                  : excitation_period(records, plan.choice, beginning);
  return period % 2 == 0 ? period : 2 * period;  // blocks have an even length
}

/// Of inputs of H1, or of the instruments of a loop. Where other records follow, or the record goes
/// on, they may pass all.
std::optional<Swept> sweep_of(const data::RecordSet& records, const Plan& plan,
                              Beginning& beginning) {
  const bool loop = plan.estimator == Estimator::instrumental;
  if (plan.estimator != Estimator::h1 && !loop) return {};
  const auto& channels = loop ? plan.choice.instruments : plan.choice.inputs;
  std::vector<const VectorXd*> samples;
  for (const int channel : channels) samples.push_back(&beginning.of(channel));
  const auto count = samples.front()->size() * std::ssize(samples);
  std::vector<std::optional<Swept>> sweeps(samples.size());
  numerics::parallel_for(sweeps.size(), count < samples_worth_a_thread ? 1 : 0, [&](std::size_t k) {
    sweeps[k] = sweep_in(*samples[k], records.header().sample_rate);
  });
  std::optional<Swept> all;
  for (const auto& own : sweeps) {
    if (own && all) all = Swept{std::min(all->from, own->from), std::max(all->to, own->to)};
    if (own && !all) all = own;
  }
  if (all && (records.files().size() > 1 || !beginning.is_whole()))
    all = Swept{0.0, 0.5 * records.header().sample_rate};
  return all;
}

SpectrumOptions spectrum_options(data::RecordSet& records, const Plan& plan,
                                 const MeasureOptions& options, std::int64_t shortest,
                                 Beginning& beginning, std::optional<Swept>& sweep) {
  SpectrumOptions o{.window = options.window};
  if (options.overlap)
    o.overlap = *options.overlap;
  else if (options.window == Window::rectangular)
    o.overlap = 0.0;
  constexpr std::int64_t shortest_period = 8;
  const auto period = period_to_use(records, plan, options, shortest, beginning);
  o.periodic = period >= shortest_period;
  if (o.periodic) {
    o.block_length = static_cast<int>(period);
    return o;
  }
  o.block_length = block_to_use(records, plan, options, shortest);
  sweep = sweep_of(records, plan, beginning);
  // then all samples weigh the same at every lag: a sweep is not cut into pieces
  const bool leaves_gaps =
      plan.estimator == Estimator::instrumental &&
      !fills_band(beginning.of(plan.choice.instruments[0]), o.block_length, options.filled);
  if (!options.overlap && o.window != Window::rectangular && (leaves_gaps || sweep))
    o.overlap = 0.75;
  return o;
}

/// Columns of the record.
std::vector<Index> corrected_columns(const Reading& reading) {
  std::vector<Index> columns;
  for (const int o : reading.clocks->outputs)
    columns.push_back(static_cast<Index>(reading.used[static_cast<std::size_t>(o)]));
  return columns;
}

}  // namespace

bool is_worth_a_thread(const Reading& reading) {
  return reading.spectrum.threads != 1 &&
         reading.total * std::ssize(reading.used) >= samples_worth_a_thread;
}

std::int64_t settling_samples(const data::RecordSet& records, const MeasureOptions& options) {
  constexpr double most = 9e15;  // beyond every record, and an integer
  return std::llround(std::min(options.settling * records.header().sample_rate, most));
}

Reading plan_reading(data::RecordSet& records, Plan& plan, const MeasureOptions& options,
                     Beginning& beginning) {
  Reading reading{.settling = settling_samples(records, options)};
  auto shortest = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = 0; k < records.files().size(); ++k) {
    const std::int64_t count = records.count_samples(k);
    shortest = std::min(shortest, count);
    reading.total += count;
  }
  if (reading.settling > 0 && reading.settling >= shortest)
    base::refuse(
        records.files()[0],
        fmt::format("{:g} s are left out as settling, and the record has {:g} s", options.settling,
                    static_cast<double>(shortest) / records.header().sample_rate));
  reading.spectrum = spectrum_options(records, plan, options, shortest, beginning, reading.sweep);
  beginning.release();
  reading.used = used_channels(plan.choice);
  reading.plan = plan;
  reading.spectrum.inputs =
      plan.estimator == Estimator::instrumental ? plan.choice.instruments : plan.choice.inputs;
  reading.gap_plan = {.channels = reading.used,
                      .groups = groups_to_fill(plan.choice, plan.estimator),
                      .draw = plan.estimator == Estimator::half_spectra,
                      .settling = reading.settling,
                      .block_length = reading.spectrum.block_length};
  return reading;
}

Streamed stream_read(data::RecordSet& records, const Reading& reading,
                     const numerics::Progress& progress,
                     const std::function<void(std::size_t)>& begin,
                     const std::function<void(const Eigen::Ref<const data::Samples>&)>& add) {
  std::int64_t samples = 0, of_record = 0;
  std::optional<std::size_t> begun;
  std::optional<GapFiller> filler;
  std::optional<ClockCorrector> corrector;
  if (reading.clocks)
    corrector.emplace(corrected_columns(reading), records.header().sample_rate,
                      reading.clocks->ratio, add);
  const auto at_one_clock = [&](const Eigen::Ref<const data::Samples>& block) {
    if (corrector)
      corrector->add(block);
    else
      add(block);
  };
  const auto deliver = [&](const Eigen::Ref<const data::Samples>& block) {
    if (reading.tones.empty()) {
      at_one_clock(block);
    } else {
      data::Samples rest = block;
      subtract_tones(reading.tones, reading.used, *begun, of_record, rest);
      at_one_clock(rest);
    }
    of_record += block.rows();
  };
  if (reading.gaps) filler.emplace(*reading.gaps, deliver);
  const bool whole =
      records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
        if (begun != file) {
          if (filler) filler->end_record();
          if (corrector) corrector->end_record();
          begin(file);
          of_record = 0;
        }
        begun = file;
        if (filler)
          filler->add(block);
        else
          deliver(block);
        samples += block.rows();
        const auto total = static_cast<double>(std::max<std::int64_t>(reading.total, 1));
        return !(progress && progress(static_cast<double>(samples) / total));
      });
  if (filler) filler->end_record();
  if (corrector) corrector->end_record();
  return {samples, whole, filler ? filler->unknown_share() : 0.0};
}

namespace {

/// Streams all files into the estimator, and past `clocks`, where there is such a search.
Streamed read_into(SpectrumEstimator& estimator, data::RecordSet& records, const Reading& reading,
                   const numerics::Progress& progress, Measurement& m,
                   ClockSearch* clocks = nullptr) {
  const auto streamed = stream_read(
      records, reading, progress,
      [&](std::size_t record) {
        estimator.begin_record(reading.settling);
        if (clocks != nullptr) clocks->begin_record(record);
      },
      [&](const Eigen::Ref<const data::Samples>& block) {
        estimator.add(block);
        if (clocks != nullptr) clocks->add(block);
      });
  m.samples = streamed.samples;
  m.interrupted = !streamed.whole;
  m.notes = records.notes();
  return streamed;
}

/// Reads all files into m.spectra.
Streamed read_once(data::RecordSet& records, const Reading& reading,
                   const numerics::Progress& progress, Measurement& m) {
  SpectrumEstimator estimator(m.header, reading.spectrum, reading.used);
  const auto streamed = read_into(estimator, records, reading, progress, m);
  m.spectra = estimator.result();
  return streamed;
}

/// Whether outputs have another clock, by samples that are in memory; none after `stop`.
std::optional<ClockDifference> clocks_in(data::RecordSet& records, const Reading& reading,
                                         const std::atomic<bool>& stop) {
  ClockSearch search(records, reading.used, reading.plan.choice, reading.settling);
  std::optional<std::size_t> begun;
  const bool whole =
      records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
        if (begun != file) search.begin_record(file);
        begun = file;
        search.add(block);
        return !stop.load(std::memory_order_relaxed);
      });
  return whole ? search.result() : std::nullopt;
}

/// Reads into the estimator and says whether outputs have another clock. Samples in memory are
/// looked at for that on another thread.
std::optional<ClockDifference> read_and_compare(SpectrumEstimator& estimator,
                                                data::RecordSet& records, const Reading& reading,
                                                const numerics::Progress& progress,
                                                Measurement& m) {
  auto own = is_worth_a_thread(reading) ? records.of_memory() : std::nullopt;
  if (!own) {
    ClockSearch search(records, reading.used, reading.plan.choice, reading.settling);
    read_into(estimator, records, reading, progress, m, &search);
    return m.interrupted ? std::nullopt : search.result();
  }
  Background<std::optional<ClockDifference>> search(
      std::move(*own), [&](data::RecordSet& set, const std::atomic<bool>& stop) {
        return clocks_in(set, reading, stop);
      });
  read_into(estimator, records, reading, progress, m);
  return m.interrupted ? std::nullopt : search.result();
}

/// As read_once(), and once more where outputs have another clock than inputs, at one clock.
void read_at_one_clock(data::RecordSet& records, Reading& reading,
                       const numerics::Progress& progress, Measurement& m) {
  const auto& choice = reading.plan.choice;
  if (reading.plan.estimator != Estimator::h1 || reading.spectrum.periodic) {
    read_once(records, reading, progress, m);
    return;
  }
  {
    SpectrumEstimator estimator(m.header, reading.spectrum, reading.used);
    // the search has ended before the spectra are formed: both are large
    reading.clocks = read_and_compare(estimator, records, reading, progress, m);
    if (!reading.clocks) {
      m.spectra = estimator.result();
      return;
    }
  }
  read_once(records, reading, {}, m);
  const auto name = [&](int c) {
    return records.header().channels[reading.used[static_cast<std::size_t>(c)]].name;
  };
  m.responses.warnings.push_back({.kind = data::ResponseWarning::Kind::two_clocks,
                                  .channel = name(reading.clocks->outputs.front()),
                                  .other = name(choice.inputs.front()),
                                  .value = reading.clocks->ratio,
                                  .share = std::abs(reading.clocks->turn),
                                  .count = std::ssize(reading.clocks->outputs),
                                  .total = std::ssize(choice.outputs)});
}

/// Once more, without samples that stand still where they cannot.
void read_without_held(data::RecordSet& records, const Reading& reading, Measurement& m) {
  if (m.interrupted || !may_be_held(m.spectra)) return;
  auto held = find_held(records, reading.used, reading.plan.choice);
  if (held.stretches.empty()) return;
  auto missing = records.taken_as_missing();  // spikes
  missing.insert(missing.end(), held.stretches.begin(), held.stretches.end());
  records.take_as_missing(std::move(missing));
  read_once(records, reading, {}, m);
  auto& warnings = m.responses.warnings;
  warnings.insert(warnings.end(), held.warnings.begin(), held.warnings.end());
}

bool inputs_are_cut_off(const CrossSpectra& spectra, const std::vector<int>& inputs) {
  constexpr std::int64_t few = 3;  // the largest of a channel is one
  return std::ranges::any_of(inputs, [&](int c) {
    const auto& health = spectra.health[static_cast<std::size_t>(c)];
    return health.in_flat_tops > 0 || health.at_limit > few;
  });
}

}  // namespace

void read_spectra(data::RecordSet& records, Reading& reading, const numerics::Progress& progress,
                  Measurement& m) {
  read_at_one_clock(records, reading, progress, m);
  read_without_held(records, reading, m);
  reading.inputs_cut_off = inputs_are_cut_off(m.spectra, reading.plan.choice.inputs);
  if (!misses_samples(m.spectra) || reading.spectrum.periodic || m.interrupted) return;
  const auto as_read = m.spectra;
  reading.gaps = std::make_shared<GapModel>(records, reading.gap_plan);
  const auto streamed = read_once(records, reading, {}, m);
  m.spectra.health = as_read.health;
  m.responses.warnings.push_back(warning_of_missing(as_read, streamed.unknown_share));
}

std::vector<Tone> tones_in(data::RecordSet& records, const Reading& reading, const Plan& plan,
                           const CrossSpectra& spectra,
                           std::vector<data::ResponseWarning>& warnings) {
  const auto& c = plan.choice;
  const bool loop = plan.estimator == Estimator::instrumental;
  auto tones = find_tones(records,
                          {.channels = reading.used,
                           .settling = reading.settling,
                           .block = reading.spectrum.block_length,
                           .periodic = reading.spectrum.periodic},
                          spectra, loop ? c.instruments : c.inputs);
  for (const auto& tone : take_ringing(tones))
    if (loop)
      warnings.push_back({.kind = data::ResponseWarning::Kind::rings, .value = tone.frequency});
  return tones;
}

void subtract_found_tones(data::RecordSet& records, const Plan& plan, Reading& reading,
                          Measurement& m) {
  if (m.interrupted) return;
  reading.tones = tones_in(records, reading, plan, m.spectra, m.responses.warnings);
  if (reading.tones.empty()) return;
  const auto health = m.spectra.health;
  read_once(records, reading, {}, m);
  m.spectra.health = health;
}

}  // namespace hydrapod::identification
