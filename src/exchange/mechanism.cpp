#include "mechanism.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::exchange {

namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Rotation of the rod in the case with its first and second derivatives of e.
struct RodTurn {
  double first{}, second{};  ///< θ1, θ2 from the straight leg [rad]
  Matrix3 R{Matrix3::Identity()};
  std::array<Vector3, 2> e_i{};
  std::array<std::array<Vector3, 2>, 2> e_ij{};
};

/// Hinges about `a1` and then y that bring z to `e`. A turn about a1 keeps a1·e, which gives θ2.
RodTurn rod_turn(const Vector3& a1, const Vector3& e) {
  RodTurn turn;
  const bool straight = e.x() == 0.0 && e.y() == 0.0;
  if (!straight)
    turn.second = std::asin(a1.dot(e) / std::hypot(a1.x(), a1.z())) - std::atan2(a1.z(), a1.x());
  const Vector3 w(std::sin(turn.second), 0.0, std::cos(turn.second));
  const Vector3 from = w - a1 * a1.dot(w), to = e - a1 * a1.dot(e);
  if (!straight) turn.first = std::atan2(a1.dot(from.cross(to)), from.dot(to));
  const Matrix3 R1 = Eigen::AngleAxisd(turn.first, a1).toRotationMatrix();
  turn.R = R1 * Eigen::AngleAxisd(turn.second, Vector3::UnitY()).toRotationMatrix();
  const Vector3 second = R1 * Vector3(w.z(), 0.0, -w.x());
  turn.e_i = {a1.cross(e), second};
  turn.e_ij[0] = {a1.cross(a1.cross(e)), a1.cross(second)};
  turn.e_ij[1] = {a1.cross(second), -e};
  return turn;
}

/// d and its derivatives by (s, θ1, θ2, u1, u2).
struct SleeveOffset {
  std::array<double, 2> d{};
  std::array<Vector5, 2> J{};
  std::array<Matrix5, 2> H{};
};

