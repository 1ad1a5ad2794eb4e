#include "hydrapod/model/variable_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "hydrapod/base/nearest.hpp"
#include "key_path.hpp"
#include "machine_numbers.hpp"
#include "machine_reader.hpp"
#include "overrides.hpp"

namespace hydrapod::model {

namespace {

/// How one number of the machine follows a parameter.
struct Slope {
  std::size_t number{};  ///< in the order of for_each_number
  double slope{};
};

struct Parameter {
  TiedPaths paths{};
  std::vector<Node*> nodes{};  ///< in the tree
  double value{};              ///< in the file
  std::vector<Slope> slopes{};
  bool affine{true};
};

std::vector<double> numbers_of(Machine& machine) {
  std::vector<double> numbers;
  for_each_number(machine, [&](double& number) { numbers.push_back(number); });
  return numbers;
}

void set_number(Node& node, double value) {
  node.kind = Node::Kind::real;
  node.number = value;
  node.text.clear();
}

std::vector<FileNumber> without_repeats(const std::vector<ReadNumber>& log) {
  std::vector<FileNumber> numbers;
  std::set<std::string> seen;
  for (const auto& read : log)
    if (seen.insert(read.path).second)
      numbers.push_back({read.path, read.unit, read.value, read.given, read.place.line});
  std::stable_sort(numbers.begin(), numbers.end(), [](const FileNumber& a, const FileNumber& b) {
    const auto rank = [](const FileNumber& n) {
      return n.given && n.line > 0 ? n.line : std::numeric_limits<unsigned>::max() - n.given;
    };
    return rank(a) < rank(b);
  });
  return numbers;
}

/// What all legs share, one leg may have of its own: `leg.3.rod.mass` beside `legs.rod.mass`.
void add_single_legs(std::vector<FileNumber>& numbers) {
  constexpr std::string_view shared = "legs.";
  std::vector<FileNumber> own;
  for (const auto& number : numbers) {
    if (!number.path.starts_with(shared)) continue;
    for (int leg = 1; leg <= leg_count; ++leg) {
      FileNumber single = number;
      single.path = fmt::format("leg.{}.{}", leg, number.path.substr(shared.size()));
      single.given = false;
      const auto known = std::any_of(numbers.begin(), numbers.end(), [&](const FileNumber& n) {
        return n.path == single.path;
      });
      if (!known) own.push_back(std::move(single));
    }
  }
  numbers.insert(numbers.end(), own.begin(), own.end());
}

}  // namespace

struct VariableMachine::State {
  std::vector<std::string> sources{};
  Node root{};
  std::vector<FileNumber> numbers{};
  Machine base{};
  std::vector<double> base_numbers{};
  std::vector<Parameter> parameters{};
  std::vector<double> values{};

  [[nodiscard]] Machine read() const {
    Faults faults(sources);
    return read_machine(root, faults);
  }

  /// The tree's node of a number; a default is put into the tree first.
  Node* node_of(const FileNumber& number) {
    const auto path = parse_path(number.path);
    if (!number.given) {
      Faults faults(sources);
      lay_over(root, {fmt::format("{}={:.17g}", number.path, number.value)}, faults);
    }
    return const_cast<Node*>(find_node(root, *path));
  }

  /// Reads the machine with the parameter at `value`.
  std::vector<double> numbers_at(const Parameter& parameter, double value) {
    std::vector<Node> kept;
    for (Node* node : parameter.nodes) {
      kept.push_back(*node);
      set_number(*node, value);
    }
    Machine machine = read();
    for (std::size_t i = 0; i < kept.size(); ++i) *parameter.nodes[i] = kept[i];
    return numbers_of(machine);
  }

