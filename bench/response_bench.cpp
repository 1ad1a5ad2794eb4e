/// 2000 frequencies of the 6×6 response of the published machine with viscous seals and oil.

#include <benchmark/benchmark.h>

#include <Eigen/LU>
#include <complex>

#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "machines.hpp"

namespace {

using namespace hydrapod;
using response::Complex;
using response::Matrix6c;
using response::Method;
using response::ResponseModel;

constexpr int points = 2000;

/// Viscous dampers where `viscous`, else only a modal ratio (which the modal sum needs).
ResponseModel published_response(bool viscous) {
  auto machine = bench::published();
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.damping = viscous ? 30.0 : 0.0;
    leg.oil_spring.damping = viscous ? 500.0 : 0.0;
  }
  const auto model = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
  const auto modes = modal::normal_modes(model);
  return response::response_model(model, modes, viscous ? 0.0 : 0.002,
                                  machine.platform.mass_center);
}

void sweep(benchmark::State& state, Method method) {
  const auto model = published_response(method != Method::modes);
  const auto omega = response::log_space(10.0, 400.0, points);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        response::frequency_response(model, omega, response::Output::displacement, method));
  state.SetItemsProcessed(state.iterations() * points);
}
BENCHMARK_CAPTURE(sweep, elimination, Method::elimination);
BENCHMARK_CAPTURE(sweep, modes, Method::modes);

/// Dense complex LU of the whole 18×18 at every frequency, in its best form: fixed size, six
/// right-hand sides that are the platform's unit wrenches.
void dense_fixed_lu(benchmark::State& state) {
  using Matrix = Eigen::Matrix<double, 18, 18>;
  using ComplexMatrix = Eigen::Matrix<Complex, 18, 18>;
  using Loads = Eigen::Matrix<Complex, 18, 6>;
  const auto model = published_response(true);
  const Matrix M = model.M, K = model.K, C = model.C;
  const Loads loads = Loads::Identity();
  const auto omega = response::log_space(10.0, 400.0, points);
  std::vector<Matrix6c> H(points);
  for (auto _ : state) {
    for (int i = 0; i < points; ++i) {
      ComplexMatrix D;
      D.real() = K - omega[i] * omega[i] * M;
      D.imag() = omega[i] * C;
      H[i] = Eigen::PartialPivLU<ComplexMatrix>(D).solve(loads).topRows<6>();
    }
    benchmark::DoNotOptimize(H.data());
  }
  const auto ours = response::frequency_response(model, omega, response::Output::displacement,
                                                 Method::elimination);
  double error = 0.0;
  for (int i = 0; i < points; ++i) error = std::max(error, (H[i] - ours[i]).norm() / H[i].norm());
  if (error > 1e-11) state.SkipWithError("elimination and LU disagree");
  state.SetItemsProcessed(state.iterations() * points);
}
BENCHMARK(dense_fixed_lu);

/// The same in matrices of dynamic size, as most programs have them.
void dense_dynamic_lu(benchmark::State& state) {
  const auto model = published_response(true);
  const Eigen::MatrixXd M = model.M, K = model.K, C = model.C;
  const Eigen::MatrixXcd loads = Eigen::MatrixXcd::Identity(18, 6);
  const auto omega = response::log_space(10.0, 400.0, points);
  std::vector<Matrix6c> H(points);
  Eigen::MatrixXcd D(18, 18);
  Eigen::PartialPivLU<Eigen::MatrixXcd> lu(18);
  for (auto _ : state) {
    for (int i = 0; i < points; ++i) {
      D.real() = K - omega[i] * omega[i] * M;
      D.imag() = omega[i] * C;
      lu.compute(D);
      H[i] = lu.solve(loads).topRows<6>();
    }
    benchmark::DoNotOptimize(H.data());
  }
  state.SetItemsProcessed(state.iterations() * points);
}
BENCHMARK(dense_dynamic_lu);

}  // namespace
