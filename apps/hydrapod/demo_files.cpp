#include "hydrapod/demo_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Text of models/`name`, carried inside the program (embedded_models.cpp.in). Throws
/// std::out_of_range for a file that was not there when it was built.
std::string_view embedded_model(std::string_view name);

namespace {

struct Case {
  const char* file;      ///< in models/, copied into the folder
  const char* stem;      ///< of the pictures
  const char* headline;  ///< what it shows
  std::vector<std::string> overrides{};
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"zhang-jiang-2021.toml", "published",
       "1. The published machine as in the paper's Table 2 (without gravity)"},
      {"zhang-jiang-2021-transverse.toml",
       "published-with-gravity",
       "2. The same machine under its own weight, which the paper leaves out",
       {"environment.gravity=9.81"}},
      {"heavy-platform.toml", "heavy",
       "3. A heavy machine whose seals add modes in x and y a third below those of rigid legs"}};
  return list;
}

std::string path_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

/// The report, with every pose of the file. A program built without the page goes on without it.
void write_report(const Case& the_case, const tasks::Machine& machine, const std::string& folder) {
  try {
    base::write_file_whole(path_in(folder, fmt::format("report-{}.html", the_case.stem)),
                           report::html_report(machine.file, machine.path,
                                               machine.file.machine.poses, {.kind = machine.kind}));
  } catch (const base::ComputationError& error) {
    print_note(fmt::format("no report for {}: {}", the_case.file, error.what()));
  }
}

/// Modes on the terminal; the Bode diagram and the report as files.
void show(const Case& the_case, const std::string& folder) {
  const auto style = table_style("-");
  const std::string path = path_in(folder, the_case.file);
  const std::string text(embedded_model(the_case.file));
  base::write_file_whole(path, text);
  const auto machine =
      tasks::read_machine({.file = path, .text = text, .overrides = the_case.overrides});
  const auto bode = tasks::bode(machine);
  fmt::print("{}\n\n{}\n{}\n{}\n", styled(the_case.headline, Style::cyan, style.colour),
             heading(machine, style), mode_text(bode.table, nullptr, style),
             report::answer_text(bode.table));
  const std::vector<report::Entry> direct{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}};
  for (const char* ending : {".svg", ".png"})
    report::plot_bode(bode, direct, plot_text(machine, bode),
                      path_in(folder, fmt::format("bode-{}{}", the_case.stem, ending)));
  base::write_file_whole(path_in(folder, fmt::format("bode-{}.csv", the_case.stem)),
                         report::bode_csv(bode));
  write_report(the_case, machine, folder);
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder))
    throw base::InputError(
        {{.file = folder, .message = "cannot make a folder here: " + error.message()}});
}

void list_files(const std::string& folder) {
  fmt::print("Files in {}:\n", folder);
  for (const auto& the_case : cases())
    fmt::print("  {0:<34} report-{1}.html, bode-{1}.svg, .png, .csv\n", the_case.file,
               the_case.stem);
  fmt::print("\nOpen a report in a browser: moving modes, interactive Bode diagrams.\n");
  fmt::print("Next: `hydrapod init` writes a machine file to fill in with your own machine.\n");
}

}  // namespace

void write_demo(const std::string& folder) {
  make_folder(folder);
  // the program that a fresh clone builds first knows no commit, and its pictures are the same
  report::state_in_pictures([] {
    return fmt::format("made by: hydrapod demo\nwritten by hydrapod {}\n", base::version);
  });
  for (const auto& the_case : cases()) show(the_case, folder);
  list_files(folder);
}

}  // namespace hydrapod::cli
