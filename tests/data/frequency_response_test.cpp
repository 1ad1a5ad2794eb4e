/// Frequency responses through Universal Files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/data/frequency_response.hpp"
#include "said.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"
#include "uff_reference.hpp"

namespace hydrapod::test {
namespace {

using data::Direction;
using data::Role;

data::FrequencyResponses example(bool even) {
  data::FrequencyResponses all;
  all.title = "Platform";
  all.date = "2026-11-20T10:00:00";
  all.inputs = {{"force x", "N", Direction::x, Role::excitation, 1},
                {"valve 3", "1", Direction::leg3, Role::excitation, 3}};
  all.outputs = {{"acceleration x, at the front edge", "m/s^2", Direction::x, Role::response, 7},
                 {"tilt", "rad", Direction::minus_ry, Role::response, 7},
                 {"length 3", "m", Direction::leg3, Role::response, 3}};
  all.frequency.resize(23);
  for (std::size_t k = 0; k < 23; ++k)
    all.frequency[k] = even ? 0.5 + 0.25 * static_cast<double>(k) : std::pow(1.3, k);
  Random random(12);
  for (std::size_t k = 0; k < 23; ++k) {
    const auto positive = [&] { return std::complex<double>(random.uniform(1e-5, 1e-3)); };
    all.H.push_back(Eigen::MatrixXcd::NullaryExpr(3, 2, [&] {
      return std::complex<double>(random.uniform(-1.0, 1.0), random.uniform(-1e-6, 1e-6));
    }));
    all.noise.emplace_back(Eigen::VectorXcd::NullaryExpr(3, positive).asDiagonal());
    all.input_factor.emplace_back(Eigen::VectorXcd::NullaryExpr(2, positive).asDiagonal());
    all.multiple_coherence.push_back(
        Eigen::VectorXd::NullaryExpr(3, [&] { return random.uniform(); }));
  }
  return all;
}

void expect_same_channels(const std::vector<data::Channel>& a,
                          const std::vector<data::Channel>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t c = 0; c < a.size(); ++c) {
    EXPECT_EQ(a[c].name, b[c].name);
    EXPECT_EQ(a[c].unit, b[c].unit);
    EXPECT_EQ(a[c].direction, b[c].direction);
    EXPECT_EQ(a[c].role, b[c].role);
    EXPECT_EQ(a[c].point, b[c].point);
  }
}

struct Way {
  bool even, binary;
};
class ResponseFile : public testing::TestWithParam<Way> {};

TEST_P(ResponseFile, GoesThereAndBack) {
  const TemporaryFolder folder;
  const auto sent = example(GetParam().even);
  data::write_frequency_responses(folder / "h.uff", sent, GetParam().binary);
  const auto [got, notes] = data::read_frequency_responses(folder / "h.uff");
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_EQ(got.title, sent.title);
  EXPECT_EQ(got.date, sent.date);
  expect_same_channels(got.outputs, sent.outputs);
  expect_same_channels(got.inputs, sent.inputs);
  const double value = GetParam().binary ? 0.0 : 5.1e-13;
  // even frequencies of few digits and binary ones are exact, others have six digits
  const double abscissa = GetParam().even || GetParam().binary ? 0.0 : 5.1e-6;
  ASSERT_EQ(got.frequency.size(), sent.frequency.size());
  for (std::size_t k = 0; k < 23; ++k) {
    EXPECT_NEAR(got.frequency[k], sent.frequency[k], abscissa * sent.frequency[k]);
    EXPECT_LE((got.H[k] - sent.H[k]).cwiseAbs().maxCoeff(), value);
    for (int o = 0; o < 3; ++o)
      for (int i = 0; i < 2; ++i)  // a product of a mean and a share, which round
        EXPECT_NEAR(got.variance(k, o, i), sent.variance(k, o, i),
                    value + 1e-14 * sent.variance(k, o, i));
    EXPECT_LE((got.multiple_coherence[k] - sent.multiple_coherence[k]).cwiseAbs().maxCoeff(),
              value);
  }
}

TEST_P(ResponseFile, IsReadByTheReaderThatTakesColumnsLiterally) {
  const TemporaryFolder folder;
  const auto sent = example(GetParam().even);
  data::write_frequency_responses(folder / "h.uff", sent, GetParam().binary);
  const uff::File file = uff::Reader(read_text(folder / "h.uff")).read();
  std::size_t responses = 0;
  for (const auto& f : file.functions) {
    if (f.type != 4) continue;
    const auto o = static_cast<Eigen::Index>(responses / 2),
               i = static_cast<Eigen::Index>(responses % 2);
    EXPECT_EQ(f.data_type, 6);     // complex, double precision
    EXPECT_EQ(f.quantity[0], 18);  // frequency
    EXPECT_EQ(f.response_node, sent.outputs[static_cast<std::size_t>(o)].point);
    EXPECT_EQ(f.unit[2], sent.inputs[static_cast<std::size_t>(i)].unit);
    const std::size_t tuple = f.spacing == 1 ? 2 : 3;
    for (std::size_t k = 0; k < 23; ++k) {
      const std::complex<double> value(f.values[tuple * k + tuple - 2],
                                       f.values[tuple * k + tuple - 1]);
      EXPECT_LE(std::abs(value - sent.H[k](o, i)), 1e-12);
    }
    ++responses;
  }
  EXPECT_EQ(responses, 6U);
}

/// With everything that identification needs: errors that go together, window, and a shift.
data::FrequencyResponses described_example() {
  auto all = example(false);
  Random random(29);
  const auto covariance = [&](Eigen::Index size) {
    const Eigen::MatrixXcd A = Eigen::MatrixXcd::NullaryExpr(size, size, [&] {
      return std::complex<double>(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    });
    return Eigen::MatrixXcd(A * A.adjoint());
  };
  for (std::size_t k = 0; k < all.lines(); ++k) {
    all.noise[k] = covariance(3);
    all.input_factor[k] = covariance(2);
    all.on_axis.push_back(all.H[k] + Eigen::MatrixXcd::Constant(3, 2, {0.25, 0.125}));
  }
  all.estimator = data::Estimator::instrumental;
  all.averages = 17.25;
  all.degrees = 13.5;
  all.shift = 1.0 / 3.0;
  all.line_covariance = {1.0, {0.6, -0.3}, {0.1, 0.05}};
  all.taper = Eigen::VectorXd::LinSpaced(80, 1.0, 1.0 / 7.0);
  all.leakage = {.rate = 1.0 / 3.0, .line_covariance = {0.79, -1.0 / 7.0}, .relation = {0.3, 0.1}};
  all.sample_rate = 62.5;
  for (std::size_t k = 0; k < all.lines(); ++k)  // lines of the window, with a gap
    all.frequency[k] = 62.5 / 80.0 * static_cast<double>(k > 10 ? k + 3 : k + 1);
  all.outputs[0].name += std::string(90, 'x');  // longer than a line of a Universal File
  all.inputs[1].role = Role::drive;
  return all;
}

class DescribedResponses : public testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] std::string written(const data::FrequencyResponses& all) const {
    const std::string path = folder_ / (std::string("h.") + GetParam());
    if (path.ends_with(".csv"))
      write_text(path, data::response_table(all));
    else if (path.ends_with(".mat"))
      data::write_mat_variables(path, data::response_arrays(all));
    else if (path.ends_with(".h5"))
      data::write_hdf5_variables(path, data::response_arrays(all));
    else
      data::write_frequency_responses(path, all);
    return path;
  }

