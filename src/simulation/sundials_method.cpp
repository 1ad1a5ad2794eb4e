#include "sundials_method.hpp"

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"

namespace hydrapod::simulation {

namespace {

/// z = Σ c_k x_k; x_0 may be z. Stages of a step are summed so, a fifth of the time of a run with
/// SUNDIALS' own loop, which is compiled for any processor.
int linear_combination(int count, realtype* c, N_Vector* x, N_Vector z) {
  const auto vector = [](N_Vector v) {
    return Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(v), N_VGetLength(v));
  };
  auto sum = vector(z);
  sum = c[0] * vector(x[0]);
  int k = 1;
  for (; k + 1 < count; k += 2) sum += c[k] * vector(x[k]) + c[k + 1] * vector(x[k + 1]);
  if (k < count) sum += c[k] * vector(x[k]);
  return 0;
}

}  // namespace

SundialsMethod::SundialsMethod(const Problem& problem, const IntegratorOptions& options)
    : problem_(problem), options_(options), directions_(problem.plant.event_count(), 0) {
  require(SUNContext_Create(nullptr, &context_), "context");
  x_ = N_VNew_Serial(size(), context_);
  absolute_ = N_VNew_Serial(size(), context_);
  if (!x_ || !absolute_) throw std::bad_alloc();
  require(N_VEnableFusedOps_Serial(x_, 1), "fused operations");  // stages in one sweep
  x_->ops->nvlinearcombination = linear_combination;             // clones of x_ have it too
  Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(absolute_), size()) =
      options.absolute_tolerance * problem.plant.scales();
}

SundialsMethod::~SundialsMethod() {
  N_VDestroy(x_);
  N_VDestroy(absolute_);
  SUNContext_Free(&context_);
}

int SundialsMethod::rate(double t, N_Vector x, N_Vector rate, void* self) {
  auto& method = *static_cast<SundialsMethod*>(self);
  ++method.statistics_.evaluations;
  const bool good = method.problem_.plant.derivative(
      t, N_VGetArrayPointer(x), method.problem_.input, N_VGetArrayPointer(rate));
  return good ? 0 : 1;  // 1: try a smaller step
}

int SundialsMethod::roots(double /*t*/, N_Vector x, double* values, void* self) {
  static_cast<SundialsMethod*>(self)->problem_.plant.events(N_VGetArrayPointer(x), values);
  return 0;
}

void SundialsMethod::hear(int /*code*/, const char* /*module*/, const char* /*function*/,
                          char* message, void* self) {
  static_cast<SundialsMethod*>(self)->message_ = message;
}

void SundialsMethod::require(int code, const char* what) {
  if (code < 0)
    throw base::ComputationError(fmt::format("integrator: SUNDIALS refuses {} ({})", what, code));
}

Step SundialsMethod::failed(double time) const {
  std::string why = "the step became too small or failed too often";
  if (!message_.empty()) why += ": " + message_;
  return {.end = Step::End::failed, .time = time, .message = why};
}

}  // namespace hydrapod::simulation
