#include "elastomers.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::dynamics {

namespace {

constexpr double step = 8.0;  ///< between the rates of neighbouring arms

/// Of bisections: they end where two numbers are neighbours, and always.
constexpr double rounding = std::numeric_limits<double>::epsilon();
constexpr int halvings = 200;

/// Rates of the arms over ω, the middle one at `center`.
std::array<double, arms_per_seal> rates_about(double center) {
  return {center / step, center, center * step};
}

/// Σ Re and Σ Im of iω/(iω + λ) for rates λ/ω.
struct ArmSums {
  double storage{}, loss{};
  explicit ArmSums(const std::array<double, arms_per_seal>& rates) {
    for (const double rate : rates) {
      storage += 1.0 / (1.0 + rate * rate);
      loss += rate / (1.0 + rate * rate);
    }
  }
};

/// By their rates; arms of the same rate are one and one without stiffness.
SealArms joined(SealArms arms) {
  std::sort(arms.begin(), arms.end(),
            [](const SealArm& a, const SealArm& b) { return a.rate < b.rate; });
  for (std::size_t j = arms_per_seal - 1; j > 0; --j)
    if (arms[j].rate - arms[j - 1].rate <= rounding * arms[j].rate) {
      arms[j - 1].stiffness += arms[j].stiffness;
      arms[j].stiffness = 0.0;
    }
  return arms;
}

void press(double pressure, double& stiffness, std::optional<model::Elastomer>& elastomer) {
  if (!elastomer) return;
  const double over = pressure - hydraulics::atmospheric_pressure;
  stiffness *= 1.0 + elastomer->pressure_stiffening * std::max(over, 0.0);
  elastomer->pressure_stiffening = 0.0;
}

}  // namespace

SealArms seal_arms(double stiffness, const model::Elastomer& elastomer) {
  SealArms arms;
  if (elastomer.arms) {
    for (std::size_t j = 0; j < arms_per_seal; ++j)
      arms[j] = {.stiffness = elastomer.arms->strength[static_cast<int>(j)] * stiffness,
                 .rate = 1.0 / elastomer.arms->time[static_cast<int>(j)]};
    return arms;
  }
  if (!elastomer.dynamic_ratio || !elastomer.loss_factor || !elastomer.frequency)
    throw std::invalid_argument(
        "elastomer: neither arms nor a dynamic ratio with loss factor and frequency are given");
  const double ratio = *elastomer.dynamic_ratio, growth = ratio - 1.0;
  const double wanted = *elastomer.loss_factor * ratio / growth;
  // loss/storage of the arms grows with their rates as long as these are not far apart.
  double low = 1e-9 * std::min(1.0, wanted), high = 1e3 * std::max(1.0, wanted) * step;
  for (int k = 0; k < halvings && high > low * (1.0 + rounding); ++k) {
    const double middle = std::sqrt(low * high);
    const ArmSums sums(rates_about(middle));
    (sums.loss < wanted * sums.storage ? low : high) = middle;
  }
  const auto rates = rates_about(std::sqrt(low * high));
  const double each = growth * stiffness / ArmSums(rates).storage;
  for (std::size_t j = 0; j < arms_per_seal; ++j)
    arms[j] = {.stiffness = each, .rate = base::two_pi * *elastomer.frequency * rates[j]};
  return arms;
}

SealArms arms_in_series(const SealArms& arms, double k, double f) {
  constexpr double least = 1e-9;  // of the arms' share in series: below, they are what they were
  if (!(f * (arms[0].stiffness + arms[1].stiffness + arms[2].stiffness) > least)) return arms;
  const auto sorted = joined(arms);
  // 1 + f k(−μ), which falls from ∞ (from 1 + f k at μ = 0) to −∞ between two rates.
  const auto excess = [&](double mu) {
    double sum = 1.0 + f * k;
    for (const auto& arm : sorted)
      if (arm.stiffness > 0.0) sum += f * arm.stiffness * mu / (mu - arm.rate);
    return sum;
  };
  SealArms result = sorted;
  double from = 0.0;
  for (std::size_t j = 0; j < arms_per_seal; ++j) {
    if (sorted[j].stiffness == 0.0) continue;
    double low = from, high = sorted[j].rate;
    from = high;
    for (int n = 0; n < halvings && high - low > rounding * high; ++n) {
      const double middle = 0.5 * (low + high);
      (excess(middle) > 0.0 ? low : high) = middle;
    }
    double slope = 0.0;  // of k(p) at −μ
    for (const auto& arm : sorted)
      if (arm.stiffness > 0.0)
        slope += arm.stiffness * arm.rate / ((arm.rate - low) * (arm.rate - low));
    const double chords_per_seal = 1.0 + f * k;
    result[j] = {.stiffness = chords_per_seal * chords_per_seal / (f * f * slope * low),
                 .rate = low};
  }
  return result;
}

