#include <algorithm>
#include <array>
#include <cmath>

#include "integrator_methods.hpp"
#include "spools.hpp"

namespace hydrapod::simulation {

namespace {

/// Classical Runge–Kutta of order 4 for all but the spools, which are in closed form.
class FixedStep : public MethodBase {
 public:
  FixedStep(const Problem& problem, const IntegratorOptions& options)
      : problem_(problem), step_(options.fixed_step), spools_(problem.plant, {middle, end}) {
    const int n = problem.plant.layout().size;
    for (auto* vector : {&k_[0], &k_[1], &k_[2], &k_[3], &at_}) vector->setZero(n);
  }

  void start(double /*time*/, const Eigen::VectorXd& x) override {
    statistics_ = {};
    watch_.start(problem_.plant, x);
  }
  void input_changed() override {}

  Step advance(double time, double to, Eigen::VectorXd& x) override {
    const double steps = std::max(1.0, std::ceil((to - time) / step_ * (1.0 - 1e-9)));
    if (steps > static_cast<double>(most_steps(to - time)))
      return {.end = Step::End::failed,
              .time = time,
              .message = too_many_steps(step_, to - time, most_steps(to - time))};
    const double h = (to - time) / steps;
    for (double k = 0.0; k < steps; ++k) {
      const double t = time + k * h;
      if (!step(t, h, x)) {
        Step failed{.end = Step::End::failed, .time = t, .message = "a step failed"};
        failed.attempted = at_;
        return failed;
      }
      const double reached = k + 1.0 == steps ? to : t + h;
      if (watch_.happened(problem_.plant, x))
        return {.end = Step::End::event, .time = reached, .directions = watch_.directions()};
    }
    return {.time = to};
  }

 private:
  bool rate(double t, const Eigen::VectorXd& x, Eigen::VectorXd& k) {
    ++statistics_.evaluations;
    return problem_.plant.derivative(t, x.data(), problem_.input, k.data());
  }

  bool step(double t, double h, Eigen::VectorXd& x) {
    auto& [k1, k2, k3, k4] = k_;
    at_ = x;
    spools_.begin(x.data(), problem_.input.command, h);
    if (!rate(t, at_, k1)) return false;
    at_ = x + 0.5 * h * k1;
    spools_.place(0, at_.data());
    if (!rate(t + 0.5 * h, at_, k2)) return false;
    at_ = x + 0.5 * h * k2;
    spools_.place(0, at_.data());
    if (!rate(t + 0.5 * h, at_, k3)) return false;
    at_ = x + h * k3;
    spools_.place(1, at_.data());
    if (!rate(t + h, at_, k4)) return false;
    x += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    spools_.place(1, x.data());
    ++statistics_.steps;
    return true;
  }

  static constexpr double middle = 0.5, end = 1.0;  // of a step

  const Problem& problem_;
  double step_;
  Spools spools_;
  std::array<Eigen::VectorXd, 4> k_{};
  Eigen::VectorXd at_{};
  EventWatch watch_{};
};

}  // namespace

std::unique_ptr<MethodBase> make_fixed(const Problem& problem, const IntegratorOptions& options) {
  return std::make_unique<FixedStep>(problem, options);
}

}  // namespace hydrapod::simulation
