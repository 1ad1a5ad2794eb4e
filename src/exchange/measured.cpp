/// What a file holds, computed beside what hydrapod computes of the machine.
///
/// Poles: each of hydrapod's against its partner in the file, |Δλ|/|λ|. Responses: over 60 lines
/// from a third of the lowest to three times the highest frequency of the rigid model,
/// |ΔH_ij|/√(max|H_ii| max|H_jj|). Motion: a constant push on the platform in all six directions,
/// in the nonlinear simulation and in the file's equations, over five periods of the lowest mode.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::exchange {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using response::Matrix6c;
using spatial::Matrix6;
using spatial::Vector6;

constexpr double exact_to = 1e-9;

ParityLine measured(const char* what, double difference, const std::string& beside) {
  return {difference <= exact_to ? Held::exact : Held::approximate, what,
          fmt::format("within {:.1e} of {}", difference, beside)};
}

struct Own {
  dynamics::LinearModel linear{};
  dynamics::NormalModes normal{};
  double ratio{};
};

Own own_model(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind) {
  Own own{.linear = dynamics::linear_model(machine, X_BP, kind)};
  own.normal = modal::normal_modes(own.linear);
  own.ratio = model::modal_ratio(machine).value;
  return own;
}

std::vector<double> lines_of(const Machine& machine, const Pose& X_BP) {
  const auto rigid =
      modal::normal_modes(dynamics::linear_model(machine, X_BP, dynamics::ModelKind::rigid));
  const double highest = rigid.omega(rigid.size() - 1);
  double lowest = highest;
  for (int k = 0; k < rigid.size(); ++k)
    if (rigid.omega(k) > 0.0) lowest = std::min(lowest, rigid.omega(k));
  constexpr int count = 60;
  return response::log_space(lowest / 3.0, 3.0 * highest, count);
}

double largest_difference(const std::vector<Matrix6c>& own, const std::vector<Matrix6c>& held) {
  Vector6 sizes = Vector6::Zero();
  for (const auto& H : own) sizes = sizes.cwiseMax(H.diagonal().cwiseAbs());
  sizes = sizes.cwiseSqrt();
  double largest = 0.0;
  for (std::size_t k = 0; k < own.size(); ++k)
    largest = std::max(largest, (sizes.cwiseInverse().asDiagonal() * (held[k] - own[k]) *
                                 sizes.cwiseInverse().asDiagonal())
                                    .cwiseAbs()
                                    .maxCoeff());
  return largest;
}

std::vector<Complex> own_poles(const Own& own) {
  std::vector<Complex> poles;
  for (const auto& mode : modal::damped_modes(own.linear, own.normal, own.ratio))
    poles.push_back(mode.pole);
  return poles;
}

/// The largest difference, each pole having a partner of its own.
double farthest(const std::vector<Complex>& own, const Eigen::VectorXcd& held) {
  if (std::ssize(own) > held.size()) return 1.0;
  MatrixXd differences(std::ssize(own), held.size());
  for (Index k = 0; k < differences.rows(); ++k) {
    const Complex pole = own[static_cast<std::size_t>(k)];
    differences.row(k) = (held.array() - pole).abs().min(1e3 * std::abs(pole)) / std::abs(pole);
  }
  const auto partners = numerics::assign(differences);
  double largest = 0.0;
  for (std::size_t k = 0; k < partners.size(); ++k)
    largest = std::max(largest, differences(static_cast<Index>(k), partners[k]));
  return largest;
}

/// The place of a signal; −1: there is none.
Index place(const std::vector<Signal>& signals, const std::string& name) {
  const auto at = std::ranges::find(signals, name, &Signal::name);
  return at == signals.end() ? -1 : at - signals.begin();
}

const std::array<std::string, 6> wrenches{"wrench.fx", "wrench.fy", "wrench.fz",
                                          "wrench.mx", "wrench.my", "wrench.mz"};

