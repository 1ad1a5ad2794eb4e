#include "usable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "names.hpp"
#include "search.hpp"

namespace hydrapod::identification {

namespace {

using Kind = data::ResponseWarning::Kind;

constexpr double smallest_size = 1e-50, largest_size = 1e50;  // fourth powers are numbers

/// Elements of a vector or of values per line; adjacent ones of these are shared.
template <class List>
List picked(const List& all, const std::vector<std::size_t>& places) {
  List some;
  if (all.empty() || places.empty()) return some;
  if constexpr (requires { all.part(0, 0); })
    if (places.back() - places.front() + 1 == places.size())
      return all.part(places.front(), places.size());
  some.reserve(places.size());
  for (const std::size_t k : places) some.push_back(all[k]);
  return some;
}

bool is_finite_at(const FrequencyResponses& r, std::size_t k) {
  return r.H[k].allFinite() && (r.noise.empty() || r.noise[k].allFinite()) &&
         (r.input_factor.empty() || r.input_factor[k].allFinite());
}

/// Residual terms s⁻² of a modal model have a value.
bool is_above_zero(const FrequencyResponses& r, std::size_t k) {
  constexpr double lowest = 1e-6;  // of the highest frequency
  return r.frequency[k] > lowest * r.frequency.back();
}

/// Where an analyser has not measured: responses that are exactly 0 at some lines, not at all.
/// Those that are calculated from records are not 0 so. What was rounded to 0 is a measurement:
/// beside it are but a few of the steps that a table of so many digits has, or the response has no
/// more.
class ZeroLines {
 public:
  explicit ZeroLines(const FrequencyResponses& r)
      : counts_(Eigen::MatrixXi::Zero(std::ssize(r.outputs), std::ssize(r.inputs))),
        are_zero_(r.lines(), false) {
    if (r.whole != nullptr || !r.excitation.empty()) return;
    while (first_ < r.lines() && !is_above_zero(r, first_)) ++first_;
    for (Index o = 0; o < counts_.rows(); ++o)
      for (Index i = 0; i < counts_.cols(); ++i) look_at(r, o, i);
  }

  [[nodiscard]] bool are_there() const { return (counts_.array() > 0).any(); }
  [[nodiscard]] bool at(std::size_t line) const { return are_zero_[line]; }
  struct Entry {
    Index output{}, input{};
    int lines{};
  };
  /// The response that is 0 most often.
  [[nodiscard]] Entry worst() const {
    Entry entry;
    entry.lines = counts_.maxCoeff(&entry.output, &entry.input);
    return entry;
  }

 private:
  /// The larger one of real and imaginary part.
  static double size_of(const Complex& h) {
    return std::max(std::abs(h.real()), std::abs(h.imag()));
  }

  void look_at(const FrequencyResponses& r, Index o, Index i) {
    constexpr double few_steps = 4.0, coarse = 50.0;
    double step = std::numeric_limits<double>::infinity(), largest = 0.0;
    bool has_zero = false;
    for (std::size_t k = first_; k < r.lines(); ++k) {
      const Complex h = r.H[k](o, i);
      has_zero = has_zero || h == 0.0;
      for (const double part : {std::abs(h.real()), std::abs(h.imag())})
        if (part > 0.0) step = std::min(step, part);
      if (size_of(h) > largest) largest = size_of(h);
    }
    if (!has_zero || !(largest > coarse * step)) return;
    const auto is_zero = [&](std::size_t k) { return r.H[k](o, i) == 0.0; };
    for (std::size_t k = first_, end = k; k < r.lines(); k = end + 1) {
      end = k;
      while (end < r.lines() && is_zero(end)) ++end;  // k … end − 1 are 0
      const bool large_before = k > first_ && !(size_of(r.H[k - 1](o, i)) <= few_steps * step),
                 large_behind = end < r.lines() && !(size_of(r.H[end](o, i)) <= few_steps * step);
      if (end == k || !(large_before || large_behind)) continue;
      counts_(o, i) += static_cast<int>(end - k);
      std::fill(are_zero_.begin() + static_cast<std::ptrdiff_t>(k),
                are_zero_.begin() + static_cast<std::ptrdiff_t>(end), true);
    }
  }