SleeveOffset sleeve_offset(const RodTurn& turn, double reach, const Eigen::Vector2d& u) {
  SleeveOffset offset;
  const Vector3 e = turn.R.col(2);
  const double n = e.z();
  for (int k = 0; k < 2; ++k) {
    Vector5 J = Vector5::Zero();
    Matrix5 H = Matrix5::Zero();
    J[0] = -e[k] / n;
    J[3 + k] = 1.0;
    for (int i = 0; i < 2; ++i) {
      const Vector3& e_i = turn.e_i[static_cast<std::size_t>(i)];
      const double g_i = e_i[k] / n - e[k] * e_i.z() / (n * n);
      J[1 + i] = reach * g_i;
      H(0, 1 + i) = H(1 + i, 0) = -g_i;
      for (int j = 0; j < 2; ++j) {
        const Vector3& e_j = turn.e_i[static_cast<std::size_t>(j)];
        const Vector3& e_ij = turn.e_ij[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        H(1 + i, 1 + j) =
            reach *
            (e_ij[k] / n - (e_i[k] * e_j.z() + e_j[k] * e_i.z() + e[k] * e_ij.z()) / (n * n) +
             2.0 * e[k] * e_i.z() * e_j.z() / (n * n * n));
      }
    }
    offset.d[static_cast<std::size_t>(k)] = u[k] + reach * e[k] / n;
    offset.J[static_cast<std::size_t>(k)] = J;
    offset.H[static_cast<std::size_t>(k)] = H;
  }
  return offset;
}

/// What modal ratios and Rayleigh's β add beside a spring k that has the frequency ω.
struct AddedDamping {
  double ratio{}, beta{};
  double of_chambers{};  ///< [N s/m] beside the oil spring, at one frequency
  [[nodiscard]] double beside(double k, double omega) const {
    return beta * k + (omega > 0.0 ? 2.0 * ratio * k / omega : 0.0);
  }
};

void add_sleeve(const model::Leg& leg, const dynamics::LegElement& element, const RodTurn& turn,
                const Eigen::Vector2d& u, const AddedDamping& added, LegMechanism& out) {
  const auto offset = sleeve_offset(turn, leg.guide_sleeve.position - out.p_LR.z(), u);
  // Rod and case that bend are in series with seal and guide ring.
  const double f = element.bending;
  const double seal = leg.guide_sleeve.stiffness, series = 1.0 + f * seal;
  const double k_s = seal / series;
  const double secant = seal + element.k_contact;  // with the guide ring on which the rod lies
  const double k = secant / (1.0 + f * secant);
  const double omega = std::sqrt(k_s / element.M(3, 3)) * std::abs(element.l_mh);
  const double c = leg.guide_sleeve.damping / (series * series) + added.beside(k_s, omega);
  out.sleeve_damping = c;
  const double tangent = secant + element.contact_root.squaredNorm();
  const double of_chords = 1.0 / std::sqrt((1.0 + f * secant) * (1.0 + f * tangent));
  const Vector5 stiffening =
      of_chords * (element.contact_root[0] * offset.J[0] + element.contact_root[1] * offset.J[1]);
  Matrix5 bend = stiffening * stiffening.transpose();
  for (std::size_t i = 0; i < 2; ++i) bend += k * offset.d[i] * offset.H[i];
  for (Eigen::Index j = 0; j < 2; ++j) {
    double alone = bend(1 + j, 1 + j);
    for (const auto& J : offset.J) alone += k * J[1 + j] * J[1 + j];
    out.tilt_alone[static_cast<std::size_t>(j)] = alone;
  }
  const bool straight = offset.d[0] == 0.0 && offset.d[1] == 0.0;
  if (straight && !leg.piston_ring) {
    for (std::size_t i = 0; i < 2; ++i) {  // d1 is moved by θ2, d2 by θ1
      const double arm = offset.J[1 - i][static_cast<Eigen::Index>(1 + i)];
      out.tilt[i] = {k * arm * arm, c * arm * arm, 0.0};
    }
    return;
  }
  for (std::size_t i = 0; i < 2; ++i) out.coupled.push_back({offset.J[i], {k, c, k * offset.d[i]}});
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(bend)};
  for (Eigen::Index i = 0; i < 5; ++i)
    if (solver.eigenvalues()[i] != 0.0)
      out.coupled.push_back({solver.eigenvectors().col(i), {solver.eigenvalues()[i], 0.0, 0.0}});
}

double rod_radius(const model::Leg& leg) {
  const double diameter = leg.rod.diameter.value_or(
      leg.oil_spring.cylinder ? leg.oil_spring.cylinder->rod_diameter : 0.05 * leg.rod.length);
  return 0.5 * diameter;
}

double case_radius(const model::Leg& leg) {
  const double bore =
      leg.oil_spring.cylinder ? leg.oil_spring.cylinder->bore : 3.0 * rod_radius(leg);
  return 0.5 * leg.cylinder_case.diameter.value_or(1.2 * bore);
}

LegMechanism leg_mechanism(const model::Leg& leg, const dynamics::LegElement& element,
                           const dynamics::LegState& state, dynamics::ModelKind kind,
                           model::FlexibleAxes axes, const AddedDamping& added, double oil_omega) {
  LegMechanism out{.R_BL = element.frame.R_BL, .rod_end = leg.rod.length};
  const bool gimbal = axes == model::FlexibleAxes::gimbal;
  if (gimbal) out.base_axis = out.R_BL.transpose() * leg.gimbal_axis;
  const double c1 = std::cos(state.flexible[0]), s1 = std::sin(state.flexible[0]);
  const double c2 = std::cos(state.flexible[1]), s2 = std::sin(state.flexible[1]);
  const auto turn = rod_turn(out.base_axis, Vector3(s2, -s1 * c2, c1 * c2));
  out.R_LR = turn.R;
  out.piston_axis = turn.R.transpose() * out.base_axis;
  out.p_LR = Vector3(state.flexible[2], state.flexible[3], element.l_m);
  out.oil = {element.k_h,
             hydraulics::axial_spring(leg, element.l_m).damping +
                 added.beside(element.k_h, oil_omega) + added.of_chambers,
             state.oil_force};
  if (kind == dynamics::ModelKind::full)
    for (std::size_t i = 0; i < 2; ++i) {
      const double k = leg.piston_ring->stiffness;
      const double omega = std::sqrt(k / element.M(5, 5));
      out.offset[i] = {k, leg.piston_ring->damping + added.beside(k, omega),
                       k * state.flexible[static_cast<Eigen::Index>(2 + i)]};
    }
  model::Leg seals = leg;
  if (kind != dynamics::ModelKind::full) seals.piston_ring.reset();
  if (kind != dynamics::ModelKind::rigid)
    add_sleeve(seals, element, turn, state.flexible.tail<2>(), added, out);
  out.axial_added = leg.added_axial_inertia + hydraulics::line_inertia(leg, element.l_m);
  out.cross_inertia = gimbal ? leg.gimbal_cross_inertia : 0.0;
  out.case_radius = case_radius(leg);
  out.rod_radius = rod_radius(leg);
  out.sleeve = leg.guide_sleeve.position;
  return out;
}

