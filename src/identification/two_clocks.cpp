#include "two_clocks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "hydrapod/numerics/fft.hpp"
#include "tone_zoom.hpp"

namespace hydrapod::identification {

namespace {

/// Phase of the highest line at the end of the record between two ε that are tried: half of it off,
/// no line loses more than (sin(0.5)/0.5)² = 8 % of its power.
constexpr double radians_of_step = 2.0;

/// Which blocks and lines are taken.
struct PartPlan {
  int block{};        // [samples]
  Index together{1};  // blocks of a part
  Index parts{};      // of the longest record
  std::vector<Index> lines{};
  double duration{};  // [s] of the longest record
};

/// Cross spectra of one record in parts: for each line a matrix of entries (output, then input) by
/// parts.
struct Parts {
  std::vector<MatrixXcd> lines{};  // columns from `count` on are not filled yet
  Index count{};

  /// Entries × lines of the next part; `most`: there are no more.
  void add(const MatrixXcd& part, Index most) {
    if (lines.empty())
      lines.assign(static_cast<std::size_t>(part.cols()), MatrixXcd(part.rows(), most));
    for (Index k = 0; k < part.cols(); ++k)
      lines[static_cast<std::size_t>(k)].col(count) = part.col(k);
    ++count;
  }
  [[nodiscard]] auto of(std::size_t line) const { return lines[line].leftCols(count); }
};

std::optional<PartPlan> plan_parts(data::RecordSet& records, std::int64_t settling,
                                   const TwoClocksOptions& options) {
  std::int64_t longest = 0;
  for (std::size_t k = 0; k < records.files().size(); ++k)
    longest = std::max(longest, records.count_samples(k) - settling);
  constexpr int shortest = 64;
  const auto wanted = static_cast<std::uint64_t>(std::max<std::int64_t>(0, longest)) /
                      static_cast<std::uint64_t>(options.fewest_blocks);
  if (wanted < shortest) return {};
  PartPlan plan{.block = static_cast<int>(std::min<std::uint64_t>(
                    std::bit_floor(wanted), static_cast<std::uint64_t>(options.block)))};
  const double rate = records.header().sample_rate;
  plan.duration = static_cast<double>(longest) / rate;
  const Index blocks = static_cast<Index>(longest / plan.block);
  plan.together = (blocks + options.most_parts - 1) / options.most_parts;
  plan.parts = blocks / plan.together;
  // within a part phases turn little; above, what recorders filter
  const double part = static_cast<double>(plan.together * plan.block);
  constexpr double pass_band = 0.4;  // of the sample rate
  // per sample rate, at 2 rad of a step of ε
  const double steps = two_pi * rate * options.most * plan.duration;
  const double highest = std::min({pass_band, 1.0 / (two_pi * options.most * part),
                                   0.5 * static_cast<double>(options.most_steps) / steps});
  constexpr Index lowest = 3;  // below is the mean
  const auto last = static_cast<Index>(highest * plan.block);
  const Index stride = std::max<Index>(2, (last - lowest) / options.most_lines + 1);
  for (Index k = lowest; k <= last; k += stride) plan.lines.push_back(k);
  constexpr std::size_t fewest_lines = 8;
  if (plan.lines.size() < fewest_lines) return {};
  return plan;
}

/// Forms the parts of records one after the other.
class PartsOfRecords {
 public:
  PartsOfRecords(const PartPlan& plan, const ChannelChoice& choice, std::size_t records)
      : plan_(plan),
        choice_(choice),
        fft_(plan.block),
        window_(window_samples(Window::hann, plan.block)),
        parts_(records) {}

  void begin_record(std::size_t record) {
    record_ = record;
    filled_ = in_part_ = 0;
  }
  /// Rows from `first` on, of the columns `used`.
  void add(const Eigen::Ref<const data::Samples>& samples, Index first,
           const std::vector<Index>& used) {
    if (buffer_.size() == 0) buffer_.resize(plan_.block, std::ssize(used));
    for (Index at = first; at < samples.rows(); ++at) {
      const double* from = samples.data() + at * samples.outerStride();
      double* to = buffer_.data() + filled_ * buffer_.cols();
      for (const Index column : used) *to++ = from[column];
      if (++filled_ < buffer_.rows()) continue;
      filled_ = 0;
      take_block();
    }
  }
  [[nodiscard]] const std::vector<Parts>& parts() const { return parts_; }

