/// Every number of the JSON of measured results is the number of its field: all fields have
/// different values.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/json_numbers.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;
using report::Json;
using Complex = std::complex<double>;
constexpr double band = numerics::normal_half_width;

data::Channel channel(const char* name, int point) {
  return {.name = name, .unit = "m", .point = point};
}

/// Two outputs, three inputs, two lines.
identification::FrequencyResponses responses() {
  identification::FrequencyResponses r;
  r.outputs = {channel("a", 11), channel("b", 12)};
  r.inputs = {channel("p", 21), channel("q", 22), channel("r", 23)};
  r.frequency = {1.25, 2.5};
  r.averages = 37.0;
  r.degrees = 34.0;
  r.condition = {1.7, 1.9};
  r.line_covariance = {1.0, Complex(0.43, -0.11)};
  r.taper = Eigen::Vector3d(1.0, 0.6, 0.2);
  r.leakage = {.rate = 0.37, .line_covariance = {0.79, -0.13}, .relation = {0.26, -0.19}};
  r.sample_rate = 128.0;
  for (int k = 0; k < 2; ++k) {
    const double line = 0.001 * k;
    Eigen::MatrixXcd H(2, 3), noise(2, 2), factor(3, 3);
    Eigen::MatrixXd coherence(2, 3);
    for (int o = 0; o < 2; ++o)
      for (int i = 0; i < 3; ++i) {
        H(o, i) = {1.0 + 0.1 * o + 0.01 * i + line, -2.0 - 0.1 * o - 0.01 * i - line};
        coherence(o, i) = 0.5 + 0.1 * o + 0.01 * i + line;
      }
    for (int o = 0; o < 2; ++o)
      for (int p = 0; p < 2; ++p) noise(o, p) = {3.0 + 0.1 * o + 0.01 * p + line, 0.3 * (o - p)};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) factor(i, j) = {5.0 + 0.1 * i + 0.01 * j + line, 0.7 * (i - j)};
    r.H.push_back(H);
    r.noise.push_back(noise);
    r.input_factor.push_back(factor);
    r.coherence.push_back(coherence);
    r.multiple_coherence.push_back(Eigen::Vector2d(0.91 + line, 0.81 + line));
  }
  r.warnings = {{.kind = data::ResponseWarning::Kind::clipped,
                 .channel = "a",
                 .value = 0.11,
                 .share = 0.12,
                 .lowest = -0.13,
                 .highest = 0.14,
                 .count = 15,
                 .total = 16}};
  return r;
}

/// `numbers(k)` of both lines.
template <class Numbers>
Json lines(const Numbers& numbers) {
  return Json::array({numbers(0), numbers(1)});
}

Json matrices(const data::PerLine<Eigen::MatrixXcd>& all) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < all[0].rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < all[0].cols(); ++j)
      row.push_back({{"re", lines([&](std::size_t k) { return all[k](i, j).real(); })},
                     {"im", lines([&](std::size_t k) { return all[k](i, j).imag(); })}});
    rows.push_back(row);
  }
  return rows;
}

Json responses_object() {
  const auto r = responses();
  Json response = matrices(r.H);
  for (std::size_t o = 0; o < 2; ++o)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<int>(o), column = static_cast<int>(i);
      response[o][i]["deviation"] = lines([&](std::size_t k) {
        return std::sqrt((3.0 + 0.11 * row + 0.001 * k) * (5.0 + 0.11 * column + 0.001 * k));
      });
      response[o][i]["coherence"] =
          lines([&](std::size_t k) { return 0.5 + 0.1 * row + 0.01 * column + 0.001 * k; });
    }
  return {
      {"inputs", {{{"point", 21}}, {{"point", 22}}, {{"point", 23}}}},
      {"outputs", {{{"point", 11}}, {{"point", 12}}}},
      {"averages", 37.0},
      {"degrees_of_freedom", 34.0},
      {"frequency_hz", {1.25, 2.5}},
      {"response", response},
      {"multiple_coherence", {{0.91, 0.911}, {0.81, 0.811}}},
      {"condition", {1.7, 1.9}},
      {"noise", matrices(r.noise)},
      {"input_factor", matrices(r.input_factor)},
      {"line_covariance", {{"re", {1.0, 0.43}}, {"im", {0.0, -0.11}}}},
      {"sample_rate_hz", 128.0},
      {"taper", {1.0, 0.6, 0.2}},
      {"leakage",
       {{"rate_per_s2", 0.37}, {"line_covariance", {0.79, -0.13}}, {"relation", {0.26, -0.19}}}},
      {"findings", Json::array({{{"value", 0.11},
                                 {"share", 0.12},
                                 {"lowest", -0.13},
                                 {"highest", 0.14},
                                 {"count", 15},
                                 {"total", 16}}})}};
}

