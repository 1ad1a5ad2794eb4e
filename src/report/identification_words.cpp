#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "two_digits.hpp"

namespace hydrapod::report {

const char* words(identification::Objection reason) {
  constexpr std::array all{"",
                           "left the band in the fit",
                           "is not above the noise",
                           "its frequency is not determined",
                           "its damping is not determined",
                           "repeats another pole",
                           "a number of the fit overflowed"};
  return all[static_cast<std::size_t>(reason)];
}

const char* words(identification::PoleStability stability) {
  constexpr std::array all{"new", "frequency", "damping", "vector"};
  return all[static_cast<std::size_t>(stability)];
}

std::string two_digits(double share) {
  const double percent = 100.0 * share;
  return std::abs(percent) < 99.5 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
}

namespace {

std::string motion_text(const identification::IdentifiedMode& mode, const Eigen::VectorXd& size,
                        const std::vector<data::Channel>& outputs) {
  // of repeated modes the fit has some mixture
  const auto& shape = mode.repeated > 1 ? mode.displacement : mode.fit.shape;
  Eigen::VectorXd share = shape.cwiseAbs().cwiseQuotient(size);
  share /= share.maxCoeff();
  std::vector<int> order(outputs.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](int a, int b) { return share[a] > share[b]; });
  std::string text;
  constexpr double shown = 0.2;
  constexpr std::size_t most = 4;
  for (std::size_t k = 0; k < std::min(most, order.size()) && share[order[k]] >= shown; ++k) {
    const bool opposite = (shape[order[k]] * std::conj(shape[order[0]])).real() < 0.0;
    text += fmt::format("{}{}{} {:.2f}", k == 0 ? "" : ", ", opposite ? "−" : "",
                        outputs[static_cast<std::size_t>(order[k])].name, share[order[k]]);
  }
  return text;
}

/// A limit to a thousandth of what the two are apart, with four digits or more.
std::string limit_text(double limit, const data::ResponseWarning& w) {
  const double ratio =
      std::max(std::abs(w.lowest), std::abs(w.highest)) / std::abs(w.highest - w.lowest);
  const double more = std::isfinite(ratio) ? std::ceil(std::log10(std::max(ratio, 1.0))) : 0.0;
  return fmt::format("{:.{}g}", limit, std::min(4 + static_cast<int>(more), 17));
}

std::string missing_samples_text(const data::ResponseWarning& w) {
  return fmt::format(
      "{} % of the samples are missing, most in {} ({} %): they were filled by prediction "
      "from the samples beside them{}",
      two_digits(static_cast<double>(w.count) /
                 static_cast<double>(std::max<std::int64_t>(1, w.total))),
      w.channel, two_digits(w.share),
      w.value > 0.0 ? fmt::format("; {} % of the power of the inputs stays unknown: its "
                                  "response acts as noise, which the intervals include",
                                  two_digits(w.value))
                    : "");
}

std::string spikes_text(const data::ResponseWarning& w) {
  return fmt::format(
      "{}: {} no signal: {}, {:.4g} s from the beginning, by {:.2g} times what the samples beside "
      "it leave open; {} as missing",
      w.channel, w.count == 1 ? "1 sample is" : fmt::format("{} samples are", w.count),
      w.count == 1 ? "it stands out" : "the first stands out", w.value, w.highest,
      w.count == 1 ? "it is taken" : "they are taken");
}

std::string slow_text(const data::ResponseWarning& w) {
  const std::string held = fmt::format(
      "{}: each value stays for {:.4g} samples: the channel was measured up to {:.4g} Hz",
      w.channel, w.value, w.highest);
  if (w.count > 0) return held + ", much less than others; left out";
  if (w.share > 0.0)
    return held + fmt::format(
                      ", and what is above was folded onto what is below, {:.2g} % of it: modes "
                      "cannot be trusted",
                      100.0 * w.share);
  return held + "; what is above is noise there, and the responses are without the hold";
}

std::string two_clocks_text(const data::ResponseWarning& w) {
  return fmt::format(
      "{} and {}{} were recorded by two clocks that differ by {:.3g} millionths: {} {} by {:.3g} "
      "ms in "
      "the end; {} brought to the clock of the inputs; record inputs and outputs by one clock",
      w.other, w.channel, w.count > 1 ? fmt::format(" ({} of {} outputs)", w.count, w.total) : "",
      1e6 * std::abs(w.value), w.count > 1 ? "they are" : "it is",
      w.value > 0.0 ? "later" : "earlier", 1e3 * w.share, w.count > 1 ? "they are" : "it is");
}

std::string short_text(const data::ResponseWarning& w) {
  if (w.total == 0)
    return fmt::format(
        "the excitation is a sweep, which blocks of {:.3g} s would cut into pieces: modes are "
        "estimated from the whole record at once, by a parametric model of its spectra",
        w.share);
  return fmt::format(
      "the record is short: {:.4g} s hold {} of the {} blocks of {:.3g} s that averages need; "
      "modes "
      "are estimated from the whole record at once, by a parametric model of its spectra",
      w.value, w.count, w.total, w.share);
}

std::string hits_text(const data::ResponseWarning& w) {
  std::string text;
  if (w.total <= w.count)
    text = w.count == 1
               ? "the record is a single hit: taken as one block"
               : fmt::format("each of the {} records is a single hit: taken as one block", w.count);
  else
    text = fmt::format(
        "{} {} hits: {}",
        w.count == 1 ? "the record has" : fmt::format("the {} records have", w.count), w.total,
        w.share >= 1.0  ? "each is taken as one block, from just before it to just before the next"
        : w.share > 0.0 ? "some come before the last has rung down; a block is from just before a "
                          "hit to just before the next one at rest"
                        : "the next comes before one has rung down, so each record is taken as one "
                          "block from just before its first hit on");
  text +=
      "; the errors of the responses are not measured, but estimated from their roughness along "
      "the frequency axis";
  if (w.value > 0.0)
    text += fmt::format(
        "; the hits do not agree: {:.0f} % of the power of {} is no response to them that they "
        "have in common, and the result cannot be trusted; were different points hit? identify the "
        "records of each point by themselves",
        100.0 * w.value, w.channel);
  return text;
}

std::string motion_input_text(const data::ResponseWarning& w) {
  const bool several = w.count > 1;
  return fmt::format(
      "the input{} {}{} {}: poles are those with {} held, antiresonances of the free machine, "
      "unless it is shaken at its base",
      several ? "s" : "", w.channel, several ? fmt::format(" and {} more", w.count - 1) : "",
      several ? "are motions" : "is a motion", several ? "these motions" : "this motion");
}

std::string lost_rows_text(const data::ResponseWarning& w) {
  const bool one = w.count == 1;
  return fmt::format(
      "at {}, {} {:.4g} s{}, most outputs do not go on from where they were: rows were lost, or "
      "something struck the machine; {}",
      one ? "a place" : fmt::format("{} places", w.count), one ? "at" : "the first at", w.value,
      w.other.empty() ? "" : " of " + w.other,
      w.total > 0 ? fmt::format("the blocks with {} are left out", one ? "it" : "them")
                  : "too few blocks are without, so damping ratios may be too high");
}

/// Of a sensor or an input.
std::string changed_text(const data::ResponseWarning& w) {
  const bool one_record = w.other.empty(),
             is_input = w.kind == data::ResponseWarning::Kind::input_changed;
  const std::string place =
      one_record ? fmt::format("from {:.4g} s to {:.4g} s", w.lowest, w.highest) : "of " + w.other;
  const std::string others = w.count <= 1 ? ""
                                          : fmt::format(" ({} of {} {} changed{})", w.count,
                                                        w.total, is_input ? "inputs" : "outputs",
                                                        w.count < w.total ? ""
                                                        : is_input        ? ", or outputs"
                                                                          : ", or an input");
  return fmt::format("{} {} is {}{:.2f} times what it is in the {}{}: {}", w.channel, place,
                     w.value < 0.0 ? "−" : "", std::abs(w.value),
                     one_record ? "rest of the record" : "other records", others,
                     is_input ? "the responses to it are wrong, and modes that it excites may be "
                                "missing"
                              : "its part of the shapes is wrong");
}

std::string excited_text(const data::ResponseWarning& w) {
  if (w.estimator == data::Estimator::half_spectra) {
    const bool both = w.lowest > 0.0 && w.highest > 0.0;
    const std::string where = both ? fmt::format("{:.4g} Hz and {:.4g} Hz", w.lowest, w.highest)
                              : w.lowest > 0.0 ? fmt::format("{:.4g} Hz", w.lowest)
                                               : fmt::format("{:.4g} Hz", w.highest);
    return fmt::format(
        "what excites the outputs, or a filter, ends sharply at {}, where their spectra have a "
        "step of {:.0f} "
        "dB: "
        "modes {} cannot be identified",
        where, w.value,
        both             ? "elsewhere"
        : w.lowest > 0.0 ? "below"
                         : "above");
  }
  return fmt::format(
      "the excitation reaches the inputs only from {:.4g} Hz to {:.4g} Hz{}: modes elsewhere "
      "cannot be identified",
      w.lowest, w.highest,
      w.count == 0   ? ""
      : w.count == 1 ? ", with a gap"
                     : fmt::format(", with {} gaps", w.count));
}

}  // namespace

