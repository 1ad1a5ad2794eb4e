/// From records and files to what other tasks compare with: poses and sensors of a record, the
/// summary of responses, lists of modes with and without deviations.

#include "hydrapod/tasks/measurement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <memory>

#include "exact/modal_system.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/tasks/simulation.hpp"
#include "identification/short_records.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using spatial::Vector3;

const std::array<double, 6> turned_pose{0.013, -0.021, 0.0, 0.31, -0.22, 0.47};

/// R = Rz Ry Rx of that pose.
spatial::Matrix3 turned() {
  return (Eigen::AngleAxisd(turned_pose[5], Vector3::UnitZ()) *
          Eigen::AngleAxisd(turned_pose[4], Vector3::UnitY()) *
          Eigen::AngleAxisd(turned_pose[3], Vector3::UnitX()))
      .toRotationMatrix();
}

/// A platform at a pose that its file does not name, whose point Q accelerates by `linear` and
/// `angular` times the force, in the axes of the base; six accelerometers feel it, each in an axis
/// of its own.
data::Record accelerated(const Vector3& p_PQ, const Vector3& linear, const Vector3& angular) {
  constexpr double rate = 200.0;
  data::Record record;
  auto& header = record.header;
  header.sample_rate = rate;
  header.experiment.machine = read_text(source_file("models/heavy-platform.toml"));
  header.experiment.pose_name = "where the crane left it";
  header.experiment.pose = turned_pose;
  header.channels = {{"force", "N", data::Direction::z, data::Role::excitation, 0}};
  const std::array<Vector3, 6> places{Vector3(1.1, 0.2, -0.1),  Vector3(-0.7, 0.9, 0.2),
                                      Vector3(-0.4, -1.2, 0.1), Vector3(0.9, -0.3, 0.4),
                                      Vector3(-0.2, 0.6, -0.5), Vector3(0.3, -0.8, 0.7)};
  const std::array<Vector3, 6> axes{Vector3(0.2, 0.1, 1.0),  Vector3(-0.3, 0.4, 0.9),
                                    Vector3(0.1, -0.2, 0.8), Vector3(1.0, 0.3, 0.2),
                                    Vector3(0.2, 1.1, -0.3), Vector3(0.9, -0.8, 0.1)};
  const spatial::Matrix3 R = turned();
  Eigen::RowVectorXd row(7);
  row[0] = 1.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vector3 axis = axes[k].normalized();
    const auto name = "a" + std::to_string(k);
    header.channels.push_back({name, "m/s^2", data::Direction::none, data::Role::response, 0});
    header.experiment.sensors.push_back({name, places[k], axis});
    const Vector3 felt = linear + angular.cross(R * (places[k] - p_PQ));
    row[static_cast<Eigen::Index>(k) + 1] = (R * axis).dot(felt);
  }
  record.samples.resize(8192, 7);
  Random random(29);
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t)
    record.samples.row(t) = 130.0 * normal(random) * row;
  return record;
}

TEST(Measured, AccelerometersAreTurnedAsTheRecordedPoseSays) {
  const TemporaryFolder folder;
  const Vector3 p_PQ(0.17, -0.29, 0.23), linear(1.3e-4, -0.7e-4, 2.1e-4),
      angular(0.37e-4, -0.91e-4, 0.53e-4);
  data::write_record(folder / "run.h5", accelerated(p_PQ, linear, angular),
                     data::RecordFormat::hdf5);
  const auto measured =
      tasks::frf({.files = {folder / "run.h5"}, .accelerometers = true, .p_PQ = p_PQ});
  ASSERT_TRUE(measured.machine);
  EXPECT_EQ(measured.machine->pose.name, "where the crane left it");
  const auto& X_BP = measured.machine->pose.X_BP;
  EXPECT_LT((X_BP.R_BP - turned()).norm(), 1e-14);
  EXPECT_EQ(X_BP.p_BP, Vector3(turned_pose[0], turned_pose[1], turned_pose[2]));
  spatial::Vector6 expected;
  expected << linear, angular;
  const auto& responses = measured.responses();
  ASSERT_EQ(responses.outputs.size(), 6U);
  ASSERT_GT(responses.lines(), 10U);
  for (const auto& H : responses.H)
    EXPECT_LT((H.col(0) - expected.cast<std::complex<double>>()).norm(), 1e-9 * expected.norm());
}

