#include "machine_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "elastomer_table.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

namespace {

constexpr std::size_t most_poses = 1000;

JointPoints unread_points() {
  JointPoints points;
  points.fill(Vector3::Constant(unread));
  return points;
}

/// The joints at one end of the legs.
struct LegEnd {
  std::string_view owner{};  ///< "base", "platform"
  Vector3 Leg::*joint{};
  JointPoints shared{};        ///< from the table of all legs; NaN where it has none
  unsigned own{};              ///< legs that give their own
  std::vector<int> without{};  ///< legs that have neither
};

/// Reads one machine, row by row of the table, and remembers which numbers the file gives.
class Reader {
 public:
  Reader(const Node& tree, Faults& faults) : tree_(tree), root_(tree, faults) {}

  ReadMachine read() {
    auto& machine = read_.machine;
    machine.name = root_.text("name");
    machine.description = root_.optional_text("description");
    machine.source = root_.optional_text("source");
    machine.state = root_.optional_text("state");
    read_gravity();
    read_inertia();
    read_legs();
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if (!rows_[r].path.starts_with(of_legs)) read_row(r, root_, rows_[r].path, 0);
    read_payload_modes();
    read_poses();
    keep_undamped();
    return std::move(read_);
  }

 private:
  /// A damper that the file states, and be it as 0, says what damps: the assumed ratio is for files
  /// that say nothing about damping. It does not come back where a study takes the damper to 0.
  void keep_undamped() {
    if (read_.machine.damping.modal_ratio) return;
    constexpr std::array<std::string_view, 7> keys{
        "legs.guide_sleeve.damping", "legs.piston_ring.damping", "legs.oil_spring.damping",
        "legs.strut.damping",        "legs.screw.damping",       "damping.rayleigh_mass",
        "damping.rayleigh_stiffness"};
    const bool stated = std::ranges::any_of(read_.given, [&](const GivenNumber& given) {
      return std::ranges::find(keys, rows_[given.id.row].path) != keys.end();
    });
    if (stated) read_.machine.damping.modal_ratio = 0.0;
  }

  // ---- Rows ---------------------------------------------------------------------------------

  /// Reads the key of a row from its table below `top`, where that table is in the file.
  void read_row(std::size_t r, const Section& top, std::string_view path, int index) {
    const auto& row = rows_[r];
    if (row.in_code || row.kind == Kind::table || row.kind == Kind::text) return;
    if (table_of(row.path) != last_table_path_) {
      last_table_path_ = table_of(row.path);
      last_table_ =
          table_at(top, row.path.substr(0, row.path.size() - path.size()), table_of(path));
    }
    const auto& table = last_table_;
    if (!table || !is_chosen(*table, row.path)) return;
    if (row.kind == Kind::word) {
      const auto key = last_key(path);
      if (table->has(key))
        row.set_word(read_.machine, index, static_cast<int>(table->word(key, row.words)));
    } else {
      read_numbers(r, *table, index);
    }
  }

  /// The table at `path` below `top`; nothing where an optional table on the way is left out.
  /// `front` is the path of `top` in the rows.
  std::optional<Section> table_at(const Section& top, std::string_view front,
                                  std::string_view path) {
    Section table = top;
    std::string at{front};
    while (!path.empty()) {
      const auto key = path.substr(0, path.find('.'));
      path.remove_prefix(std::min(path.size(), key.size() + 1));
      at += key;
      const auto r = row(at);
      const bool required = r < rows_.size() && rows_[r].required;
      if (!is_chosen(table, at)) return std::nullopt;
      table =
          required ? table.required_table(key, instead_of_table(at)) : table.optional_table(key);
      if (!required && !table.exists()) return std::nullopt;
      at += '.';
    }
    return table;
  }

  /// Is the key at `path` the one of two alternatives that the file gives? Others always are.
  static bool is_chosen(const Section& table, std::string_view path) {
    const auto key = last_key(path);
    for (const auto& pair : alternatives()) {
      if (last_key(table_of(path)) != pair.table || (key != pair.first && key != pair.second))
        continue;
      return table.choice(pair.first, pair.second) == key;
    }
    return true;
  }

