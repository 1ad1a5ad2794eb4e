#include "predictions.hpp"

#include <algorithm>
#include <cmath>

#include "evidence.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::diagnosis {

using observation::Observed;
using observation::Resonance;

const control::ControllerParameters* Predictions::controller(const model::NamedPose& pose) {
  if (targets_.observed != Observed::system) return nullptr;
  if (const auto held = targets_.controllers.find(pose.name); held != targets_.controllers.end())
    return &held->second;
  if (!tuned_.contains(pose.name))
    tuned_.emplace(pose.name, simulation::tune_controller(file_.machine, pose.X_BP).parameters);
  return &tuned_.at(pose.name);
}

observation::Observation Predictions::seen(const model::Machine& machine, dynamics::ModelKind kind,
                                           const model::NamedPose& pose) {
  return observation::observe(machine, pose.X_BP, kind, targets_.observed, controller(pose));
}

void Predictions::bring(const model::NamedPose& pose, std::vector<Resonance>& resonances) {
  const auto stated = seen(file_.machine, stated_, pose);
  const auto modes = modal::modes_with_elastomers(file_.machine, stated.mechanics);
  const auto of_mechanics = [&](const observation::ObservedMode& mode) {
    return modes.omega(observation::nearest_mode(stated.mechanics, modes, mode));
  };
  for (auto& resonance : resonances) {
    const auto distance = [&](const observation::ObservedMode& mode) {
      return std::abs(std::log(of_mechanics(mode) / resonance.omega));
    };
    const auto nearest = std::ranges::min_element(stated.modes, {}, distance);
    if (nearest == stated.modes.end()) continue;
    resonance.omega *= nearest->omega() / of_mechanics(*nearest);
  }
}

std::vector<Resonance> Predictions::at(const Hypothesis& e, const model::NamedPose& pose) {
  const auto machine = machine_of(file_, e);
  const bool mechanics = targets_.observed == Observed::mechanics;
  if (!mechanics && !e.by_mechanics)
    return observation::visible_resonances(seen(machine, e.kind, pose));
  auto resonances = observation::visible_resonances(machine, pose.X_BP, e.kind);
  if (!mechanics) bring(pose, resonances);
  return resonances;
}

namespace {

double stiffness(model::Leg leg, double l_m, double pressure) {
  leg.oil_spring.cylinder->air->pressure = pressure;
  return hydraulics::oil_stiffness(leg, l_m);
}

/// With a pressure of its own in each chamber: what either alone adds to the spring.
double stiffness(const model::Leg& leg, double l_m, double cap, double rod) {
  const auto [piston, annulus] = hydraulics::areas(*leg.oil_spring.cylinder);
  const auto modulus = [&](double pressure) {
    auto cylinder = *leg.oil_spring.cylinder;
    cylinder.air->pressure = pressure;
    return hydraulics::effective_bulk_modulus(cylinder);
  };
  auto volume = hydraulics::ChamberVolumes{};
  if (leg.oil_spring.cylinder->volumes == model::VolumeRule::equal)
    volume.cap = volume.rod = hydraulics::control_volume(leg);
  else
    volume = hydraulics::chamber_volumes(*leg.oil_spring.cylinder, *leg.stroke, l_m);
  const auto& cylinder = *leg.oil_spring.cylinder;
  const auto of = [](double beta, double area, double filled, double hose) {
    return hose == 0.0 ? beta * area * area / filled : area * area / (filled / beta + hose);
  };
  return of(modulus(cap), piston, volume.cap, cylinder.cap_line_compliance) +
         of(modulus(rod), annulus, volume.rod, cylinder.rod_line_compliance);
}

}  // namespace

double pressure_at_rest(const model::Machine& machine, dynamics::ModelKind kind,
                        const spatial::Pose& X_BP) {
  const simulation::Plant plant(machine, kind, {}, X_BP);
  const Eigen::VectorXd x = plant.equilibrium(X_BP).x;
  const auto lengths = kinematics::leg_lengths(machine, X_BP);
  const auto of_legs = [&](const auto& one) {
    double sum = 0.0;
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& leg = machine.legs[static_cast<std::size_t>(i)];
      sum += one(i, leg, lengths[i] - leg.rod.length);
    }
    return sum;
  };
  double low = hydraulics::atmospheric_pressure, high = low;
  const double wanted = of_legs([&](int i, const model::Leg& leg, double l_m) {
    const double cap = x[plant.layout().cap(i)], rod = x[plant.layout().rod(i)];
    high = std::max({high, cap, rod});
    low = std::min({low, cap, rod});
    return stiffness(leg, l_m, cap, rod);
  });
  constexpr double precision = 1e-9;
  while (high - low > precision * high) {
    const double middle = 0.5 * (low + high);
    const double found = of_legs(
        [&](int, const model::Leg& leg, double l_m) { return stiffness(leg, l_m, middle); });
    (found < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void settle_air(const model::MachineFile& file, const observation::Targets& targets,
                dynamics::ModelKind kind, std::vector<Cause>& causes) {
  const auto air = std::ranges::find(causes, Cause::Kind::air, &Cause::kind);
  if (air == causes.end() || targets.observed == Observed::mechanics || targets.modes.empty())
    return;
  const auto* pose = find_pose(file.machine, targets.modes.front().pose);
  const auto path = find_parameter(file, "legs.oil_spring.cylinder.air.pressure");
  if (pose == nullptr || !path) return;
  if_possible([&] {
    const auto machine = model::with(file.machine, air->changes);
    const double pressure = pressure_at_rest(machine, kind, pose->X_BP);
    std::erase_if(air->changes, [&](const auto& change) { return change.id == *path; });
    air->changes.push_back({*path, pressure});
  });
}

}  // namespace hydrapod::diagnosis
