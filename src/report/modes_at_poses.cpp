#include <fmt/format.h>

#include "fields.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

Json followed_json(const ModesAtPoses& modes, const ModesAtPoses::Followed& one) {
  Json json{{"mode", Json::array()}, {"mac", Json::array()}, {"frequency_hz", Json::array()}};
  for (std::size_t k = 0; k < one.mode.size(); ++k) {
    const int mode = one.mode[k];
    json["mode"].push_back(mode >= 0 ? Json(mode + 1) : Json());
    json["mac"].push_back(written(one.mac[k]));
    json["frequency_hz"].push_back(
        mode >= 0 ? Json(modes.tables[k].real.modes[static_cast<std::size_t>(mode)].mode.omega /
                         base::two_pi)
                  : Json());
  }
  return json;
}

}  // namespace

Json modes_at_poses_json(const ModesAtPoses& modes) {
  Json json{{"poses", Json::array()}, {"followed", Json::array()}};
  for (std::size_t k = 0; k < modes.poses.size(); ++k) {
    Json at{{"pose", pose_json(modes.poses[k])}};
    at.update(modes_json(modes.tables[k]));
    json["poses"].push_back(std::move(at));
  }
  for (const auto& one : modes.followed) json["followed"].push_back(followed_json(modes, one));
  return json;
}

ModesAtPoses modes_at_poses_from_json(const Json& json, const std::string& file) {
  const Reader fields(json, file);
  for (const char* list : {"poses", "followed"})
    if (!fields.at(list).is_array()) fields.bad(list, "expected a list");
  ModesAtPoses modes;
  for (const auto& at : json["poses"]) {
    modes.poses.push_back(pose_from_json(at, file));
    modes.tables.push_back(modes_from_json(at, file));
  }
  for (const auto& one : json["followed"]) {
    ModesAtPoses::Followed followed;
    std::vector<std::optional<int>> numbers;
    const Reader of(one, file, "followed");
    of("mode", numbers);
    of("mac", followed.mac);
    if (numbers.size() != modes.poses.size() || followed.mac.size() != numbers.size())
      of.bad("mode", "expected as many entries as there are poses");
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const int mode = numbers[k].value_or(0) - 1;
      if ((numbers[k] && mode < 0) || mode >= static_cast<int>(modes.tables[k].real.modes.size()))
        of.bad("mode", "there is no such mode at this pose");
      followed.mode.push_back(mode);
    }
    modes.followed.push_back(std::move(followed));
  }
  return modes;
}

std::string modes_at_poses_csv(const ModesAtPoses& modes) {
  std::string text =
      "followed,pose,mode,frequency_hz,omega_rad_s,damping_ratio,mac_with_pose_before,label\n";
  for (std::size_t f = 0; f < modes.followed.size(); ++f)
    for (std::size_t k = 0; k < modes.poses.size(); ++k) {
      const int mode = modes.followed[f].mode[k];
      if (mode < 0) continue;
      const auto& entry = modes.tables[k].real.modes[static_cast<std::size_t>(mode)];
      const auto& mac = modes.followed[f].mac[k];
      text += fmt::format(
          "{},{},{},{:.17g},{:.17g},{:.17g},{},{}\n", f + 1, base::quoted_cell(modes.poses[k].name),
          mode + 1, entry.mode.omega / base::two_pi, entry.mode.omega, entry.mode.damping_ratio,
          mac ? fmt::format("{:.17g}", *mac) : "", base::quoted_cell(entry.label));
    }
  return text;
}

}  // namespace hydrapod::report
