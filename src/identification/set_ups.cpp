#include "set_ups.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

struct ModePair {
  std::size_t lower{}, higher{};
  VectorXd difference{};  ///< per output, positive where the higher one moves it
};

VectorXd motion(const FittedMode& mode) { return mode.shape.cwiseAbs().normalized(); }

bool divide_outputs(const FittedMode& a, const FittedMode& b, const SetUpOptions& options) {
  return std::abs(a.omega() - b.omega()) < options.apart * std::min(a.omega(), b.omega()) &&
         motion(a).dot(motion(b)) < options.overlap &&
         (a.participation.size() < 2 ||
          mac_matrix({a.participation}, {b.participation})(0, 0) > options.alike);
}

/// Each mode with the next one above it, that has no other, which moves different outputs.
std::vector<ModePair> pairs_of(const std::vector<IdentifiedMode>& modes,
                               const SetUpOptions& options) {
  std::vector<std::size_t> left(modes.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::ranges::sort(left, {}, [&](std::size_t r) { return modes[r].fit.omega(); });
  std::vector<ModePair> pairs;
  while (!left.empty()) {
    const auto lower = left.front();
    left.erase(left.begin());
    const auto& own = modes[lower].fit;
    const auto other = std::ranges::find_if(
        left, [&](std::size_t r) { return divide_outputs(own, modes[r].fit, options); });
    if (other == left.end()) continue;
    pairs.push_back({lower, *other, motion(modes[*other].fit) - motion(own)});
    left.erase(other);
  }
  return pairs;
}

bool agree(const ModePair& a, const ModePair& b, double least) {
  const VectorXd products = a.difference.cwiseProduct(b.difference);
  return products.sum() > least * products.cwiseAbs().sum();
}

/// The most pairs that divide the outputs as one of them does.
std::vector<ModePair> largest_division(const std::vector<ModePair>& pairs, double least) {
  std::vector<ModePair> most;
  for (const auto& one : pairs) {
    std::vector<ModePair> alike;
    std::ranges::copy_if(pairs, std::back_inserter(alike),
                         [&](const auto& other) { return agree(one, other, least); });
    if (alike.size() > most.size()) most = std::move(alike);
  }
  return most;
}

/// Whether the outputs of the two sets have no direction in common: symmetry does that.
bool is_by_direction(const std::vector<data::Channel>& outputs, const VectorXd& side) {
  std::set<int> lower, higher;
  for (Index k = 0; k < side.size(); ++k) {
    const auto& direction = outputs[static_cast<std::size_t>(k)].direction;
    if (direction == data::Direction::none) return false;
    (side[k] > 0.0 ? higher : lower).insert(std::abs(static_cast<int>(direction)));
  }
  return std::ranges::none_of(lower, [&](auto one) { return higher.contains(one); });
}

}  // namespace

void warn_of_set_ups(Identification& result, const SetUpOptions& options) {
  const auto& outputs = result.responses.outputs;
  if (std::ssize(outputs) < options.fewest_outputs) return;
  const auto pairs = largest_division(pairs_of(result.modes, options), options.agree);
  const auto count = 2 * pairs.size();
  if (pairs.size() < options.fewest_pairs ||
      static_cast<double>(count) < options.least_share * static_cast<double>(result.modes.size()))
    return;
  VectorXd side = VectorXd::Zero(std::ssize(outputs));
  for (const auto& pair : pairs) side += pair.difference;
  if (is_by_direction(outputs, side)) return;
  const bool one_input = result.responses.inputs.size() < 2;
  const double quality = one_input ? options.quality_of_one_input : options.quality;
  // pairs that are nearer than their width are not told apart, and are as little one mode
  for (auto& mode : result.modes) mode.explained = std::min(mode.explained, quality);
  const auto lower_set = std::ranges::find_if(side, [](double d) { return d < 0.0; });
  const auto& first = pairs.front();
  result.warnings.push_back(
      {.kind = ModeWarning::Kind::set_ups,
       .value = static_cast<double>((side.array() < 0.0).count()),
       .from = result.modes[first.lower].fit.omega() / two_pi,
       .to = result.modes[first.higher].fit.omega() / two_pi,
       .output = outputs[static_cast<std::size_t>(lower_set - side.begin())].name,
       .count = static_cast<std::int64_t>(count),
       .total = std::ssize(result.modes)});
}

}  // namespace hydrapod::identification
