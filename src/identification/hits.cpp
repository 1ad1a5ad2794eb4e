#include "hits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index margin = 2;  // samples

double median_of(const VectorXd& x) { return numerics::upper_median({x.begin(), x.end()}); }

/// Where the input is more than noise, taps and all.
std::vector<Hit> forces_in(const VectorXd& input, const HitOptions& options) {
  const Index n = input.size();
  const Eigen::ArrayXd size = (input.array() - median_of(input)).abs();
  const double level =
      std::max(options.of_noise * median_of(size.matrix()), options.of_peak * size.maxCoeff());
  const Index apart =
      std::max<Index>(2 * margin, std::lround(options.apart * static_cast<double>(n)));
  std::vector<Hit> all;
  for (Index k = 0; k < n; ++k) {
    if (!(size[k] > level)) continue;
    if (all.empty() || k - all.back().to > apart) all.push_back({k, k, 0.0});
    all.back().to = k;
    all.back().peak = std::max(all.back().peak, size[k]);
  }
  for (auto& hit : all) {
    hit.from = std::max<Index>(0, hit.from - margin);
    hit.to = std::min(n - 1, hit.to + margin);
  }
  return all;
}

/// The force alone. Noise of the input in there is a factor of all responses that changes within
/// 1/length of frequency: the shorter, the less it looks like a mode.
VectorXd force(const VectorXd& input, const std::vector<Hit>& forces) {
  VectorXd x = VectorXd::Zero(input.size());
  const double rest = median_of(input);
  for (const auto& hit : forces)
    x.segment(hit.from, hit.to - hit.from + 1) =
        input.segment(hit.from, hit.to - hit.from + 1).array() - rest;
  return x;
}

/// Less what it was before the first hit, or its mean where nothing was recorded before.
VectorXd ringing(const VectorXd& output, Index first) {
  constexpr Index enough = 16;
  const double rest = first >= enough ? output.head(first).mean() : output.mean();
  return output.array() - rest;
}

std::vector<Hit> only_hits(const std::vector<Hit>& forces, const HitOptions& options) {
  double largest = 0.0;
  for (const auto& hit : forces) largest = std::max(largest, hit.peak);
  std::vector<Hit> hits;
  for (const auto& hit : forces)
    if (hit.peak >= options.least * largest) hits.push_back(hit);
  return hits;
}

/// A record with what is no response taken away.
struct Record {
  std::vector<Hit> hits{};
  VectorXd u{};
  MatrixXd y{};
};

std::optional<Record> record_of(const data::Samples& samples, const ChannelChoice& choice,
                                const HitOptions& options) {
  if (!samples.allFinite()) return {};
  const VectorXd input = samples.col(choice.inputs[0]);
  Record record{.hits = hits_in(input, options)};
  if (record.hits.empty()) return {};
  const auto forces = forces_in(input, options);
  record.u = force(input, forces);
  record.y.resize(samples.rows(), static_cast<Index>(choice.outputs.size()));
  for (Index o = 0; o < record.y.cols(); ++o)
    record.y.col(o) =
        ringing(samples.col(choice.outputs[static_cast<std::size_t>(o)]), forces.front().from);
  return record;
}

/// Has the response to each hit rung down when the next one comes?
bool rings_down(const Record& record, const HitOptions& options) {
  for (std::size_t k = 0; k + 1 < record.hits.size(); ++k) {
    const Index from = record.hits[k].from, gap = record.hits[k + 1].from - from, part = gap / 8;
    if (part < margin) return false;
    for (Index o = 0; o < record.y.cols(); ++o)
      if (record.y.col(o).segment(from + gap - part, part).norm() >
          options.rung_down * record.y.col(o).segment(from, part).norm())
        return false;
  }
  return true;
}

/// Samples `from` … of a record.
struct Block {
  const Record* record{};
  Index from{};
};

/// What is transformed: all blocks have one length.
struct Blocks {
  std::vector<Block> list{};
  Index samples{};
  double after{};  ///< samples from the hit to the end
  bool each{};     ///< each hit is one
};

Blocks blocks_of(const std::vector<Record>& records, const HitOptions& options) {
  Blocks blocks{.each = std::ranges::all_of(
                    records, [&](const Record& r) { return rings_down(r, options); })};
  Index most = options.most;
  for (const auto& record : records)
    for (std::size_t k = 0; k < (blocks.each ? record.hits.size() : 1U); ++k) {
      const Index from = record.hits[k].from, to = blocks.each && k + 1 < record.hits.size()
                                                       ? record.hits[k + 1].from
                                                       : record.u.size();
      blocks.list.push_back({&record, from});
      most = std::min(most, to - from);
    }
  blocks.samples = most - most % 2;
  blocks.after = static_cast<double>(blocks.samples - margin);
  return blocks;
}

