/// Hammers that rove from point to point: what is said where their records are not combined.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "hammer.hpp"
#include "hydrapod/identification/identify.hpp"
#include "lines_with_errors.hpp"

namespace hydrapod::identification {
namespace {

std::string refusal_of(const std::vector<data::Record>& records) {
  try {
    measured(records);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// A channel for the force at each of three points.
data::Record at_point(Eigen::Index point, std::uint64_t seed) {
  const auto hit = hammer_record({.noise = 1e-3, .point = point}, seed);
  test::Random random(seed + 1000);
  data::Record record{.header = test::header_of(3, 3, hammer_rate), .samples = {}};
  record.samples.resize(hit.samples.rows(), 6);
  for (double& u : record.samples.leftCols(3).reshaped()) u = 0.4 * test::normal(random);
  record.samples.col(point) = hit.samples.col(0);
  record.samples.rightCols(3) = hit.samples.rightCols(3);
  return record;
}

TEST(Roving, OneRecordPerPointIsNotCombinedAndThatIsSaid) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal_of({at_point(0, 81), at_point(1, 82), at_point(2, 83), at_point(2, 84)}),
              AllOf(HasSubstr("a hammer test that roves: u1 is hit in run0.h5, u2 in run1.h5"),
                    HasSubstr("--inputs \"u1\" for run0.h5")));
  EXPECT_THAT(refusal_of({at_point(1, 85), at_point(1, 86)}),
              HasSubstr("of the inputs u2 alone is hit, and the others hold noise: take --inputs"));
  auto other = at_point(1, 87);
  other.header.channels[1].name = "u7";
  EXPECT_THAT(refusal_of({at_point(1, 88), other}),
              HasSubstr("identify each record by itself, or give the responses"));
}

/// Five outputs; those from `from` on belong to a machine whose frequencies are `factor` times
/// those of the rest.
FrequencyResponses in_two_set_ups(Eigen::Index inputs, double factor, Eigen::Index from) {
  Eigen::MatrixXd shapes(4, 5);
  shapes << 0.31, 0.67, 0.94, 1.0, 0.58,  //
      0.72, 0.95, 0.21, -0.66, -0.83,     //
      0.98, 0.17, -0.88, -0.24, 0.91,     //
      0.85, -0.71, -0.33, 0.97, -0.62;
  constexpr std::array frequencies{8.13, 15.7, 23.9, 31.3};
  const auto machine = [&](double factor_of_all) {
    test::ModalSystem system;
    for (int k = 0; k < 4; ++k) {
      auto mode = test::real_mode(factor_of_all * frequencies[static_cast<std::size_t>(k)], 0.0113,
                                  shapes.row(k));
      mode.participation = mode.participation.head(inputs).eval();
      system.modes.push_back(mode);
    }
    return system;
  };
  const auto one = machine(1.0), other = machine(factor);
  test::Random random(20261207);
  FrequencyResponses r;
  const auto header = test::header_of(inputs, 5, 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + inputs);
  r.outputs.assign(header.channels.begin() + inputs, header.channels.end());
  for (double f = 4.1; f < 39.0; f += 0.0737) {
    Eigen::MatrixXcd H = one.response(f);
    H.bottomRows(5 - from) = other.response(f).bottomRows(5 - from);
    add_line_with_errors(f, H, 0.01, random, r);
  }
  return r;
}

const ModeWarning* named_set_ups(const Identification& found) {
  const auto at = std::ranges::find(found.warnings, ModeWarning::Kind::set_ups, &ModeWarning::kind);
  return at == found.warnings.end() ? nullptr : &*at;
}

double best_quality(const Identification& found) {
  double best = 0.0;
  for (const auto& mode : found.modes) best = std::max(best, mode.quality());
  return best;
}

TEST(SetUps, OfWhichOneHadOtherFrequenciesAreNamed) {
  for (const Eigen::Index inputs : {1, 2})
    for (const double factor : {0.9913, 0.9971}) {
      const auto found = identify_modes(in_two_set_ups(inputs, factor, 2));
      const auto* warning = named_set_ups(found);
      ASSERT_NE(warning, nullptr) << inputs << " inputs, " << factor;
      EXPECT_GE(warning->count, 6);  // of pairs that are nearer than their width some are not found
      EXPECT_EQ(warning->value, 3.0);
      EXPECT_EQ(warning->output, found.responses.outputs[2].name);
      EXPECT_NEAR(warning->from / warning->to, factor, 2e-3);
      EXPECT_LE(best_quality(found), inputs == 1 ? 0.5 : 0.3);
    }
}

TEST(SetUps, OfOneMachineAreNot) {
  const auto found = identify_modes(in_two_set_ups(2, 1.0, 2));
  EXPECT_EQ(named_set_ups(found), nullptr);
  EXPECT_EQ(found.modes.size(), 4U);
  EXPECT_GT(best_quality(found), 0.9);
}

/// Two columns of a mast that is a little stiffer in y: pairs that move outputs of one direction
/// each, and inputs in both directions drive one of each pair.
TEST(SetUps, AreNotSeenInTwoDirections) {
  for (const bool stated : {false, true}) {
    const auto x = in_two_set_ups(1, 1.0, 0), y = in_two_set_ups(1, 1.0079, 0);
    const int inputs = stated ? 1 : 2;
    FrequencyResponses both;
    both.inputs.resize(static_cast<std::size_t>(inputs), x.inputs.front());
    both.inputs.back().name = "other";
    for (int d = 0; d < 2; ++d)
      for (std::size_t k = 0; k < 3; ++k) {
        both.outputs.push_back(x.outputs[k]);
        both.outputs.back().name += d == 0 ? "x" : "y";
        if (stated)
          both.outputs.back().direction = d == 0 ? data::Direction::x : data::Direction::minus_y;
      }
    test::Random random(20261208);
    for (std::size_t line = 0; line < x.lines(); ++line) {
      Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(6, inputs);
      H.topLeftCorner(3, 1) = x.H[line].topRows(3);
      H.bottomRightCorner(3, 1) = y.H[line].topRows(3);
      add_line_with_errors(x.frequency[line], H, 0.01, random, both);
    }
    const auto found = identify_modes(both);
    EXPECT_EQ(found.modes.size(), 8U);
    EXPECT_EQ(named_set_ups(found), nullptr) << stated;
  }
}

}  // namespace
}  // namespace hydrapod::identification
