#include "target_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::calibration {

namespace {

using model::Faults;
using model::Node;
using model::Section;
using Value = Section::Value;

using base::two_pi;
constexpr int most_repeats = 30;

/// Reports keys that are not among `known`.
void check_keys(const Node& table, const std::string& path,
                const std::vector<std::string_view>& known, Faults& faults) {
  for (const auto& child : table.children) {
    if (std::find(known.begin(), known.end(), child.key) != known.end()) continue;
    const auto meant = base::nearest(child.key, known);
    faults.add(child.key_place, model::joined_path(path, child.key),
               meant ? fmt::format("unknown key; did you mean `{}`?", *meant)
                     : fmt::format("unknown key; known here: {}", fmt::join(known, ", ")));
  }
}

/// The tables of the array `key`; anything else is reported.
std::vector<Value> tables_of(const Node& root, std::string_view key, const std::string& path,
                             Faults& faults) {
  std::vector<Value> tables;
  const Node* array = root.find(key);
  if (array == nullptr) return tables;
  const std::string at = model::joined_path(path, key);
  const bool is_array = array->kind == Node::Kind::array;
  for (std::size_t i = 0; is_array && i < array->children.size(); ++i)
    if (array->children[i].is_table())
      tables.push_back({&array->children[i], fmt::format("{}[{}]", at, i)});
  if (!is_array || tables.size() != array->children.size())
    faults.add(array->place, at, fmt::format("expected tables, each begun with [[{}]]", at));
  return tables;
}

Amount amount_of(const Node& node) {
  return node.is_number() ? Amount(node.number) : Amount(node.text);
}

/// A number or a string; the unit is judged where the machine is known.
std::optional<Amount> read_amount(const Section& table, std::string_view key) {
  const auto value = table.find(key);
  if (!value) return {};
  if (value.node->is_number() || value.node->kind == Node::Kind::text)
    return amount_of(*value.node);
  table.report(value, fmt::format("is {}, expected a number or a quantity such as \"12 kg\"",
                                  model::described(*value.node)));
  return {};
}

class TargetReader {
 public:
  TargetReader(const Node& root, std::string file, const std::vector<std::string>& poses,
               Faults& faults)
      : root_(root), file_(std::move(file)), poses_(poses), faults_(faults) {}

  TargetsFile read() {
    check_keys(root_, "",
               {"title", "source", "frequency_unit", "frequencies", "deviation", "mode", "free",
                "alternative", "fit"},
               faults_);
    const Section top(root_, faults_);
    TargetsFile file;
    auto& [targets, plan] = file;
    targets.title = top.optional_text("title");
    targets.source = top.optional_text("source");
    plain_unit_ = top.optional_text("frequency_unit");
    if (!plain_unit_.empty() && plain_unit_ != "Hz" && plain_unit_ != "rad/s")
      top.report(top.find("frequency_unit"),
                 fmt::format("is \"{}\", expected \"Hz\" or \"rad/s\"", plain_unit_));
    constexpr std::string_view kinds[]{"damped", "undamped"};
    damped_ = top.word("frequencies", kinds) == 0;
    targets.deviations_given = top.has("deviation");
    default_deviation_ = top.find("deviation");
    for (const auto& table : tables_of(root_, "mode", "", faults_)) read_mode(table, targets);
    if (targets.modes.empty() && !faults_.any_error())
      faults_.add(root_.place, "mode",
                  "there is no target; write a table [[mode]] with `frequency` for each");
    for (const auto& table : tables_of(root_, "free", "", faults_))
      plan.free.push_back(read_free(table));
    for (const auto& table : tables_of(root_, "alternative", "", faults_))
      plan.alternatives.push_back(read_alternative(table));
    read_options(top, plan.options);
    return file;
  }

 private:
  Origin origin(const Node& node) const { return {file_, node.place.line, node.place.column}; }

  double frequency(const Section& table, const Value& value) const {
    const auto read =
        read_frequency(value.node->text, value.node->is_number(), value.node->number, plain_unit_);
    if (read.problem.empty() && read.omega > 0.0) return read.omega;
    table.report(value, read.problem.empty() ? fmt::format("is {}, expected a frequency above 0",
                                                           model::described(*value.node))
                                             : read.problem);
    return std::nan("");
  }