/// Columns of the wrench and rows of the displacement; none where one of them is missing.
struct Places {
  std::vector<Index> rows{}, columns{};
};

std::optional<Places> places_in(const StateSpace& system) {
  Places at;
  for (std::size_t i = 0; i < 6; ++i) {
    at.rows.push_back(place(system.outputs, spatial::direction_names[i]));
    at.columns.push_back(place(system.inputs, wrenches[i]));
    if (at.rows.back() < 0 || at.columns.back() < 0) return {};
  }
  return at;
}

/// Poles of a sampled system as those of a continuous one.
Eigen::VectorXcd poles_of(const StateSpace& system) {
  const VectorXd d = numerics::balancing(system.A);
  Eigen::VectorXcd poles =
      numerics::eigenvalues(d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal());
  if (system.sample_time > 0.0)
    for (Complex& z : poles) z = std::log(z) / system.sample_time;
  return poles;
}

std::vector<Matrix6c> responses_of(const StateSpace& system, const Places& at,
                                   const std::vector<double>& lines) {
  std::vector<Matrix6c> all;
  const MatrixXd B = system.B(Eigen::all, at.columns), C = system.C(at.rows, Eigen::all),
                 D = system.D(at.rows, at.columns);
  for (const double omega : lines) {
    MatrixXcd A = -system.A.cast<Complex>();
    A.diagonal().array() += Complex(0.0, omega);
    all.emplace_back(C * numerics::solve(A, B.cast<Complex>()) + D);
  }
  return all;
}

/// Own poles as a sampled system of `sample_time` shows them: within half the rate.
std::vector<Complex> seen(std::vector<Complex> poles, double sample_time) {
  if (sample_time > 0.0)
    std::erase_if(poles, [&](Complex pole) {
      return std::abs(pole.imag()) >= std::numbers::pi / sample_time;
    });
  return poles;
}

Parity measured_mechanics(const Machine& machine, const Pose& X_BP,
                          const StateSpaceOptions& options, const StateSpace& held) {
  const auto own = own_model(machine, X_BP, options.kind);
  Parity parity;
  const auto poles = seen(own_poles(own), held.sample_time);
  if (!held.reduction && !poles.empty())
    parity.push_back(
        measured("poles, measured", farthest(poles, poles_of(held)), "those of `modes`"));
  const auto at = places_in(held);
  if (!at || held.sample_time > 0.0) return parity;
  const auto lines = lines_of(machine, X_BP);
  const auto responses = response::frequency_response(
      response::response_model(own.linear, own.normal, own.ratio, options.p_PQ), lines);
  parity.push_back(measured("responses, measured",
                            largest_difference(responses, responses_of(held, *at, lines)),
                            "the largest of `bode`"));
  return parity;
}

/// The platform under a constant wrench about its mass centre.
struct Push {
  Vector6 wrench{Vector6::Zero()};
  double sample_time{}, until{};
};

/// Displacements of the platform's origin at every sample.
std::vector<Vector6> simulated(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                               bool closed, const Push& push) {
  constexpr double tight = 1e-7;
  simulation::ClosedLoop loop(
      machine, X_BP,
      {.kind = kind,
       .integrator = {.relative_tolerance = tight, .absolute_tolerance = tight},
       .until = push.until,
       .output_interval = push.sample_time,
       .ideal_sensors = true,
       .actuators = closed ? simulation::Actuators::controlled : simulation::Actuators::held});
  std::vector<Vector6> motion;
  loop.run([&](double, simulation::Excitation& excitation) { excitation.wrench = push.wrench; },
           [&](const simulation::LoopSample& sample) {
             motion.push_back(simulation::displacement_between(X_BP, sample.plant.X_BP));
           });
  return motion;
}

