#pragma once
/// What watches a real machine while it is excited. Private to the module.

#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

class Guard {
 public:
  Guard(const model::Machine& machine, const Pose& operating, const Limits& limits,
        double sample_time, std::size_t accelerometers);

  /// One sample of the sensors under the command that acts; empty, or which limit was passed in
  /// this sample and in the one before it, with leg and numbers.
  std::string see(const Sensors& sensors, const Vector6& displacement);

  /// A command that is about to be sent; empty, or the leg that would go too far.
  [[nodiscard]] std::string commanded(const Vector6& displacement) const;

  /// How far the legs are from where the pose needs them, before anything moves; empty: near
  /// enough.
  [[nodiscard]] std::string at_pose(const Sensors& sensors) const;

 private:
  [[nodiscard]] std::string judge(const Sensors& sensors, const Vector6& displacement);

  const model::Machine& machine_;
  const Pose& operating_;
  Limits limits_;
  double T_;
  std::size_t accelerometers_;
  Vector6 rest_;  ///< leg lengths at the pose
  std::vector<rig::LowPass> speed_, acceleration_;
  Vector6 last_length_{Vector6::Zero()}, last_speed_{Vector6::Zero()};
  int seen_{};
  bool passed_{};  ///< a limit, in the last sample
};

}  // namespace hydrapod::realtime