void add_damping_parity(const Machine& machine, const model::ModalRatio& ratio, Parity& parity) {
  if (ratio.value > 0.0)
    parity.push_back(
        {Held::approximate, "damping ratio of every mode",
         fmt::format("{:.3g} % as dampers beside the springs, exact at one frequency "
                     "each{}",
                     100.0 * ratio.value,
                     ratio.is_default ? " (default: the file gives no damping)" : "")});
  if (machine.damping.rayleigh_stiffness != 0.0)
    parity.push_back(
        {Held::approximate, "Rayleigh damping β K", "a damper β k beside every spring"});
  if (machine.damping.rayleigh_mass != 0.0)
    parity.push_back({Held::absent, "Rayleigh damping α M",
                      "the format has no force in proportion to a body's own velocity"});
}

ParityLine axial_parity(model::LegType type) {
  switch (type) {
    case model::LegType::strut:
      return {Held::exact, "struts", "tendons with stiffness and damping"};
    case model::LegType::screw:
      return {Held::exact, "screws", "linear springs with dampers; the motors are locked"};
    case model::LegType::cylinder:
      break;
  }
  return {Held::approximate, "oil columns",
          "linear springs with dampers at this pose; valves are closed, chambers are not held"};
}

/// Whose Rayleigh β the seals' dampers hold.
Machine without_springs(Machine machine) {
  machine.damping.rayleigh_stiffness = 0.0;
  return machine;
}

}  // namespace

Mechanism mechanism(const Machine& of_file, const Pose& X_BP, dynamics::ModelKind kind) {
  const auto machine = dynamics::with_pressed_seals(of_file, kind, X_BP);
  const auto linear = dynamics::linear_model(machine, X_BP, kind);
  const auto rigid = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::rigid);
  const auto modes = modal::normal_modes(linear);
  const auto rigid_modes = modal::normal_modes(rigid);
  const double oil_omega = rigid_modes.omega(0);
  const auto ratio = model::modal_ratio(machine);
  const bool chambers = model::has_chambers(machine);
  AddedDamping added{ratio.value, chambers ? 0.0 : machine.damping.rayleigh_stiffness};
  model::Machine damped = machine;
  if (chambers) damped = dynamics::with_seal_dampers(machine, kind, X_BP);
  Mechanism result{.name = machine.name, .kind = kind, .X_BP = X_BP};
  result.highest = modes.omega(modes.size() - 1);
  result.highest_platform = rigid_modes.omega(rigid_modes.size() - 1);
  double radius = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    if (chambers) {
      damped.legs[i].oil_spring.damping =
          hydraulics::servo_axis(machine, static_cast<int>(i)).friction.viscous;
      added.of_chambers = 0.0;
      for (const auto& arm : linear.arms)
        if (arm.what == dynamics::Relaxing::oil && arm.leg == static_cast<int>(i) && arm.rate > 0.0)
          added.of_chambers += damper_at(arm, oil_omega);
    }
    result.legs[i] = leg_mechanism(damped.legs[i], linear.legs[i], linear.statics.legs[i], kind,
                                   machine.flexible_axes, added, oil_omega);
    radius = std::max(radius, machine.legs[i].platform_joint.norm());
  }
  constexpr double thin = 0.08;  // of the platform's radius, in pictures
  result.plate = thin * radius;
  result.parity = {{Held::exact, "geometry, masses, inertias, gravity", "17 digits"},
                   axial_parity(model::leg_type(machine))};
  if (chambers)
    result.parity.push_back(
        {Held::approximate, "oil damping (damping.oil = \"chambers\")",
         fmt::format("dampers beside the springs, exact at {:.4g} Hz", oil_omega / base::two_pi)});
  add_damping_parity(chambers ? without_springs(machine) : machine, ratio, result.parity);
  if (kind != dynamics::ModelKind::rigid && model::has_elastic_legs(machine))
    result.parity.push_back({Held::approximate, "bending of rods and cases",
                             "a spring in series with the guide sleeve at this pose; mass stays on "
                             "the straight lines between the joints and the piston"});
  if (kind != dynamics::ModelKind::rigid && model::has_elastomers(machine))
    result.parity.push_back({Held::absent, "elastomer seals",
                             "springs of slow motions alone: neither the higher stiffness of quick "
                             "motions nor the loss factor is held"});
  if (modes.omega2[0] < 0.0)
    result.parity.push_back(
        {Held::exact, "UNSTABLE at this pose",
         "the legs buckle; the file moves away from this rest as the machine does"});
  if (machine.base_mount)
    result.parity.push_back({Held::absent, "compliant base", "the base stands still in the file"});
  if (!machine.payload_modes.empty())
    result.parity.push_back({Held::absent, "modes of the payload",
                             "platform and payload are one rigid body in the file"});
  return result;
}

