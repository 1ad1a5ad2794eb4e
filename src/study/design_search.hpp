#pragma once
/// The search behind design(): a goal over the unit cube of the changes.
///
/// A change goes through its range in equal steps, or in equal ratios where both bounds are
/// positive and a factor of ten or more apart:  p = a + t (b − a),  or  p = a (b/a)^t,  0 ≤ t ≤ 1.
///
/// A term's margin is (v − bound)/scale, or (bound − v)/scale, at a pose; a design is feasible when
/// no margin is negative. Violation: the largest −margin, 0 for feasible designs. The search keeps
/// `reserve` of margin, so that the same design by another way of computing it (rounding) is
/// feasible too.

#include <memory>

#include "hydrapod/study/design.hpp"

namespace hydrapod::study {

/// A bound for an output or a change.
struct Term {
  int output{-1}, change{-1};
  bool at_least{};  ///< of an objective: it is maximised
  double bound{};
  double scale{1.0};
};

struct Goal {
  std::optional<Term> objective{};  ///< none: only the violation counts
  std::vector<Term> constraints{};
};

inline constexpr double reserve = 1e-9;
/// Violation of a design without outputs at a pose.
inline constexpr double no_outputs = 1e3;

/// A design that was evaluated.
struct Trial {
  std::vector<double> t{}, values{};
  std::vector<std::vector<double>> outputs{};  ///< per pose, all columns
  double violation{no_outputs};
  double cost{};  ///< of the objective, small is good
};

/// Among two designs of one goal.
bool better(const Trial& one, const Trial& other);

std::vector<double> values_at(const std::vector<Input>& changes, std::span<const double> t);
std::vector<double> place_of(const std::vector<Input>& changes, std::span<const double> values);
/// dp/dt
double slope_at(const Input& change, double value);

/// Value of a term at a pose; NaN where there is none.
double value_of(const Term& term, const Trial& trial, std::size_t pose);
double margin_of(const Term& term, const Trial& trial, std::size_t pose);
/// Sets violation and cost.
void judge(const Goal& goal, int status, Trial& trial);

/// Models of all poses for the use of one thread.
class Bench {
 public:
  Bench(const DesignProblem& problem, const std::vector<int>& wanted);
  Trial at(const Goal& goal, std::vector<double> t);
  /// Per pose the derivatives of the wanted outputs.
  std::vector<DesignModel::Derivatives> derivatives(const Trial& trial);
  /// Of a term at a pose by t, from them.
  [[nodiscard]] Eigen::RowVectorXd gradient(
      const Term& term, const Trial& trial,
      const std::vector<DesignModel::Derivatives>& derivatives, std::size_t pose) const;
  [[nodiscard]] const DesignProblem& problem() const { return problem_; }
  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }

 private:
  const DesignProblem& problem_;
  std::vector<int> wanted_;
  int status_{};
  std::vector<DesignModel> models_;
  std::uint64_t evaluations_{};
};

/// True asks to stop.
using Stop = std::function<bool()>;

/// The best design that a local search from `start` comes by.
Trial local_search(Bench& bench, const Goal& goal, const Trial& start, const Stop& stop);

}  // namespace hydrapod::study
