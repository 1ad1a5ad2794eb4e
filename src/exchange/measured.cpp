/// What a file holds, computed beside what hydrapod computes of the machine.
///
/// Poles: each of hydrapod's against its partner in the file, |Δλ|/|λ|. Responses: over 60 lines
/// from a third of the lowest to three times the highest frequency of the rigid model,
/// |ΔH_ij|/√(max|H_ii| max|H_jj|). Motion: a constant push on the platform, of a loop a step of its
/// command, in all six directions, in the nonlinear simulation and in the file's equations, over
/// five periods of the lowest mode.

#include "measured.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "hydrapod/base/units.hpp"
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
using spatial::Vector6;

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

/// Columns of the inputs `prefix` + names and rows of the displacement.
struct Places {
  std::vector<Index> rows{}, columns{};
};

/// None where one of them is missing.
std::optional<Places> places_in(const StateSpace& system, const std::string& prefix,
                                const std::array<const char*, 6>& names) {
  Places at;
  for (std::size_t i = 0; i < 6; ++i) {
    at.rows.push_back(place(system.outputs, spatial::direction_names[i]));
    at.columns.push_back(place(system.inputs, prefix + names[i]));
    if (at.rows.back() < 0 || at.columns.back() < 0) return {};
  }
  return at;
}

std::optional<Places> wrench_places(const StateSpace& system) {
  return places_in(system, "wrench.", {"fx", "fy", "fz", "mx", "my", "mz"});
}

/// Of a sampled system as those of a continuous one.
Eigen::VectorXcd poles_of(const StateSpace& system) {
  Eigen::VectorXcd poles = eigenvalues_of(system);
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
  const auto at = wrench_places(held);
  if (!at || held.sample_time > 0.0) return parity;
  const auto lines = lines_of(machine, X_BP);
  const auto responses = response::frequency_response(
      response::response_model(own.linear, own.normal, own.ratio, options.p_PQ), lines);
  parity.push_back(measured("responses, measured",
                            largest_difference(responses, responses_of(held, *at, lines)),
                            "the largest of `bode`"));
  return parity;
}

/// From rest, held from the beginning on: a wrench about the mass centre, or of a loop a command.
struct Trial {
  bool of_loop{};
  Vector6 input{Vector6::Zero()};
  double sample_time{}, until{};
};

/// Displacements of the platform's origin at every sample.
std::vector<Vector6> simulated(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                               const Trial& trial) {
  constexpr double tight = 1e-7;
  simulation::ClosedLoop loop(
      machine, X_BP,
      {.kind = kind,
       .integrator = {.relative_tolerance = tight, .absolute_tolerance = tight},
       .until = trial.until,
       .output_interval = trial.sample_time,
       .ideal_sensors = true,
       .actuators =
           trial.of_loop ? simulation::Actuators::controlled : simulation::Actuators::held});
  std::vector<Vector6> motion;
  loop.run(
      [&](double, simulation::Excitation& excitation) {
        (trial.of_loop ? excitation.command.value : excitation.wrench) = trial.input;
      },
      [&](const simulation::LoopSample& sample) {
        motion.push_back(simulation::displacement_between(X_BP, sample.plant.X_BP));
      });
  return motion;
}

/// The same by the file's equations.
std::vector<Vector6> propagated(const StateSpace& system, const Places& at, const Trial& trial,
                                std::size_t count) {
  const auto sampled = system.sample_time > 0.0 ? system : discretised(system, trial.sample_time);
  const MatrixXd C = sampled.C(at.rows, Eigen::all);
  const VectorXd input = sampled.B(Eigen::all, at.columns) * trial.input;
  VectorXd x = VectorXd::Zero(sampled.A.rows());
  std::vector<Vector6> motion;
  for (std::size_t k = 0; k < count; ++k) {
    motion.emplace_back(C * x);
    x = sampled.A * x + input;
  }
  return motion;
}

/// `size` [m, rad]: of the command, or of the static displacement by the wrench with rigid legs.
Trial trial_of(const Machine& machine, const Pose& X_BP, const StateSpace& held, double size) {
  const auto rigid = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::rigid);
  const auto modes = modal::normal_modes(rigid);
  constexpr double periods = 5.0, longest = 2.0, per_second = 1e3, most_samples = 5e3;
  Trial trial{.of_loop = held.system == SystemKind::loop};
  trial.input = trial.of_loop ? Vector6(Vector6::Constant(size))
                              : Vector6(rigid.K.topLeftCorner<6, 6>().diagonal() * size);
  trial.sample_time = held.sample_time > 0.0 ? held.sample_time : 1.0 / per_second;
  trial.until = std::min({longest, periods * base::two_pi / std::max(modes.omega(0), 1e-3),
                          most_samples * trial.sample_time});
  return trial;
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

