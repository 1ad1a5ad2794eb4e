/// Every number of the JSON of a model's results is the number of its field: all fields have
/// different values.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"
#include "support/json_numbers.hpp"
#include "support/symmetric_machine.hpp"

#include "report/geometry_json.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;
using report::Json;

/// A mode of the rigid model at `hertz`, whose other numbers follow from `first`.
modal::TabledMode mode(double hertz, double first, bool complex) {
  modal::TabledMode entry;
  entry.mode = {.pole = {-first, 3.0 * first},
                .omega = two_pi * hertz,
                .damping_ratio = 0.01 * first,
                .stable = false,
                .real = six(first + 0.1),
                .imaginary = complex ? dynamics::ModelVector(six(first + 0.2))
                                     : dynamics::ModelVector(dynamics::ModelVector::Zero(6)),
                .group = static_cast<int>(10.0 * first)};
  entry.energy.platform = six(first + 0.3);
  entry.energy.legs = six(first + 0.4);
  entry.energy.oil = six(first + 0.5);
  entry.energy.guide_sleeve = six(first + 0.6);
  entry.energy.piston_ring = six(first + 0.7);
  entry.energy.base_mount = first + 0.8;
  entry.energy.preload = -first - 0.9;
  return entry;
}

Json mode_json(double hertz, double first, int number, bool complex) {
  Json json{{"number", number},
            {"omega_rad_s", two_pi * hertz},
            {"frequency_hz", hertz},
            {"damping_ratio", 0.01 * first},
            {"pole", {{"re", -first}, {"im", 3.0 * first}}},
            {"stable", false},
            {"moves_platform", true},
            {"group", static_cast<int>(10.0 * first)},
            {"platform_energy", six_json(first + 0.3)},
            {"leg_energy", six_json(first + 0.4)},
            {"strain_energy",
             {{"oil", six(first + 0.5).sum()},
              {"guide_sleeve", six(first + 0.6).sum()},
              {"piston_ring", six(first + 0.7).sum()},
              {"preload", -first - 0.9},
              {"per_leg",
               {{"oil", six_json(first + 0.5)},
                {"guide_sleeve", six_json(first + 0.6)},
                {"piston_ring", six_json(first + 0.7)}}},
              {"base_mount", first + 0.8}}},
            {"shape", six_json(first + 0.1)}};
  if (complex) json["shape_imaginary"] = six_json(first + 0.2);
  return json;
}

TEST(NumbersInJson, OfModes) {
  modal::ModeTable table{.kind = dynamics::ModelKind::rigid};
  table.real.modes = {mode(1.3, 2.0, true)};
  table.real.modes[0].rigid = modal::RigidCounterpart{.mode = 1, .mac = 0.83, .shift = -0.071};
  table.rigid.modes = {mode(1.7, 4.0, false), mode(1.9, 6.0, false)};
  Json real = mode_json(1.3, 2.0, 1, true);
  real["rigid"] = {
      {"mode", 2}, {"omega_rad_s", two_pi * 1.9}, {"mac", 0.83}, {"shift_percent", -7.1}};
  expect_numbers(report::modes_json(table),
                 {{"modes", Json::array({real})},
                  {"rigid_modes", {mode_json(1.7, 4.0, 1, false), mode_json(1.9, 6.0, 2, false)}}});
}

TEST(NumbersInJson, OfMatrices) {
  modal::ModeTable table;
  for (auto [linear, first] : {std::pair{&table.real.linear, 1.0}, {&table.rigid.linear, 2.0}}) {
    linear->M = dynamics::ModelMatrix{{first + 0.1, first + 0.2}, {first + 0.3, first + 0.4}};
    linear->K = linear->M * 10.0;
    linear->C = linear->M * 100.0;
  }
  const auto matrices = [](double first) {
    const auto scaled = [&](double by) {
      return Json{{by * (first + 0.1), by * (first + 0.2)},
                  {by * (first + 0.3), by * (first + 0.4)}};
    };
    return Json{{"M", scaled(1.0)}, {"K", scaled(10.0)}, {"C", scaled(100.0)}};
  };
  Json expected = matrices(1.0);
  expected["rigid"] = matrices(2.0);
  expect_numbers(report::matrices_json(table), expected);
}

