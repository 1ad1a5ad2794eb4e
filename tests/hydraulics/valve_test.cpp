/// The servo valve against closed forms and differences.

#include "hydrapod/hydraulics/servo_axis.hpp"

#include <gtest/gtest.h>

#include <complex>

#include "support/published_machine.hpp"

namespace hydrapod::test {
namespace {

using hydraulics::PortPressures;
using hydraulics::Valve;

/// Ugly numbers: 37.3 l/min at 61 bar.
model::Machine machine_with(double overlap, double leakage) {
  auto machine = published_machine();
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.rated_flow = 6.2167e-4;
    leg.hydraulics.valve.rated_pressure_drop = 6.1e6;
    leg.hydraulics.valve.overlap = overlap;
    leg.hydraulics.valve.leakage = leakage;
  }
  return machine;
}
Valve valve_with(double overlap, double leakage) {
  return hydraulics::servo_axis(machine_with(overlap, leakage), 0).valve;
}

TEST(Valve, PassesItsRatedFlowAtItsRatedDrop) {
  for (const double overlap : {0.0, 0.031, -0.02}) {
    const Valve valve = valve_with(overlap, 7e-6);
    const double through_cap =
        hydraulics::valve_flows(valve, 1.0, {9e6 + 3.05e6, 5e5, 9e6, 4e6}).cap;
    const double leaving = valve.gain * hydraulics::opening(valve, -1.0) *
                           hydraulics::orifice(9e6 - 5e5, valve.laminar_pressure);
    EXPECT_NEAR(through_cap + leaving, 6.2167e-4, 1e-12 * 6.2167e-4);
  }
}

/// Steady flow through both edges in series with a load: Q = K x √((p_s − p_r − p_L)/2), the load
/// pressure divided evenly between equal areas.
TEST(Valve, SteadyFlowUnderLoadIsTheSquareRootLaw) {
  const Valve valve = valve_with(0.0, 0.0);
  constexpr double supply = 14e6, back = 5e5;
  for (const double x : {0.113, 0.5, 1.0}) {
    for (const double load : {-5.3e6, 0.0, 2.7e6, 9.1e6}) {
      const double drop = 0.5 * (supply - back - load);
      const PortPressures ports{supply, back, supply - drop, back + drop};
      const auto flows = hydraulics::valve_flows(valve, x, ports);
      const double expected = 6.2167e-4 * x * std::sqrt(drop / 3.05e6);
      const double laminar = 0.5 * std::pow(valve.laminar_pressure / std::min(drop, 3.05e6), 2.0);
      EXPECT_NEAR(flows.cap, expected, laminar * expected);
      EXPECT_NEAR(flows.rod, -flows.cap, 1e-15);
      EXPECT_EQ(flows.supply, flows.cap);
      EXPECT_NEAR(flows.back, flows.cap, 1e-15);
    }
  }
}

TEST(Valve, FlowNearNoDropIsLaminar) {
  constexpr double p_t = 1.3e5;
  EXPECT_NEAR(hydraulics::orifice(1.0, p_t), 1.0 / std::sqrt(p_t), 1e-12);
  EXPECT_EQ(hydraulics::orifice(-7e5, p_t), -hydraulics::orifice(7e5, p_t));
  const double drop = 40.0 * p_t;  // deficit p_t² / 4Δp²
  EXPECT_NEAR(hydraulics::orifice(drop, p_t) / std::sqrt(drop), 1.0 - 0.25 / 1600.0, 1e-6);
}

TEST(Valve, LeaksWhatItsDataSheetSaysInTheMiddle) {
  for (const double overlap : {0.0, 0.025}) {
    const Valve valve = valve_with(overlap, 9.1e-6);
    const double middle = 0.5 * (14e6 + 5e5);
    const auto flows = hydraulics::valve_flows(valve, 0.0, {14e6, 5e5, middle, middle});
    EXPECT_NEAR(flows.supply, 9.1e-6, 1e-9 * 9.1e-6);
    EXPECT_NEAR(hydraulics::null_leakage(valve, 14e6, 5e5), 9.1e-6, 1e-9 * 9.1e-6);
    EXPECT_NEAR(flows.cap, 0.0, 1e-18);
  }
}

TEST(Valve, OverlapShutsItAndUnderlapOpensIt) {
  const Valve over = valve_with(0.05, 0.0);
  EXPECT_EQ(hydraulics::valve_flows(over, 0.049, {14e6, 5e5, 7e6, 7e6}).cap, 0.0);
  EXPECT_GT(hydraulics::valve_flows(over, 0.051, {14e6, 5e5, 7e6, 7e6}).cap, 0.0);
  const Valve under = valve_with(-0.05, 0.0);
  EXPECT_NEAR(hydraulics::opening(under, 0.0), 0.05, 1e-15);
  EXPECT_EQ(hydraulics::opening(under, -0.06), 0.0);
}

TEST(Valve, SlopesAreThoseOfTheFlows) {
  const Valve valve = valve_with(0.02, 6e-6);
  for (const double x : {-0.7, -0.021, 0.0, 0.3}) {
    const PortPressures at{14e6, 5e5, 13.96e6, 6.1e5};  // laminar at two edges
    const auto slopes = hydraulics::valve_flow_slopes(valve, x, at);
    const auto flows = [&](double dx, double d_cap, double d_rod) {
      return hydraulics::valve_flows(valve, x + dx,
                                     {at.supply, at.back, at.cap + d_cap, at.rod + d_rod});
    };
    constexpr double h = 1e-6, hp = 20.0;
    const double scale = 6e-4;
    EXPECT_NEAR(slopes.cap_x, (flows(h, 0, 0).cap - flows(-h, 0, 0).cap) / (2 * h), 1e-6 * scale);
    EXPECT_NEAR(slopes.rod_x, (flows(h, 0, 0).rod - flows(-h, 0, 0).rod) / (2 * h), 1e-6 * scale);
    EXPECT_NEAR(slopes.cap_p, (flows(0, hp, 0).cap - flows(0, -hp, 0).cap) / (2 * hp),
                1e-6 * scale / 1e5);
    EXPECT_NEAR(slopes.rod_p, (flows(0, 0, hp).rod - flows(0, 0, -hp).rod) / (2 * hp),
                1e-6 * scale / 1e5);
  }
}

TEST(Spool, IsALagOfSecondOrderWithALimitedRate) {
  Valve valve = valve_with(0.0, 0.0);
  valve.natural_frequency = 530.0;
  valve.damping_ratio = 0.7;
  valve.rate_limit = 40.0;
  EXPECT_DOUBLE_EQ(hydraulics::spool_acceleration(valve, 0.2, 3.0, 0.23),
                   530.0 * 530.0 * 0.03 - 2.0 * 0.7 * 530.0 * 3.0);
  EXPECT_DOUBLE_EQ(hydraulics::spool_acceleration(valve, -0.5, 40.0, 0.9), 0.0);  // at the limit
  EXPECT_EQ(hydraulics::spool_acceleration(valve, 0.2, 3.0, 7.0),
            hydraulics::spool_acceleration(valve, 0.2, 3.0, 1.0));  // commands end at full travel
}

}  // namespace
}  // namespace hydrapod::test
