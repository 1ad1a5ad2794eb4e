#include <arkode/arkode_erkstep.h>

#include <algorithm>
#include <new>

#include "sundials_method.hpp"

namespace hydrapod::simulation {

namespace {

/// ARKODE's ERKStep: Dormand and Prince 5(4).
class ErkMethod : public SundialsMethod {
 public:
  ErkMethod(const Problem& problem, const IntegratorOptions& options)
      : SundialsMethod(problem, options) {
    memory_ = ERKStepCreate(rate, 0.0, x_, context_);
    if (!memory_) throw std::bad_alloc();
    require(ERKStepSetErrHandlerFn(memory_, hear, this), "error handler");
    require(ERKStepSetUserData(memory_, this), "user data");
    require(ERKStepSetTableNum(memory_, ARKODE_DORMAND_PRINCE_7_4_5), "table");
    require(ERKStepSVtolerances(memory_, options.relative_tolerance, absolute_), "tolerances");
    if (options.largest_step > 0.0)
      require(ERKStepSetMaxStep(memory_, options.largest_step), "largest step");
  }
  ErkMethod(const ErkMethod&) = delete;
  ErkMethod& operator=(const ErkMethod&) = delete;
  ~ErkMethod() override { ERKStepFree(&memory_); }

  void start(double time, const Eigen::VectorXd& x) override {
    state() = x;
    statistics_ = {};
    steps_before_ = rejected_before_ = 0;
    step_ = 0.0;
    require(ERKStepReInit(memory_, rate, time, x_), "start");
    require(ERKStepSetInitStep(memory_, 0.0), "step");
    watch_.start(problem_.plant, x);
    count(steps_before_, rejected_before_);
  }
  void input_changed() override { changed_ = true; }

  Step advance(double time, double to, Eigen::VectorXd& x) override {
    if (changed_) {
      require(ERKStepReset(memory_, time, x_), "restart");
      if (step_ > 0.0) require(ERKStepSetInitStep(memory_, std::min(step_, to - time)), "step");
      changed_ = false;
    }
    require(ERKStepSetStopTime(memory_, to), "stop time");
    double reached = time;
    bool event = false;
    long steps = 0;
    while (reached < to && !event) {
      const double before = reached;
      if (++steps > most_steps(to - time)) {
        note_counts();
        return {.end = Step::End::failed,
                .time = reached,
                .message = too_many_steps((reached - time) / static_cast<double>(steps), to - time,
                                          most_steps(to - time))};
      }
      const int code = ERKStepEvolve(memory_, to, x_, &reached, ARK_ONE_STEP);
      if (code < 0) {
        note_counts();
        state() = x;
        changed_ = true;
        return failed(before);
      }
      x = state();
      event = watch_.happened(problem_.plant, x);
    }
    note_counts();
    remember_step(to - time);
    if (!event) return {.time = reached};
    return {.end = Step::End::event, .time = reached, .directions = watch_.directions()};
  }

 private:
  void count(long& steps, long& rejected) {
    require(ERKStepGetNumSteps(memory_, &steps), "statistics");
    require(ERKStepGetNumErrTestFails(memory_, &rejected), "statistics");
  }

  void note_counts() {
    long steps = 0, rejected = 0;
    count(steps, rejected);
    statistics_.steps = steps - steps_before_;
    statistics_.rejected = rejected - rejected_before_;
  }

  /// The step to begin with after the next change of the input: what the error of the last one
  /// allows, unless that was cut so short by the end of the call that it says little.
  void remember_step(double interval) {
    constexpr double short_share = 0.1;
    double last = 0.0, next = 0.0;
    require(ERKStepGetLastStep(memory_, &last), "statistics");
    require(ERKStepGetCurrentStep(memory_, &next), "statistics");
    step_ = last > short_share * interval ? next : std::max(next, step_);
  }

  void* memory_{};
  bool changed_{};
  double step_{};
  long steps_before_{}, rejected_before_{};
  EventWatch watch_{};
};

}  // namespace

std::unique_ptr<MethodBase> make_erk(const Problem& problem, const IntegratorOptions& options) {
  return std::make_unique<ErkMethod>(problem, options);
}

}  // namespace hydrapod::simulation
