#include "short_record.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "block_length.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "identify_steps.hpp"
#include "line_noise.hpp"
#include "lower_quality.hpp"
#include "record_band.hpp"
#include "record_fit.hpp"
#include "response_checks.hpp"
#include "search.hpp"
#include "varx.hpp"

namespace hydrapod::identification {

namespace {

using Kind = data::ResponseWarning::Kind;

/// Samples of the channels that are used, a matrix per record, after what settles.
std::vector<MatrixXd> used_samples(data::RecordSet& records, const Reading& reading) {
  std::vector<std::vector<double>> all;
  std::int64_t to_skip = 0;
  const auto width = static_cast<Index>(reading.used.size());
  stream_read(
      records, reading, {},
      [&](std::size_t) {
        all.emplace_back();
        to_skip = reading.settling;
      },
      [&](const Eigen::Ref<const data::Samples>& block) {
        for (Index t = 0; t < block.rows(); ++t) {
          if (to_skip-- > 0) continue;
          for (const auto c : reading.used) all.back().push_back(block(t, static_cast<Index>(c)));
        }
      });
  std::vector<MatrixXd> samples;
  for (const auto& list : all)
    samples.push_back(
        data::Samples::Map(list.data(), static_cast<Index>(list.size()) / width, width));
  return samples;
}

Piece piece_of(const MatrixXd& samples, const ChannelChoice& choice) {
  const std::vector<Index> u(choice.inputs.begin(), choice.inputs.end()),
      y(choice.outputs.begin(), choice.outputs.end());
  return {samples(Eigen::all, u), samples(Eigen::all, y)};
}

/// A model of the time record in its band.
struct TimeModel {
  Band band{};
  Signals signals{};  ///< at the lower rate
  Varx model{};
  std::vector<OrderPoles> chart{};
  std::vector<PoleCluster> clusters{};
};

TimeModel time_model(const Signals& signals, const Band& band, const IdentifyOptions& options) {
  TimeModel m{.band = band, .signals = decimated(signals, band.to, options.record.nyquist_room)};
  m.model = fit_varx(m.signals);
  m.chart = realised_poles(m.model, options.record.orders);
  for (auto& order : m.chart)
    std::erase_if(order.poles, [&](const PoleEstimate& e) {
      return e.omega() < two_pi * band.from || e.omega() > two_pi * band.to;
    });
  m.clusters = select_poles(m.chart, options.record.selection);
  return m;
}

/// [Hz]; 0: there is none.
double highest_pole(const TimeModel& m, const IdentifyOptions& options) {
  double highest = 0.0;
  for (const auto& c : m.clusters)
    if (c.representative.damping_ratio() <= options.highest_damping)
      highest = std::max(highest, c.representative.omega() / two_pi);
  return highest;
}

/// In the band where the outputs are heard, narrowed while all poles are in its lower part.
TimeModel model_in_best_band(const Signals& signals, const std::optional<Swept>& sweep,
                             const IdentifyOptions& options) {
  const double most = options.record.nyquist_room * 0.5 * signals.sample_rate;
  Band band{options.from.value_or(0.0), most};
  if (sweep && sweep->from > 0.0) {
    // Where it passes all is heard, and above nothing. What rings from its beginning is below too:
    // without these lines a sharp mode near the beginning comes out as another, and looks certain.
    band.to = std::min(most, sweep->to);
  } else {
    const double heard = audible_end(signals, options.record.audible_chance).value_or(most);
    band.to = std::min(most, options.band.fit_room * heard);
  }
  if (options.to) band.to = std::min(*options.to, most);
  TimeModel m = time_model(signals, band, options);
  for (int round = 0; !options.to && round < options.band.rounds; ++round) {
    const double highest = highest_pole(m, options);
    const double to = options.band.room * highest;
    if (highest == 0.0 || to > options.band.worth * m.band.to) break;
    m = time_model(signals, {m.band.from, to}, options);
  }
  return m;
}

/// ln of the likelihood ratio, and the share of the inputs' innovations that outputs explain.
struct Feedback {
  double ratio{}, degrees{}, share{};
};

/// Do inputs follow outputs?
Feedback feedback_in(const Signals& signals) {
  std::vector<Regression> alone, both;
  for (const auto& piece : signals.pieces) {
    alone.push_back({MatrixXd(piece.inputs.rows(), 0), piece.inputs});
    both.push_back({piece.outputs, piece.inputs});
  }
  VarxOptions options{.direct = false};
  const Varx with = fit_varx(both, signals.sample_rate, signals.touched, options);
  options.order = with.order;
  const Varx without = fit_varx(alone, signals.sample_rate, signals.touched, options);
  const Index p = with.innovation.rows();
  const auto left = [&](const Varx& model) {
    // what is predicted but for 1e-6 of its power is exact
    const MatrixXd S =
        model.innovation * (1.0 - static_cast<double>(model.theta.rows()) / model.rows) +
        1e-6 * MatrixXd::Identity(p, p);
    return std::log(S.determinant());
  };
  const double gain = left(without) - left(with);
  Feedback f;
  f.degrees = static_cast<double>(p * with.input_size.size() * with.order);
  f.ratio = with.rows * gain;
  f.share = 1.0 - std::exp(-(gain - f.degrees / with.rows) / static_cast<double>(p));
  return f;
}

/// None: the inputs do not follow the outputs.
std::optional<Feedback> feedback_of(const Signals& signals, const FewBlocks& rules) {
  // not of the lower rate, whose filter lets the outputs know of inputs that are to come
  const auto f = feedback_in(signals);
  const bool follows = f.share > rules.feedback &&
                       f.ratio > numerics::chi_squared_quantile(1.0 - rules.feedback_chance,
                                                                static_cast<int>(f.degrees));
  return follows ? std::optional(f) : std::nullopt;
}

/// Are averages the better choice unasked: lines are many, and blocks enough for any?
bool takes_long(const Signals& signals, const BlockCount& blocks, std::size_t inputs, bool is_sweep,
                const MeasureOptions& options) {
  if (options.whole_record || blocks.fit < fewest_blocks(inputs) - 1.0) return false;
  const RecordOptions rules;
  const double nyquist = 0.5 * signals.sample_rate;
  const double heard = audible_end(signals, rules.audible_chance).value_or(nyquist);
  const double duration = static_cast<double>(signals.samples()) / signals.sample_rate;
  return duration * std::min(nyquist, heard) >
         (is_sweep ? SweepRules().most_lines : options.few_blocks.few_lines);
}

/// Is the record one of a loop? Asked of excitations too: what is called so by its name and unit
/// may be measured in a loop. Who asks for the whole record knows what they commanded, and gets an
/// error for other inputs.
std::optional<Feedback> loop_of(const Signals& signals, const std::vector<data::Channel>& inputs,
                                const MeasureOptions& options) {
  if (!options.whole_record) return feedback_of(signals, options.few_blocks);
  const bool commanded =
      std::ranges::all_of(inputs, [](const auto& c) { return c.role == data::Role::excitation; });
  const auto f = commanded ? std::nullopt : feedback_of(signals, options.few_blocks);
  if (!f) return {};
  throw base::ComputationError(fmt::format(
      "the record is short, and its inputs follow its outputs (what they did before explains "
      "{:.0f} "
      "% of what the inputs' own past does not): in a loop, modes are not "
      "estimated from the whole record at once; leave --whole-record out, name the excitations "
      "with --instruments, and record longer",
      100.0 * f->share));
}

void refuse_few_numbers(const RecordLines& lines, const Band& band,
                        const IdentifyOptions& options) {
  const double terms = options.fit.highest_residual_power - lowest_residual_power + 1;
  const double inputs = static_cast<double>(lines.U.cols() + lines.records);
  const double needed = std::max(options.record.fewest_numbers * 0.5 * (2.0 + terms * inputs),
                                 static_cast<double>(fewest_lines));
  if (static_cast<double>(lines.size()) >= needed) return;
  throw base::ComputationError(fmt::format(
      "the record is too short: its band of {:.4g} Hz to {:.4g} Hz has {} lines, and the response "
      "to {} input{} needs {:.0f}; record longer, or with fewer inputs at once",
      band.from, band.to, lines.size(), lines.U.cols(), lines.U.cols() == 1 ? "" : "s",
      std::ceil(needed)));
}

void refuse_few_periods(const Identification& found, double duration,
                        const RecordOptions& options) {
  if (found.modes.empty()) return;
  const auto& lowest = found.modes.front().fit;
  const double f = lowest.omega() / two_pi;
  if (f * duration >= options.fewest_periods) return;
  throw base::ComputationError(
      fmt::format("the record is too short: it has {:.1f} periods of a mode at {:.3g} Hz, and {:g} "
                  "are needed; record at least {:.3g} s",
                  f * duration, f, options.fewest_periods, options.fewest_periods / f));
}

}  // namespace

bool asks_for_blocks(const MeasureOptions& options) {
  return options.block_length || options.overlap || options.estimator || options.period ||
         options.window != Window::hann;
}

namespace {

BlockCount blocks_in(const data::RecordSet& records, const Reading& reading,
                     const MeasureOptions& options) {
  const auto left = static_cast<double>(
      reading.total - reading.settling * static_cast<std::int64_t>(records.files().size()));
  return {left / static_cast<double>(reading.spectrum.block_length),
          options.few_blocks.fewest * fewest_blocks(reading.plan.choice.inputs.size())};
}

}  // namespace

std::optional<BlockCount> too_few_blocks(const data::RecordSet& records, const Reading& reading,
                                         const MeasureOptions& options) {
  const auto& plan = reading.plan;
  const bool wanted = options.whole_record.value_or(true);
  if (!options.for_modes || !wanted || asks_for_blocks(options) || reading.spectrum.periodic ||
      (plan.estimator != Estimator::h1 && plan.estimator != Estimator::instrumental))
    return {};
  const auto blocks = blocks_in(records, reading, options);
  if (blocks.fit >= blocks.needed && !reading.sweep) return {};
  if (plan.estimator == Estimator::instrumental && !options.whole_record) return {};
  if (plan.estimator == Estimator::instrumental)
    throw base::ComputationError(
        "modes in a loop are not estimated from the whole record at once: intervals would be too "
        "narrow; leave --whole-record out, or record longer");
  return blocks;
}

std::optional<data::ResponseWarning> warning_of_cut_sweep(const data::RecordSet& records,
                                                          const Reading& reading,
                                                          const MeasureOptions& options) {
  const auto blocks = blocks_in(records, reading, options);
  if (!reading.sweep || reading.spectrum.periodic || blocks.fit >= blocks.needed) return {};
  return data::ResponseWarning{
      .kind = Kind::cut_sweep,
      .value = static_cast<double>(reading.spectrum.block_length) / records.header().sample_rate,
      .count = static_cast<std::int64_t>(blocks.fit),
      .total = static_cast<std::int64_t>(std::ceil(blocks.needed)),
      .estimator = reading.plan.estimator};
}

bool keep_short_record(data::RecordSet& records, const Reading& reading, const BlockCount& blocks,
                       const MeasureOptions& options, const std::vector<PlatformChange>& changes,
                       ChannelChoice& choice, Measurement& m) {
  auto samples = used_samples(records, reading);
  for (const auto& matrix : samples)
    if (!matrix.allFinite()) return false;
  ChannelChoice alive = choice;  // without dead channels
  auto r = without_lines(m.spectra, reading.plan.estimator, alive, {.of_averages = false});
  auto record = std::make_shared<ShortRecord>();
  record->signals.sample_rate = m.header.sample_rate;
  for (auto& matrix : samples) {
    const MatrixXd brought = brought_to_platform(changes, std::move(matrix));
    record->signals.pieces.push_back(piece_of(brought, alive));
  }
  record->signals = detrended(std::move(record->signals));
  if (takes_long(record->signals, blocks, alive.inputs.size(), reading.sweep.has_value(), options))
    return false;
  if (const auto loop = loop_of(record->signals, r.inputs, options)) {
    m.responses.warnings.push_back(
        {.kind = Kind::feedback, .share = loop->share, .estimator = reading.plan.estimator});
    return false;
  }
  r.averages = 0.0;
  auto earlier = std::move(m.responses.warnings);
  r.warnings.insert(r.warnings.begin(), earlier.begin(), earlier.end());
  r.harmonics = std::move(m.responses.harmonics);
  const double duration = static_cast<double>(record->signals.samples()) / m.header.sample_rate;
  r.warnings.push_back(
      {.kind = Kind::short_record,
       .value = duration,
       .share = static_cast<double>(reading.spectrum.block_length) / m.header.sample_rate,
       .count = static_cast<std::int64_t>(blocks.fit),
       .total = reading.sweep ? 0 : static_cast<std::int64_t>(std::ceil(blocks.needed))});
  if (const auto& sweep = reading.sweep; sweep && sweep->from > 0.0)
    r.warnings.push_back({.kind = Kind::excited_band, .lowest = sweep->from, .highest = sweep->to});
  record->sweep = reading.sweep;
  choice = std::move(alive);
  m.responses = std::move(r);
  m.record = std::move(record);
  return true;
}

namespace {

/// H of the model of the time record, as what was measured: for pictures and comparisons.
FrequencyResponses shown(const TimeModel& m, const Identification& found,
                         const FrequencyResponses& measured, double duration) {
  auto r = responses_of(m.model, 1.0 / duration, std::max(found.to, 4.0 / duration));
  r.inputs = measured.inputs;
  r.outputs = measured.outputs;
  r.title = measured.title;
  r.date = measured.date;
  r.geometry = measured.geometry;
  r.estimator = measured.estimator;
  r.sample_rate = measured.sample_rate;
  r.harmonics = measured.harmonics;
  r.warnings = measured.warnings;
  return r;
}

}  // namespace

Identification identify_modes(const Measurement& measurement, const IdentifyOptions& options,
                              const std::function<void(double)>& progress) {
  if (measurement.record == nullptr)
    return identify_modes(measurement.responses, options, progress);
  const auto& record = *measurement.record;
  const auto& rules = options.record;
  Identification result;
  const TimeModel m = model_in_best_band(record.signals, record.sweep, options);
  if (progress) progress(0.3);
  const auto lines = lines_in_band(record.signals, m.band.from, m.band.to, m.model);
  refuse_few_numbers(lines, m.band, options);
  result.chart = m.chart;
  result.responses.inputs = measurement.responses.inputs;
  result.responses.outputs = measurement.responses.outputs;
  result.responses.sample_rate = record.signals.sample_rate;
  fit_record(options, lines, m.clusters, result);
  if (!result.model.modes.empty()) {
    leave_out_above(options, result);
    settle_residuals(options, result);
  }
  add_shape_deviations(options, result);
  const auto whole = result.model;
  auto harmonics = take_out_tones(options, lines, result);
  without_transients(lines.U.cols(), result.model);
  list_modes(options, result);
  auto of_inputs = std::exchange(result.model, whole);
  test_residual(options, result);
  add_warnings(options, result);
  result.model = std::move(of_inputs);
  result.responses = shown(m, result, measurement.responses, lines.duration);
  lower_quality(measurement.responses, result);
  auto& listed = result.responses.harmonics;
  listed.insert(listed.end(), harmonics.begin(), harmonics.end());
  std::ranges::sort(listed, {}, &data::Harmonic::frequency);
  refuse_few_periods(result, lines.duration, rules);
  return result;
}

}  // namespace hydrapod::identification
