#include "wandering.hpp"

namespace hydrapod::identification {

data::Record drifting_record(const test::ModalSystem& system, const Drift& d, std::uint64_t seed) {
  const double T = 1.0 / d.sample_rate;
  const auto samples = static_cast<Eigen::Index>(d.duration * d.sample_rate);
  constexpr Eigen::Index settling = 6000;
  test::Random random(5717 * seed);
  data::Record record{.header = test::header_of(system.inputs(), system.outputs(), d.sample_rate),
                      .samples = data::Samples(samples, system.inputs() + system.outputs())};
  Eigen::VectorXcd state = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(system.modes.size()));
  for (Eigen::Index k = -settling; k < samples; ++k) {
    Eigen::VectorXd u(system.inputs()), y = Eigen::VectorXd::Zero(system.outputs());
    const double share =
        static_cast<double>(std::max<Eigen::Index>(k, 0)) / static_cast<double>(samples);
    for (double& x : u) x = std::pow(d.growth, share) * test::normal(random);
    for (std::size_t r = 0; r < system.modes.size(); ++r) {
      const auto& mode = system.modes[r];
      auto& q = state[static_cast<Eigen::Index>(r)];
      y += 2.0 * (mode.shape * q).real();
      const std::complex<double> pole =
          mode.pole * (static_cast<int>(r) == d.mode ? 1.0 + d.size * (share - 0.5) : 1.0);
      const std::complex<double> decay = std::exp(pole * T);
      const std::complex<double> force = (mode.participation.transpose() * u)(0);
      q = decay * q + (decay - 1.0) / pole * force;
    }
    if (k >= 0) record.samples.row(k) << u.transpose(), y.transpose();
  }
  add_output_noise(d.noise, system.inputs(), random, record);
  return record;
}

Identification tested_for_wandering(const data::Record& record, TimeTaken* time) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  };
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  const auto begin = Clock::now();
  const auto measured = measure_responses(records, {});
  auto found = identify_modes(measured.responses);
  const auto middle = Clock::now();
  add_wandering(compare_parts(records, measured, {}, found).wandering, found);
  if (time != nullptr) {
    time->all_else += seconds(begin, middle);
    time->test += seconds(middle, Clock::now());
  }
  return found;
}

std::vector<ModeWarning> wandering_in(const Identification& found) {
  std::vector<ModeWarning> list;
  for (const auto& warning : found.warnings)
    if (warning.kind == ModeWarning::Kind::wanders) list.push_back(warning);
  return list;
}

}  // namespace hydrapod::identification
