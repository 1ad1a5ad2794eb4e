#include "core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "curves.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/study/study.hpp"
#include "pose_report.hpp"
#include "study/random_bits.hpp"
#include "units.hpp"

namespace hydrapod::page {

namespace {

using model::ParameterRow;

spatial::Pose pose_of(const Json& json) {
  spatial::Pose X;
  for (int i = 0; i < 3; ++i) {
    X.p_BP[i] = json.at("position").at(i).get<double>();
    for (int j = 0; j < 3; ++j) X.R_BP(i, j) = json.at("rotation").at(i).at(j).get<double>();
  }
  return X;
}

/// A matrix as it was written, where one number stands in two places (inertia).
void put(const ParameterRow& row, model::Machine& machine, int of, int element, double value) {
  if (row.set != nullptr)
    row.set(machine, of, element, value);
  else
    *row.make(machine, of, element) = value;
}

void take_numbers(const Json& numbers, const ParameterRow& row, model::Machine& machine) {
  const auto found = numbers.find(std::string(row.path));
  if (found == numbers.end()) return;
  for (std::size_t of = 0; of < found->size(); ++of)
    for (std::size_t element = 0; element < (*found)[of].size(); ++element)
      if (const auto& value = (*found)[of][element]; !value.is_null())
        put(row, machine, static_cast<int>(of), static_cast<int>(element), value.get<double>());
}

void take_words(const Json& words, const ParameterRow& row, model::Machine& machine) {
  const auto found = words.find(std::string(row.path));
  if (found == words.end()) return;
  for (std::size_t of = 0; of < found->size(); ++of)
    if (const int word = (*found)[of].get<int>(); word != 0)
      row.set_word(machine, static_cast<int>(of), word);
}

dynamics::ModelKind kind_of(const std::string& word) {
  using dynamics::ModelKind;
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full})
    if (word == dynamics::name(kind)) return kind;
  throw std::invalid_argument("unknown model " + word);
}

Json bound_json(const model::Bound& bound) {
  Json json = Json::object();
  if (std::isfinite(bound.lowest)) json["lowest"] = bound.lowest;
  if (std::isfinite(bound.highest)) json["highest"] = bound.highest;
  if (bound.more_than_lowest) json["more_than_lowest"] = true;
  if (bound.less_than_highest) json["less_than_highest"] = true;
  return json;
}

Json findings_json(const std::vector<model::Finding>& findings) {
  Json list = Json::array();
  for (const auto& finding : findings)
    list.push_back({{"error", finding.severity == base::Severity::error},
                    {"key", finding.key},
                    {"message", finding.message}});
  return list;
}

}  // namespace

model::Machine machine_of(const Json& editable) {
  model::Machine machine;
  for (const auto& pose : editable.at("poses"))
    machine.poses.push_back({pose.at("name").get<std::string>(), pose_of(pose)});
  for (const auto& row : model::parameter_table()) {
    if (row.find != nullptr) take_numbers(editable.at("numbers"), row, machine);
    if (row.word != nullptr) take_words(editable.at("words"), row, machine);
  }
  for (std::size_t k = 0; k < machine.payload_modes.size(); ++k)
    machine.payload_modes[k].name = editable.at("payload_modes").at(k).get<std::string>();
  return machine;
}

Core::Core(const Json& editable)
    : machine_(machine_of(editable)), kind_(kind_of(editable.at("model").get<std::string>())) {
  know_units(editable.at("scales"));
  for (const auto& pose : editable.at("shown")) {
    Shown shown{pose.at("name").get<std::string>(), {}, pose_of(pose)};
    if (const auto& of = pose.at("of"); !of.is_null()) shown.of = of.get<std::size_t>();
    shown_.push_back(std::move(shown));
  }
  const auto& own = editable.at("own");
  for (auto id : model::parameters(machine_)) {
    const auto path = model::path(machine_, id);
    if (id.of == 0 && own.contains(path)) id.legs = own[path].get<std::uint16_t>();
    if (id.legs != 0) parameters_.emplace_back(path, id);
  }
}

