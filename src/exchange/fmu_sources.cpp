/// The sources in an FMU, and how they become its shared object.

#include <fmt/format.h>

#include <filesystem>

#include "fmu_description.hpp"
#include "hydrapod/base/file.hpp"

namespace hydrapod::exchange {

namespace fs = std::filesystem;

bool is_compiled(std::string_view name) { return name.ends_with(".cpp"); }

std::string fmu_build_description(const FmuContent& fmu) {
  std::string files;
  for (const auto& [name, text] : fmu.sources)
    if (is_compiled(name)) files += fmt::format("      <SourceFile name=\"{}\"/>\n", escaped(name));
  std::string libraries;
  for (const char* name : {"sundials_arkode", "sundials_cvode", "sundials_nvecserial"})
    libraries += fmt::format(
        "    <Library name=\"{}\" version=\"&gt;=6.4,&lt;7\" external=\"true\" "
        "description=\"SUNDIALS\"/>\n",
        name);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n"
      "  <BuildConfiguration modelIdentifier=\"{}\" description=\"Needs the headers of Eigen 3.4, "
      "fmt 9, JSON for Modern C++ 3.11, toml++ 3.3 and SUNDIALS 6.4. Of the symbols only those "
      "that begin with "
      "fmi need be shown.\">\n    <SourceFileSet language=\"C++20\">\n{}"
      "      <PreprocessorDefinition name=\"EIGEN_MAX_ALIGN_BYTES\" value=\"16\"/>\n"
      "      <PreprocessorDefinition name=\"FMT_HEADER_ONLY\"/>\n"
      "      <IncludeDirectory name=\".\"/>\n"
      "    </SourceFileSet>\n{}  </BuildConfiguration>\n</fmiBuildDescription>\n",
      fmu.identifier, files, libraries);
}

FmuSources fmu_sources(const std::string& object_file) {
  const fs::path root = fs::path(object_file).parent_path() / "fmu_sources";
  FmuSources sources;
  std::error_code none;
  if (object_file.empty() || !fs::is_directory(root, none)) return sources;
  constexpr std::size_t largest = 1U << 22U;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.is_regular_file())
      sources[fs::relative(entry.path(), root).generic_string()] =
          base::read_file(entry.path().string(), largest, "a source file of FMUs");
  return sources;
}

}  // namespace hydrapod::exchange