/// A small motion, and one that shows what is lost in large ones. The simulation is not linear:
/// no file has it exactly.
Parity measured_motion(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                       const StateSpace& held) {
  const bool of_loop = held.system == SystemKind::loop;
  const auto at =
      of_loop ? places_in(held, "command.", spatial::direction_names) : wrench_places(held);
  if (!at) return {};
  Parity parity;
  for (const double size : of_loop ? std::array{1e-5, 1e-3} : std::array{1e-6, 1e-4}) {
    const auto trial = trial_of(machine, X_BP, held, size);
    if (!(trial.until > 2.0 * trial.sample_time)) return parity;
    const auto motion = simulated(machine, X_BP, kind, trial);
    if (motion.size() < 2) return parity;
    const double difference =
        relative_difference(motion, propagated(held, *at, trial, motion.size()));
    double largest = 0.0;
    for (const auto& one : motion) largest = std::max(largest, one.head<3>().cwiseAbs().maxCoeff());
    parity.push_back(
        {Held::approximate,
         of_loop ? "motion after a step of the command, measured" : "motion under a push, measured",
         fmt::format("by {:.2g} mm in {:.2g} s: within {:.1e} of `simulate{}`", 1e3 * largest,
                     trial.until, difference, of_loop ? "" : " --actuators held")});
  }
  return parity;
}

/// Of a continuous system and of the sampled loop A is that of `modes --system` itself.
Parity measured_actuators(const Machine& machine, const Pose& X_BP,
                          const StateSpaceOptions& options, const StateSpace& held) {
  Parity parity;
  if (held.sample_time > 0.0 && !options.sampled_controller && !held.reduction) {
    const bool closed = options.system == SystemKind::loop;
    const auto system = simulation::linear_system(machine, X_BP,
                                                  {.kind = options.kind,
                                                   .pade_order = options.pade_order,
                                                   .closed = closed,
                                                   .sampled = false});
    std::vector<Complex> poles;
    constexpr double integrators = 1e-3;  // [1/s]
    for (const auto& one : simulation::system_poles(system).poles)
      if (std::abs(one.pole) > integrators) poles.push_back(one.pole);
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

ParityLine measured(const std::string& what, double difference, const std::string& beside,
                    double exact_to) {
  return {difference <= exact_to ? Held::exact : Held::approximate, what,
          difference == 0.0 ? "no difference from " + beside
                            : fmt::format("within {:.1e} of {}", difference, beside)};
}

Eigen::VectorXcd eigenvalues_of(const StateSpace& system) {
  const VectorXd d = numerics::balancing(system.A);
  return numerics::eigenvalues(d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal());
}

double frequency_difference(VectorXd own, VectorXd held, Index count) {
  std::ranges::sort(own);
  std::ranges::sort(held);
  double largest = 0.0;
  for (Index k = 0; k < count; ++k) {
    if (own[k] == 0.0) continue;
    const double ratio = held[k] / own[k];
    largest = std::max(largest, ratio > 0.0 ? std::abs(std::sqrt(ratio) - 1.0) : 1.0);
  }
  return largest;
}

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
                      "not held: complex modes share a pole, and their shapes are any mix"});
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
  if (options.free_base) machine.base_mount.reset();
  const auto own = own_model(machine, X_BP, options.kind);
  const auto still = with_base_held(held);
  const std::string beside = options.free_base ? ", the base held" : "";
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(still.K, still.M,
                                                                  Eigen::EigenvaluesOnly);
  const bool whole = held.first_left_out == 0.0;
  constexpr Index of_platform = 6;
  Parity parity{measured(whole ? "frequencies, measured" : "six lowest frequencies, measured",
                         frequency_difference(own.normal.omega2, solver.eigenvalues(),
                                              whole ? own.normal.omega2.size() : of_platform),
                         "those of `modes`" + beside)};
  const auto lines = lines_of(machine, X_BP);
  std::vector<Matrix6c> responses;
  for (const double omega : lines) {
    const MatrixXcd Z =
        (still.K - omega * omega * still.M).cast<Complex>() + Complex(0.0, omega) * still.C;
    responses.emplace_back(numerics::solve(Z, MatrixXcd::Identity(Z.rows(), 6)).topRows<6>());
  }
  const auto expected = response::frequency_response(
      response::response_model(own.linear, own.normal, own.ratio, options.p_PQ), lines);
  parity.push_back(measured("responses, measured", largest_difference(expected, responses),
                            "the largest of `bode`" + beside));
  return parity;
}

}  // namespace hydrapod::exchange