TEST(NumbersInJson, OfAssumptions) {
  auto machine = symmetric_machine();
  machine.gravity = {0.31, -0.27, -9.7};
  machine.damping.modal_ratio = 0.037;
  expect_numbers(report::assumptions_json(machine), {{"gravity_m_s2", {0.31, -0.27, -9.7}},
                                                     {"modal_ratio", 0.037},
                                                     {"modal_ratio_is_default", false}});
  machine.damping.modal_ratio.reset();
  const Json json = report::assumptions_json(machine);
  EXPECT_EQ(json["modal_ratio"], 0.02);
  EXPECT_EQ(json["modal_ratio_is_default"], true);
}

/// A response whose 36 entries are all different, at two frequencies.
std::vector<response::Matrix6c> different_responses(double first) {
  std::vector<response::Matrix6c> H(2);
  for (int k = 0; k < 2; ++k)
    for (int out = 0; out < 6; ++out)
      for (int in = 0; in < 6; ++in)
        H[static_cast<std::size_t>(k)](out, in) = {first + 0.1 * out + 0.01 * in + 0.001 * k,
                                                   -first + 0.2 * out - 0.03 * in - 0.002 * k};
  return H;
}

Json responses_object(const std::vector<response::Matrix6c>& H) {
  Json object;
  for (std::size_t out = 0; out < 6; ++out)
    for (std::size_t in = 0; in < 6; ++in) {
      const auto at = [&](std::size_t k) {
        return H[k](static_cast<int>(out), static_cast<int>(in));
      };
      object[spatial::direction_names[out]][spatial::direction_names[in]] = {
          {"re", {at(0).real(), at(1).real()}}, {"im", {at(0).imag(), at(1).imag()}}};
    }
  return object;
}

/// A curve with peaks of mode `k` of two, the second of which is the first in the table.
modal::AnalysedModel two_modes() {
  modal::AnalysedModel model;
  model.modes = {{.label = "first"}, {.label = "second"}};
  model.tabled_of_normal = {1, 0};
  return model;
}

TEST(NumbersInJson, OfBode) {
  report::Bode bode{.options = {.p_PQ = spatial::Vector3(0.11, -0.22, 0.33)},
                    .omega = {two_pi * 1.5, two_pi * 2.5},
                    .real = different_responses(1.0),
                    .rigid = different_responses(2.0)};
  bode.table.real = bode.table.rigid = two_modes();
  bode.real_peaks = {{.direction = 2,
                      .omega = two_pi * 1.6,
                      .magnitude = 0.71,
                      .prominence_db = 8.2,
                      .mode = 1,
                      .own = true}};
  bode.rigid_peaks = {
      {.direction = 4, .omega = two_pi * 1.8, .magnitude = 0.53, .prominence_db = 6.1, .mode = 0}};
  const Json json = report::bode_json(bode);
  expect_numbers(json, {{"point_m", {0.11, -0.22, 0.33}},
                        {"peaks", Json::array({{{"omega_rad_s", two_pi * 1.6},
                                                {"frequency_hz", 1.6},
                                                {"magnitude", 0.71},
                                                {"prominence_db", 8.2},
                                                {"mode", 1},
                                                {"own", true}}})},
                        {"rigid_peaks", Json::array({{{"omega_rad_s", two_pi * 1.8},
                                                      {"frequency_hz", 1.8},
                                                      {"magnitude", 0.53},
                                                      {"prominence_db", 6.1},
                                                      {"mode", 2},
                                                      {"own", false}}})},
                        {"omega_rad_s", {two_pi * 1.5, two_pi * 2.5}},
                        {"frequency_hz", {1.5, 2.5}},
                        {"response", responses_object(bode.real)},
                        {"rigid_response", responses_object(bode.rigid)}});
  EXPECT_EQ(json["peaks"][0]["direction"], "z");
  EXPECT_EQ(json["peaks"][0]["label"], "first");
  EXPECT_EQ(json["rigid_peaks"][0]["direction"], "ry");
}

