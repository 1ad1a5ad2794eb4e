/// Elastomers that large amplitudes soften, in the plant: states, rest, small motions, energy, one
/// seal against closed forms, frozen amplitudes against linear models.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/bending_machine.hpp"
#include "support/loop_machine.hpp"
#include "support/plant_checks.hpp"
#include "support/random_machine.hpp"
#include "support/softening_machine.hpp"

namespace hydrapod::simulation {
namespace {

using Complex = std::complex<double>;
using dynamics::Vector2;
using Eigen::VectorXd;
using model::leg_count;
using test::poles_of;
using test::with_softening;
using test::without_softening;

constexpr PlantOptions springs{.hydraulics = false, .friction = Friction::none};
constexpr double softening_amplitude = 2.3e-4, softening_time = 0.37;

model::Machine softening_machine(test::Random& random, model::FlexibleAxes axes,
                                 test::Gravity gravity = test::Gravity::down) {
  return with_softening(test::random_machine(random, {.axes = axes, .gravity = gravity}),
                        softening_amplitude, softening_time);
}

template <class Each>
void for_softening(const StateLayout& layout, const Each& each) {
  for (std::size_t i = 0; i < leg_count; ++i) {
    if (layout.sleeve_softening[i] >= 0) each(i, true, layout.sleeve_softening[i]);
    if (layout.ring_softening[i] >= 0) each(i, false, layout.ring_softening[i]);
  }
}

/// Relative to the pole.
double distance(const Complex& pole, const Eigen::VectorXcd& among) {
  return (among.array() - pole).abs().minCoeff() / std::abs(pole);
}

TEST(PlantThatSoftens, HasThreeStatesMorePerSealThatSoftens) {
  test::Random random(871);
  const auto machine = softening_machine(random, model::FlexibleAxes::transverse);
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
    const Plant plant(machine, kind, springs), hard(without_softening(machine), kind, springs);
    int seals = 0;
    for_softening(plant.layout(), [&](std::size_t i, bool sleeve, int first) {
      EXPECT_TRUE(sleeve ? i != 0 && i != 2 : i % 2 == 1);
      const auto leg = "leg" + std::to_string(i + 1) + (sleeve ? ".sleeve_" : ".ring_");
      EXPECT_EQ(plant.state_names()[static_cast<std::size_t>(first)], leg + "amplitude_square");
      EXPECT_EQ(plant.state_names()[static_cast<std::size_t>(first) + 2], leg + "mean_a2");
      ++seals;
    });
    EXPECT_EQ(seals, kind == ModelKind::rigid ? 0 : kind == ModelKind::guide ? 4 : 7);
    EXPECT_EQ(plant.layout().size, hard.layout().size + 3 * seals);
    EXPECT_EQ(plant.state_names().size(), static_cast<std::size_t>(plant.layout().size));
  }
}

/// To the bit: nobody who does not ask for softening pays for it.
TEST(PlantThatSoftens, IsTheOneWithoutWhereTheOptionOrTheKeyIsOff) {
  test::Random random(872);
  const auto machine = softening_machine(random, model::FlexibleAxes::transverse);
  auto off = springs;
  off.softening = false;
  const Plant plant(machine, ModelKind::full, off),
      hard(without_softening(machine), ModelKind::full, springs);
  ASSERT_EQ(plant.layout().size, hard.layout().size);
  const auto rest = plant.equilibrium(machine.neutral());
  VectorXd x = rest.x, one(x.size()), other(x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k)
    x[k] += 0.3 * random.uniform(-1.0, 1.0) * plant.scales()[k];
  ASSERT_TRUE(plant.derivative(0.0, x.data(), rest.input, one.data()));
  ASSERT_TRUE(hard.derivative(0.0, x.data(), rest.input, other.data()));
  EXPECT_EQ(one, other);
}

/// As well as without softening, also at a pose that is not the one from which offsets count.
TEST(PlantThatSoftens, RestsUnderItsWeight) {
  test::Random random(873);
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal}) {
    const auto machine = softening_machine(random, axes);
    constexpr PlantOptions free{.hydraulics = false, .oil_springs = false};
    const Plant plant(machine, ModelKind::full, free),
        hard(without_softening(machine), ModelKind::full, free);
    const auto largest_rate = [](const Plant& of, const Plant::Rest& rest) {
      VectorXd rate(rest.x.size());
      EXPECT_TRUE(of.derivative(0.0, rest.x.data(), rest.input, rate.data()));
      return rate.cwiseQuotient(of.scales()).cwiseAbs().maxCoeff();  // of the scales per second
    };
    for (const auto& pose : machine.poses) {
      const auto rest = plant.equilibrium(pose.X_BP);
      const double found = largest_rate(hard, hard.equilibrium(pose.X_BP));
      EXPECT_NEAR(largest_rate(plant, rest), found, 1e-9) << pose.name;
      EXPECT_LT(found, 1e-5) << pose.name;
      const auto out = plant.outputs(rest.x.data(), rest.input);
      EXPECT_NEAR(out.seal_arms_energy, 0.0, 1e-20);
      EXPECT_NEAR(out.dissipation, 0.0, 1e-12);
    }
  }
}