  /// A deviation of a frequency: a share ("0.1 %", 0.001) or a frequency ("0.02 Hz").
  double deviation(const Section& table, const Value& value, double omega) const {
    double result = std::nan("");
    if (value.node->is_number()) {
      result = value.node->number * omega;
    } else if (const auto share = base::read_quantity(value.node->text, "1"); share.ok()) {
      result = share.value * omega;
    } else {
      result = frequency(table, value);
      if (std::isnan(result)) return result;
    }
    if (result > 0.0) return result;
    table.report(value,
                 "expected a standard deviation above 0, as a share such as \"0.1 %\" or a "
                 "frequency such as \"0.02 Hz\"");
    return std::nan("");
  }

  void read_mode(const Value& at, Targets& targets) {
    check_keys(*at.node, at.path,
               {"frequency", "repeated", "direction", "deviation", "weight", "amplitude", "damping",
                "damping_deviation", "shape", "shape_deviation", "shape_against", "pose", "name"},
               faults_);
    const Section table = Section::at(*at.node, at.path, faults_);
    ModeTarget mode;
    const auto value = table.find("frequency");
    if (!value) return table.report_missing("frequency", "required value (\"11.3 Hz\")");
    mode.omega = frequency(table, value);
    mode.damped = damped_;
    if (const auto own = table.find("deviation")) {
      mode.deviation = deviation(table, own, mode.omega);
      targets.deviations_given = true;
    } else if (default_deviation_) {
      mode.deviation = deviation(Section(root_, faults_), default_deviation_, mode.omega);
    } else {
      mode.deviation = default_deviation * mode.omega;
    }
    read_weight(table, mode);
    mode.amplitude = table.number("amplitude", "m", 0.0);
    read_direction(table, mode);
    read_damping(table, mode);
    read_shape(table, mode);
    if (const auto at_pose = table.find("pose")) {
      mode.pose = table.text("pose");
      const auto problem = pose_fault(mode.pose, poses_);
      if (!problem.empty() && at_pose.node->kind == Node::Kind::text)
        table.report(at_pose, problem);
    }
    for (const auto& [key, message] : target_faults(mode))
      if (const auto at_fault = table.find(key)) table.report(at_fault, message);
    add_repeated(table, mode, targets);
  }

  static void read_weight(const Section& table, ModeTarget& mode) {
    const double weight = table.number("weight", "1", 1.0);
    if (!(weight > 0.0))
      return table.report(table.find("weight"),
                          "expected more than 0; it divides the standard deviation");
    mode.deviation /= weight;
  }

  static void read_direction(const Section& table, ModeTarget& mode) {
    const auto value = table.find("direction");
    if (!value) return;
    const int direction = direction_index(table.text("direction"));
    if (direction < 0)
      return table.report(value,
                          fmt::format("is {}, expected one of {}", model::described(*value.node),
                                      fmt::join(direction_names, ", ")));
    mode.direction = direction;
  }

  static void read_damping(const Section& table, ModeTarget& mode) {
    mode.damping = table.optional_number("damping", "1");
    if (!mode.damping) return;
    constexpr double share = 0.1, least = 1e-4;
    mode.damping_deviation =
        table.number("damping_deviation", "1", std::max(share * *mode.damping, least));
  }

  void read_shape(const Section& table, ModeTarget& mode) {
    const auto value = table.find("shape");
    if (!value) {
      if (const auto against = table.find("shape_against"))
        table.report(against, "needs a `shape`");
      return;
    }
    constexpr std::string_view words[]{"ground", "base"};
    mode.shape_against = static_cast<MotionAgainst>(table.word("shape_against", words));
    if (!value.node->is_table())
      return table.report(value,
                          "expected the platform's motion as a table, for instance "
                          "{ x = 1.0, ry = -0.2 } in m and rad");
    check_keys(*value.node, value.path, {direction_names.begin(), direction_names.end()}, faults_);
    const Section motion = Section::at(*value.node, value.path, faults_);
    Vector6 shape;
    for (int k = 0; k < 6; ++k)
      shape[k] = motion.number(direction_names[k], k < 3 ? "m" : "rad", 0.0);
    if (shape.isZero(0.0)) table.report(value, "is zero everywhere, expected a motion");
    mode.shape = shape;
    constexpr double usual = 0.05;
    mode.shape_deviation = table.number("shape_deviation", "1", usual);
  }

