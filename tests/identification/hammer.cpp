#include "hammer.hpp"

namespace hydrapod::identification {

test::ModalSystem beam(Eigen::Index point) {
  auto system =
      pushed_at_first({test::real_mode(23.71, 0.0113, Eigen::Vector3d(0.61, -0.83, 0.29)),
                       test::real_mode(61.37, 0.0171, Eigen::Vector3d(0.44, 0.52, -0.97)),
                       test::real_mode(118.3, 0.0062, Eigen::Vector3d(-0.73, 0.38, 0.66))},
                      3);
  for (auto& mode : system.modes) mode.participation = mode.participation.segment(point, 1).eval();
  return system;
}

std::complex<double> pushed(std::complex<double> pole, double t, double width) {
  if (t <= 0.0) return 0.0;
  const double b = std::numbers::pi / width, in = std::min(t, width);
  const auto own = (b * std::exp(pole * in) - pole * std::sin(b * in) - b * std::cos(b * in)) /
                   (pole * pole + b * b);
  return t > width ? own * std::exp(pole * (t - width)) : own;
}

data::Record hammer_record(const HammerTest& hammer, std::uint64_t seed) {
  const auto system = beam(hammer.point);
  test::Random random(seed);
  data::Record record{.header = test::header_of(1, 3, hammer_rate), .samples = {}};
  record.samples.setZero(static_cast<Eigen::Index>(hammer.seconds * hammer_rate), 4);
  constexpr double newtons = 870.0;
  for (std::size_t h = 0; h < hammer.at.size(); ++h)
    for (Eigen::Index k = 0; k < record.samples.rows(); ++k) {
      const double t = static_cast<double>(k) / hammer_rate - hammer.at[h],
                   size = newtons * (hammer.size.empty() ? 1.0 : hammer.size[h]);
      if (t >= 0.0 && t < hammer.width)
        record.samples(k, 0) += size * std::sin(std::numbers::pi * t / hammer.width);
      for (const auto& mode : system.modes)
        record.samples.row(k).tail(3) +=
            2.0 * size *
            (mode.shape * mode.participation[0] * pushed(mode.pole, t, hammer.width))
                .real()
                .transpose();
    }
  const double largest = record.samples.rightCols(3).cwiseAbs().maxCoeff();
  for (double& y : record.samples.rightCols(3).reshaped())
    y += largest * (hammer.noise * test::normal(random) + hammer.offset);
  for (double& u : record.samples.col(0).reshaped()) u += 0.4 * test::normal(random) + 3.1;
  return record;
}

test::ClassScore hammer_score(const std::vector<HammerTest>& hammers, int seeds) {
  test::ClassScore score;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::vector<data::Record> records;
    for (const auto& hammer : hammers)
      records.push_back(
          hammer_record(hammer, static_cast<std::uint64_t>(seed) + 1000 * records.size()));
    score.add(test::true_modes(beam(hammers[0].point)),
              test::found_modes(identify_modes(measured(records).responses)));
  }
  return score;
}

}  // namespace hydrapod::identification
