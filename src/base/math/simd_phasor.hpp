// SPDX-License-Identifier: BSD-3-Clause
// exp(2 pi i u) for many phases, the same bits in every width of vectors and on a device.
#pragma once

#include "base/math/simd.hpp"

namespace straytrace {

// Adds a exp(2 pi i phase), the phase in turns, |phase| < 2^51. The half angle makes it free of branches. Taylor series
// of sin(pi u)/u and cos(pi u) in u^2; for |u| <= 1/2 what is cut off is below 2e-17.
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
  constexpr double to_whole = 0x1.8p52;  // adding and taking it away rounds to a whole number
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