 private:
  void take_block() {
    const auto lines = static_cast<Index>(plan_.lines.size());
    const auto p = static_cast<Index>(choice_.inputs.size()),
               q = static_cast<Index>(choice_.outputs.size());
    if (in_part_ == 0) {
      S_yu_.setZero(q * p, lines);
      S_uu_.setZero(p, lines);
    }
    const Eigen::RowVectorXd mean = buffer_.colwise().mean();
    if (mean.allFinite()) {
      transform(mean);
      for (Index k = 0; k < lines; ++k) add_products(k);
    }
    if (++in_part_ < plan_.together) return;
    in_part_ = 0;
    const MatrixXd root = S_uu_.cwiseMax(1e-300).cwiseSqrt();
    for (Index o = 0; o < q; ++o) S_yu_.middleRows(o * p, p).array() /= root.array();
    parts_[record_].add(S_yu_, plan_.parts);
  }

  void transform(const Eigen::RowVectorXd& mean) {
    spectrum_.resize(static_cast<std::size_t>(fft_.line_groups() * buffer_.cols()));
    fft_.forward(buffer_, mean, window_, spectrum_.data(), buffer_.cols());
  }
  /// Of the line with that number in the plan.
  void add_products(Index number) {
    const Index line = plan_.lines[static_cast<std::size_t>(number)];
    const auto lane = static_cast<std::size_t>(line % 8);
    const auto* all = spectrum_.data() + line / 8 * buffer_.cols();
    Complex* yu = S_yu_.col(number).data();
    double* uu = S_uu_.col(number).data();
    for (const int o : choice_.outputs) {
      const double re = all[o].re[lane], im = all[o].im[lane];
      for (const int i : choice_.inputs) {
        const double u_re = all[i].re[lane], u_im = all[i].im[lane];
        *yu++ += Complex(u_re * re + u_im * im, u_re * im - u_im * re);
      }
    }
    for (const int i : choice_.inputs)
      *uu++ += all[i].re[lane] * all[i].re[lane] + all[i].im[lane] * all[i].im[lane];
  }

  PartPlan plan_;
  ChannelChoice choice_;
  numerics::RealFft fft_;
  VectorXd window_;
  data::Samples buffer_{};
  std::vector<numerics::EightLines> spectrum_{};
  Index filled_{}, in_part_{};
  std::size_t record_{};
  MatrixXcd S_yu_{};
  MatrixXd S_uu_{};
  std::vector<Parts> parts_;
};

/// L(ε) by entries and lines.
class ClockLikelihood {
 public:
  ClockLikelihood(const std::vector<Parts>& records, const PartPlan& plan, double rate)
      : records_(records), spacing_(static_cast<double>(plan.together * plan.block) / rate) {
    for (const Index k : plan.lines)
      omega_.push_back(two_pi * static_cast<double>(k) * rate / plan.block);
    for (const auto& record : records) {
      if (record.count == 0) continue;
      if (power_.size() == 0)
        power_.setZero(record.of(0).rows(), static_cast<Index>(omega_.size()));
      for (std::size_t k = 0; k < omega_.size(); ++k)
        power_.col(static_cast<Index>(k)) += record.of(k).cwiseAbs2().rowwise().sum();
      count_ += static_cast<double>(record.count);
    }
  }
  [[nodiscard]] double parts() const { return count_; }
  [[nodiscard]] double entries() const { return static_cast<double>(power_.rows()); }
  [[nodiscard]] double highest() const { return omega_.back(); }