  Eigen::MatrixXi counts_;  ///< lines per response
  std::vector<bool> are_zero_;
  std::size_t first_{};
};

/// What stays must suffice.
void require_lines_that_are_not_zero(const FrequencyResponses& r, const ZeroLines& zero,
                                     std::size_t kept) {
  if (!zero.are_there() || kept >= fewest_lines) return;
  const auto worst = zero.worst();
  throw base::ComputationError(fmt::format(
      "responses are exactly 0, which is no measurement, at all but {} of {} frequencies (that of "
      "{} to {} at {}); at least {} are needed: leave the channel out with --outputs, or export "
      "all frequencies",
      kept, r.lines(), r.outputs[static_cast<std::size_t>(worst.output)].name,
      r.inputs[static_cast<std::size_t>(worst.input)].name, worst.lines, fewest_lines));
}

void leave_out_lines(const ZeroLines& zero, FrequencyResponses& r) {
  std::vector<std::size_t> kept;
  std::int64_t broken = 0, empty = 0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    if (!is_above_zero(r, k)) continue;
    if (!is_finite_at(r, k))
      ++broken;
    else if (zero.at(k))
      ++empty;
    else
      kept.push_back(k);
  }
  const auto total = static_cast<std::int64_t>(r.lines());
  if (broken > 0)
    r.warnings.push_back({.kind = Kind::lines_not_finite, .count = broken, .total = total});
  require_lines_that_are_not_zero(r, zero, kept.size());
  if (empty > 0) {
    const auto worst = zero.worst();
    r.warnings.push_back({.kind = Kind::lines_zero,
                          .channel = r.outputs[static_cast<std::size_t>(worst.output)].name,
                          .other = r.inputs[static_cast<std::size_t>(worst.input)].name,
                          .count = empty,
                          .total = total});
  }
  if (kept.size() != r.lines()) r = lines_of(r, kept);
}

/// Behind half the sample rate a file with all lines of a transform has the conjugates of the lines
/// before, in reverse: H(f_s − f) = H(f)*. [Hz] of that half; none: there are none. `from`: the
/// line that the last one is the image of.
std::optional<double> half_of_images(const FrequencyResponses& r, std::size_t from) {
  constexpr double same = 1e-4;  // as few digits as a table may have
  if (r.lines() < from + fewest_lines) return {};
  const double rate = r.frequency[from] + r.frequency.back();
  bool is_complex = false;
  for (std::size_t k = from, image = r.lines() - 1; k < image; ++k, --image) {
    const MatrixXcd &H = r.H[k], &other = r.H[image];
    if (std::abs(r.frequency[k] + r.frequency[image] - rate) > same * rate ||
        !((H - other.conjugate()).norm() <= same * H.norm()))
      return {};
    is_complex = is_complex || !H.imag().isZero(0.0);
  }
  return is_complex ? std::optional(0.5 * rate) : std::nullopt;
}

std::optional<double> half_of_images(const FrequencyResponses& r) {
  if (r.whole != nullptr || r.shift != 0.0) return {};
  const auto half = half_of_images(r, 0);
  return half ? half : half_of_images(r, 1);  // from 0 Hz on, up to the sample rate or not
}

void leave_out_images(double half, FrequencyResponses& r) {
  constexpr double same = 1.0 + 1e-6;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < r.lines() && r.frequency[k] <= half * same; ++k) kept.push_back(k);
  r.warnings.push_back({.kind = Kind::two_sided,
                        .value = half,
                        .count = static_cast<std::int64_t>(r.lines() - kept.size()),
                        .total = static_cast<std::int64_t>(r.lines())});
  r = lines_of(r, kept);
}

/// Numbers of the rows of which one is not 0 at some line; of columns where `columns`.
std::vector<std::size_t> living(const FrequencyResponses& r, bool columns) {
  const auto size = static_cast<Index>(columns ? r.inputs.size() : r.outputs.size());
  std::vector<std::size_t> alive;
  for (Index i = 0; i < size; ++i)
    if (std::ranges::any_of(r.H, [&](const MatrixXcd& H) {
          return columns ? !H.col(i).isZero(0.0) : !H.row(i).isZero(0.0);
        }))
      alive.push_back(static_cast<std::size_t>(i));
  return alive;
}

