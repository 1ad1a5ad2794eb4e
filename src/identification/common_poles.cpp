#include "common_poles.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

using Members = std::vector<const FittedMode*>;

/// Smallest by largest singular value of n vectors or more, each of length 1.
template <class Vector>
double independence(const Members& members, const Vector& vector, Index n) {
  MatrixXcd all(vector(*members[0]).size(), std::ssize(members));
  for (Index k = 0; k < all.cols(); ++k)
    all.col(k) = vector(*members[static_cast<std::size_t>(k)]).normalized();
  const VectorXd s = Eigen::JacobiSVD<MatrixXcd>(all).singularValues();
  return s[n - 1] / std::max(s[0], 1e-300);
}

Members all_poles(const Identification& result) {
  Members all;
  for (const auto& mode : result.modes) all.push_back(&mode.fit);
  for (const auto& pole : result.heavily_damped) all.push_back(&pole);
  return all;
}

/// n terms at the place of this pole?
bool has_full_rank(const FittedMode& pole, const Members& all, Index n,
                   const CommonPoleOptions& options) {
  Members here;
  std::ranges::copy_if(all, std::back_inserter(here), [&](const FittedMode* other) {
    return std::abs(other->pole - pole.pole) <= options.near * std::abs(pole.pole.real());
  });
  return std::ssize(here) >= n &&
         independence(
             here, [](const FittedMode& m) { return m.shape; }, n) > options.rank &&
         independence(
             here, [](const FittedMode& m) { return m.participation; }, n) > options.rank;
}

bool are_alike(const FittedMode& a, const FittedMode& b, double alike) {
  return mac_matrix({a.shape}, {b.shape})(0, 0) > alike &&
         mac_matrix({a.participation}, {b.participation})(0, 0) > alike;
}

/// Numbers of modes, with n > 1. Of a pole of which G(λ) is nearly of rank one, one term is found,
/// like that of another.
std::vector<std::size_t> of_full_rank(const Identification& result, Index n,
                                      const CommonPoleOptions& options) {
  const auto all = all_poles(result);
  Members full;
  std::ranges::copy_if(all, std::back_inserter(full), [&](const FittedMode* pole) {
    return has_full_rank(*pole, all, n, options);
  });
  const auto is_common = [&](const FittedMode& pole) {
    return std::ranges::any_of(full, [&](const FittedMode* other) {
      return other == &pole || are_alike(*other, pole, options.alike);
    });
  };
  if (n < static_cast<Index>(options.alone) &&
      std::ranges::none_of(result.heavily_damped, is_common))
    return {};
  std::vector<std::size_t> common;
  for (std::size_t r = 0; r < result.modes.size(); ++r)
    if (is_common(result.modes[r].fit)) common.push_back(r);
  return common;
}

/// The same with one output or one input: the highest modes, as far as they have the same shape.
std::vector<std::size_t> of_one_shape(const Identification& result,
                                      const CommonPoleOptions& options) {
  const auto& highest = result.modes.back().fit;
  std::vector<std::size_t> common;
  for (std::size_t r = result.modes.size();
       r > 0 && are_alike(highest, result.modes[r - 1].fit, options.alike); --r)
    common.push_back(r - 1);
  std::ranges::reverse(common);
  if (common.size() < options.alone &&
      std::ranges::none_of(result.heavily_damped, [&](const FittedMode& pole) {
        return are_alike(highest, pole, options.alike_damped);
      }))
    return {};
  return common;
}

}  // namespace

void find_common_poles(Identification& result, const CommonPoleOptions& options) {
  if (result.modes.empty()) return;
  const Index outputs = result.modes[0].fit.shape.size(),
              inputs = result.modes[0].fit.participation.size(), n = std::min(outputs, inputs);
  if (std::max(outputs, inputs) < options.fewest_entries) return;
  auto common = n > 1 ? of_full_rank(result, n, options) : of_one_shape(result, options);
  std::erase_if(common, [&](std::size_t r) {
    return result.modes[r].explained <= options.quality;  // another warning says why
  });
  if (common.empty()) return;
  for (const auto r : common)
    result.modes[r].explained = std::min(result.modes[r].explained, options.quality);
  const auto &lowest = result.modes[common.front()].fit, &top = result.modes[common.back()].fit;
  result.warnings.push_back({.kind = ModeWarning::Kind::common_poles,
                             .value = lowest.damping_ratio(),
                             .from = lowest.omega() / two_pi,
                             .to = top.omega() / two_pi,
                             .count = std::ssize(common),
                             .total = std::ssize(result.modes)});
}

}  // namespace hydrapod::identification