TEST(PlantThatSoftens, StaysAtRest) {
  test::Random random(874);
  const auto machine = softening_machine(random, model::FlexibleAxes::transverse);
  const Plant plant(machine, ModelKind::full, springs);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant, {.relative_tolerance = 1e-9, .absolute_tolerance = 1e-9});
  run.start(0.0, rest.x);
  run.advance(2.0, rest.input);
  EXPECT_LT((run.state() - rest.x).cwiseQuotient(plant.scales()).cwiseAbs().maxCoeff(), 1e-7);
}

/// At the reference pose and at another: those without softening, and −1/τ three times per seal.
TEST(PlantThatSoftens, HasThePolesOfSmallMotions) {
  test::Random random(875);
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal}) {
    const auto machine = softening_machine(random, axes);
    for (const auto& pose : machine.poses) {
      const Plant plant(machine, ModelKind::full, springs),
          hard(without_softening(machine), ModelKind::full, springs);
      const auto poles = poles_of(plant, plant.equilibrium(pose.X_BP).x, {});
      const auto wanted = poles_of(hard, hard.equilibrium(pose.X_BP).x, {});
      for (const Complex& pole : wanted) {
        if (!(pole.imag() > 0.0)) continue;
        EXPECT_LT(distance(pole, poles), 1e-7) << pole;
      }
      for_softening(plant.layout(), [&](std::size_t i, bool sleeve, int) {
        const auto& leg = machine.legs[i];
        const auto& seal = sleeve ? *leg.guide_sleeve.elastomer : *leg.piston_ring->elastomer;
        EXPECT_LT(distance(-1.0 / seal.softening_time, poles), 1e-5);
      });
    }
  }
}

/// Oil, valves and controller: small motions about rest know nothing of softening.
TEST(PlantThatSoftens, LeavesLinearSystemsAsTheyAre) {
  const auto machine = with_softening(machine_of("heavy-platform"), softening_amplitude, 0.37);
  for (const bool closed : {false, true}) {
    const LinearSystemOptions options{.kind = ModelKind::guide, .closed = closed};
    const auto system = linear_system(machine, machine.neutral(), options);
    const auto wanted = linear_system(without_softening(machine), machine.neutral(), options);
    EXPECT_EQ(system.states, wanted.states);
    EXPECT_EQ(system.A, wanted.A);
  }
}

