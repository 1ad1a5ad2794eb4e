#pragma once
/// Numbers of several designs side by side, one design per SIMD lane. Private to the kernels.
///
/// Everything is in an anonymous namespace and calls nothing of any library: an inline function
/// that is compiled for one processor must not be linked into code for another.

#if defined(__AVX__) || defined(__SSE2__)
#include <immintrin.h>
#endif

namespace hydrapod::study {

namespace {

constexpr double rounding_unit = 0x1p-52;

/// `Count` doubles, one per design.
template <int Count>
struct LaneTypes {
  typedef double Vector __attribute__((vector_size(Count * sizeof(double))));   // NOLINT
  typedef long long Mask __attribute__((vector_size(Count * sizeof(double))));  // NOLINT
};

#define HYDRAPOD_INLINE inline __attribute__((always_inline))
#define HYDRAPOD_APART __attribute__((noinline))  ///< so that profiles name it

/// Masks of two vectors.
template <class M>
struct TwoMasks {
  M low, high;
  friend HYDRAPOD_INLINE TwoMasks operator&(const TwoMasks& a, const TwoMasks& b) {
    return {a.low & b.low, a.high & b.high};
  }
  friend HYDRAPOD_INLINE TwoMasks operator|(const TwoMasks& a, const TwoMasks& b) {
    return {a.low | b.low, a.high | b.high};
  }
  friend HYDRAPOD_INLINE TwoMasks operator~(const TwoMasks& a) { return {~a.low, ~a.high}; }
};

/// Two vectors side by side: roots and divisions of the one run while the other waits for its own.
template <class V, class M>
struct Two {
  V low, high;
  using Masks = TwoMasks<M>;

#define HYDRAPOD_ARITHMETIC(op)                                        \
  friend HYDRAPOD_INLINE Two operator op(const Two& a, const Two& b) { \
    return {a.low op b.low, a.high op b.high};                         \
  }                                                                    \
  friend HYDRAPOD_INLINE Two operator op(double a, const Two& b) {     \
    return {a op b.low, a op b.high};                                  \
  }                                                                    \
  friend HYDRAPOD_INLINE Two operator op(const Two& a, double b) {     \
    return {a.low op b, a.high op b};                                  \
  }
#define HYDRAPOD_COMPARISON(op)                                          \
  friend HYDRAPOD_INLINE Masks operator op(const Two& a, const Two& b) { \
    return {a.low op b.low, a.high op b.high};                           \
  }                                                                      \
  friend HYDRAPOD_INLINE Masks operator op(const Two& a, double b) {     \
    return {a.low op b, a.high op b};                                    \
  }
  HYDRAPOD_ARITHMETIC(+)
  HYDRAPOD_ARITHMETIC(-)
  HYDRAPOD_ARITHMETIC(*)
  HYDRAPOD_ARITHMETIC(/)
  HYDRAPOD_COMPARISON(==)
  HYDRAPOD_COMPARISON(!=)
  HYDRAPOD_COMPARISON(<)
  HYDRAPOD_COMPARISON(>)
  HYDRAPOD_COMPARISON(<=)
#undef HYDRAPOD_ARITHMETIC
#undef HYDRAPOD_COMPARISON
  friend HYDRAPOD_INLINE Two operator-(const Two& a) { return {-a.low, -a.high}; }
  HYDRAPOD_INLINE Two& operator+=(const Two& b) { return *this = *this + b; }
  HYDRAPOD_INLINE Two& operator-=(const Two& b) { return *this = *this - b; }
};

/// a where the mask is set, else b.
template <class M, class V>
HYDRAPOD_INLINE V select(const M& mask, const V& a, const V& b) {
  return mask ? a : b;
}
template <class M, class V>
HYDRAPOD_INLINE Two<V, M> select(const TwoMasks<M>& mask, const Two<V, M>& a, const Two<V, M>& b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}

template <class V>
HYDRAPOD_INLINE V root(const V& a) {
#if defined(__AVX512F__)
  if constexpr (sizeof(V) == 64) return (V)_mm512_sqrt_pd((__m512d)a);
#endif
#if defined(__AVX__)
  if constexpr (sizeof(V) == 32) return (V)_mm256_sqrt_pd((__m256d)a);
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(V) == 16) return (V)_mm_sqrt_pd((__m128d)a);
#endif
  V result = a;
  for (unsigned i = 0; i < sizeof(V) / sizeof(double); ++i) result[i] = __builtin_sqrt(a[i]);
  return result;
}

template <class V, class M>
HYDRAPOD_INLINE Two<V, M> root(const Two<V, M>& a) {
  return {root(a.low), root(a.high)};
}

template <class M>
HYDRAPOD_INLINE bool any(const M& mask) {
#if defined(__AVX512F__)
  if constexpr (sizeof(M) == 64) return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#endif
  long long all = 0;
  for (unsigned i = 0; i < sizeof(M) / sizeof(long long); ++i) all |= mask[i];
  return all != 0;
}
template <class M>
HYDRAPOD_INLINE bool any(const TwoMasks<M>& mask) {
  return any(mask.low) || any(mask.high);
}

template <class V>
HYDRAPOD_INLINE V size_of(const V& a) {
  return select(a < 0.0, -a, a);
}
template <class V>
HYDRAPOD_INLINE V larger(const V& a, const V& b) {
  return select(a > b, a, b);
}

/// The largest of the numbers in the lanes.
template <class V>
HYDRAPOD_INLINE double largest_of(const V& a) {
  double largest = a[0];
  for (unsigned i = 1; i < sizeof(V) / sizeof(double); ++i)
    largest = a[i] > largest ? a[i] : largest;
  return largest;
}
template <class V, class M>
HYDRAPOD_INLINE double largest_of(const Two<V, M>& a) {
  const double low = largest_of(a.low), high = largest_of(a.high);
  return low > high ? low : high;
}

/// Vectors in space.
template <class V>
struct Space {
  V x, y, z;

  friend HYDRAPOD_INLINE Space operator+(const Space& a, const Space& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend HYDRAPOD_INLINE Space operator-(const Space& a, const Space& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend HYDRAPOD_INLINE Space operator-(const Space& a) { return {-a.x, -a.y, -a.z}; }
  friend HYDRAPOD_INLINE Space operator*(const V& a, const Space& b) {
    return {a * b.x, a * b.y, a * b.z};
  }
};
template <class V>
HYDRAPOD_INLINE V dot(const Space<V>& a, const Space<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
HYDRAPOD_INLINE Space<V> cross(const Space<V>& a, const Space<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
HYDRAPOD_INLINE Space<V> space(const V (&a)[3]) {
  return {a[0], a[1], a[2]};
}

}  // namespace

}  // namespace hydrapod::study
