#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/tasks/study.hpp"

namespace hydrapod::tasks {

namespace {

/// MAC with the nominal modes and frequencies of the followed modes, a column per row of the study;
/// NaN where it has none.
Eigen::MatrixXd modes_of_rows(const StudyJob& job, int threads, const Progress& progress) {
  const auto& outputs = job.problem.outputs;
  const std::size_t inputs = job.problem.inputs.size(), width = inputs + outputs.size();
  std::vector<std::size_t> taken;  // numbers of a row
  for (std::size_t k = 0; k < outputs.size(); ++k)
    if (outputs[k].name == "mac") taken.push_back(inputs + k);
  for (std::size_t k = 0; k < outputs.size(); ++k)
    if (outputs[k].name.starts_with("mode")) taken.push_back(inputs + k);
  const auto rows = static_cast<std::size_t>(job.rows);
  Eigen::MatrixXd modes(taken.size(), rows);
  constexpr std::size_t together = 1024;
  const study::Interruptible motions(job.problem,
                                     [] { return true; });  // end where they first look
  const bool whole = numerics::parallel_for(
      (rows + together - 1) / together, threads,
      [&](std::size_t piece) {
        const std::size_t first = piece * together, count = std::min(together, rows - first);
        std::vector<double> numbers(count * width);
        study::Evaluator(job.problem).rows(job.plan, first, numbers);
        for (std::size_t row = 0; row < count; ++row)
          for (std::size_t k = 0; k < taken.size(); ++k)
            modes(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(first + row)) =
                numbers[row * width + taken[k]];
      },
      progress);
  if (!whole) throw base::ComputationError("interrupted before the first row");
  return modes;
}

/// The rows around an interval of an input, one behind the other: those at its ends and the ones
/// before and behind these, −1 where the grid has none.
struct Around {
  Eigen::Index before{-1}, begin{}, end{}, behind{-1};
};

/// 1 where mode i is above mode j in this row, −1 where it is below, 0 where they are equal or one
/// has no frequency.
int order_of(const Eigen::MatrixXd& modes, Eigen::Index row, Eigen::Index i, Eigen::Index j,
             double apart) {
  if (row < 0) return 0;
  const double off = modes(i, row) - modes(j, row);
  return !(std::abs(off) > apart * modes(i, row)) ? 0 : off > 0.0 ? 1 : -1;
}

bool cross_or_veer(const Eigen::MatrixXd& modes, const Around& rows, const RefineOptions& options) {
  if (std::abs(modes(0, rows.begin) - modes(0, rows.end)) > options.veers) return true;
  for (Eigen::Index i = 1; i < modes.rows(); ++i)
    for (Eigen::Index j = i + 1; j < modes.rows(); ++j) {
      const auto order = [&](Eigen::Index row) {
        return order_of(modes, row, i, j, options.apart);
      };
      // where they are equal at one end they may cross there
      const int from = order(rows.begin) != 0 ? order(rows.begin) : order(rows.before),
                to = order(rows.end) != 0 ? order(rows.end) : order(rows.behind);
      if (from * to < 0) return true;
    }
  return false;
}

/// For each input, which of its intervals are between neighbours whose modes cross or veer.
std::vector<std::vector<char>> intervals_to_halve(const StudyJob& job, const Eigen::MatrixXd& modes,
                                                  const RefineOptions& options) {
  const auto& counts = job.plan.counts;
  std::vector<std::vector<char>> halved;
  std::int64_t apart = modes.cols();  // rows between neighbours; the last input is the fastest
  for (const int count : counts) {
    apart /= count;
    auto& own = halved.emplace_back(static_cast<std::size_t>(count - 1));
    for (std::int64_t row = 0; row < modes.cols(); ++row) {
      const std::int64_t at = row / apart % count;
      if (at + 1 == count || own[static_cast<std::size_t>(at)] != 0) continue;
      const Around rows{.before = at > 0 ? row - apart : -1,
                        .begin = row,
                        .end = row + apart,
                        .behind = at + 2 < count ? row + 2 * apart : -1};
      own[static_cast<std::size_t>(at)] = cross_or_veer(modes, rows, options) ? 1 : 0;
    }
  }
  return halved;
}

/// Neighbours of a list are those of the number where it ascends or descends.
void require_order(const StudyJob& job, int times) {
  for (const auto& input : job.problem.inputs) {
    const auto& list = input.distribution.list;
    if (!std::ranges::is_sorted(list) && !std::ranges::is_sorted(list, std::greater{}))
      base::refuse(fmt::format("--refine {}", times),
                   fmt::format("halves intervals between neighbours; expected the values of {} in "
                               "ascending or descending order",
                               input.name));
  }
}

std::vector<double> with_middles(const std::vector<double>& values,
                                 const std::vector<char>& halved) {
  std::vector<double> all;
  for (std::size_t k = 0; k < values.size(); ++k) {
    all.push_back(values[k]);
    if (k < halved.size() && halved[k] != 0) all.push_back(std::midpoint(values[k], values[k + 1]));
  }
  return all;
}

}  // namespace

std::vector<int> refine_grid(StudyJob& job, int times, const Progress& progress,
                             const RefineOptions& options) {
  if (job.plan.design != study::Design::grid)
    throw std::invalid_argument("refine_grid: the study is no grid");
  require_order(job, times);
  if (std::ranges::count(job.problem.outputs, "mac", &study::Column::name) == 0)
    base::refuse(fmt::format("--refine {}", times),
                 "follows modes by their shape; expected `modes` among the outputs of --only");
  const auto asked = job.plan.counts;
  const double bytes_of_row = job.bytes / static_cast<double>(job.rows);
  for (int k = 0; k < times; ++k) {
    if (job.rows > options.most_rows)
      base::refuse(
          fmt::format("--refine {}", times),
          fmt::format("the grid has {} rows after {} of them, and is refined up to {}; take "
                      "fewer values, or refine less often",
                      job.rows, k, options.most_rows));
    const auto modes = modes_of_rows(
        job, options.threads,
        numerics::part_of(progress, static_cast<double>(k) / times, (k + 1.0) / times));
    const auto halved = intervals_to_halve(job, modes, options);
    job.rows = 1;
    for (std::size_t d = 0; d < halved.size(); ++d) {
      auto& values = job.problem.inputs[d].distribution.list;
      values = with_middles(values, halved[d]);
      job.plan.counts[d] = static_cast<int>(values.size());
      job.rows *= values.size();
    }
    if (job.rows == job.plan.samples) break;  // nothing crosses any more
    job.plan.samples = job.rows;
  }
  job.bytes = bytes_of_row * static_cast<double>(job.rows);
  std::vector<int> added;
  for (std::size_t d = 0; d < asked.size(); ++d) added.push_back(job.plan.counts[d] - asked[d]);
  return added;
}

}  // namespace hydrapod::tasks
