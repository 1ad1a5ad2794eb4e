#include "many_modes.hpp"

namespace hydrapod::identification {

test::ModalSystem random_system(const ManyModes& made, test::Random& random) {
  test::ModalSystem system;
  const double step = std::log(93.0 / 6.1) / made.modes;
  double frequency = 6.1, damping = 0.0;
  for (int r = 0; r < made.modes; ++r) {
    // a pair is a bandwidth 2 ζ f apart, half of it or one and a half
    const bool second = made.close_pairs && r % 3 == 1;
    frequency *= second ? 1.0 + 2.0 * damping * random.uniform(0.5, 1.5)
                        : std::exp(step * random.uniform(0.6, 1.4));
    damping = random.uniform(0.0043, 0.0187);
    Eigen::VectorXd shape(made.outputs);
    for (double& x : shape) x = test::normal(random);
    // no reference in a node: what it does not excite, nothing finds
    for (Eigen::Index i = 0; i < made.references; ++i)
      shape[i] = std::copysign(random.uniform(0.5, 1.5), shape[i]);
    auto mode = test::real_mode(frequency, damping, shape);
    mode.participation = mode.participation.head(made.references).eval();
    system.modes.push_back(mode);
  }
  return system;
}

test::ModalSystem chain_system(const ManyModes& made) {
  auto system = test::chain(made.modes, 1.73, 2.31e5, 0.0093);
  for (auto& mode : system.modes)
    mode.participation = mode.participation.head(made.references).eval();
  return system;
}

FrequencyResponses responses_of_many(const test::ModalSystem& system, const ManyModes& made,
                                     test::Random& random) {
  FrequencyResponses r;
  const auto header = test::header_of(system.inputs(), system.outputs(), 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + system.inputs());
  r.outputs.assign(header.channels.begin() + system.inputs(), header.channels.end());
  for (auto& channel : r.outputs) channel.unit = "m/s^2";
  const double top = std::abs(system.modes.back().pole) / (2.0 * std::numbers::pi);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(system.outputs(), system.inputs());
  for (double f = 2.1; f < 1.11 * top; f += made.spacing) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    r.frequency.push_back(f);
    r.H.push_back(s * s * system.response(f));
    square += r.H.back().cwiseAbs2();
  }
  // the deviation of an output is the same for all references, as that of a sensor is
  const Eigen::VectorXd deviation =
      made.noise * (square.rowwise().mean() / static_cast<double>(r.lines())).cwiseSqrt();
  for (auto& H : r.H) {
    for (Eigen::Index o = 0; o < H.rows(); ++o)
      for (Eigen::Index i = 0; i < H.cols(); ++i)
        H(o, i) += deviation[o] * std::sqrt(0.5) *
                   std::complex<double>(test::normal(random), test::normal(random));
    if (!made.known) continue;
    r.noise.emplace_back(deviation.cwiseAbs2().cast<std::complex<double>>().asDiagonal());
    r.input_factor.emplace_back(Eigen::MatrixXcd::Identity(system.inputs(), system.inputs()));
  }
  return r;
}

std::vector<test::FoundMode> textbook_modes(const FrequencyResponses& responses) {
  std::vector<test::FoundMode> list;
  for (const auto& cluster : select_poles(poly_reference_poles(responses, {2, 40, 2})))
    if (cluster.representative.damping_ratio() < 0.3)
      list.push_back({.pole = cluster.representative.pole, .shape = {}, .shape_deviation = {}});
  return list;
}

ManyModesScore score_of_many(const ManyModes& made, int seeds) {
  ManyModesScore score;
  for (int seed = 1; seed <= seeds; ++seed) {
    test::Random random(static_cast<std::uint64_t>(1000 + seed));
    const auto system = made.masses ? chain_system(made) : random_system(made, random);
    const auto responses = responses_of_many(system, made, random);
    const auto truth = test::true_modes(system);
    const auto found = identify_modes(responses);
    score.unexplained += found.unexplained.empty() ? 0 : 1;
    score.ours.add(truth, test::found_modes(found), {.frequency = 0.01});
    score.textbook.add(truth, textbook_modes(responses), {.frequency = 0.01});
  }
  return score;
}

}  // namespace hydrapod::identification
