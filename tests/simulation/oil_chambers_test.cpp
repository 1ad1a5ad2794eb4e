/// Linear models with damping.oil = "chambers" against the linearisation of the nonlinear plant, of
/// which they use nothing: closed forms here, differences there.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <ostream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::simulation {
namespace {

using Complex = std::complex<double>;

constexpr double by_differences = 1e-9;  // relative, of a linearisation by differences
/// Where these cannot be as good: beside the corner of a guide ring, and where the plant has the
/// lines' inertia of straight legs.
constexpr double coarse = 2e-6;

std::vector<modal::DampedMode> modes_of(const model::Machine& machine, const Pose& X_BP,
                                        ModelKind kind) {
  const auto linear = dynamics::linear_model(machine, X_BP, kind);
  return modal::damped_modes(linear, modal::normal_modes(linear),
                             modal::modal_ratio(machine).value);
}

/// Poles of the plant at rest that oscillate, without those of the spools. Platforms without weight
/// drift at six poles of zero, of which rounding makes pairs.
std::vector<Complex> plant_poles(const model::Machine& machine, const Pose& X_BP, ModelKind kind) {
  constexpr double drift = 1e-2;           // [1/s]
  constexpr double two_real = 1.0 - 1e-6;  // equal real poles, which rounding makes a pair
  std::vector<Complex> poles;
  for (const auto& pole :
       system_poles(linear_system(machine, X_BP, {.kind = kind, .closed = false, .sampled = false}))
           .poles)
    if (pole.oscillates() && pole.omega > drift && pole.damping_ratio < two_real &&
        pole.parts[static_cast<size_t>(Part::valve)] < 0.5)
      poles.push_back(pole.pole);
  return poles;
}

/// Largest relative distance of a mode that oscillates to the nearest pole of the plant; both are
/// equally many.
double worst_distance(const model::Machine& machine, const Pose& X_BP, ModelKind kind) {
  const auto poles = plant_poles(machine, X_BP, kind);
  double worst = 0.0;
  std::size_t count = 0;
  for (const auto& mode : modes_of(machine, X_BP, kind)) {
    if (!(mode.pole.imag() > 0.0)) continue;
    ++count;
    double nearest = 1e300;
    for (const Complex pole : poles) nearest = std::min(nearest, std::abs(pole - mode.pole));
    worst = std::max(worst, nearest / std::abs(mode.pole));
  }
  EXPECT_EQ(count, poles.size());
  return worst;
}

struct Case {
  const char* name;
  const char* machine;
  ModelKind kind;
  std::vector<std::string> overrides;
  double tolerance{by_differences};
};

void PrintTo(const Case& test, std::ostream* out) { *out << test.name; }

class Chambers : public testing::TestWithParam<Case> {};

TEST_P(Chambers, HaveThePolesOfThePlantAtRest) {
  auto overrides = GetParam().overrides;
  overrides.emplace_back("damping.oil=chambers");
  const auto machine = machine_of(GetParam().machine, overrides);
  for (const auto& pose : machine.poses) {
    const double worst = worst_distance(machine, pose.X_BP, GetParam().kind);
    EXPECT_LT(worst, GetParam().tolerance) << pose.name;
    RecordProperty(pose.name, fmt::format("{:.1e}", worst));
  }
}

INSTANTIATE_TEST_SUITE_P(
    , Chambers,
    testing::Values(Case{"heavy_rigid", "heavy-platform", ModelKind::rigid, {}},
                    Case{"heavy_guide", "heavy-platform", ModelKind::guide, {}},
                    Case{"heavy_full",
                         "heavy-platform",
                         ModelKind::full,
                         {"legs.piston_ring.stiffness=17 kN/mm",
                          "legs.piston_ring.damping=310 N s/m"}},
                    Case{"published", "zhang-jiang-2021", ModelKind::guide, {}},
                    Case{"published_with_gravity",
                         "zhang-jiang-2021-transverse",
                         ModelKind::guide,
                         {"environment.gravity=9.80665", "legs.guide_sleeve.stiffness=3e5"}},
                    Case{"friction_and_leakage",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.friction.coulomb=410 N", "legs.leakage.internal=7.3e-12",
                          "legs.leakage.external=1.1e-12", "legs.valve.overlap=-0.013",
                          "leg.2.leakage.internal=3.1e-11"}},
                    Case{"gimbals_that_give_way",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.gimbal_stiffness=71 kN/mm"}},
                    Case{"seals_that_stick",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.stick_stiffness=13 kN/mm", "leg.4.stick_stiffness=71 kN/mm",
                          "legs.gimbal_stiffness=310 kN/mm", "damping.rayleigh_stiffness=3e-5"}},
                    Case{"hoses_and_lines",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.oil_spring.cylinder.cap_line_length=3.75",
                          "legs.oil_spring.cylinder.rod_line_length=2.9",
                          "legs.oil_spring.cylinder.cap_line_compliance=1.7e-12",
                          "legs.oil_spring.cylinder.rod_line_compliance=0.6e-12"},
                         coarse},
                    Case{"rayleigh",
                         "heavy-platform",
                         ModelKind::guide,
                         {"damping.rayleigh_mass=0.7", "damping.rayleigh_stiffness=3e-5"}},
                    Case{"base",
                         "heavy-platform",
                         ModelKind::guide,
                         {"base.mount.stiffness.x=90 kN/mm", "base.mount.stiffness.z=170 kN/mm",
                          "base.mount.mass=21 t", "damping.modal_ratio=0.013"}},
                    Case{"bending",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.bending=elastic", "damping.modal_ratio=0.017"}},
                    Case{"bending_on_guides",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.bending=elastic", "legs.guide_sleeve.gap=0.2 mm"},
                         coarse},
                    Case{"elastomers_in_series_with_bending",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.bending=elastic", "legs.guide_sleeve.elastomer.dynamic_ratio=2.3",
                          "legs.guide_sleeve.elastomer.loss_factor=0.21",
                          "legs.guide_sleeve.elastomer.frequency=13 Hz"}},
                    Case{"elastomers",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.guide_sleeve.elastomer.dynamic_ratio=1.7",
                          "legs.guide_sleeve.elastomer.loss_factor=0.23",
                          "legs.guide_sleeve.elastomer.frequency=11 Hz",
                          "legs.guide_sleeve.elastomer.pressure_stiffening=4.3e-8 1/Pa"}},
                    Case{"elastomers_of_one_leg_under_pressure_on_a_base",
                         "heavy-platform",
                         ModelKind::full,
                         {"legs.piston_ring.stiffness=17 kN/mm",
                          "leg.3.guide_sleeve.elastomer.dynamic_ratio=1.3",
                          "leg.3.guide_sleeve.elastomer.loss_factor=0.11",
                          "leg.3.guide_sleeve.elastomer.frequency=4 Hz",
                          "leg.3.guide_sleeve.elastomer.pressure_stiffening=7.1e-8 1/Pa",
                          "leg.5.piston_ring.elastomer.dynamic_ratio=2.9",
                          "leg.5.piston_ring.elastomer.loss_factor=0.31",
                          "leg.5.piston_ring.elastomer.frequency=23 Hz",
                          "leg.5.piston_ring.elastomer.pressure_stiffening=2.9e-8 1/Pa",
                          "base.mount.stiffness.x=90 kN/mm", "base.mount.mass=21 t"}},
                    Case{"guide_contact",
                         "heavy-platform",
                         ModelKind::guide,
                         {"legs.guide_sleeve.gap=0.2 mm"},
                         coarse}),
    [](const auto& test) { return test.param.name; });

