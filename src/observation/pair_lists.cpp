#include <algorithm>
#include <stdexcept>

#include "pair_cost.hpp"

namespace hydrapod::observation {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double hides_nothing = 1e-12;

void require_fitting(const ModeList& list, const char* which) {
  if (list.shapes.rows() > 0 && list.shapes.cols() != static_cast<Index>(list.poles.size()))
    throw std::invalid_argument(std::string("pair_lists: the ") + which +
                                " list has not one shape for each pole");
}

/// Per mode of `u` (rows) its share in the motions of the group of each mode of `of` (columns).
MatrixXd shares(const MatrixXcd& u, const MatrixXcd& of,
                const std::vector<std::vector<int>>& groups) {
  MatrixXd all(u.cols(), of.cols());
  for (Index r = 0; r < u.cols(); ++r)
    for (Index m = 0; m < of.cols(); ++m)
      all(r, m) =
          share_shown(of(Eigen::all, groups[static_cast<std::size_t>(m)]), u.col(r), hides_nothing);
  return all;
}

}  // namespace

std::vector<ListedPair> pair_lists(const ModeList& first, const ModeList& second,
                                   const ObservationOptions& options) {
  require_fitting(first, "first");
  require_fitting(second, "second");
  if (first.shapes.rows() != second.shapes.rows())
    throw std::invalid_argument("pair_lists: the shapes are of different outputs");
  const auto rows = static_cast<Index>(first.poles.size()),
             columns = static_cast<Index>(second.poles.size());
  if (rows == 0 || columns == 0) return {};
  const bool with_shapes = first.shapes.rows() > 0;
  MatrixXd shown, alone;
  if (with_shapes) {
    const MatrixXcd u = first.shapes.colwise().normalized(),
                    v = second.shapes.colwise().normalized();
    shown = shares(u, v, group_of_each(second.poles, options))
                .cwiseMax(shares(v, u, group_of_each(first.poles, options)).transpose());
    alone = (u.adjoint() * v).cwiseAbs2();
  }
  MatrixXd cost(rows, columns + rows);
  cost.rightCols(rows).setConstant(options.no_partner);
  for (Index r = 0; r < rows; ++r)
    for (Index m = 0; m < columns; ++m) {
      cost(r, m) = frequency_cost(std::abs(first.poles[static_cast<std::size_t>(r)]),
                                  std::abs(second.poles[static_cast<std::size_t>(m)]), options);
      if (with_shapes) cost(r, m) += shape_cost(shown(r, m), alone(r, m), 1.0, options);
    }
  std::vector<ListedPair> pairs;
  const auto partner = numerics::assign(cost);
  for (std::size_t r = 0; r < partner.size(); ++r) {
    if (partner[r] >= columns) continue;
    ListedPair pair{.first = static_cast<int>(r), .second = partner[r]};
    if (with_shapes) pair.mac = shown(static_cast<Index>(r), partner[r]);
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace hydrapod::observation
