// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/beam_lines.hpp"

#include <algorithm>

#include "base/math/functions.hpp"

namespace straytrace {

// rho^2 = (root x + b/root y)^2 + (rest y)^2 for Im Q = (a, b; b, c) lambda/pi.
BeamLines::BeamLines(Mode const& mode) : origin(mode.origin), travel(mode.travel) {
  double const k = pi / mode.wavelength, a = k * mode.q11.imag(), b = k * mode.q12.imag(), c = k * mode.q22.imag();
  double const root = std::sqrt(a), rest = std::sqrt(c - b * b / a);
  across_ = (1 / root) * mode.e1;
  up_ = (1 / rest) * (mode.e2 - (b / a) * mode.e1);
}

Vec3 BeamLines::towards(SinCos a) const { return a.cos * across_ + a.sin * up_; }

Stripes without(Stripes const& all, Stripes const& gone) {
  Stripes left;
  for (Stripe rest : all) {
    for (Stripe const& g : gone) {
      if (g.to <= rest.from || g.from >= rest.to) continue;
      if (g.from > rest.from) left.push_back({rest.from, g.from});
      rest.from = std::min(g.to, rest.to);
    }
    if (!rest.empty()) left.push_back(rest);
  }
  return left;
}

Stripes together(Stripes const& one, Stripes const& two) {
  Stripes all = one;
  for (Stripe const& s : without(two, one)) all.push_back(s);
  std::sort(all.begin(), all.end(), [](Stripe const& a, Stripe const& b) { return a.from < b.from; });
  return all;
}

double share_of(Stripes const& all) {
  double sum = 0;
  for (Stripe const& s : all) sum += s.share();
  return sum;
}

}  // namespace straytrace
