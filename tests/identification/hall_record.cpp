#include "hall_record.hpp"

namespace hydrapod::identification {

test::ModalSystem hall_plant() {
  test::ModalSystem system;
  const std::array<double, 4> hertz{34.13, 49.71, 71.62, 93.27},
      damping{0.0121, 0.0087, 0.0153, 0.0064};
  const std::array<Eigen::Vector4d, 4> shape{
      Eigen::Vector4d{0.71, 1.13, 0.52, 0.94}, Eigen::Vector4d{1.21, -0.37, -0.83, 0.66},
      Eigen::Vector4d{-0.58, 0.92, -1.07, 0.41}, Eigen::Vector4d{0.83, 0.77, 0.64, -1.19}};
  for (std::size_t r = 0; r < hertz.size(); ++r) {
    auto mode = test::real_mode(hertz[r], damping[r], shape[r]);
    mode.participation = mode.participation.head(3).eval();
    system.modes.push_back(mode);
  }
  return system;
}

Hall hall_record(const test::ModalSystem& plant, const HallRecord& e) {
  auto record = test::record_of(plant, {.sample_rate = e.sample_rate,
                                        .samples = static_cast<int>(e.duration * e.sample_rate),
                                        .seed = e.seed});
  test::Random random(31 * e.seed + 7);
  const WanderingPhase mains(50.0, e.wander, random);
  const WanderingPhase pump(9.0 * 7.91, 0.0, random);
  auto& x = record.samples;
  const Eigen::Index inputs = plant.inputs();
  Hall hall{.record = {}, .amplitude = Eigen::MatrixXd(3, x.cols())};
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    const bool output = c >= inputs;
    const double rms = x.col(c).norm() / std::sqrt(static_cast<double>(x.rows()));
    const double amplitude = output ? tone_amplitude(e.level, e.noise * rms, e.sample_rate, 2.0)
                                    : tone_amplitude(e.input_level, rms, e.sample_rate, 2.0);
    const double first = amplitude * random.uniform(0.5, 1.0), angle = random.uniform(0.0, 6.28),
                 second = amplitude * random.uniform(0.3, 1.0),
                 ripple = output ? amplitude * random.uniform(0.5, 1.0) : 0.0;
    hall.amplitude.col(c) << first, ripple, second;
    for (Eigen::Index k = 0; k < x.rows(); ++k) {
      const double t = static_cast<double>(k) / e.sample_rate;
      if (output) x(k, c) += e.noise * rms * test::normal(random);
      x(k, c) += first * std::sin(mains(t) + angle) + second * std::sin(2.0 * mains(t) + angle) +
                 ripple * std::sin(pump(t) + angle);
    }
  }
  hall.record = std::move(record);
  return hall;
}

}  // namespace hydrapod::identification
