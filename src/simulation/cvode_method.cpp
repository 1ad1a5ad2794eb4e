#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <new>

#include "sundials_method.hpp"

namespace hydrapod::simulation {

namespace {

/// CVODE: Adams with fixed-point iteration, or BDF with Newton and a dense Jacobian by differences.
class CvodeMethod : public SundialsMethod {
 public:
  CvodeMethod(const Problem& problem, const IntegratorOptions& options)
      : SundialsMethod(problem, options), stiff_(options.method == Method::cvode_bdf) {
    memory_ = CVodeCreate(stiff_ ? CV_BDF : CV_ADAMS, context_);
    if (!memory_) throw std::bad_alloc();
    require(CVodeSetErrHandlerFn(memory_, hear, this), "error handler");
    require(CVodeSetUserData(memory_, this), "user data");
    require(CVodeInit(memory_, rate, 0.0, x_), "start");
    require(CVodeSVtolerances(memory_, options.relative_tolerance, absolute_), "tolerances");
    if (options.largest_step > 0.0)
      require(CVodeSetMaxStep(memory_, options.largest_step), "largest step");
    if (stiff_) {
      matrix_ = SUNDenseMatrix(size(), size(), context_);
      solver_ = SUNLinSol_Dense(x_, matrix_, context_);
      require(CVodeSetLinearSolver(memory_, solver_, matrix_), "linear solver");
    } else {
      fixed_point_ = SUNNonlinSol_FixedPoint(x_, 0, context_);
      require(CVodeSetNonlinearSolver(memory_, fixed_point_), "nonlinear solver");
    }
    require(CVodeRootInit(memory_, roots_count(), roots), "events");
    require(CVodeSetNoInactiveRootWarn(memory_), "events");
  }
  CvodeMethod(const CvodeMethod&) = delete;
  CvodeMethod& operator=(const CvodeMethod&) = delete;
  ~CvodeMethod() override {
    CVodeFree(&memory_);
    if (solver_) SUNLinSolFree(solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    if (fixed_point_) SUNNonlinSolFree(fixed_point_);
  }

  void start(double time, const Eigen::VectorXd& x) override {
    state() = x;
    statistics_ = {};
    before_ = {};
    require(CVodeReInit(memory_, time, x_), "start");
  }
  void input_changed() override { changed_ = true; }

  Step advance(double time, double to, Eigen::VectorXd& x) override {
    if (changed_) {
      before_ = statistics_;
      require(CVodeReInit(memory_, time, x_), "restart");
      changed_ = false;
    }
    require(CVodeSetStopTime(memory_, to), "stop time");
    require(CVodeSetMaxNumSteps(memory_, most_steps(to - time)), "number of steps");
    double reached = time;
    const int code = CVode(memory_, to, x_, &reached, CV_NORMAL);
    count();
    if (code < 0) {
      state() = x;
      return failed(time);
    }
    x = state();
    if (code != CV_ROOT_RETURN) return {.time = reached};
    require(CVodeGetRootInfo(memory_, directions_.data()), "events");
    changed_ = true;  // the force has a kink here
    return {.end = Step::End::event, .time = reached, .directions = directions_};
  }

 private:
  void count() {
    long steps = 0, rejected = 0, jacobians = 0;
    require(CVodeGetNumSteps(memory_, &steps), "statistics");
    require(CVodeGetNumErrTestFails(memory_, &rejected), "statistics");
    if (stiff_) require(CVodeGetNumJacEvals(memory_, &jacobians), "statistics");
    statistics_.steps = before_.steps + steps;
    statistics_.rejected = before_.rejected + rejected;
    statistics_.jacobians = before_.jacobians + jacobians;
  }

  bool stiff_;
  void* memory_{};
  SUNMatrix matrix_{};
  SUNLinearSolver solver_{};
  SUNNonlinearSolver fixed_point_{};
  bool changed_{};
  IntegratorStatistics before_{};
};

}  // namespace

std::unique_ptr<MethodBase> make_cvode(const Problem& problem, const IntegratorOptions& options) {
  return std::make_unique<CvodeMethod>(problem, options);
}

}  // namespace hydrapod::simulation