/// From memory a record gives the bits that its file gives, in modes too.
TEST(Measured, RecordsInMemoryAreAsTheirFiles) {
  const TemporaryFolder folder;
  const auto record = std::make_shared<data::Record>(
      accelerated({0.17, -0.29, 0.23}, {1.3e-4, -0.7e-4, 2.1e-4}, {0.4e-4, 0.0, 0.1e-4}));
  Random random(31);
  for (double& sample : record->samples.reshaped()) sample += 1e-3 * normal(random);
  record->samples(1234, 3) = std::numeric_limits<double>::quiet_NaN();
  data::write_record(folder / "run.h5", *record, data::RecordFormat::hdf5);
  tasks::MeasureOptions of_file{.files = {folder / "run.h5"}, .accelerometers = true};
  auto of_memory = of_file;
  of_memory.files = {"the run"};
  of_memory.records = {record};
  const auto from_file = tasks::frf(of_file), from_memory = tasks::frf(of_memory);
  ASSERT_GT(from_file.responses().lines(), 10U);
  ASSERT_EQ(from_memory.responses().lines(), from_file.responses().lines());
  for (std::size_t k = 0; k < from_file.responses().lines(); ++k) {
    EXPECT_EQ(from_memory.responses().H[k], from_file.responses().H[k]);
    EXPECT_EQ(from_memory.responses().noise[k], from_file.responses().noise[k]);
  }
  EXPECT_EQ(from_memory.machine->path, "the run (machine)");
  of_memory.sample_rate = 200.0;  // which it has
  EXPECT_EQ(tasks::frf(of_memory).responses().H[7], from_memory.responses().H[7]);
  of_memory.sample_rate = 210.0;
  EXPECT_THROW(tasks::frf(of_memory), base::InputError);
  of_memory.sample_rate.reset();
  of_memory.records.push_back(record);
  of_memory.files.push_back("again");
  try {
    tasks::frf(of_memory);
    FAIL() << "it would count twice";
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "again: error: is given twice, as the run before; it would count twice");
  }
}

TEST(RecordSet, OfMemoryAsksForWhatHoldsTogether) {
  const auto record = std::make_shared<data::Record>(
      accelerated({0.17, -0.29, 0.23}, {1.3e-4, -0.7e-4, 2.1e-4}, {0.4e-4, 0.0, 0.1e-4}));
  const auto other = std::make_shared<data::Record>(*record);
  other->header.channels.back().name = "b5";
  EXPECT_THROW(data::RecordSet({record, other}, {"one", "two"}), base::InputError);
  EXPECT_THROW(data::RecordSet({record}, {"one", "two"}), std::invalid_argument);
  other->header.channels.pop_back();
  EXPECT_THROW(data::RecordSet({other}, {"two"}), std::invalid_argument);
  data::RecordSet set({record}, {"one"});
  EXPECT_FALSE(set.format());
  EXPECT_EQ(set.sample_count(), record->samples.rows());
  set.take_as_missing({{.file = 0, .channel = 2, .begin = 17, .end = 19}});
  std::int64_t missing = 0, rows = 0;
  for (int pass = 0; pass < 2; ++pass)
    set.stream([&](std::size_t, const Eigen::Ref<const data::Samples>& block) {
      missing += block.array().isNaN().count();
      rows += block.rows();
      return true;
    });
  EXPECT_EQ(missing, 2 * 2);
  EXPECT_EQ(rows, 2 * record->samples.rows());
  EXPECT_FALSE(record->samples.array().isNaN().any()) << "the record itself is as it was";
}

/// Volts of sensors of other sensitivities would make motions that nobody made.
TEST(Measured, AccelerometersInOtherUnitsAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.h5";
  const auto with_unit = [&](const char* unit) {
    auto record =
        accelerated({0.17, -0.29, 0.23}, {1.3e-4, -0.7e-4, 2.1e-4}, {0.4e-4, 0.0, 0.1e-4});
    record.header.channels[3].unit = unit;  // of a2
    data::write_record(path, record, data::RecordFormat::hdf5);
    return tasks::MeasureOptions{.files = {path}, .accelerometers = true};
  };
  for (const auto& [unit, said] : {std::pair{"V", "a2 is in V; accepted are"},
                                   {"m/s", "a2 is in m/s; accepted are"},
                                   {"rad/s^2", "a2 is in rad/s^2; accepted are"},
                                   {"", "a2 has no unit; accepted are"}}) {
    try {
      tasks::frf(with_unit(unit));
      FAIL() << unit << " is not refused";
    } catch (const base::InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(said));
      EXPECT_THAT(error.what(), testing::HasSubstr("accelerations (m/s^2, g)"));
      EXPECT_THAT(error.what(), testing::HasSubstr("run.h5"));
    }
  }
  EXPECT_EQ(tasks::frf(with_unit("m s^-2")).responses().outputs.size(), 6U);
}

