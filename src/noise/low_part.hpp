// SPDX-License-Identifier: BSD-3-Clause
// Spectrum of the slow, strong part of the phase of a path by one Fourier transform, exact for any strength.
#pragma once

#include <span>
#include <vector>

namespace straytrace {

// Phase modulation by a sine: peak z [rad] at a frequency [Hz].
struct PhaseTone {
  double frequency, peak;
};

// The slow part of the phase: Gaussian, of given power per band, and tones.
struct SlowPhase {
  // Power [rad^2] of the Gaussian part between two frequencies [Hz].
  virtual double power(double low_hz, double high_hz) const = 0;
  virtual ~SlowPhase() = default;
  double highest = 0;      // Hz, beyond which there is no power
  double fringe_rate = 0;  // Hz, rms of (dphi/dt)/2pi of the Gaussian part
  std::vector<PhaseTone> tones;
};

// Mean over phi_0 of the PSD of Im s, on lines k * spacing of width `spacing` (physics.md eq. 1.12 with C(0) = 1).
struct LowPart {
  double spacing = 0;           // Hz
  std::vector<double> density;  // 1/Hz at k * spacing; zero where the transform shows only rounding
  double constant = 0;          // power of the unmoved light, at f = 0; constant + all density * spacing = 1/2
  std::size_t samples = 0;      // of the transform
};

// `resolution`: the spacing of lines is at most this [Hz]; coarser only when the fringe rate would need more than 2^20
// samples. Throws NumericalError beyond 2^24.
LowPart transform(SlowPhase const&, double resolution);

// Under a steady drift of the phase by `hz` turns per second, taken to the nearest line: C(tau) cos(2 pi hz tau). The
// unmoved light becomes a line. Throws NumericalError beyond 2^24 lines.
LowPart drifting(LowPart const&, double hz);

double total(LowPart const&);  // its power, constant included: 1/2

}  // namespace straytrace
