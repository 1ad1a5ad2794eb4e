#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "damped.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"
#include "response_checks.hpp"
#include "tones.hpp"

namespace hydrapod::identification {

namespace {

using data::Role;

std::vector<int> with_role(const data::RecordHeader& header, Role role) {
  std::vector<int> list;
  for (std::size_t c = 0; c < header.channels.size(); ++c)
    if (header.channels[c].role == role) list.push_back(static_cast<int>(c));
  return list;
}

/// All responses; but where the platform's motion or the six leg lengths are among sensors of
/// other kinds, these.
std::vector<int> default_outputs(const data::RecordHeader& header) {
  const auto six = [&](data::Direction first, const std::vector<std::string_view>& units) {
    return six_channels(header.channels, Role::response, first, units);
  };
  if (const auto platform = six(data::Direction::x, {"m", "rad"})) return *platform;
  return six(data::Direction::leg1, {"m"}).value_or(with_role(header, Role::response));
}

std::string names_of(const data::RecordHeader& header) {
  std::string text;
  for (const auto& c : header.channels) text += (text.empty() ? "" : ", ") + c.name;
  return text;
}

std::vector<int> with_names(const std::string& file, const data::RecordHeader& header,
                            const std::vector<std::string>& names) {
  std::vector<int> list;
  for (const auto& name : names) {
    const auto at = data::find_channel(header, name);
    if (!at) {
      std::vector<std::string_view> known;
      for (const auto& c : header.channels) known.push_back(c.name);
      const auto near = base::nearest(name, known);
      base::refuse(file, fmt::format("there is no channel '{}'; {}", name,
                                     near ? fmt::format("did you mean '{}'?", *near)
                                          : "the record has " + names_of(header)));
    }
    list.push_back(static_cast<int>(*at));
  }
  return list;
}

/// Do the drives stand between the excitations and the machine? They do where a controller makes
/// them from commanded motions or adds commands to them, and do not where the excitation is force.
bool inside_a_loop(const data::RecordHeader& header, const std::vector<int>& excitations,
                   const std::vector<int>& drives) {
  if (excitations.empty() || drives.size() != excitations.size()) return excitations.empty();
  return std::ranges::none_of(excitations, [&](int c) {
    return header.channels[static_cast<std::size_t>(c)].unit.starts_with("N");
  });
}

struct Plan {
  ChannelChoice choice{};
  Estimator estimator{Estimator::h1};
};

Plan plan_channels(const std::string& file, const data::RecordHeader& header,
                   const MeasureOptions& options) {
  Plan plan;
  auto& c = plan.choice;
  const auto excitations = with_role(header, Role::excitation);
  const auto drives = with_role(header, Role::drive);
  const bool from_drive = options.input_role ? *options.input_role == Role::drive
                                             : inside_a_loop(header, excitations, drives);
  c.inputs = !options.inputs.empty() ? with_names(file, header, options.inputs)
             : from_drive            ? drives
                                     : excitations;
  c.outputs =
      options.outputs.empty() ? default_outputs(header) : with_names(file, header, options.outputs);
  c.instruments =
      options.instruments.empty() ? excitations : with_names(file, header, options.instruments);
  const std::string advice =
      ": name channels with --inputs and --outputs; the record has " + names_of(header);
  if (c.inputs.empty())
    base::refuse(file, (!options.input_role ? "no channel has the role excitation or drive"
                        : from_drive        ? "no channel has the role drive"
                                            : "no channel has the role excitation") +
                           advice);
  if (c.outputs.empty()) base::refuse(file, "no channel has the role response" + advice);
  for (const int i : c.inputs)
    if (std::ranges::find(c.outputs, i) != c.outputs.end())
      base::refuse(file, fmt::format("channel '{}' is named as input and as output",
                                     header.channels[static_cast<std::size_t>(i)].name));
  const bool from_instrument = c.instruments.size() == c.inputs.size() && c.instruments != c.inputs;
  plan.estimator = options.estimator.value_or(
      from_instrument && c.inputs != excitations ? Estimator::instrumental : Estimator::h1);
  if (plan.estimator == Estimator::instrumental && c.instruments == c.inputs)
    base::refuse(
        file,
        "the instrumental estimate needs inputs other than the excitations: take the drives "
        "(--from-drive), or name them with --inputs");
  if (!from_instrument && plan.estimator != Estimator::instrumental) c.instruments.clear();
  return plan;
}

/// The first samples of a channel, up to a million.
VectorXd first_samples(data::RecordSet& records, int channel, std::int64_t skip) {
  constexpr std::size_t most = 1 << 20;
  std::vector<double> samples;
  std::int64_t seen = 0;
  records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    if (file > 0) return false;
    for (Index k = 0; k < block.rows() && samples.size() < most; ++k)
      if (seen + k >= skip) samples.push_back(block(k, channel));
    seen += block.rows();
    return samples.size() < most;
  });
  return VectorXd::Map(samples.data(), static_cast<Index>(samples.size()));
}