/// The numbers of a CSV's row.
std::vector<double> row_of(const std::string& csv, int row) {
  std::istringstream lines(csv);
  std::string line;
  for (int k = 0; k <= row; ++k) std::getline(lines, line);
  std::vector<double> numbers;
  std::istringstream cells(line);
  for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
  return numbers;
}

TEST(NumbersInCsv, OfBode) {
  const report::Bode bode{.omega = {two_pi * 1.5, two_pi * 2.5},
                          .real = different_responses(1.0),
                          .rigid = different_responses(2.0)};
  std::vector<double> expected{2.5, two_pi * 2.5};
  for (const auto* H : {&bode.real, &bode.rigid})
    for (int out = 0; out < 6; ++out)
      for (int in = 0; in < 6; ++in) {
        expected.push_back((*H)[1](out, in).real());
        expected.push_back((*H)[1](out, in).imag());
      }
  const auto found = row_of(report::bode_csv(bode), 2);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k], expected[k], 1e-11 * std::abs(expected[k])) << k;
}

TEST(NumbersInJson, OfAPoseCheck) {
  report::PoseCheck check;
  check.pose = {"p", {.p_BP = {0.1, 0.2, 1.3}}};
  check.quality.condition = 7.7;
  check.quality.characteristic_length = 0.77;
  check.equilibrium = true;
  check.buckling_sought = true;
  check.buckling = {
      .status = dynamics::BucklingStatus::found, .payload = 812.0, .limit_point = true};
  check.lowest_at_buckling = 0.0123;
  Json legs = Json::array();
  for (std::size_t i = 0; i < 6; ++i) {
    legs.push_back(number_fields<report::LegCheck>(
        check.legs[i], 1.0 + static_cast<double>(i),
        {{"length_m", &report::LegCheck::length},
         {"piston_m", &report::LegCheck::piston},
         {"guided_length_m", &report::LegCheck::guided_length},
         {"oil_stiffness_N_m", &report::LegCheck::oil_stiffness},
         {"axial_force_N", &report::LegCheck::axial_force},
         {"static_tilt_rad", &report::LegCheck::tilt},
         {"sleeve_offset_m", &report::LegCheck::sleeve_offset},
         {"ring_offset_m", &report::LegCheck::ring_offset},
         {"guide_gap_m", &report::LegCheck::gap},
         {"base_joint_tilt_rad", &report::LegCheck::base_tilt},
         {"platform_joint_tilt_rad", &report::LegCheck::platform_tilt},
         {"retract_left_m", &report::LegCheck::retract_left},
         {"extend_left_m", &report::LegCheck::extend_left},
         {"cap_pressure_Pa", &report::LegCheck::cap_pressure},
         {"rod_pressure_Pa", &report::LegCheck::rod_pressure},
         {"largest_push_N", &report::LegCheck::largest_push},
         {"largest_pull_N", &report::LegCheck::largest_pull}}));
  }
  check.warnings = {{.kind = report::PoseWarning::Kind::short_guide,
                     .value = 0.017,
                     .ratio = 1.23,
                     .legs = {1, 4}}};
  const Json json = report::check_json({check}, symmetric_machine());
  expect_numbers(
      json["poses"],
      Json::array(
          {{{"pose", {{"position_m", {0.1, 0.2, 1.3}}, {"rotation_rad", {0.0, 0.0, 0.0}}}},
            {"condition", 7.7},
            {"characteristic_length_m", 0.77},
            {"equilibrium", true},
            {"sound", true},
            {"legs", legs},
            {"buckling",
             {{"payload_kg", 812.0}, {"limit_point", true}, {"lowest_omega_rad_s", 0.0123}}},
            {"findings", Json::array({{{"value", 0.017}, {"ratio", 1.23}, {"legs", {1, 4}}}})}}}));
  EXPECT_EQ(json["poses"][0]["findings"][0]["kind"], "short_guide");
  EXPECT_EQ(json["poses"][0]["buckling"]["status"], "found");
}

