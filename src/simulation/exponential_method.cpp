#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "integrator_methods.hpp"
#include "spools.hpp"

namespace hydrapod::simulation {

namespace {

/// Dormand and Prince 5(4): J. R. Dormand, P. J. Prince, Journal of Computational and Applied
/// Mathematics 6 (1980) 19. The last stage is the result, and the first one of the next step.
constexpr std::size_t stages = 7;
constexpr std::array<double, stages> shares{0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
constexpr std::array<std::array<double, stages - 1>, stages> weights{{
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
}};
/// Result less that of order 4.
constexpr std::array<double, stages> error_weights{
    71.0 / 57600, 0.0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// Runge–Kutta for all but the spools, which are in closed form.
class ExponentialMethod : public MethodBase {
 public:
  ExponentialMethod(const Problem& problem, const IntegratorOptions& options)
      : problem_(problem),
        options_(options),
        spools_(problem.plant, {shares.begin(), shares.end()}),
        absolute_(options.absolute_tolerance * problem.plant.scales()) {
    for (auto* vector : {&y_, &error_, &weight_}) vector->setZero(absolute_.size());
    rates_.fill(y_);
    without_spools_.setOnes(absolute_.size());
    const auto& layout = problem.plant.layout();
    if (layout.spools >= 0) without_spools_.segment(layout.spools, 2 * model::leg_count).setZero();
  }

  void start(double /*time*/, const Eigen::VectorXd& x) override {
    statistics_ = {};
    step_ = 0.0;
    begun_ = false;
    tries_ = 0;
    watch_.start(problem_.plant, x);
  }
  /// Of the rates at the state now, the command changes those of the spools alone.
  void input_changed() override {
    const auto& input = problem_.input;
    begun_ = begun_ && input.wrench == wrench_ && input.axial == axial_;
    wrench_ = input.wrench;
    axial_ = input.axial;
  }

  Step advance(double time, double to, Eigen::VectorXd& x) override {
    if (tries_ == 0 || to != to_) {  // else it goes on after an event
      tries_ = 0;
      began_ = time;
      to_ = to;
    }
    while (time < to) {
      if (++tries_ > most_tries(to - began_)) return too_many(time);
      if (!begun_ && !(begun_ = rate(x, 0))) return failed(time, x, "there is no derivative");
      if (step_ == 0.0) step_ = first_step(x, to - time);
      const double parts = std::max(1.0, std::ceil((to - time) / allowed_step() * (1.0 - 1e-9)));
      const double h = (to - time) / parts;
      const double error = attempt(x, h);
      if (!(error <= 1.0)) {
        ++statistics_.rejected;
        if (!shorten(time, h, error)) return failed(time, y_, "the step became too small");
        continue;
      }
      const bool event = watch_.happens(problem_.plant, y_);
      if (event && h > options_.event_time) {  // a force has a kink there
        step_ = 0.5 * h;
        continue;
      }
      watch_.go_on();
      accept(h, parts == 1.0, error, x);
      time = parts == 1.0 ? to : time + h;
      if (event) return {.end = Step::End::event, .time = time, .directions = watch_.directions()};
    }
    return {.time = to};
  }

 private:
  static Step failed(double time, const Eigen::VectorXd& at, const char* why) {
    Step step{.end = Step::End::failed, .time = time, .message = why};
    step.attempted = at;
    return step;
  }
  [[nodiscard]] Step too_many(double time) const {
    const double mean = (time - began_) / static_cast<double>(tries_), interval = to_ - began_;
    return {.end = Step::End::failed,
            .time = time,
            .message = too_many_steps(mean, interval, most_tries(interval))};
  }
  /// The fastest machine that is let through at rest takes a step of 2 µs (stiffness.cpp), a
  /// quarter of these.
  static long most_tries(double interval) {
    constexpr long share = 10;
    return most_steps(interval) / share;
  }

  [[nodiscard]] double allowed_step() const {
    return options_.largest_step > 0.0 ? std::min(step_, options_.largest_step) : step_;
  }

  bool rate(const Eigen::VectorXd& x, std::size_t stage) {
    ++statistics_.evaluations;
    return problem_.plant.derivative(0.0, x.data(), problem_.input, rates_[stage].data());
  }

  /// Σ h by_k · rates of stage k.
  template <std::size_t... k>
  auto combined(double h, const auto& by, std::index_sequence<k...>) const {
    return (((h * by[k]) * rates_[k]) + ...);
  }

  /// False where it is no state.
  template <std::size_t stage>
  bool take_stage(const Eigen::VectorXd& x, double h) {
    y_ = x + combined(h, weights[stage], std::make_index_sequence<stage>());
    spools_.place(stage, y_.data());
    return rate(y_, stage);
  }

  /// In which no state changes by more than a hundredth of its scale.
  double first_step(const Eigen::VectorXd& x, double interval) {
    set_weights(x);
    const double fastest = scaled(rates_[0]);
    constexpr double share = 0.01;
    const double change = share / options_.absolute_tolerance;
    return fastest * interval > change ? change / fastest : interval;
  }

  void set_weights(const Eigen::VectorXd& x) {
    weight_ = without_spools_.cwiseQuotient(absolute_ + options_.relative_tolerance * x.cwiseAbs());
  }
  /// The largest of all states, 1 at the tolerance.
  [[nodiscard]] double scaled(const Eigen::VectorXd& error) const {
    return error.cwiseProduct(weight_).lpNorm<Eigen::Infinity>();
  }

  /// A step from `x` into y_; the error, infinite where a stage is no state.
  double attempt(const Eigen::VectorXd& x, double h) {
    spools_.begin(x.data(), problem_.input.command, h);
    const bool good = take_stage<1>(x, h) && take_stage<2>(x, h) && take_stage<3>(x, h) &&
                      take_stage<4>(x, h) && take_stage<5>(x, h) && take_stage<6>(x, h);
    if (!good) return std::numeric_limits<double>::infinity();
    error_ = combined(h, error_weights, std::make_index_sequence<stages>());
    set_weights(x);
    return scaled(error_);
  }

  /// What the error suggests for the next step, as a factor.
  static double change(double error) {
    constexpr double safety = 0.9, order = 5.0, smallest = 0.2, largest = 5.0;
    return std::clamp(safety * std::pow(std::max(error, 1e-10), -1.0 / order), smallest, largest);
  }

  /// False where the time does not move any more.
  bool shorten(double time, double h, double error) {
    constexpr double at_most = 0.9, smallest_share = 16.0 * 2.2e-16;
    step_ = h * std::min(at_most, std::isfinite(error) ? change(error) : 0.2);
    return step_ > smallest_share * std::max(std::abs(time), step_);
  }

  void accept(double h, bool last, double error, Eigen::VectorXd& x) {
    ++statistics_.steps;
    x.swap(y_);
    rates_.front().swap(rates_.back());
    // The end of the call may have cut the step so short that it says little.
    const double factor = change(error);
    step_ = last && factor > 1.0 ? std::max(step_, h * factor) : h * factor;
  }

  const Problem& problem_;
  IntegratorOptions options_;
  Spools spools_;
  Eigen::VectorXd absolute_{}, weight_{}, without_spools_{}, y_{}, error_{};
  std::array<Eigen::VectorXd, stages> rates_{};
  double step_{};
  long tries_{};           ///< between two samples, in all calls up to the next event
  double began_{}, to_{};  ///< these two samples
  bool begun_{};           ///< the first of the rates are those of the state now
  Vector6 wrench_{Vector6::Zero()}, axial_{Vector6::Zero()};
  EventWatch watch_{};
};

}  // namespace

std::unique_ptr<MethodBase> make_exponential(const Problem& problem,
                                             const IntegratorOptions& options) {
  return std::make_unique<ExponentialMethod>(problem, options);
}

}  // namespace hydrapod::simulation
