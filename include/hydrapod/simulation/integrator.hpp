#pragma once
/// Time integration of a Plant with inputs that are held between calls.
///
///     Integrator run(plant, {.method = Method::adaptive});
///     run.start(0.0, plant.equilibrium(pose).x);
///     for (int k = 1; k <= 1000; ++k) run.advance(1e-3 * k, input);
///
/// Local errors are kept below  relative_tolerance |x_i| + absolute_tolerance · scale_i  with
/// Plant::scales(), in the weighted root mean square. Methods:
/// - adaptive: one-step, explicit, embedded Runge–Kutta of order 5(4) (ARKODE's ERKStep, Dormand
/// and
///   Prince). Starts again at no cost after every change of the input; the default.
///   Events are noticed at the end of a step.
/// - cvode_adams, cvode_bdf: CVODE's multistep methods; for long stretches of constant input, BDF
///   with a dense Jacobian by differences where something is stiff. They find events to rounding
///   and start again there.
/// - fixed: classical Runge–Kutta of order 4 with a fixed step, no allocation, the same work in
/// every
///   call: for real time.

#include <memory>
#include <vector>

#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

enum class Method { adaptive, cvode_adams, cvode_bdf, fixed };
const char* name(Method method);

struct IntegratorOptions {
  Method method{Method::adaptive};
  double relative_tolerance{1e-5};
  double absolute_tolerance{1e-5};  ///< of Plant::scales()
  double fixed_step{1e-4};          ///< [s], `fixed` only; calls are divided into equal steps
  double largest_step{0.0};         ///< [s]; 0: none
};

struct IntegratorStatistics {
  long steps{};
  long evaluations{};  ///< of the right-hand side, those for Jacobians included
  long rejected{};     ///< steps that failed the error test
  long jacobians{};
};

/// Something that happened; `begins`: the event's function turned negative (touched, cavitates).
struct EventRecord {
  double time{};
  int leg{};  ///< from 0
  Plant::Event event{};
  bool begins{};
};

class Integrator {
 public:
  /// The plant must outlive the integrator.
  Integrator(const Plant& plant, const IntegratorOptions& options = {});
  ~Integrator();
  Integrator(Integrator&&) noexcept;
  Integrator& operator=(Integrator&&) noexcept;

  void start(double time, const Eigen::VectorXd& x);
  /// Integrates to `to` ≥ time() with constant input. Throws base::ComputationError that names the
  /// time and the part when it cannot go on (a piston leaves its guide sleeve, a leg does not
  /// close, a value is not finite, the step becomes too small); time() and state() are then the
  /// last good ones.
  void advance(double to, const PlantInput& input);

  [[nodiscard]] double time() const;
  [[nodiscard]] const Eigen::VectorXd& state() const;
  [[nodiscard]] const IntegratorStatistics& statistics() const;
  /// Events since the start, in order; by `adaptive` and `fixed` noticed at the end of the step, by
  /// CVODE located.
  [[nodiscard]] const std::vector<EventRecord>& events() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hydrapod::simulation
