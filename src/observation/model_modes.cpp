#include "hydrapod/observation/model_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "hydrapod/kinematics/inverse.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/simulation/system_poles.hpp"

namespace hydrapod::observation {

namespace {

constexpr std::array<std::string_view, 3> descriptions{
    "mechanics with oil springs", "mechanics, hydraulics and valves, without controller",
    "mechanics, hydraulics, valves and controller"};

std::vector<ModelMode> of_mechanics(const model::Machine& machine, const spatial::Pose& X_BP,
                                    dynamics::ModelKind kind) {
  std::vector<ModelMode> modes;
  const auto table = modal::mode_table(machine, X_BP, kind);
  const auto seen = table.real.linear.against_base.cast<std::complex<double>>().eval();
  for (const auto& entry : table.real.modes) {
    if (!(entry.mode.pole.imag() > 0.0)) continue;
    ModelMode mode{.pole = entry.mode.pole, .label = entry.label, .felt = entry.platform_feels};
    mode.motion.real() = entry.mode.real.head<6>();
    mode.motion.imag() = entry.mode.imaginary.head<6>();
    mode.against_base = seen * mode.motion;
    modes.push_back(std::move(mode));
  }
  return modes;
}

/// Parts with a tenth or more, the largest first: "seals 57 %, platform x 31 %".
std::string part_text(const simulation::SystemPole& pole) {
  constexpr double least_named = 0.1;
  std::array<std::size_t, simulation::part_count> order{};
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, [&](auto a, auto b) { return pole.parts[a] > pole.parts[b]; });
  std::string text;
  for (const auto part : order)
    if (text.empty() || pole.parts[part] >= least_named)
      text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ",
                          simulation::name(static_cast<simulation::Part>(part)),
                          100.0 * pole.parts[part]);
  return text;
}

/// The pole's participation of the six platform directions.
double platform_share(const simulation::SystemPole& pole) {
  return std::accumulate(pole.parts.begin(), pole.parts.begin() + 6, 0.0);
}

std::vector<ModelMode> of_system(const model::Machine& machine, const spatial::Pose& X_BP,
                                 dynamics::ModelKind kind, bool closed) {
  const auto poles = simulation::system_poles(
      simulation::linear_system(machine, X_BP, {.kind = kind, .closed = closed}));
  // from P's origin to the mass centre: v_C = v_P + ω × (C − P)
  Eigen::Matrix<double, 6, 6> T = Eigen::Matrix<double, 6, 6>::Identity();
  T.topRightCorner<3, 3>() = -spatial::skew(kinematics::mass_center(machine, X_BP) - X_BP.p_BP);
  std::vector<ModelMode> modes;
  for (const auto& pole : poles.poles)
    if (pole.oscillates())
      modes.push_back({.pole = pole.pole,
                       .motion = T.cast<std::complex<double>>() * pole.ground_motion,
                       .against_base = T.cast<std::complex<double>>() * pole.motion,
                       .label = part_text(pole),
                       .felt = platform_share(pole) >= modal::felt_by_platform});
  return modes;
}

}  // namespace

std::string_view source_description(Source source) {
  return descriptions[static_cast<std::size_t>(source)];
}

std::vector<ModelMode> model_modes(const model::Machine& machine, const spatial::Pose& X_BP,
                                   dynamics::ModelKind kind, Source source) {
  auto modes = source == Source::mechanics
                   ? of_mechanics(machine, X_BP, kind)
                   : of_system(machine, X_BP, kind, source == Source::system);
  std::ranges::stable_sort(modes, {}, &ModelMode::omega);
  return modes;
}

}  // namespace hydrapod::observation
