#include "held_values.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "usable.hpp"

namespace hydrapod::identification {

namespace {

double hold_of(const CrossSpectra& spectra, int channel) {
  return spectra.health[static_cast<std::size_t>(channel)].held_samples;
}

/// 1 where there is no such channel.
double hold_of(const CrossSpectra& spectra, const data::Channel& channel) {
  for (std::size_t c = 0; c < spectra.channels.size(); ++c)
    if (spectra.channels[c].name == channel.name) return spectra.health[c].held_samples;
  return 1.0;
}

/// D, z being e^(sT).
Complex transform_of_hold(double samples, Complex s, double sample_rate) {
  if (samples <= 1.0) return 1.0;
  const Complex per_sample = s / sample_rate;
  return (1.0 - std::exp(-samples * per_sample)) / (samples * (1.0 - std::exp(-per_sample)));
}

/// Mean density of a channel from `from` to `to` [Hz], without its hold.
double density(const CrossSpectra& spectra, int channel, double from, double to) {
  const Index diagonal = Index{channel} * (channel + 3) / 2;
  double sum = 0.0;
  Index count = 0;
  for (Index k = 1; k < spectra.lines(); ++k) {
    const double f = spectra.frequency(k);
    if (f < from || f > to) continue;
    sum += spectra.re(k, diagonal) /
           std::norm(transform_of_hold(hold_of(spectra, channel), Complex(0.0, two_pi * f),
                                       spectra.sample_rate));
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

double by(double part, double all) { return all > 0.0 ? std::clamp(part / all, 0.0, 1.0) : 0.0; }

data::ResponseWarning warning_of(const CrossSpectra& spectra, int channel) {
  const double samples = hold_of(spectra, channel);
  return {.kind = data::ResponseWarning::Kind::slow_channel,
          .channel = spectra.channels[static_cast<std::size_t>(channel)].name,
          .value = samples,
          .highest = 0.5 * spectra.sample_rate / samples};
}

/// Of an input: its density at half of its own rate, by that of all below, as what is below is
/// mixed with as much.
double folded_share(const CrossSpectra& spectra, int input, double own) {
  constexpr double edge = 0.95;
  return by(density(spectra, input, edge * own, own), density(spectra, input, 0.0, edge * own));
}

/// Of periodic inputs: what they excite above, by what they excite below.
double periodic_share(const CrossSpectra& spectra, const std::vector<int>& inputs, double own) {
  double below = 0.0, above = 0.0;
  for (const int i : inputs) {
    below += own * density(spectra, i, 0.0, own);
    above +=
        (0.5 * spectra.sample_rate - own) * density(spectra, i, own, 0.5 * spectra.sample_rate);
  }
  return by(above, below);
}

}  // namespace

void ValueHold::add(const Column& samples) {
  for (const double x : samples) {
    if (changes_ >= options_.enough) return;
    if (x == last_) {
      run_ += run_ > 0;
      continue;
    }
    const double step = x - last_;
    if (std::isfinite(step)) {
      if (run_ > 0) {
        ++lengths_[std::min(run_, longest)];
        ++changes_;
        steps_.push_back(std::abs(step));
      }
      run_ = 1;
    } else {
      run_ = 0;
    }
    last_ = x;
  }
}

double ValueHold::samples() const {
  if (changes_ < options_.least) return 1.0;
  std::size_t h = 1;
  for (int count = lengths_[1]; count <= options_.shorter * changes_ && h < longest;)
    count += lengths_[++h];
  if (h < 2 || h + 1 >= longest) return 1.0;
  const int own = lengths_[h], next = lengths_[h + 1];
  if (own + next < options_.alike * changes_ ||
      !(numerics::upper_median(steps_) > options_.of_step * std::ranges::min(steps_)))
    return 1.0;
  // equal values in succession make 2 h of h, and not h + 1
  return next <= options_.shorter * changes_
             ? static_cast<double>(h)
             : static_cast<double>(h) + next / static_cast<double>(own + next);
}

void leave_out_slow(const CrossSpectra& spectra, ChannelChoice& choice,
                    std::vector<data::ResponseWarning>& warnings, const HeldValueOptions& options) {
  double fastest = std::numeric_limits<double>::infinity();
  for (const int o : choice.outputs) fastest = std::min(fastest, hold_of(spectra, o));
  std::erase_if(choice.outputs, [&](int o) {
    if (!(hold_of(spectra, o) > 1.0)) return false;
    auto warning = warning_of(spectra, o);
    warning.count = hold_of(spectra, o) > options.much_slower * fastest;
    if (warning.count == 0 && spectra.options.periodic)
      warning.share = periodic_share(spectra, choice.inputs, warning.highest);
    warnings.push_back(warning);
    return warning.count > 0;
  });
  if (!(fastest > 1.0)) return;
  for (const int i : choice.inputs) {
    if (!(hold_of(spectra, i) > 1.0)) continue;
    warnings.push_back(warning_of(spectra, i));
    warnings.back().share = folded_share(spectra, i, warnings.back().highest);
  }
}

void without_hold(const CrossSpectra& spectra, FrequencyResponses& r,
                  const HeldValueOptions& options) {
  std::vector<double> outputs, inputs;
  for (const auto& channel : r.outputs) outputs.push_back(hold_of(spectra, channel));
  const bool all = std::ranges::all_of(outputs, [](double h) { return h > 1.0; });
  for (const auto& channel : r.inputs) inputs.push_back(all ? hold_of(spectra, channel) : 1.0);
  if (r.whole || std::ranges::max(outputs) <= 1.0) return;
  const double slowest = std::ranges::max(inputs),
               highest = slowest > 1.0 ? options.below_own * 0.5 * spectra.sample_rate / slowest
                                       : std::numeric_limits<double>::infinity();
  const auto holds = [&](const std::vector<double>& samples, std::size_t line) {
    VectorXcd D(std::ssize(samples));
    for (std::size_t c = 0; c < samples.size(); ++c)
      D[static_cast<Index>(c)] = transform_of_hold(
          samples[c], Complex(r.shift, two_pi * r.frequency[line]), spectra.sample_rate);
    return D;
  };
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const VectorXcd D_out = holds(outputs, k), D_in = holds(inputs, k);
    if (D_out.cwiseAbs().minCoeff() < options.least_hold * D_in.cwiseAbs().maxCoeff() ||
        r.frequency[k] > highest)
      continue;
    kept.push_back(k);
    const VectorXcd factor = D_out.cwiseInverse();
    r.H[k] = (factor.asDiagonal() * r.H[k] * D_in.asDiagonal()).eval();
    if (!r.on_axis.empty())
      r.on_axis[k] = (factor.asDiagonal() * r.on_axis[k] * D_in.asDiagonal()).eval();
    if (!r.noise.empty())
      r.noise[k] = (factor.asDiagonal() * r.noise[k] * factor.conjugate().asDiagonal()).eval();
    if (!r.input_factor.empty())
      r.input_factor[k] =
          (D_in.conjugate().asDiagonal() * r.input_factor[k] * D_in.asDiagonal()).eval();
  }
  if (kept.size() < r.lines()) r = lines_of(r, kept);
}

}  // namespace hydrapod::identification