Json Core::parameters() const {
  Json list = Json::array();
  for (const auto& [path, id] : parameters_) {
    const auto& row = model::row_of(id);
    list.push_back({{"path", path},
                    {"unit", model::unit(machine_, id)},
                    {"value", *model::value(machine_, id)},
                    {"bound", bound_json(row.bound)},
                    {"meaning", row.meaning},
                    {"mechanics", model::of_mechanics(machine_, id)},
                    {"single", id.of != 0 && !row.path.starts_with("poses.") &&
                                   !row.path.starts_with("payload_modes.")}});
    if (row.numbers == 1 || id.element == model::whole) continue;
    // files and overrides hold an array as a whole
    const auto key = path.find_last_of(row.kind == model::Kind::tensor ? '.' : '[');
    list.back()["array"] = {path.substr(0, key), path.substr(key)};
  }
  return list;
}

namespace {

/// Legs with joints of their own are not laid out on the circle again.
void spare_own_joints(std::vector<model::Assignment>& assignments) {
  for (const auto& [front, joint] :
       {std::pair{"base.joints.circle.", "leg.*.base_joint"},
        std::pair{"platform.joints.circle.", "leg.*.platform_joint"}}) {
    unsigned own = 0;
    for (const auto& one : assignments)
      if (model::row_of(one.id).path == joint) own |= one.id.legs;
    for (auto& one : assignments)
      if (model::row_of(one.id).path.starts_with(front))
        one.id.legs = static_cast<std::uint16_t>(one.id.legs & ~own);
  }
}

}  // namespace

model::ParameterId Core::parameter(const std::string& path) const {
  const auto known = std::find_if(parameters_.begin(), parameters_.end(),
                                  [&](const auto& one) { return one.first == path; });
  if (known == parameters_.end()) throw std::invalid_argument("there is no number " + path);
  return known->second;
}

model::Machine Core::changed(const Json& set) const {
  std::vector<model::Assignment> assignments;
  for (const auto& pair : set) {
    assignments.push_back({parameter(pair.at(0).get<std::string>()), pair.at(1).get<double>()});
  }
  spare_own_joints(assignments);
  return model::with(machine_, assignments);
}

namespace {

using Displacement = Eigen::Map<const spatial::Vector6>;

spatial::Pose displaced(const model::Machine& machine, const Displacement& d) {
  const auto& neutral = machine.neutral();
  return {spatial::rotation_from_rpy(d.tail<3>()) * neutral.R_BP, neutral.p_BP + d.head<3>()};
}

bool has_error(const std::vector<model::Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const auto& finding) { return finding.severity == base::Severity::error; });
}

}  // namespace

model::NamedPose Core::pose(const model::Machine& machine, const Json& request) const {
  if (const auto given = request.find("displaced"); given != request.end()) {
    const auto d = given->get<std::vector<double>>();
    std::string name;
    for (int i = 0; i < 6; ++i)
      if (d.at(i) != 0.0)
        name += fmt::format("{}{}={} {}", name.empty() ? "" : ", ", spatial::direction_names[i],
                            i < 3 ? 1e3 * d[i] : d[i], i < 3 ? "mm" : "rad");
    return {name.empty() ? machine.poses.front().name : name,
            displaced(machine, Displacement(d.data()))};
  }
  const auto& shown = shown_.at(request.at("pose").get<std::size_t>());
  if (shown.of) return machine.poses.at(*shown.of);
  const auto& neutral = machine.neutral();
  return {shown.name, {shown.X.R_BP * neutral.R_BP, neutral.p_BP + shown.X.p_BP}};
}

Json Core::compute(const Json& request) {
  swept_.clear();
  swept_.reserve(2);
  const auto machine = changed(request.at("set"));
  const auto shown = pose(machine, request);
  auto findings = kinematics::check_machine(machine);
  if (model::find_pose(machine, shown.name) == nullptr)
    for (auto& finding : kinematics::check_pose(machine, shown.X_BP, "--pose " + shown.name))
      findings.push_back(std::move(finding));
  Json json{{"findings", findings_json(findings)}};
  if (has_error(findings)) return json;
  try {
    const auto table = modal::mode_table(machine, shown.X_BP, kind_);
    direct_ = request.value("brief", false);
    json["pose"] =
        direct_ ? report::brief_pose_report(shown, table)
                : report::pose_report(machine, shown, table, request.at("points").get<int>());
    const auto& p_PC = machine.platform.mass_center;
    for (const auto* model : {&table.real, &table.rigid})
      swept_.push_back({responses_at(*model, table, p_PC),
                        direct_ ? damped_shapes(*model) : response::DampedShapes{}});
  } catch (const base::ComputationError& error) {
    json["problem"] = error.what();
  }
  return json;
}

