#include "response_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

using Kind = data::ResponseWarning::Kind;
using Warnings = std::vector<data::ResponseWarning>;

const std::string& name(const CrossSpectra& spectra, int channel) {
  return spectra.channels[static_cast<std::size_t>(channel)].name;
}

const ChannelHealth& health_of(const CrossSpectra& spectra, int channel) {
  return spectra.health[static_cast<std::size_t>(channel)];
}

/// Column of the pair in the packed spectra.
Index pair(int i, int j) {
  const Index a = std::max(i, j), b = std::min(i, j);
  return a * (a + 1) / 2 + b;
}

/// Power-weighted coherence of two channels over all lines.
double overall_coherence(const CrossSpectra& spectra, int a, int b) {
  double common = 0.0, total = 0.0;
  for (Index line = 2; line < spectra.lines() - 1; ++line) {
    const double aa = spectra.re(line, pair(a, a)), bb = spectra.re(line, pair(b, b));
    if (!(aa > 0.0) || !(bb > 0.0)) continue;
    common +=
        (std::pow(spectra.re(line, pair(a, b)), 2) + std::pow(spectra.im(line, pair(a, b)), 2)) /
        bb;
    total += aa;
  }
  return total > 0.0 ? common / total : 0.0;
}

bool is_dead(const CrossSpectra& spectra, int channel) {
  const auto& health = health_of(spectra, channel);
  return health.missing == health.samples || health.constant();
}

void drop_dead_outputs(const CrossSpectra& spectra, ChannelChoice& choice, Warnings& warnings) {
  std::erase_if(choice.outputs, [&](int o) {
    if (!is_dead(spectra, o)) return false;
    warnings.push_back({.kind = Kind::dead_output,
                        .channel = name(spectra, o),
                        .value = health_of(spectra, o).lowest});
    return true;
  });
  if (choice.outputs.empty()) throw base::ComputationError("all response channels are constant");
}

void drop_dead_inputs(const CrossSpectra& spectra, ChannelChoice& choice, Estimator estimator,
                      Warnings& warnings) {
  const bool square = estimator == Estimator::h2 || estimator == Estimator::instrumental;
  std::erase_if(choice.inputs, [&](int i) {
    if (!is_dead(spectra, i)) return false;
    if (square)
      throw base::ComputationError(
          fmt::format("input {} is dead, and {} needs all of them; leave it out, with its "
                      "counterpart, or take h1",
                      name(spectra, i), data::estimator_text(estimator)));
    warnings.push_back({.kind = Kind::dead_input, .channel = name(spectra, i)});
    return true;
  });
  if (choice.inputs.empty()) throw base::ComputationError("all input channels are constant");
}