/// `columns`: δa and the flexible coordinates of the model.
Json drawn_json(const dynamics::DrawnLeg& leg, int columns) {
  const auto point = [&](const dynamics::DrawnPoint& at) -> Json {
    Json motion = Json::array();
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < columns; ++k) motion[i].push_back(at.p_x(i, k));
    return {{"at_m", {at.p[0], at.p[1], at.p[2]}}, {"motion", motion}};
  };
  return {{"sleeve", point(leg.sleeve)},
          {"piston", point(leg.piston)},
          {"rod_at_sleeve", point(leg.rod_at_sleeve)}};
}

TEST(NumbersInJson, OfALegsGeometry) {
  auto machine = symmetric_machine();
  auto model = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
  auto& leg = machine.legs[1];
  leg.base_joint = {0.9, 0.2, 0.3};
  leg.platform_joint = {0.4, 0.5, 0.6};
  leg.rod.length = 0.91;
  leg.rod.mass_center = 0.47;
  leg.guide_sleeve.position = 0.83;
  leg.cylinder_case.mass_center = 0.39;
  leg.piston_ring = model::PistonRing{.stiffness = 7.1e6};
  leg.oil_spring.cylinder = model::Cylinder{.bore = 0.081, .rod_diameter = 0.052};
  auto& element = model.legs[1];
  element.l_m = 0.71;
  element.l_mh = 0.12;
  element.k_h = 3.3e6;
  element.k_s = 4.4e6;
  element.frame.tan_gimbal = 0.23;
  element.frame.R_BL << 0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.17, 0.18, 0.19;
  auto& state = model.statics.legs[1];
  state.flexible << 0.021, -0.022, 0.0023, 0.0024;
  state.oil_force = -5432.1;
  model.X_BP.R_BP.setIdentity();
  model.X_BP.p_BP = {0.01, 0.02, 1.1};
  model.p_BC = {0.03, 0.04, 1.2};
  const Json json = report::geometry_json(machine, model);
  const spatial::Vector3 a(0.41, 0.52, 1.7), L = a - leg.base_joint;
  const auto axes = machine.flexible_axes;
  const auto straight = dynamics::straight_leg(leg, {a, L.normalized(), L.norm()}, axes);
  expect_numbers(
      json["legs"][1],
      {{"base_joint_m", {0.9, 0.2, 0.3}},
       {"platform_joint_m", {0.41, 0.52, 1.7}},
       {"length_m", L.norm()},
       {"bent", drawn_json(dynamics::drawn_leg(leg, element, axes, state), 5)},
       {"straight", drawn_json(dynamics::drawn_leg(leg, straight, axes, {}), 3)},
       {"l_m", 0.71},
       {"l_mh", 0.12},
       {"L_g", 0.83},
       {"l_mn", 0.91},
       {"r_b", 0.39},
       {"c_g", 0.47},
       {"axes", {{"t", {0.11, 0.14, 0.17}}, {"a2", {0.12, 0.15, 0.18}}, {"n", {0.13, 0.16, 0.19}}}},
       {"tan_gimbal", 0.23},
       {"tilt_rad", {0.021, -0.022}},
       {"offset_m", {0.0023, 0.0024}},
       {"oil_force_N", -5432.1},
       {"k_h", 3.3e6},
       {"k_s", 4.4e6},
       {"k_g", 7.1e6},
       {"bore_m", 0.081},
       {"rod_diameter_m", 0.052}});
  expect_numbers(json["platform"],
                 {{"origin_m", {0.01, 0.02, 1.1}},
                  {"rotation", {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}},
                  {"mass_center_m", {0.03, 0.04, 1.2}}});
}

simulation::Tuning tuning() {
  simulation::Tuning tuning{.lowest_oil_mode = 61.0};
  auto& p = tuning.parameters;
  p.gain = six(7.0);
  p.integral_time = 0.41;
  p.velocity_feedforward = 0.93;
  p.feedback_gain = six(8.0);
  p.feedback_corner = 5.9;
  p.sample_time = 0.0013;
  p.delay = 1.7;
  p.overlap_compensation = 0.81;
  p.output.limit = 0.97;
  return tuning;
}

