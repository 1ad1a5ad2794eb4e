#include "pose_report.hpp"

#include <utility>

#include "geometry_json.hpp"
#include "modal_response_json.hpp"

namespace hydrapod::report {

Json pose_report(const model::Machine& machine, const model::NamedPose& pose,
                 const modal::ModeTable& table, int points) {
  Json json{{"pose", pose_json(pose)}, {"answer", answer_json(table)}};
  json.update(modes_json(table));
  json["geometry"] = geometry_json(machine, table.real.linear);
  if (points > 0)
    if (Json bode = bode_json(table, machine, points); !bode.is_null())
      json["bode"] = std::move(bode);
  return json;
}

}  // namespace hydrapod::report
