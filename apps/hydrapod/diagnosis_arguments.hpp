#pragma once
/// What `hydrapod diagnose` and `hydrapod report --measured` share.

#include <string>
#include <vector>

#include "hydrapod/diagnosis/summary.hpp"
#include "hydrapod/machine_arguments.hpp"

namespace hydrapod::cli {

struct DiagnosisArguments {
  std::vector<std::string> measured{};
  std::string against{"auto"};  ///< the system that was measured
  std::string want{"2 %"};
  std::string poses{};
  diagnosis::DiagnoseOptions options{};
};

/// "2 %", "drop 2 %", "5.2 Hz", "x=5.2 Hz", "x=3 %". Throws base::InputError.
diagnosis::RemedyGoal remedy_goal(const std::string& text);

/// "--want", "--poses" and the errors of the model.
void add_diagnosis_options(Command command, DiagnosisArguments& arguments);

/// The measured mode that comes most from what gives way beside the oil, as number of the
/// explaining machine's mode, from 1; 0 where there is none at that pose.
int guilty_mode(const diagnosis::Diagnosis& found, const std::string& pose);

/// The whole investigation, with progress and Ctrl-C. Throws base::InputError and
/// base::ComputationError.
diagnosis::CaseFile investigate(const DiagnosisArguments& arguments, const MachineArguments& asked,
                                tasks::Machine machine);

}  // namespace hydrapod::cli