/// Legs of all sorts, half of them with an oil spring's stiffness alone.
TEST(OilChambers, OfRandomMachinesHaveThePolesOfThePlantAtRest) {
  test::Random random(2021);
  int compared = 0;
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    auto machine = test::random_machine(
        random, {.axes = i % 2 == 0 ? model::FlexibleAxes::transverse : model::FlexibleAxes::gimbal,
                 .gravity = i % 3 == 0 ? test::Gravity::none : test::Gravity::down});
    machine.damping.oil = model::OilDamping::chambers;
    for (auto& leg : machine.legs)
      leg.hydraulics.leakage.internal = random.log_uniform(1e-13, 1e-11);
    try {
      EXPECT_LT(worst_distance(machine, machine.poses.back().X_BP, ModelKind::full), 1e-7);
      ++compared;
    } catch (const base::ComputationError&) {  // a small cylinder cannot carry it
      EXPECT_THROW(
          (void)dynamics::linear_model(machine, machine.poses.back().X_BP, ModelKind::full),
          base::ComputationError);
    }
  }
  EXPECT_GE(compared, 4);
}

TEST(OilChambers, InResponsesAreThoseOfThePlantAtRest) {
  const auto machine =
      machine_of("heavy-platform", {"damping.oil=chambers", "legs.leakage.internal=1.9e-11"});
  const auto& X_BP = machine.poses[2].X_BP;
  const auto system =
      linear_system(machine, X_BP, {.kind = ModelKind::guide, .closed = false, .sampled = false});
  const auto linear = dynamics::linear_model(machine, X_BP, ModelKind::guide);
  const auto model = response::response_model(linear, modal::normal_modes(linear), 0.0,
                                              machine.platform.mass_center);
  const auto omega = response::log_space(2.0, 700.0, 61);
  const auto by_elimination = response::frequency_response(model, omega);
  const auto dense = response::frequency_response(model, omega, response::Output::displacement,
                                                  response::Method::dense);
  // displacement of C: the first six of the plant's small changes
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const Eigen::VectorXd d = system.scales;
    Eigen::MatrixXcd pencil =
        -(d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal()).cast<Complex>();
    pencil.diagonal().array() += Complex(0.0, omega[i]);
    const Eigen::MatrixXcd B = (d.cwiseInverse().asDiagonal() * system.B_wrench).cast<Complex>();
    const Eigen::MatrixXcd x = numerics::solve(pencil, B);
    const Eigen::MatrixXcd H = d.head(6).asDiagonal() * x.topRows(6);
    const Eigen::VectorXd root = H.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
    const auto apart = [&](const response::Matrix6c& other) {
      return Eigen::MatrixXcd(root.asDiagonal() * (other - H) * root.asDiagonal())
          .cwiseAbs()
          .maxCoeff();
    };
    EXPECT_LT(apart(by_elimination[i]), 1e-8) << omega[i];
    EXPECT_LT(
        Eigen::MatrixXcd(root.asDiagonal() * (by_elimination[i] - dense[i]) * root.asDiagonal())
            .cwiseAbs()
            .maxCoeff(),
        1e-10)
        << omega[i];
  }
}

/// What the plant has today is what it had, whatever the linear models take.
TEST(OilChambers, ChangeNothingOfThePlant) {
  const auto A = [](const char* oil) {
    const auto machine = machine_of("heavy-platform", {std::string("damping.oil=") + oil});
    return linear_system(machine, machine.neutral(), {.closed = false, .sampled = false}).A;
  };
  EXPECT_EQ(A("viscous"), A("chambers"));
}

TEST(OilChambers, NeedASupplyThatHoldsTheLegs) {
  const auto machine =
      machine_of("heavy-platform", {"damping.oil=chambers", "supply.pressure=20 bar"});
  try {
    (void)dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
    FAIL() << "expected an error";
  } catch (const base::ComputationError& error) {
    EXPECT_NE(std::string(error.what()).find("supply.pressure"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace hydrapod::simulation
