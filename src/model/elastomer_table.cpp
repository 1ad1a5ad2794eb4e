#include "elastomer_table.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "hydrapod/base/units.hpp"

namespace hydrapod::model {

namespace {

using Complex = std::complex<double>;

/// Rows as complex stiffnesses over k, less the spring itself.
struct Measured {
  Eigen::VectorXd omega{};
  Eigen::VectorXcd wanted{};
  Eigen::VectorXd weight{};  ///< one over the stiffness
};

Measured measured(const std::vector<ElastomerRow>& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  Measured m{Eigen::VectorXd(n), Eigen::VectorXcd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& row = rows[static_cast<std::size_t>(i)];
    const Complex k = row.ratio * Complex(1.0, row.loss);
    m.omega[i] = base::two_pi * row.frequency;
    m.wanted[i] = k - 1.0;
    m.weight[i] = 1.0 / std::abs(k);
  }
  return m;
}

Complex arm(double omega, double time) {
  const Complex x(0.0, omega * time);
  return x / (1.0 + x);
}

/// Normal equations of arms with given times: a row and a column per arm.
struct Normal {
  Eigen::MatrixXd gram{};
  Eigen::VectorXd right{};
  double square{};  ///< of what is wanted
};

Normal normal(const Measured& m, const std::vector<double>& times) {
  const auto n = m.omega.size();
  const auto arms = static_cast<Eigen::Index>(times.size());
  Eigen::MatrixXd A(2 * n, arms);
  Eigen::VectorXd b(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < arms; ++j) {
      const Complex a = m.weight[i] * arm(m.omega[i], times[static_cast<std::size_t>(j)]);
      A(2 * i, j) = a.real();
      A(2 * i + 1, j) = a.imag();
    }
    b[2 * i] = m.weight[i] * m.wanted[i].real();
    b[2 * i + 1] = m.weight[i] * m.wanted[i].imag();
  }
  return {A.transpose() * A, A.transpose() * b, b.squaredNorm()};
}

/// The best strengths of three of the arms, and what is left.
struct Strengths {
  Vector3 value{Vector3::Zero()};
  double left{};
};

Strengths strengths(const Normal& equations, const std::array<Eigen::Index, 3>& arms) {
  Strengths best{.left = equations.square};
  for (unsigned set = 1; set < 8; ++set) {
    std::vector<Eigen::Index> used, places;
    for (std::size_t j = 0; j < 3; ++j)
      if ((set >> j & 1U) != 0) {
        used.push_back(arms[j]);
        places.push_back(static_cast<Eigen::Index>(j));
      }
    const Eigen::MatrixXd gram = equations.gram(used, used);
    const Eigen::VectorXd right = equations.right(used);
    const Eigen::VectorXd g = gram.ldlt().solve(right);
    if (!g.allFinite() || g.minCoeff() <= 0.0) continue;
    const double left = equations.square + g.dot(gram * g - 2.0 * right);
    if (left >= best.left) continue;
    best = {.left = left};
    best.value(places) = g;
  }
  return best;
}

Strengths strengths(const Measured& m, const Vector3& times) {
  return strengths(normal(m, {times[0], times[1], times[2]}), {0, 1, 2});
}

/// Times of arms [s]: those of the frequencies and a decade to both sides.
struct Range {
  double shortest{}, longest{};
};

Range range_of(const Measured& m) {
  constexpr double beyond = 10.0;
  return {1.0 / (beyond * m.omega.maxCoeff()), beyond / m.omega.minCoeff()};
}

Vector3 coarse_times(const Measured& m, const Range& range, double step) {
  std::vector<double> grid;
  for (double time = range.longest; time > range.shortest; time /= step) grid.push_back(time);
  const Normal equations = normal(m, grid);
  const auto size = static_cast<Eigen::Index>(grid.size());
  std::array<Eigen::Index, 3> best{};
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = i + 1; j < size; ++j)
      for (Eigen::Index k = j + 1; k < size; ++k) {
        const double left = strengths(equations, {i, j, k}).left;
        if (left >= least) continue;
        least = left;
        best = {i, j, k};
      }
  const auto at = [&](Eigen::Index k) { return grid[static_cast<std::size_t>(k)]; };
  return {at(best[0]), at(best[1]), at(best[2])};
}

