#include "order_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

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

/// Equal parts of 2^shift keys, from `low` on. Where they are `open` the first and the last part
/// are all that is below and above.
struct Bins {
  std::uint64_t low{};
  unsigned shift{};
  bool open{};

  Bins(std::uint64_t from, std::uint64_t to, bool is_open)
      : low(from),
        shift(static_cast<unsigned>(std::max<int>(
            0, static_cast<int>(std::bit_width(to - from)) - static_cast<int>(digit_bits)))),
        open(is_open) {}

  [[nodiscard]] std::size_t of(std::uint64_t key) const {
    if (!open) return (key - low) >> shift;
    return key < low ? 0 : std::min<std::size_t>(1 + ((key - low) >> shift), bins - 1);
  }
};

/// The values of an output in equal parts of their keys. Each part is counted in one pass; where a
/// wanted rank lies in it, it is parted again in the next one.
struct Part {
  Bins places;
  bool sorted{};  ///< few: its keys are kept instead
  std::uint64_t least{std::numeric_limits<std::uint64_t>::max()}, most{};
  std::vector<std::uint64_t> counts{}, keys{};
  std::vector<int> below{};  ///< per part the number of the Part that it is; −1: not wanted

  Part(std::uint64_t from, std::uint64_t to, bool is_open) : places(from, to, is_open) {}

  /// Keys of a part that has values.
  [[nodiscard]] std::uint64_t first_key(std::size_t bin) const {
    if (places.open && bin == 0) return least;
    return places.low + ((std::uint64_t{bin} - (places.open ? 1 : 0)) << places.shift);
  }
  [[nodiscard]] std::uint64_t last_key(std::size_t bin) const {
    if (places.open && bin == 0) return places.low - 1;
    if (places.open && bin == bins - 1) return most;
    return first_key(bin) + ((std::uint64_t{1} << places.shift) - 1);
  }

  void take(std::uint64_t key) {
    if (sorted) return keys.push_back(key);
    least = std::min(least, key);
    most = std::max(most, key);
    if (counts.empty()) counts.resize(bins);
    ++counts[places.of(key)];
  }
  void count(std::span<const double> values) {
    if (counts.empty()) counts.resize(bins);
    const Bins here = places;
    std::uint64_t low = least, high = most, *to = counts.data();
    for (const double value : values) {
      const std::uint64_t key = key_of(value);
      low = std::min(low, key);
      high = std::max(high, key);
      ++to[here.of(key)];
    }
    least = low;
    most = high;
  }
};

/// A rank on its way down.
struct Search {
  int part{};
  std::uint64_t rank{};  ///< in the part
  bool found{};
  std::uint64_t key{};
};

}  // namespace

struct OrderSearch::Implementation {
  std::vector<Part> parts{};   ///< first those of all values, one per output
  std::vector<char> wanted{};  ///< per output
  int begun{};                 ///< parts from here on take values in this pass
  std::vector<Search> searches{};

  explicit Implementation(std::span<const Range> ranges) : wanted(ranges.size()) {
    for (const auto& range : ranges) {
      const bool known = range.least <= range.most;
      parts.emplace_back(key_of(known ? range.least : 0.0), key_of(known ? range.most : 0.0), true);
    }
  }

  [[nodiscard]] bool found_all() const { return std::ranges::all_of(searches, &Search::found); }

  /// Some values of an output.
  void take(std::size_t output, std::span<const double> values) {
    if (begun == 0) return parts[output].count(values);
    const auto& root = parts[output];
    if (root.below.empty()) return;   // all that is wanted of it is found
    const Bins places = root.places;  // a copy and a pointer, which no value of the loop changes
    const int* below = root.below.data();
    for (const double value : values) {
      const std::uint64_t key = key_of(value);
      if (const int at = below[places.of(key)]; at >= 0) go_down(at, key);
    }
  }

  void go_down(int at, std::uint64_t key) {
    while (at >= 0 && !parts[static_cast<std::size_t>(at)].below.empty()) {
      const auto& part = parts[static_cast<std::size_t>(at)];
      at = part.below[part.places.of(key)];
    }
    if (at >= begun) parts[static_cast<std::size_t>(at)].take(key);
  }

  /// After all rows.
  void descend() {
    const int next = static_cast<int>(parts.size());
    for (auto& search : searches)
      if (!search.found) descend(search);
    begun = next;
  }

  void descend(Search& search) {
    auto& part = parts[static_cast<std::size_t>(search.part)];
    if (part.sorted) {
      if (!std::ranges::is_sorted(part.keys)) std::ranges::sort(part.keys);
      search.key = part.keys[search.rank];
      search.found = true;
      return;
    }
    std::size_t bin = 0;
    while (bin + 1 < bins && search.rank >= part.counts[bin]) search.rank -= part.counts[bin++];
    const std::uint64_t from = part.first_key(bin), to = part.last_key(bin);
    if (part.least == part.most || from == to) {
      search.key = part.least == part.most ? part.least : from;
      search.found = true;
      return;
    }
    if (part.below.empty()) part.below.assign(bins, -1);
    const int known = part.below[bin];
    search.part = known >= 0 ? known : static_cast<int>(parts.size());
    if (known >= 0) return;
    part.below[bin] = search.part;
    const bool sorted = part.counts[bin] <= few;
    parts.emplace_back(from, to, false);  // `part` is not valid from here on
    parts.back().sorted = sorted;
  }
};

OrderSearch::OrderSearch(std::span<const Range> ranges)
    : implementation_(std::make_unique<Implementation>(ranges)) {}
OrderSearch::~OrderSearch() = default;
OrderSearch::OrderSearch(OrderSearch&&) noexcept = default;

void OrderSearch::count(std::size_t output, std::span<const double> values) {
  implementation_->take(output, values);
}

std::vector<double> OrderSearch::find(const Spool& spool, std::size_t inputs,
                                      const std::vector<RankWanted>& wanted,
                                      const std::function<bool(std::uint64_t)>& counts) {
  auto& me = *implementation_;
  for (const auto& one : wanted) {
    me.wanted[one.output] = 1;
    me.searches.push_back({.part = static_cast<int>(one.output), .rank = one.rank});
  }
  RowsOfChunk rows(spool.width());
  for (me.descend(); !me.found_all(); me.descend())
    spool.each_chunk([&](std::uint64_t first, std::span<const double> numbers) {
      rows.take(first, numbers, counts);
      for (std::size_t k = 0; k < me.wanted.size(); ++k)
        if (me.wanted[k] != 0) me.take(k, rows.finite(inputs + k));
    });
  std::vector<double> values;
  for (const auto& search : me.searches) values.push_back(value_of(search.key));
  return values;
}

void RowsOfChunk::take(std::uint64_t first, std::span<const double> numbers,
                       const std::function<bool(std::uint64_t)>& counts) {
  numbers_ = numbers;
  rows_.clear();
  for (std::size_t k = 0; k * width_ < numbers.size(); ++k)
    if (counts(first + k)) rows_.push_back(k);
}

std::span<const double> RowsOfChunk::finite(std::size_t column) {
  values_.clear();
  for (const std::size_t k : rows_)
    if (const double value = numbers_[k * width_ + column]; std::isfinite(value))
      values_.push_back(value);
  return values_;
}

std::size_t parts_of(int threads, std::size_t outputs) {
  const int wanted = threads > 0 ? threads : numerics::processor_count();
  return std::clamp<std::size_t>(static_cast<std::size_t>(wanted), 1,
                                 std::max<std::size_t>(1, outputs));
}

}  // namespace hydrapod::study
