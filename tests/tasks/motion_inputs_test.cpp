/// Responses to measured motions: inverse ones are refused, others are said to have poles of the
/// machine that is held.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "exact/modal_system.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "support/run_program.hpp"

namespace hydrapod::tasks {
namespace {

using testing::HasSubstr;
using Kind = data::ResponseWarning::Kind;

test::ModalSystem three_masses() { return test::chain(3, 1.3, 4000.0, 0.015); }

/// A table as any program writes it, of H by `value` of the displacement responses to the first
/// force.
template <class Value>
void write_table(const std::string& file, const std::string& name, const std::string& unit,
                 const Value& value) {
  const auto system = three_masses();
  test::Random random(3);
  std::ofstream out(file);
  out << fmt::format("frequency [Hz],re {0} [{1}],im {0} [{1}]\n", name, unit);
  for (int k = 20; k < 500; ++k) {
    const double f = 0.04 * k;
    const std::complex<double> H =
        value(system.response(f)) *
        (1.0 + 0.003 * std::complex<double>(test::normal(random), test::normal(random)));
    out << fmt::format("{},{},{}\n", f, H.real(), H.imag());
  }
}

std::int64_t motion_warnings(const Identified& found) {
  return std::ranges::count(found.measured.responses().warnings, Kind::motion_input,
                            &data::ResponseWarning::kind);
}

class MotionInputs : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const char* name) const { return folder_ / name; }
  [[nodiscard]] Identified identified(const char* name) const {
    return identify({.measure = {.files = {path(name)}}});
  }
  /// A record of three forces and three motions.
  void write_run(const char* name) const {
    const auto record = test::record_of(
        three_masses(), {.samples = 1 << 14, .output_noise = Eigen::Vector3d(1, 1, 1) * 1e-5});
    data::write_record(path(name), record, data::RecordFormat::hdf5);
  }

 private:
  test::TemporaryFolder folder_{};
};

TEST_F(MotionInputs, InverseResponsesAreRefused) {
  write_table(path("stiffness.csv"), "F/x1", "N/m",
              [](const Eigen::MatrixXcd& H) { return 1.0 / H(0, 0); });
  try {
    identified("stiffness.csv");
    FAIL() << "not refused";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("stiffness.csv"));
    EXPECT_THAT(error.what(),
                HasSubstr("the output F is a force [N] and the input x1 a motion [m]"));
    EXPECT_THAT(error.what(), HasSubstr("accepted are responses of motions to forces"));
  }
  write_table(path("mass.csv"), "F/a1", "N/(m/s^2)",
              [](const Eigen::MatrixXcd& H) { return 1.0 / H(0, 0); });
  EXPECT_THROW(identified("mass.csv"), base::InputError);
}

TEST_F(MotionInputs, TransmissibilitiesAreSaidToHaveThePolesOfTheMachineThatIsHeld) {
  write_table(path("ratio.csv"), "a2/a1", "g/g",
              [](const Eigen::MatrixXcd& H) { return H(1, 0) / H(0, 0); });
  const auto found = identified("ratio.csv");
  EXPECT_EQ(motion_warnings(found), 1);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_TRUE(std::ranges::any_of(found.warnings, [](const base::Diagnostic& d) {
    return d.message.find("the input a1 is a motion: poles are those with this motion held") !=
           std::string::npos;
  }));
}

TEST_F(MotionInputs, ForcesAndCommandsAreNoMotions) {
  write_table(path("force.csv"), "a1/F", "m/N", [](const Eigen::MatrixXcd& H) { return H(0, 0); });
  EXPECT_EQ(motion_warnings(identified("force.csv")), 0);
  write_table(path("command.csv"), "a1/command z", "m/m",
              [](const Eigen::MatrixXcd& H) { return H(0, 0); });
  EXPECT_EQ(motion_warnings(identified("command.csv")), 0);
  write_run("run.h5");
  EXPECT_EQ(motion_warnings(identified("run.h5")), 0);
}

TEST_F(MotionInputs, OfARecordByTheRolesOfItsChannels) {
  write_run("run.h5");
  const auto identified_with = [&](std::vector<std::string> inputs,
                                   std::vector<std::string> outputs) {
    IdentifyOptions options{.measure = {.files = {path("run.h5")}}};
    options.measure.estimate.inputs = std::move(inputs);
    options.measure.estimate.outputs = std::move(outputs);
    return identify(options);
  };
  EXPECT_EQ(motion_warnings(identified_with({"y1"}, {"y2", "y3"})), 1);
  EXPECT_EQ(motion_warnings(identified_with({"u1", "u2", "u3"}, {"y2", "y3"})), 0);
  EXPECT_THROW(identified_with({"y1"}, {"u1", "u2"}), base::InputError);
  // responses alone are what they are
  MeasureOptions options{.files = {path("run.h5")}};
  options.estimate.inputs = {"y1"};
  options.estimate.outputs = {"u1"};
  EXPECT_EQ(frf(options).responses().outputs[0].name, "u1");
}

}  // namespace
}  // namespace hydrapod::tasks
