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
#include "lost_rows.hpp"
#include "measure_hits.hpp"
#include "names.hpp"
#include "reading.hpp"
#include "response_checks.hpp"
#include "roving.hpp"
#include "run_up.hpp"
#include "short_record.hpp"
#include "spikes.hpp"
#include "tones.hpp"
#include "wandering_tones.hpp"

namespace hydrapod::identification {

namespace {

/// Periods with a missing sample are left out: where these are most, blocks that can be filled
/// serve better than the periods, unless those were asked for.
bool loses_periods(const CrossSpectra& spectra, const MeasureOptions& options) {
  return spectra.options.periodic && !options.period && spectra.blocks_left_out > spectra.blocks;
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

/// Throws where the modes of the record in one piece were asked for, and averages are what is to be
/// had; `why` that is so.
void refuse_averages(const MeasureOptions& options, const char* why) {
  if (!options.for_modes || !options.whole_record.value_or(false) || asks_for_blocks(options))
    return;
  throw base::ComputationError(
      fmt::format("modes are estimated from the whole record at once where it is too short for "
                  "averages of blocks, and {}; leave --whole-record out",
                  why));
}

/// What a reading gave, and whether it calls for a look at spikes.
struct Attempt {
  Measurement measured{};
  bool is_suspicious{};
  std::shared_ptr<const Reading> reading{};     ///< none: hits
  std::unique_ptr<LostRowsSearch> lost_rows{};  ///< none: hits, or they are left out
};

/// What is taken as missing before the records are read.
struct Faults {
  std::vector<Spike> spikes{};
  std::vector<data::RecordSet::Stretch> lost_rows{};

  [[nodiscard]] std::vector<data::RecordSet::Stretch> stretches() const {
    auto all = stretches_of(spikes);
    all.insert(all.end(), lost_rows.begin(), lost_rows.end());
    return all;
  }
};

std::unique_ptr<LostRowsSearch> search_beside(const Faults& faults, const data::RecordSet& records,
                                              const Reading& reading) {
  return faults.lost_rows.empty() ? std::make_unique<LostRowsSearch>(records, reading) : nullptr;
}

Attempt responses_without(const Faults& faults, data::RecordSet& records,
                          const MeasureOptions& options, const numerics::Progress& progress) {
  Measurement m{.header = records.header()};
  records.take_as_missing(faults.stretches());
  Plan plan = plan_channels(records.files()[0], m.header, options);
  Beginning beginning(records, plan.choice, settling_samples(records, options));
  if (auto hits = measure_hits(records, plan, options, faults.spikes, beginning)) {
    refuse_averages(options, "this one is of hits, each of which is a block");
    return {.measured = std::move(*hits), .is_suspicious = true};
  }
  const Plan planned = plan;
  Reading reading = plan_reading(records, plan, options, beginning);
  auto lost_rows = search_beside(faults, records, reading);
  read_spectra(records, reading, progress, m);
  if (plan.estimator == Estimator::h1 && !m.interrupted)
    refuse_roving(records, m.spectra, reading.used, plan.choice);
  if (!m.interrupted && loses_periods(m.spectra, options)) {
    plan = planned;
    MeasureOptions own = options;
    own.period = 0.0;
    reading = plan_reading(records, plan, own, beginning);
    lost_rows = search_beside(faults, records, reading);
    read_spectra(records, reading, {}, m);
  }
  const bool is_suspicious = may_have_spikes(m.spectra);
  subtract_found_tones(records, plan, reading, m);
  auto harmonics = harmonics_of(reading.tones, plan.choice, options, m.spectra);
  const auto changes = bring_outputs_to_platform(options, plan.choice, m);
  const auto blocks = too_few_blocks(records, reading, options);
  if (blocks && !m.interrupted) {
    m.responses.harmonics = harmonics;
    if (keep_short_record(records, reading, *blocks, options, changes, plan.choice, m)) {
      m.choice = std::move(plan.choice);
      const auto shared = m.reading = std::make_shared<const Reading>(std::move(reading));
      return {std::move(m), is_suspicious, shared, std::move(lost_rows)};
    }
  }
  if (!m.interrupted)
    refuse_averages(options, blocks ? "samples of this one are missing that cannot be filled"
                                    : "this one is not, or its excitation is periodic");
  if (const auto cut = warning_of_cut_sweep(records, reading, options))
    m.responses.warnings.push_back(*cut);
  const auto earlier = std::move(m.responses.warnings);
  m.responses = responses_for_modes(m.spectra, plan.choice, plan.estimator);
  m.responses.harmonics = std::move(harmonics);
  m.responses.warnings.insert(m.responses.warnings.begin(), earlier.begin(), earlier.end());
  compare_with_instrument(plan, m);
  m.choice = std::move(plan.choice);
  const auto shared = m.reading = std::make_shared<const Reading>(std::move(reading));
  return {std::move(m), is_suspicious, shared, std::move(lost_rows)};
}

Attempt outputs_without(const Faults& faults, data::RecordSet& records,
                        const MeasureOptions& options, const numerics::Progress& progress) {
  Measurement m{.header = records.header()};
  records.take_as_missing(faults.stretches());
  Plan plan = plan_outputs(records.files()[0], m.header, options);
  MeasureOptions own = options;
  own.period = 0.0;
  Beginning beginning(records, plan.choice, settling_samples(records, options));
  Reading reading = plan_reading(records, plan, own, beginning);
  auto lost_rows = search_beside(faults, records, reading);
  read_spectra(records, reading, progress, m);
  const bool is_suspicious = may_have_spikes(m.spectra);
  HalfSpectraOptions half;
  if (!m.interrupted)
    half.wandering = find_wandering_tones(records, reading.used, reading.settling, m.spectra,
                                          plan.choice.outputs);
  if (!m.interrupted)
    if (const auto passed =
            find_run_up(records, reading.used, reading.settling, m.spectra, plan.choice.outputs))
      m.responses.warnings.push_back({.kind = data::ResponseWarning::Kind::run_up,
                                      .share = passed->brevity,
                                      .lowest = passed->lowest,
                                      .highest = passed->highest});
  bring_outputs_to_platform(options, plan.choice, m);
  const auto earlier = std::move(m.responses.warnings);
  m.responses = half_spectra(m.spectra, plan.choice.outputs, half);
  m.responses.warnings.insert(m.responses.warnings.begin(), earlier.begin(), earlier.end());
  return {std::move(m), is_suspicious, std::make_shared<const Reading>(std::move(reading)),
          std::move(lost_rows)};
}

/// Once more without the places where rows were lost, if there are some.
template <class Measure>
void leave_out_lost_rows(data::RecordSet& records, const Measure& measure, Faults faults,
                         const Attempt& attempt, Measurement& m) {
  if (attempt.lost_rows == nullptr || m.interrupted) return;
  const auto before = records.taken_as_missing();
  const auto lost = attempt.lost_rows->result(records, *attempt.reading);
  if (lost.places == 0) return;
  faults.lost_rows = lost.stretches;
  std::optional<Measurement> rest;
  try {
    rest = measure(faults).measured;
  } catch (const base::ComputationError&) {  // too little is left
  }
  if (rest && rest->interrupted) {
    m = std::move(*rest);
    return;
  }
  const auto without = records.taken_as_missing();
  take_without_lost_rows(lost, std::move(rest), records, m);
  const bool taken = m.responses.warnings.back().total > 0;
  records.take_as_missing(taken ? without : before);
}

/// measure(what is left out): first nothing, then spikes, if there are some, then the places where
/// rows were lost.
template <class Measure>
Measurement without_faults(data::RecordSet& records, Plan plan, const Measure& measure) {
  Faults faults;
  Attempt attempt = measure(faults);
  if (attempt.is_suspicious && !attempt.measured.interrupted) {
    const auto read = records.taken_as_missing();
    records.take_as_missing({});
    faults.spikes = leave_out_spikes(records, used_channels(plan.choice));
    records.take_as_missing(read);
    if (!faults.spikes.empty()) attempt = measure(faults);
  }
  Measurement m = std::move(attempt.measured);
  leave_out_lost_rows(records, measure, faults, attempt, m);
  const auto warnings = warnings_of_spikes(faults.spikes, records.header());
  m.responses.warnings.insert(m.responses.warnings.begin(), warnings.begin(), warnings.end());
  return m;
}

}  // namespace

Measurement measure_responses(data::RecordSet& records, const MeasureOptions& options,
                              const numerics::Progress& progress) {
  records.keep_samples(options.most_kept);
  const auto& file = records.files()[0];
  const Plan plan = plan_channels(file, records.header(), options);
  const auto channels = [&](const std::vector<int>& list) {
    std::vector<data::Channel> some;
    for (const int c : list) some.push_back(records.header().channels[static_cast<std::size_t>(c)]);
    return some;
  };
  std::vector<data::ResponseWarning> of_inputs;
  if (options.for_modes)
    of_inputs = check_inputs(file, channels(plan.choice.inputs), channels(plan.choice.outputs));
  Measurement m = without_faults(records, plan, [&](const Faults& faults) {
    return responses_without(faults, records, options, progress);
  });
  m.responses.warnings.insert(m.responses.warnings.end(), of_inputs.begin(), of_inputs.end());
  return m;
}

Measurement measure_outputs(data::RecordSet& records, const MeasureOptions& options,
                            const numerics::Progress& progress) {
  records.keep_samples(options.most_kept);
  refuse_averages(options, "its inputs are known; outputs alone are always averaged");
  return without_faults(
      records, plan_outputs(records.files()[0], records.header(), options),
      [&](const Faults& faults) { return outputs_without(faults, records, options, progress); });
}

namespace {

void refuse_periods(const Reading& reading) {
  if (reading.spectrum.periodic)
    throw base::ComputationError("the excitation is periodic: there are no blocks to resample");
}

/// Of groups: lines above `highest` may be left out.
SpectrumOptions spectrum_up_to(std::optional<double> highest, const Reading& reading,
                               double sample_rate) {
  auto spectrum = reading.spectrum;
  if (highest && reading.plan.estimator != Estimator::instrumental) {
    // the last line that is formed is never used
    const double lines = *highest * spectrum.block_length / sample_rate + 3.0;
    spectrum.lines = static_cast<int>(std::min(lines, 1.0 + spectrum.block_length / 2));
  }
  return spectrum;
}

/// What an estimator has seen.
void deliver_group(SpectrumEstimator&& estimator, const Reading& reading,
                   const MeasureOptions& options, const TakeGroup& take) {
  Measurement m{.spectra = SpectrumEstimator(std::move(estimator)).result()};  // it is large
  if (m.spectra.blocks == 0) return;
  auto choice = reading.plan.choice;
  bring_outputs_to_platform(options, choice, m);
  take(std::move(m.spectra), choice, reading.plan.estimator);
}

void read_groups(data::RecordSet& records, const Reading& reading, const MeasureOptions& options,
                 int groups, const numerics::Progress& progress, std::optional<double> highest,
                 const TakeGroup& take) {
  const auto& header = records.header();
  const auto spectrum = spectrum_up_to(highest, reading, header.sample_rate);
  const std::int64_t piece =
      std::max(reading.total / groups, std::int64_t{2} * spectrum.block_length);
  SpectrumEstimator estimator(header, spectrum, reading.used);
  const auto close = [&] { deliver_group(std::move(estimator), reading, options, take); };
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
  stream_read(
      records, reading, progress, [&](std::size_t) { estimator.begin_record(reading.settling); },
      add);
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
  if (measured.record != nullptr)
    throw base::ComputationError("the record has too few blocks to resample");
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
  reading.tones = tones_in(records, reading, plan, whole.spectra, whole.responses.warnings);
  return read_groups(records, reading, options, groups, progress, {});
}

GroupedSpectra measure_groups(data::RecordSet& records, const Measurement& measured,
                              const MeasureOptions& options, int groups,
                              const numerics::Progress& progress, std::optional<double> highest) {
  return read_groups(records, reading_of_blocks(measured), options, groups, progress, highest);
}

GroupedSpectra measure_groups_in_blocks(data::RecordSet& records, const Measurement& measured,
                                        const MeasureOptions& options, int block_length, int groups,
                                        const numerics::Progress& progress,
                                        std::optional<double> highest) {
  if (measured.reading == nullptr)
    throw base::ComputationError("there are no blocks: each record is a single hit");
  refuse_periods(*measured.reading);
  Reading reading = *measured.reading;
  reading.spectrum.block_length = block_length;
  return read_groups(records, reading, options, groups, progress, highest);
}

void each_group(data::RecordSet& records, const Measurement& measured,
                const MeasureOptions& options, int groups, const numerics::Progress& progress,
                std::optional<double> highest, const TakeGroup& take) {
  read_groups(records, reading_of_blocks(measured), options, groups, progress, highest, take);
}

void each_record(
    data::RecordSet& records, const Measurement& measured, const MeasureOptions& options,
    const numerics::Progress& progress, std::optional<double> highest,
    const std::function<void(std::size_t record, CrossSpectra&& spectra,
                             const ChannelChoice& choice, Estimator estimator)>& take) {
  const Reading& reading = reading_of_blocks(measured);
  const auto& header = records.header();
  const auto spectrum = spectrum_up_to(highest, reading, header.sample_rate);
  std::optional<SpectrumEstimator> estimator;
  std::size_t open = 0;
  const auto close = [&] {
    if (estimator)
      deliver_group(std::move(*estimator), reading, options,
                    [&](CrossSpectra&& spectra, const ChannelChoice& choice, Estimator by) {
                      take(open, std::move(spectra), choice, by);
                    });
    estimator.reset();
  };
  const auto begin = [&](std::size_t record) {
    close();
    open = record;
    estimator.emplace(header, spectrum, reading.used);
    estimator->begin_record(reading.settling);
  };
  stream_read(records, reading, progress, begin,
              [&](const Eigen::Ref<const data::Samples>& block) { estimator->add(block); });
  close();
}

}  // namespace hydrapod::identification
