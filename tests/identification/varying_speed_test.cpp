/// Modes from outputs alone beside a machine whose speed varies: its vibrations are named, and are
/// no modes.

#include "varying_speed.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <numeric>

#include "hydrapod/numerics/fft.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

TEST(VaryingSpeed, IsNamedAndIsNoMode) {
  for (const double spread : {0.001, 0.003, 0.01}) {
    auto data = floor_with_machine(spread);
    data.experiment.seed = 21;
    const auto found = identified_as_asked(
        with_machine(outputs_of(data.system, data.experiment), data.machine, 22));
    ClassScore score;
    score.add(true_modes(data.system), found_modes(found));
    EXPECT_EQ(score.found, 4) << spread;
    // what is left of the flanks may be a pole, but none that is trusted
    int trusted = 0;
    for (const auto& mode : found.modes) trusted += mode.quality() >= 0.5 ? 1 : 0;
    EXPECT_EQ(trusted, 4) << spread;
    const auto is_speed = [&](const data::Harmonic& harmonic) {
      return std::abs(harmonic.frequency / data.machine.frequency - 1.0) < spread + 0.001;
    };
    ASSERT_TRUE(std::ranges::any_of(found.responses.harmonics, is_speed)) << spread;
    if (spread < 0.003) continue;
    const auto& harmonic = *std::ranges::find_if(found.responses.harmonics, is_speed);
    // a normal process is within three deviations nearly all the time
    EXPECT_NEAR(harmonic.wander / data.machine.frequency, 2.5 * spread, spread) << spread;
  }
}

/// Noise and resonances, however sharp, are no vibrations of constant amplitude.
TEST(VaryingSpeed, NothingIsFoundWhereNothingTurns) {
  for (std::uint64_t seed = 31; seed < 34; ++seed) {
    auto data = floor_with_machine(0.0);
    data.experiment.seed = seed;
    const auto found = identified_as_asked(outputs_of(data.system, data.experiment));
    EXPECT_TRUE(found.responses.harmonics.empty()) << seed;
    EXPECT_EQ(found.modes.size(), 4U) << seed;
  }
}

/// Outputs under these forces of all inputs, over time [s], and noise of sensors.
data::Record outputs_under(const ModalSystem& system,
                           const std::function<void(double, Eigen::VectorXd&)>& force) {
  constexpr double rate = 100.0;
  constexpr int rows = 20000;
  ModalRun run(system, 1.0 / rate);
  data::Record record{.header = header_of(0, system.outputs(), rate), .samples = {}};
  record.samples.resize(rows, system.outputs());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(system.inputs());
  for (int k = 0; k < rows; ++k) {
    force(k / rate, u);
    record.samples.row(k) = run.output().transpose();
    run.advance(u);
  }
  Random random(417);
  const double rms = std::sqrt(record.samples.squaredNorm() / record.samples.size());
  for (double& x : record.samples.reshaped()) x += 0.02 * rms * normal(random);
  return record;
}

const data::ResponseWarning* run_up_in(const std::vector<data::ResponseWarning>& all) {
  const auto at =
      std::ranges::find(all, data::ResponseWarning::Kind::run_up, &data::ResponseWarning::kind);
  return at == all.end() ? nullptr : &*at;
}

std::vector<data::ResponseWarning> warnings_of(const data::Record& record) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  return identification::measure_outputs(records, {}).responses.warnings;
}

/// An unbalance, and what comes twice a turn. Up, and up and down again.
TEST(RunUp, IsNamedAndNoModeIsTrusted) {
  const auto system = floor_with_machine(0.0).system;
  for (const bool down_again : {false, true}) {
    double turned = 0.0;
    const auto found = identified_as_asked(outputs_under(system, [&](double t, Eigen::VectorXd& u) {
      const double share = down_again ? 1.0 - std::abs(t / 100.0 - 1.0) : t / 200.0;
      const double speed = 2.63 + 18.4 * share;  // [Hz]
      turned += 2.0 * std::numbers::pi * speed / 100.0;
      u[1] = speed * speed * std::sin(turned) + 21.0 * std::sin(2.0 * turned);
    }));
    const auto* warning = run_up_in(found.responses.warnings);
    ASSERT_NE(warning, nullptr);
    EXPECT_LT(warning->lowest, 4.0);
    EXPECT_GT(warning->highest, 19.0);
    EXPECT_LT(warning->share, 0.1);
    for (const auto& mode : found.modes) EXPECT_LE(mode.quality(), 0.3) << mode.fit.omega();
  }
}

