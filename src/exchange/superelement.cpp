#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::exchange {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Large-field number of 16 characters: as many digits as fit, the exponent without its letter.
std::string large_field(double value) {
  if (value == 0.0) return "             0.0";
  for (int digits = 12; digits > 0; --digits) {
    std::string text = fmt::format("{:.{}e}", value, digits);
    const auto e = text.find('e');
    const int exponent = std::stoi(text.substr(e + 1));
    text = text.substr(0, e) + fmt::format("{:+d}", exponent);
    if (text.size() <= 16) return fmt::format("{:>16}", text);
  }
  throw std::invalid_argument("DMIG: a number does not fit 16 characters");
}

/// GRID of the real coordinates, an SPOINT (component 0) for each mode.
struct Place {
  int point{}, component{};
};

Place place(const Superelement& element, Index i) {
  const auto platform = static_cast<Index>(element.platform);
  const auto base = static_cast<Index>(element.base_directions.size());
  if (i < platform) return {dmig_platform, static_cast<int>(i) + 1};
  if (i < platform + base)
    return {dmig_base, element.base_directions[static_cast<std::size_t>(i - platform)] + 1};
  return {dmig_mode + static_cast<int>(i - platform - base), 0};
}

/// Of a symmetric matrix the lower triangle, column by column, without zeros.
std::string dmig_matrix(const std::string& name, const MatrixXd& matrix,
                        const Superelement& element) {
  std::string text = fmt::format("DMIG    {:<8}{:>8}{:>8}{:>8}{:>8}\n", name, 0, 6, 2, 0);
  for (Index j = 0; j < matrix.cols(); ++j) {
    std::string rows;
    for (Index i = j; i < matrix.rows(); ++i) {
      if (matrix(i, j) == 0.0) continue;
      const auto at = place(element, i);
      rows += fmt::format("*       {:>16}{:>16}{}\n", at.point, at.component,
                          large_field(matrix(i, j)));
    }
    const auto at = place(element, j);
    if (!rows.empty())
      text += fmt::format("DMIG*   {:<16}{:>16}{:>16}{:>16}\n", name, at.point, at.component, "") +
              rows;
  }
  return text;
}

std::string grid(int number, const Vector3& p) {
  return fmt::format("GRID*   {:>16}{:>16}{}{}\n*       {}\n", number, 0, large_field(p.x()),
                     large_field(p.y()), large_field(p.z()));
}

/// Coordinates: platform at Q, legs, base, payload.
struct Matrices {
  MatrixXd M{}, K{}, C{};
  std::vector<int> base_directions{};
  std::vector<std::string> payload{};
  Vector3 p_BQ{};
};

Matrices on_its_base(const Machine& machine, const Pose& X_BP, const SuperelementOptions& options) {
  const auto linear = dynamics::linear_model(machine, X_BP, options.kind);
  const auto at_Q = response::response_model(linear, modal::normal_modes(linear),
                                             model::modal_ratio(machine).value, options.p_PQ);
  return {at_Q.M,
          at_Q.K,
          response::damping_matrix(at_Q),
          linear.base_directions,
          linear.payload_names,
          at_Q.p_BQ};
}

/// Springs and dampers act on the motion against the base, y − T q_b. M is that of a base with a
/// mass, less that mass.
Matrices on_a_free_base(Machine machine, const Pose& X_BP, const SuperelementOptions& options) {
  machine.base_mount.reset();
  const auto still = on_its_base(machine, X_BP, options);
  auto& mount = machine.base_mount.emplace();
  mount.stiffness.fill(0.0);
  mount.mass = 1.0;
  mount.inertia.setOnes();
  const auto linear = dynamics::linear_model(machine, X_BP, options.kind);
  const Index n = linear.dof(), first = linear.first_of_base();
  const auto carried = [](const Vector3& arm) {  // motion of a point per motion of one at −arm
    spatial::Matrix6 T = spatial::Matrix6::Identity();
    T.topRightCorner<3, 3>() = -spatial::skew(arm);
    return T;
  };
  MatrixXd at_C = MatrixXd::Identity(n, n);  // motion of C per motion of Q
  at_C.topLeftCorner<6, 6>() = carried(linear.p_BC - still.p_BQ);
  MatrixXd M = linear.M;
  M.diagonal().segment(first, 6).array() -= 1.0;
  MatrixXd against_base = MatrixXd::Zero(n - 6, n);
  against_base.leftCols(first).setIdentity();
  against_base.block(0, first, 6, 6) = -carried(still.p_BQ);
  const Index payload = linear.payload_count();
  against_base.bottomRightCorner(payload, payload).setIdentity();
  return {at_C.transpose() * M * at_C,
          against_base.transpose() * still.K * against_base,
          against_base.transpose() * still.C * against_base,
          {0, 1, 2, 3, 4, 5},
          still.payload,
          still.p_BQ};
}

}  // namespace