  void read_numbers(std::size_t r, const Section& table, int index) {
    const auto& row = rows_[r];
    const auto key = last_key(row.path);
    const auto unit = unit_of(read_.machine, row);
    const auto value = table.find(key);
    if (value && row.otherwise == rigid_word && value.node->kind == Node::Kind::text &&
        value.node->text == rigid_word)
      return make_part(row, index);
    std::vector<double> numbers(static_cast<std::size_t>(row.numbers), unread);
    if (value) {
      const bool single =
          row.numbers == 1 || (row.kind == Kind::six && value.node->kind != Node::Kind::array);
      if (single) {
        std::fill(numbers.begin(), numbers.end(), table.read_number(value, unit));
        remember(r, row.numbers == 1 ? 0 : whole, index, value, numbers[0]);
      } else {
        numbers = read_array(r, table, value, index, unit);
      }
    } else if (row.required) {
      table.report_missing_numbers(key, unit, numbers.size());
    } else {
      return make_part(row, index);
    }
    for (int k = 0; k < row.numbers; ++k) *row.make(read_.machine, index, k) = numbers[k];
    if (row.finish != nullptr) row.finish(read_.machine, 1U << index);
  }

  /// A part whose table is there is there, even where all of its keys are left out.
  void make_part(const ParameterRow& row, int index) {
    if (!row.optional) row.make(read_.machine, index, 0);
  }

  std::vector<double> read_array(std::size_t r, const Section& table, const Section::Value& value,
                                 int index, std::string_view unit) {
    const auto numbers = table.read_array(value, static_cast<std::size_t>(rows_[r].numbers), unit);
    for (std::size_t k = 0; k < numbers.size(); ++k)
      remember(r, static_cast<int>(k), index, table.element(value, k), numbers[k]);
    return numbers;
  }

  /// Notes a number of leg, pose or mode `index`; one that legs share is one number.
  void remember(std::size_t r, int element, int index, const Section::Value& value, double number) {
    if (value.node == nullptr) return;
    const bool of_leg = value.path.starts_with("leg.") || rows_[r].path.starts_with("leg.");
    const bool single = of_leg || rows_[r].path.starts_with("poses.") ||
                        rows_[r].path.starts_with("payload_modes.");
    const bool shared = value.path.starts_with(of_legs);
    const ParameterId id{static_cast<std::uint16_t>(r), static_cast<std::int16_t>(element),
                         static_cast<std::int16_t>(single ? index + 1 : 0),
                         static_cast<std::uint16_t>(shared || of_leg ? 1U << index : 0x3FU)};
    const auto known = std::find_if(read_.given.begin(), read_.given.end(), [&](const auto& given) {
      return given.id == id && given.written == value.path;
    });
    if (known == read_.given.end()) {
      read_.given.push_back({id, number, value.node->place.line, value.path});
    } else {
      known->id.legs |= id.legs;
    }
  }

  std::size_t row(std::string_view path) const {
    const auto found = std::find_if(rows_.begin(), rows_.end(),
                                    [&](const ParameterRow& r) { return r.path == path; });
    return static_cast<std::size_t>(found - rows_.begin());
  }

  // ---- Gravity and the platform's tensor -----------------------------------------------------

  /// Gravity as a magnitude along −z, or as a vector.
  void read_gravity() {
    const Section environment = root_.optional_table("environment");
    const auto value = environment.find("gravity");
    if (!value) return;
    const auto r = row("environment.gravity");
    if (value.node->kind == Node::Kind::array) {
      const auto numbers = read_array(r, environment, value, 0, rows_[r].unit);
      read_.machine.gravity = Eigen::Map<const Vector3>(numbers.data());
      return;
    }
    const double magnitude = environment.read_number(value, rows_[r].unit);
    remember(r, whole, 0, value, magnitude);
    if (magnitude < 0.0) {
      environment.report(value, fmt::format("is {} m/s^2, expected a magnitude of 0 or more (it "
                                            "points along -z), or an array [gx, gy, gz]",
                                            magnitude));
    }
    rows_[r].set(read_.machine, 0, whole, magnitude);
  }

