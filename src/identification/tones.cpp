#include "tones.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hydrapod/numerics/statistics.hpp"
#include "some_spectra.hpp"
#include "tone_fit.hpp"

namespace hydrapod::identification {

namespace {

/// Lines on either side that a tone of one frequency fills: Hann's window.
constexpr Index hann_lobe = 2;

/// A line that stands out of a channel.
struct Peak {
  Index line{};
  Index channel{};
  double height{};  // power by the level around it
};

/// Power of the references, and of what they do not explain of the others: lines × channels.
MatrixXd unexplained_powers(const CrossSpectra& spectra, const std::vector<int>& references) {
  const auto q = static_cast<Index>(spectra.channels.size());
  std::vector<int> others;
  for (int c = 0; c < q; ++c)
    if (std::ranges::find(references, c) == references.end()) others.push_back(c);
  MatrixXd power(spectra.lines(), q);
  for (Index c = 0; c < q; ++c) power.col(c) = spectra.re.col(c * (c + 3) / 2);
  if (references.empty()) return power;
  for (Index first = 0; first < spectra.lines(); first += together) {
    const auto lines = lines_from(first, spectra.lines());
    const SomeSpectra S(spectra.re, spectra.im, lines);
    const auto explained =
        explained_powers(S.part(references, references), S.part(references, others));
    for (std::size_t o = 0; o < others.size(); ++o)
      for (int k = 0; k < together; ++k) {
        auto& own = power(lines[static_cast<std::size_t>(k)], others[o]);
        const double all =
            spectra.re(lines[static_cast<std::size_t>(k)], others[o] * (others[o] + 3) / 2);
        own = std::max(all - explained(0, static_cast<Index>(o)).re[k], 1e-12 * all);
      }
  }
  return power;
}

/// x that a mean of K squares of normal numbers exceeds with this chance at most (Chernoff).
double far_out(double K, double chance) {
  double low = 1.0, high = 1e6;
  constexpr int cuts = 60;
  for (int k = 0; k < cuts; ++k) {
    const double x = std::sqrt(low * high);
    (K * (x - 1.0 - std::log(x)) < -std::log(chance) ? low : high) = x;
  }
  return high;
}

/// Lines next to a tone that it and its wander fill.
Index filled_lines(const CrossSpectra& spectra, const ToneOptions& options) {
  return hann_lobe + static_cast<Index>(std::ceil(options.wander / spectra.frequency(1)));
}

/// Of lines whose power is > `least`.
std::vector<Peak> peaks_of(const VectorXd& power, Index channel, Index filled, double stands_out,
                           double least, Index far) {
  std::vector<Peak> peaks;
  for (Index k = filled + 3; k + filled + 3 < power.size(); ++k) {
    if (power[k] < power.segment(k - filled, 2 * filled + 1).maxCoeff()) continue;
    const double left = power.segment(k - filled - 3, 3).mean(),
                 right = power.segment(k + filled + 1, 3).mean();
    if (!(power[k] > stands_out * std::max(left, right))) continue;
    const Index from = std::max<Index>(0, k - far), to = std::min(power.size() - 1, k + far);
    const auto near = power.segment(from, to - from + 1);
    const double level =
        std::max({numerics::upper_median({near.begin(), near.end()}), left, right});
    if (power[k] > std::max(stands_out * level, least))
      peaks.push_back({k, channel, power[k] / level});
  }
  return peaks;
}

/// Takes away peaks where those of one reference hold most of its power: they are its excitation.
void leave_out_excitation(const MatrixXd& power, const std::vector<int>& references,
                          const ToneOptions& options, Index filled, std::vector<Peak>& peaks) {
  std::vector<Index> commanded;
  for (const Index c : references) {
    double in_lines = 0.0;
    std::vector<Index> own;
    for (const auto& peak : peaks)
      if (peak.channel == c) {
        own.push_back(peak.line);
        in_lines += (1.0 - 1.0 / peak.height) *
                    power.col(c).segment(peak.line - hann_lobe, 2 * hann_lobe + 1).sum();
      }
    if (in_lines > options.of_excitation * power.col(c).bottomRows(power.rows() - filled).sum())
      commanded.insert(commanded.end(), own.begin(), own.end());
  }
  std::erase_if(peaks, [&](const Peak& peak) {
    return std::ranges::any_of(commanded,
                               [&](Index line) { return std::abs(line - peak.line) <= hann_lobe; });
  });
}

/// What periodic excitation leaves of samples one period apart, as if it were a record.
CrossSpectra difference_spectra(data::RecordSet& records, const ToneReading& reading,
                                const CrossSpectra& like) {
  data::RecordHeader header = records.header();
  header.channels = like.channels;
  SpectrumEstimator estimator(header, {.block_length = reading.block});
  const auto P = static_cast<Index>(reading.block);
  std::optional<std::size_t> begun;
  data::Samples waiting;
  const auto add = [&](std::size_t record, std::int64_t, const data::Samples& samples) {
    if (begun != record) {
      estimator.begin_record();
      begun = record;
      waiting.resize(0, samples.cols());
    }
    data::Samples both(waiting.rows() + samples.rows(), samples.cols());
    both << waiting, samples;
    const Index count = std::max<Index>(0, both.rows() - P);
    estimator.add(both.bottomRows(count) - both.topRows(count));
    waiting = both.bottomRows(both.rows() - count);
  };
  stream_used(records, reading, add);
  return estimator.result();
}

double mean_frequency(const std::vector<ToneTrack>& tracks) {
  double sum = 0.0, count = 0.0;
  for (const auto& track : tracks)
    if (track.amplitude.size() > 0) {
      sum += track.omega;
      count += 1.0;
    }
  return sum / count;
}

Tone tone_of(std::vector<ToneTrack> tracks, double sample_rate) {
  Tone tone{.frequency = mean_frequency(tracks) * sample_rate / two_pi};
  double count = 0.0;
  for (const auto& track : tracks) {
    if (track.amplitude.size() == 0) continue;
    if (count == 0.0) tone.amplitude = VectorXd::Zero(track.amplitude.size());
    tone.amplitude += track.amplitude.cwiseAbs2();
    tone.unevenness += track.unevenness;
    count += 1.0;
    if (tone.relative.size() == 0 || track.amplitude.norm() > tone.relative.norm())
      tone.relative = track.amplitude;
  }
  tone.amplitude = (tone.amplitude / count).cwiseSqrt();
  tone.unevenness /= count;
  tone.records = std::move(tracks);
  return tone;
}

std::vector<double> omegas_of(const std::vector<ToneTrack>& tracks) {
  std::vector<double> list;
  for (const auto& track : tracks) list.push_back(track.omega);
  return list;
}

/// Samples of a window of the demodulation: a quarter of a block, a multiple of 4.
Index zoom_window(const CrossSpectra& spectra, int block, const ToneOptions& options) {
  const auto longest = static_cast<Index>(options.longest_window * spectra.sample_rate);
  return std::max<Index>(4, std::min<Index>(block / 4, longest) / 4 * 4);
}

/// Candidates that fit into ToneOptions::most_numbers, at least one.
std::size_t room_for(data::RecordSet& records, const ToneReading& reading, Index window,
                     const ToneOptions& options) {
  std::int64_t samples = 0;
  for (std::size_t k = 0; k < records.files().size(); ++k) samples += records.count_samples(k);
  const auto times = static_cast<std::size_t>(samples / (window / 4)) + 1;
  return std::max<std::size_t>(1, options.most_numbers / (times * reading.channels.size()));
}

/// Is it, within the resolution of the records, a line of the excitation? The machine's transient
/// makes a candidate of one: it is in the differences, and the line in the samples.
bool is_excitation(const Tone& tone, data::RecordSet& records, const ToneReading& reading,
                   double sample_rate) {
  std::int64_t longest = 1;
  for (std::size_t k = 0; k < records.files().size(); ++k)
    longest = std::max(longest, records.count_samples(k));
  const double line = tone.frequency * reading.block / sample_rate;
  return std::abs(line - std::round(line)) * static_cast<double>(longest) < reading.block;
}

}  // namespace

std::vector<Index> conspicuous_lines(const CrossSpectra& spectra,
                                     const std::vector<int>& references,
                                     const ToneOptions& options) {
  const double K = spectra.statistics.effective_averages - static_cast<double>(references.size());
  constexpr double fewest = 4.0;
  const Index filled = filled_lines(spectra, options),
              q = static_cast<Index>(spectra.channels.size());
  if (K < fewest || spectra.lines() <= 2 * (filled + options.reach)) return {};
  const double chance = options.by_chance / static_cast<double>(spectra.lines() * q);
  const double stands_out = std::max(options.stands_out, far_out(K, chance));
  const MatrixXd power = unexplained_powers(spectra, references);
  std::vector<Peak> peaks;
  for (Index c = 0; c < q; ++c) {
    const double least = options.audible * spectra.re.col(c * (c + 3) / 2).maxCoeff();
    for (const auto& peak :
         peaks_of(power.col(c), c, filled, stands_out, std::max(least, 1e-300), options.reach))
      peaks.push_back(peak);
  }
  leave_out_excitation(power, references, options, filled, peaks);
  std::ranges::sort(peaks, std::greater{}, &Peak::height);
  std::vector<Index> lines;
  for (const auto& peak : peaks)
    if (lines.size() < options.most && std::ranges::none_of(lines, [&](Index line) {
          return std::abs(line - peak.line) <= filled;
        }))
      lines.push_back(peak.line);
  std::ranges::sort(lines);
  return lines;
}

std::vector<Tone> find_tones(data::RecordSet& records, const ToneReading& reading,
                             const CrossSpectra& own, const std::vector<int>& references,
                             const ToneOptions& options) {
  std::optional<CrossSpectra> differences;
  if (reading.periodic) differences = difference_spectra(records, reading, own);
  const auto& spectra = differences ? *differences : own;
  const Index window = zoom_window(spectra, reading.block, options);
  auto limited = options;
  limited.most = std::min(options.most, room_for(records, reading, window, options));
  const auto lines =
      conspicuous_lines(spectra, reading.periodic ? std::vector<int>{} : references, limited);
  if (lines.empty()) return {};
  std::vector<std::vector<double>> omegas;
  const double line = two_pi / static_cast<double>(reading.block);
  const double wander = two_pi * options.wander / spectra.sample_rate;
  for (const Index k : lines)
    omegas.emplace_back(records.files().size(), line * static_cast<double>(k));
  const auto fits = [&] {
    std::vector<std::vector<ToneTrack>> kept;
    for (const auto& zooms : zoom_in(records, reading, omegas, window))
      if (auto tracks = fit_tone(zooms, line, wander, options); !tracks.empty())
        kept.push_back(std::move(tracks));
    return kept;
  };
  // around the middle of a zoom its window does nothing to the envelope
  omegas = [&] {
    std::vector<std::vector<double>> better;
    for (const auto& tracks : fits()) better.push_back(omegas_of(tracks));
    return better;
  }();
  std::vector<Tone> tones;
  if (omegas.empty()) return tones;
  for (auto& tracks : fits()) tones.push_back(tone_of(std::move(tracks), spectra.sample_rate));
  if (reading.periodic)
    std::erase_if(tones, [&](const Tone& tone) {
      return is_excitation(tone, records, reading, spectra.sample_rate);
    });
  std::ranges::sort(tones, {}, &Tone::frequency);
  return tones;
}

std::vector<Tone> take_ringing(std::vector<Tone>& tones, const ToneOptions& options) {
  const auto from = std::stable_partition(tones.begin(), tones.end(), [&](const Tone& tone) {
    return tone.unevenness <= options.comes_and_goes;
  });
  std::vector<Tone> ringing(std::make_move_iterator(from), std::make_move_iterator(tones.end()));
  tones.erase(from, tones.end());
  return ringing;
}

void subtract_tones(const std::vector<Tone>& tones, const std::vector<std::size_t>& channels,
                    std::size_t record, std::int64_t first, data::Samples& samples) {
  for (const auto& tone : tones) {
    const auto& track = tone.records.at(record);
    if (track.amplitude.size() == 0) continue;
    VectorXcd g(samples.rows());
    constexpr Index renewed = 256;  // samples over which rounding of the phase adds up
    const Complex turn = std::polar(1.0, track.omega);
    Complex phase = 1.0;
    for (Index t = 0; t < g.size(); ++t, phase *= turn) {
      const auto at = static_cast<double>(first + t);
      if (t % renewed == 0) phase = std::polar(1.0, track.omega * at);
      g[t] = phase * track.envelope.at(at);
    }
    for (std::size_t c = 0; c < channels.size(); ++c)
      samples.col(static_cast<Index>(channels[c])) -=
          (track.amplitude[static_cast<Index>(c)] * g).real();
  }
}

CrossSpectra tone_spectra(const std::vector<Tone>& tones, const CrossSpectra& like) {
  const auto q = static_cast<Index>(like.channels.size());
  CrossSpectra spectra{.channels = like.channels,
                       .sample_rate = like.sample_rate,
                       .options = like.options,
                       .window = like.window,
                       .blocks = like.blocks,
                       .blocks_left_out = like.blocks_left_out,
                       .records = like.records,
                       .statistics = like.statistics,
                       .health = like.health,
                       .re = MatrixXd::Zero(static_cast<Index>(tones.size()), q * (q + 1) / 2)};
  spectra.im = spectra.re;
  for (std::size_t k = 0; k < tones.size(); ++k) {
    const auto& tone = tones[k];
    // the relation between channels is that of one record, their size that of all
    VectorXcd A = tone.relative;
    for (Index c = 0; c < q; ++c)
      A[c] *= tone.amplitude[c] / std::max(std::abs(tone.relative[c]), 1e-300);
    for (Index i = 0, pair = 0; i < q; ++i)
      for (Index j = 0; j <= i; ++j, ++pair) {
        const Complex S = 0.5 * A[i] * std::conj(A[j]);
        spectra.re(static_cast<Index>(k), pair) = S.real();
        spectra.im(static_cast<Index>(k), pair) = S.imag();
      }
  }
  return spectra;
}

}  // namespace hydrapod::identification
