#include "machine_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/nearest.hpp"
#include "key_path.hpp"

namespace hydrapod::model {

namespace {

struct TableKeys;

struct Key {
  std::string_view name;
  const TableKeys* table{};    ///< keys of the table it holds; null for a value
  bool value_or_table{false};  ///< may hold a value instead
};

struct TableKeys {
  std::span<const Key> keys{};
  const TableKeys* named{};  ///< keys of the tables in it when their names are free (poses)
};

constexpr Key environment_keys[]{{"gravity"}};
constexpr TableKeys environment{environment_keys};

constexpr Key circle_keys[]{{"radius"}, {"spacing"}};
constexpr TableKeys circle{circle_keys};
constexpr Key joints_keys[]{{"circle", &circle}, {"points"}};
constexpr TableKeys joints{joints_keys};
constexpr Key mount_stiffness_keys[]{{"x"}, {"y"}, {"z"}, {"rx"}, {"ry"}, {"rz"}};
constexpr TableKeys mount_stiffness{mount_stiffness_keys};
constexpr Key mount_keys[]{{"stiffness", &mount_stiffness}, {"mass"}, {"inertia"}};
constexpr TableKeys mount{mount_keys};
constexpr Key base_keys[]{{"joints", &joints}, {"mount", &mount}};
constexpr TableKeys base_table{base_keys};

constexpr Key inertia_keys[]{{"xx"}, {"yy"}, {"zz"}, {"xy"}, {"xz"}, {"yz"}};
constexpr TableKeys inertia{inertia_keys};
constexpr Key platform_keys[]{
    {"mass"}, {"mass_center"}, {"inertia", &inertia, true}, {"joints", &joints}};
constexpr TableKeys platform{platform_keys};

constexpr Key case_keys[]{{"mass"}, {"mass_center"}, {"transverse_inertia"}, {"axial_inertia"}};
constexpr TableKeys case_table{case_keys};
constexpr Key rod_keys[]{
    {"length"}, {"mass"}, {"mass_center"}, {"transverse_inertia"}, {"axial_inertia"}};
constexpr TableKeys rod{rod_keys};
constexpr Key guide_sleeve_keys[]{{"position"}, {"stiffness"}, {"damping"}};
constexpr TableKeys guide_sleeve{guide_sleeve_keys};
constexpr Key piston_ring_keys[]{{"stiffness"}, {"damping"}};
constexpr TableKeys piston_ring{piston_ring_keys};

constexpr Key air_keys[]{{"fraction"}, {"pressure"}, {"polytropic"}};
constexpr TableKeys air{air_keys};
constexpr Key cylinder_keys[]{{"bore"},
                              {"rod_diameter"},
                              {"cap_dead_volume"},
                              {"rod_dead_volume"},
                              {"cap_line_volume"},
                              {"rod_line_volume"},
                              {"bulk_modulus"},
                              {"volumes"},
                              {"control_volume"},
                              {"air", &air}};
constexpr TableKeys cylinder{cylinder_keys};
constexpr Key oil_spring_keys[]{{"stiffness"}, {"cylinder", &cylinder}, {"damping"}};
constexpr TableKeys oil_spring{oil_spring_keys};

constexpr Key stroke_keys[]{{"retracted"}, {"length"}};
constexpr TableKeys stroke{stroke_keys};
constexpr Key joint_limits_keys[]{{"base"}, {"platform"}};
constexpr TableKeys joint_limits{joint_limits_keys};

constexpr Key valve_keys[]{
    {"rated_flow"},        {"rated_pressure_drop"}, {"overlap"},    {"laminar_pressure"},
    {"natural_frequency"}, {"damping_ratio"},       {"rate_limit"}, {"leakage"}};
constexpr TableKeys valve{valve_keys};
constexpr Key leakage_keys[]{{"internal"}, {"external"}};
constexpr TableKeys leakage{leakage_keys};
constexpr Key bristle_keys[]{{"stiffness"}, {"damping"}};
constexpr TableKeys bristles{bristle_keys};
constexpr Key friction_keys[]{{"coulomb"},           {"breakaway"},
                              {"stribeck_velocity"}, {"smoothing_velocity"},
                              {"viscous"},           {"bristles", &bristles}};
constexpr TableKeys friction{friction_keys};
constexpr Key joint_friction_keys[]{{"viscous"}, {"coulomb"}, {"smoothing_rate"}};
constexpr TableKeys joint_friction{joint_friction_keys};
constexpr Key end_stop_keys[]{{"stiffness"}, {"damping"}};
constexpr TableKeys end_stops{end_stop_keys};
constexpr Key equivalent_cylinder_keys[]{{"area_ratio"}, {"area"}, {"bulk_modulus"}};
constexpr TableKeys equivalent_cylinder{equivalent_cylinder_keys};

constexpr Key leg_keys[]{{"gimbal_axis"},
                         {"added_axial_inertia"},
                         {"gimbal_stiffness"},
                         {"case", &case_table},
                         {"rod", &rod},
                         {"guide_sleeve", &guide_sleeve},
                         {"piston_ring", &piston_ring},
                         {"oil_spring", &oil_spring},
                         {"stroke", &stroke},
                         {"joint_limits", &joint_limits},
                         {"valve", &valve},
                         {"leakage", &leakage},
                         {"friction", &friction},
                         {"joint_friction", &joint_friction},
                         {"end_stops", &end_stops},
                         {"equivalent_cylinder", &equivalent_cylinder},
                         {"base_joint"},
                         {"platform_joint"}};
constexpr TableKeys one_leg{leg_keys};
constexpr std::size_t joints_of_one_leg = 2;  // the last two keys
constexpr TableKeys all_legs{std::span(leg_keys).first(std::size(leg_keys) - joints_of_one_leg)};
constexpr Key leg_numbers[]{{"1", &one_leg}, {"2", &one_leg}, {"3", &one_leg},
                            {"4", &one_leg}, {"5", &one_leg}, {"6", &one_leg}};
constexpr TableKeys single_legs{leg_numbers};

constexpr Key model_keys[]{{"flexible_axes"}};
constexpr TableKeys model_table{model_keys};
constexpr Key damping_keys[]{{"modal_ratio"}, {"rayleigh_mass"}, {"rayleigh_stiffness"}};
constexpr TableKeys damping{damping_keys};
constexpr Key accumulator_keys[]{{"gas_volume"}, {"precharge"}, {"polytropic"}};
constexpr TableKeys accumulator{accumulator_keys};
constexpr Key supply_keys[]{
    {"pressure"},    {"return_pressure"},     {"pump_flow"},
    {"line_volume"}, {"cavitation_pressure"}, {"accumulator", &accumulator}};
constexpr TableKeys supply{supply_keys};
constexpr Key output_keys[]{{"limit"}, {"resolution"}, {"scale"}, {"offset"}};
constexpr TableKeys output{output_keys};
constexpr Key controller_keys[]{{"space"},
                                {"gain"},
                                {"bandwidth"},
                                {"integral_time"},
                                {"velocity_feedforward"},
                                {"feedback"},
                                {"feedback_damping"},
                                {"feedback_gain"},
                                {"feedback_corner"},
                                {"sample_time"},
                                {"delay"},
                                {"compensation"},
                                {"overlap_compensation"},
                                {"output", &output}};
constexpr TableKeys controller{controller_keys};
constexpr Key sensor_keys[]{{"resolution"}, {"noise"}, {"range"}};
constexpr TableKeys sensor{sensor_keys};
constexpr Key sensors_keys[]{{"length", &sensor}, {"pressure", &sensor}, {"acceleration", &sensor}};
constexpr TableKeys sensors{sensors_keys};
constexpr Key pose_keys[]{{"position"}, {"rotation"}};
constexpr TableKeys pose{pose_keys};
constexpr TableKeys poses{{}, &pose};

constexpr Key root_keys[]{{"name"},
                          {"description"},
                          {"source"},
                          {"environment", &environment},
                          {"base", &base_table},
                          {"platform", &platform},
                          {"legs", &all_legs},
                          {"leg", &single_legs},
                          {"model", &model_table},
                          {"damping", &damping},
                          {"supply", &supply},
                          {"controller", &controller},
                          {"sensors", &sensors},
                          {"poses", &poses}};
constexpr TableKeys root_table{root_keys};

class KeyCheck {
 public:
  explicit KeyCheck(Faults& faults) : faults_(faults) {}

