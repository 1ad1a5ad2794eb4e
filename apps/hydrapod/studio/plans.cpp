#include "hydrapod/studio/plans.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <span>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::studio {

namespace {
namespace fs = std::filesystem;
using report::Json;

constexpr std::size_t longest_text = 4096;
constexpr std::size_t longest_list = 64;

enum class Use { text, list, flag, input, inputs, output };

/// A field of a form and the option that it becomes.
struct Field {
  std::string_view name, option;
  Use use{Use::text};
  bool required{};
};

struct Kind {
  std::string_view name, command, section;
  std::span<const Field> fields;
  bool json{true};          ///< the command has --format
  bool pose{true};          ///< it takes --pose
  bool picture{};           ///< and draws with --plot
  std::string_view rows{};  ///< option of a file that it always writes
};

constexpr Field identify_fields[] = {{"records", "--measured", Use::inputs, true},
                                     {"from", "--from"},
                                     {"to", "--to"},
                                     {"against", "--against"},
                                     {"from_drive", "--from-drive", Use::flag}};
constexpr Field simulate_fields[] = {{"commands", "--command", Use::list, true},
                                     {"until", "--until"}};
constexpr Field diagnose_fields[] = {{"records", "--measured", Use::inputs, true},
                                     {"want", "--want"},
                                     {"against", "--against"},
                                     {"modes_only", "--modes-only", Use::flag}};
constexpr Field calibrate_fields[] = {{"targets", "--targets", Use::input, true},
                                      {"free", "--free", Use::list, true},
                                      {"priors", "--prior", Use::list},
                                      {"output", "--output", Use::output}};
constexpr Field rig_fields[] = {
    {"excite", "--excite", Use::list}, {"entry", "--entry"}, {"duration", "--duration"},
    {"averages", "--averages"},        {"seed", "--seed"},   {"output", "-o", Use::output, true}};
constexpr Field map_fields[] = {
    {"over", "--over", Use::list, true}, {"worst_over", "--worst-over", Use::list},
    {"also", "--also", Use::list},       {"value", "--value"},
    {"want", "--want", Use::list},       {"rows", "--results", Use::output}};
constexpr Field montecarlo_fields[] = {{"vary", "--vary", Use::list, true},
                                       {"correlate", "--correlate", Use::list},
                                       {"also", "--also", Use::list},
                                       {"commands", "--command", Use::list},
                                       {"until", "--until"},
                                       {"want", "--want", Use::list},
                                       {"samples", "--samples"},
                                       {"seed", "--seed"},
                                       {"rows", "--results", Use::output}};

constexpr Kind kinds[] = {
    {"identify", "report", "identification", identify_fields},
    {"simulate", "report", "simulation", simulate_fields},
    {.name = "diagnose",
     .command = "diagnose",
     .section = "diagnosis",
     .fields = diagnose_fields,
     .pose = false},
    {.name = "calibrate",
     .command = "calibrate",
     .section = "",
     .fields = calibrate_fields,
     .pose = false,
     .picture = true},
    {.name = "rig", .command = "rig", .section = "", .fields = rig_fields, .json = false},
    {.name = "map",
     .command = "map",
     .section = "",
     .fields = map_fields,
     .picture = true,
     .rows = "--results"},
    {.name = "montecarlo",
     .command = "montecarlo",
     .section = "",
     .fields = montecarlo_fields,
     .rows = "--results"}};

std::string text_of(const Json& value, const std::string& what) {
  if (!value.is_string()) base::refuse(what, "expected a text");
  const auto text = std::string(base::trimmed(value.get<std::string>()));
  if (text.size() > longest_text || text.find('\0') != text.npos)
    base::refuse(what, fmt::format("expected a text of at most {} characters", longest_text));
  if (text.empty()) base::refuse(what, "is empty");
  return text;
}

std::vector<std::string> list_of(const Json& value, const std::string& what) {
  if (!value.is_array() || value.empty() || value.size() > longest_list)
    base::refuse(what, fmt::format("expected a list of 1 to {} texts", longest_list));
  std::vector<std::string> all;
  for (const auto& one : value) all.push_back(text_of(one, what));
  return all;
}

/// "record:3", or a path.
std::string input_path(const std::string& text, const std::string& what, const Records& records) {
  constexpr std::string_view of_list = "record:";
  if (!text.starts_with(of_list)) return absolute_path(text, what);
  std::size_t number = 0;
  const auto* begin = text.data() + of_list.size();
  const auto* end = text.data() + text.size();
  const auto [last, status] = std::from_chars(begin, end, number);
  if (status != std::errc() || last != end || number >= records.count())
    base::refuse(what, fmt::format("there is no {}; {} records are known", text, records.count()));
  return records.path(number);
}

std::string file_name(const std::string& path) { return fs::path(path).filename().string(); }

/// Adds the arguments of one field.
class Arguments {
 public:
  Arguments(const PlanContext& context, bool replace, JobPlan& plan)
      : context_(context), replace_(replace), plan_(plan) {}

