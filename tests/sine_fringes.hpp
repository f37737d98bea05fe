// SPDX-License-Identifier: BSD-3-Clause
// Fringe wrapping by a sine motion x = A sin(2 pi f_m t) along the beam, one normal-incidence bounce (physics.md 7).
#pragma once

#include <cmath>

#include "base/constants.hpp"

namespace straytrace {

// Peak phase z [rad] and highest fringe frequency [Hz], physics.md eq. 7.2. A in m, peak.
inline double phase_amplitude(double motion_peak, double wavelength) { return 4 * pi * motion_peak / wavelength; }
inline double cutoff(double phase_peak, double motion_hz) { return phase_peak * motion_hz; }

// One-sided PSD of sin(phi_0 + phi(t)) for z >> 1, mean over phi_0, smoothed over lines: the shelf, eq. 7.6 [1/Hz].
// At f = 0 it is the plateau whose root this project quotes.
inline double shelf_psd(double hz, double cutoff_hz) {
  return hz < cutoff_hz ? 1 / (pi * std::sqrt(cutoff_hz * cutoff_hz - hz * hz)) : 0;
}

}  // namespace straytrace
