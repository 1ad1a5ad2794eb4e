#include "hydrapod/command.hpp"

#include <filesystem>

#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::cli {

namespace {
struct Arguments {
  std::string file{"machine.toml"};
  bool force{};
  bool reference{};
};

void run(const Arguments& arguments) {
  if (arguments.reference) return fmt::print("{}", model::parameter_reference());
  std::error_code ignored;
  if (!arguments.force && arguments.file != "-" &&
      std::filesystem::is_regular_file(arguments.file, ignored)) {
    throw base::InputError(
        {{.file = arguments.file,
          .message = "the file exists and was left as it is; choose another name, "
                     "or --force to replace it"}});
  }
  base::write_file_whole(arguments.file, model::starter_machine_file());
  if (arguments.file == "-") return;
  print_note(fmt::format("wrote {0}; next: hydrapod check {0}", arguments.file));
}
}  // namespace

void add_init(Command app) {
  Command command = app.add_command("init", "Write a commented machine file to start from",
                                    {{"init", "writes machine.toml"},
                                     {"init simulator.toml --force", "replaces simulator.toml"},
                                     {"init -", "prints it"},
                                     {"init --reference", "prints tables of all keys"}});
  auto& arguments = command.calls(&run);
  command.add_options({{"FILE", arguments.file, "File to write; - prints"},
                       {"--force", arguments.force, "Replace the file if it exists"},
                       {"--reference", arguments.reference,
                        "Print the tables of all keys in Markdown, and write no file"}});
}

}  // namespace hydrapod::cli
