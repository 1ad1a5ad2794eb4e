#pragma once
/// Sobol's indices from the rows A, B, A_1 … A_d of every sample.
///
/// Sums go to 256 groups of samples, sample j to group j mod 256; the bootstrap draws groups with
/// replacement. f is taken against the mean of the output, which keeps the product of Saltelli's
/// estimator small.

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

std::vector<Indices> sobol_indices(const Spool& spool, const Problem& problem, const Plan& plan,
                                   const Summary& summary, int replicates);

}  // namespace hydrapod::study
