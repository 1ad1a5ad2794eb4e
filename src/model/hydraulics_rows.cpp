// Rows of the machine file: the servo-hydraulics of the legs.
#include "parameter_rows.hpp"

namespace hydrapod::model::rows {

namespace {

constexpr auto hydraulics = &Leg::hydraulics;
constexpr auto valve = &LegHydraulics::valve;
constexpr auto friction = &LegHydraulics::friction;
constexpr auto joint_friction = &LegHydraulics::joint_friction;

constexpr ParameterRow leg_hydraulics_rows[]{
    simulation(
        "legs.valve", "four-edge servo valve",
        R"(# ---- Servo-hydraulics, for `hydrapod simulate` ------------------------------------------------
# All of it is optional; what is not given follows from the machine, and `hydrapod check` says how.
# Pressures are absolute.
)"),
    number<hydraulics, valve, &ServoValve::rated_flow>(
        "legs.valve.rated_flow", "m^3/s", otherwise("0.5 m/s times A_p"),
        usual(1e-7, 0.5, positive), "at full opening and the rated pressure drop",
        shown("150 l/min")),
    number<hydraulics, valve, &ServoValve::rated_pressure_drop>(
        "legs.valve.rated_pressure_drop", "Pa", standard, usual(1e4, 1e8, positive),
        "over both edges together", shown("70 bar")),
    number<hydraulics, valve, &ServoValve::overlap>(
        "legs.valve.overlap", "1", standard,
        {.lowest = -0.5,
         .highest = 0.5,
         .expected = "-0.5 (underlap) to 0.5 (overlap)",
         .shown_in = "of the travel"},
        "share of the travel, -0.5 to 0.5; negative: underlap"),
    number<hydraulics, valve, &ServoValve::laminar_pressure>(
        "legs.valve.laminar_pressure", "Pa", standard, positive,
        "pressure drop below which the flow of an edge is laminar", shown("1 bar")),
    number<hydraulics, valve, &ServoValve::natural_frequency>(
        "legs.valve.natural_frequency", "rad/s", standard, usual(1.0, 1e5, positive),
        "of the spool", shown("600 rad/s")),
    number<hydraulics, valve, &ServoValve::damping_ratio>("legs.valve.damping_ratio", "1", standard,
                                                          positive, "of the spool"),
    number<hydraulics, valve, &ServoValve::rate_limit>("legs.valve.rate_limit", "1/s", standard,
                                                       positive,
                                                       "largest rate of the spool, in travels"),
    number<hydraulics, valve, &ServoValve::leakage>(
        "legs.valve.leakage", "m^3/s", otherwise("1 % of the rated flow"), not_negative,
        "null leakage: from supply to return, both ports blocked", shown("1.5 l/min")),
    simulation("legs.leakage", "of the cylinder"),
    number<hydraulics, &LegHydraulics::leakage, &CylinderLeakage::internal>(
        "legs.leakage.internal", "m^3/(s Pa)",
        otherwise("1 % of the rated flow at the supply pressure"), not_negative, "past the piston",
        shown("1e-12")),
    number<hydraulics, &LegHydraulics::leakage, &CylinderLeakage::external>(
        "legs.leakage.external", "m^3/(s Pa)", standard, not_negative,
        "from each chamber to the outside"),
    simulation("legs.friction", "of the seals, along the leg"),
    number<hydraulics, friction, &SealFriction::coulomb>(
        "legs.friction.coulomb", "N", otherwise("0"), not_negative,
        "F_c; with O-rings about 1 % of A_p times the supply pressure", shown("700 N")),
    number<hydraulics, friction, &SealFriction::breakaway>(
        "legs.friction.breakaway", "N", otherwise("1.5 F_c"), not_negative, "F_s, no less than F_c",
        shown("1050 N")),
    number<hydraulics, friction, &SealFriction::viscous>("legs.friction.viscous", "N s/m",
                                                         otherwise("10 F_c per m/s"), not_negative,
                                                         "b", shown("7 kN s/m")),
    used_with(
        "legs.friction.coulomb",
        number<hydraulics, friction, &SealFriction::stribeck_velocity>(
            "legs.friction.stribeck_velocity", "m/s", standard, positive, "v_s", shown("20 mm/s"))),
    used_with("legs.friction.coulomb",
              number<hydraulics, friction, &SealFriction::smoothing_velocity>(
                  "legs.friction.smoothing_velocity", "m/s", standard, positive,
                  "v_0 of tanh(v/v_0); not used with bristles", shown("2 mm/s"))),
    simulation("legs.friction.bristles", "friction after LuGre instead of tanh"),
    number<hydraulics, friction, &SealFriction::bristles, &LuGreBristles::stiffness>(
        "legs.friction.bristles.stiffness", "N/m", required, spring_rate, "σ_0", shown("50 kN/mm")),
    number<hydraulics, friction, &SealFriction::bristles, &LuGreBristles::damping>(
        "legs.friction.bristles.damping", "N s/m", standard, not_negative, "σ_1"),
    simulation("legs.joint_friction", "in both joints of a leg, against turning of its axis"),
    number<hydraulics, joint_friction, &JointFriction::viscous>(
        "legs.joint_friction.viscous", "N m s/rad", standard, not_negative, "0 or more"),
    number<hydraulics, joint_friction, &JointFriction::coulomb>(
        "legs.joint_friction.coulomb", "N m", standard, not_negative, "0 or more"),
    used_with("legs.joint_friction.coulomb",
              number<hydraulics, joint_friction, &JointFriction::smoothing_rate>(
                  "legs.joint_friction.smoothing_rate", "rad/s", standard, positive,
                  "of the same law as at the seals; not used with bristles")),
    number<hydraulics, joint_friction, &JointFriction::bristle_stiffness>(
        "legs.joint_friction.bristle_stiffness", "N m/rad", otherwise("the smooth law"), positive,
        "σ_0 of the law of LuGre: joints stick before they slide, in simulations, `modes "
        "--system` and `modes --amplitude`",
        shown("500 kN m/rad")),
    used_with(
        "legs.joint_friction.bristle_stiffness",
        number<hydraulics, joint_friction, &JointFriction::bristle_damping>(
            "legs.joint_friction.bristle_damping", "N m s/rad", standard, not_negative, "σ_1")),
    simulation("legs.end_stops", "at the ends of the stroke"),
    number<hydraulics, &LegHydraulics::end_stops, &EndStops::stiffness>(
        "legs.end_stops.stiffness", "N/m", otherwise("20 times the oil spring"), positive,
        "k of the force k δ (1 + damping dδ/dt)", shown("400 kN/mm")),
    number<hydraulics, &LegHydraulics::end_stops, &EndStops::damping>(
        "legs.end_stops.damping", "s/m", standard, not_negative, "of the same force"),
    simulation("legs.equivalent_cylinder", "with `oil_spring.stiffness` only"),
    number<hydraulics, &LegHydraulics::equivalent_cylinder, &EquivalentCylinder::area_ratio>(
        "legs.equivalent_cylinder.area_ratio", "1", standard, up_to_one,
        "e, rod side to cap side, no more than 1"),
    number<hydraulics, &LegHydraulics::equivalent_cylinder, &EquivalentCylinder::area>(
        "legs.equivalent_cylinder.area", "m^2",
        otherwise("a sixth of the supply pressure bears the leg's share of the platform"),
        usual(1e-5, 2.0, positive),
        "A_p; the default is larger where chambers would else be shorter than the "
        "stroke",
        shown("50 cm^2")),
    number<hydraulics, &LegHydraulics::equivalent_cylinder, &EquivalentCylinder::bulk_modulus>(
        "legs.equivalent_cylinder.bulk_modulus", "Pa", standard, usual(1e7, 1e10, positive), "β_e",
        shown("1 GPa")),
};

}  // namespace

std::span<const ParameterRow> leg_hydraulics() { return leg_hydraulics_rows; }

}  // namespace hydrapod::model::rows