  /// MAT files have two bytes per character.
  static std::string as_in_file(const std::string& text) {
    if (GetParam() != std::string("mat")) return text;
    std::string wide;
    for (const char c : text) wide.append({c, '\0'});
    return wide;
  }

 private:
  TemporaryFolder folder_;
};

TEST_P(DescribedResponses, AreReadAsTheyWere) {
  const auto sent = described_example();
  const auto [got, notes] = data::read_frequency_responses(written(sent));
  EXPECT_THAT(notes, testing::IsEmpty());
  data::validate(got);
  EXPECT_EQ(got.title, sent.title);
  expect_same_channels(got.outputs, sent.outputs);
  expect_same_channels(got.inputs, sent.inputs);
  EXPECT_EQ(got.frequency, sent.frequency);
  EXPECT_EQ(got.H, sent.H);
  EXPECT_EQ(got.on_axis, sent.on_axis);
  EXPECT_EQ(got.noise, sent.noise);
  EXPECT_EQ(got.input_factor, sent.input_factor);
  EXPECT_EQ(got.line_covariance, sent.line_covariance);
  EXPECT_EQ(got.taper, sent.taper);
  EXPECT_EQ(got.leakage.rate, sent.leakage.rate);
  EXPECT_EQ(got.leakage.line_covariance, sent.leakage.line_covariance);
  EXPECT_EQ(got.leakage.relation, sent.leakage.relation);
  EXPECT_EQ(got.sample_rate, sent.sample_rate);
  EXPECT_EQ(got.shift, sent.shift);
  EXPECT_EQ(got.estimator, sent.estimator);
  EXPECT_EQ(got.averages, sent.averages);
  EXPECT_EQ(got.degrees, sent.degrees);
}

