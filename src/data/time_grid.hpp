#pragma once
/// The grid of even times on which the samples of a file stand, found from the times that stand
/// beside them, and the samples put on it: gaps become missing samples, times that scatter are
/// interpolated between.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "hydrapod/data/record.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// h is the step of the grid, q the resolution with which a time is written.
struct TimeGridOptions {
  /// Times are even where |t − grid| ≤ even·h, and what rounding adds, for all: nobody samples
  /// better than a tenth of a step by a clock that is read beside the samples.
  double even{0.1};
  /// A difference above gap·h + q is a gap: half a step more than one step.
  double gap{1.5};
  /// Times scatter, and samples are resampled without being asked, where the differences have an
  /// RMS deviation from h of at most jitter·h. Beyond that cubic interpolation errs by more than a
  /// tenth at a fifth of the rate.
  double jitter{0.3};
  /// Nothing is interpolated over more than interpolated_gap·h.
  double interpolated_gap{3.0};
  /// 2·max|t − grid| ≤ rate_uncertainty·(length), and (q + q)/2 ≤ rate_uncertainty·(distance) for
  /// some pair of times; else the rate is not known well enough: a tenth of what an interval of a
  /// frequency usually is.
  double rate_uncertainty{1e-4};
  /// A rate from elsewhere agrees where it differs by at most this share (and the uncertainty).
  double agreement{1e-3};
  /// Points of the grid ≤ most_missing·(samples that are there): beyond, a file holds several
  /// records.
  double most_missing{20.0};
  /// Times are first taken for exact, q = 0. They are where they are even then and at most
  /// most_gaps·(samples) gaps are between them: rounded times of a rate that does not suit their
  /// resolution look like exact ones with a gap every few samples.
  double most_gaps{0.1};
};

/// The times of a file, as often as they are wanted.
struct TimeSource {
  /// Tells every time [s], NaN where it is missing, and its line in the file (0: none).
  using Use = std::function<void(double time, unsigned line)>;
  std::function<void(const Use&)> each{};
  /// q of a time; asked after all times were told once.
  std::function<double(double time)> resolution{};
};

/// Times as numbers in binary: those of single precision have seven digits.
class BinaryTimes {
 public:
  void take(double time) {
    single_ =
        single_ && (std::isnan(time) || static_cast<double>(static_cast<float>(time)) == time);
  }
  /// Of those that were taken.
  [[nodiscard]] double resolution(double time) const {
    constexpr double digits = 1.2e-7;
    return single_ ? digits * std::abs(time) : 0.0;
  }

 private:
  bool single_{true};
};

/// A rate that is stated elsewhere.
struct StatedRate {
  double rate{};        ///< [Hz]
  std::string where{};  ///< "--rate 100"
};

struct TimeGrid {
  double rate{};   ///< [Hz]
  double start{};  ///< [s]
  bool interpolated{};
  bool complete{};  ///< every sample stands on the point after the one before
  double gap{};     ///< [s] a difference between neighbours that is longer by q is a gap
  std::function<double(double)> resolution{};  ///< q of a time; none: 0

  /// The point of the grid on which the sample at `time` stands: the next one after `before`,
  /// except behind a gap.
  [[nodiscard]] std::int64_t point_of(double time, double time_before, std::int64_t before) const;
};

/// The grid of these times. What is noteworthy is noted; times that have no grid fail, with a
/// message that says whether a rate (--rate) would help.
TimeGrid find_time_grid(const TimeSource& times, const std::optional<StatedRate>& stated,
                        Notes& notes, const TimeGridOptions& options = {});

/// Samples as they come, with their times, put on a grid.
class GridRows {
 public:
  GridRows(const TimeGrid& grid, Eigen::Index columns) : grid_(grid), columns_(columns) {}

  /// Gives the next sample and its time (NaN: missing); false at the end.
  using Fetch = std::function<bool(double& time, Eigen::RowVectorXd& row)>;
  /// The next row of the grid; false at the end.
  bool next(const Fetch& fetch, Eigen::Ref<Eigen::RowVectorXd> out);
  /// Back to the beginning.
  void rewind();

 private:
  struct Row {
    double time{};
    std::int64_t point{};
    Eigen::RowVectorXd values{};
  };
  bool take(const Fetch& fetch);
  bool next_even(const Fetch& fetch, Eigen::Ref<Eigen::RowVectorXd> out);
  bool next_between(const Fetch& fetch, Eigen::Ref<Eigen::RowVectorXd> out);
  void interpolate(std::size_t right, double time, Eigen::Ref<Eigen::RowVectorXd> out) const;

  TimeGrid grid_;
  Eigen::Index columns_;
  std::deque<Row> rows_{};
  std::int64_t at_{};  ///< point of the grid that comes next
  std::int64_t last_point_{-1};
  double last_time_{};
  bool timed_{}, ended_{};
};

/// Samples that stand evenly in time.
struct EvenSamples {
  double rate{};   ///< [Hz]
  double start{};  ///< [s]
  Samples samples{};
};

/// Rows of samples with their `times` [s], NaN where one is missing, put on the grid of these.
EvenSamples on_time_grid(const Eigen::Ref<const Samples>& samples, std::span<const double> times,
                         const std::optional<StatedRate>& stated, Notes& notes);

/// A note where numbers without a unit make a rate at which nobody records vibrations, or few who
/// take many samples. `assumed`: what they are taken for, as in "the times have no unit and are
/// taken for seconds"; `remedy`: what states another unit.
void note_assumed_unit(std::string_view assumed, double rate, std::uint64_t samples,
                       std::string_view remedy, Notes& notes);
constexpr std::string_view times_taken_for_seconds =
    "the times have no unit and are taken for seconds";

}  // namespace hydrapod::data
