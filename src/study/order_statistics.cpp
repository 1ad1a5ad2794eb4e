#include "order_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace hydrapod::study {

namespace {

constexpr unsigned digit_bits = 11;
constexpr std::size_t bins = std::size_t{1} << digit_bits;
constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
/// Values of one bin that are kept in memory to be sorted.
constexpr std::uint64_t few = std::uint64_t{1} << 14U;

/// Numbers ordered as their values are; −0 is 0.
std::uint64_t key_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
double value_of(std::uint64_t key) {
  return std::bit_cast<double>((key & sign) != 0 ? key & ~sign : ~key);
}

/// The values of an output with keys from `low` on, in equal parts of 2^shift keys. Each part is
/// counted in one pass; where a wanted rank lies in it, it is parted again in the next one.
struct Part {
  std::uint64_t low{};
  unsigned shift{};
  bool sorted{};  ///< few: its keys are kept instead
  std::uint64_t least{std::numeric_limits<std::uint64_t>::max()}, most{};
  std::vector<std::uint64_t> counts{}, keys{};
  std::vector<int> below{};  ///< per part the number of the Part that it is; −1: not wanted

  Part(std::uint64_t from, std::uint64_t to)
      : low(from),
        shift(static_cast<unsigned>(std::max<int>(
            0, static_cast<int>(std::bit_width(to - from)) - static_cast<int>(digit_bits)))),
        counts(bins) {}

  [[nodiscard]] std::size_t bin_of(std::uint64_t key) const { return (key - low) >> shift; }

  void take(std::uint64_t key) {
    if (sorted) return keys.push_back(key);
    least = std::min(least, key);
    most = std::max(most, key);
    ++counts[bin_of(key)];
  }
};

/// A rank on its way down.
struct Search {
  int part{};
  std::uint64_t rank{};  ///< in the part
  bool found{};
  std::uint64_t key{};
};

class OrderSearch {
 public:
  OrderSearch(std::span<const Range> ranges, const std::vector<RankWanted>& wanted)
      : first_(ranges.size(), -1) {
    for (const auto& one : wanted) {
      if (first_[one.output] < 0) {
        first_[one.output] = static_cast<int>(parts_.size());
        parts_.emplace_back(key_of(ranges[one.output].least), key_of(ranges[one.output].most));
      }
      searches_.push_back({.part = first_[one.output], .rank = one.rank});
    }
  }

  [[nodiscard]] bool open() const {
    return std::ranges::any_of(searches_, [](const Search& one) { return !one.found; });
  }

  /// The outputs of a row.
  void take(std::span<const double> outputs) {
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      if (first_[k] < 0 || !std::isfinite(outputs[k])) continue;
      const std::uint64_t key = key_of(outputs[k]);
      int at = first_[k];
      while (at >= 0 && !parts_[static_cast<std::size_t>(at)].below.empty()) {
        const auto& part = parts_[static_cast<std::size_t>(at)];
        at = part.below[part.bin_of(key)];
      }
      if (at >= begun_) parts_[static_cast<std::size_t>(at)].take(key);
    }
  }

  /// After all rows.
  void descend() {
    const int next = static_cast<int>(parts_.size());
    for (auto& search : searches_)
      if (!search.found) descend(search);
    begun_ = next;
  }

  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> values(searches_.size());
    std::ranges::transform(searches_, values.begin(),
                           [](const Search& one) { return value_of(one.key); });
    return values;
  }

 private:
  void descend(Search& search) {
    auto& part = parts_[static_cast<std::size_t>(search.part)];
    if (part.sorted) {
      if (!std::ranges::is_sorted(part.keys)) std::ranges::sort(part.keys);
      search.key = part.keys[search.rank];
      search.found = true;
      return;
    }
    std::size_t bin = 0;
    while (bin + 1 < bins && search.rank >= part.counts[bin]) search.rank -= part.counts[bin++];
    if (part.least == part.most || part.shift == 0) {
      search.key = part.least == part.most ? part.least : part.low + bin;
      search.found = true;
      return;
    }
    if (part.below.empty()) part.below.assign(bins, -1);
    const int known = part.below[bin];
    search.part = known >= 0 ? known : static_cast<int>(parts_.size());
    if (known >= 0) return;
    part.below[bin] = search.part;
    const std::uint64_t low = part.low + (std::uint64_t{bin} << part.shift),
                        width = (std::uint64_t{1} << part.shift) - 1;
    const bool sorted = part.counts[bin] <= few;
    parts_.emplace_back(low, low + width);  // `part` is not valid from here on
    parts_.back().sorted = sorted;
  }

  std::vector<int> first_;  ///< per output its Part of all values; −1: no rank is wanted
  std::vector<Part> parts_{};
  int begun_{};  ///< parts from here on take values in this pass
  std::vector<Search> searches_{};
};

}  // namespace

namespace {

std::vector<double> search_for(const Spool& spool, std::size_t inputs,
                               std::span<const Range> ranges, const std::vector<RankWanted>& wanted,
                               const std::function<bool(std::uint64_t)>& counts) {
  OrderSearch search(ranges, wanted);
  const std::size_t width = spool.width();
  while (search.open()) {
    spool.each_chunk([&](std::uint64_t first, std::span<const double> numbers) {
      for (std::size_t at = 0; at < numbers.size(); at += width)
        if (counts(first + at / width)) search.take(numbers.subspan(at + inputs, ranges.size()));
    });
    search.descend();
  }
  return search.values();
}

}  // namespace

std::size_t parts_of(int threads, std::size_t outputs) {
  const int wanted = threads > 0 ? threads : numerics::processor_count();
  return std::clamp<std::size_t>(static_cast<std::size_t>(wanted), 1,
                                 std::max<std::size_t>(1, outputs));
}

std::vector<double> order_statistics(const Spool& spool, std::size_t inputs,
                                     std::span<const Range> ranges,
                                     const std::vector<RankWanted>& wanted,
                                     const std::function<bool(std::uint64_t)>& counts,
                                     int threads) {
  const auto parts = parts_of(threads, ranges.size());
  std::vector<double> values(wanted.size());
  numerics::parallel_for(parts, threads, [&](std::size_t part) {
    std::vector<RankWanted> own;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k].output % parts != part) continue;
      own.push_back(wanted[k]);
      places.push_back(k);
    }
    if (own.empty()) return;
    const auto found = search_for(spool, inputs, ranges, own, counts);
    for (std::size_t k = 0; k < places.size(); ++k) values[places[k]] = found[k];
  });
  return values;
}

}  // namespace hydrapod::study
