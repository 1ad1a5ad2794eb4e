#pragma once
/// Sensors of the virtual machine as a packet has them. Private to the module.

#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

class Readings {
 public:
  Readings(const simulation::ClosedLoop& loop, const std::vector<rig::Accelerometer>& list);
  /// The values of `sensors` at a sample; all others of it are kept.
  void read(const simulation::SampledMachine& machine, Sensors& sensors);

 private:
  struct Chain {
    rig::Accelerometer one{};
    rig::LowPass bandwidth{};
    numerics::Gaussian random{0};
    double noise{};  ///< RMS of a sample [m/s²]
  };
  const simulation::ClosedLoop& loop_;
  std::vector<Chain> chains_{};
  bool settled_{};
};

/// Whether the machine can be asked for this: legs within their stops, numbers of machines.
bool is_reachable(const simulation::ClosedLoop& loop, const Command& command);

}  // namespace hydrapod::realtime