  void find_slopes(Parameter& parameter);
};

void VariableMachine::State::find_slopes(Parameter& parameter) {
  constexpr double step = 1.0 / 1024.0;
  constexpr double rounding = 1e-11;
  const double h = step * (parameter.value != 0.0 ? std::abs(parameter.value) : 1.0);
  const auto near = numbers_at(parameter, parameter.value + h);
  const auto far = numbers_at(parameter, parameter.value + 2.0 * h);
  for (std::size_t i = 0; i < base_numbers.size(); ++i) {
    const double first = near[i] - base_numbers[i];
    const double second = far[i] - near[i];
    if (first == 0.0 && second == 0.0) continue;
    const double scale = std::max({std::abs(base_numbers[i]), std::abs(far[i])});
    if (std::abs(second - first) > rounding * scale) parameter.affine = false;
    parameter.slopes.push_back({i, 0.5 * (first + second) / h});
  }
  // numbers that are the parameter itself are so to the last digit
  for (auto& slope : parameter.slopes)
    if (std::abs(std::abs(slope.slope) - 1.0) < 1e-9) slope.slope = std::round(slope.slope);
}

VariableMachine::VariableMachine(const MachineFile& file) : state_(std::make_unique<State>()) {
  parse_machine(file.text, "machine file", file.overrides, {});  // throws what there is to say
  state_->sources.push_back("machine file");
  for (const auto& text : file.overrides) state_->sources.push_back(source_name(text));
  state_->root = std::get<Node>(parse_tree(file.text, 0));
  Faults faults(state_->sources);
  lay_over(state_->root, file.overrides, faults);
  std::vector<ReadNumber> log;
  faults.log_numbers(&log);
  state_->base = read_machine(state_->root, faults);
  state_->numbers = without_repeats(log);
  add_single_legs(state_->numbers);
  state_->base_numbers = numbers_of(state_->base);
}

VariableMachine::~VariableMachine() = default;
VariableMachine::VariableMachine(VariableMachine&&) noexcept = default;
VariableMachine& VariableMachine::operator=(VariableMachine&&) noexcept = default;

const std::vector<FileNumber>& VariableMachine::numbers() const { return state_->numbers; }

const FileNumber* VariableMachine::find(const std::string& path) const {
  const auto parsed = parse_path(path);
  if (!parsed) return nullptr;
  const std::string canonical = to_string(*parsed);
  const auto found = std::find_if(state_->numbers.begin(), state_->numbers.end(),
                                  [&](const FileNumber& n) { return n.path == canonical; });
  return found == state_->numbers.end() ? nullptr : &*found;
}

std::string VariableMachine::nearest_path(const std::string& path) const {
  std::vector<std::string_view> paths;
  for (const auto& number : state_->numbers) paths.push_back(number.path);
  return std::string{base::nearest(path, paths).value_or("")};
}

void VariableMachine::vary(const std::vector<TiedPaths>& parameters) {
  state_->parameters.clear();
  state_->values.clear();
  std::set<std::string> taken;
  for (const auto& paths : parameters)
    for (const auto& path : paths) {
      const auto* number = find(path);
      if (number == nullptr)
        throw std::invalid_argument(fmt::format("the machine file has no number `{}`", path));
      if (!taken.insert(number->path).second)
        throw std::invalid_argument(fmt::format("`{}` stands in two parameters", path));
      state_->node_of(*number);  // later ones must not move the nodes of earlier ones
    }
  for (const auto& paths : parameters) {
    Parameter parameter{.paths = paths, .value = find(paths.front())->value};
    for (const auto& path : paths) {
      const auto* number = find(path);
      parameter.nodes.push_back(const_cast<Node*>(find_node(state_->root, *parse_path(path))));
      set_number(*parameter.nodes.back(), number->value);
    }
    state_->parameters.push_back(std::move(parameter));
    state_->values.push_back(state_->parameters.back().value);
  }
  // tied numbers start from one value
  for (auto& parameter : state_->parameters)
    for (Node* node : parameter.nodes) set_number(*node, parameter.value);
  state_->base = state_->read();
  state_->base_numbers = numbers_of(state_->base);
  for (auto& parameter : state_->parameters) state_->find_slopes(parameter);
}

const std::vector<double>& VariableMachine::values() const { return state_->values; }

bool VariableMachine::matters(std::size_t parameter) const {
  return !state_->parameters.at(parameter).slopes.empty();
}

Machine VariableMachine::machine(const std::vector<double>& values) const {
  Machine machine = state_->base;
  this->machine(values, machine);
  return machine;
}

void VariableMachine::machine(const std::vector<double>& values, Machine& machine) const {
  const auto& parameters = state_->parameters;
  const bool affine = std::all_of(parameters.begin(), parameters.end(),
                                  [](const Parameter& p) { return p.affine; });
  if (!affine) {
    State copy = *state_;
    for (std::size_t j = 0; j < parameters.size(); ++j)
      for (const auto& path : parameters[j].paths)
        set_number(*const_cast<Node*>(find_node(copy.root, *parse_path(path))), values[j]);
    machine = copy.read();
    return;
  }
  std::vector<double> numbers = state_->base_numbers;
  for (std::size_t j = 0; j < parameters.size(); ++j)
    for (const auto& slope : parameters[j].slopes)
      numbers[slope.number] += slope.slope * (values[j] - parameters[j].value);
  std::size_t next = 0;
  for_each_number(machine, [&](double& number) { number = numbers[next++]; });
}

}  // namespace hydrapod::model
