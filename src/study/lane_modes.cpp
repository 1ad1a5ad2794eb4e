#include "lane_modes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "hydrapod/modal/normal_modes.hpp"
#include "lane_solve.hpp"

namespace hydrapod::study {

namespace {

using dynamics::LinearModel;
using dynamics::ModelMatrix;
using modal::NormalModes;

constexpr int most_flexible = 4, most_modes = 6 + model::leg_count * most_flexible;

/// Largest residual (lane_kernel.hpp) that is taken; some thousand epsilons, of which rounding
/// needs a hundred.
constexpr double largest_residual = 1e-12;

/// What goes into the kernel and comes out.
struct alignas(64) LaneBuffers {
  std::array<double, most_lanes * packed_numbers(most_flexible)> M, K;
  std::array<double, most_lanes * most_modes> omega2;
  std::array<double, most_lanes * most_modes * most_modes> shapes;
  std::array<double, most_lanes> residual;
};
static_assert(sizeof(std::array<double, most_lanes * packed_numbers(most_flexible)>) % 64 == 0);

/// The packed numbers of a matrix into lane `lane` of `to`.
template <int flexible>
void pack(const ModelMatrix& A, int lane, int lanes, double* to) {
  to += lane;
  const auto put = [&](double value) {
    *to = value;
    to += lanes;
  };
  const double* const numbers = A.data();
  constexpr int rows = 6 + model::leg_count * flexible;
  const auto entry = [&](int i, int j) { return numbers[i + j * rows]; };
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) put(entry(i, j));
  for (int leg = 0; leg < model::leg_count; ++leg) {
    const int at = 6 + leg * flexible;
    for (int i = 0; i < flexible; ++i)
      for (int j = 0; j < 6; ++j) put(entry(at + i, j));
    for (int i = 0; i < flexible; ++i)
      for (int j = 0; j <= i; ++j) put(entry(at + i, at + j));
  }
}

/// The modes of a lane, sorted by ω².
template <int flexible>
void unpack(const LaneBuffers& buffers, int lane, int lanes, NormalModes& modes) {
  constexpr int size = 6 + model::leg_count * flexible;
  std::array<int, size> order;
  std::array<double, size> omega2;
  std::iota(order.begin(), order.end(), 0);
  for (int k = 0; k < size; ++k) omega2[k] = buffers.omega2[k * lanes + lane];
  std::sort(order.begin(), order.end(), [&](int a, int b) { return omega2[a] < omega2[b]; });
  modes.omega2.resize(size);
  modes.shapes.resize(size, size);
  double* to = modes.shapes.data();
  for (int k = 0; k < size; ++k) {
    modes.omega2[k] = omega2[order[k]];
    const double* from = buffers.shapes.data() + order[k] * size * lanes + lane;
    for (int row = 0; row < size; ++row, from += lanes) *to++ = *from;
  }
}

template <int flexible>
void solve_lanes(std::span<const LinearModel* const> models, std::span<NormalModes> modes,
                 std::span<bool> sound, int lanes, void (*kernel)(const LaneTask&)) {
  LaneBuffers buffers;
  const int count = static_cast<int>(models.size());
  for (int first = 0; first < count; first += lanes) {
    const int now = std::min(lanes, count - first);
    for (int lane = 0; lane < lanes; ++lane) {  // lanes without a design repeat the last one
      const auto& model = *models[static_cast<std::size_t>(first + std::min(lane, now - 1))];
      pack<flexible>(model.M, lane, lanes, buffers.M.data());
      pack<flexible>(model.K, lane, lanes, buffers.K.data());
    }
    kernel({buffers.M.data(), buffers.K.data(), buffers.omega2.data(), buffers.shapes.data(),
            buffers.residual.data()});
    for (int lane = 0; lane < now; ++lane) {
      const auto at = static_cast<std::size_t>(first + lane);
      sound[at] = buffers.residual[static_cast<std::size_t>(lane)] <= largest_residual;
      if (!sound[at]) continue;
      unpack<flexible>(buffers, lane, lanes, modes[at]);
      modal::make_canonical(models[at]->M.diagonal(), modes[at]);
    }
  }
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

}  // namespace

std::span<const LaneKernels> usable_kernels() {
  static const auto kernels = kernels_of_processor();
  return kernels;
}

void modes_in_lanes(std::span<const LinearModel* const> models, std::span<NormalModes> modes,
                    std::span<bool> sound) {
  solve_in_lanes(usable_kernels().front(), models, modes, sound);
}

void solve_in_lanes(const LaneKernels& kernels, std::span<const LinearModel* const> models,
                    std::span<NormalModes> modes, std::span<bool> sound) {
  const auto other = [&](const LinearModel* model) {
    return model->kind != models.front()->kind || model->base_count() > 0;
  };
  if (models.size() != modes.size() || models.size() != sound.size() ||
      std::ranges::any_of(models, other))
    throw std::invalid_argument(
        "modes_in_lanes: expected as many modes as models, all of one kind and on a base without "
        "coordinates");
  if (models.empty()) return;
  switch (models.front()->kind) {
    case dynamics::ModelKind::rigid:
      return solve_lanes<0>(models, modes, sound, kernels.lanes, kernels.rigid);
    case dynamics::ModelKind::guide:
      return solve_lanes<2>(models, modes, sound, kernels.lanes, kernels.guide);
    case dynamics::ModelKind::full:
      return solve_lanes<4>(models, modes, sound, kernels.lanes, kernels.full);
  }
}

}  // namespace hydrapod::study
