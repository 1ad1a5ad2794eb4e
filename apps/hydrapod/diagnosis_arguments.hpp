#pragma once
/// What `hydrapod diagnose` and `hydrapod report --diagnose` share.

#include <string>
#include <vector>

#include "hydrapod/options.hpp"
#include "hydrapod/tasks/fit.hpp"

namespace hydrapod::cli {

struct DiagnosisArguments {
  std::vector<std::string> measured{};
  std::string against{"auto"};  ///< the system that was measured
  std::string want{"2 %"};
  std::string poses{};
  diagnosis::DiagnoseOptions options{};
};

/// "--want", "--poses" and the errors of the model.
void add_diagnosis_options(Command command, DiagnosisArguments& arguments);

/// Throws base::InputError.
tasks::DiagnoseOptions diagnose_options(const DiagnosisArguments& arguments,
                                        const model::Machine& machine);

}  // namespace hydrapod::cli