bool have_one_unit(const std::vector<data::Channel>& outputs) {
  return !outputs.empty() && !outputs.front().unit.empty() &&
         std::ranges::all_of(
             outputs, [&](const auto& output) { return output.unit == outputs.front().unit; });
}

std::vector<std::string> motion_words(const identification::Identification& result) {
  const auto& outputs = result.responses.outputs;
  Eigen::VectorXd size = Eigen::VectorXd::Zero(std::ssize(outputs));
  for (const auto& H : result.responses.H) size += H.rowwise().squaredNorm();
  size = size.cwiseSqrt().cwiseMax(1e-300);
  if (have_one_unit(outputs)) size.setOnes();  // the shape itself
  std::vector<std::string> words;
  for (const auto& mode : result.modes) words.push_back(motion_text(mode, size, outputs));
  return words;
}

std::string warning_text(const data::ResponseWarning& w) {
  using Kind = data::ResponseWarning::Kind;
  switch (w.kind) {
    case Kind::dead_output:
      return fmt::format("{}: dead (always {:.4g}); left out", w.channel, w.value);
    case Kind::dead_input:
      return fmt::format("input {}: dead (constant); no responses to it", w.channel);
    case Kind::repeated_input:
      return fmt::format(
          "input {} repeats input {}: left out; the responses to {} are those to both together",
          w.channel, w.other, w.other);
    case Kind::clipped:
      return fmt::format(
          "{}: {} % of the samples, {} % of the power, are cut off at {} or {}: the "
          "channel "
          "looks clipped, and its results are distorted",
          w.channel, two_digits(w.share), two_digits(w.value), limit_text(w.lowest, w),
          limit_text(w.highest, w));
    case Kind::blocks_left_out:
      return fmt::format("{} of {} blocks have missing samples and were left out", w.count,
                         w.total);
    case Kind::correlated_inputs:
      return fmt::format(
          "the inputs are correlated: the condition of their matrix is {:.0f} (median over lines; "
          "1 is best), and the uncertainty of the responses to them is larger by this factor",
          w.value);
    case Kind::biased:
      return fmt::format(
          "{} is biased by the loop: it differs from the instrumental estimate by {} % "
          "(median), outside its 95 % band at {:.0f} % of the lines; take --estimator iv",
          data::estimator_text(w.estimator), two_digits(w.value), 100.0 * w.share);
    case Kind::excited_band:
      return excited_text(w);
    case Kind::interrupted:
      return fmt::format("interrupted: the result uses the first {} samples", w.count);
    case Kind::lines_not_finite:
      return fmt::format(
          "{} of {} frequencies have a value that is no finite number and were left out", w.count,
          w.total);
    case Kind::missing_samples:
      return missing_samples_text(w);
    case Kind::single_block:
      return hits_text(w);
    case Kind::weak_excitation:
      return fmt::format(
          "from {:.4g} Hz to {:.4g} Hz the excitation is too weak beside what else moves the "
          "inputs: its F statistic for them falls to {:.2g}, and {:.2g} is needed; modes there "
          "may be wrong by more than their intervals; excite more, or measure longer",
          w.lowest, w.highest, w.value, w.value / std::max(w.share, 1e-300));
    case Kind::spikes:
      return spikes_text(w);
    case Kind::hits_left_out:
      return fmt::format(
          "{} of {} hits {} left out: what was recorded after {} is too short beside the blocks of "
          "{:.3g} s",
          w.count, w.total, w.count == 1 ? "was" : "were", w.count == 1 ? "it" : "them", w.value);
    case Kind::repeated_output:
      return fmt::format(
          "output {} has the samples of output {}: one of them is not measured, and the shapes "
          "hold "
          "one motion twice",
          w.channel, w.other);
    case Kind::held:
      return fmt::format(
          "{}: {} % of the samples stand still, {} of up to {:.4g} s, while the excitation "
          "goes "
          "on: taken as missing",
          w.channel, two_digits(w.share),
          w.total == 1 ? "in a run" : fmt::format("in {} runs", w.total), w.value);
    case Kind::drop_outs:
      return fmt::format(
          "all channels stand still at once in {} of up to {:.4g} s, {} % of the samples: "
          "taken "
          "as missing",
          w.total == 1 ? "a run" : fmt::format("{} runs", w.total), w.value, two_digits(w.share));
    case Kind::slow_channel:
      return slow_text(w);
    case Kind::clipped_hits:
      return fmt::format("{} of {} hits {} left out: {}{} clipped there", w.count, w.total,
                         w.count == 1 ? "was" : "were", w.channel,
                         w.value > 1.0 ? fmt::format(" and {:.0f} other channel{} are",
                                                     w.value - 1.0, w.value > 2.0 ? "s" : "")
                                       : " is");
    case Kind::delayed:
      return fmt::format("{} is {:.4g} ms later than {}: the responses are without this delay",
                         w.channel, 1e3 * w.value, w.other);
    case Kind::hum:
      return fmt::format(
          "{}: a tone of {:.4g} Hz, {} % of the largest hit, goes on where nothing is hit: "
          "taken out "
          "as hum of the cable",
          w.channel, w.value, two_digits(w.share));
    case Kind::two_clocks:
      return two_clocks_text(w);
    case Kind::exponential_window:
      return fmt::format(
          "{} an exponential window with a time constant of {:.4g} s was applied to the samples: "
          "its "
          "damping, {:.4g} 1/s, is taken out of all modes; if it was not, damping ratios are too "
          "low",
          w.count > 0 ? "the file says that" : "as given,", w.value, 1.0 / w.value);
    case Kind::wandering_tone:
      return fmt::format(
          "at {:.4g} Hz ± {:.2g} % the outputs vibrate with a constant amplitude, as a machine "
          "makes them whose speed varies: this is no mode; the spectra from {:.4g} Hz to {:.4g} Hz "
          "are left out, and modes there cannot be found",
          w.value, 100.0 * w.share, w.lowest, w.highest);
    case Kind::short_record:
      return short_text(w);
    case Kind::feedback:
      return fmt::format(
          "the inputs follow the outputs: what these did before explains {:.0f} % of what the "
          "inputs' own past does not; noise in such a loop biases responses by {}; record the "
          "excitation from outside the loop too, and name it with --instruments",
          100.0 * w.share, data::estimator_text(w.estimator));
    case Kind::motion_input:
      return motion_input_text(w);
    case Kind::sensor_changed:
    case Kind::input_changed:
      return changed_text(w);
    case Kind::lines_zero:
      return fmt::format(
          "at {} of {} frequencies a response is exactly 0, that of {} to {} most often, as "
          "analysers write where they did not measure: these frequencies were left out",
          w.count, w.total, w.channel, w.other);
    case Kind::two_sided:
      return fmt::format(
          "the responses are two-sided: {} of {} frequencies, those above {:.4g} Hz, hold the "
          "conjugates of the others in reverse and were left out",
          w.count, w.total, w.value);
    case Kind::lost_rows:
      return lost_rows_text(w);
    case Kind::rings:
      return fmt::format(
          "the loop rings at {:.4g} Hz for longer than a block lasts: it is nearly unstable; modes "
          "of the machine near this frequency are hidden, and resonances of the loop may look like "
          "modes",
          w.value);
    case Kind::cut_sweep:
      return fmt::format(
          "the excitation is a sweep, and the record has {} block{} of {:.3g} s side by side: they "
          "cut the sweep into pieces, and damping ratios may be wrong by more than their "
          "intervals; {} record {} blocks",
          w.count, w.count == 1 ? "" : "s", w.value,
          w.estimator == data::Estimator::instrumental
              ? "sweep more slowly, and"
              : "identify takes the record itself in one piece, or",
          w.total);
    case Kind::run_up:
      return fmt::format(
          "what excites the outputs passes from {:.3g} Hz to {:.3g} Hz or back, as in a run-up: "
          "half of the power at a frequency comes in {:.2g} % of the record; modes from outputs "
          "alone need noise that goes on all the time, and where a run-up begins and ends looks "
          "like a mode",
          w.lowest, w.highest, 100.0 * w.share);
  }
  return {};
}

}  // namespace hydrapod::report