  void check(const Node& table, const TableKeys& known, const std::string& path) {
    for (const auto& child : table.children) {
      const std::string child_path = joined_path(path, child.key);
      const auto key = std::find_if(known.keys.begin(), known.keys.end(),
                                    [&](const Key& k) { return k.name == child.key; });
      if (known.named != nullptr) {
        check_table(child, *known.named, child_path);
      } else if (key == known.keys.end()) {
        report_unknown(child, known, path);
      } else if (key->table != nullptr && (child.is_table() || !key->value_or_table)) {
        check_table(child, *key->table, child_path);
      }
    }
  }

 private:
  void check_table(const Node& node, const TableKeys& known, const std::string& path) {
    if (node.is_table()) return check(node, known, path);
    const std::string names = known.named != nullptr ? "named poses" : "the keys " + listed(known);
    faults_.add(node.place, path,
                fmt::format("is {}, expected a table with {}", described(node), names));
    faults_.mark_incomplete();
  }

  void report_unknown(const Node& node, const TableKeys& known, const std::string& path) {
    std::vector<std::string_view> names;
    for (const auto& key : known.keys) names.push_back(key.name);
    const auto meant = base::nearest(node.key, names);
    // Names of one letter (the numbers of the legs) are too alike for a guess.
    std::string advice = "known here: " + listed(known);
    if (meant && meant->size() > 1) {
      advice = fmt::format("did you mean `{}`?", *meant);
      faults_.mark_misspelt(joined_path(path, *meant));
    }
    faults_.add(node.key_place, joined_path(path, node.key), "unknown key; " + advice);
  }

  static std::string listed(const TableKeys& known) {
    std::string names;
    for (const auto& key : known.keys) {
      if (!names.empty()) names += ", ";
      names += key.name;
    }
    return names;
  }

  Faults& faults_;
};

}  // namespace

void check_keys(const Node& root, Faults& faults) { KeyCheck(faults).check(root, root_table, ""); }

}  // namespace hydrapod::model
