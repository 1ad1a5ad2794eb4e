#include "lane_designs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <vector>

namespace hydrapod::study {

namespace {

using dynamics::ModelKind;
using dynamics::ModelMatrix;
using modal::NormalModes;

/// Largest residual (lane_eigen.hpp) that is taken; some thousand epsilons, of which rounding needs
/// a hundred.
constexpr double largest_residual = 1e-12;

/// Of the largest ω², for frequencies without shapes: some ten epsilons of the largest are then at
/// most 1e-12 of the least.
constexpr double least_share = 3e-4;

template <class Numbers>
constexpr std::size_t count_of = sizeof(Numbers) / sizeof(double);

/// One lane of what kernels read or write.
template <class Numbers>
Numbers gathered(const double* from, int lanes) {
  Numbers numbers;
  auto* to = reinterpret_cast<double*>(&numbers);
  for (std::size_t k = 0; k < count_of<Numbers>; ++k)
    to[k] = from[k * static_cast<std::size_t>(lanes)];
  return numbers;
}

/// Sorted by ω².
template <int flexible>
NormalModes ascending(const ModeNumbers<double, flexible>& found) {
  constexpr int size = modes_of(flexible);
  std::array<int, size> order;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return found.omega2[a] < found.omega2[b]; });
  NormalModes modes;
  modes.omega2.resize(size);
  modes.shapes.resize(size, size);
  for (int k = 0; k < size; ++k) {
    modes.omega2[k] = found.omega2[order[k]];
    std::copy_n(found.shapes[order[k]], size, modes.shapes.col(k).data());
  }
  return modes;
}

template <int flexible>
ModelMatrix full(const BlockMatrix<double, flexible>& A) {
  ModelMatrix matrix = ModelMatrix::Zero(modes_of(flexible), modes_of(flexible));
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) matrix(i, j) = A.rr(i, j);
  for (int leg = 0; leg < leg_number; ++leg)
    for (int i = 0; i < flexible; ++i) {
      const int row = 6 + leg * flexible + i;
      for (int j = 0; j < 6; ++j) matrix(row, j) = matrix(j, row) = A.fr(leg, i, j);
      for (int j = 0; j < flexible; ++j) matrix(row, row - i + j) = A.ff(leg, i, j);
    }
  return matrix;
}

std::vector<LaneKernels> kernels_of_processor() {
  std::vector<LaneKernels> kernels;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) kernels.push_back(avx512_kernels());
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    kernels.push_back(avx2_kernels());
#endif
  kernels.push_back(plain_kernels());
  std::erase_if(kernels, [](const LaneKernels& one) { return one.lanes == 0; });
  return kernels;
}

/// Calls `use` with the flexible coordinates per leg as a constant.
template <class Use>
auto with_flexible(ModelKind kind, const Use& use) {
  switch (kind) {
    case ModelKind::guide:
      return use(std::integral_constant<int, 2>{});
    case ModelKind::full:
      return use(std::integral_constant<int, 4>{});
    case ModelKind::rigid:
      break;
  }
  return use(std::integral_constant<int, 0>{});
}

}  // namespace

struct alignas(64) LaneDesigns::Buffers {
  std::array<double, most_lanes * count_of<MachineNumbers<double>>> machines;
  alignas(64) std::array<double, most_lanes * count_of<OutputNumbers<double>>> outputs;
  alignas(64) std::array<double, most_lanes * count_of<ModelNumbers<double, most_flexible>>> models;
};

std::span<const LaneKernels> usable_kernels() {
  static const auto kernels = kernels_of_processor();
  return kernels;
}

LaneDesigns::LaneDesigns(const LaneKernels& kernels, ModelKind kind, const LaneOptions& options,
                         const ModelMatrix& followed)
    : kernels_(kernels),
      kind_(kind),
      options_(options),
      followed_(followed),
      buffers_(std::make_unique<Buffers>()) {
  options_.followed = static_cast<int>(followed.cols());
}
LaneDesigns::LaneDesigns(LaneDesigns&&) noexcept = default;
LaneDesigns::~LaneDesigns() = default;

void LaneDesigns::put(int lane, const MachineNumbers<double>& numbers) {
  const auto* from = reinterpret_cast<const double*>(&numbers);
  double* const to = buffers_->machines.data() + lane;
  for (std::size_t k = 0; k < count_of<MachineNumbers<double>>; ++k)
    to[k * static_cast<std::size_t>(lanes())] = from[k];
}