/// In any state; `machine` stands at its first pose.
void expect_energy_accounts(const model::Machine& machine, ModelKind kind, test::Random& random) {
  const auto& X_BP = machine.poses.front().X_BP;
  const Plant plant(machine, kind, springs, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  for (int trial = 0; trial < 5; ++trial) {
    VectorXd x = test::beside(plant, rest.x, random);
    for_softening(plant.layout(),
                  [&](std::size_t, bool, int first) { x[first] = random.uniform(0.01, 3.0); });
    test::expect_energy_account(plant, x, rest.input);
  }
}

TEST(PlantThatSoftens, LosesTheEnergyThatItDissipates) {
  test::Random random(876);
  const auto that_stands = [](ModelKind kind, const auto& make) {
    return test::first_machine(make, [&](const model::Machine& machine) {
      const auto& X_BP = machine.poses.front().X_BP;
      (void)Plant(machine, kind, springs, X_BP).equilibrium(X_BP);
    });
  };
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal})
    for (const auto kind : {ModelKind::guide, ModelKind::full}) {
      const auto random_one = [&] { return softening_machine(random, axes); };
      expect_energy_accounts(that_stands(kind, random_one), kind, random);
      const auto on_guide = [&] {
        auto machine = random_one();
        for (auto& leg : machine.legs) leg.guide_sleeve.gap = 1.7e-4;
        return machine;
      };
      expect_energy_accounts(that_stands(kind, on_guide), kind, random);
      const auto bending = [&] {
        return with_softening(test::bending_machine(random, {.axes = axes}), 1.9e-4,
                              softening_time);
      };
      expect_energy_accounts(that_stands(kind, bending), kind, random);
    }
}

/// The piston of leg 2 swings along t, everything else stands still: its ring's states follow.
class PrescribedRing {
 public:
  PrescribedRing(const model::Machine& machine, double amplitude, double omega)
      : plant_(machine, ModelKind::full, springs),
        rest_(plant_.equilibrium(machine.neutral()).x),
        first_(plant_.layout().ring_arms[leg]),
        softening_(plant_.layout().ring_softening[leg]),
        amplitude_(amplitude),
        omega_(omega),
        x_(rest_) {}

  static constexpr std::size_t leg = 1;
  static constexpr int count = 6 + 3;
  using States = Eigen::Matrix<double, count, 1>;

  States states{States::Zero()};  ///< of the arms, w, d̄; offsets count from the rest

  /// To `t` by the classical method of Runge and Kutta.
  void run(double from, double to, int steps) {
    const double h = (to - from) / steps;
    for (int k = 0; k < steps; ++k) {
      const double t = from + k * h;
      const States a = rate(t, states), b = rate(t + 0.5 * h, states + 0.5 * h * a),
                   c = rate(t + 0.5 * h, states + 0.5 * h * b), d = rate(t + h, states + h * c);
      states += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
  }

  /// What is dissipated at t [W]. Velocities are zero, so that dampers take nothing.
  double dissipation(double t) {
    place(t, states);
    return plant_.outputs(x_.data(), {}).dissipation;
  }

 private:
  void place(double t, const States& of) {
    x_ = rest_;
    x_[7 + 4 * static_cast<int>(leg) + 2] += amplitude_ * std::cos(omega_ * t);
    const auto& offset = rest_.segment<2>(7 + 4 * static_cast<int>(leg) + 2);
    for (int k = 0; k < 6; ++k) x_[first_ + k] = offset[k % 2] + of[k];
    x_[softening_] = of[6];
    for (int k = 0; k < 2; ++k) x_[softening_ + 1 + k] = offset[k] + of[7 + k];
  }
  States rate(double t, const States& of) {
    place(t, of);
    VectorXd rates(x_.size());
    EXPECT_TRUE(plant_.derivative(0.0, x_.data(), {}, rates.data()));
    States found;
    found << rates.segment<6>(first_), rates.segment<3>(softening_);
    return found;
  }

  Plant plant_;
  VectorXd rest_;
  int first_, softening_;
  double amplitude_, omega_;
  VectorXd x_;
};

/// Of a swing a cos ωt that lasts: d̄ and ξ are lags of the first order, w is that of the square,
/// B² (1 + cos 2θ) with the amplitude B and the phase of the offset from d̄.
struct SteadySwing {
  double a, omega, tau, softening_amplitude;

