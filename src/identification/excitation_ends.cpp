#include "excitation_ends.hpp"

#include <algorithm>
#include <cmath>

namespace hydrapod::identification {

namespace {

/// Mean over the outputs of ln S_oo.
VectorXd mean_logarithm(const std::vector<MatrixXcd>& S) {
  VectorXd L(std::ssize(S));
  for (Index k = 0; k < L.size(); ++k)
    L[k] = S[static_cast<std::size_t>(k)].diagonal().real().cwiseMax(1e-300).array().log().mean();
  return L;
}

struct Step {
  Index line{};  // the first one of the gap
  double size{};
};

/// Differences of what is above and below, one per step: the largest within its reach.
std::vector<Step> steps_in(const VectorXd& L, const ExcitationEndsOptions& options) {
  const Index n = options.stretch, g = options.gap, reach = 2 * n + g;
  const auto mean = [&](Index from) { return L.segment(from, n).mean(); };
  std::vector<Step> steps;
  if (L.size() < options.fewest_lines) return steps;
  // the first lines hold what is left of the mean
  for (Index k = reach + g; k + reach + n <= L.size(); ++k) {
    const double below = mean(k - n), above = mean(k + g), size = above - below;
    const auto is_level = [&](Index here, Index next, Index behind) {
      const double most = options.level * std::abs(size), own = mean(here);
      double least = own, largest = own;
      for (Index pair = here; pair + 2 <= here + n; pair += 2) {
        least = std::min(least, L.segment<2>(pair).mean());
        largest = std::max(largest, L.segment<2>(pair).mean());
      }
      return std::abs(own - mean(next)) <= most && std::abs(own - mean(behind)) <= most &&
             largest - least <= 2.0 * most;
    };
    const double beside = L.segment<2>(k + g).mean() - L.segment<2>(k - 2).mean();
    if (!(std::abs(size) > options.least) || !(beside / size > options.sharp) ||
        !is_level(k - n, k - 2 * n, k - reach) || !is_level(k + g, k + g + n, k + reach))
      continue;
    if (steps.empty() || k - steps.back().line > reach)
      steps.push_back({k, size});
    else if (std::abs(size) > std::abs(steps.back().size))
      steps.back() = {k, size};
  }
  return steps;
}

}  // namespace

ExcitationEnds excitation_ends(const std::vector<MatrixXcd>& S,
                               const ExcitationEndsOptions& options) {
  ExcitationEnds ends{.first = 0, .last = std::ssize(S) - 1};
  const auto steps = steps_in(mean_logarithm(S), options);
  const auto lower = std::ranges::max_element(steps, {}, &Step::size),
             upper = std::ranges::min_element(steps, {}, &Step::size);
  // beyond an end there may be what is left of resonances
  const auto is_beyond = [&](const Step& end, auto from, auto to) {
    return std::none_of(from, to,
                        [&](const Step& other) { return other.size / end.size < -options.beyond; });
  };
  if (lower != steps.end() && lower->size > 0.0 && is_beyond(*lower, steps.begin(), lower)) {
    ends.lower_step = lower->size;
    ends.first = lower->line + options.gap;
  }
  if (upper != steps.end() && upper->size < 0.0 && is_beyond(*upper, upper, steps.end())) {
    ends.upper_step = upper->size;
    ends.last = upper->line - 1;
  }
  return ends;
}

void continue_beyond(const ExcitationEnds& ends, std::vector<MatrixXcd>& S,
                     const ExcitationEndsOptions& options) {
  const auto mean = [&](Index from) {
    MatrixXcd sum = MatrixXcd::Zero(S[0].rows(), S[0].cols());
    for (Index k = from; k < from + options.stretch; ++k) sum += S[static_cast<std::size_t>(k)];
    return MatrixXcd((sum / static_cast<double>(options.stretch)).real().cast<Complex>());
  };
  if (ends.lower_step != 0.0) std::fill(S.begin(), S.begin() + ends.first, mean(ends.first));
  if (ends.upper_step != 0.0)
    std::fill(S.begin() + ends.last + 1, S.end(), mean(ends.last + 1 - options.stretch));
}

}  // namespace hydrapod::identification
