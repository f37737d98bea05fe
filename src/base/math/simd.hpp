// SPDX-License-Identifier: BSD-3-Clause
// Eight numbers at once, and exp(2 pi i u) for many phases. Every operation is one IEEE operation per lane, so the bits
// depend neither on the instruction set nor on nvcc (plain loops). Functions take references because vectors have no
// stable calling convention across instruction sets; all calls are inlined.
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
STRAY_INLINE void fill(Floats& out, float x) { out = x - Floats{}; }  // of braces g++ 12 makes a chain of inserts
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

namespace straytrace {

// Adds a exp(2 pi i phase), the phase in turns, |phase| < 2^51. The half angle avoids branches. Taylor series
// of sin(pi u)/u and cos(pi u) in u^2; the truncation error for |u| <= 1/2 is below 2e-17.
template <class Lane>
STRAY_INLINE void add_turned(Lane const& phase, double a, Lane& real, Lane& imag) {
  constexpr double sine[] = {3.141592653589793,       -5.167712780049969,      2.550164039877345,
                             -0.5992645293207919,     0.08214588661112819,     -0.007370430945714348,
                             0.00046630280576761234,  -2.1915353447830204e-05, 7.952054001475508e-07,
                             -2.2948428997269856e-08, 5.392664662608125e-10};
  constexpr double cosine[] = {1.0,
                               -4.934802200544679,
                               4.058712126416768,
                               -1.3352627688545893,
                               0.23533063035889312,
                               -0.02580689139001405,
                               0.001929574309403922,
                               -0.00010463810492484565,
                               4.303069587032944e-06,
                               -1.387895246221376e-07,
                               3.6047307974624982e-09};
  constexpr double to_whole = 0x1.8p52;  // adding and subtracting it rounds to a whole number
  Lane const u = phase - ((phase + to_whole) - to_whole), v = u * u;
  Lane s = sine[10] * v + sine[9], c = cosine[10] * v + cosine[9];
  for (int k = 8; k >= 0; --k) {
    s = s * v + sine[k];
    c = c * v + cosine[k];
  }
  s *= u;
  real += a - 2 * a * (s * s);
  imag += 2 * a * (s * c);
}

}  // namespace straytrace