/// To see whether the first input repeats.
std::int64_t find_period(data::RecordSet& records, int channel, std::int64_t skip) {
  const VectorXd x = first_samples(records, channel, skip);
  if (x.size() < 32 || !x.allFinite()) return 0;
  return period_of(x.tail(x.size() - x.size() / 8));  // past a fade-in
}

/// That of the instruments, where there are records enough for responses from them: in a loop noise
/// makes the inputs differ from period to period. Else that of the inputs.
std::int64_t excitation_period(data::RecordSet& records, const ChannelChoice& choice,
                               std::int64_t skip) {
  if (!choice.instruments.empty() && records.files().size() >= choice.inputs.size())
    if (const auto period = find_period(records, choice.instruments[0], skip); period > 0)
      return period;
  return find_period(records, choice.inputs[0], skip);
}

bool fills_band(const VectorXd& x, int block, const FilledBand& options) {
  const VectorXd window = window_samples(Window::hann, block);
  numerics::RealFft fft(block);
  std::vector<Complex> lines(static_cast<std::size_t>(fft.lines()));
  VectorXd power = VectorXd::Zero(fft.lines());
  for (Index at = 0; at + block <= x.size(); at += block) {
    const VectorXd part = x.segment(at, block);
    const VectorXd windowed = window.cwiseProduct(part - VectorXd::Constant(block, part.mean()));
    fft.forward({windowed.data(), static_cast<std::size_t>(block)}, lines);
    for (Index k = 0; k < power.size(); ++k)
      power[k] += std::norm(lines[static_cast<std::size_t>(k)]);
  }
  const auto below = static_cast<Index>(options.pass_band * static_cast<double>(power.size()));
  return static_cast<double>(
             (power.head(below).array() > options.quiet * power.maxCoeff()).count()) >=
         options.most_lines * static_cast<double>(below);
}

std::int64_t settling_samples(const data::RecordSet& records, const MeasureOptions& options) {
  return std::llround(options.settling * records.header().sample_rate);
}