/// Does one hit outweigh all others of the block, after e^(−at)?
bool one_outweighs(const Block& block, double decay_per_sample, double others) {
  double largest = 0.0, all = 0.0;
  for (const auto& hit : block.record->hits) {
    const double weight =
        hit.peak * std::exp(-decay_per_sample * static_cast<double>(hit.from - block.from));
    largest = std::max(largest, weight);
    all += weight;
  }
  return all - largest <= others * largest;
}

/// a, per sample.
double decay_of(const Blocks& blocks, const HitOptions& options) {
  double decay = options.decay / blocks.after;
  constexpr double step = 1.05;
  const double highest = 200.0 * decay;
  while (!blocks.each && decay < highest &&
         !std::ranges::all_of(blocks.list, [&](const Block& block) {
           return one_outweighs(block, decay, options.others);
         }))
    decay *= step;
  return decay;
}

/// Transforms of blocks of one length.
class Transform {
 public:
  Transform(Index samples, double decay_per_sample)
      : window_(samples), fft_(static_cast<int>(samples)) {
    for (Index k = 0; k < samples; ++k)
      window_[k] = std::exp(-decay_per_sample * static_cast<double>(k));
  }
  VectorXcd of(const Eigen::Ref<const VectorXd>& signal) {
    const VectorXd x = signal.cwiseProduct(window_);
    VectorXcd lines(fft_.lines());
    fft_.forward({x.data(), static_cast<std::size_t>(x.size())},
                 {lines.data(), static_cast<std::size_t>(lines.size())});
    return lines;
  }

 private:
  VectorXd window_;
  numerics::RealFft fft_;
};

/// Lines of all blocks.
struct Spectra {
  std::vector<VectorXcd> U{};
  std::vector<MatrixXcd> Y{};
  VectorXd power{};   ///< Σ |U|²
  MatrixXcd cross{};  ///< Σ Y U*
  [[nodiscard]] MatrixXcd response(Index line) const {
    return cross.row(line).transpose() / power[line];
  }
};

Spectra spectra_of_blocks(const Blocks& blocks, double decay_per_sample) {
  Transform transform(blocks.samples, decay_per_sample);
  Spectra s;
  for (const auto& block : blocks.list) {
    const auto& y = block.record->y;
    VectorXd u = block.record->u.segment(block.from, blocks.samples);
    s.U.push_back(transform.of(u));
    MatrixXcd Y(s.U.back().size(), y.cols());
    for (Index o = 0; o < y.cols(); ++o)
      Y.col(o) = transform.of(y.col(o).segment(block.from, blocks.samples));
    if (s.power.size() == 0) {
      s.power = VectorXd::Zero(Y.rows());
      s.cross = MatrixXcd::Zero(Y.rows(), Y.cols());
    }
    s.power += s.U.back().cwiseAbs2();
    s.cross += s.U.back().conjugate().asDiagonal() * Y;
    s.Y.push_back(std::move(Y));
  }
  return s;
}

/// Lines from 1 on that the hits excite.
Index excited_lines(const VectorXd& power, double weakest) {
  Index largest = 0;
  power.tail(power.size() - 1).maxCoeff(&largest);
  Index to = largest + 1;
  while (to + 1 < power.size() && power[to + 1] >= weakest * power[largest + 1]) ++to;
  return to;
}

/// E[e_k e*_{k+d}] of white noise under the window is the transform of e^(−2at), and that of
/// e U*/Σ |U|² turns with U.
std::vector<Complex> covariance_of_lines(const Spectra& s, Index every, Index to, double decay,
                                         const HitOptions& options) {
  std::vector<Complex> covariance;
  const double turn = two_pi / static_cast<double>(2 * (s.power.size() - 1));
  for (Index d = 0; d < options.most_covariances; ++d) {
    const Index apart = every * d;
    if (every + apart > to) break;
    Complex together = 0.0;
    for (Index k = every; k + apart <= to; k += every) {
      Complex product = 0.0;
      for (const auto& U : s.U) product += std::conj(U[k]) * U[k + apart];
      together += product / std::sqrt(s.power[k] * s.power[k + apart]);
    }
    together /= static_cast<double>((to - every - apart) / every + 1);
    covariance.push_back(together * 2.0 * decay /
                         Complex(2.0 * decay, -static_cast<double>(apart) * turn));
  }
  return covariance;
}

/// Where several hits were averaged; there is one input.
void add_coherence(const Spectra& s, Index every, Index to, FrequencyResponses& r) {
  for (Index k = every; k <= to; k += every) {
    VectorXd coherence(s.cross.cols());
    for (Index o = 0; o < coherence.size(); ++o) {
      double power = 0.0;
      for (const auto& Y : s.Y) power += std::norm(Y(k, o));
      coherence[o] =
          power > 0.0 ? std::min(1.0, std::norm(s.cross(k, o)) / (s.power[k] * power)) : 0.0;
    }
    r.coherence.push_back(MatrixXd(coherence));
    r.multiple_coherence.push_back(coherence);
    r.condition.push_back(1.0);
  }
}

