/// Any bytes as a machine file, with overrides: an InputError or a machine that validate() accepts.
///
/// The input is the file. Lines that begin with "#!" are taken as overrides besides (they are
/// comments of the file), so that one input exercises both and the corpus stays readable.

#include <sstream>
#include <vector>

#include "fuzz.hpp"
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydrapod;
  const std::string text = fuzz::text_of(data, size);
  fuzz::accepted([&] {
    const auto file = model::parse_machine(text, "fuzz.toml", overrides_in(text));
    for (const auto& finding : model::validate(file.machine))
      if (finding.severity == base::Severity::error) std::abort();
    for (const auto& warning : file.warnings) fuzz::require_presentable(warning);
  });
  return 0;
}
