/// Any bytes as a machine file, with overrides: an InputError or a machine that validate() accepts.
///
/// The input is the file. Lines that begin with "#!" are taken as overrides besides (they are
/// comments of the file), so that one input exercises both and the corpus stays readable.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "hydrapod/base/text.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace {

std::vector<std::string> overrides_in(const std::string& text) {
  std::vector<std::string> overrides;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && overrides.size() < 8;) {
    if (line.starts_with("#!")) overrides.push_back(line.substr(2));
  }
  return overrides;
}

/// What every diagnostic promises to those who show it.
void require_presentable(const hydrapod::base::Diagnostic& diagnostic) {
  const std::string text = diagnostic.text();
  const bool one_line = text.find('\n') == std::string::npos;
  const bool utf8 = hydrapod::base::first_invalid_utf8(text) == std::string::npos;
  if (!one_line || !utf8 || diagnostic.message.empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const auto file = hydrapod::model::parse_machine(text, "fuzz.toml", overrides_in(text));
    if (!hydrapod::model::validate(file.machine).empty()) std::abort();
    for (const auto& warning : file.warnings) require_presentable(warning);
  } catch (const hydrapod::base::InputError& error) {
    if (error.diagnostics().empty()) std::abort();
    for (const auto& diagnostic : error.diagnostics()) require_presentable(diagnostic);
  }
  return 0;
}
