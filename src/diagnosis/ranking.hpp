#pragma once
/// Ranks hypotheses, passes judgement, and looks closer at the best one. Private to the module.

#include <optional>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "predictions.hpp"

namespace hydrapod::diagnosis {

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
