#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace hydrapod::base {

std::string Diagnostic::text() const {
  std::string where = file;
  if (line > 0) where += fmt::format(":{}:{}", line, column);
  if (!where.empty()) where += ": ";
  where += severity == Severity::error ? "error: " : "warning: ";
  if (!key.empty()) where += key + ": ";
  return where + message;
}

namespace {
std::string joined(const std::vector<Diagnostic>& diagnostics) {
  std::string all;
  for (const auto& diagnostic : diagnostics) {
    if (!all.empty()) all += '\n';
    all += diagnostic.text();
  }
  return all;
}
}  // namespace

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(joined(diagnostics)), diagnostics_(std::move(diagnostics)) {}

void refuse(const std::string& where, const std::string& message) {
  throw InputError({{.file = where, .message = message}});
}

}  // namespace hydrapod::base
