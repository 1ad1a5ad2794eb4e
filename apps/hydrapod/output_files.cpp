#include "hydrapod/output_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/reproduction.hpp"
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

/// What a known ending says of the contents: a word of --format, or the ending itself.
std::string contents_of_ending(const std::string& output) {
  struct Ending {
    std::string_view ending, contents;
  };
  constexpr std::array known{
      Ending{".json", "json"}, Ending{".csv", "csv"},    Ending{".txt", "table"},
      Ending{".uff", "uff"},   Ending{".unv", "uff"},    Ending{".uf", "uff"},
      Ending{".mat", "mat"},   Ending{".h5", "h5"},      Ending{".hdf5", "h5"},
      Ending{".rpc", ".rpc"},  Ending{".rsp", ".rpc"},   Ending{".drv", ".rpc"},
      Ending{".tim", ".rpc"},  Ending{".toml", ".toml"}, Ending{".html", ".html"},
      Ending{".htm", ".html"}, Ending{".svg", ".svg"},   Ending{".png", ".png"},
      Ending{".pdf", ".pdf"},  Ending{".xlsx", ".xlsx"}, Ending{".npz", "npz"},
      Ending{".npy", "npy"}};
  const std::string ending = base::lower_case(fs::path(output).extension().string());
  const auto at = std::ranges::find(known, ending, &Ending::ending);
  return at == known.end() ? std::string() : std::string(at->contents);
}

/// The end of a table in a file.
constexpr std::string_view signature = "written by hydrapod ";

/// The beginning of a file and its end, of long files without what is between.
std::string seen_of(const std::string& path) {
  constexpr std::uintmax_t most = 65536;
  const auto size = fs::file_size(path);
  std::ifstream file(path, std::ios::binary);
  std::string text(std::min(size, 2 * most), '\0');
  const auto begin = static_cast<std::streamsize>(text.size() - text.size() / 2);
  file.read(text.data(), begin);
  const auto rest = static_cast<std::streamsize>(text.size()) - begin;
  file.seekg(-static_cast<std::streamoff>(rest), std::ios::end);
  file.read(text.data() + begin, rest);
  return text;
}

/// Titles of the tables that are written as CSV, or what stands above them.
bool has_own_titles(std::string_view text) {
  constexpr std::array<std::string_view, 9> titles{"frequency_hz,omega_rad_s,",
                                                   "mode,omega_rad_s,frequency_hz,",
                                                   "mode,frequency_hz,frequency_95_hz,",
                                                   "mode,direction,amplitude_m,",
                                                   "followed,pose,mode,",
                                                   "thing,mode_first,",
                                                   "re_1_s,im_1_s,omega_rad_s,",
                                                   "value,re_1_s,im_1_s,omega_rad_s,",
                                                   "# hydrapod "};
  constexpr std::string_view rows_of_a_study = ",lowest [Hz],";
  return std::ranges::any_of(titles, [&](auto title) { return text.starts_with(title); }) ||
         text.substr(0, text.find('\n')).find(rows_of_a_study) != text.npos;
}

bool has_signature(std::string_view text) {
  const auto end = text.find_last_not_of("\r\n");
  if (end == text.npos) return false;
  const auto begin = text.rfind('\n', end);
  return text.substr(begin == text.npos ? 0 : begin + 1).starts_with(signature);
}

