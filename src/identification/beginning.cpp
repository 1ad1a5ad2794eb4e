#include "beginning.hpp"

#include <algorithm>

#include "bridge.hpp"
#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::identification {

Beginning::Beginning(data::RecordSet& records, const ChannelChoice& choice, std::int64_t settling)
    : records_(records), settling_(settling) {
  for (const auto* list : {&choice.inputs, &choice.instruments})
    if (!list->empty()) samples_[list->front()];
}

VectorXd Beginning::of(int channel) {
  if (!read_) read();
  const auto& samples = samples_.at(channel);
  return VectorXd::Map(samples.data(), static_cast<Index>(samples.size()));
}

void Beginning::read() {
  constexpr std::int64_t most = 1 << 20;
  std::int64_t seen = 0, taken = 0;
  records_.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    if (file > 0) return false;
    const Index first = std::clamp<std::int64_t>(settling_ - seen, 0, block.rows()),
                count = std::min<std::int64_t>(block.rows() - first, most - taken);
    for (auto& [channel, samples] : samples_)
      for (Index k = first; k < first + count; ++k) samples.push_back(block(k, channel));
    seen += block.rows();
    taken += count;
    return taken < most;
  });
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

bool fills_band(const VectorXd& samples, int block, const FilledBand& options) {
  const VectorXd x = bridged(samples);
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

}  // namespace hydrapod::identification
