/// What the JSON says in words, and that nothing in it is not a number.

#include "hydrapod/report/json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/report/model_results.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using report::Json;

TEST(DampingText, SaysWhatDampsAndWhatIsAssumed) {
  auto machine = symmetric_machine();
  EXPECT_EQ(report::damping_text(machine),
            "2 % of critical in every mode (default: the machine file states no damping)");
  machine.damping.modal_ratio = 0.002;
  EXPECT_EQ(report::damping_text(machine), "0.2 % of critical in every mode");
  machine.damping.modal_ratio = 0.0;
  EXPECT_EQ(report::damping_text(machine), "none");
  machine.legs[4].oil_spring.damping = 10.0;
  EXPECT_EQ(report::damping_text(machine), "viscous dampers of the legs");
  machine.damping.modal_ratio = 0.01;
  machine.damping.rayleigh_mass = 0.5;
  EXPECT_EQ(report::damping_text(machine),
            "1 % of critical in every mode + viscous dampers of the legs + Rayleigh α = 0.5 1/s, "
            "β = 0 s");
}

/// Numbers of the hydraulics that the linear models leave out are named, whatever damps.
TEST(DampingText, SaysWhatOfTheHydraulicsIsNotUsed) {
  auto machine = symmetric_machine();
  machine.damping = {.modal_ratio = 0.0, .oil = model::OilDamping::viscous};
  machine.legs[2].hydraulics.valve.rated_flow = 3.1e-4;
  EXPECT_EQ(report::damping_text(machine),
            "none; the flow of the valves in the file is not used here (damping.oil = \"chambers\" "
            "uses it)");
  machine.legs[5].hydraulics.leakage.internal = 2.3e-12;
  machine.damping.modal_ratio = 0.01;
  EXPECT_EQ(
      report::damping_text(machine),
      "1 % of critical in every mode; the leakage in the file is not used here (damping.oil = "
      "\"chambers\" uses it)");
}

TEST(DampingText, DoesNotTakeElastomersForViscousDampers) {
  auto machine = symmetric_machine();
  machine.legs[3].guide_sleeve.elastomer = {
      .dynamic_ratio = 1.7, .loss_factor = 0.19, .frequency = 23.0};
  EXPECT_EQ(report::damping_text(machine), "loss factors of the elastomer seals");
  machine.legs[1].oil_spring.damping = 37.0;
  EXPECT_EQ(report::damping_text(machine),
            "viscous dampers of the legs + loss factors of the elastomer seals");
}

/// ζ of chambers follows from numbers that few files have; those that the program chose are named.
TEST(DampingText, OfChambersNamesWhatTheFileLeavesOpen) {
  auto machine = symmetric_machine();
  machine.damping.oil = model::OilDamping::chambers;
  EXPECT_TRUE(report::damping_text(machine).ends_with(
      "; assumed, as the file does not say: equivalent_cylinder, valve.rated_flow, valve.leakage, "
      "leakage.internal (values: hydrapod check)"))
      << report::damping_text(machine);
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.rated_flow = 7.3e-4;
    leg.hydraulics.valve.leakage = 1.9e-5;
  }
  EXPECT_TRUE(report::damping_text(machine).ends_with(
      "not say: equivalent_cylinder, leakage.internal (values: hydrapod check)"))
      << report::damping_text(machine);
  for (auto& leg : machine.legs) leg.hydraulics.leakage.internal = 3.1e-12;
  EXPECT_TRUE(report::damping_text(machine).ends_with(
      "not say: equivalent_cylinder (values: hydrapod check)"))
      << report::damping_text(machine);
  for (auto& leg : machine.legs) {
    leg.stroke = model::Stroke{.retracted = 0.17, .length = 0.53};
    leg.oil_spring.cylinder =
        model::Cylinder{.bore = 0.063, .rod_diameter = 0.036, .bulk_modulus = 1.3e9};
  }
  EXPECT_EQ(report::damping_text(machine).find("assumed"), std::string::npos);
}

