#include "hydrapod/command.hpp"
#include "hydrapod/demo_files.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  std::string folder{demo_folder};
};

void run(const Arguments& arguments) { write_demo(arguments.folder); }

}  // namespace

void add_demo(Command app) {
  Command command = app.add_command(
      "demo",
      "The published machine: its modes on the terminal, Bode diagrams and reports as files",
      {{"demo", "writes into the folder hydrapod-demo"},
       {"demo results", "writes into the folder results"}});
  auto& arguments = command.calls(&run);
  command.add_options(
      {{"FOLDER", arguments.folder, "Folder for the files; made if it is not there"}});
}

}  // namespace hydrapod::cli
