#pragma once
/// Records with spikes, and records of many kinds without. Shared by the short and the long test.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "foreign_loop.hpp"
#include "gapped.hpp"
#include "hammer.hpp"
#include "identification/spikes.hpp"

namespace hydrapod::identification {

/// What find_spikes() sees in a record, of all its channels.
std::vector<Spike> spikes_in(const data::Record& record);

std::vector<data::ResponseWarning> spike_warnings(const FrequencyResponses& responses);

/// `count` spikes of `height` times the channel's RMS, of one to three samples, at random times.
void add_spikes(Eigen::Index channel, int count, double height, test::Random& random,
                data::Record& record);

/// Three forces on five masses, 300 s.
data::Record quiet_record(std::uint64_t seed);

/// Student's t with five degrees of freedom.
double heavy_tailed(test::Random& random);

enum class CleanKind {
  hammer,
  hammer_of_two_samples,
  several_hits,
  sweep,
  multisine,
  white_loop,
  stepped_sine,
  three_bits,
  heavy_tails,
  steps,
  count
};

/// A sine on the first of five masses whose frequency grows in 31 steps, 0.3 % noise.
data::Record stepped_sine(std::uint64_t seed);

/// Forces that jump to another value every 0.37 s and stay there: the outputs creep.
data::Record stepped_forces(std::uint64_t seed);

data::Record clean_record(CleanKind kind, std::uint64_t seed);

}  // namespace hydrapod::identification