/// Each time in turn is moved by a step, which is halved where none improves.
Vector3 refined(const Measured& m, const Range& range, Vector3 times, double step) {
  constexpr double finest = 1.0 + 1e-7;
  double left = strengths(m, times).left;
  while (step > finest) {
    bool moved = false;
    for (int j = 0; j < 3; ++j)
      for (const double factor : {step, 1.0 / step}) {
        Vector3 other = times;
        other[j] = std::clamp(other[j] * factor, range.shortest, range.longest);
        const double now = strengths(m, other).left;
        if (now >= left) continue;
        left = now;
        times = other;
        moved = true;
      }
    if (!moved) step = std::sqrt(step);
  }
  return times;
}

}  // namespace

FittedArms fitted_arms(const std::vector<ElastomerRow>& rows) {
  constexpr double coarse = 2.5;
  const Measured m = measured(rows);
  const Range range = range_of(m);
  const Vector3 times = refined(m, range, coarse_times(m, range, coarse), std::sqrt(coarse));
  FittedArms fit{.arms = {.strength = strengths(m, times).value, .time = times}};
  for (Eigen::Index i = 0; i < m.omega.size(); ++i) {
    Complex k = -m.wanted[i];
    for (int j = 0; j < 3; ++j) k += fit.arms.strength[j] * arm(m.omega[i], times[j]);
    const double error = m.weight[i] * std::abs(k);
    if (error <= fit.worst) continue;
    fit.worst = error;
    fit.worst_frequency = rows[static_cast<std::size_t>(i)].frequency;
  }
  return fit;
}

void read_elastomer_table(const Section& seal, std::optional<Elastomer>& elastomer,
                          KnownFits& known, std::vector<Finding>& findings) {
  const auto value = seal.optional_table("elastomer").find("table");
  if (!value || !elastomer) return;
  if (elastomer->arms) {
    findings.push_back({base::Severity::warning, value.path, "has no effect beside `arms`"});
    return;
  }
  elastomer->arms = {.strength = Vector3::Constant(unread), .time = Vector3::Constant(unread)};
  constexpr std::size_t fewest = 2, most = 1000;
  const std::size_t size = value.node->children.size();
  const bool are_rows = value.node->kind == Node::Kind::array && size >= fewest && size <= most;
  const std::string what =
      fmt::format("{} rows of [frequency in Hz, dynamic_ratio, loss_factor]",
                  are_rows ? fmt::format("{}", size) : fmt::format("{} to {}", fewest, most));
  std::vector<ElastomerRow> rows;
  for (const auto& line : seal.elements(value, are_rows ? size : most, what)) {
    const auto cells = seal.elements(line, 3, "[frequency in Hz, dynamic_ratio, loss_factor]");
    if (cells.size() < 3) return;
    rows.push_back({seal.read_number(cells[0], "Hz"), seal.read_number(cells[1], "1"),
                    seal.read_number(cells[2], "1")});
    constexpr double lowest = 1e-6, highest = 1e6;  // [Hz]
    if (!(rows.back().frequency >= lowest && rows.back().frequency <= highest))
      return seal.report(cells[0], "is no frequency from 1e-6 Hz to 1e6 Hz");
    if (!(rows.back().ratio > 1.0)) return seal.report(cells[1], "expected more than 1");
    if (!(rows.back().loss > 0.0)) return seal.report(cells[2], "expected more than 0");
  }
  if (rows.empty()) return;
  auto fitted = known.find(value.node);
  if (fitted == known.end()) fitted = known.emplace(value.node, fitted_arms(rows)).first;
  const auto& fit = fitted->second;
  elastomer->arms = fit.arms;
  constexpr double good = 0.05;
  if (fit.worst > good)
    findings.push_back({base::Severity::warning, value.path,
                        fmt::format("three arms miss the stiffness by {:.2g} % at {:.4g} Hz",
                                    100.0 * fit.worst, fit.worst_frequency)});
}

}  // namespace hydrapod::model