Superelement superelement(const Machine& machine, const Pose& X_BP,
                          const SuperelementOptions& options) {
  if (model::has_chambers(machine))
    base::refuse("damping.oil",
                 "is \"chambers\": a superelement holds M, K and C, and chambers with dampers in "
                 "series need states; expected a state space (--to mat, npz, json or hdf5), or "
                 "\"viscous\" (--set damping.oil=viscous)");
  if (model::has_elastomers(machine) && options.kind != dynamics::ModelKind::rigid)
    base::refuse(
        "elastomer",
        "of a seal is a spring that depends on frequency: a superelement holds M, K and C, "
        "and its dampers in series need states; expected a state space (--to mat, npz, "
        "json or hdf5), or a machine file without `elastomer`");
  const auto at_Q = options.free_base ? on_a_free_base(machine, X_BP, options)
                                      : on_its_base(machine, X_BP, options);
  const Index n = at_Q.M.rows(),
              beyond = static_cast<Index>(at_Q.base_directions.size() + at_Q.payload.size()),
              legs = n - 6 - beyond, held = 6 + beyond;
  const Index kept = options.leg_modes < 0 ? legs : options.leg_modes;
  if (kept > legs)
    base::refuse(
        fmt::format("--leg-modes {}", kept),
        fmt::format("the legs of the {} model have {} modes", dynamics::name(options.kind), legs));
  std::vector<Index> order;  // platform, base, payload, legs
  for (Index i = 0; i < 6; ++i) order.push_back(i);
  for (Index i = n - beyond; i < n; ++i) order.push_back(i);
  for (Index i = 6; i < n - beyond; ++i) order.push_back(i);
  const MatrixXd M = at_Q.M(order, order), K = at_Q.K(order, order), C = at_Q.C(order, order);
  MatrixXd T = MatrixXd::Zero(n, held + kept);
  T.topLeftCorner(held, held).setIdentity();
  Superelement element{.base_directions = at_Q.base_directions,
                       .p_BQ = at_Q.p_BQ,
                       .is_base_free = options.free_base};
  if (legs > 0) {
    const MatrixXd K_ff = K.bottomRightCorner(legs, legs);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(
        K_ff, M.bottomRightCorner(legs, legs));
    T.bottomLeftCorner(legs, held) = -K_ff.ldlt().solve(K.bottomLeftCorner(legs, held));
    T.bottomRightCorner(legs, kept) = solver.eigenvectors().leftCols(kept);
    if (kept < legs) element.first_left_out = std::sqrt(std::max(solver.eigenvalues()[kept], 0.0));
  }
  const auto reduced = [&](const MatrixXd& A) -> MatrixXd {
    const MatrixXd R = T.transpose() * A * T;
    return 0.5 * (R + R.transpose());
  };
  element.M = reduced(M);
  element.K = reduced(K);
  element.C = reduced(C);
  for (std::size_t i = 0; i < 6; ++i)
    element.coordinates.push_back({spatial::direction_names[i], i < 3 ? "m" : "rad", 0.0});
  for (const int d : at_Q.base_directions)
    element.coordinates.push_back(
        {std::string("base.") + spatial::direction_names[static_cast<std::size_t>(d)],
         d < 3 ? "m" : "rad", 0.0});
  for (const auto& mode : at_Q.payload)
    element.coordinates.push_back({"payload." + mode, "m sqrt(kg)", 0.0});
  for (Index k = 1; k <= kept; ++k)
    element.coordinates.push_back({fmt::format("leg mode {}", k), "m sqrt(kg)", 0.0});
  return element;
}

Superelement with_base_held(const Superelement& element) {
  if (!element.is_base_free) return element;
  auto held = element;
  const Index base = element.platform, count = std::ssize(element.base_directions);
  std::vector<Index> kept;
  for (Index i = 0; i < element.M.rows(); ++i)
    if (i < base || i >= base + count) kept.push_back(i);
  held.M = element.M(kept, kept);
  held.K = element.K(kept, kept);
  held.C = element.C(kept, kept);
  held.coordinates.erase(held.coordinates.begin() + base, held.coordinates.begin() + base + count);
  held.base_directions.clear();
  held.is_base_free = false;
  return held;
}

std::string matrix_market(const Eigen::Ref<const MatrixXd>& matrix,
                          const std::vector<std::string>& comments) {
  std::string entries;
  int count = 0;
  for (Index j = 0; j < matrix.cols(); ++j)
    for (Index i = j; i < matrix.rows(); ++i) {
      if (matrix(i, j) == 0.0) continue;
      entries += fmt::format("{} {} {:.17g}\n", i + 1, j + 1, matrix(i, j));
      ++count;
    }
  std::string text = "%%MatrixMarket matrix coordinate real symmetric\n";
  for (const auto& comment : comments) text += "% " + comment + "\n";
  return text + fmt::format("{} {} {}\n", matrix.rows(), matrix.cols(), count) + entries;
}

std::string dmig_punch(const Superelement& element, const FileHead& head) {
  std::string text = fmt::format(
      "$ {}\n$ Superelement in SI units: m, kg, s, N, rad. Basic coordinates are the base frame.\n"
      "$ Case control: K2GG = K2HYD, M2GG = M2HYD, B2GG = B2HYD.\n"
      "$ {}: platform; {}: base; from {}: modes of {}the legs with the interface held.\n",
      head.title, dmig_platform, dmig_base, dmig_mode,
      std::ranges::any_of(element.coordinates,
                          [](const Signal& c) { return c.name.starts_with("payload."); })
          ? "the payload, then of "
          : "");
  text += grid(dmig_platform, element.p_BQ);
  if (!element.base_directions.empty()) text += grid(dmig_base, Vector3::Zero());
  const Index real = element.platform + static_cast<Index>(element.base_directions.size());
  for (Index i = real; i < element.M.rows(); ++i)
    text += fmt::format("SPOINT  {:>8}\n", dmig_mode + static_cast<int>(i - real));
  return text + dmig_matrix("K2HYD", element.K, element) +
         dmig_matrix("M2HYD", element.M, element) + dmig_matrix("B2HYD", element.C, element);
}

}  // namespace hydrapod::exchange