TEST(NumbersInJson, OfResponses) {
  expect_numbers(report::responses_json(responses()), responses_object());
}

TEST(NumbersInJson, OfResponsesBesideTheAxis) {
  auto r = responses();
  r.shift = 0.77;
  r.on_axis = r.H;
  for (auto& H : r.on_axis) H *= 1.5;
  Json expected = responses_object();
  for (auto& row : expected["response"])
    for (auto& entry : row)
      for (const char* part : {"re", "im"})
        for (auto& number : entry[part]) number = 1.5 * number.get<double>();
  expected["beside_axis"] = {{"shift_per_s", 0.77}, {"response", matrices(r.H)}};
  expect_numbers(report::responses_json(r), expected);
}

Eigen::Vector2cd two(double first) {
  return {Complex(first, -first - 0.3), Complex(first + 0.1, first + 0.2)};
}
Json two_json(double first) {
  return {{"re", {first, first + 0.1}}, {"im", {-first - 0.3, first + 0.2}}};
}

/// ζ/(4 σ) of a damping ratio of 0.6 whose 95 % interval is ± 1.04.
constexpr double certain = 0.6 / (4.0 * 1.04 / 1.959963984540054);

/// A fitted mode at `hertz` with the damping ratio 0.6: its pole has plain numbers.
identification::FittedMode fitted(double hertz, double first) {
  identification::FittedMode mode;
  mode.pole = two_pi * hertz * Complex(-0.6, 0.8);
  mode.shape = two(first + 0.01);
  mode.participation = two(first + 0.02);
  mode.omega_deviation = two_pi * (first + 0.03) / band;
  mode.damping_deviation = (first + 0.04) / band;
  mode.shape_deviation = Eigen::Vector2d(first + 0.05, first + 0.06);
  mode.significance = first + 0.07;
  return mode;
}

Json fitted_json(double hertz, double first) {
  return {{"frequency_hz", hertz},
          {"frequency_95_hz", first + 0.03},
          {"damping_ratio", 0.6},
          {"damping_95", first + 0.04},
          {"pole", {{"re", -0.6 * two_pi * hertz}, {"im", 0.8 * two_pi * hertz}}},
          {"shape", two_json(first + 0.01)},
          {"shape_deviation", {first + 0.05, first + 0.06}},
          {"participation", two_json(first + 0.02)},
          {"significance", first + 0.07}};
}

identification::Identification identified() {
  identification::Identification found;
  found.responses = responses();
  found.responses.harmonics = {{.frequency = 49.7, .amplitude = Eigen::Vector2d(0.31, 0.32)}};
  found.from = 0.7;
  found.to = 8.3;
  found.model.error = 0.057;
  found.model.misfit = 1.093;
  found.model.omega_scale = 52.1;
  found.model.residuals = {Eigen::MatrixXd{{1.1, 1.2, 1.3}, {1.4, 1.5, 1.6}}};
  found.errors_assumed = true;
  found.needed_duration = 731.5;
  identification::IdentifiedMode mode{.fit = fitted(2.5, 1.0)};
  mode.displacement = two(7.1);
  mode.repeated = 2;
  mode.persistence = 0.91;
  mode.vector_consistency = 0.92;
  mode.mpc = 0.93;
  mode.mpd = 0.094;
  mode.explained = 0.95;
  mode.steadiness = 0.96;
  found.modes = {mode};
  found.heavily_damped = {fitted(3.5, 2.0)};
  found.model.modes = {fitted(3.5, 2.0), fitted(2.5, 1.0)};
  found.left_out = {{.pole = {-1.3, 4.4}, .reason = identification::Objection::open_damping}};
  found.unexplained = {{.output = 1,
                        .input = 2,
                        .from = 1.1,
                        .to = 1.2,
                        .level = 5.3,
                        .smooth = 0.34,
                        .share = 0.035}};
  found.warnings = {{.kind = identification::ModeWarning::Kind::unexplained,
                     .value = 4.1,
                     .from = 1.3,
                     .to = 1.4,
                     .smooth = 0.45,
                     .share = 0.46,
                     .count = 47,
                     .total = 48}};
  identification::PoleEstimate below, above;
  below.pole = two_pi * 2.4 * Complex(-0.28, 0.96);
  above.pole = two_pi * 6.0 * Complex(0.28, 0.96);  // grows
  for (auto* e : {&below, &above}) {
    e->shape = two(1.0);
    e->participation = two(2.0);
  }
  found.chart = {{.order = 4, .poles = {below}}, {.order = 6, .poles = {below, above}}};
  identification::PoleCluster cluster{.representative = below, .members = {{0, 0}, {1, 0}}};
  cluster.persistence = 0.71;
  cluster.frequency_scatter = 0.072;
  cluster.damping_scatter = 0.073;
  cluster.vector_consistency = 0.74;
  found.clusters = {cluster,
                    {.persistence = 0.61,
                     .frequency_scatter = 0.062,
                     .damping_scatter = 0.063,
                     .vector_consistency = 0.64}};
  return found;
}