  [[nodiscard]] Complex from_mean() const {
    return a * Complex(0.0, omega * tau) / Complex(1.0, omega * tau);
  }
  [[nodiscard]] double square(double t) const {
    const Complex twice = from_mean() * from_mean() * std::polar(1.0, 2.0 * omega * t) /
                          Complex(1.0, 2.0 * omega * tau);
    return (std::norm(from_mean()) + twice.real()) / (softening_amplitude * softening_amplitude);
  }
  [[nodiscard]] double mean(double t) const {
    return (a * std::polar(1.0, omega * t) / Complex(1.0, omega * tau)).real();
  }
};

model::Machine one_seal(test::Random& random) {
  auto machine = softening_machine(random, model::FlexibleAxes::gimbal);
  machine.legs[PrescribedRing::leg].guide_sleeve.elastomer.reset();
  return machine;
}

TEST(OneSealThatSoftens, FollowsTheMeanSquareWithItsLag) {
  test::Random random(877);
  const auto machine = one_seal(random);
  const auto& seal = *machine.legs[PrescribedRing::leg].piston_ring->elastomer;
  for (const double omega : {3.1, 41.0}) {
    const SteadySwing steady{1.7e-4, omega, seal.softening_time, seal.softening_amplitude};
    PrescribedRing ring(machine, steady.a, omega);
    const double period = 2.0 * std::numbers::pi / omega;
    // From rest: the transient of ten time constants leaves e⁻¹⁰ behind.
    const double settled = std::ceil(10.0 * seal.softening_time / period) * period;
    ring.run(0.0, settled, static_cast<int>(1000.0 * settled / period));
    for (const double t : {0.0, 0.13 * period, 0.71 * period}) {
      auto later = ring;
      if (t > 0.0) later.run(settled, settled + t, 1000);
      const double scale = steady.a * steady.a / std::pow(seal.softening_amplitude, 2);
      EXPECT_NEAR(later.states[6], steady.square(t), 3e-4 * scale);
      EXPECT_NEAR(later.states[7], steady.mean(t), 1e-4 * steady.a);
      EXPECT_NEAR(later.states[8], 0.0, 1e-12);
    }
    // From the closed form itself: to the error of the integration.
    ring.states[6] = steady.square(0.0);
    ring.states[7] = steady.mean(0.0);
    ring.run(0.0, 0.37 * period, 400);
    EXPECT_NEAR(ring.states[6], steady.square(0.37 * period), 1e-9);
    EXPECT_NEAR(ring.states[7], steady.mean(0.37 * period), 1e-10 * steady.a);
  }
}

/// What a period takes out is π a² k'' of the softened stiffness, where k'' has what the lag of s
/// behind the square adds: for s = s_0 + s' (w − w_0), k_eff = s_0 k + ½ s' w̃ k*, w̃ the amplitude
/// of w at 2ω. The next terms are of the order |w̃|².
TEST(OneSealThatSoftens, TakesOutWhatTheSoftenedLossFactorSays) {
  test::Random random(878);
  const auto machine = one_seal(random);
  const auto& ring = *machine.legs[PrescribedRing::leg].piston_ring;
  const auto& seal = *ring.elastomer;
  for (const double amplitude : {0.3, 1.0, 4.3}) {
    const double omega = 61.0, period = 2.0 * std::numbers::pi / omega;
    const SteadySwing steady{amplitude * seal.softening_amplitude, omega, seal.softening_time,
                             seal.softening_amplitude};
    Complex k = 1.0;
    PrescribedRing swings(machine, steady.a, omega);
    swings.states[6] = steady.square(0.0);
    swings.states[7] = steady.mean(0.0);
    for (int j = 0; j < 3; ++j) {
      const Complex lag = Complex(0.0, omega * seal.arms->time[j]);
      k += seal.arms->strength[j] * lag / (1.0 + lag);
      swings.states[2 * j] = (steady.a / (1.0 + lag)).real();
    }
    k *= ring.stiffness;
    const double w = std::norm(steady.from_mean()) / std::pow(seal.softening_amplitude, 2);
    const double r = std::pow(w, 0.6), s = 1.0 - seal.softening * r / (1.0 + r);
    const double slope = -seal.softening * 0.6 * std::pow(w, -0.4) / ((1.0 + r) * (1.0 + r));
    const Complex ripple = w * std::polar(1.0, 2.0 * std::arg(steady.from_mean())) /
                           Complex(1.0, 2.0 * omega * seal.softening_time);
    const Complex softened = s * k + 0.5 * slope * ripple * std::conj(k);
    EXPECT_NEAR(s, dynamics::softened(seal, steady.a), 1e-4);
    constexpr int samples = 64;
    double power = 0.0;
    for (int n = 0; n < samples; ++n) {  // trapezoidal over a period: exact for few harmonics
      power += swings.dissipation(n * period / samples) / samples;
      swings.run(n * period / samples, (n + 1) * period / samples, 20);
    }
    const double wanted = 0.5 * omega * steady.a * steady.a * softened.imag();
    const double without_lag = 0.5 * omega * steady.a * steady.a * s * k.imag();
    EXPECT_NEAR(power, wanted, 1e-4 * wanted) << amplitude;
    EXPECT_GT(std::abs(wanted - without_lag), 5e-4 * wanted);  // the lag counts in this test
  }
}

/// Amplitudes held at random ratios to A_s, nothing loaded, and the machine with the share s of the
/// stiffness that those leave.
struct HeldAmplitudes {
  Plant plant;
  VectorXd x;
  model::Machine softer;

