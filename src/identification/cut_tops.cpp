#include "cut_tops.hpp"

#include <algorithm>
#include <cmath>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Samples that a top of n is judged by on either side.
Index flank_of(Index n) { return (n + 1) / 2; }

constexpr Index beside_flank = 2;  // are they held?

}  // namespace

void CutTops::keep(End& end, Top top) const {
  if (end.seen++ % end.every != 0) return;
  end.stored += top.x.size();
  end.tops.push_back(std::move(top));
  if (end.stored <= options_.most) return;
  const double least = end.extreme - options_.bands.back() * (low_.extreme + high_.extreme);
  std::erase_if(end.tops, [&](const Top& other) { return std::ranges::max(other.x) < least; });
  const auto count = [&] {
    end.stored = 0;
    for (const Top& other : end.tops) end.stored += other.x.size();
  };
  count();
  if (2 * end.stored <= options_.most) return;
  for (std::size_t k = 1; 2 * k < end.tops.size(); ++k) end.tops[k] = std::move(end.tops[2 * k]);
  end.tops.resize((end.tops.size() + 1) / 2);
  end.every *= 2;
  count();
}

Index CutTops::look(End& end, const Samples& x, Index from) const {
  const double least = end.extreme - options_.bands.back() * (low_.extreme + high_.extreme);
  const Index size = std::ssize(x);
  const auto value = [&](Index t) { return end.side * x[static_cast<std::size_t>(t)]; };
  for (Index t = from; t < size; ++t) {
    if (!(value(t) >= least)) continue;
    const Index begin = t;
    while (t < size && value(t) >= least) ++t;
    const Index n = t - begin, beside = flank_of(n) + beside_flank;
    if (n > options_.longest) continue;
    if (t + beside > size) return begin;
    if (begin < beside) continue;
    Top top{.beside = beside};
    for (Index k = begin - beside; k < t + beside; ++k) top.x.push_back(value(k));
    keep(end, std::move(top));
  }
  return size;
}

void CutTops::add(const Column& samples, double low, double high) {
  low_.extreme = std::max(low_.extreme, -low);
  high_.extreme = std::max(high_.extreme, high);
  const double band = options_.bands.back() * (low_.extreme + high_.extreme);
  const Index before = std::ssize(before_);
  const bool is_low = -low >= low_.extreme - band || seen_low_ < before,
             is_high = high >= high_.extreme - band || seen_high_ < before;
  // what is beside a top that begins with the next piece
  const Index tail = flank_of(options_.longest) + beside_flank;
  if (!is_low && !is_high && samples.size() >= tail) {
    before_.assign(samples.end() - tail, samples.end());
    seen_low_ = seen_high_ = tail;
    return;
  }
  before_.insert(before_.end(), samples.begin(), samples.end());
  const Index size = std::ssize(before_);
  seen_low_ = is_low ? look(low_, before_, seen_low_) : size;
  seen_high_ = is_high ? look(high_, before_, seen_high_) : size;
  const Index gone = std::max<Index>(0, std::min(seen_low_, seen_high_) - tail);
  before_.erase(before_.begin(), before_.begin() + gone);
  seen_low_ -= gone;
  seen_high_ -= gone;
}

CutTops::Count CutTops::count(const End& end, double band) const {
  const double least = end.extreme - band;
  Count sums;
  for (const Top& top : end.tops) {
    const auto x = VectorXd::Map(top.x.data(), std::ssize(top.x));
    for (Index t = top.beside; t < x.size() - top.beside; ++t) {
      if (!(x[t] >= least)) continue;
      const Index begin = t;
      while (t < x.size() && x[t] >= least) ++t;
      const Index n = t - begin, beside = flank_of(n);
      sums.samples += n * end.every;
      if (n < options_.least || begin < beside + 1 || t + beside >= x.size()) continue;
      const bool is_held = x[begin - 1] == x[begin - 2] || x[t] == x[t + 1];
      const double fall = end.extreme - std::max(x[begin - beside], x[t - 1 + beside]);
      const bool is_cut = !is_held && fall > options_.corner * band;
      ++(is_cut ? sums.cut : sums.round);
      sums.sharp += is_cut && fall > options_.sharp_corner * band;
    }
  }
  return sums;
}

CutOff CutTops::cut_off(double step) const {
  const double range = low_.extreme + high_.extreme;
  std::vector<CutOff> found_in;
  for (const double share : options_.bands) {
    const double band = share * range;
    if (!(band >= options_.of_step * step)) continue;
    CutOff here;
    for (const End* end : {&low_, &high_}) {
      const auto found = count(*end, band);
      if (found.cut < found.round || (found.cut < options_.fewest && found.sharp == 0)) continue;
      here.samples += found.samples;
      (end == &low_ ? here.below : here.above) = end->side * (end->extreme - band);
    }
    found_in.push_back(here);
  }
  // the narrowest band that has nearly all of them is as wide as the noise
  constexpr double nearly_all = 0.9;
  double most = 0.0;
  for (const CutOff& here : found_in) most = std::max(most, static_cast<double>(here.samples));
  const auto narrowest = std::ranges::find_if(found_in, [&](const CutOff& here) {
    return static_cast<double>(here.samples) >= nearly_all * most;
  });
  return most > 0.0 ? *narrowest : CutOff();
}

}  // namespace hydrapod::identification