void fill_seal_arms(const model::Machine& machine, LinearModel& model) {
  if (model.kind == ModelKind::rigid) return;
  using Rows = Eigen::Matrix<double, 2, leg_coordinates>;
  const auto add = [&](int leg, double stiffness, const model::Elastomer& elastomer, Relaxing what,
                       const Rows& per_x) {
    double closed = 0.0;
    auto arms = seal_arms(stiffness, elastomer);
    const double f = model.legs[leg].bending;
    if (what == Relaxing::sleeve && f > 0.0) arms = arms_in_series(arms, stiffness, f);
    for (const auto& arm : arms) {
      if (arm.stiffness == 0.0) continue;
      closed += arm.stiffness;
      for (const int axis : {0, 1})
        model.arms.push_back({.leg = leg,
                              .stiffness = arm.stiffness,
                              .rate = arm.rate,
                              .s_y = per_x.row(axis),
                              .what = what,
                              .axis = axis});
    }
    return closed;
  };
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    auto& element = model.legs[i];
    if (const auto& sleeve = leg.guide_sleeve; sleeve.elastomer) {
      const double closed =
          add(i, sleeve.stiffness, *sleeve.elastomer, Relaxing::sleeve, element.d_x);
      element.K += closed * element.d_x.transpose() * element.d_x;
      element.k_s += closed;
    }
    if (model.kind != ModelKind::full || !leg.piston_ring->elastomer) continue;
    const double closed = add(i, leg.piston_ring->stiffness, *leg.piston_ring->elastomer,
                              Relaxing::ring, element.u_x);
    element.K += closed * element.u_x.transpose() * element.u_x;
    element.k_g += closed;
  }
}

ModelMatrix slow_stiffness(const LinearModel& model) {
  ModelMatrix K = model.K;
  for (const auto& arm : model.arms)
    if (arm.what != Relaxing::oil) K -= arm.stiffness * arm.s_y * arm.s_y.transpose();
  return K;
}

void require_slow_stiffness(const LinearModel& model) {
  const auto stands = [](const ModelMatrix& K) {
    return Eigen::LLT<ModelMatrix>(K).info() == Eigen::Success;
  };
  if (stands(slow_stiffness(model)) || !stands(model.K)) return;
  throw base::ComputationError(
      "the legs fold at this pose under the static stiffness of their seals, `stiffness`, which "
      "does not carry the load (see `hydrapod check`)");
}

model::Machine with_pressed_seals(model::Machine machine, ModelKind kind,
                                  const spatial::Pose& X_BP) {
  if (kind == ModelKind::rigid || !model::has_pressed_seals(machine)) return machine;
  const auto statics = static_equilibrium(machine, X_BP, ModelKind::rigid);
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    const auto axis = hydraulics::servo_axis(machine, i);
    const double force = 0.0 - statics.legs[i].oil_force;
    const auto rest = hydraulics::hydraulic_rest(axis, machine.hydraulics.supply, force);
    if (!rest.found)
      throw base::ComputationError(fmt::format(
          "pressure_stiffening of the seals: a supply of {:.4g} MPa cannot hold the static force "
          "of {:.4g} N on leg {} at this pose, so that the pressures are not known",
          1e-6 * machine.hydraulics.supply.pressure, force, i + 1));
    press(rest.p_rod, leg.guide_sleeve.stiffness, leg.guide_sleeve.elastomer);
    if (leg.piston_ring)
      press(0.5 * (rest.p_cap + rest.p_rod), leg.piston_ring->stiffness,
            leg.piston_ring->elastomer);
  }
  return machine;
}

}  // namespace hydrapod::dynamics
