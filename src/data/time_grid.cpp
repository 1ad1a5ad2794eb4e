#include "time_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "formats.hpp"

namespace hydrapod::data {

namespace {

constexpr std::size_t looked_at = 1000;  ///< times, for a first step

/// What a pass over the times finds of their differences.
struct TimeSteps {
  std::int64_t rows{}, regular{};  ///< steps that are no gap
  double first{}, sum{}, squares{};
  double best_step{};  ///< from the first time to the one that tells it best
  double unsure{};     ///< the share by which rounding may have changed it

  [[nodiscard]] double mean() const { return sum / static_cast<double>(regular); }
};

/// How times stand to a grid.
struct TimeFit {
  std::int64_t rows{};
  double first{}, last{};
  std::int64_t gaps{}, missing{};  ///< and points of the grid that are missing in them
  unsigned gap_line{}, last_line{};
  double gap_time{};   ///< behind the first gap
  double deviation{};  ///< largest |t − grid| [s]
  bool even{true};
  bool too_long{};  ///< and not followed to the end
};

[[noreturn]] void fail_backwards(double before, double time, unsigned line, const Notes& notes) {
  notes.fail(fmt::format("the time goes back from {} s to {} s; expected are rising times. Several "
                         "records in one file are to be split into files",
                         before, time),
             line);
}

/// The mean of the steps that are no gap.
double typical_step(const std::vector<double>& times, double gap, double resolution) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  const double mean = (times.back() - times.front()) / static_cast<double>(steps.size());
  const double limit = gap * (*middle > 0.0 ? *middle : mean) + resolution;
  double sum = 0.0, count = 0.0;
  for (const double step : steps)
    if (step <= limit) {
      sum += step;
      ++count;
    }
  return sum > 0.0 ? sum / count : mean;
}

class GridSearch {
 public:
  GridSearch(const TimeSource& times, const std::optional<StatedRate>& stated, Notes& notes,
             const TimeGridOptions& options)
      : times_(times), stated_(stated), notes_(&notes), options_(options) {}

  TimeGrid found() {
    take_first_times();
    if (first_.size() < 2 || !(first_.back() > first_.front())) return standing();
    for (const bool exact : {true, false}) {
      const TimeSteps steps = counted(exact);
      if (!(steps.mean() > 0.0) || !std::isfinite(1.0 / steps.mean())) continue;
      const TimeGrid grid = grid_of(steps, exact);
      const TimeFit fit = compared(grid, steps.unsure);
      if (exact && (fit.too_long || !fit.even || !are_few(fit))) continue;
      return settled(grid, fit, steps);
    }
    fail_standing();
  }

 private:
  [[noreturn]] void fail_standing() const {
    notes_->fail(
        "the sample rate cannot be determined from the column of times: it needs at least two "
        "times, rising; give the rate in Hz with --rate");
  }

  /// Times that do not rise: what is stated holds.
  TimeGrid standing() const {
    if (!stated_) fail_standing();
    if (first_.size() > 1)
      notes_->add(fmt::format("the times do not rise; {} holds for all rows", stated_->where));
    return {.rate = stated_->rate,
            .start = first_.empty() ? 0.0 : first_.front(),
            .complete = true,
            .gap = std::numeric_limits<double>::infinity()};
  }

  void take_first_times() {
    times_.each([&](double time, unsigned line) {
      if (first_.size() >= looked_at || std::isnan(time)) return;
      if (!first_.empty() && time < first_.back())
        fail_backwards(first_.back(), time, line, *notes_);
      first_.push_back(time);
    });
  }

  [[nodiscard]] double resolution(double time, bool exact) const {
    return exact ? 0.0 : times_.resolution(time);
  }

