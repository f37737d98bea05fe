// SPDX-License-Identifier: BSD-3-Clause
// Fit of fringe-wrapped stray light to a record of h(t) and of the motion that causes it (requirements R6.06, R6.07):
//   h(t) = sum over paths of { T_ph * [sqrt(f_r) sin(phi + theta(t))] + T_am * [sqrt(f_r) cos(phi + theta(t))] } +
//   noise, theta(t) = W (4 pi/lambda) u(t - delay) + drift (t - middle),  u = x_1 - ratio x_2.
// For given W, delay, drift and ratio this is linear in sqrt(f_r) (cos phi, sin phi): variable projection. A grid
// search finds these four, and least squares refines them together (docs/theory/fit.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/fringes/fringe_stretch.hpp"
#include "base/namespaces.hpp"

namespace straytrace::analysis {

// Search range of a parameter; equal ends: fixed.
struct SearchRange {
  double low = 0, high = 0;
  bool free() const { return high > low; }
};

struct FringePath {
  std::string name;
  SearchRange multiplicity{1, 1}, delay, drift;  // units of 2k; s; rad/s
  StrainResponse phase, amplitude;               // null: 1 and 0, with amplitudes in units of the target
};

enum class FitMethod : std::uint8_t { frequency, time };  // likelihood on lines; least squares of whitened samples

struct FringeFitSettings {
  double low = 0, high = 0;  // Hz, band
  double wavelength = 1064e-9;
  std::vector<FringePath> paths;
  SearchRange ratio;          // of the second witness
  double train = 0.7;         // share of the record that is fitted; the rest tests the fit
  double false_alarm = 1e-3;  // chance of noise alone, in the fitted stretch and in the rest, each
  FitMethod method = FitMethod::frequency;
  double clock = 0;  // s: searches another delay of the witness this far to either side; 0: common clock
};

struct Fitted {
  double value = 0, sigma = 0;  // sigma 0: fixed
  bool at_end = false;          // of its range: the truth may lie beyond
};

struct FittedPath {
  std::string name;
  Fitted amplitude;  // sqrt(f_r), or in units of the target where no response was given
  Fitted phase;      // rad, -pi to pi, at the middle of the fitted stretch and the mean of the motion
  Fitted multiplicity, delay, drift;
  double gain = 0;            // reduction of chi^2 by this path when it is added last
  double ln_false_alarm = 0;  // ln of the chance that noise alone gains as much, anywhere in the ranges
};

// Test of the fit on the part of the record that it has not used.
struct OutOfSample {
  double seconds = 0;                         // 0: the fit used the whole record
  double without = 0, with = 0, degrees = 0;  // chi^2 of the target and of target less model
  // Least-squares factor on the model: 1 when the fit generalises, 0 when it was noise; its error is that of the noise
  // of the rest and of all fitted parameters together.
  Fitted scale;
  Fitted reduction;  // of the whitened power in the band: 1 - with/without
  // ln of the likelihood of the rest with the fit, its parameters spread by their covariance, over that without. Noise
  // alone exceeds ln(1/p) with a chance of at most p (Markov: the ratio is 1 in the mean).
  double ln_odds = 0;
  Fitted ln_odds_expected;  // of a right fit
};

enum class FitOutcome : std::uint8_t {
  none,         // noise alone explains it
  untested,     // significant, but the rest of the record cannot confirm it even if it is correct
  not_general,  // significant, but does not predict the rest of the record
  clock,        // another delay of the witness fits better, and gives another amplitude
  at_end,       // significant, but a parameter is at the end of its range: the maximum may lie outside
  found         // significant in the fitted stretch, all places of the search counted, and in the rest
};

// The same fit with a delay between the clocks of target and witness.
struct ClockCheck {
  double range = 0;               // s, searched to either side; 0: not searched
  Fitted delay;                   // s, the best; common to all paths
  double gain = 0;                // reduction of chi^2 relative to the delay of the fit
  std::vector<FittedPath> paths;  // with it
  bool better = false;            // more than noise alone over as many delays
  bool doubtful = false;          // better, and an amplitude differs by more than its error
};

struct FringeFit {
  std::vector<FittedPath> paths;
  Fitted ratio;
  std::vector<std::string> names;             // of the free parameters, "amplitude 1", "multiplicity 1", ...
  std::vector<double> correlation;            // names x names
  double without = 0, with = 0, degrees = 0;  // chi^2 of the fitted stretch; of noise, less one for each parameter
  double ln_false_alarm = 0;                  // of all paths together: that of the most significant
  double trials = 0;                          // transforms of the search
  double highest_fringe = 0;                  // Hz, of the fitted paths, from the motion
  double start = 0, split = 0, end = 0, middle = 0;  // GPS s: fitted from start to split
  std::vector<double> means;                         // m, of the witnesses: reference of the phases
  OutOfSample test;
  ClockCheck clock;
  FitOutcome verdict = FitOutcome::none;
};

// Throws InputError: records that do not overlap, a band outside the sampled one, a sample rate that cannot hold the
// fringes of the ranges (docs/theory/spectra.md, eq. 7.13), too few data, a search that would take too long.
FringeFit fit_fringes(FringeRecords const&, FringeFitSettings const&);

// The fitted noise at the samples of the target from first to last (beyond the witness: 0), inside the band, with edges
// that fall over 5 % of its width; in units of the target.
struct FringeModel {
  std::size_t first = 0;  // sample
  std::vector<double> values;
};
FringeModel fringe_model(FringeRecords const&, FringeFitSettings const&, FringeFit const&);

// Correlation of columns that one path at two places of its range gives is 1 - l^2/2: l is the length between them.
// ln of the chance that chi^2 of two columns exceeds `gain` somewhere in a box of these side lengths (expected Euler
// characteristic of a Rayleigh field, leading term of each dimension; cf. Davies 1987).
double ln_chance_of(double gain, std::vector<double> const& lengths);

}  // namespace straytrace::analysis