Json tuning_json() {
  return {{"lowest_oil_mode_rad_s", 61.0},  {"gain_1_s", six_json(7.0)},
          {"integral_time_s", 0.41},        {"velocity_feedforward", 0.93},
          {"feedback_gain", six_json(8.0)}, {"feedback_corner_rad_s", 5.9},
          {"sample_time_s", 0.0013},        {"delay_samples", 1.7},
          {"overlap_compensation", 0.81},   {"limit", 0.97}};
}

TEST(NumbersInJson, OfASystem) {
  report::System system{.tuning = tuning()};
  system.linear.delay = 0.0029;
  system.linear.pade_order = 3;
  system.linear.sample_time = 0.0013;
  simulation::SystemPole pole{.pole = {-1.1, 7.3},
                              .omega = two_pi * 1.2,
                              .damping_ratio = 0.149,
                              .stable = false,
                              .group = 5};
  Json parts;
  for (int i = 0; i < simulation::part_count; ++i) {
    pole.parts[static_cast<std::size_t>(i)] = 0.011 * (i + 1);
    parts[simulation::name(static_cast<simulation::Part>(i))] = 0.011 * (i + 1);
  }
  for (std::size_t i = 0; i < 6; ++i) pole.legs[i] = six(0.3)[static_cast<int>(i)];
  system.poles.poles = {pole};
  system.poles.stable = true;
  system.poles.largest_real = -1.1;
  system.poles.sampled = {{0.19, 6.1}, {-0.23, 8.7}};
  system.poles.largest_modulus = 1.017;
  system.poles.sampled_stable = false;
  const Json json = report::system_json(system);
  expect_numbers(json,
                 {{"controller", tuning_json()},
                  {"stable", false},
                  {"delay", {{"seconds", 0.0029}, {"pade_order", 3}}},
                  {"poles", Json::array({{{"pole", {{"re", -1.1}, {"im", 7.3}}},
                                          {"omega_rad_s", two_pi * 1.2},
                                          {"frequency_hz", 1.2},
                                          {"damping_ratio", 0.149},
                                          {"stable", false},
                                          {"group", 5},
                                          {"participation", parts},
                                          {"participation_of_legs", six_json(0.3)}}})},
                  {"sampled",
                   {{"sample_time_s", 0.0013},
                    {"largest_modulus", 1.017},
                    {"stable", false},
                    {"poles", {{{"re", 0.19}, {"im", 6.1}}, {{"re", -0.23}, {"im", 8.7}}}}}}});
  // what is sampled is exact, and is what the verdict is about
  EXPECT_EQ(
      report::verdict_text(system.poles),
      "UNSTABLE: an oscillation at 0.9708 Hz grows with 0.19 1/s (sampled loop, exact: largest "
      "|z| 1.017000); the continuous approximation would be stable");
}

TEST(NumbersInJson, OfARootLocus) {
  report::RootLocus locus{.key = "controller.bandwidth", .values = {3.1, 4.2}, .limits = {3.7}};
  for (const double first : {1.0, 2.0}) {
    simulation::SystemPoles poles;
    poles.poles = {{.pole = {-first, 3.0 * first}}};
    poles.sampled = {{-first - 0.1, 3.0 * first - 0.1}};
    poles.largest_modulus = 0.9 + 0.01 * first;
    poles.sampled_stable = first > 1.5;
    locus.poles.push_back(poles);
  }
  const auto point = [](double value, double first) {
    return Json{{"value", value},
                {"stable", first > 1.5},
                {"largest_modulus", 0.9 + 0.01 * first},
                {"poles", Json::array({{{"re", -first}, {"im", 3.0 * first}}})},
                {"sampled", Json::array({{{"re", -first - 0.1}, {"im", 3.0 * first - 0.1}}})}};
  };
  expect_numbers(report::root_locus_json(locus),
                 {{"limits", Json::array({3.7})}, {"points", {point(3.1, 1.0), point(4.2, 2.0)}}});
}

