#include "order_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace hydrapod::study {

namespace {

constexpr unsigned digit_bits = 11, digits = 6;  // 66 bits: the first digit has nine
constexpr std::uint64_t sign = std::uint64_t{1} << 63U;

/// Numbers ordered as their values are.
std::uint64_t key_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
double value_of(std::uint64_t key) {
  return std::bit_cast<double>((key & sign) != 0 ? key & ~sign : ~key);
}

/// Values of an output that begin with `prefix`, counted by their next eleven bits.
struct Histogram {
  std::size_t output{};
  std::uint64_t prefix{};
  std::vector<std::uint64_t> counts = std::vector<std::uint64_t>(std::size_t{1} << digit_bits);
};

}  // namespace

std::vector<double> order_statistics(const Spool& spool, std::size_t inputs,
                                     const std::vector<RankWanted>& wanted,
                                     const std::function<bool(std::uint64_t)>& counts) {
  std::vector<std::uint64_t> prefix(wanted.size(), 0), rank(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) rank[k] = wanted[k].rank;
  const std::size_t width = spool.width();
  for (unsigned digit = 0; digit < digits && !wanted.empty(); ++digit) {
    const unsigned below = digit_bits * (digits - 1 - digit);
    std::map<std::pair<std::size_t, std::uint64_t>, std::size_t> place;
    std::vector<Histogram> histograms;
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (place.try_emplace({wanted[k].output, prefix[k]}, histograms.size()).second)
        histograms.push_back({wanted[k].output, prefix[k]});
    spool.each_chunk([&](std::uint64_t first, std::span<const double> numbers) {
      for (std::size_t at = 0; at < numbers.size(); at += width) {
        if (!counts(first + at / width)) continue;
        for (auto& one : histograms) {
          const double value = numbers[at + inputs + one.output];
          const std::uint64_t key = key_of(value) >> below;
          if (key >> digit_bits == one.prefix && std::isfinite(value))
            ++one.counts[key & ((std::uint64_t{1} << digit_bits) - 1)];
        }
      }
    });
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const auto& found = histograms[place.at({wanted[k].output, prefix[k]})].counts;
      std::uint64_t next = 0;
      while (next + 1 < found.size() && rank[k] >= found[next]) rank[k] -= found[next++];
      prefix[k] = prefix[k] << digit_bits | next;
    }
  }
  std::vector<double> values(wanted.size());
  std::ranges::transform(prefix, values.begin(), value_of);
  return values;
}

}  // namespace hydrapod::study
