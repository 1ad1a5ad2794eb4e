#include "machine_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/text.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

namespace {

/// Paths of rows that a table of the file stands for: of one leg, `legs.` and `leg.*.`.
using Fronts = std::vector<std::string>;

const Fronts one_leg{"legs.", "leg.*."};

/// The keys of a table, in the order of the rows.
std::vector<std::string_view> keys_of(const Fronts& fronts) {
  if (fronts == Fronts{"leg."}) return {"1", "2", "3", "4", "5", "6"};
  if (fronts == Fronts{"platform.inertia."}) return {"xx", "yy", "zz", "xy", "xz", "yz"};
  std::vector<std::string_view> keys;
  for (const auto& front : fronts)
    for (const auto& row : parameter_table()) {
      if (!row.path.starts_with(front)) continue;
      const auto rest = row.path.substr(front.size());
      const auto key = rest.substr(0, rest.find('.'));
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  return keys;
}

class KeyCheck {
 public:
  explicit KeyCheck(Faults& faults) : faults_(faults) {}

  void check(const Node& table, const Fronts& fronts, const std::string& path) {
    const auto known = keys_of(fronts);
    for (const auto& child : table.children) {
      const std::string child_path = joined_path(path, child.key);
      const bool named = fronts == Fronts{"poses."} || fronts == Fronts{"payload_modes."};
      if (!named && std::find(known.begin(), known.end(), child.key) == known.end()) {
        report_unknown(child, known, path);
        continue;
      }
      Fronts below;
      for (const auto& front : fronts) below.push_back(front + (named ? "*" : child.key) + ".");
      if (fronts == Fronts{"leg."}) below = one_leg;
      const bool value_or_table = child_path == "platform.inertia";
      const auto keys = keys_of(below);
      if (keys.empty() || (value_or_table && !child.is_table())) continue;
      check_table(child, below, keys, child_path);
    }
  }

 private:
  void check_table(const Node& node, const Fronts& fronts,
                   const std::vector<std::string_view>& keys, const std::string& path) {
    if (node.is_table()) return check(node, fronts, path);
    const std::string names = path == "poses" ? "named poses"
                              : path == "payload_modes"
                                  ? "named modes"
                                  : fmt::format("the keys {}", fmt::join(keys, ", "));
    faults_.add(node.place, path,
                fmt::format("is {}, expected a table with {}", described(node), names));
    faults_.mark_incomplete();
  }

  void report_unknown(const Node& node, const std::vector<std::string_view>& known,
                      const std::string& path) {
    const auto meant = base::nearest(node.key, known);
    // Names of one letter (the numbers of the legs) are too alike for a guess.
    std::string advice = fmt::format("known here: {}", fmt::join(known, ", "));
    if (meant && meant->size() > 1) {
      advice = fmt::format("did you mean `{}`?", *meant);
      faults_.mark_misspelt(joined_path(path, *meant));
    }
    faults_.add(node.key_place, joined_path(path, node.key), "unknown key; " + advice);
  }

  Faults& faults_;
};

}  // namespace

std::string_view instead_of_table(std::string_view path) {
  if (belongs_to(LegType::strut, path)) return "";
  if (belongs_to(LegType::screw, path))
    return "; a plain strut, [legs.strut], in place of all parts of a cylinder would do too";
  return "; [legs.screw] of an electric cylinder in its place, or a plain strut, [legs.strut], "
         "in place of all parts of a cylinder would do too";
}

void refuse_beside(LegType type, const Section& leg) {
  const std::string_view own = type == LegType::strut ? "strut" : "screw";
  if (type == LegType::cylinder || !leg.has(own)) return;
  std::vector<std::string> found{};
  std::string_view last{};
  for (const auto& row : parameter_table()) {
    if (belongs_to(type, row.path)) continue;
    auto key = row.path.substr(of_legs.size());
    key = key.substr(0, key.find('.'));
    if (key != last && leg.has(key)) found.push_back(fmt::format("`{}`", key));
    last = key;
  }
  if (found.empty()) return;
  auto list = found.back();
  found.pop_back();
  if (!found.empty()) list = fmt::format("{} and {}", fmt::join(found, ", "), list);
  const auto has = type == LegType::strut ? "a plain strut has no other parts"
                                          : "an electric cylinder has no oil and no valve";
  leg.report(leg.find(own), fmt::format("is given beside {}, expected either the one or "
                                        "the other: {}; all six legs are alike",
                                        list, has));
}

void check_keys(const Node& root, Faults& faults) { KeyCheck(faults).check(root, {""}, ""); }

}  // namespace hydrapod::model
