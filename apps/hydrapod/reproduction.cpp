#include "hydrapod/reproduction.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod_commit.hpp"

namespace hydrapod::cli {

namespace {

/// What changes when a file does.
struct FileState {
  std::int64_t bytes{}, seconds{}, nanoseconds{};
  std::uint64_t device{}, node{};

  friend bool operator==(const FileState&, const FileState&) = default;
};

std::optional<FileState> state_of(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return FileState{.bytes = found.st_size,
                   .seconds = found.st_mtim.tv_sec,
                   .nanoseconds = found.st_mtim.tv_nsec,
                   .device = found.st_dev,
                   .node = found.st_ino};
}

struct Input {
  std::string option, path;
  std::optional<FileState> state;
  std::string sum{};  ///< SHA-256, once it was formed: each output states it
};

std::vector<std::string> whole;
std::vector<Input> inputs;

std::string date_text() {
  std::int64_t seconds = std::time(nullptr);
  // https://reproducible-builds.org/specs/source-date-epoch/
  if (const char* const asked = std::getenv("SOURCE_DATE_EPOCH")) {
    const std::string_view text = asked;
    std::int64_t value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    constexpr std::int64_t last = 253402300799;  // of the year 9999
    if (status == std::errc() && end == text.data() + text.size() && value >= 0 && value <= last)
      seconds = value;
  }
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(seconds)));
}

report::Json input_json(Input& input) {
  report::Json json{{"option", input.option}, {"path", input.path}};
  json["bytes"] = input.state ? report::Json(input.state->bytes) : report::Json();
  json["sha256"] = nullptr;
  try {
    if (input.sum.empty()) input.sum = sha256_of_file(input.path);
    if (input.state && state_of(input.path) == input.state) json["sha256"] = input.sum;
  } catch (const base::InputError&) {  // removed since
  }
  return json;
}

}  // namespace

void set_command_line(int argc, const char* const* argv) {
  if (argc > 1) whole.assign(argv + 1, argv + argc);
}

tasks::Origin record_origin() {
  tasks::Origin origin{.program = program_text(), .command = whole};
  for (auto& input : inputs)
    if (const auto json = input_json(input); json["sha256"].is_string())
      origin.inputs.push_back({input.path, json["sha256"].get<std::string>()});
  return origin;
}

const std::string& program_text() {
  static const std::string text =
      *commit == '\0' ? fmt::format("hydrapod {}", base::version)
                      : fmt::format("hydrapod {}, commit {}", base::version, commit);
  return text;
}

void note_input(const std::string& option, const std::string& path) {
  inputs.push_back({option, path, state_of(path)});
}

report::Json reproduction() {
  report::Json json{{"program", "hydrapod"},
                    {"version", base::version},
                    {"commit", *commit == '\0' ? report::Json() : report::Json(commit)},
                    {"date", date_text()},
                    {"command", whole},
                    {"inputs", report::Json::array()}};
  for (auto& input : inputs) json["inputs"].push_back(input_json(input));
  return json;
}

std::string shell_text(const std::vector<std::string>& arguments) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+%@-";
  std::string text = "hydrapod";
  for (const auto& argument : arguments) {
    if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) {
      text += " " + argument;
      continue;
    }
    text += " '";
    for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += "'";
  }
  return text;
}

std::string reproduction_text() {
  std::string text = fmt::format("made on {} by: {}\n", date_text(), shell_text(whole));
  for (const auto& [path, sum] : record_origin().inputs)
    text += fmt::format("read {}: sha256 {}\n", path, sum);
  return text;
}

std::string origin_text() {
  return fmt::format("{}\nwritten by {}\n", reproduction_text(), program_text());
}

std::string sha256_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) base::refuse(path, "cannot be read");
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest(EVP_MD_CTX_new(),
                                                                  &EVP_MD_CTX_free);
  if (!digest || EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not available");
  std::vector<char> block(std::size_t{1} << 20U);
  do {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    EVP_DigestUpdate(digest.get(), block.data(), static_cast<std::size_t>(file.gcount()));
  } while (file);
  if (file.bad()) base::refuse(path, "cannot be read");
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
  unsigned int length = 0;
  EVP_DigestFinal_ex(digest.get(), sum.data(), &length);
  std::string text;
  for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", sum[i]);
  return text;
}

}  // namespace hydrapod::cli
