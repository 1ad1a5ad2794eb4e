#pragma once
/// A machine on the rig, diagnosed against what its owner believes it to be.

#include <gtest/gtest.h>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/calibration_machine.hpp"
#include "support/rig_record.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

/// From modes and responses. `design` and `truth`: overrides of models/`name`.toml. The pose is the
/// neutral one.
inline diagnosis::Diagnosis diagnosed_on_rig(const std::string& name,
                                             const std::vector<std::string>& design,
                                             const std::vector<std::string>& truth,
                                             RigExperiment experiment) {
  const auto text = read_text(source_file("models/" + name + ".toml"));
  const auto machine = machine_file(text, truth).machine;
  const auto file = machine_file(text, design);
  experiment.X_BP = machine.neutral();
  experiment.point = spatial::Vector3::Zero();
  observation::MeasuredAt at{.pose = "neutral", .point = spatial::Vector3::Zero()};
  if (experiment.force > 0.0) {  // about the mass centre, and the controller is at work
    at.observed = observation::Observed::system;
    at.force_point = machine.platform.mass_center;
  }
  const auto responses = measured_on_rig(machine, experiment);
  auto targets = observation::measured_modes(
      identification::modal_results(identification::identify_modes(responses)), file.machine, at);
  if (const auto lines = observation::measured_responses(responses, file.machine, at))
    targets.responses.push_back(*lines);
  return diagnosis::diagnose(file, targets, dynamics::ModelKind::guide, file.machine.poses);
}

/// The guide sleeves of all legs are blamed, and their stiffness is the true one, within 5 % and
/// within the interval.
inline void expect_sleeves(const diagnosis::Diagnosis& d, double stiffness) {
  EXPECT_TRUE(d.finding == diagnosis::Finding::identified ||
              d.finding == diagnosis::Finding::undecided)
      << report::finding_word(d.finding);
  ASSERT_EQ(report::hypothesis_name(d, d.best()), "guide sleeves of all legs");
  const auto& p = d.best().fit.parameters.at(0);
  EXPECT_NEAR(p.value / stiffness, 1.0, 0.05);
  EXPECT_NEAR(p.value, stiffness, 1.96 * p.deviation);
}

}  // namespace hydrapod::test
