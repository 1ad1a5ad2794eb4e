#include "hydrapod/model/machine_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

struct VariableMachine::State {
  MachineFile file{};
  std::vector<FileNumber> numbers{};
  std::vector<ParameterId> ids{};  ///< of the numbers
  std::vector<std::vector<ParameterId>> varied{};
  std::vector<double> values{};

  void add(const ParameterId& id, bool given, unsigned line) {
    const auto number = value(file.machine, id);
    if (!number) return;
    ids.push_back(id);
    numbers.push_back(
        {path(file.machine, id), std::string{unit(file.machine, id)}, *number, given, line});
  }
};

VariableMachine::VariableMachine(const MachineFile& file) : state_(std::make_unique<State>()) {
  state_->file = file;
  auto& ids = state_->ids;
  // an element of a tensor in rows is given twice
  for (const auto& given : file.given)
    if (std::find(ids.begin(), ids.end(), given.id) == ids.end())
      state_->add(given.id, true, given.line);
  const auto count = static_cast<std::ptrdiff_t>(ids.size());
  for (const auto& id : parameters(file.machine)) {
    const auto known = ids.begin() + count;
    if (std::find(ids.begin(), known, id) != known) continue;
    if (const auto own = in_file(file, id)) state_->add(*own, false, 0);
  }
}

VariableMachine::~VariableMachine() = default;
VariableMachine::VariableMachine(VariableMachine&&) noexcept = default;
VariableMachine& VariableMachine::operator=(VariableMachine&&) noexcept = default;

const std::vector<FileNumber>& VariableMachine::numbers() const { return state_->numbers; }

const FileNumber* VariableMachine::find(const std::string& path) const {
  const auto id = find_parameter(state_->file, path);
  if (!id) return nullptr;
  const auto found = std::find(state_->ids.begin(), state_->ids.end(), *id);
  return found == state_->ids.end()
             ? nullptr
             : &state_->numbers[static_cast<std::size_t>(found - state_->ids.begin())];
}

ParameterId VariableMachine::id(const std::string& path) const {
  return find_parameter(state_->file, path).value();
}

std::string VariableMachine::nearest_path(const std::string& path) const {
  return nearest_parameter(state_->file, path);
}

void VariableMachine::vary(const std::vector<TiedPaths>& parameters) {
  state_->varied.clear();
  state_->values.clear();
  std::set<std::string> taken;
  for (const auto& paths : parameters) {
    state_->varied.emplace_back();
    for (const auto& path : paths) {
      const auto* number = find(path);
      if (number == nullptr)
        throw std::invalid_argument(fmt::format("the machine file has no number `{}`", path));
      if (!taken.insert(number->path).second)
        throw std::invalid_argument(fmt::format("`{}` is in two parameters", path));
      state_->varied.back().push_back(*find_parameter(state_->file, path));
    }
    state_->values.push_back(find(paths.front())->value);
  }
}

const std::vector<double>& VariableMachine::values() const { return state_->values; }

bool VariableMachine::matters(std::size_t parameter) const {
  const auto& ids = state_->varied.at(parameter);
  return std::any_of(ids.begin(), ids.end(), of_mechanics);
}

Machine VariableMachine::machine(const std::vector<double>& values) const {
  Machine machine = state_->file.machine;
  this->machine(values, machine);
  return machine;
}

void VariableMachine::machine(const std::vector<double>& values, Machine& machine) const {
  machine = state_->file.machine;
  std::vector<Assignment> assignments;
  for (std::size_t j = 0; j < values.size(); ++j)
    for (const auto& id : state_->varied[j]) assignments.push_back({id, values[j]});
  assign(machine, assignments);
}

}  // namespace hydrapod::model
