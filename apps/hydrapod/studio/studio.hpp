#pragma once
/// The page of one machine, served to the browsers of this computer, with the program behind it.
///
/// GET ""             the page
/// GET "state"        file, changed values, records, jobs
/// GET "edits"        what saving would write
/// GET "job/N"        a job with its result and picture
/// POST "values"      { "values": [[path, value], …], "assignments": ["PATH=VALUE"], "from": tab }
/// POST "save"        { "path": "" for the machine's file, "replace": false }
/// POST "page"        { "path", "replace" }: the page as one HTML file
/// POST "reload"      reads the machine file anew
/// POST "job"         see plans.hpp
/// POST "cancel/N"    cancels a job
/// POST "record?name" the bytes of a measured file; answers its number
///
/// Pages listen at "events": { "state": … } after every change, { "job": … } for progress. The page
/// has a number; one that is older than the state's has another machine or other results, and loads
/// itself again.

#include <string>
#include <vector>

#include "hydrapod/studio/open_machine.hpp"
#include "hydrapod/studio/server.hpp"

namespace hydrapod::studio {

struct StudioOptions {
  MachineChoice machine{};  ///< without a file: a new machine
  std::vector<std::string> records{};
  ServerOptions server{};
  std::string program{};  ///< that computes: this one
  bool browser{true};     ///< open one
};

/// Serves until SIGINT or SIGTERM. Throws base::InputError where it cannot begin.
void serve(StudioOptions options);

}  // namespace hydrapod::studio
