#pragma once
/// Hammer tests: a structure of unequal masses that is hit, and rings down. Outputs are those of
/// the continuous system at the times of the samples. Shared by the short and the long test.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "hydrapod/identification/identify.hpp"
#include "measured_records.hpp"
#include "support/identification_score.hpp"

namespace hydrapod::identification {

/// Hit at one of its three points.
test::ModalSystem beam(Eigen::Index point = 0);

struct HammerTest {
  double seconds{4.0};
  std::vector<double> at{0.113};  ///< [s]
  std::vector<double> size{};     ///< of each hit; empty: 1
  double width{3.7e-3};           ///< of a half sine [s]
  double noise{3e-4};             ///< of the largest output
  double offset{};                ///< of all outputs, of the largest
  Eigen::Index point{};           ///< that is hit
};

constexpr double hammer_rate = 2048.0;

/// ∫ e^(λ(t − τ)) sin(πτ/w) dτ from 0 to min(t, w).
std::complex<double> pushed(std::complex<double> pole, double t, double width);

data::Record hammer_record(const HammerTest& hammer, std::uint64_t seed);

/// Of measurements of one kind, each with these records.
test::ClassScore hammer_score(const std::vector<HammerTest>& hammers, int seeds);

}  // namespace hydrapod::identification