  /// Σ L(k step) for |k| ≤ `steps`: the sums over parts by transforms with `finer` times as many
  /// points as there are parts, and linear between these.
  [[nodiscard]] VectorXd at_steps(double step, Index steps) const {
    VectorXd total = VectorXd::Zero(2 * steps + 1);
    Rows rho(total.size(), power_.rows());
    std::vector<numerics::SeriesFft> transforms;
    for (const auto& record : records_)
      transforms.emplace_back(
          static_cast<int>(finer * std::bit_ceil(static_cast<std::size_t>(record.count))));
    for (std::size_t k = 0; k < omega_.size(); ++k) {
      const auto line = static_cast<Index>(k);
      rho.setZero();
      for (std::size_t r = 0; r < records_.size(); ++r)
        if (records_[r].count > 0)
          add_at_steps(records_[r], k, omega_[k] * step * spacing_, transforms[r], rho);
      rho.rowwise() /= power_.col(line).cwiseMax(1e-300).transpose().array();
      total -= count_ * (1.0 - rho.min(1.0 - 1e-9)).rowwise().prod().log().matrix();
    }
    return total;
  }
  [[nodiscard]] Eigen::ArrayXXd operator()(double ratio) const {
    Eigen::ArrayXXd rho = Eigen::ArrayXXd::Zero(power_.rows(), power_.cols());
    for (const auto& record : records_) {  // delays between recorders begin anew
      if (record.count == 0) continue;
      VectorXcd phases(record.count);
      for (std::size_t k = 0; k < omega_.size(); ++k) {
        const Complex turn = std::polar(1.0, omega_[k] * ratio * spacing_);
        phases[0] = 1.0;
        for (Index g = 1; g < phases.size(); ++g) phases[g] = phases[g - 1] * turn;
        const VectorXcd sum = record.of(k) * phases;
        rho.col(static_cast<Index>(k)) +=
            sum.cwiseAbs2().array() / static_cast<double>(record.count);
      }
    }
    rho /= power_.array().max(1e-300);
    return -count_ * (1.0 - rho.min(1.0 - 1e-9)).log();
  }
  /// L(0) of entries that change their sign once in each record where that says more: a cable that
  /// was turned round is no clock.
  [[nodiscard]] Eigen::ArrayXXd turned_once() const {
    Eigen::ArrayXXd rho = Eigen::ArrayXXd::Zero(power_.rows(), power_.cols());
    for (const auto& record : records_)
      if (record.count > 0) rho += turned_once(record) / static_cast<double>(record.count);
    rho /= power_.array().max(1e-300);
    return -count_ * (1.0 - rho.min(1.0 - 1e-9)).log();
  }

 private:
  /// |Σ_g ±C_g|² of each entry with the sign turned behind that part where its sum over lines, each
  /// by its power, is largest; behind the last one is not at all.
  [[nodiscard]] Eigen::ArrayXXd turned_once(const Parts& record) const {
    const auto squares = [&](std::size_t k, const auto& take) {
      VectorXcd sum = record.of(k).rowwise().sum();
      take(record.count - 1, sum.cwiseAbs2());
      for (Index g = 0; g + 1 < record.count; ++g) {
        sum -= 2.0 * record.of(k).col(g);
        take(g, sum.cwiseAbs2());
      }
    };
    Eigen::ArrayXXd weighted = Eigen::ArrayXXd::Zero(power_.rows(), record.count), best = power_;
    for (std::size_t k = 0; k < omega_.size(); ++k) {
      const Eigen::ArrayXd weight = power_.col(static_cast<Index>(k)).array().max(1e-300).inverse();
      squares(k, [&](Index g, const auto& own) { weighted.col(g) += weight * own.array(); });
    }
    std::vector<Index> where(static_cast<std::size_t>(power_.rows()), record.count - 1);
    for (Index e = 0; e < power_.rows(); ++e)
      for (Index g = 0; g + 1 < record.count; ++g) {
        auto& own = where[static_cast<std::size_t>(e)];
        if (weighted(e, g) > weighted(e, own)) own = g;
      }
    for (std::size_t k = 0; k < omega_.size(); ++k)
      squares(k, [&](Index g, const auto& own) {
        for (Index e = 0; e < power_.rows(); ++e)
          if (where[static_cast<std::size_t>(e)] == g) best(e, static_cast<Index>(k)) = own[e];
      });
    return best;
  }

  using Rows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr std::size_t finer = 2;