  void add_repeated(const Section& table, ModeTarget mode, Targets& targets) const {
    const double repeated = table.number("repeated", "1", 1.0);
    if (!(repeated >= 1.0 && repeated <= most_repeats) || repeated != std::floor(repeated)) {
      table.report(
          table.find("repeated"),
          fmt::format("expected the number of modes with this frequency, 1 to {}", most_repeats));
      return;
    }
    const std::string given = table.optional_text("name");
    const auto& frequency = *table.find("frequency").node;
    const std::string name = !given.empty() ? given
                             : frequency.is_number()
                                 ? fmt::format("{:g} {}", frequency.number, plain_unit_)
                                 : frequency.text;
    for (int k = 1; k <= static_cast<int>(repeated); ++k) {
      mode.name = repeated > 1.0 ? fmt::format("{} ({})", name, k) : name;
      targets.modes.push_back(mode);
    }
  }

  FreeParameter read_free(const Value& at) {
    check_keys(*at.node, at.path, {"path", "start", "bounds", "prior"}, faults_);
    const Section table = Section::at(*at.node, at.path, faults_);
    FreeParameter free{.origin = origin(*at.node)};
    const auto value = table.find("path");
    if (!value) {
      table.report_missing("path",
                           "required value (\"legs.rod.mass\", or an array of paths that "
                           "are to be equal)");
    } else if (value.node->kind == Node::Kind::array && !value.node->children.empty()) {
      for (const auto& child : value.node->children) {
        free.paths.push_back(child.text);
        if (child.kind != Node::Kind::text)
          table.report(value, fmt::format("holds {}, expected paths such as \"legs.rod.mass\"",
                                          model::described(child)));
      }
    } else {
      free.paths.push_back(table.text("path"));
    }
    free.start = read_amount(table, "start");
    if (const auto bounds = table.find("bounds")) {
      const auto ends = table.elements(bounds, 2, "two values, [lowest, highest]");
      if (ends.size() == 2) {
        free.lower = amount_of(*ends[0].node);
        free.upper = amount_of(*ends[1].node);
      }
    }
    if (const auto prior = table.find("prior")) free.prior = read_prior(table, prior);
    return free;
  }

  std::optional<PriorAmounts> read_prior(const Section& table, const Value& value) {
    if (value.node->is_table()) {
      check_keys(*value.node, value.path, {"value", "spread"}, faults_);
      const Section prior = Section::at(*value.node, value.path, faults_);
      const auto center = read_amount(prior, "value"), spread = read_amount(prior, "spread");
      if (center && spread) return PriorAmounts{*center, *spread};
    }
    table.report(value, "expected { value = …, spread = … }: prior knowledge");
    return {};
  }

  Alternative read_alternative(const Value& at) {
    check_keys(*at.node, at.path, {"name", "choice"}, faults_);
    const Section table = Section::at(*at.node, at.path, faults_);
    Alternative alternative{.name = table.text("name"), .origin = origin(*at.node)};
    for (const auto& choice : tables_of(*at.node, "choice", at.path, faults_))
      alternative.choices.push_back(read_choice(choice));
    if (alternative.choices.size() < 2)
      faults_.add(
          at.node->place, at.path,
          "expected at least two tables [[alternative.choice]], each with `name` and `set`");
    return alternative;
  }

  Choice read_choice(const Value& at) {
    check_keys(*at.node, at.path, {"name", "set"}, faults_);
    const Section table = Section::at(*at.node, at.path, faults_);
    Choice choice{.name = table.text("name")};
    const auto set = table.find("set");
    if (!set) return choice;
    if (set.node->kind != Node::Kind::array) {
      table.report(set, "expected an array of \"PATH=VALUE\", as --set takes them");
      return choice;
    }
    for (const auto& child : set.node->children) {
      choice.overrides.push_back(child.text);
      if (child.text.find('=') == std::string::npos)
        table.report(set, fmt::format("holds {}, expected \"PATH=VALUE\", as --set takes it",
                                      model::described(child)));
    }
    return choice;
  }