SingleSprings single_springs(const LegMechanism& leg) {
  if (leg.coupled.empty()) return {leg.oil, leg.tilt};
  SingleSprings springs{leg.oil, {}};
  for (std::size_t i = 0; i < 2; ++i) springs.tilt[i].stiffness = leg.tilt_alone[i];
  for (const auto& [along, spring] : leg.coupled) {
    springs.slide.rest_force += along[0] * spring.rest_force;
    springs.slide.damping += along[0] * along[0] * spring.damping;
    for (std::size_t i = 0; i < 2; ++i) {
      const double arm = along[static_cast<Eigen::Index>(1 + i)];
      springs.tilt[i].rest_force += arm * spring.rest_force;
      springs.tilt[i].damping += arm * arm * spring.damping;
    }
  }
  return springs;
}

Principal principal(const Matrix3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(inertia)};
  Principal result{solver.eigenvectors(), solver.eigenvalues()};
  if (result.axes.determinant() < 0.0) result.axes.col(0) = -result.axes.col(0);
  return result;
}

std::string number_text(double x) { return fmt::format("{:.17g}", x); }

std::string vector_text(const Vector3& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string quaternion_text(const Matrix3& R) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  return number_text(q.w()) + " " + vector_text(q.vec());
}

std::string rpy_text(const Matrix3& R) {
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  return vector_text({std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))});
}

std::string xml_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&apos;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out;
}

/// What only MuJoCo's joints have: inertia of their own.
void add_joint_inertia_parity(const Mechanism& parts, Parity& parity) {
  const auto any = [&](double LegMechanism::*inertia) {
    return std::ranges::any_of(parts.legs, [&](const auto& leg) { return leg.*inertia > 0.0; });
  };
  if (any(&LegMechanism::axial_added))
    parity.push_back({Held::absent, "added axial inertia, oil in lines",
                      "joints have no inertia of their own in the format"});
  if (any(&LegMechanism::cross_inertia))
    parity.push_back({Held::absent, "inertia of the gimbals' crosses",
                      "joints have no inertia of their own in the format"});
}

