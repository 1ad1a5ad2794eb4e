#include "machine_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::study {

namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using dynamics::ModelMatrix;
using dynamics::ModelVector;
using modal::NormalModes;
/// A row per followed mode, a column per mode of a sample.
using MacMatrix = ModelMatrix;
using MacVector = ModelVector;

double hertz(double omega) { return omega / base::two_pi; }

/// Share of a mode's kinetic energy that the platform has; φᵀ M φ = 1.
double platform_share(const LinearModel& model, const NormalModes& modes, int k) {
  const spatial::Vector6 phi = modes.shapes.col(k).head<6>();
  return phi.dot(model.platform_mass * phi);
}

/// Pairs (nominal, mode) in falling order of MAC, one to one. φ_n is normalised in the nominal mass
/// matrix, φ in that of the sample: both enter the denominator.
struct Followed {
  std::vector<int> mode{};
  double least_mac{1.0};
};

/// Shapes of the followed modes times M, and those times the shapes of a sample.
template <int dof>
MacMatrix squared_products(const ModelMatrix& nominal, const LinearModel& model,
                           const NormalModes& modes, MacVector& mass) {
  using Square = Eigen::Matrix<double, dof, dof>;
  using Columns = Eigen::Matrix<double, dof, Eigen::Dynamic, 0, dof, dynamics::max_dof>;
  const Eigen::Map<const Square> M(model.M.data()), shapes(modes.shapes.data());
  const Eigen::Map<const Columns> psi(nominal.data(), dof, nominal.cols());
  const Columns momentum = M.lazyProduct(psi);
  mass = psi.cwiseProduct(momentum).colwise().sum().transpose();
  const MacMatrix common = momentum.transpose().lazyProduct(shapes);
  return common.cwiseAbs2();
}

MacMatrix squared_products(const Nominal& nominal, const LinearModel& model,
                           const NormalModes& modes, MacVector& mass) {
  const ModelMatrix& psi = nominal.followed_shapes;
  switch (model.dof()) {
    case 6:
      return squared_products<6>(psi, model, modes, mass);
    case 18:
      return squared_products<18>(psi, model, modes, mass);
    case 30:
      return squared_products<30>(psi, model, modes, mass);
    default:
      break;
  }
  const ModelMatrix momentum = model.M * psi;
  mass = psi.cwiseProduct(momentum).colwise().sum().transpose();
  const MacMatrix common = momentum.transpose() * modes.shapes;
  return common.cwiseAbs2();
}

Followed follow(const Nominal& nominal, const LinearModel& model, const NormalModes& modes) {
  const auto count = static_cast<int>(nominal.followed.size());
  Followed result{.mode = std::vector<int>(nominal.followed.size(), -1)};
  if (model.dof() != nominal.flexible.dof()) return result;
  MacVector mass;
  MacMatrix mac = squared_products(nominal, model, modes, mass);
  for (int n = 0; n < count; ++n) mac.row(n) /= mass[n];
  std::array<int, dynamics::max_dof> like;  // per followed mode, the mode most like it
  for (int n = 0; n < count; ++n) mac.row(n).maxCoeff(&like[n]);
  for (int taken = 0; taken < count; ++taken) {
    int n = 0;
    for (int m = 1; m < count; ++m)
      if (mac(m, like[m]) > mac(n, like[n])) n = m;
    const int k = like[n];
    result.mode[static_cast<std::size_t>(n)] = k;
    result.least_mac = std::min(result.least_mac, mac(n, k));
    mac.row(n).setConstant(-2.0);
    mac.col(k).setConstant(-1.0);
    mac(n, k) = -2.0;
    for (int m = 0; m < count; ++m)
      if (like[m] == k) mac.row(m).maxCoeff(&like[m]);
  }
  return result;
}

}  // namespace