SpectrumOptions spectrum_options(data::RecordSet& records, const Plan& plan,
                                 const MeasureOptions& options, std::int64_t shortest) {
  const std::string& first = records.files()[0];
  SpectrumOptions o{.window = options.window};
  if (options.overlap)
    o.overlap = *options.overlap;
  else if (options.window == Window::rectangular)
    o.overlap = 0.0;
  std::int64_t period =
      options.period ? std::llround(*options.period * records.header().sample_rate)
      : options.block_length
          ? 0
          : excitation_period(records, plan.choice, settling_samples(records, options));
  if (period % 2 != 0) period *= 2;  // blocks have an even length
  if (period >= 8) {
    o.periodic = true;
    o.block_length = static_cast<int>(period);
    return o;
  }
  constexpr int shortest_block = 16;
  if (shortest < shortest_block)
    base::refuse(
        first,
        fmt::format("the record has {}: responses need blocks of at least {}, and several of them",
                    shortest == 0 ? "no samples" : fmt::format("only {} samples", shortest),
                    shortest_block));
  if (options.block_length) {
    o.block_length = *options.block_length;
  } else {
    // the instrumental estimate averages over neighbouring lines besides
    const double blocks_per_input = plan.estimator == Estimator::instrumental ? 2.0 : 4.0;
    // covariances of outputs want long lags more than many averages
    constexpr double of_outputs = 8.0;
    const double side_by_side =
        plan.estimator == Estimator::half_spectra
            ? of_outputs
            : blocks_per_input * static_cast<double>(plan.choice.inputs.size() + 2);
    const double total =
        static_cast<double>(shortest) * static_cast<double>(records.files().size());
    // the power of two that is nearest in ratio
    const auto wanted = static_cast<unsigned>(std::clamp(std::numbers::sqrt2 * total / side_by_side,
                                                         static_cast<double>(shortest_block),
                                                         static_cast<double>(1 << 17)));
    o.block_length = static_cast<int>(std::bit_floor(wanted));
    if (o.block_length > shortest)
      o.block_length = static_cast<int>(std::bit_floor(static_cast<unsigned>(shortest)));
  }
  if (o.block_length > shortest)
    base::refuse(first, fmt::format("the record has {} samples, fewer than one block of {}: take "
                                    "shorter blocks or a longer record",
                                    shortest, o.block_length));
  // then all samples weigh the same at every lag: a sweep is not cut into pieces
  if (!options.overlap && o.window != Window::rectangular &&
      plan.estimator == Estimator::instrumental &&
      !fills_band(
          first_samples(records, plan.choice.instruments[0], settling_samples(records, options)),
          o.block_length, options.filled))
    o.overlap = 0.75;
  return o;
}

/// Channels that are used, in the order of the record, and the choice in terms of them.
std::vector<std::size_t> used_channels(ChannelChoice& choice) {
  std::vector<int> used;
  for (const auto* list : {&choice.inputs, &choice.outputs, &choice.instruments})
    used.insert(used.end(), list->begin(), list->end());
  std::ranges::sort(used);
  const auto [first, last] = std::ranges::unique(used);
  used.erase(first, last);
  for (auto* list : {&choice.inputs, &choice.outputs, &choice.instruments})
    for (int& c : *list) c = static_cast<int>(std::ranges::find(used, c) - used.begin());
  return {used.begin(), used.end()};
}

/// How the records are read.
struct Reading {
  SpectrumOptions spectrum{};
  std::vector<std::size_t> used{};   ///< channels
  std::int64_t settling{}, total{};  ///< samples
  std::vector<Tone> tones{};         ///< that are subtracted
};

/// `plan`: its choice becomes one of the channels that are used.
Reading plan_reading(data::RecordSet& records, Plan& plan, const MeasureOptions& options) {
  Reading reading{.settling = settling_samples(records, options)};
  auto shortest = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = 0; k < records.files().size(); ++k) {
    const std::int64_t count = records.count_samples(k);
    shortest = std::min(shortest, count);
    reading.total += count;
  }
  reading.spectrum = spectrum_options(records, plan, options, shortest);
  reading.used = used_channels(plan.choice);
  return reading;
}

/// add(samples) for all samples, `estimator` being told where a record begins; how many there were,
/// and whether that is all.
template <class Add>
std::pair<std::int64_t, bool> stream(data::RecordSet& records, const Reading& reading,
                                     const numerics::Progress& progress,
                                     SpectrumEstimator& estimator, const Add& add) {
  std::int64_t samples = 0, of_record = 0;
  std::optional<std::size_t> begun;
  const bool whole =
      records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
        if (begun != file) {
          estimator.begin_record(reading.settling);
          of_record = 0;
        }
        begun = file;
        if (reading.tones.empty()) {
          add(block);
        } else {
          data::Samples rest = block;
          subtract_tones(reading.tones, reading.used, file, of_record, rest);
          add(rest);
        }
        of_record += block.rows();
        samples += block.rows();
        const auto total = static_cast<double>(std::max<std::int64_t>(reading.total, 1));
        return !(progress && progress(static_cast<double>(samples) / total));
      });
  return {samples, whole};
}