  void read_options(const Section& top, FitOptions& options) {
    const Section fit = top.optional_table("fit");
    if (!fit.exists()) return;
    check_keys(*root_.find("fit"), "fit", {"starts", "seed", "loss", "max_iterations"}, faults_);
    const auto whole = [&](std::string_view key, double fallback, double highest) {
      const double number = fit.number(key, "1", fallback);
      if (number >= 1.0 && number <= highest && number == std::floor(number)) return number;
      fit.report(fit.find(key), fmt::format("expected a whole number from 1 to {}", highest));
      return fallback;
    };
    options.starts = static_cast<int>(whole("starts", options.starts, 10000));
    options.seed = static_cast<std::uint64_t>(whole("seed", 1.0, 1e15));
    options.max_iterations =
        static_cast<int>(whole("max_iterations", options.max_iterations, 100000));
    constexpr std::string_view losses[]{"automatic", "squares", "cauchy"};
    options.loss = static_cast<Loss>(fit.word("loss", losses));
  }

  const Node& root_;
  std::string file_;
  const std::vector<std::string>& poses_;
  Faults& faults_;
  std::string plain_unit_{};
  bool damped_{true};
  Value default_deviation_{};
};

}  // namespace

int direction_index(std::string_view name) {
  return spatial::direction_from_name(name).value_or(-1);
}

Frequency read_frequency(const std::string& text, bool plain, double number,
                         const std::string& plain_unit) {
  if (plain) {
    if (plain_unit == "rad/s") return {number, ""};
    if (plain_unit == "Hz") return {number * two_pi, ""};
    return {0.0, fmt::format("is {:g} without a unit; write \"{:g} Hz\" or \"{:g} rad/s\", or say "
                             "`frequency_unit = \"Hz\"` at the top of the file",
                             number, number, number)};
  }
  const auto cycles = base::read_quantity(text, "Hz");
  if (cycles.ok()) return {cycles.value * two_pi, ""};
  const auto radians = base::read_quantity(text, "rad/s");
  if (radians.ok()) return {radians.value, ""};
  return {0.0, fmt::format("is \"{}\", expected a frequency such as \"11.3 Hz\" or \"71 rad/s\"",
                           base::printable(text))};
}

std::vector<TargetFault> target_faults(const ModeTarget& mode) {
  constexpr double lowest = 1e-6, highest = 1e6;   // Hz
  constexpr double finest = 1e-9, coarsest = 1e3;  // of what is measured
  std::vector<TargetFault> faults;
  const auto outside = [](double value, double low, double high) {
    return value < low || value > high;  // what is not a number was reported where it was read
  };
  if (outside(mode.omega, lowest * two_pi, highest * two_pi))
    faults.push_back({"frequency", fmt::format("is {:g} Hz, expected {:g} to {:g} Hz",
                                               mode.omega / two_pi, lowest, highest)});
  else if (outside(mode.deviation, finest * mode.omega, coarsest * mode.omega))
    faults.push_back({"deviation", fmt::format("is {:g} times the frequency, expected {:g} to {:g}",
                                               mode.deviation / mode.omega, finest, coarsest)});
  constexpr double smallest = 1e-9, largest = 10.0;  // m
  if (mode.amplitude != 0.0 && outside(mode.amplitude, smallest, largest))
    faults.push_back({"amplitude", fmt::format("is {:g} m, expected {:g} to {:g} m", mode.amplitude,
                                               smallest, largest)});
  if (mode.damping && (*mode.damping < 0.0 || *mode.damping >= 1.0))
    faults.push_back({"damping", fmt::format("is {:g}, expected a damping ratio of at least 0 and "
                                             "below 1",
                                             *mode.damping)});
  if (mode.damping && outside(mode.damping_deviation, finest, coarsest))
    faults.push_back({"damping_deviation", fmt::format("is {:g}, expected {:g} to {:g}",
                                                       mode.damping_deviation, finest, coarsest)});
  if (mode.shape && !mode.shape->allFinite())
    faults.push_back({"shape", "expected finite numbers"});
  if (mode.shape && outside(mode.shape_deviation, finest, coarsest))
    faults.push_back({"shape_deviation", fmt::format("is {:g}, expected {:g} to {:g}",
                                                     mode.shape_deviation, finest, coarsest)});
  return faults;
}

std::string pose_fault(const std::string& pose, const std::vector<std::string>& poses) {
  if (poses.empty() || std::ranges::count(poses, pose) > 0) return {};
  return fmt::format("is \"{}\", expected a pose of the machine: {}", base::printable(pose),
                     fmt::join(poses, ", "));
}

TargetsFile read_target_tables(const model::Node& root, const std::string& file,
                               const std::vector<std::string>& poses, model::Faults& faults) {
  return TargetReader(root, file, poses, faults).read();
}

}  // namespace hydrapod::calibration
