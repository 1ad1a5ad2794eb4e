#include "residual_tests.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "fit_covariance.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "weak_modes.hpp"

namespace hydrapod::identification {

namespace {

/// Sums over the lines of a part of the band, of one response.
struct PartSums {
  double level{}, together{}, alone{}, rest{}, response{};
  Index lines{};
};

/// Residuals by their deviations, per entry: a row per line.
struct Residual {
  MatrixXcd white, plain, response;
};

/// Of a whole record a column per output, of responses one per output and input.
Residual residual_columns(const FrequencyResponses& r, const ModalModel& model, bool taper) {
  const auto rest = residual_of(r, model, taper);
  const Index outputs = r.H[0].rows(), inputs = r.excitation.empty() ? r.H[0].cols() : 1;
  const auto lines = static_cast<Index>(r.lines());
  Residual all{MatrixXcd(lines, outputs * inputs), MatrixXcd(lines, outputs * inputs),
               MatrixXcd(lines, outputs * inputs)};
  for (Index k = 0; k < lines; ++k)
    for (Index o = 0; o < outputs; ++o)
      for (Index i = 0; i < inputs; ++i) {
        const auto at = static_cast<std::size_t>(k);
        if (!r.excitation.empty()) {
          const auto seen = [&](const FrequencyResponses& of) -> Complex {
            return of.H[at].row(o) * r.excitation[at];
          };
          all.plain(k, o) = seen(rest);
          all.white(k, o) = seen(rest) / std::sqrt(std::max(r.noise[at](o, o).real(), 1e-300));
          all.response(k, o) = seen(r);
          continue;
        }
        const Complex e = rest.H[at](o, i);
        all.plain(k, o * inputs + i) = e;
        all.white(k, o * inputs + i) = e / std::sqrt(std::max(r.variance(at, o, i), 1e-300));
        all.response(k, o * inputs + i) = r.H[at](o, i);
      }
  return all;
}

PartSums sums_of(const Residual& all, Index column, Index from, Index count, Index lag) {
  const auto white = all.white.col(column).segment(from, count);
  PartSums s;
  s.lines = count;
  s.level = white.squaredNorm();
  s.rest = all.plain.col(column).segment(from, count).squaredNorm();
  s.response = all.response.col(column).segment(from, count).squaredNorm();
  const auto front = white.head(count - lag), back = white.tail(count - lag);
  s.together = front.dot(back).real();
  s.alone = 0.5 * (front.squaredNorm() + back.squaredNorm());
  return s;
}

/// What chance leaves below itself in all tests together but for `false_alarm`.
struct Limits {
  double level{}, smooth{};
};

Limits limits_of(const FrequencyResponses& r, const IdentifyOptions& asked, bool assumed,
                 Index lines, Index lag, double tests) {
  const auto& options = asked.residual_test;
  const double alone = lines_in_step(r), chance = options.false_alarm / std::max(1.0, tests);
  const double n = std::max(1.0, static_cast<double>(lines) / alone);
  Limits limits;
  const auto fisher = [&](double degrees) {
    return numerics::fisher_quantile(1.0 - chance, 2.0 * n, degrees);
  };
  // the mean of F(2, 2 ν) over lines whose noise was estimated apart is F(2 n, 2 n ν), or nearly
  // so; an assumed variance, a median over 2 reach + 1 lines, is one estimate for all lines of a
  // part
  if (assumed)
    limits.level = fisher(asked.assumed_errors.reach);
  else if (r.degrees > 1.0)
    limits.level = fisher(2.0 * n * r.degrees) * r.degrees / (r.degrees - 1.0);
  else
    limits.level = numerics::chi_squared_quantile(1.0 - chance, static_cast<int>(2.0 * n)) /
                   std::floor(2.0 * n);
  limits.level = std::max(limits.level, options.level);
  const double normal = std::sqrt(numerics::chi_squared_quantile(1.0 - 2.0 * chance, 1));
  limits.smooth =
      std::max(options.smooth, normal / std::sqrt(2.0 * static_cast<double>(lines - lag) / alone));
  return limits;
}

}  // namespace

std::vector<Unexplained> unexplained_parts(const FrequencyResponses& r, const ModalModel& model,
                                           const IdentifyOptions& options, bool assumed) {
  std::vector<Unexplained> found;
  const auto& asked = options.residual_test;
  const auto lines = static_cast<Index>(r.lines()),
             lag = static_cast<Index>(r.line_covariance.size());
  const Index count = std::min<Index>(lines, asked.lines), step = std::max<Index>(1, count / 2);
  if (!r.has_errors() || model.modes.empty() || count <= 2 * lag) return found;
  const auto all = residual_columns(r, model, options.fit.taper);
  const Index entries = all.white.cols(), inputs = entries / r.H[0].rows();
  std::vector<Index> starts;
  for (Index from = 0; from + count <= lines; from += step) starts.push_back(from);
  if (starts.back() + count < lines) starts.push_back(lines - count);
  const auto limits = limits_of(r, options, assumed, count, lag,
                                static_cast<double>(entries) * static_cast<double>(starts.size()));
  for (const Index from : starts)
    for (Index c = 0; c < entries; ++c) {
      const auto s = sums_of(all, c, from, count, lag);
      const double level = s.level / static_cast<double>(s.lines),
                   smooth = s.alone > 0.0 ? s.together / s.alone : 0.0;
      if (s.rest <= asked.negligible * asked.negligible * s.response) continue;
      // a hundredth of the noise is nothing, however smooth: responses that are 0 but for rounding
      constexpr double nothing = 1e-4;
      if (level <= limits.level && (smooth <= limits.smooth || level <= nothing)) continue;
      const auto at = [&](Index k) { return r.frequency[static_cast<std::size_t>(k)]; };
      found.push_back({.output = c / inputs,
                       .input = c % inputs,
                       .from = at(from),
                       .to = at(from + count - 1),
                       .level = level,
                       .smooth = smooth,
                       .share = s.rest / std::max(s.response, 1e-300)});
    }
  std::ranges::stable_sort(found, std::ranges::greater{}, &Unexplained::level);
  return found;
}

}  // namespace hydrapod::identification