TEST(NumbersInJson, OfAnIdentification) {
  const auto found = identified();
  Json json = report::identification_json(found);
  // a matrix of squares of singular values, which others compute as well
  const Json indicator = json["indicator"];
  json.erase("indicator");
  Json mode = fitted_json(2.5, 1.0);
  mode.update({{"displacement_shape", two_json(7.1)},
               {"repeated", 2},
               {"mpc", 0.93},
               {"mpd_rad", 0.094},
               {"persistence", 0.91},
               {"vector_consistency", 0.92},
               {"explained", 0.95},
               {"steadiness", 0.96},
               {"quality", 0.91 * 0.92 * 0.95 * 0.96 * certain}});
  const auto pole = [](double hertz, double ratio, bool stable, const Json& cluster) {
    return Json{{"frequency_hz", hertz},
                {"damping_ratio", ratio},
                {"stable", stable},
                {"cluster", cluster}};
  };
  expect_numbers(
      json,
      {{"inputs", {{{"point", 21}}, {{"point", 22}}, {{"point", 23}}}},
       {"outputs", {{{"point", 11}}, {{"point", 12}}}},
       {"band_hz", {0.7, 8.3}},
       {"modes", Json::array({mode})},
       {"heavily_damped", Json::array({fitted_json(3.5, 2.0)})},
       {"harmonics", Json::array({{{"frequency_hz", 49.7}, {"amplitude", {0.31, 0.32}}}})},
       {"rejected", Json::array({{{"pole", {{"re", -1.3}, {"im", 4.4}}}}})},
       {"fit_error", 0.057},
       {"misfit", 1.093},
       {"errors_assumed", true},
       {"needed_duration_s", 731.5},
       {"unexplained", Json::array({{{"output", 2},
                                     {"input", 3},
                                     {"band_hz", {1.1, 1.2}},
                                     {"level", 5.3},
                                     {"smooth", 0.34},
                                     {"share", 0.035}}})},
       {"findings", Json::array({{{"value", 0.11},
                                  {"share", 0.12},
                                  {"lowest", -0.13},
                                  {"highest", 0.14},
                                  {"count", 15},
                                  {"total", 16}},
                                 {{"value", 4.1},
                                  {"from_hz", 1.3},
                                  {"to_hz", 1.4},
                                  {"smooth", 0.45},
                                  {"share", 0.46},
                                  {"count", 47},
                                  {"total", 48}}})},
       {"mac", Json::array({Json::array({1.0})})},
       {"residuals",
        {{"omega_scale_rad_s", 52.1},
         {"terms", Json::array({Json::array({{1.1, 1.2, 1.3}, {1.4, 1.5, 1.6}})})}}},
       {"stabilisation",
        {{{"order", 4}, {"poles", Json::array({pole(2.4, 0.28, true, 1)})}},
         {{"order", 6},
          {"poles", Json::array({pole(2.4, 0.28, true, 1), pole(6.0, -0.28, false, nullptr)})}}}},
       {"clusters",
        {{{"mode", nullptr},
          {"heavily_damped", 1},
          {"orders", 2},
          {"persistence", 0.71},
          {"frequency_scatter", 0.072},
          {"damping_scatter", 0.073},
          {"vector_consistency", 0.74}},
         {{"mode", 1},
          {"heavily_damped", nullptr},
          {"orders", 0},
          {"persistence", 0.61},
          {"frequency_scatter", 0.062},
          {"damping_scatter", 0.063},
          {"vector_consistency", 0.64}}}}});
  EXPECT_EQ(json["rejected"][0]["reason"], report::words(identification::Objection::open_damping));
  EXPECT_EQ(indicator["frequency_hz"], Json({1.25, 2.5}));
  EXPECT_EQ(indicator["values"].size(), 2U);
}