std::vector<double> Core::sweep(const std::vector<double>& omega) const {
  std::vector<double> numbers;
  numbers.reserve((direct_ ? 12 : 72) * swept_.size() * omega.size());
  for (const auto& [model, damped] : swept_)
    if (direct_)
      add_direct_responses(response::direct_responses(model, damped, omega).H, numbers);
    else
      add_responses(response::frequency_response(model, omega), numbers);
  return numbers;
}

std::vector<double> Core::curves(const Json& request) const {
  const auto machine = changed(request.at("set"));
  const auto table = modal::mode_table(machine, pose(machine, request).X_BP, kind_);
  return bode_curves(table, machine.platform.mass_center, request.at("from").get<double>(),
                     request.at("to").get<double>(), request.at("points").get<int>());
}

Json Core::buckling(const Json& request) const {
  const auto machine = changed(request.at("set"));
  const auto shown = pose(machine, request);
  const auto found = dynamics::buckling_payload(machine, shown.X_BP, kind_);
  using dynamics::BucklingStatus;
  if (found.status == BucklingStatus::not_found) return {{"status", "none"}};
  return {{"status", found.status == BucklingStatus::found ? "found" : "buckled"},
          {"payload_kg", found.payload}};
}

Json Core::sensitivities(const Json& request) const {
  constexpr double step = 1e-3;  // relative; the differences are for the order of a list
  const auto lowest = [&](const model::Machine& machine) {
    const auto modes = modal::mode_table(machine, pose(machine, request).X_BP, kind_).real.modes;
    const int k = modal::lowest_platform_mode(modes);
    return k < 0 ? 0.0 : std::log(modes[k].mode.omega);
  };
  Json json = Json::object();
  for (const auto& [path, id] : parameters_) {
    const double value = *model::value(machine_, id);
    if (!model::of_mechanics(machine_, id) || value == 0.0) continue;
    if (id.of != 0 && !model::row_of(id).path.starts_with("poses.")) continue;
    try {
      const model::Assignment more[]{{id, value * (1.0 + step)}},
          less[]{{id, value * (1.0 - step)}};
      const double slope =
          (lowest(model::with(machine_, more)) - lowest(model::with(machine_, less))) /
          (2.0 * step);
      if (std::isfinite(slope)) json[path] = slope;
    } catch (
        const std::exception&) {  // a pose or leg that cannot be: it keeps its place in the list
    }
  }
  return json;
}

namespace {

/// In the order of study::Status.
enum class MapStatus { computed, not_allowed, out_of_reach, no_equilibrium, buckled };

/// Equilibria to start from, of a machine that is like this one.
struct Starts {
  std::optional<dynamics::StaticEquilibrium> flexible{}, rigid{};
  [[nodiscard]] static const dynamics::StaticEquilibrium* of(
      const std::optional<dynamics::StaticEquilibrium>& one) {
    return one ? &*one : nullptr;
  }
};

/// As studies begin their samples: with the equilibria of the nominal machine, where it needed
/// some.
Starts starts_of(const model::Machine& machine, const spatial::Pose& X_BP,
                 dynamics::ModelKind kind) {
  Starts starts;
  try {
    const auto flexible = dynamics::linear_model(machine, X_BP, kind).statics;
    if (flexible.iterations == 0) return {};
    starts.flexible = flexible;
    starts.rigid = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::rigid).statics;
  } catch (const base::ComputationError&) {
    return {};
  }
  return starts;
}

MapStatus resonances_at(const model::Machine& machine, const spatial::Pose& X_BP,
                        dynamics::ModelKind kind, const Starts& starts, double* row) {
  row[16] = kinematics::stroke_left(machine, X_BP);
  if (has_error(kinematics::check_pose(machine, X_BP, ""))) return MapStatus::out_of_reach;
  try {
    const auto flexible = dynamics::linear_model(machine, X_BP, kind, Starts::of(starts.flexible));
    const auto modes = modal::modes_with_elastomers(machine, flexible);
    if (modes.omega2[0] <= 0.0) return MapStatus::buckled;
    const auto rigid =
        dynamics::linear_model(machine, X_BP, dynamics::ModelKind::rigid, Starts::of(starts.rigid));
    const auto found = modal::resonances(flexible, modes, modal::normal_modes(rigid));
    row[1] = found.lowest / base::two_pi;
    row[2] = found.direction + 1;
    row[3] = found.drop;
    row[17] = found.share;
    row[18] = found.peak;
    for (int d = 0; d < 6; ++d) {
      row[4 + d] = found.first[d] / base::two_pi;
      row[10 + d] = found.drops[d];
      row[19 + d] = found.shares[d];
      row[25 + d] = found.peaks[d];
    }
  } catch (const base::ComputationError&) {
    return MapStatus::no_equilibrium;
  }
  return MapStatus::computed;
}

}  // namespace

