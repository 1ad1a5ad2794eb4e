// Rows of the machine file: the mechanics of the legs.
#include "parameter_rows.hpp"

namespace hydrapod::model::rows {

namespace {

constexpr Bound tilt{.lowest = 0.0,
                     .highest = std::numbers::pi * (1.0 + 1e-9),
                     .more_than_lowest = true,
                     .expected = "no more than 180 deg",
                     .shown_in = "deg",
                     .shown_size = std::numbers::pi / 180.0};

/// Axes get the length one; a zero axis stays zero for validate() to find.
void make_units(Machine& machine, unsigned legs) {
  for (std::size_t i = 0; i < leg_count; ++i) {
    Vector3& axis = machine.legs[i].gimbal_axis;
    const double largest = axis.cwiseAbs().maxCoeff();
    if ((legs >> i & 1U) == 0 || largest == 0.0 || !axis.allFinite()) continue;
    axis = (axis / largest).normalized();
  }
}

constexpr ParameterRow of_gimbal_axis(ParameterRow made) {
  made.finish = make_units;
  return made;
}

void drop_cylinder(Machine& machine, int leg) {
  machine.legs[static_cast<std::size_t>(leg)].oil_spring.cylinder.reset();
}
void drop_stiffness(Machine& machine, int leg) {
  machine.legs[static_cast<std::size_t>(leg)].oil_spring.stiffness.reset();
}

/// `seal`: the way to its elastomer.
template <auto... seal>
void drop_arms(Machine& machine, int leg) {
  if (auto* elastomer = member<false, seal...>(machine, leg)) elastomer->arms.reset();
}
template <auto... seal>
void drop_ratio(Machine& machine, int leg) {
  auto* elastomer = member<false, seal...>(machine, leg);
  if (elastomer == nullptr) return;
  elastomer->dynamic_ratio.reset();
  elastomer->loss_factor.reset();
  elastomer->frequency.reset();
}

constexpr Bound above_one{.lowest = 1.0, .more_than_lowest = true, .expected = "more than 1"};

constexpr std::string_view softening_of(std::string_view path) {
  return path.starts_with("legs.guide_sleeve") ? "legs.guide_sleeve.elastomer.softening"
                                               : "legs.piston_ring.elastomer.softening";
}

/// The keys of a seal's elastomer; `seal`: the way to it.
template <int which, auto... seal>
constexpr ParameterRow of_elastomer(std::string_view path) {
  if constexpr (which == 0)
    return table(path, optional,
                 "what makes the O-ring a spring that depends on frequency, amplitude and pressure "
                 "(docs/theory/elastomers.md); without the table it is an ideal spring");
  if constexpr (which == 1)
    return instead_of(
        drop_arms<seal...>,
        number<seal..., &Elastomer::dynamic_ratio>(
            path, "1", otherwise("that of `arms` or `table`"), usual(1e-3, 6.0, above_one),
            "stiffness at `frequency` over `stiffness`, which is then that of slow motions; more "
            "than 1, of O-rings 1.3 to 3",
            shown("1.6")));
  if constexpr (which == 2)
    return instead_of(
        drop_arms<seal...>,
        number<seal..., &Elastomer::loss_factor>(
            path, "1", otherwise("that of `arms` or `table`"), usual(0.01, 1.5, positive),
            "η at `frequency`: imaginary over real part of the stiffness, of O-rings 0.1 to 0.3",
            shown("0.2")));
  if constexpr (which == 3)
    return instead_of(drop_arms<seal...>,
                      number<seal..., &Elastomer::frequency>(
                          path, "Hz", otherwise("–"), usual(0.01, 1e3, positive),
                          "at which `dynamic_ratio` and `loss_factor` hold", shown("10 Hz")));
  if constexpr (which == 4)
    return number<seal..., &Elastomer::softening>(
        path, "1", standard, below_one,
        "share of `stiffness` that large amplitudes take away (Payne effect); used by `modes "
        "--amplitude` and simulations");
  if constexpr (which == 5)
    return used_with(softening_of(path),
                     number<seal..., &Elastomer::softening_amplitude>(
                         path, "m", standard, usual(1e-6, 1e-2, positive),
                         "amplitude at which half of `softening` is reached; used with "
                         "`softening`"));
  if constexpr (which == 6)
    return used_with(softening_of(path),
                     number<seal..., &Elastomer::softening_time>(
                         path, "s", standard, usual(1e-2, 1e3, positive),
                         "τ of simulations, in which the seal softens and recovers: the amplitude "
                         "is a running mean over it, much longer than a period; used with "
                         "`softening`"));
  if constexpr (which == 7)
    return number<seal..., &Elastomer::pressure_stiffening>(
        path, "1/Pa", standard, usual(1e-10, 1e-6, not_negative),
        "growth of `stiffness` per pressure above that of the atmosphere: of the rod side at the "
        "guide sleeve, of the mean of both sides at the piston ring");
  if constexpr (which == 8) {
    auto made = row(Kind::rows, path, {}, optional, {},
                    "in place of `dynamic_ratio`, `loss_factor` and `frequency`: measured rows of "
                    "frequency [Hz], `dynamic_ratio` and `loss_factor`, to which three arms are "
                    "fitted",
                    {});
    made.in_code = true;
    made.numbers = 0;
    return made;
  }
  if constexpr (which == 9)
    return instead_of(
        drop_ratio<seal...>,
        table(path, optional,
              "in place of the same: three Maxwell arms (Prony series) beside `stiffness`"));
  if constexpr (which == 10)
    return number<seal..., &Elastomer::arms, &MaxwellArms::strength>(
        path, "1", required, not_negative, "g, spring of each arm over `stiffness`");
  if constexpr (which == 11)
    return number<seal..., &Elastomer::arms, &MaxwellArms::time>(
        path, "s", required, usual(1e-7, 1e5, positive), "τ, time in which each arm relaxes");
}

constexpr std::string_view volume_words[]{"chambers", "equal"};
constexpr std::string_view bending_words[]{"rigid", "elastic"};

constexpr auto oil = &Leg::oil_spring;
constexpr auto cylinder = &OilSpring::cylinder;

constexpr ParameterRow leg_rows[]{
    table(
        "legs", required, "",
        R"(# ---- Legs: what all six have in common -------------------------------------------------------
# Lengths are counted along the leg's axis from the base joint, unless it says otherwise.
)"),
    of_gimbal_axis(number<&Leg::gimbal_axis>(
        "legs.gimbal_axis", "1", standard, any,
        "base-fixed axis of the lower gimbal in the base frame, of any length; "
        "used with `flexible_axes = \"gimbal\"`")),
    alone(number<&Leg::gimbal_cross_inertia>(
        "legs.gimbal_cross_inertia", "kg m^2", standard, not_negative,
        "I_c, of the cross of the lower gimbal about its first axis; used with `flexible_axes = "
        "\"gimbal\"`")),
    alone(number<&Leg::added_axial_inertia>(
        "legs.added_axial_inertia", "kg", standard, not_negative,
        "m_a, inertia that moves with the piston only; oil in lines that end at a closed valve "
        "follows from `cap_line_length` and `rod_line_length`, oil in a line with an open end (an "
        "accumulator) is ρ L A_p²/A for a length L and a cross-section A")),
    alone(number<&Leg::gimbal_stiffness>("legs.gimbal_stiffness", "N/m", otherwise("rigid"),
                                         spring_rate,
                                         "k_j, of both gimbals and their fastening along the "
                                         "leg, in series with the oil spring",
                                         shown("300 kN/mm"))),
    alone(number<&Leg::stick_stiffness>(
        "legs.stick_stiffness", "N/m", standard, {.lowest = 0.0, .highest = stiffest},
        "k_b, of cylinder seals that stick instead of sliding at the amplitude of the motion, "
        "along the leg, parallel to the oil spring; simulations with valves and `modes "
        "--amplitude` have `friction.bristles` in its place")),
    word<&Leg::bending>(
        "legs.bending", bending_words,
        "whether rod and case bend under the lateral force at the guide sleeve: `\"rigid\"`, or "
        "`\"elastic\"`, beams by `rod.diameter`, `rod.wall`, `case.diameter`, `case.wall` and "
        "`rod.youngs_modulus`, in series with the guide sleeve"),
    table("legs.case", required, "cylinder case"),
    number<&Leg::cylinder_case, &CylinderCase::mass>("legs.case.mass", "kg", required,
                                                     usual(0.1, 2e4, not_negative),
                                                     "m_t, 0 or more", given("35 kg")),
    number<&Leg::cylinder_case, &CylinderCase::mass_center>(
        "legs.case.mass_center", "m", required, usual(1e-3, 20.0, any), "r_b, from the base joint",
        given("0.5 m")),
    number<&Leg::cylinder_case, &CylinderCase::transverse_inertia>(
        "legs.case.transverse_inertia", "kg m^2", required, not_negative,
        "I_t, across the axis, about the mass centre", given("3 kg m^2")),
    number<&Leg::cylinder_case, &CylinderCase::axial_inertia>(
        "legs.case.axial_inertia", "kg m^2", standard, not_negative,
        "I_ta, about the axis, no more than twice I_t; used with `flexible_axes = "
        "\"gimbal\"`"),
    not_mechanical(number<&Leg::cylinder_case, &CylinderCase::diameter>(
        "legs.case.diameter", "m", otherwise("the case does not bend"), usual(5e-3, 2.0, positive),
        "outside; with `wall`, for the buckling of the leg as a column and for `bending = "
        "\"elastic\"`",
        shown("100 mm"))),
    not_mechanical(number<&Leg::cylinder_case, &CylinderCase::wall>(
        "legs.case.wall", "m", otherwise("the case does not bend"), usual(5e-4, 0.5, positive),
        "thickness, no more than half the diameter", shown("10 mm"))),
    table("legs.rod", required, "rod with piston"),
    number<&Leg::rod, &Rod::length>("legs.rod.length", "m", required, usual(0.02, 20.0, positive),
                                    "l_mn, from the piston to the platform joint", given("1.05 m")),
    number<&Leg::rod, &Rod::mass>("legs.rod.mass", "kg", required, usual(0.05, 2e4, not_negative),
                                  "m_g, 0 or more", given("22 kg")),
    number<&Leg::rod, &Rod::mass_center>(
        "legs.rod.mass_center", "m", required, usual(1e-3, 20.0, any),
        "c_g, from the piston towards the platform", given("0.5 m")),
    number<&Leg::rod, &Rod::transverse_inertia>(
        "legs.rod.transverse_inertia", "kg m^2", required, not_negative,
        "I_r, across the axis, about the mass centre", given("2 kg m^2")),
    number<&Leg::rod, &Rod::axial_inertia>(
        "legs.rod.axial_inertia", "kg m^2", standard, not_negative,
        "I_ra, about the axis, no more than twice I_r; used with `flexible_axes = "
        "\"gimbal\"`"),
    not_mechanical(number<&Leg::rod, &Rod::diameter>(
        "legs.rod.diameter", "m", otherwise("`rod_diameter` of the oil spring's cylinder"),
        usual(2e-3, 1.2, positive),
        "outside; for the buckling of the leg as a column and for `bending = \"elastic\"`",
        shown("56 mm"))),
    not_mechanical(number<&Leg::rod, &Rod::wall>("legs.rod.wall", "m", otherwise("solid"),
                                                 usual(5e-4, 0.5, positive),
                                                 "thickness of a hollow rod, no more than half the "
                                                 "diameter",
                                                 shown("12 mm"))),
    not_mechanical(number<&Leg::rod, &Rod::youngs_modulus>(
        "legs.rod.youngs_modulus", "Pa", standard, usual(1e9, 1e12, positive),
        "E of rod and case; the default is that of steel")),
    not_mechanical(number<&Leg::rod, &Rod::yield_strength>(
        "legs.rod.yield_strength", "Pa", standard, usual(1e7, 5e9, positive), "R_e of the rod")),
    table("legs.guide_sleeve", required, "the seals' O-rings where the rod leaves the cylinder"),
    number<&Leg::guide_sleeve, &GuideSleeve::position>("legs.guide_sleeve.position", "m", required,
                                                       usual(0.02, 20.0, positive),
                                                       "L_g, from the base joint", given("1 m")),
    alone(number<&Leg::guide_sleeve, &GuideSleeve::stiffness>(
        "legs.guide_sleeve.stiffness", "N/m", required, spring_rate,
        "k_s, lateral, between case and rod", given("5 kN/mm"))),
    alone(number<&Leg::guide_sleeve, &GuideSleeve::damping>(
        "legs.guide_sleeve.damping", "N s/m", standard, not_negative, "c_s, lateral, viscous",
        given("2 kN s/m"))),
    alone(number<&Leg::guide_sleeve, &GuideSleeve::gap>(
        "legs.guide_sleeve.gap", "m", otherwise("the rod never touches its guide"),
        usual(1e-6, 1e-2, positive),
        "g, radial, from the centred rod to the guide ring; beyond it the guide ring carries, "
        "with `guide_stiffness` beside k_s",
        shown("0.2 mm"))),
    used_with("legs.guide_sleeve.gap",
              alone(number<&Leg::guide_sleeve, &GuideSleeve::guide_stiffness>(
                  "legs.guide_sleeve.guide_stiffness", "N/m", standard, spring_rate,
                  "k_c, lateral, of the guide ring; used with `gap`"))),
    of_elastomer<0, &Leg::guide_sleeve, &GuideSleeve::elastomer>("legs.guide_sleeve.elastomer"),
    of_elastomer<1, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.dynamic_ratio"),
    of_elastomer<2, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.loss_factor"),
    of_elastomer<3, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.frequency"),
    of_elastomer<4, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.softening"),
    of_elastomer<5, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.softening_amplitude"),
    of_elastomer<6, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.softening_time"),
    of_elastomer<7, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.pressure_stiffening"),
    of_elastomer<8, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.table"),
    of_elastomer<9, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.arms"),
    of_elastomer<10, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.arms.strength"),
    of_elastomer<11, &Leg::guide_sleeve, &GuideSleeve::elastomer>(
        "legs.guide_sleeve.elastomer.arms.time"),
    table("legs.piston_ring", optional,
          "the O-ring under the piston's ring; without the table it is rigid"),
    alone(number<&Leg::piston_ring, &PistonRing::stiffness>(
        "legs.piston_ring.stiffness", "N/m", required, spring_rate,
        "k_g, lateral, between case and piston", shown("20 kN/mm"))),
    alone(number<&Leg::piston_ring, &PistonRing::damping>(
        "legs.piston_ring.damping", "N s/m", standard, not_negative, "c_u, lateral, viscous")),
    of_elastomer<0, &Leg::piston_ring, &PistonRing::elastomer>("legs.piston_ring.elastomer"),
    of_elastomer<1, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.dynamic_ratio"),
    of_elastomer<2, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.loss_factor"),
    of_elastomer<3, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.frequency"),
    of_elastomer<4, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.softening"),
    of_elastomer<5, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.softening_amplitude"),
    of_elastomer<6, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.softening_time"),
    of_elastomer<7, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.pressure_stiffening"),
    of_elastomer<8, &Leg::piston_ring, &PistonRing::elastomer>("legs.piston_ring.elastomer.table"),
    of_elastomer<9, &Leg::piston_ring, &PistonRing::elastomer>("legs.piston_ring.elastomer.arms"),
    of_elastomer<10, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.arms.strength"),
    of_elastomer<11, &Leg::piston_ring, &PistonRing::elastomer>(
        "legs.piston_ring.elastomer.arms.time"),
    table("legs.oil_spring", required,
          "the oil along the leg: either `stiffness`, or the table `cylinder`"),
    instead_of(drop_cylinder,
               number<oil, &OilSpring::stiffness>("legs.oil_spring.stiffness", "N/m", standard,
                                                  spring_rate, "k_h", shown("20 kN/mm"))),
    number<oil, &OilSpring::damping>(
        "legs.oil_spring.damping", "N s/m", standard, not_negative,
        "c_h, viscous, parallel to the spring; simulations, poles of the system and "
        "chambers (`damping.oil`) model leakage, valves and friction in its place",
        given("10 kN s/m")),
    instead_of(drop_stiffness,
               table("legs.oil_spring.cylinder", required, "what the stiffness follows from")),
    number<oil, cylinder, &Cylinder::bore>("legs.oil_spring.cylinder.bore", "m", required,
                                           usual(4e-3, 1.5, positive), "more than 0",
                                           given("80 mm")),
    number<oil, cylinder, &Cylinder::rod_diameter>("legs.oil_spring.cylinder.rod_diameter", "m",
                                                   required, usual(2e-3, 1.2, not_negative),
                                                   "0 or more, less than the bore", given("56 mm")),
    number<oil, cylinder, &Cylinder::cap_dead_volume>(
        "legs.oil_spring.cylinder.cap_dead_volume", "m^3", standard, not_negative,
        "of the chamber on the base side, with the piston retracted", given("100 cm^3")),
    number<oil, cylinder, &Cylinder::rod_dead_volume>(
        "legs.oil_spring.cylinder.rod_dead_volume", "m^3", standard, not_negative,
        "of the chamber around the rod, with the piston extended", given("100 cm^3")),
    number<oil, cylinder, &Cylinder::cap_line_volume>(
        "legs.oil_spring.cylinder.cap_line_volume", "m^3", standard, not_negative,
        "between the chamber on the base side and the valve", given("150 cm^3")),
    number<oil, cylinder, &Cylinder::rod_line_volume>(
        "legs.oil_spring.cylinder.rod_line_volume", "m^3", standard, not_negative,
        "between the chamber around the rod and the valve", given("150 cm^3")),
    number<oil, cylinder, &Cylinder::cap_line_length>(
        "legs.oil_spring.cylinder.cap_line_length", "m", standard, usual(0.02, 100.0, not_negative),
        "of the line between the chamber on the base side and the valve, for the inertia of its "
        "oil; needs `cap_line_volume`"),
    number<oil, cylinder, &Cylinder::rod_line_length>(
        "legs.oil_spring.cylinder.rod_line_length", "m", standard, usual(0.02, 100.0, not_negative),
        "of the line between the chamber around the rod and the valve; needs `rod_line_volume`"),
    number<oil, cylinder, &Cylinder::cap_line_compliance>(
        "legs.oil_spring.cylinder.cap_line_compliance", "m^3/Pa", standard,
        usual(1e-16, 1e-9, not_negative),
        "volume by which the wall of the line (a hose) grows per pressure, beside the oil of the "
        "chamber on the base side"),
    number<oil, cylinder, &Cylinder::rod_line_compliance>(
        "legs.oil_spring.cylinder.rod_line_compliance", "m^3/Pa", standard,
        usual(1e-16, 1e-9, not_negative), "the same of the line to the chamber around the rod"),
    used_with("legs.oil_spring.cylinder.cap_line_length",
              number<oil, cylinder, &Cylinder::density>(
                  "legs.oil_spring.cylinder.density", "kg/m^3", standard,
                  usual(700.0, 1300.0, positive), "ρ of the oil; used with a line length"),
              "legs.oil_spring.cylinder.rod_line_length"),
    number<oil, cylinder, &Cylinder::bulk_modulus>("legs.oil_spring.cylinder.bulk_modulus", "Pa",
                                                   required, usual(1e7, 1e10, positive),
                                                   "β_e of the oil without air", given("1.4 GPa")),
    word<oil, cylinder, &Cylinder::volumes>(
        "legs.oil_spring.cylinder.volumes", volume_words,
        "`\"chambers\"`: the true volumes at the pose, which needs `[legs.stroke]`; "
        "`\"equal\"`: both chambers hold `control_volume` at every pose (Eq. 16 of the "
        "paper)"),
    number<oil, cylinder, &Cylinder::control_volume>(
        "legs.oil_spring.cylinder.control_volume", "m^3",
        otherwise("mean of both chambers at mid stroke"), positive, "V_0 for `\"equal\"`",
        shown("2 l")),
    table("legs.oil_spring.cylinder.air", optional,
          "air carried in the oil as bubbles; without the table there is none"),
    number<oil, cylinder, &Cylinder::air, &EntrainedAir::fraction>(
        "legs.oil_spring.cylinder.air.fraction", "1", required, usual(0.0, 0.25, below_one),
        "share of the volume at atmospheric pressure, 0 or more and less than 1", shown("1 %")),
    number<oil, cylinder, &Cylinder::air, &EntrainedAir::pressure>(
        "legs.oil_spring.cylinder.air.pressure", "Pa", required, usual(1e4, 1e8, positive),
        "mean absolute pressure in the chambers", shown("70 bar")),
    number<oil, cylinder, &Cylinder::air, &EntrainedAir::polytropic>(
        "legs.oil_spring.cylinder.air.polytropic", "1", standard, polytropic,
        "exponent n of p Vⁿ: 1 for slow changes, 1.4 for fast ones"),
    table("legs.stroke", optional, "where the piston can be; optional with a given stiffness"),
    number<&Leg::stroke, &Stroke::retracted>(
        "legs.stroke.retracted", "m", required, usual(0.01, 20.0, not_negative),
        "from the base joint to the piston when retracted", given("0.25 m")),
    number<&Leg::stroke, &Stroke::length>("legs.stroke.length", "m", required,
                                          usual(2e-3, 20.0, positive), "more than 0",
                                          given("0.6 m")),
    table("legs.strut", optional,
          "a plain strut in place of `case`, `rod`, `guide_sleeve`, `piston_ring`, "
          "`oil_spring` and `stroke`: a spring and a damper without mass between the "
          "joints, for all six legs",
          "# A leg may also be a plain strut ([legs.strut] in place of all from "
          "[legs.case] on) or an\n"
          "# electric cylinder ([legs.screw] in place of [legs.oil_spring]); see\n"
          "# docs/howto/machine-file.md\n"),
    alone(number<&Leg::strut, &Strut::stiffness>("legs.strut.stiffness", "N/m", required,
                                                 spring_rate, "k, between the joints",
                                                 shown("20 kN/mm"))),
    alone(number<&Leg::strut, &Strut::damping>("legs.strut.damping", "N s/m", standard,
                                               not_negative, "c, viscous, parallel to the spring")),
    table("legs.screw", optional,
          "motor and screw of an electric cylinder in place of `oil_spring`, for all "
          "six legs; its guide bush is `guide_sleeve`"),
    alone(number<&Leg::screw, &Screw::stiffness>(
        "legs.screw.stiffness", "N/m", required,
        spring_rate, "k_a of screw, nut and bearings along the axis", shown("120 N/um"))),
    alone(number<&Leg::screw, &Screw::damping>("legs.screw.damping", "N s/m", standard,
                                               not_negative, "c_a, viscous, parallel to it")),
    number<&Leg::screw, &Screw::lead>("legs.screw.lead", "m", required, usual(5e-4, 0.2, positive),
                                      "p, way of the nut per revolution", shown("10 mm")),
    alone(not_mechanical(number<&Leg::screw, &Screw::inertia>(
        "legs.screw.inertia", "kg m^2", required, positive,
        "J of rotor, coupling and screw about the axis", shown("4e-3")))),
    not_mechanical(number<&Leg::screw, &Screw::torque_limit>(
        "legs.screw.torque_limit", "N m", otherwise("any"), positive, "T_max of the motor",
        shown("40 N m"))),
    alone(not_mechanical(number<&Leg::screw, &Screw::speed_limit>(
        "legs.screw.speed_limit", "rad/s", otherwise("any"), usual(1.0, 5000.0, positive),
        "ω_max of the motor", shown("3000 rpm")))),
    not_mechanical(number<&Leg::screw, &Screw::friction_torque>(
        "legs.screw.friction_torque", "N m", standard, not_negative,
        "T_f, Coulomb, of motor, bearings and nut; less than the torque limit")),
    alone(not_mechanical(number<&Leg::screw, &Screw::viscous_friction>(
        "legs.screw.viscous_friction", "N m s/rad", standard, not_negative,
        "b of motor, bearings and nut"))),
    alone(not_mechanical(number<&Leg::screw, &Screw::speed_bandwidth>(
        "legs.screw.speed_bandwidth", "Hz", standard, usual(1.0, 2000.0, positive),
        "ω_s/2π of the drive's speed loop: its gain is k_p = ω_s J"))),
    alone(not_mechanical(number<&Leg::screw, &Screw::speed_integral_time>(
        "legs.screw.speed_integral_time", "s", otherwise("4/ω_s"), usual(1e-4, 10.0, positive),
        "t_i of the drive's speed loop", shown("13 ms")))),
    simulation("legs.joint_limits", "largest tilt of the joints from the neutral pose"),
    number<&Leg::joint_limits, &JointLimits::base>(
        "legs.joint_limits.base", "rad", otherwise("any"), tilt, "more than 0, no more than 180°",
        shown("35 deg")),
    number<&Leg::joint_limits, &JointLimits::platform>(
        "legs.joint_limits.platform", "rad", otherwise("any"), tilt,
        "more than 0, no more than 180°", shown("40 deg")),
};

}  // namespace

std::span<const ParameterRow> legs() { return leg_rows; }

}  // namespace hydrapod::model::rows