TEST(NumbersInJson, OfCrossChecksAndBootstrap) {
  Json json{{"modes", {Json::object(), Json::object()}}};
  report::add_cross_checks(
      {{},
       identification::CrossCheck{
           .omega = two_pi * 2.3, .damping_ratio = 0.031, .mac = 0.97, .agrees = true}},
      json);
  report::add_bootstrap({.omega_deviation = Eigen::Vector2d(0.1, 0.2),
                         .damping_deviation = Eigen::Vector2d(0.03, 0.04),
                         .resamples = 99,
                         .groups = 24},
                        json);
  const auto scatter = [](double omega, double zeta) {
    return Json{{"frequency_95_hz", 1.959963984540054 * omega / two_pi},
                {"damping_95", 1.959963984540054 * zeta}};
  };
  expect_numbers(
      json,
      {{"modes",
        {{{"cross_check", nullptr}, {"bootstrap", scatter(0.1, 0.03)}},
         {{"cross_check",
           {{"frequency_hz", 2.3}, {"damping_ratio", 0.031}, {"mac", 0.97}, {"agrees", true}}},
          {"bootstrap", scatter(0.2, 0.04)}}}},
       {"bootstrap_resamples", 99},
       {"bootstrap_groups", 24}});
}

/// Without it, modes that were measured elsewhere would be compared with those of the neutral pose.
TEST(NumbersInCsv, OfIdentifiedModesHaveThePoseOfTheRecord) {
  const data::Experiment experiment{.pose_name = "z=100 mm, rx=3 deg",
                                    .pose = {{0.011, -0.012, 1.513, 0.052, -0.013, 0.014}}};
  const TemporaryFolder folder;
  for (const auto* stated : {&experiment, static_cast<const data::Experiment*>(nullptr)}) {
    write_text(folder / "modes.csv", report::identified_modes_csv(identified(), {}, stated));
    const auto read = report::identified_modes_from_csv(folder / "modes.csv").experiment;
    EXPECT_EQ(read.pose_name, stated != nullptr ? stated->pose_name : "");
    EXPECT_EQ(read.pose, stated != nullptr ? stated->pose : std::nullopt);
  }
}

TEST(NumbersInCsv, OfIdentifiedModesAreReadAsTheyWereWritten) {
  const auto found = identified();
  const TemporaryFolder folder;
  write_text(folder / "modes.csv",
             report::identified_modes_csv(found, observation::Observed::plant));
  const auto lines = read_text(folder / "modes.csv");
  std::istringstream row(lines.substr(lines.find('\n') + 1));
  const std::vector<double> expected{
      1,    2.5, 1.03, 0.6, 1.04, 0.93, 0.094, 0.91 * 0.92 * 0.95 * 0.96 * certain,
      1.07, 7.1, -7.4, 7.2, 7.3};
  for (std::size_t k = 0; k < expected.size(); ++k) {
    std::string cell;
    ASSERT_TRUE(std::getline(row, cell, ','));
    EXPECT_NEAR(std::stod(cell), expected[k], 1e-5 * std::abs(expected[k])) << "column " << k + 1;
  }
  const auto read = report::identified_modes_from_csv(folder / "modes.csv");
  ASSERT_EQ(read.modes.modes.size(), 1U);
  const auto& mode = read.modes.modes[0];
  EXPECT_NEAR(std::abs(mode.pole - found.modes[0].fit.pole), 0.0, 1e-12 * std::abs(mode.pole));
  EXPECT_NEAR(mode.omega_deviation, two_pi * 1.03 / band, 1e-5);
  EXPECT_NEAR(mode.damping_deviation, 1.04 / band, 1e-5);
  EXPECT_NEAR(mode.significance, 1.07, 1e-5);
  EXPECT_NEAR((mode.shape - found.modes[0].displacement).norm(), 0.0, 1e-7);
  EXPECT_EQ(read.observed, observation::Observed::plant);
}

