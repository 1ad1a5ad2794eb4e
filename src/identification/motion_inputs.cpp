#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

namespace {

bool is_measured_in(const data::Channel& channel, std::initializer_list<const char*> units) {
  if (channel.unit.empty() || channel.unit == "1") return false;
  return std::ranges::any_of(units, [&](const char* unit) {
    return channel.unit == unit || base::read_quantity("1 " + channel.unit, unit).ok();
  });
}

bool is_force_or_moment(const data::Channel& channel) {
  return is_measured_in(channel, {"N", "N m"});
}

/// Not one that was commanded.
bool is_measured_motion(const data::Channel& channel) {
  return channel.role != data::Role::excitation && channel.role != data::Role::drive &&
         is_measured_in(channel, {"m/s^2", "m", "m/s", "rad", "rad/s", "rad/s^2"});
}

}  // namespace

std::vector<data::ResponseWarning> check_inputs(const std::string& file,
                                                const std::vector<data::Channel>& inputs,
                                                const std::vector<data::Channel>& outputs) {
  const auto first = std::ranges::find_if(inputs, is_measured_motion);
  if (first == inputs.end()) return {};
  if (std::ranges::all_of(outputs, is_force_or_moment))
    base::refuse(
        file,
        fmt::format("the output {} is a force [{}] and the input {} a motion [{}]: poles of such "
                    "inverse responses are antiresonances, no modes of the machine; accepted are "
                    "responses of motions to forces or commands (m/N, (m/s^2)/N)",
                    base::printable(outputs.front().name), base::printable(outputs.front().unit),
                    base::printable(first->name), base::printable(first->unit)));
  return {{.kind = data::ResponseWarning::Kind::motion_input,
           .channel = first->name,
           .count = std::ranges::count_if(inputs, is_measured_motion),
           .total = std::ssize(inputs)}};
}

}  // namespace hydrapod::identification