/// White noise of a band, as a generator makes it: a sum of sines of random phases at the lines of
/// the whole record.
data::Record outputs_under_band(const ModalSystem& system, double from, double to,
                                double sensor_noise) {
  constexpr double rate = 100.0;
  constexpr int rows = 1 << 15;
  Random random(1009);
  Eigen::MatrixXd forces(rows, system.inputs());
  numerics::RealFft fft(rows);
  std::vector<std::complex<double>> lines(static_cast<std::size_t>(fft.lines()));
  for (auto force : forces.colwise()) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const double f = static_cast<double>(k) * rate / rows;
      lines[k] = f < from || f > to ? 0.0 : std::complex(normal(random), normal(random));
    }
    fft.inverse(lines, {force.data(), static_cast<std::size_t>(rows)});
  }
  ModalRun run(system, 1.0 / rate);
  data::Record record{.header = header_of(0, system.outputs(), rate), .samples = {}};
  record.samples.resize(rows, system.outputs());
  for (int k = -rows; k < rows; ++k) {  // the noise has the period of the record
    if (k >= 0) record.samples.row(k) = run.output().transpose();
    run.advance(forces.row((k + rows) % rows).transpose());
  }
  const double rms = std::sqrt(record.samples.squaredNorm() / record.samples.size());
  for (double& x : record.samples.reshaped()) x += sensor_noise * rms * normal(random);
  return record;
}

/// Four more modes at 2 Hz, or none at all, where the ends are taken for the machine's.
TEST(ExcitationEnds, AreNoModes) {
  const auto system = floor_with_machine(0.0).system;
  struct Case {
    double from, to, noise;
  };
  for (const auto& [from, to, noise] :
       {Case{2.03, 20.1, 0.01}, {0.0, 12.02, 1e-4}, {4.97, 13.04, 1e-4}}) {
    SCOPED_TRACE(testing::Message() << from << " " << to << " " << noise);
    const auto found = identified_as_asked(outputs_under_band(system, from, to, noise));
    const auto& all = found.responses.warnings;
    const auto named = std::ranges::find(all, data::ResponseWarning::Kind::excited_band,
                                         &data::ResponseWarning::kind);
    ASSERT_NE(named, all.end());
    if (from > 0.0) EXPECT_NEAR(named->lowest, from, 0.2);
    if (to < 30.0) EXPECT_NEAR(named->highest, to, 0.2);
    auto inside = system;
    std::erase_if(inside.modes, [&](const ExactMode& mode) {
      const double f = std::abs(mode.pole) / (2.0 * std::numbers::pi);
      return f < from || f > to;
    });
    ClassScore score;
    score.add(true_modes(inside), found_modes(found));
    EXPECT_EQ(score.found, static_cast<int>(inside.modes.size()));
    EXPECT_EQ(score.false_modes, 0);
  }
}

/// Resonances and what lies between them are no ends, with few lines and with many.
TEST(ExcitationEnds, AreNotFoundWhereNoiseFillsTheBand) {
  for (const auto& data : {sharp_chain(), close_pairs(), unequal_chain(), chain_with_tones()})
    for (const int block : {256, 512, 1024, 2048, 4096, 8192}) {
      const auto spectra = output_spectra(outputs_of(data.system, data.experiment), block);
      std::vector<int> outputs(spectra.channels.size());
      std::iota(outputs.begin(), outputs.end(), 0);
      if (spectra.blocks < 16) continue;
      const auto half = identification::half_spectra(spectra, outputs);
      EXPECT_TRUE(std::ranges::none_of(half.warnings,
                                       [](const auto& warning) {
                                         return warning.kind ==
                                                data::ResponseWarning::Kind::excited_band;
                                       }))
          << data.name << " " << block;
    }
}

/// Gusts and hits come and go at all frequencies at once; noise goes on, however sharp a resonance.
TEST(RunUp, IsNotFoundInGustsHitsAndNoise) {
  const auto system = floor_with_machine(0.0).system;
  Random random(91);
  const auto gusts = [&](double t, Eigen::VectorXd& u) {
    const double wind = std::exp(3.0 * std::sin(0.071 * t) + 2.0 * std::sin(0.237 * t + 0.9));
    for (double& x : u) x = wind * normal(random);
  };
  const auto hits = [&](double t, Eigen::VectorXd& u) {
    u.setZero();
    const double since = std::fmod(t + 31.7, 83.3);
    if (since < 0.025) u[2] = 1.0 - since / 0.025;
  };
  EXPECT_EQ(run_up_in(warnings_of(outputs_under(system, gusts))), nullptr);
  EXPECT_EQ(run_up_in(warnings_of(outputs_under(system, hits))), nullptr);
  for (const auto& data : {sharp_chain(), close_pairs(), unequal_chain()})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      auto experiment = data.experiment;
      experiment.seed = seed;
      EXPECT_EQ(run_up_in(warnings_of(outputs_of(data.system, experiment))), nullptr)
          << data.name << seed;
    }
}

}  // namespace
}  // namespace hydrapod::test
