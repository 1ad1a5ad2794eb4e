#include "hydrapod/response/frequency_response.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "elimination.hpp"
#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::response {

namespace {

using spatial::Matrix6;

/// Motion of the mass centre per motion of Q: v_C = v_Q + ω × (C − Q).
Matrix6 center_from_point(const Vector3& p_CQ) {
  Matrix6 T = Matrix6::Identity();
  T.topRightCorner<3, 3>() = spatial::skew(p_CQ);
  return T;
}

void move_platform_coordinates(const Matrix6& T, ModelMatrix& A) {
  A.topRows<6>() = (T.transpose() * A.topRows<6>()).eval();
  A.leftCols<6>() = (A.leftCols<6>() * T).eval();
}

/// Generalised forces of the oil columns per force or moment at Q: (∂s/∂y)ᵀ (∂s/∂q_Q)⁻ᵀ. They push
/// a base with coordinates the other way.
ModelMatrix actuator_loads(const LinearModel& model, const Matrix6& T) {
  ModelMatrix s_y(6, model.dof());
  for (int i = 0; i < model::leg_count; ++i)
    s_y.row(i) = dynamics::per_coordinate(model, i, model.legs[i].s_x);
  s_y.leftCols<6>() = (s_y.leftCols<6>() * T).eval();
  const Eigen::FullPivLU<Matrix6> lu(Matrix6(s_y.leftCols<6>()));
  if (!lu.isInvertible())
    throw std::invalid_argument(
        "input actuator: the pose is singular, leg forces cannot be mapped");
  return (lu.inverse() * s_y).transpose();
}

/// Per mode the platform direction that holds most of the platform's kinetic energy.
std::vector<int> mode_directions(const LinearModel& model, const NormalModes& modes) {
  std::vector<int> directions(modes.size());
  for (int k = 0; k < modes.size(); ++k) {
    const spatial::Vector6 q = modes.shapes.col(k).head<6>();
    q.cwiseProduct(model.platform_mass * q).maxCoeff(&directions[k]);
  }
  return directions;
}

Complex output_factor(Output output, double omega) {
  switch (output) {
    case Output::velocity:
      return {0.0, omega};
    case Output::acceleration:
      return {-omega * omega, 0.0};
    case Output::displacement:
      break;
  }
  return {1.0, 0.0};
}

/// Lines of the modal sum that are computed at once: their numbers stand side by side, so that the
/// compiler puts them into the lanes of the processor's registers.
constexpr size_t lines_at_once = 8;
using Lines = std::array<double, lines_at_once>;

/// Residues of the modal sum: per mode one 6×6, 36 numbers in a row.
using Residues = Eigen::Matrix<double, 36, Eigen::Dynamic, Eigen::ColMajor, 36, dynamics::max_dof>;

Residues residues_of(const ResponseModel& model) {
  const int n = model.modes.size();
  Residues residues(36, n);
  for (int k = 0; k < n; ++k) {
    const auto phi = model.modes.shapes.col(k);
    const Matrix6 residue = phi.head<6>() * (phi.transpose() * model.loads);
    residues.col(k) = residue.reshaped();
  }
  return residues;
}

/// Equal to the last bit: those of forces and motions at one point are.
bool are_symmetric(const Residues& residues) {
  for (Eigen::Index k = 0; k < residues.cols(); ++k) {
    const Matrix6 residue = residues.col(k).reshaped(6, 6);
    if (residue != residue.transpose()) return false;
  }
  return true;
}

/// 1/(ω_k² − ω² + 2iζ ω_k ω) at some lines, of each mode.
struct Weights {
  std::array<Lines, dynamics::max_dof> re, im;
};

void set_weights(const ResponseModel& model, const Lines& omega, Weights& weights) {
  for (int k = 0; k < model.modes.size(); ++k) {
    const double omega2_k = model.modes.omega2[k];
    const double damping = 2.0 * model.modal_ratio * model.modes.omega(k);
    for (size_t l = 0; l < lines_at_once; ++l) {
      const double re = omega2_k - omega[l] * omega[l];
      const double im = damping * omega[l];
      const double scale = 1.0 / (re * re + im * im);
      weights.re[k][l] = re * scale;
      weights.im[k][l] = -im * scale;
    }
  }
}

void by_modes(const ResponseModel& model, std::span<const double> omega, std::span<Matrix6c> out) {
  const int n = model.modes.size();
  const Residues residues = residues_of(model);
  const bool symmetric = are_symmetric(residues);
  Weights weights;
  for (size_t first = 0; first < omega.size(); first += lines_at_once) {
    const size_t count = std::min(lines_at_once, omega.size() - first);
    Lines block;
    for (size_t l = 0; l < lines_at_once; ++l) block[l] = omega[first + std::min(l, count - 1)];
    set_weights(model, block, weights);
    for (int entry = 0; entry < 36; ++entry) {
      const int row = entry % 6, column = entry / 6;
      if (symmetric && row > column) continue;
      Lines re{}, im{};
      for (int k = 0; k < n; ++k) {
        const double residue = residues(entry, k);
        for (size_t l = 0; l < lines_at_once; ++l) re[l] += residue * weights.re[k][l];
        for (size_t l = 0; l < lines_at_once; ++l) im[l] += residue * weights.im[k][l];
      }
      for (size_t l = 0; l < count; ++l) {
        out[first + l](row, column) = {re[l], im[l]};
        if (symmetric) out[first + l](column, row) = {re[l], im[l]};
      }
    }
  }
}

void dense(const ResponseModel& model, std::span<const double> omega, std::span<Matrix6c> out) {
  using ComplexModel = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, 0, dynamics::max_dof,
                                     dynamics::max_dof>;
  const ModelMatrix C = damping_matrix(model);
  const ComplexModel loads = model.loads.cast<Complex>();
  for (size_t i = 0; i < omega.size(); ++i) {
    ComplexModel D = (model.K - omega[i] * omega[i] * model.M).cast<Complex>() +
                     Complex(0.0, omega[i]) * C.cast<Complex>();
    for (const auto& arm : model.arms) {
      const Complex weight = arm.stiffness * arm.rate / Complex(arm.rate, omega[i]);
      D -= weight * (arm.s_y * arm.s_y.transpose()).cast<Complex>();
    }
    out[i] = Eigen::PartialPivLU<ComplexModel>(D).solve(loads).topRows(6);
  }
}

/// All 72 numbers in one sum, which is faster than one after the other.
bool is_finite(const Matrix6c& H) {
  const Eigen::Map<const Eigen::Array<double, 72, 1>> numbers(
      reinterpret_cast<const double*>(H.data()));
  return (0.0 * numbers).sum() == 0.0;
}

}  // namespace

