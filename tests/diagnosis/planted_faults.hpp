#pragma once
/// Faults of every cause, and the machines that they are planted in.

#include "blind_series.hpp"

namespace hydrapod::test {

using dynamics::ModelKind;

struct Fault {
  std::vector<std::string> overrides, planted;
  std::string size{};  ///< in words, beside what the file says
  ModelKind kind{ModelKind::guide};
};

/// Sizes of faults that a platform feels and under which its legs still carry it.
struct Sizes {
  double sleeve;   ///< factor on its stiffness
  double payload;  ///< factor on its mass
  double rings;    ///< their stiffness, in that of the sleeves
  double shift;    ///< of the mass centre, in a quarter of the radius of gyration
};

/// Faults of a machine by factors on what its file says.
inline std::vector<Fault> faults_of(const model::MachineFile& file, const Sizes& sizes) {
  const auto [sleeve, payload, rings, shift] = sizes;
  const auto& m = file.machine;
  const auto& leg = m.legs[0];
  const double k_s = leg.guide_sleeve.stiffness, mass = m.platform.mass;
  const auto& I = m.platform.inertia;
  const bool cylinder = leg.oil_spring.cylinder.has_value();
  const double l_m = kinematics::leg_lengths(m, m.neutral())[0] - leg.rod.length;
  const double k_h = hydraulics::oil_stiffness(leg, l_m);
  const double oil = cylinder ? leg.oil_spring.cylinder->bulk_modulus : k_h;
  const std::string oil_path =
      cylinder ? "oil_spring.cylinder.bulk_modulus" : "oil_spring.stiffness";
  const std::string oil_name = cylinder ? "bulk modulus of the oil" : "oil springs of all legs";
  const auto set = [](const std::string& path, double value) {
    return fmt::format("{}={:.12g}", path, value);
  };
  const double reach = 0.25 * shift * std::sqrt(I.trace() / (3.0 * mass));
  const double K = 6.0 * k_h;
  const double height = m.neutral().p_BP.z();
  const auto& center = m.platform.mass_center;
  const std::array moments{set("platform.inertia.xx", 1.3 * I(0, 0)),
                           set("platform.inertia.yy", 1.18 * I(1, 1)),
                           set("platform.inertia.zz", 1.22 * I(2, 2))};
  const std::string of_moments = "I × 1.3, 1.18, 1.22";
  const auto times = [](const char* what, double factor) {
    return fmt::format("{} × {:.3g}", what, factor);
  };
  const auto moved = [&](double x, double y, double z) {
    return fmt::format("{:.3g}, {:.3g}, {:.3g} mm", 1e3 * x * reach, 1e3 * y * reach,
                       1e3 * z * reach);
  };
  std::vector<Fault> faults{
      {},
      {{set("legs.guide_sleeve.stiffness", sleeve * k_s)},
       {"guide sleeves of all legs"},
       times("k_s", sleeve)},
      {{set("leg.3.guide_sleeve.stiffness", sleeve * k_s)},
       {"guide sleeve of leg 3"},
       times("k_s", sleeve)},
      {{set("legs.piston_ring.stiffness", rings * k_s)},
       {"piston rings of all legs"},
       fmt::format("k_g = {:.3g} k_s", rings),
       ModelKind::full},
      {{set("legs." + oil_path, 0.72 * oil)}, {oil_name}, times("oil", 0.72)},
      {{set("leg.2." + oil_path, 0.6 * oil)}, {"oil spring of leg 2"}, times("oil", 0.6)},
      {{set("legs.gimbal_stiffness", 3.1 * k_h)}, {"gimbals of all legs"}, "k_j = 3.1 k_h"},
      {{set("leg.5.gimbal_stiffness", 2.2 * k_h)}, {"gimbals of leg 5"}, "k_j = 2.2 k_h"},
      {{set("platform.mass", payload * mass)}, {"payload (platform mass)"}, times("mass", payload)},
      {{moments[0], moments[1], moments[2]}, {"platform inertia"}, of_moments},
      {{set("platform.mass", payload * mass), moments[0], moments[1], moments[2]},
       {"platform mass and inertia"},
       times("mass", payload) + ", " + of_moments},
      {{set("platform.mass_center[0]", center.x() + 0.6 * reach),
        set("platform.mass_center[1]", center.y() - 0.4 * reach),
        set("platform.mass_center[2]", center.z() + 0.7 * reach)},
       {"mass centre"},
       moved(0.6, -0.4, 0.7)},
      {{set("base.mount.stiffness.x", 3.0 * K), set("base.mount.stiffness.y", 3.0 * K)},
       {"lateral compliance of the base"},
       "18 k_h"},
      {{set("base.mount.stiffness.z", 4.0 * K)}, {"vertical compliance of the base"}, "24 k_h"},
      {{set("base.mount.stiffness.rx", 4.0 * K * height * height),
        set("base.mount.stiffness.ry", 4.0 * K * height * height)},
       {"rocking compliance of the base"},
       "24 k_h height²"},
      {{set("legs.added_axial_inertia", leg.added_axial_inertia + 0.03 * mass)},
       {"oil in the lines"},
       fmt::format("+{:.3g} kg per leg", 0.03 * mass)},
      {{set("legs.guide_sleeve.stiffness", sleeve * k_s), set("legs." + oil_path, 0.7 * oil)},
       {"guide sleeves of all legs", oil_name},
       times("k_s", sleeve) + ", oil × 0.7"},
      {{set("leg.2." + oil_path, 0.55 * oil), set("leg.6." + oil_path, 0.6 * oil)},
       {"oil spring of leg 2", "oil spring of leg 6"},
       "oil × 0.55 and × 0.6"},
      {{set("legs.guide_sleeve.stiffness", sleeve * k_s), set("platform.mass", payload * mass)},
       {"guide sleeves of all legs", "payload (platform mass)"},
       times("k_s", sleeve) + ", " + times("mass", payload)},
      {{set("leg.4." + oil_path, 0.55 * oil),
        set("platform.mass_center[0]", center.x() + 1.2 * reach)},
       {"oil spring of leg 4", "mass centre"},
       "oil × 0.55, " + moved(1.2, 0.0, 0.0)},
  };
  const Fault oil_in_line{
      {set("leg.4.added_axial_inertia", m.legs[3].added_axial_inertia + 0.12 * mass)},
      {"oil in the lines of leg 4"},
      "12 % of the platform's mass"};
  if (!cylinder) {
    faults.push_back(oil_in_line);
    return faults;
  }
  faults.push_back(
      {{"legs.oil_spring.cylinder.air.fraction=0.12"}, {"entrained air in all legs"}, "12 %"});
  faults.push_back({{set("leg.1.oil_spring.cylinder.cap_line_volume",
                         8.0 * leg.oil_spring.cylinder->cap_line_volume)},
                    {"cap-side chamber or line volume of leg 1"},
                    "line × 8"});
  faults.push_back(oil_in_line);
  return faults;
}

struct Setting {
  std::string machine;
  std::vector<std::string> design;
  std::vector<std::string> poses;
  double noise;
  Sizes sizes;
};

inline std::vector<Setting> settings() {
  const std::vector<std::string> stiff{"legs.guide_sleeve.stiffness=20 kN/mm"};
  return {{"zhang-jiang-2021.toml", {}, {"neutral"}, 1e-3, {0.8, 1.24, 1.6, 1.0}},
          {"heavy-platform.toml", {}, {"neutral", "low"}, 1e-3, {1.7, 0.93, 9.0, 0.2}},
          {"heavy-platform.toml", stiff, {"neutral"}, 5e-4, {0.1, 1.21, 0.3, 1.0}},
          {"random 31", {}, {"neutral", "shifted"}, 2e-3, {0.7, 1.18, 4.0, 1.0}},
          {"random 47", {}, {"neutral"}, 3e-3, {0.7, 1.27, 4.0, 1.0}},
          {"random 83", {}, {"shifted"}, 5e-4, {0.7, 1.16, 4.0, 1.0}}};
}

/// All cases of a setting; `first`: number of its first case, which seeds the noise.
inline std::vector<BlindCase> cases_of(const Setting& s, int first) {
  const BlindCase basic{.machine = s.machine, .design = s.design};
  std::vector<BlindCase> cases;
  for (const auto& fault : faults_of(machine_file(basic.text(), s.design), s.sizes))
    cases.push_back({s.machine, s.design, fault.overrides, fault.planted, s.poses, s.noise,
                     fault.kind, first + static_cast<int>(cases.size()), fault.size});
  return cases;
}

}  // namespace hydrapod::test
