#include "hits.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// The force alone. Noise of the input in there is a factor of all responses that changes within
/// 1/length of frequency: the shorter, the less it looks like a mode.
VectorXd force(const VectorXd& input, const std::vector<Hit>& forces) {
  VectorXd x = VectorXd::Zero(input.size());
  const double rest = rest_of(input);
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

/// A record with what is no response taken away.
struct Record {
  std::vector<Hit> forces{}, hits{};
  std::vector<Index> cut{};  ///< samples at which a channel is cut off
  VectorXd u{};
  MatrixXd y{};
};

std::vector<Index> cut_samples(const data::Samples& samples,
                               const std::vector<ChannelHealth>& health) {
  std::vector<Index> cut;
  for (Index t = 0; t < samples.rows(); ++t)
    for (std::size_t c = 0; c < health.size(); ++c) {
      const double x = samples(t, static_cast<Index>(c));
      if (!(x <= health[c].cut_below || x >= health[c].cut_above)) continue;
      cut.push_back(t);
      break;
    }
  return cut;
}

std::optional<Record> record_of(const data::Samples& samples, const ChannelChoice& choice,
                                const std::vector<ChannelHealth>& health,
                                const HitOptions& options) {
  if (!samples.allFinite()) return {};
  const VectorXd input = samples.col(choice.inputs[0]);
  Record record{.hits = hits_in(input, options)};
  if (record.hits.empty() || !outputs_rise(samples, choice.outputs, record.hits, options))
    return {};
  record.forces = forces_in(input, options);
  record.cut = cut_samples(samples, health);
  record.u = force(input, record.forces);
  record.y.resize(samples.rows(), static_cast<Index>(choice.outputs.size()));
  for (Index o = 0; o < record.y.cols(); ++o)
    record.y.col(o) = ringing(samples.col(choice.outputs[static_cast<std::size_t>(o)]),
                              record.forces.front().from);
  return record;
}

/// Has the response to a hit rung down when the next one comes?
bool rings_down(const Record& record, std::size_t hit, const HitOptions& options) {
  const Index from = record.hits[hit].from, gap = record.hits[hit + 1].from - from, part = gap / 8;
  if (part < hit_margin) return false;
  for (Index o = 0; o < record.y.cols(); ++o)
    if (record.y.col(o).segment(from + gap - part, part).norm() >
        options.rung_down * record.y.col(o).segment(from, part).norm())
      return false;
  return true;
}

/// Samples `from` … of a record.
struct Block {
  const Record* record{};
  Index from{}, length{};
  std::int64_t hits{};

  /// The first sample that is cut off; none: `from + length`.
  [[nodiscard]] Index first_cut() const {
    const auto at = std::ranges::lower_bound(record->cut, from);
    return at == record->cut.end() ? from + length : std::min(*at, from + length);
  }
  [[nodiscard]] bool is_cut() const { return first_cut() < from + length; }
  /// Up to the hit at which it is cut off first.
  [[nodiscard]] Block before_cut() const {
    Block block{record, from, 0, 0};
    for (const auto& hit : record->hits) {
      if (hit.from < from || hit.from > first_cut()) continue;
      block.length = hit.from - from;
      ++block.hits;
    }
    --block.hits;  // the last one is cut off
    return block;
  }
};

/// What is transformed: all blocks have one length.
struct Blocks {
  std::vector<Block> list{};
  Index samples{};
  std::int64_t records{}, hits{}, all{};  ///< `all`: with those left out
  std::int64_t left_out{};                ///< hits
  std::int64_t cut{};                     ///< … for samples that are cut off
  [[nodiscard]] double after() const {    ///< samples from the hit to the end
    return static_cast<double>(samples - hit_margin);
  }
  void leave_out_below(Index length) {
    std::erase_if(list, [&](const Block& block) {
      if (block.length < length) left_out += block.hits;
      return block.length < length;
    });
  }
  /// All of them stay where nothing else would be left.
  void leave_out_cut(Index fewest) {
    std::vector<Block> whole, part;
    std::int64_t of_whole = 0, of_part = 0, before = 0;
    for (const Block& block : list) {
      before += block.hits;
      if (!block.is_cut()) {
        whole.push_back(block);
        of_whole += block.hits;
      } else if (const Block own = block.before_cut(); own.length >= fewest) {
        part.push_back(own);
        of_part += own.hits;
      }
    }
    if (whole.empty() && part.empty()) return;
    cut = before - (whole.empty() ? of_part : of_whole);
    list = whole.empty() ? std::move(part) : std::move(whole);
  }
  void settle_length(const HitOptions& options) {
    const Index most = std::min(options.most, std::ranges::min(list, {}, &Block::length).length);
    samples = most - most % 2;
  }
};

Blocks blocks_of(const std::vector<Record>& records, const HitOptions& options) {
  Blocks blocks{.records = std::ssize(records)};
  for (const auto& record : records) {
    blocks.hits += std::ssize(record.hits);
    std::size_t first = 0;
    for (std::size_t k = 0; k < record.hits.size(); ++k) {
      const bool last = k + 1 == record.hits.size();
      if (!last && !rings_down(record, k, options)) continue;
      const Index from = record.hits[first].from,
                  to = last ? record.u.size() : record.hits[k + 1].from;
      blocks.list.push_back({&record, from, to - from, static_cast<std::int64_t>(k + 1 - first)});
      first = k + 1;
    }
  }
  blocks.all = std::ssize(blocks.list);
  blocks.leave_out_cut(options.fewest);
  std::vector<double> lengths;
  for (const auto& block : blocks.list) lengths.push_back(static_cast<double>(block.length));
  blocks.leave_out_below(std::lround(options.short_of * numerics::upper_median(lengths)));
  blocks.settle_length(options);
  return blocks;
}

/// The same without the shortest; false: all are as long.
bool leave_out_shortest(Blocks& blocks, const HitOptions& options) {
  const Index shortest = std::ranges::min(blocks.list, {}, &Block::length).length;
  if (shortest == std::ranges::max(blocks.list, {}, &Block::length).length) return false;
  blocks.leave_out_below(shortest + 1);
  blocks.settle_length(options);
  return true;
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

constexpr Index line_step = 2;  // lines in between hold little that these do not

/// Lines of all blocks.
struct Spectra {
  std::vector<VectorXcd> U{};
  std::vector<MatrixXcd> Y{};
  VectorXd power{};   ///< Σ |U|²
  VectorXd single{};  ///< the same of the forces one by one, as if they never met
  MatrixXcd cross{};  ///< Σ Y U*
  [[nodiscard]] MatrixXcd response(Index line) const {
    return cross.row(line).transpose() / power[line];
  }
};

/// Σ |X|² of the forces of all blocks at lines of blocks, from transforms that are as short as
/// forces are.
VectorXd power_of_forces(const Blocks& blocks, double decay_per_sample) {
  constexpr Index finer = 64;  // than the reciprocal of a force
  Index longest = 1;
  std::vector<VectorXd> pieces;
  for (const auto& block : blocks.list)
    for (const auto& force : block.record->forces) {
      const Index from = std::max(force.from, block.from),
                  to = std::min(force.to + 1, block.from + blocks.samples);
      if (from >= to) continue;
      pieces.emplace_back(block.record->u.segment(from, to - from));
      for (Index k = 0; k < to - from; ++k)
        pieces.back()[k] *=
            std::exp(-decay_per_sample * static_cast<double>(from + k - block.from));
      longest = std::max(longest, to - from);
    }
  const auto size = static_cast<Index>(std::bit_ceil(static_cast<std::size_t>(finer * longest)));
  numerics::RealFft fft(static_cast<int>(size));
  VectorXd x(size), power = VectorXd::Zero(fft.lines());
  VectorXcd X(fft.lines());
  for (const auto& piece : pieces) {
    x.setZero();
    x.head(piece.size()) = piece;
    fft.forward({x.data(), static_cast<std::size_t>(size)},
                {X.data(), static_cast<std::size_t>(X.size())});
    power += X.cwiseAbs2();
  }
  VectorXd lines(blocks.samples / 2 + 1);
  for (Index k = 0; k < lines.size(); ++k) {
    const double at =
        static_cast<double>(k) * static_cast<double>(size) / static_cast<double>(blocks.samples);
    const Index below = std::min(static_cast<Index>(at), power.size() - 2);
    lines[k] = power[below] + (at - static_cast<double>(below)) * (power[below + 1] - power[below]);
  }
  return lines;
}

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
  s.single = power_of_forces(blocks, decay_per_sample);
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

/// Lines at which the hits do not cancel each other.
struct KeptLines {
  std::vector<Index> kept{};
  std::int64_t gaps{};  ///< wide ones
};

KeptLines lines_of_hits(const Spectra& damped, const Spectra& plain, const HitOptions& options) {
  // what several hits make of it at once is no end of what they excite
  const Index to = std::min(excited_lines(damped.single, options.weakest),
                            excited_lines(plain.single, options.weakest));
  const auto excited = [&](Index k, double share) {
    return damped.power[k] >= share * damped.single[k] &&
           plain.power[k] >= options.weakest * plain.single[k];
  };
  KeptLines lines;
  for (Index k = line_step; k <= to;) {
    if (excited(k, options.cancelled)) {
      lines.kept.push_back(k);
      k += line_step;
      continue;
    }
    Index end = k;
    while (end <= to && !excited(end, options.cancelled)) end += line_step;
    const bool wide = end - k > options.wide * line_step;
    Index missed = 0;
    for (; k < end; k += line_step) {
      if (wide && excited(k, options.nearly_cancelled)) {
        lines.kept.push_back(k);
        missed = 0;
      } else if (++missed == options.gap) {
        ++lines.gaps;
      }
    }
  }
  return lines;
}

/// E[e_k e*_{k+d}] of white noise under the window is the transform of e^(−2at), and that of
/// e U*/Σ |U|² turns with U. Lines count as their errors do beside what a single hit would
/// leave.
std::vector<Complex> covariance_of_lines(const Spectra& s, const KeptLines& lines, double decay,
                                         const HitOptions& options) {
  std::vector<Complex> covariance;
  const double turn = two_pi / static_cast<double>(2 * (s.power.size() - 1));
  std::vector<char> kept(static_cast<std::size_t>(s.power.size()));
  for (const Index k : lines.kept) kept[static_cast<std::size_t>(k)] = 1;
  for (Index d = 0; d < options.most_covariances; ++d) {
    const Index apart = line_step * d;
    Complex together = 0.0;
    double alone = 0.0;
    for (const Index k : lines.kept) {
      if (k + apart >= s.power.size() || kept[static_cast<std::size_t>(k + apart)] == 0) continue;
      Complex product = 0.0;
      for (const auto& U : s.U) product += std::conj(U[k]) * U[k + apart];
      const double size = std::sqrt(s.single[k] * s.single[k + apart]),
                   power = std::sqrt(s.power[k] * s.power[k + apart]);
      together += product * size / (power * power);
      alone += 0.5 * (s.single[k] / s.power[k] + s.single[k + apart] / s.power[k + apart]);
    }
    if (alone == 0.0) break;
    covariance.push_back(together / alone * 2.0 * decay /
                         Complex(2.0 * decay, -static_cast<double>(apart) * turn));
  }
  return covariance;
}

/// Where several hits were averaged; there is one input.
void add_coherence(const Spectra& s, const KeptLines& lines, FrequencyResponses& r) {
  for (const Index k : lines.kept) {
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
std::optional<Disagreement> disagreement(const Spectra& s, const KeptLines& lines,
                                         const HitOptions& options) {
  std::optional<Disagreement> worst;
  for (Index o = 0; o < s.cross.cols(); ++o) {
    double rest = 0.0, all = 0.0, rest_there = 0.0, all_there = 0.0;
    for (const Index k : lines.kept) {
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

/// What was left out.
void add_warnings_of_rest(const Blocks& blocks, const KeptLines& lines, FrequencyResponses& r) {
  using Kind = data::ResponseWarning::Kind;
  if (blocks.left_out > 0)
    r.warnings.push_back({.kind = Kind::hits_left_out,
                          .value = static_cast<double>(blocks.samples) / r.sample_rate,
                          .count = blocks.left_out,
                          .total = blocks.hits});
  if (blocks.cut > 0)
    r.warnings.push_back({.kind = Kind::clipped_hits, .count = blocks.cut, .total = blocks.hits});
  if (lines.gaps > 0)
    r.warnings.push_back({.kind = Kind::excited_band,
                          .lowest = r.frequency.front(),
                          .highest = r.frequency.back(),
                          .count = lines.gaps});
}

data::ResponseWarning warning_of_hits(const Blocks& blocks) {
  const double share = blocks.all == blocks.hits ? 1.0
                       : blocks.all == blocks.records
                           ? 0.0
                           : static_cast<double>(blocks.all) / static_cast<double>(blocks.hits);
  return {.kind = data::ResponseWarning::Kind::single_block,
          .share = share,
          .count = blocks.records,
          .total = blocks.hits};
}

void add_warnings(const Blocks& blocks, const Spectra& damped, const KeptLines& lines,
                  const HitOptions& options, FrequencyResponses& r) {
  auto warning = warning_of_hits(blocks);
  if (blocks.list.size() > 1) {
    add_coherence(damped, lines, r);
    if (const auto worst = disagreement(damped, lines, options)) {
      warning.value = worst->share;
      warning.channel = r.outputs[static_cast<std::size_t>(worst->output)].name;
    }
  }
  r.warnings.push_back(std::move(warning));
  add_warnings_of_rest(blocks, lines, r);
}

/// Of blocks that are long enough for the lines that are needed.
struct Transformed {
  Spectra damped{}, plain{};
  KeptLines lines{};
  double decay{};  ///< a, per sample
};

std::optional<Transformed> transformed(Blocks& blocks, const HitOptions& options) {
  do {
    if (blocks.samples < options.fewest / 2) continue;
    const double decay = options.decay / blocks.after();
    Transformed t{.damped = spectra_of_blocks(blocks, decay),
                  .plain = spectra_of_blocks(blocks, 0.0),
                  .decay = decay};
    t.lines = lines_of_hits(t.damped, t.plain, options);
    if (t.lines.kept.size() >= options.fewest_lines) return t;
  } while (leave_out_shortest(blocks, options));
  return {};
}

/// Where hits meet in a block, |U| changes from line to line, and errors with it.
void add_input_density(const Blocks& blocks, const Transformed& t, FrequencyResponses& r) {
  if (std::ranges::all_of(blocks.list, [](const Block& block) { return block.hits == 1; })) return;
  const double unit = 2.0 / (r.sample_rate * static_cast<double>(blocks.samples) * r.averages);
  for (const Index k : t.lines.kept)
    r.input_density.push_back(VectorXd::Constant(1, unit * t.damped.power[k]));
}

}  // namespace

std::optional<HitResponses> responses_of_hits(const std::vector<data::Samples>& samples,
                                              const std::vector<data::Channel>& outputs,
                                              const ChannelChoice& choice, double sample_rate,
                                              const std::vector<ChannelHealth>& health,
                                              const HitOptions& options) {
  if (samples.empty() || choice.inputs.size() != 1) return {};
  std::vector<Record> records;
  for (const auto& own : samples) {
    auto record = record_of(own, choice, health, options);
    if (!record) return {};
    records.push_back(std::move(*record));
  }
  Blocks blocks = blocks_of(records, options);
  const auto t = transformed(blocks, options);
  if (!t) return {};
  FrequencyResponses r{.outputs = outputs,
                       .shift = t->decay * sample_rate,
                       .sample_rate = sample_rate,
                       .estimator = Estimator::h1,
                       .averages = static_cast<double>(blocks.list.size())};
  r.line_covariance = covariance_of_lines(t->damped, t->lines, t->decay, options);
  for (const Index k : t->lines.kept) {
    r.frequency.push_back(static_cast<double>(k) * sample_rate /
                          static_cast<double>(blocks.samples));
    r.H.push_back(t->damped.response(k));
    r.on_axis.push_back(t->plain.response(k));
  }
  add_input_density(blocks, *t, r);
  add_warnings(blocks, t->damped, t->lines, options, r);
  return HitResponses{std::move(r), blocks.samples, blocks.cut > 0};
}

}  // namespace hydrapod::identification
