#include "geometry_json.hpp"

#include "fields.hpp"

namespace hydrapod::report {

namespace {

Json drawn_json(const dynamics::DrawnLeg& leg, int flexible) {
  const auto point = [&](const dynamics::DrawnPoint& at) -> Json {
    return {{"at_m", written(at.p)}, {"motion", written(at.p_x.leftCols(3 + flexible))}};
  };
  return {{"sleeve", point(leg.sleeve)},
          {"piston", point(leg.piston)},
          {"rod_at_sleeve", point(leg.rod_at_sleeve)}};
}

Json leg_json(const model::Leg& leg, const dynamics::LegElement& element,
              const dynamics::LegState& state, const dynamics::Vector3& a) {
  const auto& axes = element.frame.R_BL;
  Json json{
      {"base_joint_m", written(leg.base_joint)},
      {"platform_joint_m", written(a)},
      {"length_m", (a - leg.base_joint).norm()},
      {"l_m", element.l_m},
      {"l_mh", element.l_mh},
      {"L_g", leg.guide_sleeve.position},
      {"l_mn", leg.rod.length},
      {"r_b", leg.cylinder_case.mass_center},
      {"c_g", leg.rod.mass_center},
      {"axes",
       {{"t", written(axes.col(0))}, {"a2", written(axes.col(1))}, {"n", written(axes.col(2))}}},
      {"tan_gimbal", element.frame.tan_gimbal},
      {"tilt_rad", {state.flexible[0], state.flexible[1]}},
      {"offset_m", {state.flexible[2], state.flexible[3]}},
      {"oil_force_N", state.oil_force},
      {"k_h", element.k_h},
      {"k_s", element.k_s}};
  if (leg.strut) json["strut"] = true;
  if (leg.piston_ring) json["k_g"] = leg.piston_ring->stiffness;
  if (leg.oil_spring.cylinder) {
    json["bore_m"] = leg.oil_spring.cylinder->bore;
    json["rod_diameter_m"] = leg.oil_spring.cylinder->rod_diameter;
  }
  return json;
}

}  // namespace

Json geometry_json(const model::Machine& machine, const dynamics::LinearModel& model) {
  Json json{{"platform",
             {{"origin_m", written(model.X_BP.p_BP)},
              {"rotation", written(model.X_BP.R_BP)},
              {"mass_center_m", written(model.p_BC)}}},
            {"legs", Json::array()}};
  const auto axes = machine.flexible_axes;
  const auto geometry = kinematics::inverse_kinematics(machine, model.X_BP);
  for (size_t i = 0; i < machine.legs.size(); ++i) {
    const auto& leg = machine.legs[i];
    const auto& state = model.statics.legs[i];
    Json entry = leg_json(leg, model.legs[i], state, geometry[i].a);
    const auto straight = dynamics::straight_leg(leg, geometry[i], axes);
    entry["straight"] = drawn_json(dynamics::drawn_leg(leg, straight, axes, {}), 0);
    if (const int flexible = dynamics::flexible_per_leg(model.kind); flexible > 0)
      entry["bent"] = drawn_json(dynamics::drawn_leg(leg, model.legs[i], axes, state), flexible);
    json["legs"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace hydrapod::report