  void add(const Field& field, const Json& value) {
    const std::string what = fmt::format("{}: {}", plan_.kind, field.name);
    switch (field.use) {
      case Use::text:
        return option(field, text_of(value, what));
      case Use::list:
        for (const auto& text : list_of(value, what)) option(field, text);
        return;
      case Use::flag:
        if (!value.is_boolean()) base::refuse(what, "expected true or false");
        if (value.get<bool>()) plan_.arguments.emplace_back(field.option);
        return;
      case Use::input:
        return input(field, text_of(value, what), what);
      case Use::inputs:
        for (const auto& text : list_of(value, what)) input(field, text, what);
        return;
      case Use::output:
        return output(field, absolute_path(text_of(value, what), what));
    }
  }

 private:
  /// With the equals sign no value can be taken for another option.
  void option(const Field& field, const std::string& text) {
    plan_.arguments.push_back(fmt::format("{}={}", field.option, text));
    if (field.use == Use::list && subject_.empty()) subject(text);
  }

  void input(const Field& field, const std::string& text, const std::string& what) {
    const auto path = input_path(text, what, context_.records);
    plan_.arguments.push_back(fmt::format("{}={}", field.option, path));
    subject(file_name(path));
  }

  void output(const Field& field, const std::string& path) {
    refuse_existing(path, replace_);
    if (field.option.starts_with("--")) {
      plan_.arguments.push_back(fmt::format("{}={}", field.option, path));
    } else {
      plan_.arguments.insert(plan_.arguments.end(), {std::string(field.option), path});
    }
    plan_.output = path;
  }

  void subject(const std::string& text) {
    if (!subject_.empty()) return;
    subject_ = text;
    plan_.title += " " + base::printable(text, 60);
  }

  const PlanContext& context_;
  bool replace_;
  JobPlan& plan_;
  std::string subject_;
};

void add_machine(const Kind& kind, const Json& asked, const OpenMachine& machine, JobPlan& plan) {
  auto& words = plan.arguments;
  words = {std::string(kind.command), machine.file()};
  for (const auto& text : machine.overrides()) words.push_back("--set=" + text);
  if (const auto model = machine.model_word(); !model.empty()) words.push_back("--model=" + model);
  const auto pose = asked.value("pose", std::uint64_t{0});
  if (pose >= machine.poses())
    base::refuse("pose",
                 fmt::format("there is no pose {}; the page has {}", pose, machine.poses()));
  if (kind.pose) words.push_back("--pose=" + machine.pose(pose));
}

void add_fields(const Kind& kind, const Json& asked, const PlanContext& context, JobPlan& plan) {
  const auto given = asked.value("fields", Json::object());
  if (!given.is_object()) base::refuse("fields", "expected an object");
  const bool replace = asked.value("replace", false);
  Arguments arguments(context, replace, plan);
  for (const auto& [name, value] : given.items()) {
    const auto field = std::ranges::find(kind.fields, name, &Field::name);
    if (field == kind.fields.end())
      base::refuse(base::printable(name), fmt::format("{} has no such field", kind.name));
    arguments.add(*field, value);
  }
  for (const auto& field : kind.fields)
    if (field.required && !given.contains(field.name))
      base::refuse(fmt::format("{}: {}", kind.name, field.name), "is missing");
  if (!kind.rows.empty() && plan.output.empty())
    plan.arguments.push_back(fmt::format("{}={}", kind.rows, context.folder.place_for("rows.h5")));
  if (!plan.output.empty() && replace) plan.arguments.emplace_back("--force");
}

}  // namespace

std::string absolute_path(const std::string& text, const std::string& what) {
  if (base::trimmed(text).empty()) base::refuse(what, "expected the path of a file");
  std::error_code failure;
  const auto path = fs::absolute(fs::path(text), failure);
  if (failure) base::refuse(what, failure.message());
  return path.lexically_normal().string();
}

JobPlan job_plan(const Json& asked, const PlanContext& context) {
  const auto name = asked.at("kind").get<std::string>();
  const auto* kind = std::ranges::find(kinds, name, &Kind::name);
  if (kind == std::end(kinds)) {
    std::vector<std::string_view> names;
    for (const auto& one : kinds) names.push_back(one.name);
    base::refuse(base::printable(name),
                 fmt::format("unknown kind of job; expected {}", fmt::join(names, ", ")));
  }
  JobPlan plan{.kind = name,
               .title = name,
               .section = std::string(kind->section),
               .folder = context.folder.path()};
  add_machine(*kind, asked, context.machine, plan);
  add_fields(*kind, asked, context, plan);
  if (kind->json) plan.arguments.emplace_back("--format=json");
  if (kind->json && kind->command == "report") plan.arguments.emplace_back("--output=-");
  if (kind->picture) {
    plan.picture = context.folder.place_for("plot.svg");
    plan.arguments.push_back("--plot=" + plan.picture);
  }
  for (const auto& next : asked.value("then", Json::array())) {
    Json more{{"kind", next.get<std::string>()},
              {"pose", asked.value("pose", 0)},
              {"fields", Json::object()}};
    if (more["kind"] == name) base::refuse("then", "a job does not follow itself");
    more["fields"]["records"] = asked.at("fields").at("records");
    plan.then.push_back(job_plan(more, context));
  }
  return plan;
}

}  // namespace hydrapod::studio