std::vector<Column> columns_of(const Kept& kept) {
  const std::string of = fmt::format("{} frequency of the ", frequency_kind(kept.machine));
  std::vector<Column> columns{
      {"status", "1",
       "0 computed, 1 number not allowed, 2 pose out of reach, 3 no equilibrium, 4 buckled"},
      {"lowest", "Hz", of + "lowest mode with platform motion"},
      {"direction", "1", "its main direction, 1 … 6 for x … rz", {}, "lowest"},
      {"drop", "1", "its frequency against that of its counterpart with rigid legs, share lost",
       Worse::more},
      {"share", "1", "part of that counterpart which is in it (MAC)", {}, "drop"},
      {"peak", "1", "its peak over that of the counterpart", {}, "drop"}};
  for (const char* name : spatial::direction_names)
    columns.push_back({name, "Hz", fmt::format("{}first resonance in {}", of, name)});
  for (const char* name : spatial::direction_names)
    columns.push_back({fmt::format("drop_{}", name), "1",
                       fmt::format("first resonance in {} against rigid legs, share lost", name),
                       Worse::more});
  for (const char* name : spatial::direction_names)
    columns.push_back({fmt::format("share_{}", name),
                       "1",
                       fmt::format("part of the motion in {} that its first resonance holds", name),
                       {},
                       fmt::format("drop_{}", name)});
  for (const char* name : spatial::direction_names)
    columns.push_back(
        {fmt::format("peak_{}", name),
         "1",
         fmt::format("peak of the first resonance in {} over that with rigid legs", name),
         {},
         fmt::format("drop_{}", name)});
  columns.push_back({"condition", "1", "condition of the Jacobian", Worse::more});
  columns.push_back({"stroke", "m", "least stroke left of any leg, negative beyond it"});
  columns.push_back({"mac", "1", "least MAC of the followed modes with the nominal ones"});
  for (std::size_t k = 0; k < kept.nominal.followed.size(); ++k)
    columns.push_back({fmt::format("mode{}", k + 1), "Hz",
                       fmt::format("{}mode that is like mode {} of the nominal machine, {:.4g} Hz",
                                   of, kept.nominal.followed[k] + 1,
                                   hertz(kept.nominal.modes.omega(kept.nominal.followed[k])))});
  return columns;
}

namespace {

/// What a column says, and of which mode or direction.
struct Said {
  std::string_view what{}, of{};
};

constexpr std::array<std::string_view, 3> groups{"frequencies", "modes", "drops"};

Said said_by(std::string_view column) {
  if (column == "direction") return {column, "lowest"};
  if (column == "lowest" || spatial::direction_from_name(column)) return {"frequency", column};
  if (column == "mac" || column.starts_with("mode")) return {"mode", column};
  for (const std::string_view against_rigid : {"drop", "share", "peak"}) {
    if (column == against_rigid) return {"drop", "lowest"};
    if (column.starts_with(against_rigid) && column[against_rigid.size()] == '_')
      return {"drop", column.substr(against_rigid.size() + 1)};
  }
  return {column, column};
}

bool belongs_to(std::string_view column, std::string_view word) {
  const auto own = said_by(column), asked = said_by(word);
  const bool frequency = own.what == "frequency", drop = own.what == "drop";
  if (word == "frequencies") return frequency || own.what == "direction";
  if (word == "modes") return own.what == "mode";
  if (word == "drops") return drop || frequency;
  if (column == word) return true;
  if (asked.what == "mode") return column == "mac";
  if (asked.what == "direction") return column == "lowest";
  return asked.what == "drop" && own.of == asked.of && (drop || frequency);
}

}  // namespace

std::vector<std::string> columns_of_word(const std::vector<Column>& columns,
                                         std::string_view word) {
  std::vector<std::string> names;
  for (const auto& column : columns)
    if (belongs_to(column.name, word)) names.push_back(column.name);
  // what is only said beside a word does not make it one
  if (std::ranges::count(groups, word) + std::ranges::count(names, word) == 0) names.clear();
  return names;
}

std::optional<std::string> why_no_column(const model::Machine& machine, ModelKind kind,
                                         std::string_view name) {
  const bool rigid = kind == ModelKind::rigid;
  const bool struts = model::leg_type(machine) == model::LegType::strut;
  const auto has_stroke = [](const model::Leg& leg) { return leg.stroke.has_value(); };
  const auto of_direction = [&](std::string_view start) {
    return name.starts_with(start) && spatial::direction_from_name(name.substr(start.size()));
  };
  const bool drop = name == "drop" || name == "share" || name == "peak" || of_direction("drop_") ||
                    of_direction("peak_");
  if (drop && rigid && struts)
    return "compares flexible legs with rigid ones, and plain struts have no guide sleeves";
  if (drop && rigid)
    return "compares flexible legs with rigid ones, which --model rigid has alone; expected "
           "--model guide or full";
  if (name != "stroke" || std::ranges::any_of(machine.legs, has_stroke)) return {};
  if (struts) return "is what pistons have left, and plain struts have none";
  return "needs the range of the pistons; expected legs.stroke";
}

