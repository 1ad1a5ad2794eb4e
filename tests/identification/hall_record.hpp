#pragma once
/// Records of a machine in a hall with mains hum and a pump, forces measured. Shared by the short
/// and the long test.

#include <array>
#include <cmath>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"
#include "measured_records.hpp"
#include "tones.hpp"

namespace hydrapod::identification {

/// Four masses between springs with modes at 34.1 Hz, 49.7 Hz (0.6 % below the mains), 71.6 Hz and
/// 93.3 Hz; three forces.
test::ModalSystem hall_plant();

constexpr double hall_band = 130.0;  // [Hz] that modes are looked for in

struct HallRecord {
  double level{};        ///< of each tone by the noise of an output, in one line of 2 s
  double input_level{};  ///< the same by the excitation
  double wander{};       ///< [Hz] of the mains
  double noise{0.03};    ///< of sensors, by the RMS of the channel
  double duration{80.0};
  double sample_rate{1200.0};
  std::uint64_t seed{1};
};

struct Hall {
  data::Record record{};
  Eigen::MatrixXd amplitude{};  ///< of 50 Hz, 71.19 Hz and 100 Hz, in each channel
};

/// Noise forces; mains hum of 50 and 100 Hz in force sensors and outputs, the ripple of nine
/// pistons at 71.19 Hz in the outputs.
Hall hall_record(const test::ModalSystem& plant, const HallRecord& e);

}  // namespace hydrapod::identification
