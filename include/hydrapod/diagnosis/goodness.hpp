#pragma once
/// Does a hypothesis explain what was measured, by the deviations stated? The kinds of values are
/// judged one by one, so that many values of one kind, well met, do not hide that another is
/// missed: frequencies with n_f − k degrees of freedom (they determine the k numbers for the most
/// part), shapes and damping ratios, responses. Of each kind the probability is that of a χ² as
/// large or larger; `probability` is the least of them times the number of kinds (Bonferroni), at
/// most 1. Theory: docs/theory/diagnosis.md.

#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis {

struct ChiSquared {
  double sum{};   ///< Σ (difference/deviation)²
  int values{};   ///< that it is of
  int degrees{};  ///< of freedom; 0: nothing can be said
  [[nodiscard]] double reduced() const { return degrees > 0 ? sum / degrees : 0.0; }
  /// Of a sum as large or larger, where the deviations are right; 1 without degrees of freedom.
  [[nodiscard]] double probability() const;
};

struct Goodness {
  ChiSquared frequencies{}, shapes{}, responses{};
  double reduced{};  ///< misfit over values − numbers, 0 where there are no more values
  double probability{};
};

Goodness goodness(const Diagnosis& d, const Hypothesis& hypothesis);

/// Below this probability a hypothesis does not explain the data, and nothing is identified by it.
inline constexpr double least_probability = 0.01;

/// BIC of a cause that is no candidate: it moves every value of a kind by an amount of its own, normally
/// distributed about the nominal machine's with a variance that the data determine,
///
///     Σ over kinds  n (1 + ln(χ²/n)) + ln(all values)   where χ² > n, else χ²
///
/// with χ² of the nominal machine (the least over n and 1 + ln of Σ [d²/(1 + τ²) + ln(1 + τ²)], d in
/// deviations). A candidate that does not beat it by more than `same` explains no more than chance does.
double unlisted_bic(const Diagnosis& d);

/// s² as it comes out, below 1 too: where deviations are right about 1, where the model is better
/// than its stated uncertainty less. 0 where nothing has more values than numbers.
double raw_scatter2(const Diagnosis& d);

}  // namespace hydrapod::diagnosis