/// Puts the six directions that `map` makes of the channels in the place of these, which are all in
/// `list`, one of the choice's.
void replace_channels(const std::vector<int>& channels, const MatrixXd& map,
                      const std::string& prefix, std::vector<int>& list, ChannelChoice& choice,
                      Measurement& m) {
  warn_of_limits(m.spectra, channels, m.responses.warnings);
  m.spectra = to_platform(m.spectra, channels, map, prefix);
  const auto renumber = [&](std::vector<int>& numbers) {
    std::vector<int> now;
    for (const int c : numbers) {
      if (std::ranges::find(channels, c) != channels.end()) continue;
      const auto before = std::ranges::count_if(channels, [&](int gone) { return gone < c; });
      now.push_back(c - static_cast<int>(before));
    }
    numbers = now;
  };
  renumber(choice.inputs);
  renumber(choice.outputs);
  renumber(choice.instruments);
  const int count = static_cast<int>(m.spectra.channels.size());
  for (int d = 6; d > 0; --d) list.push_back(count - d);
}

/// All outputs, sensors at places that are known, become directions of the platform.
void bring_sensors_to_platform(const MatrixXd& map, ChannelChoice& choice, Measurement& m) {
  for (const int c : choice.outputs)
    if (m.spectra.health[static_cast<std::size_t>(c)].constant())
      throw base::ComputationError(
          fmt::format("{} is dead: leave it out by naming the other sensors with --outputs",
                      m.spectra.channels[static_cast<std::size_t>(c)].name));
  replace_channels(std::vector<int>(choice.outputs), map, {}, choice.outputs, choice, m);
}

/// The channels of legs 1 … 6 with this role, if all are in `list` and alive.
std::optional<std::vector<int>> living_legs(const CrossSpectra& spectra, Role role,
                                            const std::vector<int>& list) {
  using Units = std::vector<std::string_view>;
  const auto legs = six_channels(spectra.channels, role, data::Direction::leg1,
                                 role == Role::response ? Units{"m", "m/s", "m/s^2"} : Units{});
  if (!legs) return {};
  for (const int leg : *legs) {
    if (std::ranges::find(list, leg) == list.end()) return {};
    if (!spectra.health[static_cast<std::size_t>(leg)].constant()) continue;
    if (role == Role::drive) return {};  // named where inputs are checked
    throw base::ComputationError(fmt::format(
        "{} is dead: the platform's directions need all six legs; without the machine file the "
        "other legs are identified as they are",
        spectra.channels[static_cast<std::size_t>(leg)].name));
  }
  return legs;
}

/// Leg lengths among the outputs become directions of the platform, and so do the legs' drives.
void bring_to_platform(const PlatformFrame& frame, ChannelChoice& choice, Measurement& m) {
  const auto legs = living_legs(m.spectra, Role::response, choice.outputs);
  if (!legs) return;
  const auto map = platform_from_legs(frame.machine, frame.X_BP, frame.p_BQ);
  replace_channels(*legs, map, {}, choice.outputs, choice, m);
  m.from_legs = true;
  if (choice.inputs.size() != 6) return;
  if (const auto drives = living_legs(m.spectra, Role::drive, choice.inputs))
    replace_channels(*drives, map, "drive ", choice.inputs, choice, m);
}

/// Where the options say how: the outputs become directions of the platform.
void bring_outputs_to_platform(const MeasureOptions& options, ChannelChoice& choice,
                               Measurement& m) {
  if (options.outputs_to_platform)
    bring_sensors_to_platform(*options.outputs_to_platform, choice, m);
  else if (options.platform)
    bring_to_platform(*options.platform, choice, m);
}

