#pragma once
/// What ARKODE's and CVODE's methods share: context, vectors, callbacks, messages. Private to
/// Integrator.

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include "integrator_methods.hpp"

namespace hydrapod::simulation {

class SundialsMethod : public MethodBase {
 public:
  SundialsMethod(const Problem& problem, const IntegratorOptions& options);
  SundialsMethod(const SundialsMethod&) = delete;
  SundialsMethod& operator=(const SundialsMethod&) = delete;
  ~SundialsMethod() override;

  /// Callbacks; `self` is this object.
  static int rate(double t, N_Vector x, N_Vector rate, void* self);
  static int roots(double t, N_Vector x, double* values, void* self);
  static void hear(int code, const char* module, const char* function, char* message, void* self);

 protected:
  [[nodiscard]] int size() const { return problem_.plant.layout().size; }
  [[nodiscard]] int roots_count() const { return problem_.plant.event_count(); }
  [[nodiscard]] Eigen::Map<Eigen::VectorXd> state() { return {N_VGetArrayPointer(x_), size()}; }
  /// Throws base::ComputationError for what cannot happen but to a wrong call.
  static void require(int code, const char* what);
  [[nodiscard]] Step failed(double time) const;

  const Problem& problem_;
  IntegratorOptions options_;
  SUNContext context_{};
  N_Vector x_{}, absolute_{};
  std::vector<int> directions_{};
  std::string message_{};  ///< the library's last one
};

}  // namespace hydrapod::simulation
