#include "hydrapod/simulation/closed_loop.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "integrator_methods.hpp"

namespace hydrapod::simulation {

namespace {

std::unique_ptr<MethodBase> make_method(const Problem& problem, const IntegratorOptions& options) {
  switch (options.method) {
    case Method::adaptive:
      return make_erk(problem, options);
    case Method::cvode_adams:
    case Method::cvode_bdf:
      return make_cvode(problem, options);
    case Method::exponential:
      return make_exponential(problem, options);
    case Method::fixed:
      return make_fixed(problem, options);
  }
  throw std::invalid_argument("integrator: unknown method");
}

}  // namespace

std::string too_many_steps(double step, double interval, long most) {
  return fmt::format(
      "steps of {:.2g} s are too short for {:.2g} s between two samples: they would be {:.2g}, "
      "expected at most {}",
      step, interval, interval / step, most);
}

namespace {

void require(bool good, const char* what, double value, const char* expected) {
  if (!good)
    throw std::invalid_argument(
        fmt::format("integrator: {} is {:g}, expected {}", what, value, expected));
}

void check(const IntegratorOptions& options) {
  constexpr double tightest = 1e-15;
  require(options.relative_tolerance >= tightest && options.relative_tolerance < 1.0,
          "relative tolerance", options.relative_tolerance, "1e-15 to 1");
  require(options.absolute_tolerance >= tightest && std::isfinite(options.absolute_tolerance),
          "absolute tolerance", options.absolute_tolerance, "1e-15 or more");
  require(options.fixed_step > 0.0 && std::isfinite(options.fixed_step), "fixed step",
          options.fixed_step, "a time above 0 s");
  require(options.event_time > 0.0, "event time", options.event_time, "a time above 0 s");
  require(options.largest_step >= 0.0, "largest step", options.largest_step, "0 s (none) or more");
}

}  // namespace

const char* name(Method method) {
  switch (method) {
    case Method::adaptive:
      return "adaptive";
    case Method::cvode_adams:
      return "cvode-adams";
    case Method::cvode_bdf:
      return "cvode-bdf";
    case Method::exponential:
      return "exponential";
    case Method::fixed:
      return "fixed";
  }
  return "";
}

struct Integrator::Implementation : Problem {
  std::unique_ptr<MethodBase> method{};
  Eigen::VectorXd x{};
  double time{};

  Implementation(const Plant& plant_, const IntegratorOptions& options) : Problem(plant_) {
    check(options);
    method = make_method(*this, options);
    x.setZero(plant.layout().size);
  }

  /// Why the plant cannot be at `state`; empty when it can.
  [[nodiscard]] std::string fault(const Eigen::VectorXd& state) const {
    const auto names = plant.state_names();
    for (int k = 0; k < state.size(); ++k)
      if (!std::isfinite(state[k])) return names[k] + " is not finite";
    dynamics::Motion motion;
    plant.mechanics().motion(state.data(), state.data() + plant.layout().velocity(), motion);
    for (int i = 0; i < model::leg_count; ++i)
      if (!motion.legs[i].exists) return fmt::format("leg {} does not close", i + 1);
    Eigen::VectorXd rate(state.size());
    if (plant.derivative(time, state.data(), input, rate.data())) return {};
    for (int k = 0; k < rate.size(); ++k)
      if (!std::isfinite(rate[k])) return "the rate of " + names[k] + " is not finite";
    return "the state has no derivative";
  }

  /// The state whose rate is largest for its scale.
  [[nodiscard]] std::string fastest() const {
    Eigen::VectorXd rate(x.size());
    if (!plant.derivative(time, x.data(), input, rate.data())) return fault(x);
    Eigen::Index worst = 0;
    rate.cwiseQuotient(plant.scales()).cwiseAbs().maxCoeff(&worst);
    return plant.state_names()[worst];
  }

  [[noreturn]] void stop(const std::string& why) const {
    throw base::ComputationError(fmt::format("simulation stopped at {:.6g} s: {}", time, why));
  }

  /// Notes what happened; throws where the model ends.
  void note(double at, const std::vector<int>& directions) {
    for (int k = 0; k < static_cast<int>(directions.size()); ++k) {
      if (directions[k] == 0) continue;
      const int leg = k / Plant::events_per_leg;
      const auto event = static_cast<Plant::Event>(k % Plant::events_per_leg);
      records.push_back({at, leg, event, directions[k] < 0});
      if (event == Plant::Event::unguided && directions[k] < 0)
        stop(fmt::format("leg {}: the piston leaves the guide sleeve, where the model ends",
                         leg + 1));
    }
  }

  void advance(double to) {
    while (time < to) {
      const Step step = method->advance(time, to, x);
      if (step.end == Step::End::failed) {
        const std::string why = fault(step.attempted.size() > 0 ? step.attempted : x);
        stop(!why.empty() ? why : fmt::format("{} (fastest: {})", step.message, fastest()));
      }
      time = step.time;
      if (step.end == Step::End::event) note(time, step.directions);
    }
  }
};

Integrator::Integrator(const Plant& plant, const IntegratorOptions& options)
    : implementation_(std::make_unique<Implementation>(plant, options)) {}
Integrator::~Integrator() = default;
Integrator::Integrator(Integrator&&) noexcept = default;
Integrator& Integrator::operator=(Integrator&&) noexcept = default;

void Integrator::start(double time, const Eigen::VectorXd& x) {
  auto& self = *implementation_;
  if (x.size() != self.plant.layout().size)
    throw std::invalid_argument(fmt::format("integrator: the state has {} numbers, expected {}",
                                            x.size(), self.plant.layout().size));
  self.time = time;
  self.x = x;
  self.input = {};
  self.records.clear();
  self.method->start(time, x);
}

void Integrator::advance(double to, const PlantInput& input) {
  auto& self = *implementation_;
  if (!(to >= self.time))
    throw std::invalid_argument(
        fmt::format("integrator: cannot go from {:g} s back to {:g} s", self.time, to));
  if (!input.command.allFinite() || !input.wrench.allFinite())
    self.stop("a command or a wrench is not finite");
  if (!input.axial.allFinite()) self.stop("an axial force is not finite");
  const bool changed = input.command != self.input.command || input.wrench != self.input.wrench ||
                       input.axial != self.input.axial;
  self.input = input;
  if (changed) self.method->input_changed();
  self.advance(to);
}

double Integrator::time() const { return implementation_->time; }
const Eigen::VectorXd& Integrator::state() const { return implementation_->x; }
const IntegratorStatistics& Integrator::statistics() const {
  return implementation_->method->statistics();
}
const std::vector<EventRecord>& Integrator::events() const { return implementation_->records; }

}  // namespace hydrapod::simulation