  HeldAmplitudes(const model::Machine& machine, const Pose& X_BP, ModelKind kind,
                 test::Random& random)
      : plant(machine, kind, springs, X_BP),
        x(plant.equilibrium(X_BP).x),
        softer(without_softening(machine)) {
    for_softening(plant.layout(), [&](std::size_t i, bool sleeve, int first) {
      const double ratio = random.uniform(0.4, 2.0);
      x[first] = ratio * ratio;
      const auto& leg = machine.legs[i];
      const auto& seal = sleeve ? *leg.guide_sleeve.elastomer : *leg.piston_ring->elastomer;
      auto& of = softer.legs[i];
      (sleeve ? of.guide_sleeve.stiffness : of.piston_ring->stiffness) *=
          dynamics::softened(seal, ratio * seal.softening_amplitude);
    });
  }
};

TEST(PlantThatSoftens, HasThePolesOfSofterSealsAtItsAmplitude) {
  test::Random random(879);
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal})
    for (const auto kind : {ModelKind::guide, ModelKind::full}) {
      auto machine = softening_machine(random, axes, test::Gravity::none);
      machine.damping.modal_ratio = 0.0;
      const auto& X_BP = machine.poses.back().X_BP;
      const HeldAmplitudes held(machine, X_BP, kind, random);
      const auto poles = poles_of(held.plant, held.x, {});
      const auto modes_of = [&](const model::Machine& of) {
        const auto model = dynamics::linear_model(of, X_BP, kind);
        return modal::damped_modes(model, modal::normal_modes(model), 0.0);
      };
      for (const auto& mode : modes_of(held.softer)) {
        if (!(mode.pole.imag() > 0.0)) continue;
        EXPECT_LT(distance(mode.pole, poles), 1e-4) << mode.pole;  // ε of the law moves s by 1e-4
      }
      double farthest = 0.0;
      for (const auto& mode : modes_of(without_softening(machine)))
        if (mode.pole.imag() > 0.0) farthest = std::max(farthest, distance(mode.pole, poles));
      EXPECT_GT(farthest, 1e-2);
    }
}

