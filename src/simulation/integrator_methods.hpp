#pragma once
/// What the integrators have in common. Private to Integrator.

#include <algorithm>
#include <string>

#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::simulation {

/// In one call, from one sample of the controller or of the record to the next. Oil and valves of
/// 600 rad/s take a few.
/// Steps of less than 50 ns in the mean make a run of seconds last for hours.
inline long most_steps(double interval) {
  constexpr double shortest = 5e-8;  // [s]
  return static_cast<long>(std::clamp(interval / shortest, 2e4, 1e6));
}
std::string too_many_steps(double step, double interval, long most);

/// The equation that a method solves; the input is constant during one call.
struct Problem {
  const Plant& plant;
  PlantInput input{};
  std::vector<EventRecord> records{};

  explicit Problem(const Plant& plant_) : plant(plant_) {}
};

/// How one call of MethodBase::advance() ended.
struct Step {
  enum class End { reached, event, failed };
  End end{End::reached};
  double time{};
  std::vector<int> directions{};  ///< per event function: −1 fell through zero, +1 rose, 0 neither
  std::string message{};          ///< of a failure
  Eigen::VectorXd attempted{};    ///< the state that failed, where it is known
};

/// Notices signs of event functions that changed from one step to the next.
class EventWatch {
 public:
  void start(const Plant& plant, const Eigen::VectorXd& x) {
    before_.assign(plant.event_count(), 0.0);
    now_ = before_;
    directions_.assign(plant.event_count(), 0);
    plant.events(x.data(), before_.data());
  }
  /// Whether something happens on the way to `x`.
  bool happens(const Plant& plant, const Eigen::VectorXd& x) {
    plant.events(x.data(), now_.data());
    bool any = false;
    for (size_t k = 0; k < now_.size(); ++k) {
      directions_[k] = (now_[k] > 0.0) - (before_[k] > 0.0);
      any = any || directions_[k] != 0;
    }
    return any;
  }
  /// The run goes there.
  void go_on() { before_.swap(now_); }
  bool happened(const Plant& plant, const Eigen::VectorXd& x) {
    const bool any = happens(plant, x);
    go_on();
    return any;
  }
  [[nodiscard]] const std::vector<int>& directions() const { return directions_; }

 private:
  std::vector<double> before_{}, now_{};
  std::vector<int> directions_{};
};

class MethodBase {
 public:
  virtual ~MethodBase() = default;
  virtual void start(double time, const Eigen::VectorXd& x) = 0;
  virtual void input_changed() = 0;
  /// From `time` towards `to`; `x` goes from the state at `time` to that at Step::time. On a
  /// failure x is the last good state.
  virtual Step advance(double time, double to, Eigen::VectorXd& x) = 0;
  [[nodiscard]] const IntegratorStatistics& statistics() const { return statistics_; }

 protected:
  IntegratorStatistics statistics_{};
};

std::unique_ptr<MethodBase> make_erk(const Problem& problem, const IntegratorOptions& options);
std::unique_ptr<MethodBase> make_cvode(const Problem& problem, const IntegratorOptions& options);
std::unique_ptr<MethodBase> make_exponential(const Problem& problem,
                                             const IntegratorOptions& options);
std::unique_ptr<MethodBase> make_fixed(const Problem& problem, const IntegratorOptions& options);

}  // namespace hydrapod::simulation
