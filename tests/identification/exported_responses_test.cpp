/// Responses that went through a file give the modes and intervals of the record they came from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foreign_loop.hpp"

namespace hydrapod::identification {
namespace {

/// Two forces on three masses, accelerometers on two of them; disturbances of the machine make the
/// noise of the outputs common, and short blocks widen resonances.
FrequencyResponses open_loop_responses(std::uint64_t seed) {
  const Eigen::Matrix3d M = Eigen::Vector3d(1.37, 2.91, 0.83).asDiagonal();
  Eigen::Matrix3d K, D;
  K << 4310.0, -1930.0, 0.0, -1930.0, 6170.0, -1490.0, 0.0, -1490.0, 9270.0;
  D << 1.9, -0.7, 0.0, -0.7, 2.3, -0.4, 0.0, -0.4, 2.9;
  const auto plant = masses_and_springs(M, D, K);
  const test::TemporaryFolder folder;
  data::Record record;
  record.header.sample_rate = 125.0;
  record.header.channels = {{.name = "F/1", .unit = "N", .role = data::Role::excitation},
                            {.name = "F 3", .unit = "N", .role = data::Role::excitation},
                            {.name = "a, re 1", .unit = "m", .role = data::Role::response},
                            {.name = "x2", .unit = "m", .role = data::Role::response},
                            {.name = "x3", .unit = "m", .role = data::Role::response}};
  constexpr Eigen::Index samples = 20000, before = 2000;
  record.samples.resize(samples, 5);
  test::Random random(seed);
  test::ModalRun run(plant, 1.0 / record.header.sample_rate);
  for (Eigen::Index k = -before; k < samples; ++k) {
    const Eigen::Vector2d force(test::normal(random), test::normal(random));
    const Eigen::Vector3d disturbance =
        0.3 * Eigen::Vector3d(test::normal(random), test::normal(random), test::normal(random));
    if (k >= 0) {
      Eigen::Vector3d y = run.output();
      for (double& x : y) x += 2e-5 * test::normal(random);
      record.samples.row(k) << force.transpose(), y.transpose();
    }
    run.advance(Eigen::Vector3d(force[0], 0.0, force[1]) + disturbance);
  }
  const auto writer = data::open_record_writer(folder / "run.h5", record.header);
  writer->append(record.samples);
  writer->close();
  data::RecordSet records({folder / "run.h5"});
  return measure_responses(records, {.block_length = 512}).responses;
}

FrequencyResponses closed_loop_responses(std::uint64_t seed) {
  auto responses =
      foreign_measurement(foreign_plant(), {.excitation = Excitation::noise, .seed = seed})
          .responses;
  EXPECT_GT(responses.shift, 0.0);
  responses.on_axis = on_imaginary_axis(responses, identify_modes(responses));
  return responses;
}

FrequencyResponses through_a_file(const FrequencyResponses& responses, const std::string& ending) {
  const test::TemporaryFolder folder;
  const std::string path = folder / ("frf." + ending);
  if (ending == "csv")
    test::write_text(path, data::response_table(responses));
  else if (ending == "mat")
    data::write_mat_variables(path, data::response_arrays(responses));
  else if (ending == "h5")
    data::write_hdf5_variables(path, data::response_arrays(responses));
  else
    data::write_frequency_responses(path, responses, ending == "uff");
  auto read = data::read_frequency_responses(path);
  EXPECT_THAT(read.notes, testing::IsEmpty());
  return std::move(read.responses);
}

struct Export {
  const char* ending;
  double tolerance;  ///< relative, of what a file of this kind keeps of its numbers
  double misfit;     ///< the same of the sum of squares, whose smallness shows every rounding
};

void expect_same_modes(const Identification& a, const Identification& b, const Export& file) {
  const double tolerance = file.tolerance;
  ASSERT_GE(a.modes.size(), 3U);
  ASSERT_EQ(a.modes.size(), b.modes.size());
  for (std::size_t r = 0; r < a.modes.size(); ++r) {
    const auto &sent = a.modes[r].fit, &got = b.modes[r].fit;
    EXPECT_NEAR(got.omega(), sent.omega(), tolerance * sent.omega());
    EXPECT_NEAR(got.damping_ratio(), sent.damping_ratio(), tolerance * sent.damping_ratio());
    EXPECT_NEAR(got.omega_deviation, sent.omega_deviation, tolerance * sent.omega_deviation);
    EXPECT_NEAR(got.damping_deviation, sent.damping_deviation, tolerance * sent.damping_deviation);
    EXPECT_LT((got.shape_deviation - sent.shape_deviation).norm(),
              tolerance * sent.shape_deviation.norm());
    EXPECT_LT((b.modes[r].displacement - a.modes[r].displacement).norm(),
              tolerance * a.modes[r].displacement.norm());
  }
  EXPECT_NEAR(b.model.misfit, a.model.misfit, file.misfit * a.model.misfit);
  EXPECT_EQ(b.unexplained.size(), a.unexplained.size());
  EXPECT_EQ(b.warnings.size(), a.warnings.size());
  EXPECT_EQ(b.errors_assumed, a.errors_assumed);
}

class Exported : public testing::TestWithParam<Export> {};

TEST_P(Exported, ResponsesOfAnOpenLoopGiveTheSameModes) {
  for (const std::uint64_t seed : {3U, 4U}) {
    const auto responses = open_loop_responses(seed);
    ASSERT_GT(responses.taper.size(), 0);
    ASSERT_GT(responses.line_covariance.size(), 1U);
    expect_same_modes(identify_modes(responses),
                      identify_modes(through_a_file(responses, GetParam().ending)), GetParam());
  }
}

TEST_P(Exported, ResponsesOfAClosedLoopGiveTheSameModes) {
  const auto responses = closed_loop_responses(5);
  expect_same_modes(identify_modes(responses),
                    identify_modes(through_a_file(responses, GetParam().ending)), GetParam());
}

/// What is known of the measurement holds for the file too, and lowers the quality of its modes.
TEST_P(Exported, WarningsStayWithTheResponses) {
  using Kind = data::ResponseWarning::Kind;
  auto responses = open_loop_responses(3);
  responses.warnings = {{.kind = Kind::sensor_changed,
                         .channel = "a, re 1",
                         .other = "p \"2\".csv",
                         .value = -1.25,
                         .count = 1,
                         .total = 3},
                        {.kind = Kind::biased,
                         .value = 0.125,
                         .share = 0.375,
                         .lowest = 1.5,
                         .highest = 2.75,
                         .estimator = Estimator::hv},
                        {.kind = Kind::cut_sweep, .value = 20.5, .count = 2, .total = 6}};
  const auto read = through_a_file(responses, GetParam().ending);
  ASSERT_EQ(read.warnings.size(), responses.warnings.size());
  for (std::size_t k = 0; k < read.warnings.size(); ++k) {
    const auto &sent = responses.warnings[k], &got = read.warnings[k];
    EXPECT_EQ(got.kind, sent.kind);
    EXPECT_EQ(got.channel, sent.channel);
    EXPECT_EQ(got.other, sent.other);
    EXPECT_EQ(std::vector({got.value, got.share, got.lowest, got.highest}),
              std::vector({sent.value, sent.share, sent.lowest, sent.highest}));
    EXPECT_EQ(got.count, sent.count);
    EXPECT_EQ(got.total, sent.total);
    EXPECT_EQ(got.estimator, sent.estimator);
  }
  for (const auto& mode : identify_modes(read).modes) EXPECT_LE(mode.quality(), 0.3);
}

// the fit ends where the sum of squares falls by 1e-9 of itself; 58 has 13 digits, but 6 for the
// distance of the lines
INSTANTIATE_TEST_SUITE_P(Formats, Exported,
                         testing::Values(Export{"uff", 1e-6, 1e-6}, Export{"csv", 1e-6, 1e-6},
                                         Export{"mat", 1e-6, 1e-6}, Export{"h5", 1e-6, 1e-6},
                                         Export{"unv", 1e-5, 1e-3}),
                         [](const auto& format) { return std::string(format.param.ending); });

/// H(iω) in the file is what other programs take for the machine's response.
TEST(ExportedResponses, OfAClosedLoopAreThoseOfThePlantOnTheAxis) {
  const auto responses = closed_loop_responses(6);
  const auto plant = foreign_plant();
  const auto shown = data::brought_to_axis(through_a_file(responses, "uff"));
  EXPECT_EQ(shown.shift, 0.0);
  double error = 0.0, size = 0.0;
  for (std::size_t k = 0; k < shown.lines(); ++k) {
    if (shown.frequency[k] < 4.0 || shown.frequency[k] > 14.0) continue;
    const Eigen::MatrixXcd truth = plant.sampled_response(shown.frequency[k], 1.0 / foreign_rate);
    error += (shown.H[k] - truth).squaredNorm();
    size += truth.squaredNorm();
  }
  EXPECT_LT(std::sqrt(error / size), 0.1);
}

/// What another program left of a file: without hydrapod's own parts it is read as any other.
TEST(ExportedResponses, WithoutTheDescriptionAreOnTheAxis) {
  const auto responses = closed_loop_responses(7);
  const test::TemporaryFolder folder;
  std::string bare;
  const std::string table = data::response_table(responses);
  for (std::size_t begin = 0; begin < table.size();) {
    const std::size_t end = table.find('\n', begin) + 1;
    if (table[begin] != '#') bare += table.substr(begin, end - begin);
    begin = end;
  }
  test::write_text(folder / "bare.csv", bare);
  const auto read = data::read_frequency_responses(folder / "bare.csv").responses;
  EXPECT_EQ(read.shift, 0.0);
  ASSERT_EQ(read.outputs.size(), 3U);
  ASSERT_EQ(read.inputs.size(), 3U);
  ASSERT_EQ(read.lines(), responses.lines());
  EXPECT_EQ(read.H[40], responses.on_axis[40]);
}

TEST(ExportedResponses, BesideTheAxisAloneAreRefused) {
  auto responses = closed_loop_responses(8);
  responses.on_axis.clear();
  const test::TemporaryFolder folder;
  EXPECT_THROW(data::response_table(responses), std::invalid_argument);
  EXPECT_THROW(data::write_frequency_responses(folder / "h.uff", responses), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::identification
