#pragma once
/// The whole machine as one linear system, for people and programs: poles, root locus, response
/// from command to pose.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/report/bode.hpp"
#include "hydrapod/simulation/system_poles.hpp"
#include "hydrapod/simulation/tuning.hpp"

namespace hydrapod::report {

/// What takes part in a pole, in words: "oil 41 %, controller 38 %, platform z 12 %"; parts below
/// 10 % are left out. A leg that has most of a part's share is named.
std::string participation_text(const simulation::SystemPole& pole);

/// "stable: …" or "unstable: …", by the sampled loop, with the pole that decides it.
std::string verdict_text(const simulation::SystemPoles& poles);

/// Mechanics, hydraulics and controller as one linear system.
struct System {
  bool closed{true};  ///< false: without the controller
  simulation::LinearSystem linear{};
  simulation::SystemPoles poles{};
  simulation::Tuning tuning{};  ///< of the controller; empty without one
};

/// `controller`, `stable`, `poles[]`, `sampled`, `delay`.
Json system_json(const System& system);
/// Reads it. Of `linear` there are the delay and the sample time.
System system_from_json(const Json& json, const std::string& file);
std::string system_poles_csv(const simulation::SystemPoles& poles);

/// Poles over one number of the machine file.
struct RootLocus {
  std::string key{};
  std::vector<double> values{};
  std::vector<simulation::SystemPoles> poles{};
  /// Where the sampled loop passes from stable to unstable or back between two values, bisected to
  /// 1e-4 of their distance.
  std::vector<double> limits{};
};
Json root_locus_json(const RootLocus& locus);
/// Reads it. Of the poles there is λ alone.
RootLocus root_locus_from_json(const Json& json, const std::string& file);
std::string root_locus_csv(const RootLocus& locus);
/// Poles in the complex plane, coloured by the value. Throws as plot_bode does.
void plot_root_locus(const RootLocus& locus, const std::string& title, const std::string& subtitle,
                     const std::string& path);

/// H from the commanded to the true displacement of the pose, 6×6.
struct CommandResponse {
  std::vector<double> omega{};  ///< [rad/s]
  std::vector<response::Matrix6c> H{};
};

/// What a direct response is like.
struct CommandBandwidth {
  std::optional<double> magnitude{};  ///< −3 dB [rad/s]
  std::optional<double> phase{};      ///< −90° [rad/s]
  double peak{};                      ///< largest magnitude
  double peak_omega{};                ///< [rad/s]
};
CommandBandwidth command_bandwidth(const CommandResponse& response, int direction);

Json command_response_json(const CommandResponse& response);
CommandResponse command_response_from_json(const Json& json, const std::string& file);
std::string command_response_csv(const CommandResponse& response);
void plot_command_response(const CommandResponse& response, const std::string& title,
                           const std::string& subtitle, const std::string& path);

}  // namespace hydrapod::report
