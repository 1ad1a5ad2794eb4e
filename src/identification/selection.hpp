#pragma once
/// What it takes to call two poles the same. Private to the module.

#include "hydrapod/identification/poles.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// Share of `vector` in the span of the columns of `span`; 0 where there is none.
double share_in(const VectorXcd& vector, const MatrixXcd& span);

/// One more column, of length 1.
void add_direction(const VectorXcd& vector, MatrixXcd& span);

/// Do their moduli differ by less than the share `near`?
bool is_near(Complex a, Complex b, double near);

/// Is the damping ratio `other` that of a mode with `ratio`?
bool same_damping(double other, double ratio, const SelectionOptions& options);

/// Mean over the members of a cluster.
Complex mean_pole(const PoleCluster& cluster, const std::vector<OrderPoles>& chart);

}  // namespace hydrapod::identification
