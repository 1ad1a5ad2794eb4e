#include "hydrapod/studio/open_machine.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::studio {

namespace {

constexpr std::size_t largest_file = std::size_t{16} << 20U;

std::optional<double> whole_number(const std::string& text) {
  double number = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

/// A plain number as the quantity that stood there, in its unit, where that is the same number.
void keep_unit(model::FileEdit& edit, const std::string& text, const model::MachineFile& file) {
  const auto value = edit.taken_out ? std::nullopt : whole_number(edit.value);
  const auto known = value ? model::find_number(file, edit.path) : std::nullopt;
  if (!known) return;
  const auto unit = model::written_unit(text, edit.path, known->unit);
  if (unit.name.empty()) return;
  for (const int digits : {6, 9, 12, 15, 16, 17}) {
    const auto written = model::written(*value, unit, digits);
    const auto read = base::read_quantity(written.substr(1, written.size() - 2), known->unit);
    if (!read.ok() || read.value != *value) continue;
    edit.value = written;
    return;
  }
}

/// The text must be read as the machine that was shown.
void verify(const std::string& text, const std::string& name, const model::Machine& shown) {
  const auto read = model::parse_machine(text, name, {}, {});
  constexpr double rounding = 1e-14;
  for (const auto& id : model::parameters(shown)) {
    const auto value = model::value(read.machine, id), expected = model::value(shown, id);
    if (!expected) continue;
    if (!value || !(std::abs(*value - *expected) <= rounding * std::abs(*expected)))
      throw base::ComputationError(fmt::format(
          "`{}` could not be written into the machine file; nothing was changed",
          model::path(shown, id)));
  }
}

}  // namespace

void refuse_existing(const std::string& path, bool replace) {
  std::error_code ignored;
  if (!replace && std::filesystem::exists(path, ignored))
    base::refuse(path, fmt::format("{} and was left as it is", exists_words));
}

OpenMachine::OpenMachine(MachineChoice choice)
    : choice_(std::move(choice)),
      text_(base::read_file(choice_.file, largest_file, "a machine file")) {
  for (std::size_t k = 0; k < choice_.poses.size(); ++k) (void)machine(k, false);
}

std::vector<std::string> OpenMachine::overrides() const {
  auto all = choice_.overrides;
  all.insert(all.end(), assignments_.begin(), assignments_.end());
  return all;
}

tasks::Machine OpenMachine::machine(std::size_t pose, bool pages) const {
  return tasks::read_machine({.file = choice_.file,
                              .text = text_,
                              .overrides = pages ? overrides() : choice_.overrides,
                              .pose = choice_.poses.at(pose),
                              .model = choice_.model});
}

std::string OpenMachine::model_word() const {
  return choice_.model ? dynamics::name(*choice_.model) : "";
}

void OpenMachine::change(report::Json values, std::vector<std::string> assignments) {
  assignments_.swap(assignments);
  try {
    (void)machine(0, true);
  } catch (...) {
    assignments_.swap(assignments);
    throw;
  }
  values_ = std::move(values);
}

bool OpenMachine::differs_on_disk() const {
  try {
    return base::read_file(choice_.file, largest_file, "a machine file") != text_;
  } catch (const base::InputError&) {
    return true;
  }
}

void OpenMachine::reload() { *this = OpenMachine(choice_); }

std::string OpenMachine::edited_text() const {
  const auto all = overrides();
  const auto shown = model::parse_machine(text_, choice_.file, all, {});
  auto edits = model::edits_of_overrides(text_, all);
  for (auto& edit : edits) keep_unit(edit, text_, shown);
  const auto text = model::edited_file(text_, edits, "studio");
  verify(text, choice_.file, shown.machine);
  return text;
}

std::vector<PlannedEdit> OpenMachine::edits() const {
  const auto all = overrides();
  const auto shown = model::parse_machine(text_, choice_.file, all, {});
  std::vector<PlannedEdit> planned;
  for (auto& edit : model::edits_of_overrides(text_, all)) {
    keep_unit(edit, text_, shown);
    planned.push_back({edit.path, edit.taken_out ? "(taken out)" : edit.value});
  }
  return planned;
}

void OpenMachine::save(const std::string& path, bool replace) {
  const bool in_place = path.empty();
  if (in_place && choice_.is_new)
    base::refuse("save", "the machine has no file yet; give the path of one");
  if (in_place && differs_on_disk())
    base::refuse(choice_.file,
                 "the file on the disk has changed since it was read and was left as it is; save "
                 "under another name, or read it again (the values changed here are then lost)");
  const std::string target = in_place ? choice_.file : path;
  if (!in_place) refuse_existing(target, replace);
  const auto text = edited_text();
  base::write_file_whole(target, text);
  auto choice = choice_;
  choice.file = target;
  choice.is_new = false;
  choice.overrides.clear();
  *this = OpenMachine(std::move(choice));
}

}  // namespace hydrapod::studio