/// The same by the file's equations.
std::vector<Vector6> propagated(const StateSpace& system, const Places& at, const Push& push,
                                std::size_t count) {
  const auto sampled = system.sample_time > 0.0 ? system : discretised(system, push.sample_time);
  const MatrixXd C = sampled.C(at.rows, Eigen::all);
  const VectorXd input = sampled.B(Eigen::all, at.columns) * push.wrench;
  VectorXd x = VectorXd::Zero(sampled.A.rows());
  std::vector<Vector6> motion;
  for (std::size_t k = 0; k < count; ++k) {
    motion.emplace_back(C * x);
    x = sampled.A * x + input;
  }
  return motion;
}

/// The push whose static displacement by the rigid model is `size` in every direction [m, rad].
Push push_of(const Machine& machine, const Pose& X_BP, const StateSpace& held, double size) {
  const auto rigid = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::rigid);
  const auto modes = modal::normal_modes(rigid);
  constexpr double periods = 5.0, longest = 2.0, per_second = 1e3, most_samples = 5e3;
  Push push;
  push.wrench = rigid.K.topLeftCorner<6, 6>().diagonal() * size;
  push.sample_time = held.sample_time > 0.0 ? held.sample_time : 1.0 / per_second;
  push.until = std::min({longest, periods * base::two_pi / std::max(modes.omega(0), 1e-3),
                         most_samples * push.sample_time});
  return push;
}

/// Largest difference over the largest displacement, lengths and angles apart.
double relative_difference(const std::vector<Vector6>& own, const std::vector<Vector6>& held) {
  Vector6 sizes = Vector6::Zero(), differences = Vector6::Zero();
  for (std::size_t k = 0; k < own.size(); ++k) {
    sizes = sizes.cwiseMax(own[k].cwiseAbs());
    differences = differences.cwiseMax((held[k] - own[k]).cwiseAbs());
  }
  return std::max(differences.head<3>().maxCoeff() / sizes.head<3>().maxCoeff(),
                  differences.tail<3>().maxCoeff() / sizes.tail<3>().maxCoeff());
}

/// A small push and one that shows what is lost in large motions.
Parity measured_motion(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                       const StateSpace& held) {
  const bool closed = held.system == SystemKind::loop;
  const auto at = places_in(held);
  if (!at) return {};
  Parity parity;
  constexpr double thousandth = 1e-3;
  for (const double size : {1e-6, 1e-4}) {
    const auto push = push_of(machine, X_BP, held, size);
    if (!(push.until > 2.0 * push.sample_time)) return parity;
    const auto motion = simulated(machine, X_BP, kind, closed, push);
    if (motion.size() < 2) return parity;
    const double difference =
        relative_difference(motion, propagated(held, *at, push, motion.size()));
    double largest = 0.0;
    for (const auto& one : motion) largest = std::max(largest, one.head<3>().cwiseAbs().maxCoeff());
    parity.push_back(
        {difference <= thousandth ? Held::exact : Held::approximate,
         "motion under a push, measured",
         fmt::format("by {:.2g} mm in {:.2g} s: within {:.1e} of `simulate{}`", 1e3 * largest,
                     push.until, difference, closed ? "" : " --actuators held")});
  }
  return parity;
}

Parity measured_actuators(const Machine& machine, const Pose& X_BP,
                          const StateSpaceOptions& options, const StateSpace& held) {
  Parity parity;
  const bool closed = options.system == SystemKind::loop;
  if (!held.reduction) {
    const auto system = simulation::linear_system(
        machine, X_BP, {.kind = options.kind, .pade_order = options.pade_order, .closed = closed});
    const auto all = simulation::system_poles(system);
    std::vector<Complex> poles;
    if (options.sampled_controller)
      poles = all.sampled;
    else
      for (const auto& one : all.poles) poles.push_back(one.pole);
    std::erase_if(poles, [](Complex pole) { return std::abs(pole) < 1e-3; });
    poles = seen(std::move(poles), held.sample_time);
    if (!poles.empty())
      parity.push_back(measured("poles, measured", farthest(poles, poles_of(held)),
                                "those of `modes --system`"));
  }
  for (auto& line : measured_motion(machine, X_BP, options.kind, held))
    parity.push_back(std::move(line));
  return parity;
}

}  // namespace