void LaneDesigns::solve(int count) { run(kernels_.designs, count); }
void LaneDesigns::solve_frequencies(int count) { run(kernels_.frequencies, count); }

void LaneDesigns::run(const LaneKernel& kernel, int count) {
  for (int lane = count; lane < lanes(); ++lane)  // lanes without a design repeat the last one
    put(lane, gathered<MachineNumbers<double>>(buffers_->machines.data() + count - 1, lanes()));
  options_.shapes = followed_.data();
  const LaneTask task{buffers_->machines.data(), buffers_->outputs.data(), buffers_->models.data(),
                      &options_};
  (kind_ == ModelKind::rigid   ? kernel.rigid
   : kind_ == ModelKind::guide ? kernel.guide
                               : kernel.full)(task);
}

bool LaneDesigns::frequencies(int lane, double* omega2) const {
  return with_flexible(kind_, [&]<int n>(std::integral_constant<int, n>) {
    const auto found =
        gathered<FrequencyNumbers<double, n>>(buffers_->outputs.data() + lane, lanes());
    std::copy(std::begin(found.omega2), std::end(found.omega2), omega2);
    const double largest = std::max(std::abs(omega2[0]), omega2[modes_of(n) - 1]);
    return found.residual <= largest_residual && std::abs(omega2[0]) >= least_share * largest;
  });
}

OutputNumbers<double> LaneDesigns::outputs(int lane) const {
  return gathered<OutputNumbers<double>>(buffers_->outputs.data() + lane, lanes());
}

bool LaneDesigns::sound(int lane) const { return outputs(lane).residual <= largest_residual; }

namespace {

/// The modes in lanes from `from` on.
template <int flexible>
NormalModes modes_at(const double* from, int lanes, const ModelMatrix& mass) {
  auto modes = ascending(gathered<ModeNumbers<double, flexible>>(from, lanes));
  modal::make_canonical(mass.diagonal(), modes);
  return modes;
}

}  // namespace

const double* LaneDesigns::at(std::size_t offset, int lane) const {
  return buffers_->models.data() + offset / sizeof(double) * static_cast<std::size_t>(lanes()) +
         lane;
}

NormalModes LaneDesigns::modes(int lane) const {
  return with_flexible(kind_, [&]<int n>(std::integral_constant<int, n>) {
    using Model = ModelNumbers<double, n>;
    return modes_at<n>(at(offsetof(Model, modes), lane), lanes(), mass(lane));
  });
}

NormalModes LaneDesigns::rigid_modes(int lane) const {
  return with_flexible(kind_, [&]<int n>(std::integral_constant<int, n>) {
    using Model = ModelNumbers<double, n>;
    return modes_at<0>(
        at(offsetof(Model, rigid), lane), lanes(),
        full(gathered<BlockMatrix<double, 0>>(at(offsetof(Model, M_rigid), lane), lanes())));
  });
}

void LaneDesigns::model(int lane, dynamics::LinearModel& model) const {
  const auto machine = gathered<MachineNumbers<double>>(buffers_->machines.data() + lane, lanes());
  model.kind = kind_;
  model.platform_mass.setZero();
  for (int i = 0; i < 3; ++i) {
    model.platform_mass(i, i) = machine.m;
    for (int j = 0; j < 3; ++j)
      model.platform_mass(3 + i, 3 + j) = machine.inertia[BlockMatrix<double, 0>::below(i, j)];
  }
  model.M = mass(lane);
}

ModelMatrix LaneDesigns::mass(int lane) const {
  return with_flexible(kind_, [&]<int n>(std::integral_constant<int, n>) {
    using Model = ModelNumbers<double, n>;
    return full(gathered<BlockMatrix<double, n>>(at(offsetof(Model, M), lane), lanes()));
  });
}

ModelMatrix LaneDesigns::stiffness(int lane) const {
  return with_flexible(kind_, [&]<int n>(std::integral_constant<int, n>) {
    using Model = ModelNumbers<double, n>;
    return full(gathered<BlockMatrix<double, n>>(at(offsetof(Model, K), lane), lanes()));
  });
}

}  // namespace hydrapod::study
