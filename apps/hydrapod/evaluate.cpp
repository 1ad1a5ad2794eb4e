/// `hydrapod evaluate`: one evaluation by Dakota's files.

#include "hydrapod/command.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/study/study.hpp"
#include "hydrapod/tasks/study.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  tasks::EvaluateOptions options{};
  std::string results{};
};

void run(const Arguments& arguments) {
  const auto machine = load(arguments.machine);
  const auto done = tasks::evaluate(machine, arguments.options);
  base::write_file_whole(arguments.results, done.text);
  const std::string which = done.id.empty() ? "" : fmt::format("evaluation {}: ", done.id);
  if (!done.failure.empty()) print_warning(which + done.failure + "; the results file says FAIL");
  if (done.failure.empty() && !done.frequencies.empty())
    print_note(fmt::format("{}frequencies of {} modes: {}", which,
                           study::frequency_kind(machine.file.machine),
                           fmt::join(done.frequencies, ", ")));
  if (!done.by_differences.empty())
    print_note(
        fmt::format("{}gradients by central differences: {}; others are derivatives of "
                    "modes",
                    which, fmt::join(done.by_differences, ", ")));
}

}  // namespace

void add_evaluate(Command app) {
  Command command = app.add_command(
      "evaluate", "One evaluation by Dakota's files: parameters in, results out",
      {{"evaluate --machine machine.toml --variable \"k=legs.guide_sleeve.stiffness [kN/mm]\" "
        "--function x params.in results.out",
        "as Dakota calls it; without the options variables are paths in SI, functions outputs"}},
      study_frequencies);
  auto& arguments = command.calls(&run);
  command.add_options(
      {{"PARAMETERS", arguments.options.parameters,
        "Parameters file of Dakota, standard or aprepro format", reads_required},
       {"RESULTS", arguments.results, "Results file to write", OptionRule{.required = true}},
       {"--machine", arguments.machine.file, "Machine file (TOML)", reads_required},
       {"--set", arguments.machine.overrides,
        "PATH=VALUE overrides a value of the file, units allowed; may be repeated",
        one_each_as("PATH=VALUE")},
       {"--variable", arguments.options.variables,
        "NAME=PATH or \"NAME=PATH [unit]\": what a variable of Dakota is; may be repeated",
        one_each_as("NAME=PATH")},
       {"--function", arguments.options.outputs,
        "Output of each function, in their order; default: the label of the function", one_each}});
  command.also_writes([&arguments] {
    return std::vector<NamedFile>{{"RESULTS", arguments.results}};
  });
  add_pose_option(command, arguments.machine);
  add_model_option(command, arguments.machine);
}

}  // namespace hydrapod::cli