Parity measured_state_space(const Machine& machine, const Pose& X_BP,
                            const StateSpaceOptions& options, const StateSpace& held) {
  return options.system == SystemKind::mechanics ? measured_mechanics(machine, X_BP, options, held)
                                                 : measured_actuators(machine, X_BP, options, held);
}

Parity measured_modes(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                      const data::ModalResults& held) {
  const auto own = own_model(machine, X_BP, kind);
  Eigen::VectorXcd poles(static_cast<Index>(held.modes.size()));
  for (Index k = 0; k < poles.size(); ++k) poles[k] = held.modes[static_cast<std::size_t>(k)].pole;
  Parity parity;
  if (poles.size() > 0)
    parity.push_back(measured("poles, measured", farthest(own_poles(own), poles),
                              "those of `modes`, read back"));
  if (held.inputs.size() != 6 || held.outputs.size() < 6) {
    parity.push_back({Held::approximate, "participation of the modes",
                      "not held: complex modes share a pole, and each number would be any mix"});
    return parity;
  }
  const auto lines = lines_of(machine, X_BP);
  std::vector<Matrix6c> synthesised;
  for (const double omega : lines) {
    Matrix6c H = Matrix6c::Zero();
    const Complex s(0.0, omega);
    for (const auto& mode : held.modes) {
      if (mode.participation.size() != 6) return parity;
      const Matrix6c residue = mode.shape.head(6) * mode.participation.transpose();
      H += residue / (s - mode.pole) + residue.conjugate() / (s - std::conj(mode.pole));
    }
    synthesised.push_back(H);
  }
  const auto responses = response::frequency_response(
      response::response_model(own.linear, own.normal, own.ratio, machine.platform.mass_center),
      lines);
  parity.push_back(measured("responses, measured", largest_difference(responses, synthesised),
                            "the largest of `bode`, read back"));
  return parity;
}

Parity measured_superelement(const Machine& of_file, const Pose& X_BP,
                             const SuperelementOptions& options, const Superelement& held) {
  auto machine = of_file;
  if (options.base) machine.base_mount.reset();
  const auto own = own_model(machine, X_BP, options.kind);
  std::vector<Index> kept(static_cast<std::size_t>(held.M.rows()));
  std::iota(kept.begin(), kept.end(), Index{0});
  if (held.is_base_free) kept.erase(kept.begin() + 6, kept.begin() + 12);  // the base is held
  const MatrixXd M = held.M(kept, kept), K = held.K(kept, kept), C = held.C(kept, kept);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K, M, Eigen::EigenvaluesOnly);
  const std::string still = options.base ? ", the base held" : "";
  const Index count = held.first_left_out > 0.0 ? 6 : own.normal.omega2.size();
  double worst = 0.0;
  for (Index k = 0; k < count; ++k)
    if (const double own_square = own.normal.omega2[k]; own_square != 0.0)
      worst = std::max(worst,
                       std::abs(std::sqrt(std::abs(solver.eigenvalues()[k] / own_square)) - 1.0));
  Parity parity{measured(count == 6 && own.normal.size() > 6 ? "six lowest frequencies, measured"
                                                             : "frequencies, measured",
                         worst, "those of `modes`" + still)};
  const auto lines = lines_of(machine, X_BP);
  std::vector<Matrix6c> responses;
  for (const double omega : lines) {
    const MatrixXcd Z = (K - omega * omega * M).cast<Complex>() + Complex(0.0, omega) * C;
    responses.emplace_back(numerics::solve(Z, MatrixXcd::Identity(Z.rows(), 6)).topRows<6>());
  }
  const auto expected = response::frequency_response(
      response::response_model(own.linear, own.normal, own.ratio, options.p_PQ), lines);
  parity.push_back(measured("responses, measured", largest_difference(expected, responses),
                            "the largest of `bode`" + still));
  return parity;
}

}  // namespace hydrapod::exchange
