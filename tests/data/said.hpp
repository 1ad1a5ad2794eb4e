#pragma once
/// What readers say of a file.

#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"

namespace hydrapod::test {

inline std::vector<std::string> messages(const std::vector<base::Diagnostic>& notes) {
  std::vector<std::string> list;
  for (const auto& note : notes) list.push_back(note.message);
  return list;
}

/// The last thing that is said where `read` is refused; nothing where it is not.
template <class Read>
base::Diagnostic refusal_of(const Read& read) {
  try {
    read();
    return {};
  } catch (const base::InputError& error) {
    return error.diagnostics().back();
  }
}

}  // namespace hydrapod::test
