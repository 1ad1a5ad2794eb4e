#include "foreign_loop.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace hydrapod::identification {

test::ModalSystem masses_and_springs(const Eigen::Matrix3d& M, const Eigen::Matrix3d& D,
                                     const Eigen::Matrix3d& K) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A.topRightCorner<3, 3>().setIdentity();
  A.bottomLeftCorner<3, 3>() = -M.inverse() * K;
  A.bottomRightCorner<3, 3>() = -M.inverse() * D;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  const Eigen::MatrixXcd V = solver.eigenvectors(), W = V.inverse();
  const Eigen::Matrix3d flexibility = M.inverse();
  test::ModalSystem system;
  for (Eigen::Index r = 0; r < 6; ++r)
    if (solver.eigenvalues()[r].imag() > 0.0)
      system.modes.push_back(
          {.pole = solver.eigenvalues()[r],
           .shape = V.col(r).head(3),
           .participation =
               (W.row(r).tail(3) * flexibility.cast<std::complex<double>>()).transpose()});
  std::ranges::sort(system.modes, {}, [](const auto& m) { return std::abs(m.pole); });
  return system;
}

test::ModalSystem foreign_plant() {
  const Eigen::Matrix3d M = Eigen::Vector3d(2.31, 1.67, 3.13).asDiagonal();
  Eigen::Matrix3d K, D;
  K << 5270.0, -2210.0, 0.0, -2210.0, 8130.0, -3950.0, 0.0, -3950.0, 7410.0;
  D << 6.1, -2.3, 0.0, -2.3, 7.7, -3.1, 0.0, -3.1, 4.6;
  return masses_and_springs(M, D, K);
}

ForeignLoop loop_with_tones(double level, double wander, ForeignLoop e) {
  const double y = tone_amplitude(level, e.sensors, foreign_rate, 16.0),
               d = tone_amplitude(level, e.forces, foreign_rate, 16.0);
  e.tones = {{.frequency = 50.0,
              .wander = wander,
              .sensor = {y, 0.7 * y, -0.4 * y},
              .drive_sensor = {d, 0.3 * d, 0.6 * d}},
             {.frequency = 100.0, .wander = wander, .sensor = {0.3 * y, -0.7 * y, 0.5 * y}},
             {.frequency = 9.0 * 0.8556, .force = {d, -0.6 * d, 0.8 * d}}};
  return e;
}

Eigen::VectorXd noise_in_band(Eigen::Index samples, double from, double to, test::Random& random) {
  constexpr double pi = std::numbers::pi;
  const Eigen::Index half = 500, taps = 2 * half + 1;
  Eigen::VectorXd filter(taps);
  for (Eigen::Index t = -half; t <= half; ++t) {
    const auto sinc = [&](double f) {
      const double x = 2.0 * f / foreign_rate;
      return t == 0 ? x : std::sin(pi * x * static_cast<double>(t)) / (pi * static_cast<double>(t));
    };
    const double at = pi * static_cast<double>(t) / static_cast<double>(half);
    filter[t + half] =
        (sinc(to) - sinc(from)) * (0.42 + 0.5 * std::cos(at) + 0.08 * std::cos(2.0 * at));
  }
  filter /= filter.norm();
  Eigen::VectorXd white(samples + taps), x(samples);
  for (double& w : white) w = test::normal(random);
  for (Eigen::Index k = 0; k < samples; ++k) x[k] = filter.dot(white.segment(k, taps));
  return x;
}

Eigen::VectorXd sweep(Eigen::Index samples, Eigen::Index axis, double from, double to) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(samples);
  const double T = static_cast<double>(samples) / foreign_rate / 3.0,
               rate = std::log(to / from) / T;
  for (Eigen::Index k = axis * (samples / 3); k < (axis + 1) * (samples / 3); ++k) {
    const double t = static_cast<double>(k - axis * (samples / 3)) / foreign_rate;
    const double round = std::min({1.0, t / 1.5, (T - t) / 1.5});
    x[k] = std::numbers::sqrt2 * std::sin(0.5 * std::numbers::pi * std::max(0.0, round)) *
           std::sin(2.0 * std::numbers::pi * from * std::expm1(rate * t) / rate);
  }
  return x;
}

Eigen::VectorXd multisine(Eigen::Index samples, Eigen::Index axis, int experiment,
                          const ForeignLoop& e) {
  constexpr double two_pi = 2.0 * std::numbers::pi;
  test::Random random(977 * e.seed + static_cast<std::uint64_t>(axis));
  const auto period = static_cast<Eigen::Index>(std::llround(foreign_period * foreign_rate));
  Eigen::VectorXd once = Eigen::VectorXd::Zero(period), x(samples);
  for (int line = 1; line / foreign_period <= e.to; ++line) {
    const double phase = random.uniform(0.0, two_pi) +
                         two_pi / 3.0 * static_cast<double>(axis) * static_cast<double>(experiment);
    if (line / foreign_period < e.from) continue;
    for (Eigen::Index k = 0; k < period; ++k)
      once[k] +=
          std::cos(two_pi * line * static_cast<double>(k) / static_cast<double>(period) + phase);
  }
  once *= std::sqrt(static_cast<double>(period)) / once.norm();
  for (Eigen::Index k = 0; k < samples; ++k) x[k] = once[k % period];
  return x;
}

