#include "finding_place.hpp"

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "hydrapod/model/machine.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

namespace {

KeyPath path_below(std::initializer_list<std::string> front, const KeyPath& path,
                   std::size_t first) {
  KeyPath joined;
  for (const auto& key : front) joined.push_back({key, std::nullopt});
  joined.insert(joined.end(), path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
  return joined;
}

/// Number of the leg (1…6) that `path` is about, 0 if it is not about a single leg.
int leg_number(const KeyPath& path) {
  if (path.size() < 2 || path[0].key != "leg" || path[1].key.size() != 1) return 0;
  const int number = path[1].key[0] - '0';
  return number >= 1 && number <= leg_count ? number : 0;
}

/// Where the joint of a leg may stand instead of in its own table.
std::vector<KeyPath> joint_places(const std::string& key, int leg) {
  std::string owner;
  if (key == "base_joint") owner = "base";
  if (key == "platform_joint") owner = "platform";
  if (owner.empty()) return {};
  KeyPath points = path_below({owner, "joints", "points"}, {}, 0);
  points.push_back({"", static_cast<std::size_t>(leg - 1)});
  return {points, path_below({owner, "joints", "circle"}, {}, 0),
          path_below({owner, "joints"}, {}, 0)};
}

/// The paths under which the same value may stand, the likeliest first.
std::vector<KeyPath> equal_paths(const KeyPath& path) {
  std::vector<KeyPath> paths{path};
  if (const int leg = leg_number(path)) {
    if (path.size() > 2) {
      for (auto& place : joint_places(path[2].key, leg)) paths.push_back(std::move(place));
    }
    paths.push_back(path_below({"legs"}, path, 2));
  } else if (!path.empty() && path[0].key == "legs") {
    for (int number = 1; number <= leg_count; ++number) {
      paths.push_back(path_below({"leg", std::to_string(number)}, path, 1));
    }
  }
  return paths;
}

/// The pose that `key` names, even where its name would need quotes in a path ("poses.far left").
const Node* named_pose(const Node& root, std::string_view key) {
  constexpr std::string_view front = "poses.";
  const Node* poses = root.find("poses");
  if (poses == nullptr || !key.starts_with(front)) return nullptr;
  return poses->find(key.substr(front.size()));
}

/// The place to look at for a fault in `node`: a part that an override has put there before the
/// rest.
Place suspect_place(const Node& node) {
  Place suspect = node.place;
  for (const auto& child : node.children) {
    const Place place = suspect_place(child);
    if (place.source > suspect.source) suspect = place;
  }
  return suspect;
}

}  // namespace

FindingPlace find_place(const Node& root, const std::string& key) {
  KeyPath path = parse_path(key).value_or(KeyPath{});
  if (const auto* pose = named_pose(root, key)) path = path_below({"poses", pose->key}, {}, 0);
  for (; !path.empty(); path.pop_back()) {
    for (const auto& candidate : equal_paths(path)) {
      if (const Node* node = find_node(root, candidate))
        return {suspect_place(*node), to_string(candidate)};
    }
  }
  return {root.place, ""};
}

}  // namespace hydrapod::model
