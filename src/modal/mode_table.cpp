#include "hydrapod/modal/mode_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::modal {

namespace {

using spatial::direction_names;

/// "all legs", "leg 3", "legs 1, 2 and 4": the legs that hold 90 % of `per_leg`, "all" from five
/// on.
std::string legs_involved(const Vector6& per_leg) {
  std::array<int, 6> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return per_leg[a] > per_leg[b]; });
  const double wanted = 0.9 * per_leg.sum();
  double held = 0.0;
  int count = 0;
  while (count < 6 && held < wanted) held += per_leg[order[count++]];
  constexpr int nearly_all = 4;  // pairs of a symmetric machine spread unevenly over the legs
  if (count >= nearly_all) return "all legs";
  std::sort(order.begin(), order.begin() + count);
  if (count == 1) return fmt::format("leg {}", order[0] + 1);
  std::string text = fmt::format("legs {}", order[0] + 1);
  for (int k = 1; k < count; ++k)
    text += fmt::format("{} {}", k == count - 1 ? " and" : ",", order[k] + 1);
  return text;
}

/// What gives way: the spring that holds most of the elastic energy.
std::string compliance_text(const EnergyShares& energy) {
  const double oil = energy.oil.sum();
  const double guide = energy.guide_sleeve.sum();
  const double ring = energy.piston_ring.sum();
  const double bending = energy.bending.sum();
  if (energy.payload_elastic > std::max({oil, guide, ring, bending, energy.base_mount}))
    return "payload";
  if (energy.base_mount > std::max({oil, guide, ring, bending})) return "base mount";
  if (bending > std::max({oil, guide, ring})) return "bending of " + legs_involved(energy.bending);
  if (oil >= guide && oil >= ring)
    return fmt::format("{}{} of {}", model::axial_part(energy.leg_type),
                       energy.leg_type == model::LegType::cylinder ? " springs" : "",
                       legs_involved(energy.oil));
  if (guide >= ring) return "guide sleeves of " + legs_involved(energy.guide_sleeve);
  return "piston rings of " + legs_involved(energy.piston_ring);
}

TabledMode tabled(const LinearModel& model, const DampedMode& mode) {
  TabledMode entry{.mode = mode};
  entry.energy = energy_shares(model, mode.real, mode.imaginary);
  entry.moves_platform = entry.energy.platform.sum() >= local_mode_energy;
  entry.label = mode_label(entry.energy, mode.stable);
  return entry;
}

/// φᵀ M ψ squared, for complex shapes its mean over a period; `momentum`: M φ.
double likeness(const ModelVector& momentum, const DampedMode& mode) {
  return std::pow(momentum.dot(mode.real), 2) + std::pow(momentum.dot(mode.imaginary), 2);
}

AnalysedModel analyse(const model::Machine& machine, const spatial::Pose& X_BP,
                      dynamics::ModelKind kind, double ratio) {
  AnalysedModel result{.linear = dynamics::linear_model(machine, X_BP, kind)};
  result.normal = normal_modes(result.linear);
  for (const auto& mode : damped_modes(result.linear, result.normal, ratio))
    result.modes.push_back(tabled(result.linear, mode));
  for (int k = 0; k < result.normal.size(); ++k) {
    const ModelVector momentum = result.linear.M * result.normal.shapes.col(k);
    const auto most_alike = std::max_element(
        result.modes.begin(), result.modes.end(), [&](const TabledMode& a, const TabledMode& b) {
          return likeness(momentum, a.mode) < likeness(momentum, b.mode);
        });
    result.tabled_of_normal.push_back(static_cast<int>(most_alike - result.modes.begin()));
  }
  return result;
}

/// Rows of M of platform, base and payload times a shape: what every kind of model has.
struct OuterMomentum {
  Vector6 platform{};
  ModelVector beyond{};  ///< base and payload

  OuterMomentum(const LinearModel& model, const ModelVector& shape)
      : platform(model.M.topRows<6>() * shape),
        beyond(model.M.bottomRows(model.beyond_legs()) * shape) {}
  /// ψᵀ of it; ψ: a shape of the rigid model.
  [[nodiscard]] double dot(const ModelVector& psi) const {
    const Vector6 of_platform = psi.head<6>();
    return of_platform.dot(platform) + psi.tail(beyond.size()).dot(beyond);
  }
};

/// ψᵀ M_r ψ of a shape of the rigid model.
double outer_energy(const LinearModel& model, const ModelVector& psi) {
  const int beyond = model.beyond_legs();
  const spatial::Matrix6 M_rr = model.M.topLeftCorner<6, 6>();
  const Vector6 of_platform = psi.head<6>();
  const ModelVector of_beyond = psi.tail(beyond);
  return of_platform.dot(M_rr * of_platform) +
         of_beyond.dot(model.M.bottomRightCorner(beyond, beyond) * of_beyond +
                       2.0 * (model.M.bottomLeftCorner(beyond, 6) * of_platform));
}

RigidCounterpart counterpart(const LinearModel& model, const std::vector<TabledMode>& rigid,
                             const DampedMode& mode) {
  const OuterMomentum momentum(model, mode.real), momentum_imaginary(model, mode.imaginary);
  RigidCounterpart best;
  for (int r = 0; r < static_cast<int>(rigid.size()); ++r) {
    const ModelVector& psi = rigid[r].mode.real;
    const double projection =
        std::pow(momentum.dot(psi), 2) + std::pow(momentum_imaginary.dot(psi), 2);
    const double mac = projection / outer_energy(model, psi);
    if (mac > best.mac) best = {r, mac, 0.0};
  }
  const double omega_rigid = rigid[best.mode].mode.omega;
  best.shift = omega_rigid > 0.0 ? mode.omega / omega_rigid - 1.0 : 0.0;
  return best;
}

