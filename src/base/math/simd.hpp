// SPDX-License-Identifier: BSD-3-Clause
// Eight numbers at once. Every operation is one IEEE operation per lane, so the instruction set that a compiler picks
// (or the plain loops under nvcc) cannot change a bit. Functions take references: vectors have no stable calling
// convention across instruction sets, and all of this is inlined anyway.
#pragma once

#include <cstdint>

#include "base/memory/host_device.hpp"

#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__)
#define STRAY_VECTORS 1
#define STRAY_INLINE inline __attribute__((always_inline))
#define STRAY_INLINE_LAMBDA __attribute__((always_inline))
#else
#define STRAY_VECTORS 0
#define STRAY_INLINE STRAY_HD
#define STRAY_INLINE_LAMBDA
#endif

#if defined(__GNUC__)
#define STRAY_LIKELY(x) __builtin_expect(!!(x), 1)
#define STRAY_UNLIKELY(x) __builtin_expect(!!(x), 0)
#else
#define STRAY_LIKELY(x) (x)
#define STRAY_UNLIKELY(x) (x)
#endif

namespace straytrace::simd {

STRAY_HD std::uint32_t float_bits(float x) {
  std::uint32_t bits;
  __builtin_memcpy(&bits, &x, sizeof bits);
  return bits;
}

constexpr int lanes = 8;

#if STRAY_VECTORS
typedef float Floats __attribute__((vector_size(32)));
typedef double Doubles __attribute__((vector_size(64)));
typedef std::int32_t Ints __attribute__((vector_size(32)));

STRAY_INLINE Floats const& loaded(float const* from) { return *reinterpret_cast<Floats const*>(from); }
STRAY_INLINE void fill(Floats& out, float x) { out = Floats{x, x, x, x, x, x, x, x}; }
STRAY_INLINE void store_bits(std::uint32_t* to, Floats const& x) {
  *reinterpret_cast<Ints __attribute__((may_alias))*>(to) = (Ints)x;
}
// a where a > b (a < b), else b: a lane of `a` that is NaN is discarded.
STRAY_INLINE void raise(Floats& b, Floats const& a) { b = a > b ? a : b; }
STRAY_INLINE void lower(Floats& b, Floats const& a) { b = a < b ? a : b; }
// Bit i is set where lane i of a comparison is true.
STRAY_INLINE unsigned bits_set(Ints const& mask) {
  union {
    Ints all;
    float __attribute__((vector_size(16))) half[2];
  } m;
  m.all = mask;
  return unsigned(__builtin_ia32_movmskps(m.half[0])) | unsigned(__builtin_ia32_movmskps(m.half[1])) << 4;
}
// Bit i is set where a <= b in lane i.
STRAY_INLINE unsigned at_most(Floats const& a, Floats const& b) { return bits_set(a <= b); }
#else
struct Floats {
  float x[lanes];
};
STRAY_HD Floats const& loaded(float const* from) { return *reinterpret_cast<Floats const*>(from); }
STRAY_HD void fill(Floats& out, float x) {
  for (int i = 0; i < lanes; ++i) out.x[i] = x;
}
STRAY_HD void store_bits(std::uint32_t* to, Floats const& x) {
  for (int i = 0; i < lanes; ++i) to[i] = float_bits(x.x[i]);
}
STRAY_HD void raise(Floats& b, Floats const& a) {
  for (int i = 0; i < lanes; ++i) b.x[i] = a.x[i] > b.x[i] ? a.x[i] : b.x[i];
}
STRAY_HD void lower(Floats& b, Floats const& a) {
  for (int i = 0; i < lanes; ++i) b.x[i] = a.x[i] < b.x[i] ? a.x[i] : b.x[i];
}
STRAY_HD unsigned at_most(Floats const& a, Floats const& b) {
  unsigned mask = 0;
  for (int i = 0; i < lanes; ++i) mask |= unsigned(a.x[i] <= b.x[i]) << i;
  return mask;
}
STRAY_HD Floats operator-(Floats const& a, Floats const& b) {
  Floats out;
  for (int i = 0; i < lanes; ++i) out.x[i] = a.x[i] - b.x[i];
  return out;
}
STRAY_HD Floats operator*(Floats const& a, Floats const& b) {
  Floats out;
  for (int i = 0; i < lanes; ++i) out.x[i] = a.x[i] * b.x[i];
  return out;
}
#endif

// Number of the lowest bit that is set.
STRAY_HD int lowest(unsigned bits) {
#if defined(__CUDA_ARCH__)
  return __ffs(int(bits)) - 1;
#else
  return __builtin_ctz(bits);
#endif
}

}  // namespace straytrace::simd
