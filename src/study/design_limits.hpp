#pragma once
/// What keeps the best design from getting better.

#include "design_search.hpp"

namespace hydrapod::study {

/// Active requirements and bounds of a feasible design with their multipliers, and jumps beside it.
/// The multipliers λ ≥ 0 solve, in the least squares sense,
///
///     Σ_p μ_p ∂f_p/∂t = Σ_i λ_i ∂m_i/∂t + Σ_k (± β_k) e_k,   Σ μ_p = 1
///
/// with f_p the cost at those poses where it is the worst one, m_i the active margins and β_k those
/// of changes at their bounds. No price is stated where more than 5 % of the gradient is left.
std::vector<Limit> limits_of(Bench& bench, const Goal& goal, const Trial& best);

}  // namespace hydrapod::study
