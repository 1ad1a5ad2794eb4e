#include "gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

/// As a word of the shell.
std::string shell_word(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string terminal_of(const std::string& path, int width, int height) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const std::string font = "font 'Helvetica,11'";
  if (ending == ".svg")
    return fmt::format("svg size {},{} dynamic background rgb 'white' {} enhanced", width, height,
                       font);
  if (ending == ".png") return fmt::format("pngcairo size {},{} {}", width, height, font);
  if (ending == ".pdf")
    return fmt::format("pdfcairo size {:.2f}in,{:.2f}in {}", width / 96.0, height / 96.0, font);
  throw base::InputError(
      {{.file = "--plot " + path,
        .message = fmt::format("a plot ends in .svg, .png or .pdf; found '{}'", ending)}});
}

std::string file_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A folder of its own that is gone at the end.
struct TemporaryFolder {
  std::filesystem::path path;
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "hydrapod-plot-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw base::ComputationError("no temporary folder for the plot could be made in " +
                                   std::filesystem::temp_directory_path().string());
    path = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

void run_gnuplot(const std::filesystem::path& script, const std::filesystem::path& log) {
  const std::string command = fmt::format("gnuplot {} > {} 2>&1 < /dev/null",
                                          shell_word(script.string()), shell_word(log.string()));
  const int status = std::system(command.c_str());
  if (status == 0) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw base::ComputationError("plots need the program gnuplot; install the package gnuplot-nox");
  std::string said = file_text(log);
  said.erase(said.find_last_not_of(" \n") + 1);
  throw base::ComputationError("gnuplot failed: " + said);
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? ' ' : c;
  }
  return out + "'";
}

void require_picture_ending(const std::string& path) { terminal_of(path, 1, 1); }

void draw(const std::string& path, int width, int height, const Script& script) {
  const std::string terminal = terminal_of(path, width, height);
  const TemporaryFolder folder;
  const auto picture = folder.path / "picture";
  const auto file = folder.path / "plot.gp";
  base::write_file_whole(file.string(), script(terminal, picture.string()));
  run_gnuplot(file, folder.path / "log");
  base::write_file_whole(path, file_text(picture));
}

}  // namespace hydrapod::report
