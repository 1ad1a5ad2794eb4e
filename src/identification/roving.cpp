#include "roving.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "hits.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "measure_hits.hpp"
#include "names.hpp"
#include "response_checks.hpp"

namespace hydrapod::identification {

namespace {

/// Peaks of an input that stand out as hits do.
bool may_be_hit(const CrossSpectra& spectra, int input) {
  constexpr double conspicuous = 8.0;
  const auto& health = spectra.health[static_cast<std::size_t>(input)];
  return health.missing == 0 &&
         health.highest - health.lowest > conspicuous * rms_in(spectra, input);
}

/// Does a single record show by its extremes that no input is alone in being hit? An input of the
/// extent e (highest less lowest) reaches between e/2 and e from its mean.
bool are_alike(const CrossSpectra& spectra, const std::vector<int>& inputs) {
  double most = 0.0, second = 0.0;
  for (const int i : inputs) {
    const auto& health = spectra.health[static_cast<std::size_t>(i)];
    const double extent = health.highest - health.lowest;
    second = std::max(second, std::min(most, extent));
    most = std::max(most, extent);
  }
  static_assert(HitOptions{}.least <= 0.5);
  return 0.5 * second >= HitOptions{}.least * most;
}

/// The one input that is hit; none: several are, or it is no such record.
std::optional<std::size_t> only_hit(const data::Samples& inputs) {
  if (inputs.rows() == 0 || !inputs.allFinite()) return {};
  const Eigen::RowVectorXd size =
      (inputs.rowwise() - inputs.colwise().mean()).cwiseAbs().colwise().maxCoeff();
  Index largest = 0;
  size.maxCoeff(&largest);
  const double least = HitOptions{}.least * size[largest];
  for (Index i = 0; i < size.size(); ++i)
    if (i != largest && size[i] >= least) return {};
  if (hits_in(inputs.col(largest)).empty()) return {};
  return static_cast<std::size_t>(largest);
}

}  // namespace

void refuse_roving(data::RecordSet& records, const CrossSpectra& spectra,
                   const std::vector<std::size_t>& used, const ChannelChoice& choice) {
  if (choice.inputs.size() < 2 || !choice.instruments.empty() ||
      std::ranges::none_of(choice.inputs, [&](int i) { return may_be_hit(spectra, i); }) ||
      (records.files().size() == 1 && are_alike(spectra, choice.inputs)))
    return;
  std::vector<std::size_t> columns;
  for (const int i : choice.inputs) columns.push_back(used[static_cast<std::size_t>(i)]);
  const auto all = whole_records(records, columns, HitOptions{}.most);
  if (!all) return;
  std::vector<std::size_t> hit;
  for (const auto& inputs : *all) {
    const auto own = only_hit(inputs);
    if (!own) return;
    hit.push_back(*own);
  }
  const auto name = [&](std::size_t k) {
    const auto channel = static_cast<std::size_t>(choice.inputs[hit[k]]);
    return base::printable(spectra.channels[channel].name);
  };
  const std::string own = fmt::format("--inputs \"{}\"", name(0));
  const auto other = std::ranges::find_if(hit, [&](std::size_t i) { return i != hit[0]; });
  if (other == hit.end())
    throw base::ComputationError(fmt::format(
        "of the inputs {} alone is hit, and the others hold noise: take {}", name(0), own));
  const auto k = static_cast<std::size_t>(other - hit.begin());
  const auto file = [&](std::size_t at) {
    return base::printable(std::filesystem::path(records.files()[at]).filename().string());
  };
  throw base::ComputationError(fmt::format(
      "a hammer test that roves: {} is hit in {}, {} in {}, and the other inputs hold noise; "
      "records of several points are not combined; identify the records of each point by "
      "themselves ({} for {}), or give the responses to all points as one file",
      name(0), file(0), name(k), file(k), own, file(0)));
}

}  // namespace hydrapod::identification