/// The largest response is that which moves the output most: |H|² times the density of the input.
TEST(ResponseSummary, TakesTheResponseThatMovesTheOutputMost) {
  identification::FrequencyResponses responses;
  responses.inputs = {{.name = "u", .unit = "N"}, {.name = "v", .unit = "N m"}};
  responses.outputs = {{.name = "y", .unit = "m"}};
  const auto add = [&](double hertz, double u, double v, double S_u, double S_v) {
    responses.frequency.push_back(hertz);
    Eigen::MatrixXcd H(1, 2);
    H << std::polar(u, 0.7), std::polar(v, -1.9);
    responses.H.push_back(H);
    responses.input_density.push_back(Eigen::Vector2d(S_u, S_v));
    responses.noise.push_back(Eigen::MatrixXcd::Constant(1, 1, 0.0029 * hertz));
    Eigen::MatrixXcd Q = 0.1 * Eigen::MatrixXcd::Ones(2, 2);
    Q.diagonal() << 0.31, 0.47;
    responses.input_factor.push_back(Q);
  };
  add(1.3, 0.5, 0.9, 4.0, 1.0);   // 1.0 and 0.9
  add(2.9, 0.7, 3.1, 4.0, 0.81);  // 1.4 and 2.79
  add(3.7, 0.5, 0.3, 25.0, 9.0);  // 2.5 and 0.9
  const auto summary = tasks::summary_of(responses);
  ASSERT_EQ(summary.outputs.size(), 1U);
  const auto& y = summary.outputs.front();
  EXPECT_EQ(y.line, 1U);
  EXPECT_EQ(y.input, 1U);
  EXPECT_DOUBLE_EQ(y.magnitude, 3.1);
  // cov(H_oi, H_oi*) is the noise of the output times the factor of the input
  EXPECT_NEAR(y.deviation * y.deviation, 0.0029 * 2.9 * 0.47, 1e-15);
}

/// A deviation that only one of two lists states counts for neither.
TEST(ReadMeasured, DeviationsCountWhereAllFilesStateThem) {
  const TemporaryFolder folder;
  const std::string mode = "[[mode]]\nfrequency = \"4.3 Hz\"\ndirection = \"x\"\n";
  write_text(folder / "without.toml", mode);
  write_text(folder / "with.toml", "deviation = \"0.7 %\"\n" + mode);
  write_text(folder / "too.toml", "deviation = \"0.9 %\"\n" + mode);
  const auto machine =
      tasks::read_machine({.file = source_file("models/heavy-platform.toml").string()});
  const auto given = [&](const char* first, const char* second) {
    const auto targets =
        tasks::read_measured(machine, {.files = {folder / first, folder / second}}).targets;
    EXPECT_EQ(targets.modes.size(), 2U);
    return targets.deviations_given;
  };
  EXPECT_TRUE(given("with.toml", "too.toml"));
  EXPECT_FALSE(given("with.toml", "without.toml"));
  EXPECT_FALSE(given("without.toml", "with.toml"));
}

/// What `diagnose` and `calibrate` compare with are the modes that `identify` finds, in short
/// records of masses on springs too; averages of blocks do not show them all.
TEST(ReadMeasured, AShortRecordGivesTheModesOfTheWholeOfIt) {
  const TemporaryFolder folder;
  const auto system = identification::two_rows();
  auto record = identification::short_record(system, {.duration = 9.1, .noise = 0.05}, 17);
  int direction = 0;
  for (auto& channel : record.header.channels)
    if (channel.role == data::Role::response)
      channel.direction = static_cast<data::Direction>(++direction);
  ASSERT_EQ(direction, 6);
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  const auto machine =
      tasks::read_machine({.file = source_file("models/heavy-platform.toml").string()});
  const auto targets = tasks::read_measured(machine, {.files = {file}}).targets;
  ASSERT_EQ(targets.modes.size(), system.modes.size());
  for (std::size_t k = 0; k < system.modes.size(); ++k) {
    const auto& mode = targets.modes[k];
    EXPECT_TRUE(mode.damped);
    EXPECT_NEAR(mode.omega, std::abs(system.modes[k].pole), 4.0 * mode.deviation) << k;
    EXPECT_LT(mode.deviation, 0.004 * mode.omega);
  }
  tasks::IdentifyOptions averaged{.measure = {.files = {file}}};
  averaged.measure.estimate.whole_record = false;
  EXPECT_LT(tasks::identify(averaged).modes.modes.size(), system.modes.size());
}

/// The period that the record states is the one after which its excitation repeats.
TEST(RigRecord, StatesThePeriodOfItsExcitation) {
  const TemporaryFolder folder;
  const auto machine =
      tasks::read_machine({.file = source_file("models/heavy-platform.toml").string()});
  const signals::Signal sines{.size = spatial::Vector6::Constant(1e-5),
                              .form = signals::Multisine{.from = 8.0, .to = 40.0, .period = 0.125},
                              .fade = 0.0};
  tasks::rig(machine, {.test = {.signals = {sines}, .settling = 0.3, .duration = 0.3},
                       .record = folder / "run.h5"});
  const auto record = data::read_record(folder / "run.h5").record;
  const auto& excitation = record.header.experiment.excitation;
  ASSERT_TRUE(excitation && excitation->period);
  EXPECT_NEAR(*excitation->period, 0.125, 1e-12);
  const auto samples =
      static_cast<Eigen::Index>(std::lround(*excitation->period * record.header.sample_rate));
  ASSERT_LT(samples, record.samples.rows());
  const Eigen::Index both = record.samples.rows() - samples;
  const Eigen::VectorXd x = record.samples.col(0);
  EXPECT_LT((x.head(both) - x.tail(both)).norm(), 1e-9 * x.norm());
}

}  // namespace
}  // namespace hydrapod::test
