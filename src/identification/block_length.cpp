#include "block_length.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numbers>

#include "hydrapod/base/error.hpp"

namespace hydrapod::identification {

namespace {

/// Blocks whose spectra fit into MeasureOptions::most_spectra.
unsigned longest_block(const ChannelChoice& choice, const MeasureOptions& options) {
  constexpr unsigned longest = 1U << 17U, least = 1U << 10U;
  const std::size_t channels =
      choice.inputs.size() + choice.outputs.size() + choice.instruments.size();
  const std::size_t lines = options.most_spectra / (channels * (channels + 1) / 2);
  return std::clamp(static_cast<unsigned>(2 * lines), least, longest);
}

constexpr int shortest_block = 16;

/// Where the options name none.
int usual_block(const data::RecordSet& records, const Plan& plan, const MeasureOptions& options,
                std::int64_t shortest) {
  // the instrumental estimate averages over neighbouring lines besides
  const double blocks_per_input = plan.estimator == Estimator::instrumental ? 2.0 : 4.0;
  // covariances of outputs want long lags more than many averages
  constexpr double of_outputs = 8.0;
  const double side_by_side =
      plan.estimator == Estimator::half_spectra
          ? of_outputs
          : blocks_per_input * static_cast<double>(plan.choice.inputs.size() + 2);
  const double total = static_cast<double>(shortest) * static_cast<double>(records.files().size());
  double wanted = total / side_by_side;
  if (plan.estimator != Estimator::half_spectra)  // few lines cost more than few averages
    wanted = std::max(wanted, std::min(static_cast<double>(options.short_block),
                                       total / fewest_blocks(plan.choice.inputs.size())));
  // the power of two that is nearest in ratio
  const auto most = static_cast<unsigned>(
      std::clamp(std::numbers::sqrt2 * wanted, static_cast<double>(shortest_block),
                 static_cast<double>(longest_block(plan.choice, options))));
  const auto block = static_cast<int>(std::bit_floor(most));
  return block > shortest ? static_cast<int>(std::bit_floor(static_cast<unsigned>(shortest)))
                          : block;
}

}  // namespace

double fewest_blocks(std::size_t inputs) { return std::max(4.0, static_cast<double>(inputs + 2)); }

int block_to_use(const data::RecordSet& records, const Plan& plan, const MeasureOptions& options,
                 std::int64_t shortest) {
  const std::string& first = records.files()[0];
  if (shortest < shortest_block)
    base::refuse(
        first,
        fmt::format("the record has {}: responses need blocks of at least {}, and several of them",
                    shortest == 0 ? "no samples" : fmt::format("only {} samples", shortest),
                    shortest_block));
  const int block =
      options.block_length ? *options.block_length : usual_block(records, plan, options, shortest);
  if (block > shortest)
    base::refuse(first, fmt::format("the record has {} samples, fewer than one block of {}: take "
                                    "shorter blocks or a longer record",
                                    shortest, block));
  return block;
}

}  // namespace hydrapod::identification
