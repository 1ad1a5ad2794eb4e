#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/report/measured_results.hpp"
#include "two_digits.hpp"

namespace hydrapod::report {

namespace {

/// Windows that are named after somebody have a capital letter.
std::string window_words(const std::string& name) {
  if (name == "rectangular") return "without a window";
  if (name == "hann") return "with a Hann window";
  if (name == "hamming") return "with a Hamming window";
  if (name == "blackman") return "with a Blackman window";
  if (name == "tukey") return "with a Tukey window";
  if (name == "blackman-harris") return "with a Blackman-Harris window";
  return fmt::format("with a {} window", name);
}

}  // namespace

std::string warning_text(const identification::ModeWarning& w) {
  using Kind = identification::ModeWarning::Kind;
  switch (w.kind) {
    case Kind::no_mode:
      return fmt::format("no mode from {:.4g} Hz to {:.4g} Hz: there is no stable pole", w.from,
                         w.to);
    case Kind::few_samples:
      return fmt::format(
          "the highest mode has {:.1f} samples per period: the modal model does not include "
          "aliasing, and with little noise the intervals are too narrow; use a higher sample "
          "rate{}{}",
          w.value,
          w.to > 0.0 ? fmt::format("; it may be the image of a mode at {:.4g} Hz where no "
                                   "anti-alias filter was used",
                                   w.to)
                     : "",
          w.count > 0 ? fmt::format("; {} of {} modes {} above {:.4g} Hz, where anti-alias filters "
                                    "begin to cut: without such a filter {} may be what is folded",
                                    w.count, w.total, w.count == 1 ? "is" : "are", w.from,
                                    w.count == 1 ? "it" : "they")
                      : "");
    case Kind::misfit:
      return fmt::format(
          "the modal model misses the responses by {:.1f} times their noise (mean square): a mode "
          "may be missing, the machine may not be linear, or the inputs may follow the outputs in "
          "a loop; the intervals are widened accordingly",
          w.value);
    case Kind::unexplained:
      return fmt::format(
          "the modal model does not explain {} of {} responses; the worst is {}{} from {:.4g} "
          "Hz to {:.4g} Hz: the residual is {:.2g} times its noise (mean square), {:.0f} % of it "
          "goes on from line to line, and it is {} % of the response; a mode may be missing "
          "there, and the intervals of modes there cannot be trusted",
          w.count, w.total, w.output, w.input.empty() ? "" : " to " + w.input, w.from, w.to,
          w.value, 100.0 * std::clamp(w.smooth, 0.0, 1.0), two_digits(std::sqrt(w.share)));
    case Kind::wanders:
      return fmt::format(
          "the mode at {:.4g} Hz wanders: it is from {:.4g} Hz to {:.4g} Hz in the {} parts of the "
          "record; {}its damping ratio is {:.0f} % {} than the mean "
          "of the parts, and its intervals cannot be trusted",
          w.value, w.from, w.to, w.count, w.share < 0.0 ? "" : "that widens its resonance, ",
          100.0 * std::abs(w.share), w.share < 0.0 ? "lower" : "higher");
    case Kind::short_blocks:
      return fmt::format(
          "{} of {} modes {} narrower than two lines of blocks of {:.3g} s, most of all that at "
          "{:.4g} Hz, which is {:.2g} Hz wide: modes that are nearer to each other come out as one "
          "with a damping ratio that is too high; take longer blocks",
          w.count, w.total, w.count == 1 ? "is" : "are", w.value, w.from, w.to);
    case Kind::peaks_above:
      return fmt::format(
          "modes were looked for from {:.4g} Hz to {:.4g} Hz, and the responses have {} above, the "
          "largest at {:.4g} Hz: modes there may be missing; --to sets the band",
          w.from, w.to, w.count == 1 ? "a peak" : fmt::format("{} peaks", w.count), w.value);
    case Kind::twins:
      return fmt::format(
          "{} of {} modes stand beside another one with the same shape and participation, as at "
          "{:.5g} Hz and {:.5g} Hz, {:.2g} half widths apart: one resonance may have become both, "
          "by a window of the analyser that was not told, or because it moved during the "
          "measurement, and damping ratios of all modes may be too high; a tuned absorber makes "
          "such pairs too",
          w.count, w.total, w.from, w.to, w.value);
    case Kind::moved:
      return fmt::format(
          "{} of {} modes stand beside another one with the same shape and participation, as at "
          "{:.5g} Hz and {:.5g} Hz, and the inputs do not explain {:.2g} % of the outputs' power "
          "there: one resonance that moved during the measurement may have become both",
          w.count, w.total, w.from, w.to, 100.0 * w.share);
    case Kind::common_poles:
      return fmt::format(
          "{} of {} modes, from {:.4g} Hz to {:.4g} Hz, {} that all responses have in common: "
          "those of a filter that all sensors pass and the inputs do not, and no modes",
          w.count, w.total, w.from, w.to, w.count == 1 ? "is a pole" : "are poles");
    case Kind::set_ups:
      return fmt::format(
          "{} of {} modes stand in pairs, as at {:.5g} Hz and {:.5g} Hz: the lower one of each "
          "pair "
          "moves {} and the higher one the rest: these outputs were measured while the machine had "
          "other frequencies, and each pair is one mode",
          w.count, w.total, w.from, w.to,
          w.value > 1.0 ? fmt::format("{} and {:.0f} other output{}", w.output, w.value - 1.0,
                                      w.value > 2.0 ? "s" : "")
                        : w.output + " alone");
    case Kind::combination_tones:
      return fmt::format(
          "{} of {} modes stand at sums or differences of the frequencies of two others, and decay "
          "as fast as both together, as that at {:.4g} Hz (of {:.4g} Hz and {:.4g} Hz): a machine "
          "that is not linear vibrates there too, and these may be no modes",
          w.count, w.total, w.value, w.from, w.to);
    case Kind::conjugated:
      return fmt::format(
          "the phases rise through the resonances: from {:.4g} Hz to {:.4g} Hz modes leave {} % "
          "of the responses unexplained, and {} % of the conjugated ones; the file follows the "
          "convention e^(−iωt), or its cross spectra are formed the other way round: change the "
          "sign of all imaginary parts, or of all phases",
          w.from, w.to, two_digits(w.share), two_digits(w.value));
    case Kind::window:
      return fmt::format(
          "the responses are averages of blocks of {:.3g} s {}, which widens their "
          "resonances: with this effect modes explain them far better from {:.4g} Hz to {:.4g} Hz; "
          "the frequencies and damping ratios are those without it",
          w.value, window_words(w.window), w.from, w.to);
  }
  return {};
}

}  // namespace hydrapod::report
