#pragma once
/// The whole machine as one linear system, for people and programs: poles, root locus, response
/// from command to pose.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/report/json.hpp"
#include "hydrapod/simulation/system_poles.hpp"

namespace hydrapod::report {

/// What takes part in a pole, in words: "oil 41 %, controller 38 %, platform z 12 %"; parts below
/// 10 % are left out. A leg that has most of a part's share is named.
std::string participation_text(const simulation::SystemPole& pole);

/// "stable: …" or "unstable: …", by the sampled loop, with the pole that decides it.
std::string verdict_text(const simulation::LinearSystem& system,
                         const simulation::SystemPoles& poles);

/// `stable`, `poles[]`, `sampled`, `delay`.
Json system_poles_json(const simulation::LinearSystem& system,
                       const simulation::SystemPoles& poles);
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
/// `system_at` gives the system for a value; `progress` gets the share that is done.
RootLocus root_locus(const std::string& key, const std::vector<double>& values,
                     const std::function<simulation::LinearSystem(double)>& system_at,
                     const std::function<void(double)>& progress = {});
Json root_locus_json(const RootLocus& locus);
std::string root_locus_csv(const RootLocus& locus);
/// Poles in the complex plane, coloured by the value. Throws as plot_bode does.
void plot_root_locus(const RootLocus& locus, const std::string& title, const std::string& subtitle,
                     const std::string& path);

/// H from the commanded to the true displacement of the pose, 6×6.
struct CommandResponse {
  std::vector<double> omega{};  ///< [rad/s]
  std::vector<Eigen::Matrix<std::complex<double>, 6, 6>> H{};
};
CommandResponse command_response(const simulation::LinearSystem& system, double from, double to,
                                 int points);

/// What a direct response is like.
struct CommandBandwidth {
  std::optional<double> magnitude{};  ///< −3 dB [rad/s]
  std::optional<double> phase{};      ///< −90° [rad/s]
  double peak{};                      ///< largest magnitude
  double peak_omega{};                ///< [rad/s]
};
CommandBandwidth command_bandwidth(const CommandResponse& response, int direction);

Json command_response_json(const CommandResponse& response);
std::string command_response_csv(const CommandResponse& response);
void plot_command_response(const CommandResponse& response, const std::string& title,
                           const std::string& subtitle, const std::string& path);

}  // namespace hydrapod::report
