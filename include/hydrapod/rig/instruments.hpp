#pragma once
/// What a test rig measures with, and how that falsifies.
///
/// The chain of every measured channel: quantity → sensor's bandwidth (accelerometers) → noise →
/// anti-alias filter → range and resolution → drop-outs. Filters run at the simulation's output
/// rate, the record's rate times `oversampling`; the record takes every n-th of their samples.
/// Excitations are known and recorded as they are.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::rig {

using model::Vector3;

/// One axis of an accelerometer on the platform. It shows e·(a − g) less its value at rest, e and
/// the place turning with the platform: a piezoelectric one, which feels gravity when it tilts.
struct Accelerometer {
  std::string name{};
  Vector3 p_P{Vector3::Zero()};   ///< place in P [m]
  Vector3 e_P{Vector3::UnitX()};  ///< direction in P, unit
  data::Direction direction{data::Direction::x};
  int point{};                               ///< number of the place
  double noise_density{1e-3};                ///< [m/s²/√Hz], white
  double bandwidth{5000.0};                  ///< [Hz] of a second-order low pass, ζ = 0.7; 0: none
  model::Sensor sensor{.resolution = 1e-3};  ///< its `noise` is added to that of the density
};

struct Instruments {
  model::Sensor length{.resolution = 5e-6, .noise = 2e-6};   ///< leg lengths [m]
  model::Sensor pressure{.resolution = 2e3, .noise = 5e3};   ///< chambers [Pa]
  model::Sensor current{.resolution = 1e-4, .noise = 1e-4};  ///< valves, share of the rated current
  std::vector<Accelerometer> accelerometers{};
  bool anti_alias{true};       ///< Butterworth of order 8, −3 dB at 0.4 of the record's rate
  double drop_outs{};          ///< per second and channel
  double drop_out_time{0.02};  ///< [s] of each
};

/// Three axes at the platform joints of legs 1, 3 and 5: enough for six directions.
std::vector<Accelerometer> default_accelerometers(const model::Machine& machine);

/// "resolution=5 um, noise=2 um, low=0.8 m, high=1.2 m" in `unit`. Throws base::InputError with
/// `argument` as place.
model::Sensor parse_sensor(const std::string& argument, const std::string& text, const char* unit);

/// "front, at=0.3 0 0.1, along=z, noise=0.001, bandwidth=5 kHz, range=50, resolution=0.001".
Accelerometer parse_accelerometer(const std::string& text);

/// Low-pass sections of order two, by the bilinear transform with the corner kept in place.
class LowPass {
 public:
  /// Butterworth of even `order`, −3 dB at `corner` [Hz] < rate/2.
  static LowPass butterworth(int order, double corner, double rate);
  /// Order 2 with damping ratio `zeta`; passes everything where the corner is not below rate/2.
  static LowPass second_order(double corner, double zeta, double rate);

  double operator()(double value);
  /// As if `value` had been there for ever.
  void settle(double value);

 private:
  struct Section {
    double b{}, a1{}, a2{};  ///< y = b (x + 2x₁ + x₂) − a1 y₁ − a2 y₂
    double s1{}, s2{};
  };
  void add(double corner, double zeta, double rate);
  std::vector<Section> sections_{};
};

}  // namespace hydrapod::rig