  /// Steps that are no gap; the step becomes better on the way.
  TimeSteps counted(bool exact) const {
    TimeSteps steps;
    double step = typical_step(first_, options_.gap, resolution(first_.back(), exact));
    double before = 0.0;
    std::int64_t apart = 0;  // rows since the last time that is there
    bool begun = false, gap = false;
    steps.unsure = std::numeric_limits<double>::infinity();
    times_.each([&](double time, unsigned line) {
      ++steps.rows;
      ++apart;
      if (std::isnan(time)) return;
      if (!begun) steps.first = time;
      const double rows = static_cast<double>(apart), passed = time - before;
      if (begun && passed < 0.0) fail_backwards(before, time, line, *notes_);
      if (begun && passed <= rows * options_.gap * step + resolution(time, exact)) {
        steps.sum += passed;
        steps.regular += apart;
        steps.squares += std::pow(passed - rows * step, 2);
        constexpr std::int64_t enough = 100;
        if (steps.regular >= enough) step = steps.mean();
        const double q = resolution(steps.first, exact) + resolution(time, exact);
        const double unsure = 0.5 * q / (time - steps.first);
        if (!gap && time > steps.first && unsure <= steps.unsure) {
          steps.unsure = unsure;
          steps.best_step = (time - steps.first) / static_cast<double>(steps.regular);
        }
      } else {
        gap = gap || begun;
      }
      begun = true;
      before = time;
      apart = 0;
    });
    return steps;
  }

  [[nodiscard]] TimeGrid grid_of(const TimeSteps& steps, bool exact) const {
    constexpr double near = 1e-5;  // times of few digits mean a whole number
    const double step = exact || !(steps.best_step > 0.0) ? steps.mean() : steps.best_step;
    TimeGrid grid{.rate = rounded_rate(1.0 / step, near), .start = steps.first};
    grid.gap = options_.gap / grid.rate;
    if (!exact) grid.resolution = times_.resolution;
    return grid;
  }

  [[nodiscard]] bool are_few(const TimeFit& fit) const {
    return static_cast<double>(fit.gaps) <= options_.most_gaps * static_cast<double>(fit.rows);
  }

  /// `unsure` is that of the grid's step.
  TimeFit compared(const TimeGrid& grid, double unsure) const {
    const auto rounding = [&](double time) {
      if (!grid.resolution) return 0.0;
      return 0.5001 * (grid.resolution(time) + grid.resolution(grid.start)) +
             unsure * (time - grid.start);
    };
    TimeFit fit;
    std::int64_t point = -1;
    times_.each([&](double time, unsigned line) {
      if (fit.too_long) return;
      ++fit.rows;
      if (std::isnan(time)) {
        if (point >= 0) ++point;
        return;
      }
      const std::int64_t now = point < 0 ? 0 : grid.point_of(time, fit.last, point);
      if (point < 0) fit.first = time;
      if (point >= 0 && now > point + 1) {
        if (fit.gaps++ == 0) {
          fit.gap_line = line;
          fit.gap_time = time;
        }
        fit.missing += now - point - 1;
      }
      const double off = std::abs(time - (grid.start + static_cast<double>(now) / grid.rate));
      fit.deviation = std::max(fit.deviation, off);
      fit.even = fit.even && off <= options_.even / grid.rate + rounding(time);
      fit.last = time;
      fit.last_line = line;
      point = now;
      fit.too_long = is_too_long(static_cast<double>(point), fit);
    });
    return fit;
  }

  [[nodiscard]] bool is_too_long(double points, const TimeFit& fit) const {
    constexpr double always = 1000.0;
    return points > always + options_.most_missing * static_cast<double>(fit.rows);
  }

  [[noreturn]] void fail_too_long(const TimeGrid& grid, const TimeFit& fit) const {
    notes_->fail(
        fmt::format("up to the time {} s, {:.6g} Hz make {:.6g} samples, and {} are there: "
                    "several records in one file are to be split into files",
                    fit.last, grid.rate, (fit.last - fit.first) * grid.rate, fit.rows),
        fit.last_line);
  }

  TimeGrid settled(TimeGrid grid, TimeFit fit, const TimeSteps& steps) {
    if (fit.too_long) fail_too_long(grid, fit);
    if (!fit.even && stated_ && agrees(grid.rate, options_.agreement)) {
      TimeGrid other = grid;  // perhaps the times are even at the rate that is stated
      other.rate = stated_->rate;
      if (const TimeFit again = compared(other, steps.unsure); again.even) {
        grid = other;
        fit = again;
      }
    }
    if (!fit.even) return resampled(grid, fit, steps);
    require_sure(grid,
                 grid.resolution ? steps.unsure : 2.0 * fit.deviation / (fit.last - fit.first));
    if (stated_) grid.rate = stated_->rate;
    grid.complete = fit.gaps == 0;
    if (fit.gaps > 0)
      notes_->add(
          fmt::format("the times have {} gap{}, the first before {:.9g} s: {} sample{} at "
                      "{:.9g} Hz {} missing",
                      fit.gaps, fit.gaps == 1 ? "" : "s", fit.gap_time, fit.missing,
                      fit.missing == 1 ? "" : "s", grid.rate, fit.missing == 1 ? "is" : "are"),
          fit.gap_line);
    return grid;
  }

