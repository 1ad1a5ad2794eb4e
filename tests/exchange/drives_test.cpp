/// State spaces of machines with electric cylinders, against closed forms and the simulation.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/other_legs.hpp"
#include "support/symmetric_screws.hpp"

namespace hydrapod::exchange {
namespace {

using dynamics::ModelKind;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

/// H(iω) of a continuous system.
MatrixXcd response_at(const StateSpace& system, double omega) {
  MatrixXcd pencil = -system.A.cast<std::complex<double>>();
  pencil.diagonal().array() += std::complex<double>(0.0, omega);
  return system.C.cast<std::complex<double>>() *
             numerics::solve(pencil, system.B.cast<std::complex<double>>()) +
         system.D.cast<std::complex<double>>();
}

Index place_of(const std::vector<Signal>& signals, const std::string& name) {
  const auto found = std::ranges::find(signals, name, &Signal::name);
  EXPECT_NE(found, signals.end()) << name;
  return found - signals.begin();
}

const Signal& signal_named(const std::vector<Signal>& signals, const std::string& name) {
  return signals[static_cast<std::size_t>(place_of(signals, name))];
}

/// All six drives together move the platform in heave: z, s_n, their rates, T_i.
TEST(StateSpaceOfDrives, IsTwoMassesAndASpeedLoop) {
  using S = test::SymmetricScrews;
  const auto machine = test::damped_screws();
  const auto loop = simulation::speed_loop(*machine.legs[0].screw);
  const double n_z = test::rise(machine), m = S::mass, q = 6.0 * n_z, m_r = S::reflected;
  const double slow = (S::b + loop.gain) * S::ratio * S::ratio, t_i = loop.integral_time;
  Eigen::Matrix<double, 5, 5> A;
  A << 0, 0, 1, 0, 0, 0, 0, 0, 1, 0,                                                    //
      -q * n_z * S::k_a / m, q * S::k_a / m, -q * n_z * S::c_a / m, q * S::c_a / m, 0,  //
      n_z * S::k_a / m_r, -S::k_a / m_r, n_z * S::c_a / m_r, -(S::c_a + slow) / m_r, S::ratio / m_r,
      0, 0, 0, -loop.gain * S::ratio / t_i, 0;
  const double command = loop.gain * S::speed;  // torque per command
  Eigen::Matrix<double, 5, 1> B;
  B << 0, 0, 0, command * S::ratio / m_r, command / t_i;
  const std::vector<std::string> outputs{"z", "leg4.l", "az", "leg1.motor_speed", "leg6.torque"};
  Eigen::Matrix<double, 5, 5> C;
  C << 1, 0, 0, 0, 0, n_z, 0, 0, 0, 0, A.row(2), 0, 0, 0, S::ratio, 0,  //
      0, 0, 0, -loop.gain * S::ratio, 1;
  const StateSpace expected{
      .A = A, .B = B, .C = C, .D = command * Eigen::Matrix<double, 5, 1>::Unit(4)};
  const auto system =
      state_space(machine, machine.neutral(),
                  {.system = SystemKind::plant, .kind = ModelKind::rigid, .outputs = outputs});
  for (const double omega : {3.0, 41.0, 290.0, 1700.0}) {
    const VectorXcd found = response_at(system, omega).leftCols(6).rowwise().sum();
    const VectorXcd wanted = response_at(expected, omega);
    for (Index i = 0; i < 5; ++i)
      EXPECT_LT(std::abs(found[i] - wanted[i]), 1e-6 * std::abs(wanted[i]))
          << outputs[static_cast<std::size_t>(i)] << ' ' << omega;
  }
}

/// T is where T_i goes, T = T_i + t_i Ṫ_i, whatever commands it; the motor turns with the nut.
TEST(StateSpaceOfDrives, HasTheTorqueThatItsSpeedLoopIntegrates) {
  const auto machine = test::ugly_screws();
  const auto& screw = *machine.legs[0].screw;
  const double t_i = simulation::speed_loop(screw).integral_time;
  for (const auto kind : {SystemKind::plant, SystemKind::loop})
    for (const int order : {0, 2}) {
      const auto system =
          state_space(machine, machine.neutral(), {.system = kind, .pade_order = order});
      for (const char* leg : {"leg2.", "leg5."}) {
        const Index i = place_of(system.states, std::string(leg) + "torque_integral");
        const Index out = place_of(system.outputs, std::string(leg) + "torque");
        const Eigen::RowVectorXd to = t_i * system.A.row(i);
        const double size = to.cwiseAbs().maxCoeff();
        EXPECT_LT((system.C.row(out) - to - Eigen::RowVectorXd::Unit(to.size(), i)).norm(),
                  1e-8 * size);
        const Eigen::RowVectorXd at_once = t_i * system.B.row(i);
        EXPECT_LT((system.D.row(out) - at_once).norm(), 1e-8 * at_once.norm());
        EXPECT_GT(at_once.norm(), 0.0);
        const Index speed = place_of(system.outputs, std::string(leg) + "motor_speed");
        const Index rate = place_of(system.states, std::string(leg) + "nut_rate");
        EXPECT_NEAR(system.C(speed, rate), screw.ratio(), 1e-8 * screw.ratio());
      }
    }
}

TEST(StateSpaceOfDrives, HasPolesAndResponseOfTheWholeSystem) {
  const auto machine = test::ugly_screws();
  const auto linear = simulation::linear_system(machine, machine.neutral());
  const auto poles = simulation::system_poles(linear);
  const auto system = state_space(machine, machine.neutral(), {.system = SystemKind::loop});
  EXPECT_EQ(system.A, linear.A);
  const Eigen::VectorXd d = numerics::balancing(system.A);
  const VectorXcd found =
      numerics::eigenvalues(d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal());
  for (const auto& pole : poles.poles)
    EXPECT_LT((found.array() - pole.pole).abs().minCoeff(), 1e-10 * found.cwiseAbs().maxCoeff())
        << pole.pole;
  for (const double omega : {2.0, 37.0, 240.0}) {
    const MatrixXcd H = response_at(system, omega).topRows(6);
    const MatrixXcd with_rate =
        H.leftCols(6) + std::complex<double>(0.0, omega) * H.middleCols(6, 6);
    const auto expected = simulation::command_response(linear, omega);
    EXPECT_LT((with_rate - expected).norm(), 1e-9 * expected.norm()) << omega;
  }
}

/// A step of 20 µm of the nonlinear machine, sample by sample, with drives that act at once, one
/// sample late and in between.
TEST(StateSpaceOfDrives, SampledIsTheSimulatedLoop) {
  for (const double delay : {0.0, 0.6, 1.0}) {
    auto machine = test::smooth(test::ugly_screws());
    machine.controller.delay = delay;
    simulation::ClosedLoop loop(
        machine, machine.neutral(),
        {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10},
         .until = 0.3,
         .ideal_sensors = true});
    const auto system =
        state_space(machine, machine.neutral(),
                    {.system = SystemKind::loop,
                     .sampled_controller = true,
                     .inputs = {"command.z"},
                     .outputs = {"leg1.torque", "leg6.torque", "leg3.motor_speed", "leg2.l"}});
    EXPECT_EQ(system.sample_time, loop.parameters().sample_time);
    EXPECT_EQ(system.D(0, 0) != 0.0, delay == 0.0);
    constexpr double size = 2e-5;
    signals::Generator step(
        {{.size = size * spatial::Vector6::Unit(2), .form = signals::Step{.at = 0.0}}},
        1.0 / system.sample_time);
    Eigen::VectorXd w = Eigen::VectorXd::Zero(system.A.rows());
    Eigen::Vector4d rest, worst = Eigen::Vector4d::Zero(), largest = worst;
    for (Index i = 0; i < 4; ++i) rest[i] = system.outputs[static_cast<std::size_t>(i)].rest;
    const auto summary =
        loop.run(simulation::command_source(step), [&](const simulation::LoopSample& sample) {
          const auto& legs = sample.plant.legs;
          const Eigen::Vector4d real =
              Eigen::Vector4d(legs[0].torque, legs[5].torque, legs[2].motor_speed, legs[1].length) -
              rest;
          const Eigen::Vector4d linear = system.C * w + size * system.D;
          worst = worst.cwiseMax((real - linear).cwiseAbs());
          largest = largest.cwiseMax(real.cwiseAbs());
          w = (system.A * w + size * system.B).eval();
        });
    EXPECT_EQ(summary.end, simulation::RunEnd::finished) << summary.message;
    for (Index i = 0; i < 4; ++i)
      EXPECT_LT(worst[i], 3e-3 * largest[i])
          << system.outputs[static_cast<std::size_t>(i)].name << ", delay " << delay;
  }
}

TEST(StateSpaceOfDrives, NamesSignalsWithUnitsAndRest) {
  const auto machine = test::symmetric_screws(9.81);
  using S = test::SymmetricScrews;
  const auto system = state_space(machine, machine.neutral(),
                                  {.system = SystemKind::loop, .kind = ModelKind::rigid});
  ASSERT_EQ(system.states.size(), static_cast<std::size_t>(system.A.rows()));
  ASSERT_EQ(system.inputs.size(), static_cast<std::size_t>(system.B.cols()));
  ASSERT_EQ(system.outputs.size(), static_cast<std::size_t>(system.C.rows()));
  EXPECT_EQ(system.inputs[12].name, "leg1.drive");
  EXPECT_EQ(system.inputs[12].unit, "1");
  EXPECT_EQ(signal_named(system.states, "leg3.nut_rate").unit, "m/s");
  EXPECT_EQ(signal_named(system.states, "leg3.torque_integral").unit, "N m");
  EXPECT_EQ(signal_named(system.outputs, "leg5.motor_speed").unit, "rad/s");
  EXPECT_EQ(signal_named(system.outputs, "leg5.motor_speed").rest, 0.0);
  EXPECT_EQ(signal_named(system.outputs, "az").unit, "m/s^2");
  const auto& torque = signal_named(system.outputs, "leg2.torque");
  EXPECT_EQ(torque.unit, "N m");
  const double held = S::mass * 9.81 / (6.0 * test::rise(machine)) / S::ratio;
  EXPECT_NEAR(torque.rest, held, 1e-9 * held);
  for (const auto& output : system.outputs)
    EXPECT_EQ(output.name.find(".p_"), std::string::npos) << output.name;
  EXPECT_TRUE(std::ranges::any_of(state_space_parity(system), [](const ParityLine& line) {
    return line.how.find("saturation") != std::string::npos &&
           line.what.find("torque") != std::string::npos;
  }));
}

TEST(StateSpaceOfDrives, NeedsLegsThatAreDriven) {
  const auto struts = test::machine_of(test::strut_file);
  try {
    (void)state_space(struts, struts.neutral(),
                      {.system = SystemKind::plant, .kind = ModelKind::rigid});
    FAIL() << "expected an error";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("legs.strut: error: has no valves"));
  }
}

}  // namespace
}  // namespace hydrapod::exchange
