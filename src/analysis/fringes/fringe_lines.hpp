// SPDX-License-Identifier: BSD-3-Clause
// Whether a driven line is linear or a fringe, from its harmonics and its growth with the drive (R6.03;
// docs/theory/spectra.md, eq. 7.3): h = G sin(phi_0 + z sin wt) has lines 2 G J_n(z) |cos phi_0| at odd n, |sin phi_0|
// at even n.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/coupling/lines.hpp"
#include "base/math/constants.hpp"

namespace straytrace::analysis {

struct Harmonic {
  int order = 1;
  double power = 0, sigma = 0;  // peak amplitude squared, mean over the windows less the noise; its standard error
  double limit = 0;             // 95 % upper limit of the amplitude
  bool seen = false;            // three standard errors above the noise
};

struct HarmonicFit {
  std::vector<Harmonic> harmonics;                 // orders 1, 2, ...
  double z = not_a_number, z_low = 0, z_high = 0;  // peak phase, rad; one standard error
  double significance = 0;                         // of z > 0, standard deviations
  double z_limit = 0;                              // 95 %
  bool limit_only = false;                         // less than three standard deviations: the limit is the answer
  bool open = false;                               // even the limit lies beyond the scan
  std::vector<double> others;                      // other z with a similar fit
  double odd = 0, even = 0;  // G |cos phi_0|, G |sin phi_0|: target unit; even is NaN when z is not known
  double chi_square = 0;
  int degrees = 0;
};
// `windows[n - 1]`: the target at harmonic n, window by window. Assumes a flat response of the target: calibrated data.
// z is searched up to z_max.
HarmonicFit fit_harmonics(std::span<std::vector<LinePoint> const> windows, double z_max = 20);

// The same from the target itself, at up to `orders` harmonics of the drive, as far as its rate reaches; InputError
// when that is not to the third.
HarmonicFit fit_harmonics(TimeSeries const& target, std::span<LinePoint const> drive, double window, int orders,
                          double z_max);

// A peak amplitude with its error, or an upper limit, which has none.
struct LineAmplitude {
  double value = 0, sigma = not_a_number;
  bool limit = false;
};
LineAmplitude amplitude_of(Harmonic const&);
LineAmplitude mean_amplitude(std::span<LinePoint const>);        // over the windows; its error is the spread
LineAmplitude over(LineAmplitude const&, LineAmplitude const&);  // the ratio

// Effective motion amplitude of a phase amplitude z: A = z lambda/(4 pi N), eq. 7.2 with N equal bounces.
double motion_of_phase(double z, double wavelength, double multiplicity);

struct RampFit {
  enum class Verdict { linear, fringe, neither, unseen } verdict = Verdict::linear;
  double slope = 0, slope_sigma = 0;  // target per drive, linear fit: modulus, and the error of one quadrature
  double chi_linear = 0, chi_fringe = 0;
  int degrees_linear = 0, degrees_fringe = 0;  // two per point, less the complex factor, less z
  double significance = 0;                     // of the fringe over the line, standard deviations
  double z = 0, z_low = 0, z_high = 0;         // peak phase at the largest drive, rad
  double z_limit = 0;                          // 95 %
  bool open = false;
  double small_slope = 0;  // target per drive of the fringe at small drive: G' z/drive

  double limit() const { return slope + 1.645 * slope_sigma; }  // 95 %, of target per drive
};
// The target's line, phase counted from the drive's, against the amplitude of the drive: straight line, or C J_1(z)
// with z in proportion to the drive, and C complex. `fringe` when that is better by `threshold` standard deviations and
// fits; `neither` when both miss the points (probability below 1e-3): a static phase that drifts does that. `unseen`:
// no fringe, and the slope is below three standard errors.
RampFit fit_ramp(std::span<LinePoint const> drive, std::span<LinePoint const> target, double threshold = 3,
                 double z_max = 20);

// The coupling at the line with the outcome as its flag, for the projection.
CouplingPoint coupling_at(RampFit const&, double hz);

// Least squares in one parameter that may have several minima: by scanning.

struct ScanResult {
  double best = 0, chi_square = 0;
  double low = 0, high = 0;    // chi^2 + 1: one standard error; `low` = start of the scan: none below
  double limit = 0;            // chi^2 + 2.71 above: 95 %, one-sided
  bool open = false;           // chi^2 never rises to the limit within the scan
  std::vector<double> others;  // further minima within chi^2 + 4: equally good solutions
};
// From `from` to `to` in `steps` equal steps, each minimum refined. The function is finite.
ScanResult scan_minimum(std::function<double(double)> const& chi_square, double from, double to, int steps);

}  // namespace straytrace::analysis