  [[nodiscard]] bool agrees(double rate, double tolerance) const {
    return std::abs(rate - stated_->rate) <= tolerance * stated_->rate;
  }

  /// `unsure`: the share by which the rate may be another one.
  void require_sure(const TimeGrid& grid, double unsure) const {
    if (stated_ && !agrees(grid.rate, options_.agreement + unsure))
      notes_->fail(
          fmt::format("the times make a sample rate of {:.9g} Hz, but {} says {:.9g} Hz; "
                      "leave it out, or resample the record (`record resample`)",
                      grid.rate, stated_->where, stated_->rate));
    const bool whole = grid.rate == std::round(grid.rate);
    if (!stated_ && !whole && unsure > options_.rate_uncertainty)
      notes_->fail(
          fmt::format("the times are too coarse for a sample rate: {:.6g} Hz within {:.2g} "
                      "%; give the rate in Hz with --rate",
                      grid.rate, 100.0 * unsure));
  }

  TimeGrid resampled(TimeGrid grid, const TimeFit& fit, const TimeSteps& steps) {
    const double own = grid.rate;
    const double scatter = std::sqrt(steps.squares / static_cast<double>(steps.regular)) * own;
    if (scatter > options_.jitter && !stated_)
      notes_->fail(
          fmt::format("the times are not evenly spaced: their differences scatter by {:.0f} "
                      "% of {:.6g} s; to have the samples interpolated at even times, give "
                      "a sample rate in Hz with --rate",
                      100.0 * scatter, 1.0 / own));
    if (stated_) grid.rate = stated_->rate;
    if (is_too_long((fit.last - fit.first) * grid.rate, fit)) fail_too_long(grid, fit);
    grid.interpolated = true;
    grid.gap = options_.interpolated_gap / std::min(own, grid.rate);
    constexpr double sound = 0.2;  // of the rate
    notes_->add(
        fmt::format("the times are off an even grid by up to {:.2g} s (their differences "
                    "scatter by {:.2g} %): the samples are interpolated at {:.9g} Hz, which "
                    "is sound up to about {:.3g} Hz",
                    fit.deviation, 100.0 * scatter, grid.rate, sound * std::min(own, grid.rate)));
    return grid;
  }