/// Where rods and cases bend in series with the seals: the stiffness of slow motions and that of
/// motions too fast for the arms to relax. The mass of the bow is that of hard seals, so that poles
/// differ.
TEST(PlantThatSoftens, HasTheStiffnessOfSofterSealsInSeriesWithBending) {
  test::Random random(880);
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal})
    for (const auto kind : {ModelKind::guide, ModelKind::full}) {
      const auto machine = with_softening(
          test::bending_machine(random, {.axes = axes, .gravity = test::Gravity::none}), 1.9e-4,
          softening_time);
      const auto& X_BP = machine.poses.back().X_BP;
      const HeldAmplitudes held(machine, X_BP, kind, random);
      const auto rest = held.plant.equilibrium(X_BP);
      const Plant softer(held.softer, kind, springs, X_BP);
      const auto found = held.plant.linearise(held.x, {}).A,
                 hard = held.plant.linearise(rest.x, {}).A,
                 wanted = softer.linearise(softer.equilibrium(X_BP).x, {}).A;
      const Eigen::Index n = softer.layout().velocity() - 1, states = wanted.rows();
      const Eigen::MatrixXd M = dynamics::linear_model(without_softening(machine), X_BP, kind).M,
                            M_softer = dynamics::linear_model(held.softer, X_BP, kind).M;
      const auto fast = [&](const Eigen::MatrixXd& A) -> Eigen::MatrixXd {
        return A.block(n, 0, n, n);
      };
      const auto slow = [&](const Eigen::MatrixXd& A) -> Eigen::MatrixXd {
        const auto arms = states - 2 * n;
        return fast(A) - A.block(n, 2 * n, n, arms) * A.block(2 * n, 2 * n, arms, arms)
                                                          .partialPivLu()
                                                          .solve(A.block(2 * n, 0, arms, n));
      };
      const auto expect_stiffness = [&](const auto& of) {
        const Eigen::MatrixXd K = M_softer * of(wanted);
        EXPECT_LT((M * of(found) - K).norm(), 2e-4 * (M * of(hard) - K).norm());  // ε of the law
      };
      expect_stiffness(fast);
      expect_stiffness(slow);
    }
}

/// Chambers, valves, controller: every integrator comes to the same motion of a machine that
/// softens much.
TEST(PlantThatSoftens, IsTheSameUnderAllIntegrators) {
  const auto machine = with_softening(machine_of("heavy-platform", smooth), 2.3e-4, 0.21);
  const Plant plant(machine, ModelKind::guide);
  const auto rest = plant.equilibrium(machine.neutral());
  const auto run = [&](Method method, double tolerance) {
    Integrator integrator(plant, {.method = method,
                                  .relative_tolerance = tolerance,
                                  .absolute_tolerance = tolerance,
                                  .fixed_step = 2e-5});
    integrator.start(0.0, rest.x);
    PlantInput input = rest.input;
    for (int k = 0; k < 40; ++k) {
      input.wrench[k % 3] = (k / 4) % 2 == 0 ? 3.1e4 : -2.3e4;
      integrator.advance(2e-3 * (k + 1), input);
    }
    return integrator.state();
  };
  const VectorXd wanted = run(Method::cvode_adams, 1e-11);
  double softest = 0.0;
  for_softening(plant.layout(),
                [&](std::size_t, bool, int first) { softest = std::max(softest, wanted[first]); });
  EXPECT_GT(softest, 0.1);
  for (const auto method : {Method::exponential, Method::adaptive, Method::cvode_bdf}) {
    const VectorXd found = run(method, 1e-9);
    EXPECT_LT((found - wanted).cwiseQuotient(plant.scales()).cwiseAbs().maxCoeff(), 1e-5)
        << name(method);
  }
  const VectorXd fixed = run(Method::fixed, 1e-9);
  EXPECT_LT((fixed - wanted).cwiseQuotient(plant.scales()).cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace hydrapod::simulation
