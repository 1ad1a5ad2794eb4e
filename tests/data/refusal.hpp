#pragma once
/// What is said of a file that must be refused.

#include "hydrapod/base/error.hpp"

namespace hydrapod::test {

/// The last thing that `call` says; nothing where it is not refused.
template <class Call>
base::Diagnostic refusal_of(const Call& call) {
  try {
    call();
    return {};
  } catch (const base::InputError& error) {
    return error.diagnostics().back();
  }
}

}  // namespace hydrapod::test
