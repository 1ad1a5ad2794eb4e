#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "beginning.hpp"
#include "block_length.hpp"
#include "bring_to_platform.hpp"
#include "channel_plan.hpp"
#include "damped.hpp"
#include "gaps.hpp"
#include "groups.hpp"
#include "held.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "measure_hits.hpp"
#include "names.hpp"
#include "response_checks.hpp"
#include "roving.hpp"
#include "spikes.hpp"
#include "tones.hpp"
#include "two_clocks.hpp"
#include "wandering_tones.hpp"

namespace hydrapod::identification {

namespace {

std::int64_t settling_samples(const data::RecordSet& records, const MeasureOptions& options) {
  return std::llround(options.settling * records.header().sample_rate);
}

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

SpectrumOptions spectrum_options(data::RecordSet& records, const Plan& plan,
                                 const MeasureOptions& options, std::int64_t shortest,
                                 Beginning& beginning) {
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
  // then all samples weigh the same at every lag: a sweep is not cut into pieces
  if (!options.overlap && o.window != Window::rectangular &&
      plan.estimator == Estimator::instrumental &&
      !fills_band(beginning.of(plan.choice.instruments[0]), o.block_length, options.filled))
    o.overlap = 0.75;
  return o;
}

}  // namespace

/// How the records are read.
struct Reading {
  Plan plan{};  ///< of the channels that are used
  SpectrumOptions spectrum{};
  std::vector<std::size_t> used{};   ///< channels
  std::int64_t settling{}, total{};  ///< samples
  GapPlan gap_plan{};
  std::shared_ptr<const GapModel> gaps{};   ///< none: samples are taken as they are
  std::vector<Tone> tones{};                ///< that are subtracted
  std::optional<ClockDifference> clocks{};  ///< by which outputs are corrected
};

namespace {

/// `plan`: its choice becomes one of the channels that are used.
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
  reading.spectrum = spectrum_options(records, plan, options, shortest, beginning);
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

struct Streamed {
  std::int64_t samples{};
  bool whole{};            ///< that is all
  double unknown_share{};  ///< see GapFiller
};

/// Columns of the record.
std::vector<Index> corrected_columns(const Reading& reading) {
  std::vector<Index> columns;
  for (const int o : reading.clocks->outputs)
    columns.push_back(static_cast<Index>(reading.used[static_cast<std::size_t>(o)]));
  return columns;
}

/// Looks for a second clock in records with inputs and outputs.
void find_clocks(data::RecordSet& records, Reading& reading, Measurement& m) {
  const auto& choice = reading.plan.choice;
  if (reading.plan.estimator != Estimator::h1 || reading.spectrum.periodic) return;
  reading.clocks = find_two_clocks(records, reading.used, choice, reading.settling);
  if (!reading.clocks) return;
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

/// add(samples) for all samples, filled where the reading says so, `estimator` being told where a
/// record begins.
template <class Add>
Streamed stream(data::RecordSet& records, const Reading& reading,
                const numerics::Progress& progress, SpectrumEstimator& estimator, const Add& add) {
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
          estimator.begin_record(reading.settling);
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

/// Reads all files into m.spectra.
Streamed read_once(data::RecordSet& records, const Reading& reading,
                   const numerics::Progress& progress, Measurement& m) {
  SpectrumEstimator estimator(m.header, reading.spectrum, reading.used);
  const auto streamed =
      stream(records, reading, progress, estimator,
             [&](const Eigen::Ref<const data::Samples>& block) { estimator.add(block); });
  m.samples = streamed.samples;
  m.interrupted = !streamed.whole;
  m.notes = records.notes();
  m.spectra = estimator.result();
  return streamed;
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

/// The same; where samples are missing they are filled, and it is said.
void read_spectra(data::RecordSet& records, Reading& reading, const numerics::Progress& progress,
                  Measurement& m) {
  read_once(records, reading, progress, m);
  read_without_held(records, reading, m);
  if (!misses_samples(m.spectra) || reading.spectrum.periodic || m.interrupted) return;
  const auto as_read = m.spectra;
  reading.gaps = std::make_shared<GapModel>(records, reading.gap_plan);
  const auto streamed = read_once(records, reading, {}, m);
  m.spectra.health = as_read.health;
  m.responses.warnings.push_back(warning_of_missing(as_read, streamed.unknown_share));
}

/// Periods with a missing sample are left out: where these are most, blocks that can be filled
/// serve better than the periods, unless those were asked for.
bool loses_periods(const CrossSpectra& spectra, const MeasureOptions& options) {
  return spectra.options.periodic && !options.period && spectra.blocks_left_out > spectra.blocks;
}

/// Finds tones in records whose spectra are known.
std::vector<Tone> tones_in(data::RecordSet& records, const Reading& reading, const Plan& plan,
                           const CrossSpectra& spectra) {
  const auto& c = plan.choice;
  return find_tones(records,
                    {.channels = reading.used,
                     .settling = reading.settling,
                     .block = reading.spectrum.block_length,
                     .periodic = reading.spectrum.periodic},
                    spectra, plan.estimator == Estimator::instrumental ? c.instruments : c.inputs);
}

/// Reads once more, without the tones, where there are some.
void subtract_found_tones(data::RecordSet& records, const Plan& plan, Reading& reading,
                          Measurement& m) {
  if (m.interrupted) return;
  reading.tones = tones_in(records, reading, plan, m.spectra);
  if (reading.tones.empty()) return;
  const auto health = m.spectra.health;
  read_once(records, reading, {}, m);
  m.spectra.health = health;
}

/// What tones are called in the results: amplitudes of outputs and inputs, those of the platform
/// where the spectra are brought there.
std::vector<data::Harmonic> harmonics_of(const std::vector<Tone>& tones, ChannelChoice choice,
                                         const MeasureOptions& options,
                                         const CrossSpectra& spectra) {
  if (tones.empty()) return {};
  Measurement m{.spectra = tone_spectra(tones, spectra)};
  bring_outputs_to_platform(options, choice, m);
  std::vector<data::Harmonic> list;
  for (std::size_t k = 0; k < tones.size(); ++k) {
    const VectorXd A =
        (2.0 * m.spectra.at(static_cast<Index>(k)).diagonal().real()).cwiseMax(0.0).cwiseSqrt();
    list.push_back({.frequency = tones[k].frequency, .amplitude = A(choice.outputs)});
  }
  return list;
}

/// Both estimates where both can be formed, and a warning where H1 is biased.
void compare_with_instrument(const Plan& plan, Measurement& m) {
  if (plan.choice.instruments.empty()) return;
  // both on the imaginary axis, at the same lines
  const bool instrumental = plan.estimator == Estimator::instrumental;
  const auto by_instrument = estimate_responses(m.spectra, plan.choice, Estimator::instrumental);
  m.h1_against_instrument = compare_responses(
      instrumental ? estimate_responses(m.spectra, plan.choice, Estimator::h1) : m.responses,
      by_instrument);
  constexpr double chance = 0.1;
  if (!instrumental && m.h1_against_instrument->share > chance)
    m.responses.warnings.push_back({.kind = data::ResponseWarning::Kind::biased,
                                    .value = m.h1_against_instrument->median,
                                    .share = m.h1_against_instrument->share,
                                    .estimator = plan.estimator});
}

/// What a reading gave, and whether it calls for a look at spikes.
struct Attempt {
  Measurement measured{};
  bool is_suspicious{};
};

/// `spikes`: which the records are read without.
Attempt responses_without(const std::vector<Spike>& spikes, data::RecordSet& records,
                          const MeasureOptions& options, const numerics::Progress& progress) {
  Measurement m{.header = records.header()};
  records.take_as_missing(stretches_of(spikes));
  Plan plan = plan_channels(records.files()[0], m.header, options);
  Beginning beginning(records, plan.choice, settling_samples(records, options));
  if (auto hits = measure_hits(records, plan, options, spikes, beginning))
    return {std::move(*hits), true};
  const Plan planned = plan;
  Reading reading = plan_reading(records, plan, options, beginning);
  find_clocks(records, reading, m);
  read_spectra(records, reading, progress, m);
  if (plan.estimator == Estimator::h1 && !m.interrupted)
    refuse_roving(records, m.spectra, reading.used, plan.choice);
  if (!m.interrupted && loses_periods(m.spectra, options)) {
    plan = planned;
    MeasureOptions own = options;
    own.period = 0.0;
    reading = plan_reading(records, plan, own, beginning);
    read_spectra(records, reading, {}, m);
  }
  const bool is_suspicious = may_have_spikes(m.spectra);
  subtract_found_tones(records, plan, reading, m);
  auto harmonics = harmonics_of(reading.tones, plan.choice, options, m.spectra);
  bring_outputs_to_platform(options, plan.choice, m);
  const auto earlier = std::move(m.responses.warnings);
  m.responses = responses_for_modes(m.spectra, plan.choice, plan.estimator);
  m.responses.harmonics = std::move(harmonics);
  m.responses.warnings.insert(m.responses.warnings.begin(), earlier.begin(), earlier.end());
  compare_with_instrument(plan, m);
  m.choice = std::move(plan.choice);
  m.reading = std::make_shared<const Reading>(std::move(reading));
  return {std::move(m), is_suspicious};
}

Attempt outputs_without(const std::vector<Spike>& spikes, data::RecordSet& records,
                        const MeasureOptions& options, const numerics::Progress& progress) {
  Measurement m{.header = records.header()};
  records.take_as_missing(stretches_of(spikes));
  Plan plan = plan_outputs(records.files()[0], m.header, options);
  MeasureOptions own = options;
  own.period = 0.0;
  Beginning beginning(records, plan.choice, settling_samples(records, options));
  Reading reading = plan_reading(records, plan, own, beginning);
  read_spectra(records, reading, progress, m);
  const bool is_suspicious = may_have_spikes(m.spectra);
  HalfSpectraOptions half;
  if (!m.interrupted)
    half.wandering = find_wandering_tones(records, reading.used, reading.settling, m.spectra,
                                          plan.choice.outputs);
  bring_outputs_to_platform(options, plan.choice, m);
  const auto earlier = std::move(m.responses.warnings);
  m.responses = half_spectra(m.spectra, plan.choice.outputs, half);
  m.responses.warnings.insert(m.responses.warnings.begin(), earlier.begin(), earlier.end());
  return {std::move(m), is_suspicious};
}

/// measure(spikes), and once more where there are some.
template <class Measure>
Measurement without_spikes(data::RecordSet& records, Plan plan, const Measure& measure) {
  Attempt attempt = measure(std::vector<Spike>());
  if (!attempt.is_suspicious || attempt.measured.interrupted) return std::move(attempt.measured);
  records.take_as_missing({});
  const auto spikes = leave_out_spikes(records, used_channels(plan.choice));
  if (spikes.empty()) return std::move(attempt.measured);
  Measurement m = measure(spikes).measured;
  const auto warnings = warnings_of_spikes(spikes, records.header());
  m.responses.warnings.insert(m.responses.warnings.begin(), warnings.begin(), warnings.end());
  return m;
}

}  // namespace

Measurement measure_responses(data::RecordSet& records, const MeasureOptions& options,
                              const numerics::Progress& progress) {
  return without_spikes(records, plan_channels(records.files()[0], records.header(), options),
                        [&](const std::vector<Spike>& spikes) {
                          return responses_without(spikes, records, options, progress);
                        });
}

Measurement measure_outputs(data::RecordSet& records, const MeasureOptions& options,
                            const numerics::Progress& progress) {
  return without_spikes(records, plan_outputs(records.files()[0], records.header(), options),
                        [&](const std::vector<Spike>& spikes) {
                          return outputs_without(spikes, records, options, progress);
                        });
}

namespace {

void refuse_periods(const Reading& reading) {
  if (reading.spectrum.periodic)
    throw base::ComputationError("the excitation is periodic: there are no blocks to resample");
}

void read_groups(data::RecordSet& records, const Reading& reading, const MeasureOptions& options,
                 int groups, const numerics::Progress& progress, std::optional<double> highest,
                 const TakeGroup& take) {
  const auto& header = records.header();
  auto spectrum = reading.spectrum;
  if (highest && reading.plan.estimator != Estimator::instrumental) {
    // the last line that is formed is never used
    const double lines = *highest * spectrum.block_length / header.sample_rate + 3.0;
    spectrum.lines = static_cast<int>(std::min(lines, 1.0 + spectrum.block_length / 2));
  }
  const std::int64_t piece =
      std::max(reading.total / groups, std::int64_t{2} * spectrum.block_length);
  SpectrumEstimator estimator(header, spectrum, reading.used);
  const auto close = [&] {
    Measurement m{.spectra = SpectrumEstimator(std::move(estimator)).result()};  // it is large
    if (m.spectra.blocks == 0) return;
    auto choice = reading.plan.choice;
    bring_outputs_to_platform(options, choice, m);
    take(std::move(m.spectra), choice, reading.plan.estimator);
  };
  std::int64_t in_piece = 0;
  const auto add = [&](const Eigen::Ref<const data::Samples>& block) {
    for (Index at = 0; at < block.rows();) {
      const std::int64_t count = std::min(block.rows() - at, piece - in_piece);
      estimator.add(block.middleRows(at, count));
      at += count;
      in_piece += count;
      if (in_piece < piece) continue;
      close();
      estimator = SpectrumEstimator(header, spectrum, reading.used);
      in_piece = 0;
    }
  };
  stream(records, reading, progress, estimator, add);
  if (in_piece >= piece / 2) close();
}

GroupedSpectra read_groups(data::RecordSet& records, const Reading& reading,
                           const MeasureOptions& options, int groups,
                           const numerics::Progress& progress, std::optional<double> highest) {
  GroupedSpectra result{.estimator = reading.plan.estimator};
  read_groups(records, reading, options, groups, progress, highest,
              [&](CrossSpectra&& spectra, const ChannelChoice& choice, Estimator) {
                result.choice = choice;
                result.groups.push_back(std::move(spectra));
              });
  return result;
}

/// Throws where there are no blocks in groups.
const Reading& reading_of_blocks(const Measurement& measured) {
  if (measured.reading == nullptr)
    throw base::ComputationError("there are no blocks to resample: each record is a single hit");
  refuse_periods(*measured.reading);
  return *measured.reading;
}

}  // namespace

GroupedSpectra measure_groups(data::RecordSet& records, const MeasureOptions& options, int groups,
                              const numerics::Progress& progress) {
  Plan plan = plan_channels(records.files()[0], records.header(), options);
  Beginning beginning(records, plan.choice, settling_samples(records, options));
  Reading reading = plan_reading(records, plan, options, beginning);
  refuse_periods(reading);
  Measurement whole{.header = records.header()};
  read_spectra(records, reading, {}, whole);
  reading.tones = tones_in(records, reading, plan, whole.spectra);
  return read_groups(records, reading, options, groups, progress, {});
}

GroupedSpectra measure_groups(data::RecordSet& records, const Measurement& measured,
                              const MeasureOptions& options, int groups,
                              const numerics::Progress& progress, std::optional<double> highest) {
  return read_groups(records, reading_of_blocks(measured), options, groups, progress, highest);
}

void each_group(data::RecordSet& records, const Measurement& measured,
                const MeasureOptions& options, int groups, const numerics::Progress& progress,
                std::optional<double> highest, const TakeGroup& take) {
  read_groups(records, reading_of_blocks(measured), options, groups, progress, highest, take);
}

}  // namespace hydrapod::identification
