#include "hydrapod/simulation/linear_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::simulation {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double equal_tolerance = 1e-6;  // relative: poles nearer than this are one group

/// A in units in which the states matter alike.
MatrixXd scaled(const LinearSystem& system) {
  return system.scales.cwiseInverse().asDiagonal() * system.A * system.scales.asDiagonal();
}

bool are_equal(Complex a, Complex b) {
  return std::abs(a - b) <= equal_tolerance * std::max({std::abs(a), std::abs(b), 1.0});
}

/// Numbers of groups of equal poles, each pole compared with the one before it in `order`.
std::vector<int> groups(const Eigen::VectorXcd& poles, const std::vector<int>& order) {
  std::vector<int> group(order.size());
  int count = 0;
  for (size_t k = 0; k < order.size(); ++k) {
    bool found = false;
    for (size_t before = k; before-- > 0 && !found;) {
      if (!are_equal(poles[order[before]], poles[order[k]])) continue;
      group[k] = group[before];
      found = true;
    }
    if (!found) group[k] = count++;
  }
  return group;
}

SystemPole described(Complex pole, int group, const Eigen::VectorXd& shares,
                     const std::vector<StatePart>& parts) {
  SystemPole found{.pole = pole, .omega = std::abs(pole), .group = group};
  found.damping_ratio = found.omega > 0.0 ? -pole.real() / found.omega : 0.0;
  const double sum = shares.sum();
  for (size_t k = 0; k < parts.size(); ++k) {
    const double share = shares[static_cast<Eigen::Index>(k)] / sum;
    found.parts[static_cast<size_t>(parts[k].part)] += share;
    const auto part = parts[k].part;
    const bool of_leg = part == Part::seal || part == Part::oil || part == Part::line ||
                        part == Part::valve || part == Part::motor;
    if (of_leg && parts[k].leg >= 0) found.legs[static_cast<size_t>(parts[k].leg)] += share;
  }
  return found;
}

void sampled_poles(const LinearSystem& system, SystemPoles& found) {
  found.sampled_stable = found.stable;
  if (system.sampled.size() == 0) return;
  const Eigen::VectorXd d = numerics::balancing(system.sampled);
  const MatrixXd A = d.cwiseInverse().asDiagonal() * system.sampled * d.asDiagonal();
  found.largest_modulus = 0.0;
  for (const Complex z : numerics::eigenvalues(A)) {
    found.largest_modulus = std::max(found.largest_modulus, std::abs(z));
    if (z.imag() < 0.0 || std::abs(z) < 1e-12) continue;  // conjugates; drives that are forgotten
    found.sampled.push_back(std::log(z) / system.sample_time);
  }
  found.sampled_stable = std::ranges::none_of(found.sampled, grows);
  std::sort(found.sampled.begin(), found.sampled.end(), [](Complex a, Complex b) {
    return a.real() != b.real() ? a.real() > b.real() : a.imag() < b.imag();
  });
}

}  // namespace

bool grows(Complex pole) {
  return pole.real() >= (pole.imag() > 0.0 ? rounded_growth * std::abs(pole) : 0.0);
}

void mark_growing(SystemPoles& poles) {
  for (auto& pole : poles.poles) pole.stable = !poles.sampled.empty() || !grows(pole.pole);
  for (const auto& s : poles.sampled) {
    if (!grows(s)) continue;
    SystemPole* nearest = nullptr;
    for (auto& pole : poles.poles)
      if (pole.stable &&
          (nearest == nullptr || std::abs(pole.pole - s) < std::abs(nearest->pole - s)))
        nearest = &pole;
    if (nearest != nullptr) nearest->stable = false;
  }
}

SystemPoles system_poles(const LinearSystem& system) {
  const Eigen::VectorXd d = numerics::balancing(system.A);
  const auto pairs =
      numerics::eigen_pairs(d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal());
  if (!pairs.converged)
    throw base::ComputationError(
        "the poles of the system could not be computed: the QR iteration "
        "did not converge");
  const Eigen::VectorXcd& poles = pairs.values;
  const MatrixXcd &V = pairs.vectors, W = numerics::inverse(V);  // rows: left eigenvectors
  std::vector<int> order;
  for (int k = 0; k < poles.size(); ++k)
    if (poles[k].imag() >= 0.0) order.push_back(k);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Complex p = poles[a], q = poles[b];
    return p.real() != q.real() ? p.real() > q.real() : p.imag() < q.imag();
  });
  const auto group = groups(poles, order);

  SystemPoles found;
  for (size_t k = 0; k < order.size(); ++k) {
    Eigen::VectorXcd diagonal = Eigen::VectorXcd::Zero(poles.size());
    for (size_t j = 0; j < order.size(); ++j)
      if (group[j] == group[k])
        diagonal += V.col(order[j]).cwiseProduct(W.row(order[j]).transpose());
    found.poles.push_back(described(poles[order[k]], group[k], diagonal.cwiseAbs(), system.parts));
    const Eigen::VectorXcd v = d.cast<Complex>().cwiseProduct(V.col(order[k]));
    if (system.C.rows() == 6) found.poles.back().motion = system.C.cast<Complex>() * v;
    if (system.C_ground.rows() == 6)
      found.poles.back().ground_motion = system.C_ground.cast<Complex>() * v;
  }
  found.largest_real = found.poles.empty() ? -std::numeric_limits<double>::infinity()
                                           : found.poles.front().pole.real();
  found.stable = std::ranges::none_of(
      found.poles, [](const SystemPole& described) { return grows(described.pole); });
  sampled_poles(system, found);
  mark_growing(found);
  return found;
}

Eigen::Matrix<Complex, 6, 6> command_response(const LinearSystem& system, double omega) {
  const Complex s(0.0, omega);
  const auto& d = system.scales;
  MatrixXcd pencil = -scaled(system).cast<Complex>();
  pencil.diagonal().array() += s;
  const MatrixXcd B = d.cwiseInverse().asDiagonal() *
                      (system.B_command.cast<Complex>() + s * system.B_velocity.cast<Complex>());
  const MatrixXcd C = (system.C * d.asDiagonal()).cast<Complex>();
  return C * numerics::solve(pencil, B);
}

}  // namespace hydrapod::simulation
