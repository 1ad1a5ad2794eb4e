/// An error that all frequencies have in common is that of the model, and no cause is identified by
/// it.

#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "diagnosis/evidence.hpp"
#include "diagnosis/ranking.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;

const std::vector<std::string> three_poses{"neutral", "low", "surge"};

model::MachineFile heavy_platform(const std::vector<std::string>& overrides = {}) {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")),
                            overrides);
}

/// Modes of the machine at three poses, each frequency 0.41 % lower, measured to 0.05 %.
observation::Targets all_lower() {
  test::Random random(31);
  auto targets = test::noisy_modes(heavy_platform().machine, three_poses, ModelKind::guide,
                                   {.frequency = 5e-4, .shape = 0.013}, random);
  for (auto& mode : targets.modes) mode.omega *= 1.0 - 4.1e-3;
  return targets;
}

/// Twice the model uncertainty of 0.2 %. Were it independent from mode to mode, twenty such
/// frequencies would refute the nominal machine.
TEST(CommonError, OfAllFrequenciesIdentifiesNoCause) {
  const auto file = heavy_platform();
  const auto targets = all_lower();
  const auto d =
      diagnose(file, targets, ModelKind::guide, {}, {.common_share = 0.5, .strongest = 1});
  EXPECT_EQ(d.finding, Finding::nominal) << test::verdict(d);
  EXPECT_GE(d.modes.size(), 20U);
  const auto alone = diagnose(file, targets, ModelKind::guide, {}, {.strongest = 1});
  EXPECT_NE(alone.finding, Finding::nominal);
  EXPECT_LT(goodness(alone, alone.nominal()).probability, 1e-4);
}

/// χ² of the frequencies is rᵀ R⁻¹ r, with R = 1 − ρ² + ρ ρᵀ by Sherman and Morrison, and the
/// misfit is that beside the χ² of the shapes.
TEST(CommonError, IsInTheMisfit) {
  const auto file = heavy_platform();
  const DiagnoseOptions options{.frequency_error = 2.7e-3, .common_share = 0.37};
  const auto targets = weighted_targets(file, all_lower(), options);
  const auto causes = causes_of(file);
  const Evidence evidence(file, targets, ModelKind::guide, causes);
  const auto& nominal = evidence.nominal();
  double own = 0.0, across = 0.0, slopes = 0.0;
  for (std::size_t i = 0; i < targets.modes.size(); ++i) {
    const auto& mode = targets.modes[i];
    const double shared = options.common_share * std::pow(2.7e-3 * mode.omega, 2);
    const double left = mode.deviation * mode.deviation - shared;
    const double r = nominal.fit.targets[i].omega - mode.omega;
    own += r * r / left;
    across += r * std::sqrt(shared) / left;
    slopes += shared / left;
  }
  const double expected = own - across * across / (1.0 + slopes);
  Diagnosis d{.causes = causes, .hypotheses = {nominal}, .targets = targets};
  d.values = values_in(targets);
  const auto g = goodness(d, nominal);
  EXPECT_NEAR(g.frequencies.sum, expected, 1e-9 * expected);
  // shapes are met as well, whatever frequencies have in common
  auto alone = targets;
  double squares = 0.0;
  for (std::size_t i = 0; i < targets.modes.size(); ++i) {
    alone.modes[i].common_deviation = 0.0;
    squares += std::pow(nominal.fit.targets[i].difference, 2);
  }
  const auto fit = calibration::compare(file, alone, ModelKind::guide);
  EXPECT_NEAR(nominal.misfit - expected, fit.misfit - squares, 1e-9 * fit.misfit);
}

}  // namespace
}  // namespace hydrapod::diagnosis
