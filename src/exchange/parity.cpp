/// What each format holds of a machine, as far as it follows from the machine alone.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "measured.hpp"

namespace hydrapod::exchange {

namespace {

constexpr const char* small_motion = "small motions about the operating point";

void add_hydraulics(Parity& parity) {
  parity.push_back({Held::approximate, "friction of the seals",
                    "its viscous part; Coulomb and Stribeck parts have no linear model at rest"});
  parity.push_back({Held::approximate, "valves, end stops, limits of drives and sensors",
                    "their slope at the operating point; saturation and contact are not held"});
}

/// Of matrices of small motions.
ParityLine axial_parity(model::LegType type) {
  switch (type) {
    case model::LegType::strut:
      return {Held::exact, "struts", "springs with a damper"};
    case model::LegType::screw:
      return {Held::exact, "screws", "springs with a damper; the motors are locked"};
    case model::LegType::cylinder:
      break;
  }
  return {Held::approximate, "oil columns", "springs with a damper; valves are closed"};
}

void add_drives(Parity& parity) {
  parity.push_back({Held::approximate, "friction of the motors",
                    "its viscous part; Coulomb's has no linear model at rest"});
  parity.push_back({Held::approximate, "limits of torque and speed, end stops, limits of sensors",
                    "their slope at the operating point; saturation and contact are not held"});
}

/// `rate`: of the fastest motion that grows [1/s]; 0: none.
void add_growth(double rate, Parity& parity) {
  if (rate > 0.0)
    parity.push_back(
        {Held::exact, "UNSTABLE at this pose",
         fmt::format("small motions grow, the fastest by e in {:.3g} s; so they do in the file",
                     1.0 / rate)});
}

/// Of a continuous or a sampled system; 0 where nothing grows beyond rounding.
double growth(const StateSpace& system) {
  if (system.A.size() == 0) return 0.0;
  const auto poles = eigenvalues_of(system);
  constexpr double rounding = 1e-9;
  if (system.sample_time > 0.0) {
    const double largest = poles.cwiseAbs().maxCoeff();
    return largest > 1.0 + rounding ? std::log(largest) / system.sample_time : 0.0;
  }
  const double largest = poles.real().maxCoeff();
  return largest > rounding * poles.cwiseAbs().maxCoeff() ? largest : 0.0;
}

/// Of M q̈ + K q = 0; a free base is held.
double growth(const Superelement& element) {
  const auto held = with_base_held(element);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(held.K, held.M,
                                                                         Eigen::EigenvaluesOnly);
  const double least = solver.eigenvalues()[0];
  return least < 0.0 ? std::sqrt(-least) : 0.0;
}

}  // namespace

bool has_absent(const Parity& parity) {
  return std::ranges::any_of(parity, [](const auto& line) { return line.held == Held::absent; });
}

Parity state_space_parity(const StateSpace& system) {
  Parity parity{{Held::exact, small_motion, "A, B, C, D of the linearised equations, doubles"},
                {Held::approximate, "large motions", "only the slope at this pose is held"}};
  const double rate = growth(system);
  if (system.system == SystemKind::plant && rate > 0.0 && rate <= simulation::slowest_growth)
    parity.push_back({Held::exact, "drift at this pose",
                      fmt::format("without a controller the pose is not held: the platform drifts "
                                  "by e in {:.3g} s",
                                  1.0 / rate)});
  else
    add_growth(rate, parity);
  const auto has_state = [&](const char* name) {
    return std::ranges::any_of(
        system.states, [&](const auto& s) { return s.name.find(name) != std::string::npos; });
  };
  if (has_state(".p_cap")) add_hydraulics(parity);
  if (has_state(".torque_integral")) add_drives(parity);
  if (system.pade_order > 0)
    parity.push_back({Held::approximate, "delay of the controller",
                      fmt::format("{:.4g} ms as Padé {}/{}", 1e3 * system.delay, system.pade_order,
                                  system.pade_order)});
  if (system.reduction)
    parity.push_back(
        {Held::approximate, "states",
         fmt::format(
             "{} of {}; each response is within {:.3g} of its magnitude (output_scales times "
             "input_scales) at every frequency",
             system.states.size(), system.reduction->from, system.reduction->bound)});
  if (system.sample_time > 0.0)
    parity.push_back({Held::exact, "motion at the samples",
                      fmt::format("inputs held over {:.6g} ms", 1e3 * system.sample_time)});
  return parity;
}

Parity modal_model_parity(dynamics::ModelKind kind) {
  Parity parity{
      {Held::approximate, "frequencies, damping ratios, shapes, modal masses",
       "six digits (E13.5), as Universal Files have them"},
      {Held::exact, "geometry", "joints of platform and base as nodes, legs as lines or rods"}};
  if (kind != dynamics::ModelKind::rigid)
    parity.push_back({Held::approximate, "shapes of the legs",
                      "motion of the platform only; rod tilt and piston offset have no node"});
  return parity;
}

Parity superelement_parity(const Machine& machine, const Superelement& element, bool nastran) {
  Parity parity{
      {nastran ? Held::approximate : Held::exact, "numbers",
       nastran ? "11 digits or more (large field, 16 characters)" : "17 digits"},
      {Held::exact, small_motion, "M, K, C at the interface, gravity's preload terms included"}};
  add_growth(growth(element), parity);
  if (element.first_left_out > 0.0)
    parity.push_back({Held::approximate, "modes of the legs",
                      fmt::format("those from {:.4g} Hz on, with the interface held, are left out",
                                  element.first_left_out / base::two_pi)});
  if (element.is_base_free) {
    parity.push_back(
        {Held::exact, "free base",
         "its six directions at its origin are coordinates; add its mass and its mount"});
    if (!machine.gravity.isZero(0.0))
      parity.push_back({Held::approximate, "weight on a base that tilts",
                        "the moment of the weight against the mount is left out"});
    if (model::modal_ratio(machine).value > 0.0)
      parity.push_back({Held::approximate, "damping ratio of every mode",
                        "dampers against the base, exact where it stands still"});
  } else if (!machine.base_mount) {
    parity.push_back({Held::exact, "base", "stands still"});
  } else if (element.base_directions.empty()) {
    parity.push_back({Held::exact, "base",
                      "its mount is in series with the legs: neither they nor the base have "
                      "inertia"});
  }
  parity.push_back(axial_parity(model::leg_type(machine)));
  return parity;
}

}  // namespace hydrapod::exchange
