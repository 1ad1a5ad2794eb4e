/// Accelerometers at known places as directions of the platform, from a record file on.

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "exact/modal_system.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/responses.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::identification {
namespace {

using spatial::Vector3;

const std::vector<LinearSensor> sensors{
    {{0.71, -0.12, 0.33}, {1.0, 0.0, 0.0}},   {{0.71, -0.12, 0.33}, {0.0, 0.6, 0.8}},
    {{-0.45, 0.52, 0.29}, {0.0, 1.0, 0.0}},   {{-0.45, 0.52, 0.29}, {0.0, 0.0, 1.0}},
    {{-0.31, -0.66, 0.41}, {0.8, 0.0, -0.6}}, {{-0.31, -0.66, 0.41}, {0.0, 1.0, 0.0}},
    {{0.05, 0.02, -0.2}, {0.0, 0.0, 1.0}}};
const Vector3 p_BQ(0.02, -0.03, 0.17);

/// Six inputs that accelerate the platform at Q by G u, seen by the sensors.
data::Record record_of(const Eigen::Matrix<double, 6, 6>& G) {
  data::Record record;
  record.header.sample_rate = 100.0;
  for (int i = 1; i <= 6; ++i)
    record.header.channels.push_back(
        {.name = "u" + std::to_string(i), .unit = "N", .role = data::Role::excitation});
  for (std::size_t k = 0; k < sensors.size(); ++k)
    record.header.channels.push_back({.name = "a" + std::to_string(k + 1),
                                      .unit = "m/s^2",
                                      .role = data::Role::response,
                                      .point = static_cast<int>(k) + 1});
  test::Random random(17);
  record.samples.resize(1 << 13, 6 + static_cast<Eigen::Index>(sensors.size()));
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t) {
    Eigen::Matrix<double, 6, 1> u;
    for (double& x : u) x = test::normal(random);
    record.samples.row(t).head<6>() = u;
    const Eigen::Matrix<double, 6, 1> q = G * u;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      const Vector3 a = q.head<3>() + q.tail<3>().cross(sensors[k].position - p_BQ);
      record.samples(t, 6 + static_cast<Eigen::Index>(k)) = sensors[k].axis.dot(a);
    }
  }
  return record;
}

class Accelerometers : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  Eigen::Matrix<double, 6, 6> G =
      Eigen::Matrix<double, 6, 6>::Identity() + 0.3 * Eigen::Matrix<double, 6, 6>::Random();
  MeasureOptions options{.outputs = {"a1", "a2", "a3", "a4", "a5", "a6", "a7"},
                         .block_length = 256,
                         .outputs_to_platform = platform_from_accelerometers(sensors, p_BQ)};
};

TEST_F(Accelerometers, GiveTheAccelerationOfThePoint) {
  const std::string path = folder / "run.h5";
  data::write_record(path, record_of(G), data::RecordFormat::hdf5);
  data::RecordSet record({path});
  const auto m = measure_responses(record, options);
  ASSERT_EQ(m.responses.outputs.size(), 6U);
  for (int d = 0; d < 6; ++d) {
    const auto& channel = m.responses.outputs[static_cast<std::size_t>(d)];
    EXPECT_EQ(channel.direction, static_cast<data::Direction>(d + 1));
    EXPECT_EQ(channel.unit, d < 3 ? "m/s^2" : "rad/s^2");
    EXPECT_EQ(channel.point, 0);
  }
  for (const auto& H : m.responses.H)
    EXPECT_LT((H - G.cast<std::complex<double>>()).norm(), 1e-9 * G.norm());
}

TEST_F(Accelerometers, ADeadOneIsNamed) {
  auto record = record_of(G);
  record.samples.col(8).setConstant(0.25);
  const std::string path = folder / "run.h5";
  data::write_record(path, record, data::RecordFormat::hdf5);
  data::RecordSet records({path});
  try {
    measure_responses(records, options);
    FAIL() << "accepted";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("a3 is dead"));
  }
}

}  // namespace
}  // namespace hydrapod::identification