bool is_number(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

/// Results for Dakota: values with their labels, gradients in brackets, or a failure.
bool is_evaluation(std::string_view text) {
  const auto lines = base::split(base::trimmed(text), "\n");
  return std::ranges::all_of(lines, [](std::string_view line) {
    const auto words = base::split(base::trimmed(line), " ");
    if (words.size() == 1) return words[0] == "FAIL";
    if (words.front() != "[")
      return words.size() == 2 && is_number(words[0]) && !is_number(words[1]);
    return words.back() == "]" && std::all_of(words.begin() + 1, words.end() - 1, is_number);
  });
}

/// Whether the file says that hydrapod wrote it. Prose that only speaks of hydrapod does not.
bool is_own_result(std::string_view text) {
  const std::string_view begin = base::trimmed(text.substr(0, 256));
  if (begin.starts_with('{')) {
    const bool has_kind = base::trimmed(begin.substr(1)).starts_with("\"kind\"");
    return has_kind || text.find("\"reproduction\"") != text.npos;
  }
  // markup, Matrix Market, Nastran, Universal Files, and what is no text
  const bool of_programs = begin.starts_with('<') || begin.starts_with('%') ||
                           begin.starts_with('$') || begin.starts_with("-1") ||
                           text.find('\0') != text.npos;
  if (of_programs) return text.find("hydrapod") != text.npos;
  return has_own_titles(text) || has_signature(text) || is_evaluation(text);
}

/// Pictures have nobody's name in them. What is no text is not judged: its contents are known by
/// data::file_kind(), or by nobody.
bool is_kept_text(const std::string& path, std::string_view text) {
  const auto contents = contents_of_ending(path);
  const bool picture = contents == ".svg" || contents == ".png" || contents == ".pdf";
  return !picture && text.find('\0') == text.npos && !is_own_result(text);
}

/// What must not be lost: a record, a machine file or study, and what others wrote: measured
/// responses and modes, and any text. None: anything else.
std::optional<const char*> kept_kind(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) == 0) return {};
  if (path.ends_with(".toml")) return "machine file or study";
  const std::string text = seen_of(path);
  const bool own = is_own_result(text);
  try {
    switch (data::file_kind(path)) {
      case data::FileKind::record: {
        const data::RecordSet record({path});
        return "record";
      }
      case data::FileKind::frequency_responses:
        if (!own) return "file of frequency responses";
        break;
      case data::FileKind::mode_table:
      case data::FileKind::modal_results:
        if (!own) return "file of modes";
        break;
      default:
        break;
    }
  } catch (const base::InputError&) {  // of no kind that is known
  }
  if (is_kept_text(path, text)) return "text that hydrapod did not write";
  return {};
}

std::optional<const char*> existing_file(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) ? std::optional("file") : std::nullopt;
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

std::optional<std::string> input_file(const std::string& text) {
  std::error_code ignored;
  const auto is_there = [&](const std::string& path) { return fs::is_regular_file(path, ignored); };
  if (is_there(text)) return text;
  if (const auto at = text.rfind('@'); at != text.npos && is_there(text.substr(0, at)))
    return text.substr(0, at);
  constexpr std::string_view signal = "file";
  std::string_view rest = base::trimmed(text);
  if (!rest.starts_with(signal)) return {};
  rest = base::trimmed(rest.substr(signal.size()));
  if (rest.starts_with(',')) rest = base::trimmed(rest.substr(1));
  for (const std::string path : {std::string(rest), std::string(rest.substr(0, rest.find(',')))})
    if (is_there(path)) return path;
  return {};
}

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
    if (const auto kind =
            output.existing == Existing::kept ? existing_file(output.path) : kept_kind(output.path))
      fault(output, fmt::format("a {} exists there and was left as it is; choose another name, or "
                                "--force to replace it",
                                *kind));
  }
  if (!faults.empty()) throw base::InputError(faults);
  for (const auto& output : outputs) {
    std::error_code ignored;
    if (!force && is_file_name(output.path) && !fs::exists(output.path, ignored))
      base::expect_no_file(output.path,
                           [kept = output.existing == Existing::kept](const std::string& path) {
                             return kept || kept_kind(path).has_value();
                           });
  }
}

std::size_t result_format(const std::string& format, const std::string& output,
                          const std::vector<std::string_view>& words) {
  const std::string contents = contents_of_ending(output);
  const bool fits = std::ranges::find(words, contents) != words.end();
  const std::string word = !format.empty()             ? format
                           : fits && !contents.empty() ? contents
                                                       : std::string(words[0]);
  const auto chosen = choose_word("--format", word, words);
  if (output == "-" && (word == "uff" || word == "mat" || word == "h5"))
    base::refuse("--format " + word, "this format needs a file name: add -o FILE." + word);
  const std::string ending = fs::path(output).extension().string();
  if (!contents.empty() && !fits)
    base::refuse(output,
                 fmt::format("the ending '{}' does not fit the content: this command writes "
                             "{} ('table' as .txt or without ending)",
                             ending, fmt::join(words, ", ")));
  if (!contents.empty() && contents != word)
    base::refuse(output, fmt::format("the ending '{}' does not fit --format {}", ending, word));
  return chosen;
}

void require_ending(const std::string& option, const std::string& output,
                    std::string_view accepted) {
  const auto contents = contents_of_ending(output);
  if (!contents.empty() && contents != accepted)
    base::refuse(output, fmt::format("the ending '{}' does not fit the content: {} writes {}",
                                     fs::path(output).extension().string(), option, accepted));
}

void write_output(const std::string& path, const std::string& text) {
  base::write_file_whole(path, text);
  if (path != "-") print_written(path);
}

void write_result(const std::string& path, std::size_t format, const std::string& text) {
  if (format != 0) return write_output(path, text);
  write_output(path, without_commands(path == "-" ? text : text + "\n" + origin_text()));
}

}  // namespace hydrapod::cli
