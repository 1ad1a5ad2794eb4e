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
  OrderSearch& search;
  std::size_t part{}, parts{1};  ///< every `parts`-th output; the first part counts statuses too
  RowsOfChunk chunk{problem.inputs.size() + problem.outputs.size()};
  std::vector<Moments> moments = std::vector<Moments>(problem.outputs.size());
  std::vector<double> margins = std::vector<double>(requirements.size());

  /// The rows of a chunk, `width` numbers each.
  void take(std::uint64_t first, std::span<const double> numbers, std::size_t width) {
    const std::size_t inputs = problem.inputs.size(), outputs = problem.outputs.size();
    const auto row = [&](std::size_t at) { return first + at / width; };
    const auto outputs_at = [&](std::size_t at) { return numbers.subspan(at + inputs, outputs); };
    if (part == 0 && problem.status >= 0)
      for (std::size_t at = 0; at < numbers.size(); at += width) count_status(outputs_at(at));
    for (std::size_t at = 0; at < numbers.size(); at += width) {
      if (!is_sample(plan, inputs, row(at))) continue;
      const auto own = outputs_at(at);
      // of many outputs in turn: a recurrence waits for itself
      for (std::size_t k = part; k < outputs; k += parts)
        if (std::isfinite(own[k])) moments[k].add(own[k], row(at));
      for (std::size_t k = part; k < requirements.size(); k += parts) judge(k, row(at), own);
    }
    chunk.take(first, numbers, [&](std::uint64_t r) { return is_sample(plan, inputs, r); });
    for (std::size_t k = part; k < outputs; k += parts) search.count(k, chunk.finite(inputs + k));
  }

  void count_status(std::span<const double> outputs) {
    const auto status = static_cast<std::size_t>(outputs[problem.status]);
    if (summary.statuses.size() <= status) summary.statuses.resize(status + 1);
    ++summary.statuses[status];
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

/// Where most values of each output are, by some rows.
std::vector<Range> ranges_of(const Spool& spool, std::size_t inputs, std::size_t outputs) {
  constexpr std::uint64_t rows = 512;  // beyond are 0.4 % of the others
  const std::uint64_t count = std::min(rows, spool.rows());
  std::vector<Range> ranges(outputs);
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto row = spool.row(k * spool.rows() / count);
    for (std::size_t o = 0; o < outputs; ++o) {
      if (!std::isfinite(row[inputs + o])) continue;
      ranges[o].least = std::min(ranges[o].least, row[inputs + o]);
      ranges[o].most = std::max(ranges[o].most, row[inputs + o]);
    }
  }
  return ranges;
}

/// A quantile that is wanted: its rank, and those around it.
struct QuantileRanks {
  std::size_t output{};
  double probability{};
  std::vector<std::uint64_t> ranks{};  ///< one, or three
};

std::vector<QuantileRanks> ranks_of(const std::vector<OutputSummary>& outputs, bool independent,
                                    const std::vector<double>& probabilities) {
  std::vector<QuantileRanks> all;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const std::uint64_t count = outputs[k].count;
    if (count == 0) continue;
    for (const double p : probabilities) {
      const auto rank = static_cast<std::uint64_t>(std::clamp(
          std::ceil(p * static_cast<double>(count)) - 1.0, 0.0, static_cast<double>(count - 1)));
      all.push_back({k, p, {rank}});
      if (const auto around = independent ? enclosing_ranks(count, p) : std::nullopt)
        all.back().ranks.insert(all.back().ranks.end(), {around->first, around->second});
    }
  }
  return all;
}

/// The quantiles of every `searches.size()`-th output by each search.
void add_quantiles(const Spool& spool, const Problem& problem, const Plan& plan,
                   const SummaryOptions& options, std::vector<OrderSearch>& searches,
                   Summary& summary) {
  const auto all = ranks_of(summary.outputs, plan.design == Design::random, options.probabilities);
  const std::size_t inputs = problem.inputs.size();
  numerics::parallel_for(searches.size(), options.threads, [&](std::size_t part) {
    const auto is_own = [&](const QuantileRanks& one) {
      return one.output % searches.size() == part;
    };
    std::vector<RankWanted> wanted;
    for (const auto& one : all)
      for (const std::uint64_t rank : one.ranks)
        if (is_own(one)) wanted.push_back({one.output, rank});
    const auto found = searches[part].find(
        spool, inputs, wanted, [&](std::uint64_t row) { return is_sample(plan, inputs, row); });
    auto next = found.begin();
    for (const auto& one : all) {
      if (!is_own(one)) continue;
      QuantileEstimate estimate{.probability = one.probability, .value = *next++};
      if (one.ranks.size() > 1) {
        estimate.interval = Interval{*next, *(next + 1)};
        next += 2;
      }
      summary.outputs[one.output].quantiles.push_back(estimate);
    }
  });
}

}  // namespace

Summary summarise(const Spool& spool, const Problem& problem, const Plan& plan,
                  const std::vector<Requirement>& requirements, const SummaryOptions& options) {
  Summary summary{.rows = spool.rows()};
  summary.requirements.resize(requirements.size());
  const std::size_t inputs = problem.inputs.size(), width = spool.width();
  std::vector<Moments> moments(problem.outputs.size());
  const auto parts = parts_of(options.threads, moments.size());
  const auto ranges = ranges_of(spool, inputs, moments.size());
  std::vector<OrderSearch> searches;
  for (std::size_t k = 0; k < parts; ++k) searches.emplace_back(ranges);
  numerics::parallel_for(parts, options.threads, [&](std::size_t part) {
    FirstPass pass{problem, plan, requirements, summary, searches[part], part, parts};
    spool.each_chunk([&](std::uint64_t first, std::span<const double> numbers) {
      pass.take(first, numbers, width);
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
  add_quantiles(spool, problem, plan, options, searches, summary);
  if (plan.indices)
    summary.indices = sobol_indices(spool, problem, plan, summary, options.replicates);
  if (options.reached) summary.reached = reached_part(spool, problem, plan);
  return summary;
}

}  // namespace hydrapod::study
