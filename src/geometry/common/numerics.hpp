// SPDX-License-Identifier: BSD-3-Clause
// Numerics of shapes. Roots that cannot be lost: bracketed Newton steps, and the search for the first root of a
// function whose second derivative is bounded. Random numbers for sampling by rejection, as functions of two given
// ones.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/math/constants.hpp"
#include "base/memory/host_device.hpp"

namespace straytrace::geometry {

struct Sloped {
  double value, slope;
};

// The root of f between a and b, where f(a) and f(b) have opposite signs (or one is zero): Newton steps that fall back
// to bisection, until the bracket or the step is exhausted.
template <class F>
STRAY_HD double bracketed_root(F const& f, double a, double b, bool rising) {
  double x = a + 0.5 * (b - a), last = b - a;
  for (int i = 0; i < 200; ++i) {
    Sloped const y = f(x);
    if (y.value == 0) return x;
    ((y.value > 0) == rising ? b : a) = x;
    double const newton = x - y.value / y.slope, step = std::fabs(newton - x);
    bool const good = newton > a && newton < b && step <= 0.5 * std::fabs(last);
    double const next = good ? newton : a + 0.5 * (b - a);
    last = next - x;
    if (next == x || !(next > a && next < b)) return x;
    x = next;
  }
  return x;
}

// The first root in (from, to) that `keep(t)` takes, infinity: none. `bend` bounds |f''| on the interval. Pieces of the
// interval are dropped when f cannot reach zero on them and searched when f is monotone on them; all others are halved.
// `least` is the length below which a piece that is still open (a tangent within rounding) holds no root.
template <class F, class Keep>
STRAY_HD double first_root(F const& f, double from, double to, double bend, double least, Keep const& keep) {
  struct Piece {
    double a, b;
  } stack[128];
  int top = 0;
  stack[top++] = {from, to};
  while (top > 0) {
    Piece const p = stack[--top];
    double const half = 0.5 * (p.b - p.a), middle = p.a + half;
    Sloped const y = f(middle);
    if (std::fabs(y.value) > half * (std::fabs(y.slope) + 0.5 * bend * half)) continue;
    if (std::fabs(y.slope) > bend * half) {
      double const low = f(p.a).value, high = f(p.b).value;
      if ((low < 0) == (high < 0) && low != 0 && high != 0) continue;
      double const t = bracketed_root(f, p.a, p.b, y.slope > 0);
      if (keep(t)) return t;
      continue;
    }
    if (half < least || top + 2 > 128) continue;
    stack[top++] = {middle, p.b};
    stack[top++] = {p.a, middle};
  }
  return infinity;
}

// A sequence of uniform numbers in [0, 1), fixed by u and v (splitmix64; Steele, Lea, Flood 2014).
class Redraw {
 public:
  STRAY_HD Redraw(double u, double v) {
    std::uint64_t a, b;
    std::memcpy(&a, &u, sizeof a);
    std::memcpy(&b, &v, sizeof b);
    state_ = mixed(a) ^ (b * 0xd6e8feb86659fd93ull);
  }
  STRAY_HD double next() {
    state_ += 0x9e3779b97f4a7c15ull;
    return static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
  }

 private:
  STRAY_HD static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

}  // namespace straytrace::geometry