  const TimeSource& times_;
  const std::optional<StatedRate>& stated_;
  Notes* notes_;
  TimeGridOptions options_;
  std::vector<double> first_{};  ///< times, a thousand at most
};

constexpr double missing_value = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::int64_t TimeGrid::point_of(double time, double time_before, std::int64_t before) const {
  if (time - time_before <= gap + (resolution ? resolution(time) : 0.0)) return before + 1;
  constexpr double most = 9e15;
  const double point = std::min(most, std::round((time - start) * rate));
  return std::max(before + 1, static_cast<std::int64_t>(std::max(0.0, point)));
}

TimeGrid find_time_grid(const TimeSource& times, const std::optional<StatedRate>& stated,
                        Notes& notes, const TimeGridOptions& options) {
  return GridSearch(times, stated, notes, options).found();
}

bool GridRows::next(const Fetch& fetch, Eigen::Ref<Eigen::RowVectorXd> out) {
  return grid_.interpolated ? next_between(fetch, out) : next_even(fetch, out);
}

void GridRows::rewind() { *this = GridRows(grid_, columns_); }

/// One more sample at the end of rows_.
bool GridRows::take(const Fetch& fetch) {
  Row row{.values = Eigen::RowVectorXd(columns_)};
  while (!ended_) {
    if (!fetch(row.time, row.values)) {
      ended_ = true;
      break;
    }
    const bool timed = !std::isnan(row.time);
    if (grid_.interpolated) {
      if (!timed || (last_point_ >= 0 && row.time <= last_time_)) continue;  // not to be placed
      row.point = last_point_ + 1;
    } else {
      row.point =
          timed && timed_ ? grid_.point_of(row.time, last_time_, last_point_) : last_point_ + 1;
    }
    if (timed) last_time_ = row.time;
    timed_ = timed_ || timed;
    last_point_ = row.point;
    rows_.push_back(row);
    return true;
  }
  return false;
}

bool GridRows::next_even(const Fetch& fetch, Eigen::Ref<Eigen::RowVectorXd> out) {
  if (rows_.empty() && !take(fetch)) return false;
  if (at_++ < rows_.front().point) {
    out.setConstant(missing_value);
    return true;
  }
  out = rows_.front().values;
  rows_.pop_front();
  return true;
}

bool GridRows::next_between(const Fetch& fetch, Eigen::Ref<Eigen::RowVectorXd> out) {
  const double time = grid_.start + static_cast<double>(at_) / grid_.rate;
  // rows_[right − 1] ≤ time ≤ rows_[right], and one more on both sides where there is one
  while (rows_.size() < 4 && take(fetch)) continue;
  while (rows_.size() > 3 && rows_[2].time <= time) {
    rows_.pop_front();
    take(fetch);
  }
  if (rows_.size() < 2) return false;
  std::size_t right = 1;
  while (right + 1 < rows_.size() && rows_[right].time < time) ++right;
  constexpr double slack = 1e-9;
  if (time > rows_[right].time + slack / grid_.rate) return false;
  ++at_;
  interpolate(right, time, out);
  return true;
}

/// Cubic through four neighbours (Lagrange); over gaps nothing, beside gaps and ends a line.
void GridRows::interpolate(std::size_t right, double time,
                           Eigen::Ref<Eigen::RowVectorXd> out) const {
  const Row &a = rows_[right - 1], &b = rows_[right];
  if (b.time - a.time > grid_.gap) {
    out.setConstant(missing_value);
    return;
  }
  const double share = (time - a.time) / (b.time - a.time);
  out = (1.0 - share) * a.values + share * b.values;
  if (right < 2 || right + 1 >= rows_.size()) return;
  const std::array<const Row*, 4> knots{&rows_[right - 2], &a, &b, &rows_[right + 1]};
  if (a.time - knots[0]->time > grid_.gap || knots[3]->time - b.time > grid_.gap) return;
  Eigen::RowVectorXd cubic = Eigen::RowVectorXd::Zero(columns_);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < knots.size(); ++j)
      if (j != i) weight *= (time - knots[j]->time) / (knots[i]->time - knots[j]->time);
    cubic += weight * knots[i]->values;
  }
  for (Eigen::Index c = 0; c < columns_; ++c)
    if (!std::isnan(cubic[c])) out[c] = cubic[c];
}

EvenSamples on_time_grid(const Eigen::Ref<const Samples>& samples, std::span<const double> times,
                         const std::optional<StatedRate>& stated, Notes& notes) {
  BinaryTimes binary;
  const TimeSource source{[&](const TimeSource::Use& use) {
                            for (const double time : times) {
                              binary.take(time);
                              use(std::isfinite(time) ? time : missing_value, 0);
                            }
                          },
                          [&](double time) { return binary.resolution(time); }};
  const TimeGrid grid = find_time_grid(source, stated, notes);
  EvenSamples even{.rate = grid.rate, .start = grid.start};
  if (grid.complete) {
    even.samples = samples;
    return even;
  }
  GridRows rows(grid, samples.cols());
  Eigen::Index at = 0, count = 0;
  const GridRows::Fetch fetch = [&](double& time, Eigen::RowVectorXd& row) {
    if (at == samples.rows()) return false;
    time = times[static_cast<std::size_t>(at)];
    if (!std::isfinite(time)) time = missing_value;
    row = samples.row(at++);
    return true;
  };
  Eigen::RowVectorXd row(samples.cols());
  for (; rows.next(fetch, row); ++count) {
    if (count == even.samples.rows())
      even.samples.conservativeResize(std::max<Eigen::Index>(2 * count, samples.rows()),
                                      samples.cols());
    even.samples.row(count) = row;
  }
  even.samples.conservativeResize(count, samples.cols());
  return even;
}

void note_assumed_unit(std::string_view assumed, double rate, std::uint64_t samples,
                       std::string_view remedy, Notes& notes) {
  constexpr double slow = 2.0, slow_for_many = 20.0;  // [Hz]
  constexpr std::uint64_t many = 1000;
  if (rate < (samples < many ? slow : slow_for_many))
    notes.add(fmt::format("{}, which makes {:.4g} Hz; {}", assumed, rate, remedy));
}

}  // namespace hydrapod::data