TEST(GravityText, SaysHowMuchAndWhichWay) {
  model::Machine machine;
  EXPECT_EQ(report::gravity_text(machine), "gravity 9.80665 m/s² downwards");
  machine.gravity.setZero();
  EXPECT_EQ(report::gravity_text(machine), "no gravity");
  machine.gravity = {1.0, 0.0, -9.0};
  EXPECT_EQ(report::gravity_text(machine), "gravity (1, 0, -9) m/s²");
}

TEST(MassText, HasFourDigitsAndNeverAPowerOfTen) {
  EXPECT_EQ(report::mass_text(45.9183), "45.92 kg");
  EXPECT_EQ(report::mass_text(0.48), "0.48 kg");
  EXPECT_EQ(report::mass_text(9999.0), "9999 kg");
  EXPECT_EQ(report::mass_text(74941.3), "74941 kg");
  EXPECT_EQ(report::mass_text(-123456.0), "-123456 kg");
}

TEST(ResponseUnit, IsOutputPerInput) {
  using response::Output;
  EXPECT_EQ(report::response_unit(Output::displacement, 0, 0), "m/N");
  EXPECT_EQ(report::response_unit(Output::displacement, 4, 0), "rad/N");
  EXPECT_EQ(report::response_unit(Output::velocity, 0, 5), "(m/s)/(N m)");
  EXPECT_EQ(report::response_unit(Output::acceleration, 3, 3), "(rad/s²)/(N m)");
}

bool all_finite(const Json& json) {
  if (json.is_number_float()) return std::isfinite(json.get<double>());
  if (!json.is_structured()) return true;
  for (const auto& item : json)
    if (!all_finite(item)) return false;
  return true;
}

TEST(ModesJson, HoldsNumbersOnly) {
  Random random(51);
  for (int i = 0; i < 10; ++i) {
    const auto machine = random_machine(random, {.gravity = Gravity::down});
    const auto table = modal::mode_table(machine, machine.poses[1].X_BP, dynamics::ModelKind::full);
    const Json json = report::modes_json(table);
    EXPECT_TRUE(all_finite(json));
    EXPECT_EQ(json["modes"].size(), 30U);
    EXPECT_TRUE(json["modes"][0].contains("shape_imaginary")) << "dampers make modes complex";
    EXPECT_TRUE(all_finite(report::matrices_json(table)));
  }
}

TEST(PeaksJson, HasNullForWhatIsUnbounded) {
  const auto machine = symmetric_machine();
  const auto table = modal::mode_table(machine, machine.neutral(), dynamics::ModelKind::guide);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const Json json = report::peaks_json({{0, 46.8, infinite, infinite, 0, true}}, table.real);
  EXPECT_TRUE(json[0]["magnitude"].is_null());
  EXPECT_TRUE(json[0]["prominence_db"].is_null());
  EXPECT_EQ(json[0]["mode"], 1);
}

TEST(BodeScript, IsWholeAndQuotesItsText) {
  const report::Bode bode{.options = {.from = 1.0, .to = 10.0},
                          .omega = {1.0, 10.0},
                          .real = {response::Matrix6c::Ones(), response::Matrix6c::Ones()},
                          .rigid = {response::Matrix6c::Ones(), response::Matrix6c::Ones()}};
  const std::string script = report::bode_script(
      bode, {{0, 0}, {4, 0}}, {.title = "it's\nset output 'stolen'"}, "svg", "out.svg");
  EXPECT_NE(script.find("set output 'out.svg'\n"), std::string::npos);
  EXPECT_NE(script.find("'it''s set output ''stolen'''"), std::string::npos);
  EXPECT_EQ(script.find("nan"), std::string::npos);
  // a phase of 0 or −180° does not lie on the frame
  EXPECT_NE(script.find("set autoscale yfix\nset offsets 0,0,10,10\nplot "), std::string::npos);
  EXPECT_TRUE(script.ends_with("unset multiplot\nunset output\n"));
}

}  // namespace
}  // namespace hydrapod::test