  void read_inertia() {
    const Section platform = root_.required_table("platform");
    auto& inertia = read_.machine.platform.inertia;
    inertia.setConstant(unread);
    const auto value = platform.find("inertia");
    const auto r = row("platform.inertia");
    const auto unit = rows_[r].unit;
    if (!value) {
      return platform.report_missing("inertia",
                                     "required value ({ xx, yy, zz, xy, xz, yz }, or three rows of "
                                     "three numbers in kg m^2)");
    }
    constexpr int element_of[3][3]{{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    if (!value.node->is_table()) {
      const auto rows = platform.elements(
          value, 3, "three rows of three numbers in kg m^2, or { xx, yy, zz, xy, xz, yz }");
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto numbers = platform.read_array(rows[i], 3, unit);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
          inertia(static_cast<int>(i), static_cast<int>(k)) = numbers[k];
          remember(r, element_of[i][k], 0, platform.element(rows[i], k), numbers[k]);
        }
      }
      return;
    }
    const Section table = platform.required_table("inertia");
    constexpr std::array moments{"xx", "yy", "zz"}, products{"xy", "xz", "yz"};
    for (int k = 0; k < 6; ++k) {
      const std::string_view key = k < 3 ? moments[k] : products[k - 3];
      const double number = k < 3 ? table.number(key, unit) : table.number(key, unit, 0.0);
      rows_[r].set(read_.machine, 0, k, number);
      remember(r, k, 0, table.find(key), number);
    }
  }

  // ---- Joints and legs -----------------------------------------------------------------------

  std::optional<JointCircle> read_circle(const Section& joints) {
    const Section table = joints.required_table("circle");
    const JointCircle circle{table.number("radius", "m"), table.number("spacing", "m")};
    if (circle.radius <= 0.0) {
      table.report(table.find("radius"),
                   fmt::format("is {} m, expected a radius above 0", circle.radius));
      return std::nullopt;
    }
    if (circle.spacing < 0.0 || circle.spacing >= 2.0 * circle.radius) {
      table.report(table.find("spacing"),
                   fmt::format("is {} m, expected 0 or more and less than the circle's diameter, "
                               "{} m",
                               circle.spacing, 2.0 * circle.radius));
      return std::nullopt;
    }
    return circle;
  }

  JointPoints read_points(const Section& joints, std::size_t joint) {
    JointPoints points = unread_points();
    const auto rows = joints.elements(joints.find("points"), leg_count,
                                      "an array of 6 points, each [x, y, z] in m");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto numbers = read_array(joint, joints, rows[i], static_cast<int>(i), "m");
      points[i] = Eigen::Map<const Vector3>(numbers.data());
    }
    return points;
  }

  /// Joints that every leg shares a table for; legs may still give their own. Lays out a circle.
  JointPoints read_joints(std::string_view owner, std::optional<JointCircle>& circle,
                          JointPoints (*on_circle)(const JointCircle&)) {
    const Section joints = root_.optional_table(owner).optional_table("joints");
    const auto how = joints.choice("circle", "points");
    if (how == "points") return read_points(joints, row(fmt::format("leg.*.{}_joint", owner)));
    if (how != "circle") return unread_points();
    const Section table = joints.optional_table("circle");
    circle = read_circle(joints);
    if (!circle) return unread_points();
    for (const auto key : {"radius", "spacing"}) {
      const auto r = row(fmt::format("{}.joints.circle.{}", owner, key));
      remember(r, 0, 0, table.find(key), *rows_[r].find(read_.machine, 0, 0));
    }
    return on_circle(*circle);
  }