TEST(NumbersInJson, OfARecord) {
  data::RecordHeader header{
      .channels = {channel("a", 5), channel("b", 6)}, .sample_rate = 64.0, .start = 0.5};
  header.repeat = 3;
  const TemporaryFolder folder;
  const std::string path = folder / "r.csv";
  const auto writer = data::open_record_writer(path, header);
  writer->append(data::Samples::Random(4, 2));
  writer->close(true);
  data::RecordSet record({path}, {});
  data::RecordOverview overview{.samples = 4, .duration = 0.0625};
  const auto of = [](double first) {
    return data::ChannelOverview{.samples = static_cast<std::int64_t>(100 * first),
                                 .missing = static_cast<std::int64_t>(200 * first),
                                 .infinite = static_cast<std::int64_t>(300 * first),
                                 .mean = first + 0.01,
                                 .rms = first + 0.02,
                                 .lowest = first + 0.03,
                                 .highest = first + 0.04,
                                 .peak = first + 0.05,
                                 .at_limit = static_cast<std::int64_t>(400 * first),
                                 .longest_hold = static_cast<std::int64_t>(500 * first),
                                 .constant = first > 1.5,
                                 .strongest_frequency = first + 0.06};
  };
  overview.channels = {of(1.0), of(2.0)};
  overview.spectrum = {.frequency = Eigen::Vector3d(0.0, 1.5, 3.0),
                       .density = Eigen::MatrixXd{{0.1, 0.2}, {0.3, 0.4}, {0.5, 0.6}},
                       .segments = 7};
  const auto expected = [](double first, int point) {
    return Json{{"point", point},
                {"samples", 100 * first},
                {"missing", 200 * first},
                {"infinite", 300 * first},
                {"mean", first + 0.01},
                {"rms", first + 0.02},
                {"lowest", first + 0.03},
                {"highest", first + 0.04},
                {"peak", first + 0.05},
                {"at_limit", 400 * first},
                {"longest_hold", 500 * first},
                {"constant", first > 1.5},
                {"strongest_frequency_hz", first + 0.06}};
  };
  expect_numbers(report::record_json(record, overview, true),
                 {{"repeat", 3},
                  {"sample_rate_hz", 64.0},
                  {"start_s", 0.5},
                  {"samples", 4},
                  {"duration_s", 0.0625},
                  {"channels", {expected(1.0, 5), expected(2.0, 6)}},
                  {"spectra",
                   {{"frequency_hz", {0.0, 1.5, 3.0}},
                    {"segments", 7},
                    {"density", {{0.1, 0.3, 0.5}, {0.2, 0.4, 0.6}}}}}});
}

TEST(NumbersInJson, OfAComparison) {
  report::ComparedModes compared{.labels = {"first", "second"}};
  auto& result = compared.result;
  result.model.resize(2);
  result.model[0].pole = two_pi * 2.0 * Complex(-0.6, 0.8);
  result.model[1].pole = two_pi * 3.0 * Complex(-0.28, 0.96);
  result.pairs = {{.measured = 0,
                   .model = 1,
                   .frequency_difference = 0.013,
                   .damping_difference = -0.17,
                   .mac = 0.88}};
  result.measured_left = {1};
  result.model_left = {{.model = 0, .reason = observation::Unpaired::not_seen}};
  result.mac = Eigen::MatrixXd{{0.21, 0.22}, {0.23, 0.24}};
  const auto model = [](double hertz, double re, double im) {
    return Json{{"frequency_hz", hertz},
                {"damping_ratio", -re},
                {"pole", {{"re", two_pi * hertz * re}, {"im", two_pi * hertz * im}}}};
  };
  const Json first = model(2.0, -0.6, 0.8), second = model(3.0, -0.28, 0.96);
  const Json json = report::comparison_json(compared, identified());
  expect_numbers(json, {{"pairs", Json::array({{{"mode", 1},
                                                {"model", second},
                                                {"frequency_difference_percent", 1.3},
                                                {"damping_difference_percent", -17.0},
                                                {"mac", 0.88}}})},
                        {"not_in_model", Json::array({2})},
                        {"not_measured", Json::array({first})},
                        {"model_modes", {first, second}},
                        {"cross_mac", {{0.21, 0.22}, {0.23, 0.24}}}});
  EXPECT_EQ(json["pairs"][0]["model"]["label"], "second");
  EXPECT_EQ(json["not_measured"][0]["reason"], report::words(observation::Unpaired::not_seen));
}

}  // namespace
}  // namespace hydrapod::test