ResponseModel response_model(const LinearModel& model, const NormalModes& modes, double modal_ratio,
                             const Vector3& p_PQ, Input input) {
  ResponseModel result{.kind = model.kind,
                       .base_count = model.base_count(),
                       .p_BQ = model.X_BP * p_PQ,
                       .M = model.M,
                       .K = model.K,
                       .C = model.C,
                       .modes = modes,
                       .arms = model.arms,
                       .modal_ratio = modal_ratio,
                       .payload_count = model.payload_count(),
                       .mode_direction = mode_directions(model, modes)};
  const Matrix6 T = center_from_point(result.p_BQ - model.p_BC);
  for (ModelMatrix* A : {&result.M, &result.K, &result.C}) move_platform_coordinates(T, *A);
  std::erase_if(result.arms, [](const dynamics::RelaxingArm& arm) { return arm.rate == 0.0; });
  for (auto& arm : result.arms) arm.s_y.head<6>() = (T.transpose() * arm.s_y.head<6>()).eval();
  result.modes.shapes.topRows<6>() = T.inverse() * modes.shapes.topRows<6>();
  if (input == Input::actuator) {
    result.loads = actuator_loads(model, T);
  } else {
    result.loads = ModelMatrix::Identity(model.dof(), 6);
  }
  result.loads_flexible = model.dof() > 6 && !result.loads.bottomRows(model.dof() - 6).isZero(0.0);
  return result;
}

ModelMatrix damping_matrix(const ResponseModel& model) {
  ModelMatrix C = model.C;
  if (model.modal_ratio == 0.0) return C;
  const ModelMatrix momenta = model.M * model.modes.shapes;
  for (int k = 0; k < model.modes.size(); ++k)
    C += 2.0 * model.modal_ratio * model.modes.omega(k) * momenta.col(k) *
         momenta.col(k).transpose();
  return C;
}

Method best_method(const ResponseModel& model) {
  if (model.C.isZero(0.0) && model.arms.empty()) return Method::modes;
  return model.modal_ratio == 0.0 && model.base_count == 0 ? Method::elimination : Method::whole;
}

std::vector<Matrix6c> frequency_response(const ResponseModel& model, std::span<const double> omega,
                                         Output output, std::optional<Method> method) {
  const Method chosen = method.value_or(best_method(model));
  if (chosen == Method::elimination && model.modal_ratio != 0.0)
    throw std::invalid_argument("elimination cannot take modal ratios: they couple all legs");
  if (chosen == Method::elimination && model.base_count > 0)
    throw std::invalid_argument(
        "elimination cannot take coordinates of the base: it couples all legs");
  if (chosen == Method::modes && !model.C.isZero(0.0))
    throw std::invalid_argument("the modal sum cannot take viscous dampers: they couple the modes");
  if (chosen == Method::modes && !model.arms.empty())
    throw std::invalid_argument("the modal sum cannot take chambers: they couple the modes");
  std::vector<Matrix6c> H(omega.size());
  if (chosen == Method::modes) by_modes(model, omega, H);
  if (chosen == Method::dense) dense(model, omega, H);
  if (chosen == Method::elimination) {
    eliminate(model, omega, H);
    for (size_t i = 0; i < H.size(); ++i)
      if (!is_finite(H[i])) dense(model, omega.subspan(i, 1), {&H[i], 1});
  }
  if (chosen == Method::whole)
    for (const size_t i : eliminate_whole(model, damping_matrix(model), omega, H))
      dense(model, omega.subspan(i, 1), {&H[i], 1});
  if (output != Output::displacement)
    for (size_t i = 0; i < H.size(); ++i) H[i] *= output_factor(output, omega[i]);
  return H;
}

std::vector<double> log_space(double from, double to, int points) {
  if (!(from > 0.0) || !(to > from) || points < 2)
    throw std::invalid_argument("log_space: needs 0 < from < to and at least two points");
  std::vector<double> values(points);
  const double step = std::log(to / from) / (points - 1);
  for (int i = 0; i < points; ++i) values[i] = from * std::exp(step * i);
  values.back() = to;
  return values;
}

}  // namespace hydrapod::response
