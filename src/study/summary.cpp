#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <limits>

#include "hydrapod/numerics/statistics.hpp"
#include "order_statistics.hpp"
#include "reached_part.hpp"
#include "sobol_indices.hpp"

namespace hydrapod::study {

namespace {

constexpr double tail = 0.025;  ///< on each side of an interval

/// With Plan::indices only A and B are samples of the inputs' distribution.
bool is_sample(const Plan& plan, std::size_t inputs, std::uint64_t row) {
  return !plan.indices || row % (inputs + 2) < 2;
}

/// Clopper & Pearson, Biometrika 26 (1934) 404: quantiles of beta distributions.
Interval proportion_interval(std::uint64_t hits, std::uint64_t count) {
  const auto k = static_cast<double>(hits), n = static_cast<double>(count);
  using Beta = boost::math::beta_distribution<>;
  return {hits == 0 ? 0.0 : boost::math::quantile(Beta(k, n - k + 1.0), tail),
          hits == count ? 1.0 : boost::math::quantile(Beta(k + 1.0, n - k), 1.0 - tail)};
}

/// Ranks, from 0, whose order statistics enclose the quantile with at least 95 %: P(x_(r) ≤ q) is
/// that of a binomial variable. Nothing where there are too few.
std::optional<std::pair<std::uint64_t, std::uint64_t>> enclosing_ranks(std::uint64_t count,
                                                                       double probability) {
  const boost::math::binomial_distribution<
      double, boost::math::policies::policy<boost::math::policies::discrete_quantile<
                  boost::math::policies::integer_round_down>>>
      below(static_cast<double>(count), probability);
  // largest l with P(B < l) ≤ tail, smallest u with P(B < u) ≥ 1 − tail; B < u: x_(u) > q
  double l = boost::math::quantile(below, tail), u = boost::math::quantile(below, 1.0 - tail);
  while (l > 0.0 && boost::math::cdf(below, l - 1.0) > tail) l -= 1.0;
  while (u <= static_cast<double>(count) &&
         (u < 1.0 || boost::math::cdf(below, u - 1.0) < 1.0 - tail))
    u += 1.0;
  if (l < 1.0 || u > static_cast<double>(count)) return {};
  return std::pair(static_cast<std::uint64_t>(l) - 1, static_cast<std::uint64_t>(u) - 1);
}

/// Count, mean and sum of squares by Welford's recurrence, in the order of the rows.
struct Moments {
  std::uint64_t count{};
  double mean{}, squares{};
  double least{std::numeric_limits<double>::infinity()}, most{-least};
  std::uint64_t least_row{}, most_row{};

  void add(double value, std::uint64_t row) {
    ++count;
    const double off = value - mean;
    mean += off / static_cast<double>(count);
    squares += off * (value - mean);
    if (value < least) least_row = row;
    if (value > most) most_row = row;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  [[nodiscard]] double deviation() const {
    return count > 1 ? std::sqrt(squares / static_cast<double>(count - 1)) : 0.0;
  }
};

/// What one pass over the rows collects.
struct FirstPass {
  const Problem& problem;
  const Plan& plan;
  const std::vector<Requirement>& requirements;
  Summary& summary;
  std::size_t part{}, parts{1};  ///< every `parts`-th output; the first part counts statuses too
  std::vector<Moments> moments = std::vector<Moments>(problem.outputs.size());
  std::vector<double> margins = std::vector<double>(requirements.size());

  void take(std::uint64_t row, std::span<const double> outputs) {
    if (part == 0 && problem.status >= 0) {
      const auto status = static_cast<std::size_t>(outputs[problem.status]);
      if (summary.statuses.size() <= status) summary.statuses.resize(status + 1);
      ++summary.statuses[status];
    }
    if (!is_sample(plan, problem.inputs.size(), row)) return;
    for (std::size_t k = part; k < outputs.size(); k += parts)
      if (std::isfinite(outputs[k])) moments[k].add(outputs[k], row);
    for (std::size_t k = part; k < requirements.size(); k += parts) judge(k, row, outputs);
  }

