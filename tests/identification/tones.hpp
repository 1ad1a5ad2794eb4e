#pragma once
/// Vibrations of nearly constant frequency, as mains and pumps make them.

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "support/random.hpp"

namespace hydrapod::identification {

/// Phase of a tone whose frequency wanders by ±wander [Hz] within half a minute to minutes.
class WanderingPhase {
 public:
  WanderingPhase(double frequency, double wander, test::Random& random)
      : frequency_(frequency),
        wander_(wander),
        fast_(random.uniform(0.0, two_pi)),
        slow_(random.uniform(0.0, two_pi)),
        begin_(random.uniform(0.0, two_pi)) {}
  [[nodiscard]] double operator()(double t) const {
    constexpr double fast = 31.7, slow = 83.1;  // [s]
    const auto turned = [&](double period, double phase) {
      return 0.5 * wander_ * period * std::sin(two_pi * t / period + phase);
    };
    return begin_ + two_pi * frequency_ * t + turned(fast, fast_) + turned(slow, slow_);
  }

 private:
  static constexpr double two_pi = 2.0 * std::numbers::pi;
  double frequency_, wander_, fast_, slow_, begin_;
};

/// Amplitude whose power is `level` times that which white noise of this RMS has in one line of
/// blocks of `seconds` under Hann's window.
inline double tone_amplitude(double level, double rms, double sample_rate, double seconds) {
  constexpr double lines_of_hann = 1.5;
  const double density = 2.0 * rms * rms / sample_rate;
  return std::sqrt(2.0 * level * density * lines_of_hann / seconds);
}

/// In a loop of three axes.
struct LoopTone {
  double frequency{}, wander{};                           ///< [Hz]
  Eigen::Vector3d sensor{Eigen::Vector3d::Zero()};        ///< amplitude in y, which is fed back [m]
  Eigen::Vector3d force{Eigen::Vector3d::Zero()};         ///< in d [N]
  Eigen::Vector3d drive_sensor{Eigen::Vector3d::Zero()};  ///< in what is recorded of u [N]
};

}  // namespace hydrapod::identification
