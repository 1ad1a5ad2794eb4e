#include "hydrapod/output_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {
namespace fs = std::filesystem;

bool is_file_name(const std::string& path) { return !path.empty() && path != "-"; }

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto place = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(path), ignored);
  };
  return fs::equivalent(a, b, ignored) || place(a) == place(b);
}

/// The file that an input names: `run.h5`, `run.h5@low`, `file run.csv, hold=1`.
std::optional<std::string> input_file(const std::string& text) {
  std::error_code ignored;
  const auto is_there = [&](const std::string& path) { return fs::is_regular_file(path, ignored); };
  constexpr std::string_view signal = "file ";
  if (is_there(text)) return text;
  if (const auto at = text.rfind('@'); at != text.npos && is_there(text.substr(0, at)))
    return text.substr(0, at);
  if (!text.starts_with(signal)) return {};
  const std::string path = text.substr(signal.size(), text.find(',') - signal.size());
  return is_there(path) ? std::optional(path) : std::nullopt;
}

/// What must not be lost: "record" or "machine file or study". None: anything else.
std::optional<const char*> kept_kind(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) == 0) return {};
  if (path.ends_with(".toml")) return "machine file or study";
  try {
    if (data::file_kind(path) != data::FileKind::record) return {};
    const data::RecordSet record({path});
    return "record";
  } catch (const base::InputError&) {
    return {};
  }
}

std::optional<std::string> why_not_writable(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return "it is a folder";
  const auto target = fs::weakly_canonical(path, ignored);
  const auto folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored))
    return fmt::format("there is no folder '{}'", fs::path(path).parent_path().string());
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored)) return {};  // a pipe
  if (::access(folder.c_str(), W_OK) != 0 ||
      (fs::exists(target, ignored) && ::access(target.c_str(), W_OK) != 0))
    return std::string(std::strerror(errno));
  return {};
}

}  // namespace

void check_outputs(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs,
                   bool force) {
  std::vector<base::Diagnostic> faults;
  const auto fault = [&](const NamedFile& file, std::string message) {
    faults.push_back({.file = file.path, .message = std::move(message)});
  };
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto& output = outputs[k];
    if (!is_file_name(output.path)) continue;
    if (const auto why = why_not_writable(output.path)) {
      fault(output, "cannot write the file: " + *why);
      continue;
    }
    bool is_input = false;
    for (const auto& input : inputs)
      if (const auto file = input_file(input.path); file && same_file(*file, output.path)) {
        fault(output, fmt::format("the file is the input {} of this command and was left as it is; "
                                  "choose another name",
                                  input.option));
        is_input = true;
        break;
      }
    for (std::size_t other = 0; other < k; ++other)
      if (is_file_name(outputs[other].path) && same_file(outputs[other].path, output.path))
        fault(output,
              fmt::format("{} writes the same file; choose another name", outputs[other].option));
    if (is_input || force) continue;
    if (const auto kind = kept_kind(output.path))
      fault(output, fmt::format("a {} exists there and was left as it is; choose another name, or "
                                "--force to replace it",
                                *kind));
  }
  if (!faults.empty()) throw base::InputError(faults);
}

void write_output(const std::string& path, const std::string& text) {
  base::write_file_whole(path, text);
  if (path != "-") print_written(path);
}

}  // namespace hydrapod::cli