/// "x", "x + ry": the directions that hold most of the energy of their body, largest first.
std::string directions_text(const Vector6& energy) {
  const Vector6 share = energy / energy.sum();
  std::array<int, 6> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return share[a] > share[b]; });
  constexpr double worth_naming = 0.2;
  std::string text = direction_names[order[0]];
  for (int k = 1; k < 6 && share[order[k]] > worth_naming; ++k)
    text += fmt::format(" + {}", direction_names[order[k]]);
  return text;
}

}  // namespace

std::string platform_directions(const EnergyShares& energy) {
  return directions_text(energy.platform);
}

std::string mode_label(const EnergyShares& energy, bool stable) {
  const std::string unstable = stable ? "" : "unstable (buckling): ";
  if (energy.base.sum() > std::max({energy.platform.sum(), energy.legs.sum(), energy.payload}))
    return unstable + "base " + directions_text(energy.base) + ", " + compliance_text(energy);
  if (energy.platform.sum() < local_mode_energy) {
    if (energy.payload > std::max(energy.base.sum(), energy.legs.sum()))
      return unstable + "local payload mode";
    const double ring = energy.piston_ring.sum(), guide = energy.guide_sleeve.sum();
    const double bending = energy.bending.sum();
    if (energy.base_mount > ring + guide + bending) return unstable + "local base mode";
    if (bending > std::max(ring, guide)) return unstable + "local bending mode";
    return unstable + (ring > guide ? "local piston-ring mode" : "local seal mode");
  }
  return unstable + platform_directions(energy) + ", " + compliance_text(energy);
}

int lowest_platform_mode(const std::vector<TabledMode>& modes) {
  const auto found = std::find_if(modes.begin(), modes.end(),
                                  [](const TabledMode& m) { return m.moves_platform; });
  return found == modes.end() ? -1 : static_cast<int>(found - modes.begin());
}

namespace {

/// `shape` of the model `from` in the coordinates of `to`; what `to` lacks is dropped. Tilts are
/// vectors normal to the leg, with components along its t and a2, which turn with a gimbal axis.
ModelVector in_coordinates(const ModelVector& shape, const LinearModel& from,
                           const LinearModel& to) {
  const int has = dynamics::flexible_per_leg(from.kind),
            wants = dynamics::flexible_per_leg(to.kind);
  ModelVector result = ModelVector::Zero(to.dof());
  result.head<6>() = shape.head<6>();
  for (int leg = 0; leg < model::leg_count; ++leg) {
    const Eigen::Matrix2d turned =
        to.legs[leg].frame.R_BL.leftCols<2>().transpose() * from.legs[leg].frame.R_BL.leftCols<2>();
    for (int k = 0; k < std::min(has, wants); k += 2)
      result.segment<2>(6 + wants * leg + k) = turned * shape.segment<2>(6 + has * leg + k);
  }
  for (int j = 0; j < to.base_count(); ++j)
    for (int k = 0; k < from.base_count(); ++k)
      if (to.base_directions[j] == from.base_directions[k])
        result[to.first_of_base() + j] = shape[from.first_of_base() + k];
  for (int j = 0; j < to.payload_count(); ++j)
    for (int k = 0; k < from.payload_count(); ++k)
      if (to.payload_names[static_cast<std::size_t>(j)] ==
          from.payload_names[static_cast<std::size_t>(k)])
        result[to.first_of_payload() + j] = shape[from.first_of_payload() + k];
  return result;
}

struct Likeness {
  double value;
  int now, before;
};

}  // namespace

std::vector<int> match_modes(const AnalysedModel& now, const AnalysedModel& before) {
  std::vector<Likeness> pairs;
  for (int b = 0; b < static_cast<int>(before.modes.size()); ++b) {
    const ModelVector momentum =
        now.linear.M * in_coordinates(before.modes[b].mode.real, before.linear, now.linear);
    for (int n = 0; n < static_cast<int>(now.modes.size()); ++n)
      pairs.push_back({likeness(momentum, now.modes[n].mode), n, b});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Likeness& a, const Likeness& b) { return a.value > b.value; });
  std::vector<int> match(now.modes.size(), -1);
  std::vector<bool> taken(before.modes.size(), false);
  for (const auto& pair : pairs) {
    if (match[pair.now] >= 0 || taken[pair.before]) continue;
    match[pair.now] = pair.before;
    taken[pair.before] = true;
  }
  return match;
}

ModeTable mode_table(const model::Machine& machine, const spatial::Pose& X_BP,
                     dynamics::ModelKind kind) {
  ModeTable table{.kind = kind, .ratio = modal_ratio(machine)};
  table.rigid = analyse(machine, X_BP, dynamics::ModelKind::rigid, table.ratio.value);
  if (kind == dynamics::ModelKind::rigid) {
    table.real = table.rigid;
    return table;
  }
  table.real = analyse(machine, X_BP, kind, table.ratio.value);
  for (auto& entry : table.real.modes)
    if (entry.moves_platform)
      entry.rigid = counterpart(table.real.linear, table.rigid.modes, entry.mode);
  return table;
}

}  // namespace hydrapod::modal
