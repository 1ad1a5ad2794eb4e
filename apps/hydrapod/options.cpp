#include "hydrapod/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <limits>
#include <type_traits>

#include "hydrapod/output_files.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

template <class Value>
bool is_shown(const Value& value, const OptionRule& rule) {
  if constexpr (std::is_arithmetic_v<Value>) return rule.shows_zero || value != Value{};
  if constexpr (std::is_same_v<Value, std::string>) return !value.empty();
  return false;
}

template <class Value>
struct Plain {
  using type = Value;
};
template <class Value>
struct Plain<std::optional<Value>> {
  using type = Value;
};

/// What CLI11 takes for numbers and is none: nan and inf; -1 as the largest number without a sign.
/// It reads whole numbers as C does, 010 as 8, and ends at the largest one: zeros in front are
/// taken off, what is larger is refused.
template <class Number>
std::string objection_to_number(std::string& text) {
  if constexpr (std::is_integral_v<Number>) {
    const auto sign = text.starts_with('-') || text.starts_with('+') ? 1U : 0U;
    const bool digits =
        text.size() > sign && text.find_first_not_of("0123456789", sign) == text.npos;
    if (digits)
      text.erase(sign, std::min(text.find_first_not_of('0', sign), text.size() - 1) - sign);
    Number value{};
    const auto read = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0),
                                      text.data() + text.size(), value);
    if (digits && read.ec == std::errc::result_out_of_range)
      return fmt::format("expected at most {}, not {}", std::numeric_limits<Number>::max(), text);
  }
  if constexpr (std::is_floating_point_v<Number>) {
    const char* const letters = "aAiI";  // of nan, inf, infinity
    if (text.find_first_of(letters) != text.npos) return "expected a finite number, not " + text;
  }
  if constexpr (std::is_unsigned_v<Number>)
    if (text.find('-') != text.npos) return "expected 0 or more, not " + text;
  return {};
}

template <class Value>
void add(CLI::App& app, const OptionRow& row, Value& value) {
  const auto& rule = row.rule;
  CLI::Option* option = app.add_option(row.names, value, row.description);
  using Number = typename Plain<Value>::type;
  if constexpr (std::is_arithmetic_v<Number>)
    option->transform(CLI::Validator(&objection_to_number<Number>, "", ""));
  if (is_shown(value, rule)) option->capture_default_str();
  if (rule.required) option->required();
  if (rule.one_each) option->allow_extra_args(false);
  if (rule.hidden) option->group("");
  if (rule.type_name != nullptr) option->type_name(rule.type_name);
  std::visit(
      [&](const auto& range) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(range)>, std::monostate>)
          option->check(CLI::Range(range.first, range.second));
      },
      rule.range);
}

void add(CLI::App& app, const OptionRow& row, bool& value) {
  app.add_flag(row.names, value, row.description);
}

}  // namespace

/// The options of a command whose values are files.
struct Command::Files {
  struct Option {
    std::string name;
    OptionValue value;
  };
  std::vector<Option> inputs{}, outputs{};
  std::function<std::vector<NamedFile>()> more_outputs{};
  bool force{};
  bool* tell_force{};
};

Command::Command(CLI::App* app) : app_(app), files_(std::make_shared<Files>()) {}

void Command::add_options(std::initializer_list<OptionRow> rows) {
  for (const auto& row : rows) {
    std::visit([&](auto* value) { add(*app_, row, *value); }, row.value);
    if (row.rule.file == FileUse::none) continue;
    const std::string name = row.names.substr(0, row.names.find(','));
    (row.rule.file == FileUse::input ? files_->inputs : files_->outputs)
        .push_back({name, row.value});
    if (row.rule.file == FileUse::output) add_force();
  }
}

void Command::add_force() {
  if (app_->get_option_no_throw("--force") != nullptr) return;
  app_->add_flag("--force", files_->force,
                 "Replace a record, machine file or study that exists, and a text that hydrapod "
                 "did not write");
}

void Command::also_writes(std::function<std::vector<NamedFile>()> files, bool* force) {
  add_force();
  files_->more_outputs = std::move(files);
  files_->tell_force = force;
}

void Command::add_extent_options() {
  app_->preparse_callback([](std::size_t) { show(Extent::screen); });  // the options come after it
  CLI::Option* brief = app_->add_flag_callback(
      "--brief", [] { show(Extent::brief); }, "The verdict, and the first rows of tables only");
  CLI::Option* all = app_->add_flag_callback(
      "--all", [] { show(Extent::all); }, "All rows of tables, also where a terminal is too small");
  all->excludes(brief);
}

void Command::check_files(const Files& files) {
  const auto named = [](const std::vector<Files::Option>& options) {
    std::vector<NamedFile> list;
    for (const auto& [name, value] : options) {
      if (const auto* one = std::get_if<std::string*>(&value)) list.push_back({name, **one});
      if (const auto* many = std::get_if<std::vector<std::string>*>(&value))
        for (const auto& text : **many) list.push_back({name, text});
    }
    return list;
  };
  const auto inputs = named(files.inputs);
  auto outputs = named(files.outputs);
  if (files.more_outputs)
    for (auto& file : files.more_outputs()) outputs.push_back(std::move(file));
  check_outputs(inputs, outputs, files.force);
  if (files.tell_force != nullptr) *files.tell_force = files.force;
  for (const auto& input : inputs)
    if (const auto path = input_file(input.path)) note_input(input.option, *path);
}

Command Command::add_command(const std::string& name, const std::string& description,
                             const std::vector<Example>& examples, const std::string& after) {
  std::size_t width = 0;
  for (const Example& example : examples) width = std::max(width, example.arguments.size());
  std::string footer = "Examples:";
  for (const Example& example : examples)
    footer += fmt::format("\n  hydrapod {:<{}}  {}", example.arguments, width, example.purpose);
  CLI::App* command = app_->add_subcommand(name, description);
  command->footer(footer + after);
  return Command(command);
}

void Command::require_subcommand(int count) { app_->require_subcommand(count); }
void Command::callback(std::function<void()> run) {
  app_->add_flag_callback("-q,--quiet", &be_quiet, "No progress and no notes; warnings stay");
  app_->callback(std::move(run));
}

}  // namespace hydrapod::cli