/// What cannot be a correlation is not believed: the rest is read with a note.
TEST_P(DescribedResponses, ThatAreDamagedAreLeftAsideWithANote) {
  const auto sent = described_example();
  const std::string path = written(sent);
  const std::string good = read_text(path);
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"\"re\":[1.0", "\"re\":[7.0"},
                                 {"\"taper\":[1.0", "\"taper\":[1e9"},
                                 {"\"sample_rate_hz\":62.5", "\"sample_rate_hz\":-2.5"},
                                 {"\"estimator\":\"iv\"", "\"estimator\":\"hx\""},
                                 {"\"relation\":[0.3", "\"relation\":[9.3"},
                                 {"\"outputs\":3", "\"outputs\":5"},
                                 {"\"line_covariance\":{", "\"line_covariance\" {"}}) {
    SCOPED_TRACE(to);
    std::string bad = good;
    const std::string found = as_in_file(from);
    ASSERT_NE(bad.find(found), bad.npos);
    bad.replace(bad.find(found), found.size(), as_in_file(to));
    write_text(path, bad);
    const auto [got, notes] = data::read_frequency_responses(path);
    ASSERT_FALSE(notes.empty());
    EXPECT_THAT(notes[0].message, testing::HasSubstr("damaged and left aside"));
    EXPECT_EQ(got.H, sent.on_axis);
    EXPECT_EQ(got.shift, 0.0);
    EXPECT_EQ(got.line_covariance.size(), 1U);
    EXPECT_EQ(got.taper.size(), 0);
  }
}

TEST_P(DescribedResponses, AtOtherFrequenciesThanTheWindowsHaveNoTaper) {
  auto sent = described_example();
  sent.frequency.back() += 0.3;
  const auto [got, notes] = data::read_frequency_responses(written(sent));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0].message, testing::HasSubstr("not lines of the window"));
  EXPECT_EQ(got.taper.size(), 0);
  EXPECT_EQ(got.frequency, sent.frequency);
}

INSTANTIATE_TEST_SUITE_P(Formats, DescribedResponses, testing::Values("uff", "csv", "mat", "h5"),
                         [](const auto& format) { return std::string(format.param); });

INSTANTIATE_TEST_SUITE_P(Ways, ResponseFile,
                         testing::Values(Way{true, true}, Way{true, false}, Way{false, true},
                                         Way{false, false}),
                         [](const auto& way) {
                           return std::string(way.param.even ? "even" : "uneven") +
                                  (way.param.binary ? "_binary" : "_ascii");
                         });

/// var H_oi = N_oo F_ii, where cov(vec H) = F ⊗ N.
TEST(FrequencyResponse, VarianceIsTheProductOfBothDiagonals) {
  data::FrequencyResponses responses;
  Eigen::Matrix2cd noise, factor;
  noise << 0.3, std::complex(0.1, 0.2), std::complex(0.1, -0.2), 1.7;
  factor << 0.09, std::complex(0.01, -0.02), std::complex(0.01, 0.02), 2.56;
  responses.noise = {noise};
  responses.input_factor = {factor};
  EXPECT_DOUBLE_EQ(responses.variance(0, 1, 0), 1.7 * 0.09);
  EXPECT_DOUBLE_EQ(responses.variance(0, 0, 1), 0.3 * 2.56);
}

TEST(ResponseFiles, OfARecordIsRefusedWithAReason) {
  const TemporaryFolder folder;
  write_text(folder / "h.uff", "    -1\n   151\nNONE\nNONE\nNONE\n    -1\n");
  EXPECT_EQ(refusal_of([&] { data::read_frequency_responses(folder / "h.uff"); }).message,
            "the Universal File holds no frequency response that can be read");
}

}  // namespace
}  // namespace hydrapod::test
