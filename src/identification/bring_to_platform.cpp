#include "bring_to_platform.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "names.hpp"
#include "response_checks.hpp"

namespace hydrapod::identification {

namespace {

using data::Role;

/// Puts the six directions that `map` makes of the channels in the place of these, which are all in
/// `list`, one of the choice's.
PlatformChange replace_channels(const std::vector<int>& channels, const MatrixXd& map,
                                const std::string& prefix, std::vector<int>& list,
                                ChannelChoice& choice, Measurement& m) {
  warn_of_limits(m.spectra, rms_of_all(m.spectra), channels, m.responses.warnings);
  m.spectra = to_platform(m.spectra, channels, map, prefix);
  const auto renumber = [&](std::vector<int>& numbers) {
    std::vector<int> now;
    for (const int c : numbers) {
      if (std::ranges::find(channels, c) != channels.end()) continue;
      const auto before = std::ranges::count_if(channels, [&](int gone) { return gone < c; });
      now.push_back(c - static_cast<int>(before));
    }
    numbers = now;
  };
  renumber(choice.inputs);
  renumber(choice.outputs);
  renumber(choice.instruments);
  const int count = static_cast<int>(m.spectra.channels.size());
  for (int d = 6; d > 0; --d) list.push_back(count - d);
  return {channels, map};
}

/// All outputs, sensors at places that are known, become directions of the platform.
std::vector<PlatformChange> bring_sensors_to_platform(const MatrixXd& map, ChannelChoice& choice,
                                                      Measurement& m) {
  for (const int c : choice.outputs)
    if (m.spectra.health[static_cast<std::size_t>(c)].constant())
      throw base::ComputationError(
          fmt::format("{} is dead: leave it out by naming the other sensors with --outputs",
                      m.spectra.channels[static_cast<std::size_t>(c)].name));
  return {replace_channels(std::vector<int>(choice.outputs), map, {}, choice.outputs, choice, m)};
}

/// The channels of legs 1 … 6 with this role, if all are in `list` and alive.
std::optional<std::vector<int>> living_legs(const CrossSpectra& spectra, Role role,
                                            const std::vector<int>& list) {
  using Units = std::vector<std::string_view>;
  const auto legs = six_channels(spectra.channels, role, data::Direction::leg1,
                                 role == Role::response ? Units{"m", "m/s", "m/s^2"} : Units{});
  if (!legs) return {};
  for (const int leg : *legs) {
    if (std::ranges::find(list, leg) == list.end()) return {};
    if (!spectra.health[static_cast<std::size_t>(leg)].constant()) continue;
    if (role == Role::drive) return {};  // named where inputs are checked
    throw base::ComputationError(fmt::format(
        "{} is dead: the platform's directions need all six legs; without the machine file the "
        "other legs are identified as they are",
        spectra.channels[static_cast<std::size_t>(leg)].name));
  }
  return legs;
}

/// Leg lengths among the outputs become directions of the platform, and so do the legs' drives.
std::vector<PlatformChange> bring_to_platform(const PlatformFrame& frame, ChannelChoice& choice,
                                              Measurement& m) {
  const auto legs = living_legs(m.spectra, Role::response, choice.outputs);
  if (!legs) return {};
  const auto map = platform_from_legs(frame.machine, frame.X_BP, frame.p_BQ);
  std::vector<PlatformChange> changes{replace_channels(*legs, map, {}, choice.outputs, choice, m)};
  m.from_legs = true;
  if (choice.inputs.size() != 6) return changes;
  if (const auto drives = living_legs(m.spectra, Role::drive, choice.inputs))
    changes.push_back(replace_channels(*drives, map, "drive ", choice.inputs, choice, m));
  return changes;
}

}  // namespace

std::vector<PlatformChange> bring_outputs_to_platform(const MeasureOptions& options,
                                                      ChannelChoice& choice, Measurement& m) {
  if (options.outputs_to_platform)
    return bring_sensors_to_platform(*options.outputs_to_platform, choice, m);
  if (options.platform) return bring_to_platform(*options.platform, choice, m);
  return {};
}

MatrixXd brought_to_platform(const std::vector<PlatformChange>& changes, MatrixXd samples) {
  for (const auto& change : changes) {
    std::vector<Index> others;
    for (Index c = 0; c < samples.cols(); ++c)
      if (std::ranges::find(change.channels, static_cast<int>(c)) == change.channels.end())
        others.push_back(c);
    MatrixXd next(samples.rows(), static_cast<Index>(others.size()) + change.map.rows());
    next << samples(Eigen::all, others),
        samples(Eigen::all, change.channels) * change.map.transpose();
    samples = std::move(next);
  }
  return samples;
}

}  // namespace hydrapod::identification
