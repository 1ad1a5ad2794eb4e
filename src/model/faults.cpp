#include "hydrapod/model/section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace hydrapod::model {

namespace {
constexpr std::size_t most_faults = 100;
}

void Faults::add(const Place& place, std::string key, std::string message,
                 base::Severity severity) {
  base::Diagnostic diagnostic{severity,       sources_.at(static_cast<std::size_t>(place.source)),
                              place.line,     place.column,
                              std::move(key), std::move(message)};
  const auto same = [&](const Fault& known) {
    return std::tie(known.diagnostic.file, known.diagnostic.line, known.diagnostic.column,
                    known.diagnostic.key, known.diagnostic.message) ==
           std::tie(diagnostic.file, diagnostic.line, diagnostic.column, diagnostic.key,
                    diagnostic.message);
  };
  if (std::any_of(faults_.begin(), faults_.end(), same)) return;
  if (severity == base::Severity::error) ++errors_;
  if (faults_.size() < most_faults) {
    faults_.push_back({place, std::move(diagnostic)});
  } else {
    ++not_kept_;
  }
}

std::vector<base::Diagnostic> Faults::diagnostics(base::Severity severity) const {
  std::vector<Fault> sorted = faults_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Fault& a, const Fault& b) {
    return std::tie(a.place.source, a.place.line, a.place.column) <
           std::tie(b.place.source, b.place.line, b.place.column);
  });
  std::vector<base::Diagnostic> diagnostics;
  for (auto& fault : sorted) {
    if (fault.diagnostic.severity == severity) diagnostics.push_back(std::move(fault.diagnostic));
  }
  if (not_kept_ > 0 && severity == base::Severity::error) {
    diagnostics.push_back(
        {severity, sources_.front(), 0, 0, "", fmt::format("and {} more errors", not_kept_)});
  }
  return diagnostics;
}

}  // namespace hydrapod::model
