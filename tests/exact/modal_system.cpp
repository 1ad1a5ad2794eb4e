#include "exact/modal_system.hpp"
#include "hydrapod/base/units.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace hydrapod::test {

using Complex = std::complex<double>;
using Eigen::Index;

namespace {
using base::two_pi;
}

Eigen::MatrixXcd ModalSystem::response(double frequency) const {
  const Complex s(0.0, two_pi * frequency);
  Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(outputs(), inputs());
  for (const auto& m : modes) {
    const Eigen::MatrixXcd A = m.shape * m.participation.transpose();
    H += A / (s - m.pole) + A.conjugate() / (s - std::conj(m.pole));
  }
  return H;
}

Eigen::MatrixXcd ModalSystem::sampled_response(double frequency, double sample_time,
                                               double shift) const {
  const Complex z = std::exp(Complex(shift, two_pi * frequency) * sample_time);
  Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(outputs(), inputs());
  for (const auto& m : modes) {
    const Complex e = std::exp(m.pole * sample_time), gain = (e - 1.0) / m.pole;
    const Eigen::MatrixXcd A = gain * m.shape * m.participation.transpose();
    H += A / (z - e) + A.conjugate() / (z - std::conj(e));
  }
  return H;
}

ExactMode real_mode(double frequency, double damping_ratio, const Eigen::VectorXd& shape) {
  const double omega = two_pi * frequency;
  const double damped = omega * std::sqrt(1.0 - damping_ratio * damping_ratio);
  ExactMode mode;
  mode.pole = {-damping_ratio * omega, damped};
  mode.shape = shape.cast<Complex>() / Complex(0.0, 2.0 * damped);
  mode.participation = shape.cast<Complex>();
  return mode;
}

ModalSystem chain(int masses, double mass, double stiffness, double damping_ratio) {
  ModalSystem system;
  const double angle = std::numbers::pi / (masses + 1);
  for (int r = 1; r <= masses; ++r) {
    Eigen::VectorXd shape(masses);
    for (int j = 1; j <= masses; ++j)
      shape[j - 1] = std::sqrt(2.0 / (mass * (masses + 1))) * std::sin(j * r * angle);
    const double omega = 2.0 * std::sqrt(stiffness / mass) * std::sin(0.5 * r * angle);
    system.modes.push_back(real_mode(omega / two_pi, damping_ratio, shape));
  }
  return system;
}

ModalRun::ModalRun(const ModalSystem& system, double sample_time)
    : system_(system), sample_time_(sample_time) {
  const auto count = static_cast<int>(system.modes.size());
  state_ = Eigen::VectorXcd::Zero(count);
  decay_ = gain_ = state_;
  for (int r = 0; r < count; ++r) tune(r, 1.0);
}

void ModalRun::tune(int mode, double factor) {
  const Complex pole = factor * system_.modes[static_cast<size_t>(mode)].pole;
  decay_[mode] = std::exp(pole * sample_time_);
  gain_[mode] = (decay_[mode] - 1.0) / pole;
}

Eigen::VectorXd ModalRun::output() const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(system_.outputs());
  for (Index r = 0; r < state_.size(); ++r)
    y += 2.0 * (system_.modes[static_cast<size_t>(r)].shape * state_[r]).real();
  return y;
}

void ModalRun::advance(const Eigen::VectorXd& input) {
  for (Index r = 0; r < state_.size(); ++r) {
    const auto& L = system_.modes[static_cast<size_t>(r)].participation;
    Complex force = 0.0;
    for (Index i = 0; i < input.size(); ++i) force += L[i] * input[i];
    state_[r] = decay_[r] * state_[r] + gain_[r] * force;
  }
}

double normal(Random& random) {  // Box and Muller
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(two_pi * random.uniform());
}

data::RecordHeader header_of(Index inputs, Index outputs, double sample_rate) {
  data::RecordHeader header;
  header.sample_rate = sample_rate;
  for (Index i = 0; i < inputs; ++i)
    header.channels.push_back(
        {.name = fmt::format("u{}", i + 1), .unit = "N", .role = data::Role::excitation});
  for (Index o = 0; o < outputs; ++o)
    header.channels.push_back(
        {.name = fmt::format("y{}", o + 1), .unit = "m", .role = data::Role::response});
  return header;
}

data::Record record_of(const ModalSystem& system, const NoiseExperiment& experiment) {
  Random random(experiment.seed);
  const Index p = system.inputs(), q = system.outputs();
  data::Record record{.header = header_of(p, q, experiment.sample_rate), .samples = {}};
  record.samples.resize(experiment.samples, p + q);
  ModalRun run(system, 1.0 / experiment.sample_rate);
  Eigen::VectorXd u(p);
  for (int k = -experiment.settling; k < experiment.samples; ++k) {
    for (double& x : u) x = experiment.input_deviation * normal(random);
    if (k >= 0) {
      Eigen::VectorXd y = run.output();
      for (Index o = 0; o < experiment.output_noise.size(); ++o)
        y[o] += experiment.output_noise[o] * normal(random);
      record.samples.row(k) << u.transpose(), y.transpose();
    }
    run.advance(u);
  }
  return record;
}

}  // namespace hydrapod::test