  /// |Σ_g C_g e^(iθg)|²/G of all entries at θ = k · `turn`, a row each.
  static void add_at_steps(const Parts& record, std::size_t line, double turn,
                           numerics::SeriesFft& transform, Rows& rho) {
    const MatrixXcd series = record.of(line).adjoint();  // of C*, whose sums turn the other way
    const auto powers = transform.powers(series);
    const Index count = powers.rows(), steps = rho.rows() / 2;
    const auto power = [&](Index t) { return powers.row((t % count + count) % count).array(); };
    const double per_step = turn / two_pi * static_cast<double>(count);
    const auto parts = static_cast<double>(series.rows());
    for (Index k = -steps; k <= steps; ++k) {
      const double at = per_step * static_cast<double>(k), whole = std::floor(at);
      const auto t = static_cast<Index>(whole);
      rho.row(k + steps) +=
          (1.0 + whole - at) / parts * power(t) + (at - whole) / parts * power(t + 1);
    }
  }

  const std::vector<Parts>& records_;
  double spacing_;
  std::vector<double> omega_{};
  MatrixXd power_{};
  double count_{};
};

/// Gain by line, without the contiguous quarter of them that gains most.
double gain_of_others(const Eigen::RowVectorXd& by_line) {
  const Index wide = std::max<Index>(1, by_line.size() / 4);
  double most = 0.0;
  for (Index k = 0; k + wide <= by_line.size(); ++k)
    most = std::max(most, by_line.segment(k, wide).sum());
  return by_line.sum() - most;
}

/// Of some entries, for steps of ε: as many as `most`, evenly.
std::vector<Parts> some_entries(const std::vector<Parts>& all, Index most) {
  std::vector<Parts> some(all.size());
  for (std::size_t r = 0; r < all.size(); ++r) {
    some[r].count = all[r].count;
    for (const auto& line : all[r].lines) {
      const Index stride = (line.rows() + most - 1) / most;
      some[r].lines.emplace_back(line(Eigen::seq(0, line.rows() - 1, stride), Eigen::all));
    }
  }
  return some;
}

/// The most likely ε: first by steps, the best ones exactly, then between them. 0 where none says
/// more than L(0) + `least`.
double best_ratio(const ClockLikelihood& likelihood, const PartPlan& plan,
                  const TwoClocksOptions& options, double least) {
  const double step = radians_of_step / (likelihood.highest() * plan.duration);
  const auto steps = static_cast<Index>(std::ceil(options.most / step));
  Index most = 0;
  likelihood.at_steps(step, steps).maxCoeff(&most);
  const double of_none = likelihood(0.0).sum();
  double best = 0.0, largest = of_none;
  const auto ask = [&](double ratio) {
    const double own = likelihood(ratio).sum();
    if (own > largest) {
      largest = own;
      best = ratio;
    }
    return own;
  };
  constexpr Index beside = 1;  // steps: what lines between the points of a transform may be off
  for (Index k = std::max<Index>(0, most - beside); k <= std::min(2 * steps, most + beside); ++k)
    if (k != steps) ask(step * static_cast<double>(k - steps));
  // vertices of parabolas
  double width = 0.5 * step;
  constexpr int refinements = 5;
  for (int n = 0; n < refinements; ++n, width *= 0.25) {
    const double centre = best, middle = largest, below = ask(centre - width),
                 above = ask(centre + width), bend = 2.0 * middle - below - above;
    if (bend > 0.0) {
      const double by = 0.5 * (above - below) / bend;  // widths
      ask(centre + width * std::clamp(by, -1.0, 1.0));
    }
    if (!(largest > of_none + least)) return 0.0;
  }
  return best;
}

}  // namespace

struct ClockSearch::Implementation {
  PartPlan plan{};
  ChannelChoice choice{};
  std::vector<Index> used{};
  std::int64_t settling{}, to_skip{};
  double rate{};
  TwoClocksOptions options{};
  PartsOfRecords parts;
};

ClockSearch::ClockSearch(data::RecordSet& records, const std::vector<std::size_t>& used,
                         const ChannelChoice& choice, std::int64_t settling,
                         const TwoClocksOptions& options) {
  const auto plan = plan_parts(records, settling, options);
  if (!plan) return;
  implementation_ = std::make_unique<Implementation>(
      Implementation{.plan = *plan,
                     .choice = choice,
                     .used = {used.begin(), used.end()},
                     .settling = settling,
                     .rate = records.header().sample_rate,
                     .options = options,
                     .parts = PartsOfRecords(*plan, choice, records.files().size())});
}
ClockSearch::~ClockSearch() = default;

void ClockSearch::begin_record(std::size_t record) {
  if (!implementation_) return;
  implementation_->to_skip = implementation_->settling;
  implementation_->parts.begin_record(record);
}

void ClockSearch::add(const Eigen::Ref<const data::Samples>& samples) {
  if (!implementation_) return;
  auto& me = *implementation_;
  const Index skipped = std::min(me.to_skip, samples.rows());
  me.to_skip -= skipped;
  me.parts.add(samples, skipped, me.used);
}

std::optional<ClockDifference> ClockSearch::result() const {
  if (!implementation_) return {};
  const auto& [plan, choice, used, settling, to_skip, rate, options, parts] = *implementation_;
  const ClockLikelihood likelihood(parts.parts(), plan, rate);
  if (likelihood.parts() < static_cast<double>(options.fewest_blocks) / 2.0) return {};
  constexpr Index enough = 8;  // entries
  const auto some = some_entries(parts.parts(), enough);
  const ClockLikelihood of_some(some, plan, rate);
  const double least = options.worth_refining * options.evidence * of_some.entries();
  const double ratio = best_ratio(of_some, plan, options, least);
  if (ratio == 0.0) return {};
  const Eigen::ArrayXXd of_clock = likelihood(ratio), as_it_is = likelihood(0.0),
                        gain = of_clock - as_it_is;
  Eigen::ArrayXXd over_turn = of_clock - likelihood.turned_once();
  for (Index e = 0; e < gain.rows(); ++e)
    if (!((gain.row(e) - over_turn.row(e)).sum() > options.evidence))
      over_turn.row(e) = gain.row(e);
  const Eigen::RowVectorXd by_line = over_turn.colwise().mean().matrix();
  // at the end of what is tried it is none of a clock
  if (std::abs(ratio) > 0.99 * options.most || !(gain_of_others(by_line) > options.evidence))
    return {};
  ClockDifference found{.ratio = ratio, .turn = ratio * plan.duration};
  const auto p = static_cast<Index>(choice.inputs.size());
  for (std::size_t o = 0; o < choice.outputs.size(); ++o)
    if (gain.middleRows(static_cast<Index>(o) * p, p).sum() > -options.own_clock)
      found.outputs.push_back(choice.outputs[o]);
  return found;
}

ClockCorrector::ClockCorrector(std::vector<Index> columns, double sample_rate, double ratio,
                               Use use)
    : columns_(std::move(columns)),
      sample_rate_(sample_rate),
      ratio_(ratio),
      use_(std::move(use)) {}

void ClockCorrector::add(const Eigen::Ref<const data::Samples>& samples) {
  if (!resampler_)
    resampler_ = std::make_unique<data::Resampler>(
        columns_.size(), sample_rate_, sample_rate_ / (1.0 + ratio_), [this](const auto& block) {
          const Index before = corrected_.rows();
          corrected_.conservativeResize(before + block.rows(), block.cols());
          corrected_.bottomRows(block.rows()) = block;
        });
  const Index before = waiting_.rows();
  waiting_.conservativeResize(before + samples.rows(), samples.cols());
  waiting_.bottomRows(samples.rows()) = samples;
  resampler_->add(data::Samples(samples(Eigen::all, columns_)));
  pass_on();
}

void ClockCorrector::end_record() {
  if (resampler_) resampler_->finish();
  pass_on();
  resampler_.reset();
  waiting_.resize(0, waiting_.cols());
  corrected_.resize(0, corrected_.cols());
}

void ClockCorrector::pass_on() {
  const Index count = std::min(waiting_.rows(), corrected_.rows());
  if (count == 0) return;
  data::Samples both = waiting_.topRows(count);
  both(Eigen::all, columns_) = corrected_.topRows(count);
  waiting_ = waiting_.bottomRows(waiting_.rows() - count).eval();
  corrected_ = corrected_.bottomRows(corrected_.rows() - count).eval();
  use_(both);
}

}  // namespace hydrapod::identification