  /// Reports the legs that have a joint neither from the shared table nor from their own.
  void require_joints(const LegEnd& end) {
    const auto owner = end.owner;
    if (end.without.empty()) return;
    const Section table = root_.optional_table(owner);
    const Section joints = table.optional_table("joints");
    if (!joints.choice("circle", "points").empty()) return;  // there, but not readable
    std::string legs = "every leg";
    if (end.without.size() < leg_count) legs = fmt::format("leg {}", fmt::join(end.without, ", "));
    const std::string what = fmt::format(
        "`circle = {{ radius, spacing }}` or `points = [[x, y, z] of six legs]` (or `{}_joint` of "
        "{})",
        owner, legs);
    if (joints.exists()) return joints.report_missing("circle", what);
    if (table.exists()) return table.report_missing("joints", "required table with " + what);
    root_.report_missing(owner, fmt::format("required table [{}]", owner));
  }

  Vector3 read_joint(const Section& own, std::string_view key, const Vector3& shared, int leg) {
    const auto value = own.find(key);
    if (!value) return shared;
    const auto r = row(fmt::format("leg.*.{}", key));
    // the point that this joint takes the place of is no number of the machine
    std::erase_if(read_.given, [&](const GivenNumber& given) {
      return given.id.row == r && given.id.of == leg + 1;
    });
    const auto numbers = read_array(r, own, value, leg, "m");
    return Eigen::Map<const Vector3>(numbers.data());
  }

  void read_legs() {
    auto& machine = read_.machine;
    std::array ends{
        LegEnd{"base", &Leg::base_joint,
               read_joints("base", machine.base_circle, base_joint_points)},
        LegEnd{"platform", &Leg::platform_joint,
               read_joints("platform", machine.platform_circle, platform_joint_points)}};
    const Section all_legs = root_.optional_table("legs");
    const Section single_legs = root_.optional_table("leg");
    for (int i = 0; i < leg_count; ++i) {
      const Section own = single_legs.optional_table(std::to_string(i + 1));
      const bool given = own.exists() || all_legs.exists();
      const Section both = given ? Section::overlaid(own, all_legs) : root_.required_table("legs");
      read_leg(both, i);
      for (auto& end : ends) {
        const std::string key = fmt::format("{}_joint", end.owner);
        const auto& shared = end.shared[static_cast<std::size_t>(i)];
        if (own.has(key))
          end.own |= 1U << i;
        else if (!shared.allFinite())
          end.without.push_back(i + 1);
        machine.legs[static_cast<std::size_t>(i)].*end.joint = read_joint(own, key, shared, i);
      }
    }
    for (const auto& end : ends) {
      const std::string joints = fmt::format("{}.joints", end.owner);
      for (auto& given : read_.given)
        if (rows_[given.id.row].path.starts_with(joints))
          given.id.legs = static_cast<std::uint16_t>(given.id.legs & ~end.own);
      require_joints(end);
    }
  }

  void read_leg(const Section& section, int leg) {
    last_table_path_ = {};
    const auto type = section.is_meant("strut")   ? LegType::strut
                      : section.is_meant("screw") ? LegType::screw
                                                  : LegType::cylinder;
    refuse_beside(type, section);
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if (rows_[r].path.starts_with(of_legs) && belongs_to(type, rows_[r].path))
        read_row(r, section, rows_[r].path.substr(of_legs.size()), leg);
    auto& read = read_.machine.legs[static_cast<std::size_t>(leg)];
    if (type == LegType::strut && !read.strut) read.strut.emplace().stiffness = unread;
    if (type == LegType::screw && !read.screw) read.screw.emplace().lead = unread;
    if (type == LegType::strut) return;
    read_elastomer_table(section.optional_table("guide_sleeve"), read.guide_sleeve.elastomer, fits_,
                         read_.findings);
    if (read.piston_ring)
      read_elastomer_table(section.optional_table("piston_ring"), read.piston_ring->elastomer,
                           fits_, read_.findings);
    if (type == LegType::screw) return;
    const Section spring =
        section.required_table("oil_spring", instead_of_table("legs.oil_spring"));
    if (!spring.choice("stiffness", "cylinder").empty()) return;
    spring.report_missing("stiffness", "either this value or the table `cylinder`");
    read.oil_spring.stiffness = unread;
  }

  // ---- Modes of the payload ------------------------------------------------------------------