Eigen::MatrixXd excitation_of(const ForeignLoop& e, Eigen::Index samples, int experiment,
                              test::Random& random) {
  Eigen::MatrixXd r(samples, 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    switch (e.excitation) {
      case Excitation::white:
        for (Eigen::Index k = 0; k < samples; ++k) r(k, i) = test::normal(random);
        break;
      case Excitation::noise:
      case Excitation::drive:
        r.col(i) = noise_in_band(samples, e.from, e.to, random);
        break;
      case Excitation::sweep:
        r.col(i) = sweep(samples, i, e.from, e.to);
        break;
      case Excitation::multisine:
        r.col(i) = multisine(samples, i, experiment, e);
    }
  }
  return e.level * r;
}

data::Record foreign_loop_record(const test::ModalSystem& plant, const ForeignLoop& e,
                                 int experiment) {
  constexpr int delay = 2, settling = 2048;
  data::Record record;
  record.header.sample_rate = foreign_rate;
  const auto add = [&](const char* name, const char* unit, data::Role role) {
    for (int i = 1; i <= 3; ++i)
      record.header.channels.push_back(
          {.name = name + std::to_string(i), .unit = unit, .role = role});
  };
  add("r", "m", data::Role::excitation);
  add("y", "m", data::Role::response);
  add("u", "N", data::Role::drive);
  test::Random random(7919 * e.seed + static_cast<std::uint64_t>(experiment));
  const auto samples = static_cast<Eigen::Index>(e.duration * foreign_rate);
  // a sweep begins and ends at rest within the record; all other signals run before
  const Eigen::Index before = e.excitation == Excitation::sweep ? 0 : settling;
  const Eigen::MatrixXd r = excitation_of(e, samples + before, experiment, random);
  record.samples.resize(samples, 9);
  const bool at_drive = e.excitation == Excitation::drive;
  const double T = 1.0 / foreign_rate;
  const Eigen::Vector3d P(910.0, 640.0, 1130.0), I(2300.0, 3100.0, 1700.0), V(11.0, 17.0, 13.0);
  test::ModalRun run(plant, T);
  std::vector<WanderingPhase> phases;
  for (const auto& tone : e.tones) phases.emplace_back(tone.frequency, tone.wander, random);
  std::vector<Eigen::Vector3d> measured(delay + 1, Eigen::Vector3d::Zero());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), last = sum;
  for (Eigen::Index k = 0; k < samples + before; ++k) {
    Eigen::Vector3d y = run.output(), forces;
    for (double& x : y) x += e.sensors * test::normal(random);
    for (double& x : forces) x = e.forces * test::normal(random);
    Eigen::Vector3d hum = Eigen::Vector3d::Zero();
    for (std::size_t n = 0; n < e.tones.size(); ++n) {
      const double wave = std::sin(phases[n](T * static_cast<double>(k)));
      y += wave * e.tones[n].sensor;
      forces += wave * e.tones[n].force;
      hum += wave * e.tones[n].drive_sensor;
    }
    std::rotate(measured.begin(), measured.end() - 1, measured.end());
    measured[0] = y;
    const Eigen::Vector3d wanted = r.row(k).transpose();
    Eigen::Vector3d error = -measured[delay];
    if (!at_drive) error += wanted;
    sum += T * error;
    Eigen::Vector3d u =
        P.cwiseProduct(error) + e.integral * I.cwiseProduct(sum) + V.cwiseProduct(error - last) / T;
    if (at_drive) u += 900.0 * wanted;
    last = error;
    if (k >= before)
      record.samples.row(k - before) << wanted.transpose(), y.transpose(), (u + hum).transpose();
    if (e.drifting >= 0) {
      const auto past = static_cast<double>(std::max<Eigen::Index>(0, k - before));
      run.tune(e.drifting, 1.0 + e.drift * (past / static_cast<double>(samples) - 0.5));
    }
    run.advance(u + forces);
  }
  return record;
}

Measurement foreign_measurement(const test::ModalSystem& plant, const ForeignLoop& e) {
  std::vector<data::Record> records;
  const int experiments = e.excitation == Excitation::multisine ? 3 : 1;
  auto one = e;
  one.duration /= experiments;
  for (int k = 0; k < experiments; ++k) records.push_back(foreign_loop_record(plant, one, k));
  return measured(records);
}

void add_modes(const test::ModalSystem& plant, const FrequencyResponses& responses,
               test::ClassScore& score) {
  score.add(test::true_modes(plant), test::found_modes(identify_modes(responses, foreign_band)));
}

FrequencyResponses textbook(const Measurement& m) {
  return estimate_responses(m.spectra,
                            {.inputs = {6, 7, 8}, .outputs = {3, 4, 5}, .instruments = {0, 1, 2}},
                            Estimator::instrumental);
}

}  // namespace hydrapod::identification
