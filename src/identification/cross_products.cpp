#include "cross_products.hpp"

#include <algorithm>
#include <array>

#include "line_matrix.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

using numerics::EightLines;

/// A square of four pairs: `z` are the lines of the first block, `apart` numbers per block.
/// `next`: numbers on are lines that are needed soon.
void add_square(const EightLines* z, Index blocks, Index apart, Index i, Index j, double factor,
                Index next, EightLines* sums) {
  for (int from = 0; from < 8; from += together) {
    std::array<ComplexLines, 4> sum;
    for (std::size_t s = 0; s < 4; ++s)
      sum[s].load(sums[s].re.data() + from, sums[s].im.data() + from);
    const EightLines* block = z;
    for (Index b = 0; b < blocks; ++b, block += apart) {
      __builtin_prefetch(block[next].re.data());
      __builtin_prefetch(block[next].im.data());
      ComplexLines a0, a1, c0, c1;
      a0.load(block[i].re.data() + from, block[i].im.data() + from);
      a1.load(block[i + 1].re.data() + from, block[i + 1].im.data() + from);
      c0.load(block[j].re.data() + from, block[j].im.data() + from);
      c1.load(block[j + 1].re.data() + from, block[j + 1].im.data() + from);
      if (factor != 1.0)
        for (auto* a : {&a0, &a1}) {
          a->re *= factor;
          a->im *= factor;
        }
      add_product_conjugate(a0, c0, sum[0]);
      add_product_conjugate(a0, c1, sum[1]);
      add_product_conjugate(a1, c0, sum[2]);
      add_product_conjugate(a1, c1, sum[3]);
    }
    for (std::size_t s = 0; s < 4; ++s)
      sum[s].store(sums[s].re.data() + from, sums[s].im.data() + from);
  }
}

}  // namespace

CrossProducts::CrossProducts(Index channels, Index groups) : channels_(channels) {
  const Index side = width() / 2;
  squares_ = side * (side + 1) / 2;
  sums_.resize(static_cast<std::size_t>(groups * squares_ * 4));
}

void CrossProducts::add(Index group, const EightLines* lines, Index blocks, Index apart,
                        double factor) {
  EightLines* sums = sums_.data() + group * squares_ * 4;
  // the lines of the next group stand behind those of this one; blocks are far from each other
  Index next = width();
  for (Index i = 0; i < width(); i += 2)
    for (Index j = 0; j <= i; j += 2, sums += 4, next = std::min(next + 1, 2 * width() - 1))
      add_square(lines, blocks, apart, i, j, factor, next, sums);
}

void CrossProducts::unpack(const VectorXd& scale, MatrixXd& re, MatrixXd& im) const {
  const Index lines = scale.size(), pairs = channels_ * (channels_ + 1) / 2;
  re.resize(lines, pairs);
  im.resize(lines, pairs);
  const EightLines* square = sums_.data();
  for (Index first = 0; first < lines; first += 8)
    for (Index i = 0; i < width(); i += 2)
      for (Index j = 0; j <= i; j += 2, square += 4)
        for (Index s = 0; s < 4; ++s) {
          const Index row = i + s / 2, column = j + s % 2;
          if (row >= channels_ || column > row) continue;
          const Index pair = row * (row + 1) / 2 + column,
                      count = std::min<Index>(8, lines - first);
          const auto& sum = square[s];
          for (Index k = 0; k < count; ++k) {
            re(first + k, pair) = scale[first + k] * sum.re[static_cast<std::size_t>(k)];
            im(first + k, pair) =
                row == column ? 0.0 : scale[first + k] * sum.im[static_cast<std::size_t>(k)];
          }
        }
}

}  // namespace hydrapod::identification
