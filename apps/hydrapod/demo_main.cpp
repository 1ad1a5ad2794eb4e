/// The program hydrapod-demo: `hydrapod demo` alone, which needs a third of the library. ./hydrapod
/// builds it first in a fresh clone. Exit codes: 0 done, 1 a computation failed, 2 no such folder.

#include <csignal>
#include <exception>

#include "hydrapod/base/error.hpp"
#include "hydrapod/demo_files.hpp"
#include "hydrapod/terminal.hpp"

int main(int argc, char** argv) {
  using namespace hydrapod;
  std::signal(SIGPIPE, SIG_DFL);  // `hydrapod demo | head` ends quietly
  try {
    cli::write_demo(argc > 1 ? argv[1] : cli::demo_folder);
    return cli::close_output() ? 0 : 1;
  } catch (const base::InputError& error) {
    cli::print_diagnostics(error.diagnostics());
    return 2;
  } catch (const std::exception& error) {
    cli::print_error(error.what());
    return 1;
  }
}