/// Of the output on which hits differ most.
struct Disagreement {
  Index output{};
  double share{};  ///< of its power
};

/// Noise is no disagreement: its power is not where the response has its own.
std::optional<Disagreement> disagreement(const Spectra& s, Index every, Index to,
                                         const HitOptions& options) {
  std::optional<Disagreement> worst;
  for (Index o = 0; o < s.cross.cols(); ++o) {
    double rest = 0.0, all = 0.0, rest_there = 0.0, all_there = 0.0;
    for (Index k = every; k <= to; k += every) {
      double power = 0.0;
      for (const auto& Y : s.Y) power += std::norm(Y(k, o));
      const double left = std::max(0.0, power - std::norm(s.cross(k, o)) / s.power[k]);
      rest += left;
      all += power;
      rest_there += left * power;
      all_there += power * power;
    }
    if (!(rest > (1.0 - options.in_common) * all) ||
        rest_there / rest < options.alike * all_there / all)
      continue;
    if (!worst || rest / all > worst->share) worst = {o, rest / all};
  }
  return worst;
}

void add_warnings(const std::vector<Record>& records, const Blocks& blocks, const Spectra& damped,
                  Index every, Index to, const HitOptions& options, FrequencyResponses& r) {
  using Kind = data::ResponseWarning::Kind;
  const auto hits =
      std::accumulate(records.begin(), records.end(), std::int64_t{0},
                      [](auto sum, const Record& record) { return sum + std::ssize(record.hits); });
  r.warnings.push_back({.kind = Kind::single_block,
                        .share = blocks.each ? 1.0 : 0.0,
                        .count = std::ssize(records),
                        .total = hits});
  if (blocks.list.size() < 2) return;
  add_coherence(damped, every, to, r);
  const auto worst = disagreement(damped, every, to, options);
  if (!worst) return;
  r.warnings.back().value = worst->share;
  r.warnings.back().channel = r.outputs[static_cast<std::size_t>(worst->output)].name;
}

}  // namespace

std::vector<Hit> hits_in(const VectorXd& input, const HitOptions& options) {
  if (input.size() < options.fewest || !input.allFinite()) return {};
  const double rest = median_of(input), all = (input.array() - rest).square().sum();
  if (!(all > 0.0)) return {};
  const auto forces = forces_in(input, options);
  double energy = 0.0;
  Index length = 0;
  for (const auto& hit : forces) {
    const Index own = hit.to - hit.from + 1;
    energy += (input.segment(hit.from, own).array() - rest).square().sum();
    length += own;
  }
  constexpr Index always = 9;  // samples of a hit in the shortest of records
  const auto longest =
      std::max<Index>(always, std::lround(options.longest * static_cast<double>(input.size())));
  if (energy < options.energy * all || length > longest) return {};
  auto hits = only_hits(forces, options);
  if (hits.size() > options.most_hits) hits.clear();
  return hits;
}

std::optional<FrequencyResponses> responses_of_hits(const std::vector<data::Samples>& samples,
                                                    const std::vector<data::Channel>& outputs,
                                                    const ChannelChoice& choice, double sample_rate,
                                                    const HitOptions& options) {
  if (samples.empty() || choice.inputs.size() != 1) return {};
  std::vector<Record> records;
  for (const auto& own : samples) {
    auto record = record_of(own, choice, options);
    if (!record) return {};
    records.push_back(std::move(*record));
  }
  const Blocks blocks = blocks_of(records, options);
  if (blocks.samples < options.fewest / 2) return {};
  const double decay = decay_of(blocks, options);
  const Spectra damped = spectra_of_blocks(blocks, decay), plain = spectra_of_blocks(blocks, 0.0);
  FrequencyResponses r{.outputs = outputs,
                       .shift = decay * sample_rate,
                       .sample_rate = sample_rate,
                       .estimator = Estimator::h1,
                       .averages = static_cast<double>(blocks.list.size())};
  // lines in between hold little that these do not
  const auto every =
      std::max<Index>(2, static_cast<Index>(2.0 * decay * blocks.after / options.decay));
  // what several hits make of it at once is no end of what they excite
  const Index to = blocks.each ? std::min(excited_lines(damped.power, options.weakest),
                                          excited_lines(plain.power, options.weakest))
                               : excited_lines(damped.power, options.weakest);
  r.line_covariance = covariance_of_lines(damped, every, to, decay, options);
  for (Index k = every; k <= to; k += every) {
    r.frequency.push_back(static_cast<double>(k) * sample_rate /
                          static_cast<double>(blocks.samples));
    r.H.push_back(damped.response(k));
    r.on_axis.push_back(plain.response(k));
  }
  add_warnings(records, blocks, damped, every, to, options, r);
  return r;
}

}  // namespace hydrapod::identification
