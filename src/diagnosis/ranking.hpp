#pragma once
/// Ranks explanations, passes judgement, and looks closer at the best one. Private to the module.

#include <optional>

#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis {

/// 2 ln C(N, m).
double hypothesis_penalty(std::size_t suspects, std::size_t blamed);

/// Scatter, criteria, order.
void rank(Diagnosis& d);

/// Finding and those that are alike. Called on ranked explanations.
void judge(Diagnosis& d);

/// Reasons why even the best explanation is none.
std::vector<std::string> unexplained(const Diagnosis& d);

/// Fills in where the measured modes come from.
void trace_modes(const model::MachineFile& file, Diagnosis& d);

/// Where the resonances that the best and another explanation predict differ most.
std::optional<Discriminator> discriminate(const model::MachineFile& file, const Diagnosis& d,
                                          std::size_t other,
                                          const std::vector<model::NamedPose>& poses,
                                          double frequency_error);

}  // namespace hydrapod::diagnosis