  void judge(std::size_t k, std::uint64_t row, std::span<const double> outputs) {
    const auto& wanted = requirements[k];
    auto& result = summary.requirements[k];
    const double value = outputs[static_cast<std::size_t>(wanted.output)];
    const double margin = wanted.at_least ? value - wanted.bound : wanted.bound - value;
    ++result.count;
    if (!(margin >= 0.0)) ++result.missed;
    if (std::isnan(margin) || (result.worst && margin >= margins[k])) return;
    margins[k] = margin;
    result.worst = row;
  }
};

OutputSummary output_summary(const Moments& moments, bool independent) {
  OutputSummary result{.count = moments.count,
                       .mean = moments.mean,
                       .deviation = moments.deviation(),
                       .least = moments.least,
                       .most = moments.most,
                       .least_row = moments.least_row,
                       .most_row = moments.most_row};
  if (independent && moments.count > 1) {
    const auto degrees =
        static_cast<int>(std::min<std::uint64_t>(moments.count - 1, 1'000'000'000));
    const double half = numerics::student_half_width(degrees) * result.deviation /
                        std::sqrt(static_cast<double>(moments.count));
    result.mean_interval = Interval{moments.mean - half, moments.mean + half};
  }
  return result;
}

/// The quantiles of all outputs, from one search for all order statistics.
void add_quantiles(const Spool& spool, const Problem& problem, const Plan& plan,
                   const SummaryOptions& options, Summary& summary) {
  const auto& probabilities = options.probabilities;
  const bool independent = plan.design == Design::random;
  std::vector<RankWanted> wanted;
  std::vector<std::vector<std::optional<std::pair<std::uint64_t, std::uint64_t>>>> enclosing;
  for (std::size_t k = 0; k < summary.outputs.size(); ++k) {
    enclosing.emplace_back();
    const std::uint64_t count = summary.outputs[k].count;
    if (count == 0) continue;
    for (const double p : probabilities) {
      const auto rank = static_cast<std::uint64_t>(std::clamp(
          std::ceil(p * static_cast<double>(count)) - 1.0, 0.0, static_cast<double>(count - 1)));
      wanted.push_back({k, rank});
      enclosing.back().push_back(independent ? enclosing_ranks(count, p) : std::nullopt);
      if (!enclosing.back().back()) continue;
      wanted.push_back({k, enclosing.back().back()->first});
      wanted.push_back({k, enclosing.back().back()->second});
    }
  }
  const std::size_t inputs = problem.inputs.size();
  std::vector<Range> ranges;
  for (const auto& output : summary.outputs) ranges.push_back({output.least, output.most});
  const auto found = order_statistics(
      spool, inputs, ranges, wanted,
      [&](std::uint64_t row) { return is_sample(plan, inputs, row); }, options.threads);
  std::size_t next = 0;
  for (std::size_t k = 0; k < summary.outputs.size(); ++k)
    for (std::size_t q = 0; q < enclosing[k].size(); ++q) {
      QuantileEstimate estimate{.probability = probabilities[q], .value = found[next++]};
      if (enclosing[k][q]) {
        estimate.interval = Interval{found[next], found[next + 1]};
        next += 2;
      }
      summary.outputs[k].quantiles.push_back(estimate);
    }
}

}  // namespace

Summary summarise(const Spool& spool, const Problem& problem, const Plan& plan,
                  const std::vector<Requirement>& requirements, const SummaryOptions& options) {
  Summary summary{.rows = spool.rows()};
  summary.requirements.resize(requirements.size());
  const std::size_t inputs = problem.inputs.size(), width = spool.width();
  std::vector<Moments> moments(problem.outputs.size());
  const auto parts = parts_of(options.threads, moments.size());
  numerics::parallel_for(parts, options.threads, [&](std::size_t part) {
    FirstPass pass{problem, plan, requirements, summary, part, parts};
    spool.each_chunk([&](std::uint64_t first, std::span<const double> numbers) {
      for (std::size_t at = 0; at < numbers.size(); at += width)
        pass.take(first + at / width, numbers.subspan(at + inputs, width - inputs));
    });
    for (std::size_t k = part; k < moments.size(); k += parts) moments[k] = pass.moments[k];
  });
  const bool independent = plan.design == Design::random;
  for (const auto& one : moments) summary.outputs.push_back(output_summary(one, independent));
  for (auto& requirement : summary.requirements) {
    if (requirement.count == 0) continue;
    requirement.probability =
        static_cast<double>(requirement.missed) / static_cast<double>(requirement.count);
    if (independent)
      requirement.interval = proportion_interval(requirement.missed, requirement.count);
  }
  add_quantiles(spool, problem, plan, options, summary);
  if (plan.indices)
    summary.indices = sobol_indices(spool, problem, plan, summary, options.replicates);
  if (options.reached) summary.reached = reached_part(spool, problem, plan);
  return summary;
}

}  // namespace hydrapod::study
