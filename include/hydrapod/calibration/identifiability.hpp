#pragma once
/// What data say about parameters, and what they cannot say.
///
/// From the weighted Jacobian J of the data at the solution (residuals in standard deviations per
/// relative change of each parameter) by its singular values: along a right singular vector with
/// value σ the data know the parameters to ± 1/σ. A direction known no better than ± `free_above`
/// is free. Parameters that can be traded for each other without the data noticing are found as the
/// smallest groups whose columns of J nearly depend on each other. Bounds are not asked: what only
/// a bound holds, the data do not know.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hydrapod::calibration {

/// A direction whose relative standard deviation is larger than this is called free.
inline constexpr double free_above = 0.3;

/// A parameter as identifiability sees it.
struct ParameterColumn {
  std::string name{};  ///< "legs.rod.mass"
  std::string unit{};  ///< SI
  double value{};      ///< at the solution
  double size{};       ///< what a relative change is relative to: |value|, or a range around zero
};

/// Parameters of which the data know a combination only.
struct Trade {
  std::vector<int> parameters{};  ///< indices; a single one: the data do not see it at all
  Eigen::VectorXd direction{};    ///< relative changes that the data do not notice, largest 1
  double deviation{};             ///< how far one may go along it, relative; inf: anywhere
  std::string words{};            ///< "only legs.rod.mass + 1.02 legs.added_axial_inertia is …"
};

struct Identifiability {
  Eigen::VectorXd singular_values{};  ///< of J, descending
  Eigen::MatrixXd directions{};       ///< right singular vectors, columns, relative changes
  int rank{};                         ///< directions known better than free_above
  int numerical_rank{};               ///< singular values above rounding
  Eigen::VectorXd deviations{};       ///< relative, data alone; inf where not determined at all
  Eigen::MatrixXd correlations{};     ///< of the determined parameters; NaN elsewhere
  std::vector<Trade> trades{};        ///< smallest groups, shortest first
};

/// Singular values of J above rounding.
int numerical_rank(const Eigen::MatrixXd& J);

/// Trades are sought in groups of up to four parameters, fewer where there would be more than some
/// ten thousand groups. `J`: residuals in deviations × parameters, per relative change. `scatter`:
/// factor on all deviations where the data tell their own scatter, else 1.
Identifiability identify_parameters(const Eigen::MatrixXd& J,
                                    const std::vector<ParameterColumn>& parameters,
                                    double scatter = 1.0);

}  // namespace hydrapod::calibration
