#pragma once
/// What every command that works on a machine takes: FILE, --set, --pose, --model.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/options.hpp"
#include "hydrapod/tasks/machine.hpp"

namespace hydrapod::cli {

struct MachineArguments {
  std::string file{};
  std::vector<std::string> overrides{};  ///< `PATH=VALUE`
  std::string pose{"neutral"};           ///< a name, or offsets: `z=50 mm, ry=5 deg`
  std::string model{};                   ///< rigid, guide, full; empty: what the file describes
};

/// Adds FILE and --set to `command`.
void add_machine_options(Command command, MachineArguments& arguments);
/// Adds --pose.
void add_pose_option(Command command, MachineArguments& arguments);
/// Adds --model.
void add_model_option(Command command, MachineArguments& arguments);
/// Adds all of these.
void add_subject_options(Command command, MachineArguments& arguments);

/// Reads the machine; warnings go to stderr. Throws base::InputError.
tasks::Machine load(const MachineArguments& arguments);

/// Poses of --pose and --poses, each once; none where neither is given. Throws base::InputError.
std::vector<model::NamedPose> poses_of(const std::vector<std::string>& named,
                                       const std::string& all, const model::Machine& machine);

/// The model of that name; none for no name. Throws base::InputError.
std::optional<dynamics::ModelKind> model_kind(const std::string& word);

/// "x,y,z" of `option`, a point of the platform [m]. Throws base::InputError; warns of lengths that
/// model::unusual_numbers() would not leave without a word in a machine file.
spatial::Vector3 point(const std::string& option, const std::string& text);

/// `text` as a number in SI, or as a quantity of the dimension of `unit`; `argument` is what the
/// message calls it. Throws base::InputError.
double plain_or_quantity(const std::string& argument, const std::string& text, const char* unit);

/// The same of the option `option`, above 0; `expected` is what the message says otherwise.
double positive_quantity(const std::string& option, const std::string& text, const char* unit,
                         const char* expected);

/// One of several words for an option, or base::InputError with the nearest of them.
size_t choose_word(const std::string& option, const std::string& word,
                   const std::vector<std::string_view>& words);

/// How a result's JSON begins that depends on the model.
report::Json head_of_model(const char* kind, const tasks::Machine& machine);

/// `result` behind its head, as a file or a printed text.
std::string json_text(report::Json head, const report::Json& result, int indent = 1);

}  // namespace hydrapod::cli