Nominal nominal_of(const model::Machine& machine, const MachineOptions& options) {
  Nominal nominal{.flexible = dynamics::linear_model(machine, options.X_BP, options.kind),
                  .rigid = dynamics::linear_model(machine, options.X_BP, ModelKind::rigid)};
  nominal.modes = modal::modes_with_elastomers(machine, nominal.flexible);
  for (int k = 0; k < nominal.modes.size(); ++k)
    if (static_cast<int>(nominal.followed.size()) < options.modes &&
        platform_share(nominal.flexible, nominal.modes, k) >= modal::local_mode_energy)
      nominal.followed.push_back(k);
  nominal.followed_shapes.resize(nominal.flexible.dof(), nominal.followed.size());
  for (std::size_t n = 0; n < nominal.followed.size(); ++n)
    nominal.followed_shapes.col(n) = nominal.modes.shapes.col(nominal.followed[n]);
  if (nominal.modes.omega2[0] <= 0.0)
    throw base::ComputationError(
        "the nominal machine is buckled, so that its modes cannot be followed; `hydrapod check` "
        "shows the payload at which it buckles");
  return nominal;
}

void outputs_of(const Kept& kept, const LinearModel& flexible, const NormalModes& modes,
                const NormalModes& rigid, std::span<double> outputs) {
  if (modes.omega2[0] <= 0.0) return set(outputs, Status::buckled);
  const auto found = modal::resonances(flexible, modes, rigid, kept.options.resonance_share);
  if (found.direction >= 0) {
    outputs[Layout::lowest] = hertz(found.lowest);
    outputs[Layout::direction] = found.direction + 1;
    outputs[Layout::drop] = found.drop;
    outputs[Layout::share] = found.share;
    outputs[Layout::peak] = found.peak;
  }
  for (std::size_t d = 0; d < platform_rows; ++d) {
    const auto k = static_cast<Eigen::Index>(d);
    outputs[Layout::resonance + d] = hertz(found.first[k]);
    outputs[Layout::resonance_drop + d] = found.drops[k];
    outputs[Layout::resonance_share + d] = found.shares[k];
    outputs[Layout::resonance_peak + d] = found.peaks[k];
  }
  const auto followed = follow(kept.nominal, flexible, modes);
  outputs[Layout::mac] = followed.least_mac;
  for (std::size_t k = 0; k < followed.mode.size(); ++k)
    if (followed.mode[k] >= 0) outputs[Layout::modes + k] = hertz(modes.omega(followed.mode[k]));
}

void take_rigid(const Kept& kept, const NormalModes& rigid, OutputNumbers<double>& found) {
  const ModelVector momentum = Eigen::Map<const spatial::Vector6>(found.momentum);
  const auto like = modal::counterpart(momentum, rigid);
  found.counterpart = rigid.omega2[like.mode];
  found.counterpart_share = like.share;
  for (int d = 0; d < platform_rows; ++d) {
    const int k = modal::first_resonance(rigid, d, kept.options.resonance_share);
    found.resonance_rigid[d] = k < 0 ? missing : rigid.omega2[k];
    found.own_rigid[d] = k < 0 ? missing : std::pow(rigid.shapes(d, k), 2);
  }
}

void outputs_of(const Kept& kept, const OutputNumbers<double>& found, std::span<double> outputs) {
  if (found.least <= 0.0) return set(outputs, Status::buckled);
  const auto frequency = [](double omega2) { return hertz(std::sqrt(omega2)); };
  const auto lost = [](double omega2, double rigid) { return 1.0 - std::sqrt(omega2 / rigid); };
  if (!std::isnan(found.lowest)) {
    outputs[Layout::lowest] = frequency(found.lowest);
    outputs[Layout::direction] = found.direction + 1.0;
    outputs[Layout::drop] = lost(found.lowest, found.counterpart);
    outputs[Layout::share] = found.counterpart_share;
    outputs[Layout::peak] = found.counterpart_share * found.counterpart / found.lowest;
  }
  for (std::size_t d = 0; d < platform_rows; ++d) {
    if (std::isnan(found.resonance[d]) || std::isnan(found.resonance_rigid[d])) continue;
    outputs[Layout::resonance + d] = frequency(found.resonance[d]);
    outputs[Layout::resonance_drop + d] = lost(found.resonance[d], found.resonance_rigid[d]);
    outputs[Layout::resonance_share + d] = found.own[d] / found.all[d];
    outputs[Layout::resonance_peak + d] =
        found.own[d] * found.resonance_rigid[d] / (found.own_rigid[d] * found.resonance[d]);
  }
  outputs[Layout::mac] = found.mac;
  for (std::size_t k = 0; k < kept.nominal.followed.size(); ++k)
    outputs[Layout::modes + k] = frequency(found.followed[k]);
}

}  // namespace hydrapod::study
