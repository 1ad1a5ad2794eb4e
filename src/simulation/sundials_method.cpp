#include "sundials_method.hpp"

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"

namespace hydrapod::simulation {

SundialsMethod::SundialsMethod(const Problem& problem, const IntegratorOptions& options)
    : problem_(problem), options_(options), directions_(problem.plant.event_count(), 0) {
  require(SUNContext_Create(nullptr, &context_), "context");
  x_ = N_VNew_Serial(size(), context_);
  absolute_ = N_VNew_Serial(size(), context_);
  if (!x_ || !absolute_) throw std::bad_alloc();
  require(N_VEnableFusedOps_Serial(x_, 1), "fused operations");  // stages in one sweep
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
