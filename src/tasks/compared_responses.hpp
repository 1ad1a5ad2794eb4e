#pragma once
/// Responses of what is compared: those that were measured, and what a machine shows on the same
/// channels. Private to the module.

#include "hydrapod/tasks/measurement.hpp"
#include "mode_differences.hpp"

namespace hydrapod::tasks {

/// Direct responses, else all; of as many as a picture can show.
void add_measured_responses(MeasuredResponses measured, Side& side);

/// To forces and moments on the platform, of mechanics.
void add_calculated_responses(const Machine& machine, int points, Side& side);

/// What `seen` of the machine shows where `measured` has responses. Where that cannot be computed
/// the description of the machine says why.
void add_shown_responses(const observation::Observation& seen, const Side& measured, Side& machine);

/// Responses that only one thing has show nothing beside others.
void keep_shared_responses(std::vector<report::ComparedThing>& things);

}  // namespace hydrapod::tasks
