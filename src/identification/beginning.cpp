#include "beginning.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "bridge.hpp"
#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::identification {

Beginning::Beginning(data::RecordSet& records, const ChannelChoice& choice, std::int64_t settling)
    : records_(records), settling_(settling) {
  for (const int input : choice.inputs) samples_[input];
  for (const int instrument : choice.instruments) samples_[instrument];
}

const VectorXd& Beginning::of(int channel) {
  if (!read_) read();
  return samples_.at(channel);
}

void Beginning::release() {
  for (auto& [channel, samples] : samples_) samples = VectorXd();
  read_ = false;
}

void Beginning::read() {
  constexpr std::int64_t most = 1 << 20;
  const std::int64_t there = records_.sample_count().value_or(most);
  for (auto& [channel, samples] : samples_)
    samples.resize(std::clamp<std::int64_t>(there, 0, most));
  std::int64_t seen = 0, taken = 0;
  whole_ = true;
  records_.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    if (file > 0) return false;
    const Index first = std::clamp<std::int64_t>(settling_ - seen, 0, block.rows()),
                count = std::min<std::int64_t>(block.rows() - first, most - taken);
    std::vector<std::pair<Index, double*>> columns;
    for (auto& [channel, samples] : samples_) {
      if (samples.size() < taken + count) samples.conservativeResize(most);
      columns.emplace_back(channel, samples.data() + taken);
    }
    for (Index t = first; t < first + count; ++t) {
      const double* row = block.data() + t * block.outerStride();
      for (auto& [column, to] : columns) *to++ = row[column];
    }
    seen += block.rows();
    taken += count;
    whole_ = taken < most;
    return whole_;
  });
  for (auto& [channel, samples] : samples_) samples.conservativeResize(taken);
  read_ = true;
}

namespace {

/// To see whether the first input repeats.
std::int64_t find_period(const VectorXd& x) {
  if (x.size() < 32) return 0;
  return period_of(x.tail(x.size() - x.size() / 8));  // past a fade-in
}

}  // namespace

std::int64_t excitation_period(const data::RecordSet& records, const ChannelChoice& choice,
                               Beginning& beginning) {
  if (!choice.instruments.empty() && records.files().size() >= choice.inputs.size())
    if (const auto period = find_period(beginning.of(choice.instruments[0])); period > 0)
      return period;
  return find_period(beginning.of(choice.inputs[0]));
}

namespace {

/// |X|² of sections, sections × lines, so many transformed side by side.
MatrixXd power_of_sections(const VectorXd& x, int block) {
  constexpr Index together = 8;
  const Index sections = x.size() / block;
  const VectorXd window = window_samples(Window::hann, block);
  numerics::RealFft fft(block);
  MatrixXd power(sections, fft.lines());
  for (Index first = 0; first < sections; first += together) {
    const Index count = std::min(together, sections - first);
    const numerics::RealFft::Block some = MatrixXd::Map(x.data() + first * block, block, count);
    std::vector<numerics::EightLines> lines(static_cast<std::size_t>(fft.line_groups() * count));
    fft.forward(some, some.colwise().mean(), window, lines.data(), count);
    for (Index k = 0; k < power.cols(); ++k)
      for (Index c = 0; c < count; ++c) {
        const auto& eight = lines[static_cast<std::size_t>(k / 8 * count + c)];
        const auto lane = static_cast<std::size_t>(k % 8);
        power(first + c, k) = eight.re[lane] * eight.re[lane] + eight.im[lane] * eight.im[lane];
      }
  }
  return power;
}

/// The same in bands of equal power, sum 1.
MatrixXd in_equal_bands(const MatrixXd& power, int bands) {
  const double total = power.sum();
  MatrixXd sums = MatrixXd::Zero(power.rows(), bands);
  double below = 0.0;
  for (Index k = 0; k < power.cols(); ++k) {
    const double own = power.col(k).sum();
    const auto band = static_cast<Index>(bands * (below + 0.5 * own) / total);
    sums.col(std::clamp<Index>(band, 0, bands - 1)) += power.col(k) / total;
    below += own;
  }
  return sums;
}

double entropy(const VectorXd& share) {
  double sum = 0.0;
  for (const double p : share)
    if (p > 0.0) sum -= p * std::log(p);
  return sum;
}

}  // namespace

std::optional<Swept> sweep_in(const VectorXd& samples, double sample_rate,
                              const SweepRules& rules) {
  constexpr unsigned shortest = 32;  // samples of a section
  const auto longest = static_cast<unsigned>(samples.size() / rules.sections);
  if (longest < shortest) return {};
  const auto block = static_cast<int>(std::bit_floor(longest));
  const MatrixXd power = samples.allFinite() ? power_of_sections(samples, block)
                                             : power_of_sections(bridged(samples), block);
  if (!(power.sum() > 0.0) || !power.allFinite()) return {};
  const MatrixXd p = in_equal_bands(power, rules.bands);
  const VectorXd of_time = p.rowwise().sum();
  const double E_t = entropy(of_time), E_f = entropy(p.colwise().sum().transpose());
  const double told = E_t + E_f - entropy(p.reshaped());
  const double least = std::log(rules.fewest);
  if (E_t < least || E_f < least || !(told > rules.tells * std::min(E_t, E_f))) return {};
  const double spacing = sample_rate / block;
  Swept swept{0.5 * sample_rate, 0.0};
  for (Index t = 0; t < power.rows(); ++t) {
    if (!(of_time[t] > rules.heard * of_time.mean())) continue;
    const double largest = power.row(t).maxCoeff();
    for (Index k = 0; k < power.cols(); ++k) {
      if (!(power(t, k) > rules.edge * largest)) continue;
      swept.from = std::min(swept.from, spacing * static_cast<double>(k));
      swept.to = std::max(swept.to, spacing * static_cast<double>(k));
    }
  }
  return swept;
}

bool fills_band(const VectorXd& samples, int block, const FilledBand& options) {
  const VectorXd power = power_of_sections(bridged(samples), block).colwise().sum();
  const auto below = static_cast<Index>(options.pass_band * static_cast<double>(power.size()));
  return static_cast<double>(
             (power.head(below).array() > options.quiet * power.maxCoeff()).count()) >=
         options.most_lines * static_cast<double>(below);
}

}  // namespace hydrapod::identification