std::vector<double> Core::map(const Json& request, const std::vector<double>& displacements) const {
  const auto machine = changed(request.at("set"));
  const bool allowed = !has_error(model::validate(machine));
  std::vector<double> rows(displacements.size() / 6 * map_columns,
                           std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < displacements.size() / 6; ++k) {
    double* row = rows.data() + k * map_columns;
    const auto status =
        allowed
            ? resonances_at(machine, displaced(machine, Displacement(displacements.data() + 6 * k)),
                            kind_, {}, row)
            : MapStatus::not_allowed;
    row[0] = static_cast<double>(status);
  }
  return rows;
}

std::vector<double> Core::scatter(const Json& request) const {
  const auto nominal = changed(request.at("set"));
  std::vector<model::Assignment> assignments;
  std::vector<study::Distribution> distributions;
  const auto vary = [&](const std::string& path, double share) {
    const auto id = parameter(path);
    const double value = *model::value(nominal, id);
    assignments.push_back({id, value});
    distributions.push_back(
        {.shape = study::Shape::normal, .a = value, .b = share * std::abs(value)});
  };
  for (const auto& one : request.at("vary")) {
    const auto path = one.at(0).get<std::string>();
    const double share = one.at(1).get<double>();
    if (!one.at(2).get<bool>()) {
      vary(path, share);
      continue;
    }
    for (int leg = 1; leg <= model::leg_count; ++leg)
      vary(fmt::format("leg.{}.{}", leg, path.substr(model::of_legs.size())), share);
  }
  const auto seed = request.at("seed").get<std::uint64_t>();
  const auto from = request.at("from").get<std::uint64_t>();
  const auto count = request.at("count").get<std::size_t>();
  const auto starts = starts_of(nominal, pose(nominal, request).X_BP, kind_);
  std::vector<double> rows(count * map_columns, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t n = 0; n < assignments.size(); ++n)
      assignments[n].value = study::quantile(distributions[n], study::uniform(seed, from + k, n));
    const auto machine = model::with(nominal, assignments);
    double* row = rows.data() + k * map_columns;
    const auto status =
        has_error(model::validate(machine))
            ? MapStatus::not_allowed
            : resonances_at(machine, pose(machine, request).X_BP, kind_, starts, row);
    row[0] = static_cast<double>(status);
  }
  return rows;
}

Json Core::reach(const Json& request) const {
  constexpr int steps = 32, halvings = 12;
  constexpr double widest = 0.7853981633974483;  // [rad]
  const auto machine = changed(request.at("set"));
  double shortest = std::numeric_limits<double>::infinity();
  for (const double length : kinematics::leg_lengths(machine, machine.neutral()))
    shortest = std::min(shortest, length);
  const auto within = [&](int direction, double value) {
    spatial::Vector6 d = spatial::Vector6::Zero();
    d[direction] = value;
    return !has_error(
        kinematics::check_pose(machine, displaced(machine, Displacement(d.data())), ""));
  };
  Json json = Json::array();
  for (int direction = 0; direction < 6; ++direction) {
    const double limit = direction < 3 ? shortest / 3.0 : widest;
    Json ends = Json::array();
    for (const double sense : {-1.0, 1.0}) {
      double inside = 0.0;
      int k = 1;
      while (k <= steps && within(direction, sense * limit * k / steps))
        inside = sense * limit * k++ / steps;
      double outside = sense * limit * std::min(k, steps) / steps;
      for (int n = 0; n < halvings && k <= steps; ++n) {
        const double middle = 0.5 * (inside + outside);
        (within(direction, middle) ? inside : outside) = middle;
      }
      ends.push_back(inside);
    }
    json.push_back(std::move(ends));
  }
  return json;
}

}  // namespace hydrapod::page