void drop_repeated_inputs(const CrossSpectra& spectra, const ResponseCheckOptions& options,
                          ChannelChoice& choice, Warnings& warnings) {
  for (std::size_t b = 1; b < choice.inputs.size(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      if (overall_coherence(spectra, choice.inputs[b], choice.inputs[a]) > options.same_signal) {
        warnings.push_back({.kind = Kind::repeated_input,
                            .channel = name(spectra, choice.inputs[b]),
                            .other = name(spectra, choice.inputs[a])});
        choice.inputs.erase(choice.inputs.begin() + static_cast<std::ptrdiff_t>(b--));
        break;
      }
}

void check_counts(const CrossSpectra& spectra, const ChannelChoice& choice, Estimator estimator) {
  const auto p = choice.inputs.size();
  if (estimator == Estimator::h2 && choice.outputs.size() != p)
    throw base::ComputationError(
        fmt::format("h2 needs as many outputs as inputs, not {} and {}", choice.outputs.size(), p));
  if (estimator == Estimator::instrumental && choice.instruments.size() != p)
    throw base::ComputationError(
        fmt::format("the instrumental estimate needs as many excitations as inputs, not {} and {}",
                    choice.instruments.size(), p));
  const bool periodic = spectra.options.periodic;
  const double available = periodic ? spectra.records : spectra.statistics.effective_averages;
  const double needed = static_cast<double>(p) + (periodic ? 0.0 : 1.0);
  if (spectra.blocks == 0 || available < needed)
    throw base::ComputationError(fmt::format(
        "{} input{} need{} {} {}, this is {:.3g}{}: {}", p, p == 1 ? "" : "s", p == 1 ? "s" : "",
        periodic ? "at least as many records with different phases as inputs, that is" : "at least",
        periodic ? fmt::format("{}", p) : fmt::format("{:.3g} independent averages", needed),
        spectra.blocks == 0 ? 0.0 : available,
        spectra.blocks_left_out > 0
            ? fmt::format(" ({} of {} blocks have samples missing that cannot be filled)",
                          spectra.blocks_left_out, spectra.blocks + spectra.blocks_left_out)
            : "",
        periodic ? "measure again with other phases, or excite one direction at a time"
                 : "the record is too short for this resolution; take shorter blocks"));
  if (periodic && spectra.blocks <= spectra.records)
    throw base::ComputationError(
        "one period does not separate signal and noise: at least two are needed");
}

}  // namespace

void warn_of_limits(const CrossSpectra& spectra, const VectorXd& rms,
                    const std::vector<int>& channels, Warnings& warnings,
                    const ResponseCheckOptions& options) {
  for (const int c : channels) {
    const auto& health = health_of(spectra, c);
    const std::int64_t count = std::max(health.at_limit, health.in_flat_tops);
    const double share =
        static_cast<double>(count) / static_cast<double>(std::max<std::int64_t>(1, health.samples));
    const bool many = health.at_limit >= options.few_at_limit && share > options.rare_at_limit;
    const double power = share * std::pow(0.5 * (health.highest - health.lowest) / rms[c], 2);
    if ((many || health.in_flat_tops > 0) && share < options.two_levels)
      warnings.push_back({.kind = Kind::clipped,
                          .channel = name(spectra, c),
                          .value = std::isfinite(power) ? std::min(power, 1.0) : 1.0,
                          .share = share,
                          .lowest = health.lowest,
                          .highest = health.highest});
  }
}

double rms_in(const CrossSpectra& spectra, int channel) {
  const double width = spectra.sample_rate / static_cast<double>(spectra.options.block_length);
  const Index c = channel, diagonal = c * (c + 3) / 2;
  return std::sqrt(width * std::max(0.0, spectra.re.col(diagonal).sum()));
}

VectorXd rms_of_all(const CrossSpectra& spectra) {
  VectorXd rms(std::ssize(spectra.channels));
  for (Index c = 0; c < rms.size(); ++c) rms[c] = rms_in(spectra, static_cast<int>(c));
  return rms;
}

void warn_of_repeated(const CrossSpectra& spectra, const std::vector<int>& outputs,
                      Warnings& warnings) {
  constexpr double rounding = 1e-9;
  const auto repeats = [&](int a, int b) {
    const auto &one = health_of(spectra, a), &other = health_of(spectra, b);
    return one.lowest == other.lowest && one.highest == other.highest &&
           one.missing == other.missing && overall_coherence(spectra, a, b) > 1.0 - rounding;
  };
  for (std::size_t b = 1; b < outputs.size(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      if (repeats(outputs[b], outputs[a])) {
        warnings.push_back({.kind = Kind::repeated_output,
                            .channel = name(spectra, outputs[b]),
                            .other = name(spectra, outputs[a])});
        break;
      }
}

namespace {

/// Without dead outputs and inputs that repeat another.
void check_choice(const CrossSpectra& spectra, Estimator estimator,
                  const ResponseCheckOptions& options, ChannelChoice& choice, Warnings& warnings) {
  if (choice.inputs.empty()) throw base::ComputationError("no input channel is named");
  if (choice.outputs.empty()) throw base::ComputationError("no response channel is named");
  if (spectra.blocks > 0) {
    drop_dead_outputs(spectra, choice, warnings);
    drop_dead_inputs(spectra, choice, estimator, warnings);
    // over fewer records than inputs periodic inputs are always coherent
    if (spectra.options.periodic) check_counts(spectra, choice, estimator);
    if (estimator == Estimator::h1 || estimator == Estimator::hv)
      drop_repeated_inputs(spectra, options, choice, warnings);
  }
  if (options.of_averages) check_counts(spectra, choice, estimator);
  const VectorXd rms = rms_of_all(spectra);
  warn_of_limits(spectra, rms, choice.inputs, warnings, options);
  warn_of_limits(spectra, rms, choice.outputs, warnings, options);
  warn_of_repeated(spectra, choice.outputs, warnings);
  if (spectra.blocks_left_out > 0)
    warnings.push_back({.kind = Kind::blocks_left_out,
                        .count = spectra.blocks_left_out,
                        .total = spectra.blocks + spectra.blocks_left_out});
}

/// Where the instruments leave part of the band unexcited.
void warn_of_band(const CrossSpectra& spectra, const ResponseCheckOptions& options,
                  FrequencyResponses& r) {
  const auto& f = r.frequency;
  double spacing = f.back();
  for (std::size_t k = 1; k < f.size(); ++k) spacing = std::min(spacing, f[k] - f[k - 1]);
  std::int64_t gaps = 0;
  for (std::size_t k = 1; k < f.size(); ++k)
    gaps += f[k] - f[k - 1] > options.lines_missing * spacing;
  if (gaps > 0 || f.front() > options.lowest_lines * spectra.frequency(1) ||
      f.back() < options.pass_band * 0.5 * spectra.sample_rate)
    r.warnings.push_back(
        {.kind = Kind::excited_band, .lowest = f.front(), .highest = f.back(), .count = gaps});
}

}  // namespace

FrequencyResponses without_lines(const CrossSpectra& spectra, Estimator estimator,
                                 ChannelChoice& choice, const ResponseCheckOptions& options) {
  FrequencyResponses r{.estimator = estimator};
  check_choice(spectra, estimator, options, choice, r.warnings);
  for (const int i : choice.inputs) r.inputs.push_back(spectra.channels[static_cast<size_t>(i)]);
  for (const int o : choice.outputs) r.outputs.push_back(spectra.channels[static_cast<size_t>(o)]);
  r.averages = spectra.statistics.effective_averages;
  r.sample_rate = spectra.sample_rate;
  return r;
}

void keep_positive(const CrossSpectra& spectra, Index line, const std::vector<int>& outputs,
                   MatrixXcd& V) {
  for (Index o = 0; o < V.rows(); ++o) {
    const int channel = outputs[static_cast<std::size_t>(o)];
    V(o, o) = std::max(V(o, o).real(), 1e-15 * spectra.re(line, pair(channel, channel)));
  }
}

LineQuality quality_of(const CrossSpectra& spectra, Index line, const ChannelChoice& c,
                       const MatrixXcd& V) {
  const auto level = [&](int channel) { return spectra.re(line, pair(channel, channel)); };
  LineQuality quality{.coherence = MatrixXd(c.outputs.size(), c.inputs.size()),
                      .multiple_coherence = VectorXd(c.outputs.size()),
                      .input_density = VectorXd(c.inputs.size())};
  for (std::size_t o = 0; o < c.outputs.size(); ++o) {
    const double power = level(c.outputs[o]);
    for (std::size_t i = 0; i < c.inputs.size(); ++i) {
      const double product = power * level(c.inputs[i]);
      const Index both = pair(c.outputs[o], c.inputs[i]);
      const double re = spectra.re(line, both), im = spectra.im(line, both);
      quality.coherence(o, i) = product > 0.0 ? (re * re + im * im) / product : 0.0;
    }
    const double noise = V(static_cast<Index>(o), static_cast<Index>(o)).real();
    quality.multiple_coherence[o] = power > 0.0 ? std::clamp(1.0 - noise / power, 0.0, 1.0) : 0.0;
  }
  for (std::size_t i = 0; i < c.inputs.size(); ++i) quality.input_density[i] = level(c.inputs[i]);
  return quality;
}

namespace {

/// Where all inputs are excited: elsewhere their matrix is rounding. Everywhere, if they nowhere
/// are.
double median_condition(const FrequencyResponses& r, const ResponseCheckOptions& options) {
  if (r.input_density.size() != r.lines()) return numerics::upper_median(r.condition);
  VectorXd most = VectorXd::Zero(std::ssize(r.inputs));
  for (std::size_t k = 0; k < r.lines(); ++k) most = most.cwiseMax(r.input_density[k]);
  std::vector<double> excited;
  for (std::size_t k = 0; k < r.lines(); ++k)
    if ((r.input_density[k].array() > options.excited * most.array()).all())
      excited.push_back(r.condition[k]);
  return numerics::upper_median(excited.empty() ? r.condition : excited);
}

}  // namespace

void finish_checks(const CrossSpectra& spectra, const ChannelChoice& choice,
                   FrequencyResponses& responses, const ResponseCheckOptions& options) {
  if (responses.lines() == 0) {
    const bool several = choice.inputs.size() > 1;
    throw base::ComputationError(
        several ? "the inputs are linearly dependent at every frequency (one is a mixture of the "
                  "others): leave inputs out, or excite them independently"
                : fmt::format("input {} has no excitation", name(spectra, choice.inputs[0])));
  }
  const double median = median_condition(responses, options);
  // independent inputs: the spread of the eigenvalues of a sample covariance (Marchenko, Pastur)
  const double spread = std::sqrt(static_cast<double>(choice.inputs.size()) / responses.averages);
  const double chance = spread < 1.0 ? std::pow((1.0 + spread) / (1.0 - spread), 2) : INFINITY;
  if (choice.inputs.size() > 1 && median > options.correlated * chance)
    responses.warnings.push_back({.kind = Kind::correlated_inputs, .value = median});
  if (responses.estimator == Estimator::instrumental) warn_of_band(spectra, options, responses);
}

}  // namespace hydrapod::identification
