// SPDX-License-Identifier: BSD-3-Clause
// Higher modes of a cavity, order by order, and what they share with Hermite-Gauss and Laguerre-Gauss modes
// (docs/theory/wave.md, Higher modes).
#pragma once

#include <functional>
#include <vector>

#include "wave/cavity.hpp"

namespace straytrace::wave {

// A mode of the cavity. Modes with one eigenvalue, to the error of the losses, share a span, in which any combination
// is a mode as well: `shared` is what the named mode has in that span, and as many are named as the span has
// dimensions.
struct ModeLine {
  struct Named {
    int one = 0, two = 0;  // HG: n, m; LG: p, l
    double shared = 0;     // power
  };
  int order = 0;
  Named hermite, laguerre;
  double in_order = 0;  // power that it shares with the Gaussian modes of its order
  double loss = 0;      // of power per round trip
  double phase = 0;     // of the round trip, less that of the fundamental mode; turns, -0.5 to 0.5
  double residual = 0;
  int alike = 1;  // modes of this order with its eigenvalue
};

// The modes of all orders up to the highest, by order and loss. An order of which rims take so much that no mode shares
// half of its power with it is left out.
// `hermite_gauss`: spectra of the modes about the axis after the last mirror, by n and m.
std::vector<ModeLine> mode_table(RoundTrip const&, std::function<Field(int n, int m)> const& hermite_gauss,
                                 int highest_order, SolveOptions const& = {});
inline std::vector<ModeLine> mode_table(CavityWaves const& waves, int highest_order, SolveOptions const& options = {}) {
  return mode_table(
      waves.trip(), [&](int n, int m) { return waves.hermite_gauss(n, m); }, highest_order, options);
}

}  // namespace straytrace::wave
