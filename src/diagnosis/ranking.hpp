#pragma once
/// Ranks hypotheses, passes judgement, and looks closer at the best one. Private to the module.

#include <optional>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "predictions.hpp"

namespace hydrapod::diagnosis {

/// s above which even the best hypothesis is none, and above which machine and data may not even
/// belong together. The right hypothesis has s = 1, where deviations are right.
inline constexpr double no_explanation = 2.0, another_machine = 5.0;

/// probability < least_probability: the hypothesis does not explain the data, and nothing is
/// identified by it. Of a pair of causes five times as much is asked: it is the best of some
/// hundred, which meet what they are not the cause of more often than a single cause does.
inline constexpr double least_probability = 0.01, least_probability_of_pair = 0.05;
/// BIC > unlisted_bic − over_unlisted: no better than a cause that is no candidate. There are more
/// causes than candidates: odds of 20 : 1 besides those of `same`.
inline constexpr double over_unlisted = 2.0 * same;
/// A measured frequency that is more deviations from the nominal machine's is not that machine's:
/// moved_frequencies().
inline constexpr double moved_by = 3.0;
/// Probability from which on values are those of the nominal machine; χ² beyond is 1 chance in 10.
inline constexpr double usual_frequencies = 0.1;

/// BIC of a cause that is no candidate: it moves every value of a kind by an amount of its own,
/// normally distributed about the nominal machine's with a variance that the data determine,
///
///     Σ over kinds  n (1 + ln(χ²/n)) + ln(all values)   where χ² > n, else χ²
///
/// with χ² of the nominal machine (the least over n and 1 + ln of Σ [d²/(1 + τ²) + ln(1 + τ²)], d
/// in deviations). A candidate that does not beat it by more than over_unlisted explains no
/// more than chance does.
double unlisted_bic(const Diagnosis& d);

/// 2 ln C(N, m) of a hypothesis that holds m of N causes.
double hypothesis_penalty(std::size_t causes, std::size_t held);

/// Root of the reduced misfit of the hypothesis that fits best for its number of parameters: of
/// its modes or its responses, what is worse, so that many values of one kind, well met, do not
/// hide that deviations of the other are too small. Infinite where all have as many as values.
double least_scatter(const Diagnosis& d);

/// Misfit of the responses of the hypothesis that meets them best: that of those which are compared
/// as mechanics, which says nothing about responses. 0 where none is compared with responses.
double least_response_misfit(const Diagnosis& d);

/// Scatter, criteria, order.
void rank(Diagnosis& d);

/// Finding and those that are alike. Called on ranked hypotheses.
void judge(Diagnosis& d);

/// Looks for slips in what was measured: another pose than the stated one, one wrong mode.
void find_slips(const model::MachineFile& file, dynamics::ModelKind kind, Diagnosis& d);

/// Share of a rigid shape ψ that is in a shape φ: (ψᵀ M_r φ)²/(ψᵀ M_rr ψ).
double rigid_share(const dynamics::LinearModel& flexible, const spatial::Vector6& psi,
                   const dynamics::ModelVector& phi);

/// Fills in where the measured modes come from.
void trace_modes(const model::MachineFile& file, Diagnosis& d);

/// Where a resonance that the best and another hypothesis predict differs most: one and the same
/// by its frequency and its motion.
std::optional<Discriminator> discriminate(Predictions& predictions, const Diagnosis& d,
                                          std::size_t other,
                                          const std::vector<model::NamedPose>& poses,
                                          double frequency_error);

}  // namespace hydrapod::diagnosis