/// Reads all files into m.spectra.
void read_spectra(data::RecordSet& records, const Reading& reading,
                  const numerics::Progress& progress, Measurement& m) {
  SpectrumEstimator estimator(m.header, reading.spectrum, reading.used);
  const auto [samples, whole] =
      stream(records, reading, progress, estimator,
             [&](const Eigen::Ref<const data::Samples>& block) { estimator.add(block); });
  m.samples = samples;
  m.interrupted = !whole;
  m.notes = records.notes();
  m.spectra = estimator.result();
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

/// What tones are called in the results: amplitudes of outputs and inputs, those of the platform
/// where the spectra are brought there.
std::vector<data::Harmonic> harmonics_of(const std::vector<Tone>& tones, ChannelChoice choice,
                                         const MeasureOptions& options, Measurement m) {
  if (tones.empty()) return {};
  m.spectra = tone_spectra(tones, m.spectra);
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

}  // namespace

Measurement measure_responses(data::RecordSet& records, const MeasureOptions& options,
                              const numerics::Progress& progress) {
  Measurement m{.header = records.header()};
  Plan plan = plan_channels(records.files()[0], m.header, options);
  Reading reading = plan_reading(records, plan, options);
  read_spectra(records, reading, progress, m);
  if (!m.interrupted) reading.tones = tones_in(records, reading, plan, m.spectra);
  if (!reading.tones.empty()) read_spectra(records, reading, {}, m);
  auto harmonics = harmonics_of(reading.tones, plan.choice, options, m);
  bring_outputs_to_platform(options, plan.choice, m);
  const auto earlier = std::move(m.responses.warnings);
  m.responses = responses_for_modes(m.spectra, plan.choice, plan.estimator);
  m.responses.harmonics = std::move(harmonics);
  m.responses.warnings.insert(m.responses.warnings.begin(), earlier.begin(), earlier.end());
  compare_with_instrument(plan, m);
  m.choice = std::move(plan.choice);
  return m;
}

Measurement measure_outputs(data::RecordSet& records, const MeasureOptions& options,
                            const numerics::Progress& progress) {
  Measurement m{.header = records.header()};
  const std::string& first = records.files()[0];
  Plan plan{.choice = {}, .estimator = Estimator::half_spectra};
  plan.choice.outputs = options.outputs.empty() ? default_outputs(m.header)
                                                : with_names(first, m.header, options.outputs);
  if (plan.choice.outputs.empty())
    base::refuse(first,
                 "no channel has the role response: name channels with --outputs; the record has " +
                     names_of(m.header));
  MeasureOptions own = options;
  own.period = 0.0;
  read_spectra(records, plan_reading(records, plan, own), progress, m);
  bring_outputs_to_platform(options, plan.choice, m);
  const auto earlier = std::move(m.responses.warnings);
  m.responses = half_spectra(m.spectra, plan.choice.outputs);
  m.responses.warnings.insert(m.responses.warnings.begin(), earlier.begin(), earlier.end());
  return m;
}

GroupedSpectra measure_groups(data::RecordSet& records, const MeasureOptions& options, int groups,
                              const numerics::Progress& progress) {
  const auto& header = records.header();
  Plan plan = plan_channels(records.files()[0], header, options);
  Reading reading = plan_reading(records, plan, options);
  const auto& spectrum = reading.spectrum;
  if (spectrum.periodic)
    throw base::ComputationError("the excitation is periodic: there are no blocks to resample");
  Measurement whole{.header = header};
  read_spectra(records, reading, {}, whole);
  reading.tones = tones_in(records, reading, plan, whole.spectra);
  const std::int64_t piece =
      std::max(reading.total / groups, std::int64_t{2} * spectrum.block_length);
  GroupedSpectra result{.estimator = plan.estimator};
  const auto close = [&](SpectrumEstimator& estimator) {
    Measurement m{.spectra = estimator.result()};
    if (m.spectra.blocks == 0) return;
    result.choice = plan.choice;
    bring_outputs_to_platform(options, result.choice, m);
    result.groups.push_back(std::move(m.spectra));
  };
  SpectrumEstimator estimator(header, spectrum, reading.used);
  std::int64_t in_piece = 0;
  const auto add = [&](const Eigen::Ref<const data::Samples>& block) {
    for (Index at = 0; at < block.rows();) {
      const std::int64_t count = std::min(block.rows() - at, piece - in_piece);
      estimator.add(block.middleRows(at, count));
      at += count;
      in_piece += count;
      if (in_piece < piece) continue;
      close(estimator);
      estimator = SpectrumEstimator(header, spectrum, reading.used);
      in_piece = 0;
    }
  };
  stream(records, reading, progress, estimator, add);
  if (in_piece >= piece / 2) close(estimator);
  return result;
}

}  // namespace hydrapod::identification
