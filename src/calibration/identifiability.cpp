#include "hydrapod/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "variables.hpp"

namespace hydrapod::calibration {

namespace {
constexpr int largest_trade = 4;
constexpr double most_groups = 30000.0;
constexpr double takes_part = 1e-3;  // of the largest relative change in a trade

/// Rounding and the differences behind J: singular values below this share of the largest are none.
constexpr double rounding = 1e-8;

bool contains(const std::vector<int>& group, const std::vector<int>& part) {
  return std::all_of(part.begin(), part.end(), [&](int j) {
    return std::find(group.begin(), group.end(), j) != group.end();
  });
}

/// "only a + 1.02 b is determined": the change δ that goes unnoticed has δ_a/δ_b = −1.02.
std::string words_of_pair(const Trade& trade, const std::vector<ParameterColumn>& parameters) {
  const auto& a = parameters[trade.parameters[0]];
  const auto& b = parameters[trade.parameters[1]];
  const double change_a = trade.direction[0] * a.size, change_b = trade.direction[1] * b.size;
  if (a.unit == b.unit) {
    const double factor = -change_a / change_b;
    const std::string times =
        std::abs(std::abs(factor) - 1.0) < 0.005 ? "" : fmt::format("{:.3g} ", std::abs(factor));
    return fmt::format("only {} {} {}{} is determined", a.name, factor < 0.0 ? "−" : "+", times,
                       b.name);
  }
  return fmt::format(
      "only one combination of {} and {} is determined: a change of {:+.3g} % of the first "
      "together with {:+.3g} % of the second has no effect",
      a.name, b.name, 1.0, trade.direction[1] / trade.direction[0]);
}

std::string words_of(const Trade& trade, const std::vector<ParameterColumn>& parameters) {
  const auto& members = trade.parameters;
  if (members.size() == 1) return "the data do not determine " + parameters[members[0]].name;
  if (members.size() == 2) return words_of_pair(trade, parameters);
  std::string names, changes;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const bool last = k + 1 == members.size();
    names += fmt::format("{}{}", k == 0 ? "" : last ? " and " : ", ", parameters[members[k]].name);
    changes += fmt::format("{}{:+.2g} %", k == 0 ? "" : ", ",
                           trade.direction[static_cast<Eigen::Index>(k)]);
  }
  return fmt::format(
      "of {} only {} combinations are determined: a joint change of {} has no effect", names,
      members.size() - 1, changes);
}

/// The direction in which the members of `group` are known worst.
Trade weakest(const Eigen::MatrixXd& J, const std::vector<int>& group, double scatter) {
  Eigen::MatrixXd part(J.rows(), group.size());
  for (std::size_t k = 0; k < group.size(); ++k)
    part.col(static_cast<Eigen::Index>(k)) = J.col(group[k]);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(part, Eigen::ComputeFullV);
  const bool enough_rows = part.rows() >= part.cols();
  const double least = enough_rows ? svd.singularValues().minCoeff() : 0.0;
  Trade trade{.parameters = group, .direction = svd.matrixV().rightCols<1>()};
  Eigen::Index largest = 0;
  trade.direction.cwiseAbs().maxCoeff(&largest);
  trade.direction /= trade.direction[largest];
  trade.deviation = least > 0.0 ? scatter / least : infinite;
  return trade;
}

/// Every group of `size` out of `of`, one after the other.
bool next_group(std::vector<int>& group, int of) {
  for (int k = static_cast<int>(group.size()) - 1; k >= 0; --k) {
    if (group[k] >= of - static_cast<int>(group.size()) + k) continue;
    ++group[k];
    for (std::size_t i = k + 1; i < group.size(); ++i) group[i] = group[i - 1] + 1;
    return true;
  }
  return false;
}

void find_trades(const Eigen::MatrixXd& J, const std::vector<ParameterColumn>& parameters,
                 const std::vector<int>& candidates, double scatter, std::vector<Trade>& trades) {
  const int count = static_cast<int>(candidates.size());
  double groups = 1.0;
  for (int size = 1; size <= std::min(largest_trade, count); ++size) {
    groups *= static_cast<double>(count - size + 1) / size;
    if (groups > most_groups) break;
    std::vector<int> at(size);
    for (int k = 0; k < size; ++k) at[k] = k;
    do {
      std::vector<int> group;
      for (const int k : at) group.push_back(candidates[k]);
      const bool known = std::any_of(trades.begin(), trades.end(), [&](const Trade& trade) {
        return contains(group, trade.parameters);
      });
      if (known) continue;
      Trade trade = weakest(J, group, scatter);
      if (trade.deviation <= free_above) continue;
      if (trade.direction.cwiseAbs().minCoeff() < takes_part) continue;
      trade.words = words_of(trade, parameters);
      trades.push_back(std::move(trade));
    } while (next_group(at, count));
  }
}

}  // namespace

int numerical_rank(const Eigen::MatrixXd& J) {
  if (J.size() == 0) return 0;
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
  const double none = rounding * sigma[0];
  return static_cast<int>((sigma.array() > none).count());
}

Identifiability identify_parameters(const Eigen::MatrixXd& J,
                                    const std::vector<ParameterColumn>& parameters,
                                    double scatter) {
  const auto n = J.cols();
  Identifiability result;
  result.deviations = Eigen::VectorXd::Constant(n, infinite);
  result.correlations = Eigen::MatrixXd::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
  if (J.size() == 0) return result;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeFullV);
  const auto& sigma = svd.singularValues();
  result.singular_values = sigma;
  result.directions = svd.matrixV();
  const double none = rounding * sigma[0];
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd in_null = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double value = k < sigma.size() ? sigma[k] : 0.0;
    const Eigen::VectorXd v = svd.matrixV().col(k);
    if (value > none && value > 0.0) {
      ++result.numerical_rank;
      if (scatter / value <= free_above) ++result.rank;
      covariance += v * v.transpose() * std::pow(scatter / value, 2);
    } else {
      in_null += v.cwiseAbs2();
    }
  }
  constexpr double touched = 1e-10;
  for (Eigen::Index a = 0; a < n; ++a) {
    if (in_null[a] > touched) continue;
    result.deviations[a] = std::sqrt(covariance(a, a));
    for (Eigen::Index b = 0; b < n; ++b)
      if (in_null[b] <= touched)
        result.correlations(a, b) =
            covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
  }
  std::vector<int> undetermined;
  for (int j = 0; j < n; ++j)
    if (!(result.deviations[j] <= free_above)) undetermined.push_back(j);
  // columns depend on each other as those of R do, which has no more rows than columns
  Eigen::MatrixXd R = J;
  if (J.rows() > n) R = J.householderQr().matrixQR().topRows(n).triangularView<Eigen::Upper>();
  find_trades(R, parameters, undetermined, scatter, result.trades);
  return result;
}

}  // namespace hydrapod::calibration