report::Simulation simulated() {
  report::Simulation s{.until = 2.7,
                       .output_interval = 0.0031,
                       .controller = tuning().parameters,
                       .lowest_oil_mode = 61.0};
  s.loop.seed = 77;
  s.loop.initial << 0.001, 0.002, 0.003, 0.004, 0.005, 0.006;
  s.loop.integrator.relative_tolerance = 2.3e-6;
  s.summary = {.time = 2.6, .samples = 200, .integrator = {.steps = 811, .evaluations = 5432}};
  s.summary.events = {{.time = 1.9, .leg = 3, .event = {}, .begins = true}};
  s.summary.peak_command = six(1.1);
  s.summary.peak_motion = six(1.2);
  s.summary.rms_error = six(1.3);
  s.summary.peak_error = six(1.4);
  s.summary.final_error = 1e-3 * six(1.5);
  s.summary.settled = six(1.6);
  s.settling.band = 1e-2 * six(1.7);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto at = static_cast<int>(i);
    s.settling.step[i] = 0.5 + 0.01 * at;
    s.stops[i] = {.low = six(0.4)[at], .high = six(0.9)[at]};
    s.summary.piston_low[i] = six(0.5)[at];
    s.summary.piston_high[i] = six(0.7)[at];
    s.summary.peak_speed[i] = six(2.1)[at];
    s.summary.peak_drive[i] = six(0.2)[at];
    s.summary.limited[i] = 10 + at;
  }
  s.trace = {.time = {0.11, 0.12},
             .command = {six(3.1), six(3.2)},
             .motion = {six(3.3), six(3.4)},
             .piston = {six(3.5), six(3.6)},
             .drive = {six(3.7), six(3.8)},
             .cap_pressure = {six(3.9), six(4.0)},
             .rod_pressure = {six(4.1), six(4.2)}};
  return s;
}

Json history(double first, double second) {
  Json lists = Json::array();
  for (int i = 0; i < 6; ++i) lists.push_back({six(first)[i], six(second)[i]});
  return lists;
}

TEST(NumbersInJson, OfASimulation) {
  Json directions = Json::array(), legs = Json::array();
  for (int i = 0; i < 6; ++i) {
    directions.push_back({{"peak_command", six(1.1)[i]},
                          {"peak_motion", six(1.2)[i]},
                          {"rms_error", six(1.3)[i]},
                          {"peak_error", six(1.4)[i]},
                          {"final_error", 1e-3 * six(1.5)[i]},
                          {"settling_band", 1e-2 * six(1.7)[i]},
                          {"settling_time_s", six(1.6)[i] - 0.5 - 0.01 * i}});
    legs.push_back({{"stroke_m", {six(0.4)[i], six(0.9)[i]}},
                    {"piston_m", {six(0.5)[i], six(0.7)[i]}},
                    {"stroke_used", 0.4},
                    {"peak_speed_m_s", six(2.1)[i]},
                    {"peak_drive", six(0.2)[i]},
                    {"share_at_limit", (10 + i) / 200.0}});
  }
  expect_numbers(report::simulation_json(simulated()),
                 {{"controller", tuning_json()},
                  {"initial", {0.001, 0.002, 0.003, 0.004, 0.005, 0.006}},
                  {"run",
                   {{"time_s", 2.6},
                    {"until_s", 2.7},
                    {"output_interval_s", 0.0031},
                    {"samples", 200},
                    {"seed", 77},
                    {"relative_tolerance", 2.3e-6},
                    {"steps", 811},
                    {"evaluations", 5432},
                    {"events", Json::array({{{"time_s", 1.9}, {"leg", 4}, {"begins", true}}})}}},
                  {"directions", directions},
                  {"legs", legs},
                  {"trace",
                   {{"time_s", {0.11, 0.12}},
                    {"command", history(3.1, 3.2)},
                    {"motion", history(3.3, 3.4)},
                    {"piston_m", history(3.5, 3.6)},
                    {"drive", history(3.7, 3.8)},
                    {"cap_pressure_Pa", history(3.9, 4.0)},
                    {"rod_pressure_Pa", history(4.1, 4.2)}}}});
}

}  // namespace
}  // namespace hydrapod::test