void warn_of_dead(const std::vector<data::Channel>& channels, const std::vector<std::size_t>& alive,
                  Kind kind, std::vector<data::ResponseWarning>& warnings) {
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (std::ranges::find(alive, c) == alive.end())
      warnings.push_back({.kind = kind, .channel = channels[c].name});
}

/// These outputs and inputs.
void pick_channels(const std::vector<std::size_t>& outputs, const std::vector<std::size_t>& inputs,
                   FrequencyResponses& r) {
  const std::vector<Index> rows(outputs.begin(), outputs.end()),
      columns(inputs.begin(), inputs.end());
  r.outputs = picked(r.outputs, outputs);
  r.inputs = picked(r.inputs, inputs);
  for (auto& H : r.H) H = H(rows, columns).eval();
  for (auto& H : r.on_axis) H = H(rows, columns).eval();
  for (auto& V : r.noise) V = V(rows, rows).eval();
  for (auto& Q : r.input_factor) Q = Q(columns, columns).eval();
  for (auto& c : r.coherence) c = c(rows, columns).eval();
  for (auto& c : r.multiple_coherence) c = c(rows).eval();
  for (auto& S : r.input_density) S = S(columns).eval();
}

void leave_out_dead_channels(FrequencyResponses& r) {
  const auto outputs = living(r, false), inputs = living(r, true);
  if (outputs.size() == r.outputs.size() && inputs.size() == r.inputs.size()) return;
  warn_of_dead(r.outputs, outputs, Kind::dead_output, r.warnings);
  warn_of_dead(r.inputs, inputs, Kind::dead_input, r.warnings);
  pick_channels(outputs, inputs, r);
}

void require_size(const FrequencyResponses& r) {
  if (r.outputs.empty() || r.inputs.empty())
    throw base::ComputationError("the responses are 0 at all frequencies");
  double largest = 0.0;
  for (const auto& H : r.H) largest = std::max(largest, H.cwiseAbs().maxCoeff());
  if (r.lines() > 0 && !(largest > smallest_size && largest < largest_size))
    throw base::ComputationError(fmt::format(
        "the largest response is {:.3g}: between {:g} and {:g} is expected; check the units",
        largest, smallest_size, largest_size));
}

}  // namespace

FrequencyResponses lines_of(const FrequencyResponses& r, const std::vector<std::size_t>& lines) {
  FrequencyResponses some = r;
  some.frequency = picked(r.frequency, lines);
  some.H = picked(r.H, lines);
  some.on_axis = picked(r.on_axis, lines);
  some.noise = picked(r.noise, lines);
  some.input_factor = picked(r.input_factor, lines);
  some.excitation = picked(r.excitation, lines);
  some.coherence = picked(r.coherence, lines);
  some.multiple_coherence = picked(r.multiple_coherence, lines);
  some.condition = picked(r.condition, lines);
  some.input_density = picked(r.input_density, lines);
  return some;
}

FrequencyResponses usable_responses(const FrequencyResponses& responses) {
  return UsableResponses(responses).get();
}

UsableResponses::UsableResponses(const FrequencyResponses& all) : given_(all) {
  if (const auto half = half_of_images(all)) {
    changed_ = all;
    leave_out_images(*half, *changed_);
  }
  const auto& r = get();
  const ZeroLines zero(r);
  const bool lines_hold = !zero.are_there() && [&] {
    for (std::size_t k = 0; k < r.lines(); ++k)
      if (!is_above_zero(r, k) || !is_finite_at(r, k)) return false;
    return true;
  }();
  // outputs that half spectra refer to are alive
  const bool all_alive = r.whole != nullptr || (living(r, false).size() == r.outputs.size() &&
                                                living(r, true).size() == r.inputs.size());
  if (!lines_hold || !all_alive) {
    if (!changed_) changed_ = all;
    if (!lines_hold) leave_out_lines(zero, *changed_);
    if (all.whole == nullptr) leave_out_dead_channels(*changed_);
  }
  require_size(get());
}

}  // namespace hydrapod::identification
