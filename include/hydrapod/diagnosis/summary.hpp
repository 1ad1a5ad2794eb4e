#pragma once
/// A diagnosis in plain words with numbers behind each.

#include <optional>

#include "hydrapod/diagnosis/attribution.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/diagnosis/remedy.hpp"

namespace hydrapod::diagnosis {

/// All that `hydrapod diagnose` finds out. Attribution and remedy are of the machine that explains
/// the measurement best, of the machine as stated where nothing was measured.
struct CaseFile {
  std::optional<Diagnosis> diagnosis{};
  model::Machine machine{};  ///< the one that attribution and remedy are of
  dynamics::ModelKind kind{};
  std::string pose{};  ///< of the attribution
  std::vector<AttributedDrop> drops{};
  RemedyGoal goal{};
  std::optional<Remedy> remedy{};
};

/// The finding in one sentence: "guide sleeves of all legs: stiffness 0.841 ± 0.012 MN/m instead of
/// 30 MN/m".
std::string finding_sentence(const Diagnosis& diagnosis);

/// Sentences, most important first.
std::vector<std::string> summary(const CaseFile& file);

/// What an explanation's numbers are, and were in the file: "legs.guide_sleeve.stiffness 0.841 ±
/// 0.012 MN/m (stated 30 MN/m)".
std::vector<std::string> parameter_words(const Explanation& explanation);

/// "a drop of at most 2 %", "at least 5.2 Hz in x".
std::string goal_words(const RemedyGoal& goal);

}  // namespace hydrapod::diagnosis
