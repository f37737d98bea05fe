// SPDX-License-Identifier: BSD-3-Clause
// Spectrum of the slow, strong part of the phase of a path by one Fourier transform, exact for any strength.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/errors.hpp"

namespace straytrace::noise {
// Phase modulation by a sine: peak z [rad] at a frequency [Hz].
struct PhaseTone {
  double frequency, peak;
};

// Everything is even in the lag and has the period 1/spacing: lags (n + 1/2)/(samples spacing), n < samples/2, hold
// everything.
struct LagGrid {
  double spacing;  // Hz, of the lines
  std::size_t samples;
  std::size_t size() const { return samples / 2; }
  // Turns of a tone, taken to the nearest line, at a lag; between 0 and 1.
  double turns(double hz, std::size_t n) const;
  std::size_t period(double hz) const;  // lags after which the turns of a tone repeat
};

// Autocovariance of a Gaussian phase, rad^2.
struct Covariance {
  double at_zero = 0;
  std::vector<double> at;  // the lags
};
// `line_power`: rad^2 within half a spacing of k spacing; none at k = 0.
Covariance covariance(std::vector<double> line_power, LagGrid const&);

// The slow part of the phase: Gaussian, and tones.
struct SlowPhase {
  double highest = 0;      // Hz, beyond which there is no Gaussian power
  double fringe_rate = 0;  // Hz, rms of (dphi/dt)/2pi of the Gaussian part
  std::vector<PhaseTone> tones;
};

// Mean over phi_0 of the PSD of Im s, on lines k * spacing of width `spacing` (docs/theory/spectra.md, eq. 1.12 with
// C(0) = 1).
struct WrappedSpectrum {
  double spacing = 0;           // Hz
  std::vector<double> density;  // 1/Hz at k * spacing; zero where the transform shows only rounding
  double constant = 0;          // power of the unmoved light, at f = 0; constant + all density * spacing = 1/2
  std::size_t samples = 0;      // of the transform
};

// `resolution`: the spacing of lines is at most this [Hz]; coarser only when the fringe rate would need more than 2^20
// samples. `gaussian`: covariance of the Gaussian part. Throws NumericalError beyond 2^24.
WrappedSpectrum transform(SlowPhase const&, std::function<Covariance(LagGrid const&)> const& gaussian,
                          double resolution);

// The parts of it, for sums of several such exponentials.
LagGrid lags_for(SlowPhase const&, double resolution);
// Error of a correlation and its transform, in units of the last place: below it a line is only rounding. `r0`: R(0).
double rounding_of(SlowPhase const&, std::vector<double> const& correlation, double r0, double constant);
// Transforms a correlation without its constant part; false when the sampling rate was too low.
bool transform_lags(std::vector<double> const& correlation, LagGrid const&, double rounding, WrappedSpectrum&);
NumericalError too_strong(SlowPhase const&, LagGrid const&);
constexpr std::size_t most_samples = std::size_t{1} << 24;

// Under a steady drift of the phase by `hz` turns per second, taken to the nearest line: C(tau) cos(2 pi hz tau). The
// unmoved light becomes a line. Throws NumericalError beyond 2^24 lines.
WrappedSpectrum drifting(WrappedSpectrum const&, double hz);

double total(WrappedSpectrum const&);  // its power, constant included: 1/2

// Sums of cosines on points half a step off the origin: an even record of 2m points from m numbers.

//   x_n = sum over k < m of a_k cos(pi k (n + 1/2) / m),   0 <= n < m
//
// Either way by one real transform of m numbers (J. Makhoul, IEEE Trans. ASSP 28 (1980) 27). m is a multiple of 4.
class CosineTransform {
 public:
  explicit CosineTransform(std::size_t m);
  ~CosineTransform();
  void values(std::vector<double> const& amplitudes, std::vector<double>& x) const;  // missing amplitudes are zero
  void amplitudes(std::vector<double> const& x, std::vector<double>& a) const;

  static CosineTransform const& of(std::size_t m);  // cached per thread: creating one takes longer than using it

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

// First-order effect of weak phase modulation on a field that already has a spectrum (docs/theory/spectra.md,
// eq. 7.14).

// Power concentrated at frequencies.
struct Kernel {
  std::vector<double> hz, power;
};

// One-sided PSD that is constant in bins; edges increase.
struct Steps {
  std::vector<double> edges, psd;
};

// Adds to `bin_power` the power that appears between each two edges when a line of power p at frequency g is modulated
// by S: 1/2 p [S(|f - g|) + S(f + g)]. No transform: relative precision is kept however small S is.
void add_sidebands(Kernel const&, Steps const&, std::span<double const> edges, std::span<double> bin_power);

// Power of a wrapped spectrum in each bin, its lines taken as wide as their spacing.
void add_lines(WrappedSpectrum const&, std::span<double const> edges, std::span<double> bin_power);

// add_sidebands() for a whole wrapped spectrum, its constant power included; `unshifted`: power of the modulation in
// each bin, exact where S is a coarser description of it.
void modulate(WrappedSpectrum const&, Steps const& fast, std::span<double const> unshifted,
              std::span<double const> edges, std::span<double> bin_power);

// A wrapped spectrum as a density that a line can shift.
Steps as_steps(WrappedSpectrum const&);

}  // namespace straytrace::noise
