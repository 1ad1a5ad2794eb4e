#pragma once
/// Bode curves as the page draws them.

#include <span>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "response/direct_responses.hpp"

namespace hydrapod::page {

/// The response of `model` to a wrench at `p_PQ`, a point of the platform in P [m].
response::ResponseModel responses_at(const modal::AnalysedModel& model,
                                     const modal::ModeTable& table, const spatial::Vector3& p_PQ);

/// The damped modes of `model` for the sum over them; empty where a mode does not oscillate.
response::DampedShapes damped_shapes(const modal::AnalysedModel& model);

/// Behind `numbers` the responses `H`: by line, output and input: re, im.
void add_responses(std::span<const response::Matrix6c> H, std::vector<double>& numbers);

/// The direct responses alone: by line and direction: re, im.
void add_direct_responses(std::span<const response::DirectLine> H, std::vector<double>& numbers);

/// From … to [rad/s]: how many lines there are, the lines [rad/s], `points` on a logarithmic axis
/// and more around resonances, then responses with flexible and with rigid legs; then for every
/// peak of a response between different directions five numbers: 0 of flexible or 1 of rigid legs,
/// output, input, line and the number in the mode table of the mode behind it.
std::vector<double> bode_curves(const modal::ModeTable& table, const spatial::Vector3& p_PQ,
                                double from, double to, int points);

}  // namespace hydrapod::page