namespace {

/// Parts of legs without mass or inertia get a little of the whole leg's: programs take no links
/// without. Whether there are any.
bool fill_massless_parts(Machine& machine) {
  constexpr double little = 1e-6;
  bool any = false;
  for (auto& leg : machine.legs) {
    auto& tube = leg.cylinder_case;
    auto& rod = leg.rod;
    const double mass = little * (tube.mass + rod.mass),
                 inertia = little * std::max({tube.transverse_inertia, rod.transverse_inertia,
                                              (tube.mass + rod.mass) * rod.length * rod.length});
    const auto fill = [&](double& value, double least) {
      any = any || value == 0.0;
      if (value == 0.0) value = least;
    };
    fill(tube.mass, mass);
    fill(rod.mass, mass);
    fill(tube.transverse_inertia, inertia);
    fill(rod.transverse_inertia, inertia);
  }
  return any;
}

}  // namespace

HeldMechanism held_mechanism(Machine machine, const Pose& X_BP, dynamics::ModelKind kind,
                             MultibodyFormat format) {
  HeldMechanism held{.machine = std::move(machine)};
  held.coupled = format == MultibodyFormat::mjcf;
  held.lose_offset = !held.coupled && kind == dynamics::ModelKind::full;
  held.filled = !held.coupled && fill_massless_parts(held.machine);
  held.parts = mechanism(held.machine, X_BP, held.lose_offset ? dynamics::ModelKind::guide : kind);
  return held;
}

MultibodyFile multibody_file(const Machine& of_file, const Pose& X_BP, dynamics::ModelKind kind,
                             MultibodyFormat format) {
  const bool coupled = format == MultibodyFormat::mjcf;
  const bool struts = model::leg_type(of_file) == model::LegType::strut;
  if (struts && !coupled)
    base::refuse("legs.strut",
                 "has no mass, and links of SDF and URDF need one; expected MJCF, where struts are "
                 "tendons");
  if (coupled && !struts &&
      std::ranges::any_of(of_file.legs, [](const auto& leg) { return leg.rod.mass == 0.0; }))
    base::refuse("legs.rod.mass",
                 "is 0, and MuJoCo closes the loops at the rods' ends with forces that need a mass "
                 "there; expected the mass of the rod, or a part of the case's");
  const auto held = held_mechanism(of_file, X_BP, kind, format);
  const auto& machine = held.machine;
  const auto& parts = held.parts;
  MultibodyFile file{.parity = parts.parity};
  auto& parity = file.parity;
  if (held.filled)
    parity.push_back({Held::approximate, "parts of legs without mass or inertia",
                      "a millionth of the leg's, which links need"});
  if (held.lose_offset)
    parity.push_back({Held::absent, "piston offset in its ring",
                      "three joints in one place need links without mass"});
  if (!coupled) add_joint_inertia_parity(parts, parity);
  const bool bent =
      std::ranges::any_of(parts.legs, [](const auto& l) { return !l.coupled.empty(); });
  if (kind != dynamics::ModelKind::rigid)
    parity.push_back(
        {bent && !coupled ? Held::approximate : Held::exact, "seals, small motions at this pose",
         !bent     ? "two hinges at the piston with stiffness"
         : coupled ? "fixed tendons: the second-order potential about the bent rest"
                   : "spring, damper and moment at rest of each hinge alone; coupling of tilt and "
                     "stroke is left out"});
  if (kind != dynamics::ModelKind::rigid)
    parity.push_back({Held::approximate, "seals, large motions",
                      "the hinges keep the stiffness that they have at this pose"});
  switch (format) {
    case MultibodyFormat::mjcf:
      if (!struts)
        parity.push_back({Held::approximate, "closed loops",
                          "equality constraints; MuJoCo makes them stiff, not rigid"});
      file.text = mjcf_text(machine, parts);
      break;
    case MultibodyFormat::sdf:
      parity.push_back({Held::exact, "closed loops", "ball joints between rods and platform"});
      file.text = sdf_text(machine, parts);
      break;
    case MultibodyFormat::urdf:
      parity.push_back({Held::approximate, "closed loops",
                        "six ball joints in the sidecar; the tree alone falls apart"});
      parity.push_back(
          {Held::approximate,
           fmt::format("springs of {} and seals", model::axial_part(model::leg_type(machine))),
           "in the sidecar"});
      file.text = urdf_text(machine, parts);
      file.sidecar = closures_json(machine, parts);
  }
  return file;
}

}  // namespace hydrapod::exchange