  void read_payload_modes() {
    const Section table = root_.optional_table("payload_modes");
    const Node* node = tree_.find("payload_modes");
    if (node == nullptr || !node->is_table()) return;
    constexpr std::string_view front = "payload_modes.*.";
    for (const auto& child : node->children) {
      if (!child.is_table()) continue;
      const int index = static_cast<int>(read_.machine.payload_modes.size());
      if (index == most_payload_modes) {
        return root_.report(root_.find("payload_modes"),
                            fmt::format("holds {} modes, expected no more than {}",
                                        node->children.size(), most_payload_modes));
      }
      read_.machine.payload_modes.push_back({.name = child.key});
      const Section mode = table.optional_table(child.key);
      for (std::size_t r = 0; r < rows_.size(); ++r)
        if (rows_[r].path.starts_with(front) && rows_[r].make != nullptr)
          read_numbers(r, mode, index);
    }
  }

  // ---- Poses ---------------------------------------------------------------------------------

  /// Degrees are easily written without their unit. No pose has an angle of more than a turn.
  static void judge_angle(const Section& pose, const Section::Value& rotation, std::size_t k,
                          double angle) {
    constexpr double as_written = 1e-3;  // π as 3.142
    if (!(std::abs(angle) > std::numbers::pi * (1.0 + as_written))) return;
    const auto value = pose.element(rotation, k);
    const bool plain = value.node == nullptr || value.node->kind != Node::Kind::text;
    constexpr double rounding = 1e-9;
    if (plain)
      pose.report(value, fmt::format("is {0:.6g} rad, more than half a turn; did you mean {0:.6g} "
                                     "deg?",
                                     angle));
    else if (std::abs(angle) > base::two_pi * (1.0 + rounding))
      pose.report(value, fmt::format("is {:.6g} rad, expected no more than a whole turn", angle));
  }

  Pose read_pose(const Section& pose, int index) {
    const Vector3 rpy = pose.vector("rotation", "rad", Vector3::Zero());
    const Pose X_BP{spatial::rotation_from_rpy(rpy), pose.vector("position", "m")};
    if (const auto value = pose.find("rotation"); value)
      for (int k = 0; k < 3; ++k) judge_angle(pose, value, static_cast<std::size_t>(k), rpy[k]);
    for (const auto& [key, numbers] : {std::pair{"rotation", rpy}, {"position", X_BP.p_BP}})
      if (const auto value = pose.find(key); value)
        for (int k = 0; k < 3; ++k)
          remember(row(fmt::format("poses.*.{}", key)), k, index,
                   pose.element(value, static_cast<std::size_t>(k)), numbers[k]);
    return X_BP;
  }

  void read_poses() {
    const Section table = root_.required_table("poses");
    auto& poses = read_.machine.poses;
    poses.push_back({"neutral", read_pose(table.required_table("neutral"), 0)});
    const Node* node = tree_.find("poses");
    if (node == nullptr || !node->is_table()) return;
    if (node->children.size() > most_poses) {
      return root_.report(root_.find("poses"),
                          fmt::format("holds {} poses, expected no more than {}",
                                      node->children.size(), most_poses));
    }
    for (const auto& child : node->children) {
      if (child.key == "neutral" || !child.is_table()) continue;
      const int index = static_cast<int>(poses.size());
      poses.push_back({child.key, read_pose(table.optional_table(child.key), index)});
    }
  }

  const Node& tree_;
  Section root_;
  std::span<const ParameterRow> rows_{parameter_table()};
  std::string_view last_table_path_{};  ///< of the rows
  std::optional<Section> last_table_{};
  KnownFits fits_{};
  ReadMachine read_{};
};

}  // namespace

ReadMachine read_machine(const Node& tree, Faults& faults) {
  auto read = Reader(tree, faults).read();
  std::stable_sort(read.given.begin(), read.given.end(), [](const auto& a, const auto& b) {
    return a.line - 1U < b.line - 1U;  // overrides, of line 0, last
  });
  return read;
}

}  // namespace hydrapod::model
