/// Modes of the published machine: the whole answer, its parts, and LAPACK's solve alone.

#include <benchmark/benchmark.h>
#include <lapacke.h>

#include <Eigen/Eigenvalues>

#include "hydrapod/modal/normal_modes.hpp"
#include "machines.hpp"

extern "C" void openblas_set_num_threads(int);

namespace {

using namespace hydrapod;
using dynamics::LinearModel;
using dynamics::ModelKind;

LinearModel published_model() {
  const auto machine = bench::published();
  return dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
}

void assembly_modes_energies(benchmark::State& state) {
  const auto machine = bench::published();
  for (auto _ : state) {
    const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
    const auto modes = modal::normal_modes(model);
    benchmark::DoNotOptimize(modal::energy_shares(model, modes.shapes));
  }
}
BENCHMARK(assembly_modes_energies);

void assembly(benchmark::State& state) {
  const auto machine = bench::published();
  for (auto _ : state)
    benchmark::DoNotOptimize(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
}
BENCHMARK(assembly);

void modes(benchmark::State& state) {
  const auto model = published_model();
  for (auto _ : state) benchmark::DoNotOptimize(modal::normal_modes(model));
}
BENCHMARK(modes);

/// Transverse axes, no gravity: six modes repeat exactly.
void modes_equal_legs(benchmark::State& state) {
  const auto machine = bench::machine("zhang-jiang-2021-transverse");
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  for (auto _ : state) benchmark::DoNotOptimize(modal::normal_modes(model));
}
BENCHMARK(modes_equal_legs);

void energies(benchmark::State& state) {
  const auto model = published_model();
  const auto modes = modal::normal_modes(model);
  for (auto _ : state) benchmark::DoNotOptimize(modal::energy_shares(model, modes.shapes));
}
BENCHMARK(energies);

void modes_eigen_generalized(benchmark::State& state) {
  using Matrix = Eigen::Matrix<double, 18, 18>;
  const auto model = published_model();
  const Matrix K = model.K, M = model.M;
  for (auto _ : state) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(K, M);
    benchmark::DoNotOptimize(solver.eigenvectors().data());
  }
}
BENCHMARK(modes_eigen_generalized);

/// dsygvd destroys its matrices, so copying them (2 × 2.6 kB) is part of every call.
void modes_lapack_dsygvd(benchmark::State& state) {
  openblas_set_num_threads(1);
  using Matrix = Eigen::Matrix<double, 18, 18>;
  const auto model = published_model();
  const Matrix K = model.K, M = model.M;
  Matrix A, B;
  Eigen::Matrix<double, 18, 1> omega2;
  for (auto _ : state) {
    A = K;
    B = M;
    const auto info = LAPACKE_dsygvd(LAPACK_COL_MAJOR, 1, 'V', 'L', 18, A.data(), 18, B.data(), 18,
                                     omega2.data());
    if (info != 0) state.SkipWithError("dsygvd failed");
    benchmark::DoNotOptimize(A.data());
  }
}
BENCHMARK(modes_lapack_dsygvd);

}  // namespace
