// SPDX-License-Identifier: BSD-3-Clause
// Fit of fringe-wrapped stray light to a record of h(t) and of the motion that causes it (requirements R6.06, R6.07):
//   h(t) = sum over paths of { T_ph * [sqrt(f_r) sin(phi + theta(t))] + T_am * [sqrt(f_r) cos(phi + theta(t))] } +
//   noise, theta(t) = W (4 pi/lambda) u(t - delay) + drift (t - middle),  u = x_1 - ratio x_2.
// For given W, delay, drift and ratio this is linear in sqrt(f_r) (cos phi, sin phi): variable projection. A grid
// search finds these four, and least squares refines them together (docs/theory/fit.md).
#pragma once

#include <Eigen/Core>

#include <complex>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "base/units/quantity.hpp"
#include "spectra/series.hpp"

namespace straytrace::analysis {

// A stretch of h(t) and of the simultaneous motion, on the lines of one Fourier transform inside a band
// (requirements R6.06, R6.07).

// Strain per Im s or Re s of a stray field, convention exp(-2 pi i f t) (docs/theory/interferometer.md).
using StrainResponse = std::function<std::complex<double>(double hz)>;

// theta(t) = W (4 pi/lambda) u(t - delay) + drift (t - middle), u = x_1 - ratio x_2.
struct FringeShape {
  double multiplicity = 1;  // W, in units of 2k: bounces, or a factor on the motion
  double delay = 0;         // s
  double drift = 0;         // rad/s
};

struct FringeRecords {
  TimeSeries target;                  // h, or another signal with fringes
  std::vector<TimeSeries> witnesses;  // x_1 and, where two bodies move, x_2; m
  std::vector<double> unseen = {};    // m rms right below the high pass of an integrated one; NaN: unknown
};

// Settings common to all stretches of one fit.
struct FringeFrame {
  double low = 0, high = 0;   // Hz, the band
  double wavelength = 0;      // m
  double middle = 0;          // GPS s, where a drift is zero
  double highest_fringe = 0;  // Hz, largest |d theta/dt|/2pi of any shape evaluated
  double longest_delay = 0;   // s, either sign
  std::vector<double> means;  // m, of the witnesses, which are subtracted
};

// Complex lines of a transform, one for each frequency in the band.
using FringeLines = Eigen::VectorXcd;

// Both columns of a path: h = Re and Im of the field times (cos phi, sin phi) sqrt(f_r):
//   T_ph * sin(phi + theta) + T_am * cos(phi + theta) = cos phi [T_ph sin + T_am cos] + sin phi [T_ph cos - T_am sin].
struct FringeColumns {
  FringeLines cosine, sine;
};

class FringeStretch {
 public:
  // `from`, `to`: samples of the target; a few may be left out at the end, for lengths that transform well.
  FringeStretch(FringeRecords const&, std::size_t from, std::size_t to, FringeFrame const&);

  std::vector<double> const& hz() const { return hz_; }
  FringeLines const& target() const { return target_; }
  double duration() const { return duration_; }  // s
  std::size_t model_samples() const { return samples_; }

  // Responses at hz(), once for each path.
  struct Response {
    Eigen::VectorXcd phase, amplitude;
  };
  Response response(StrainResponse const& phase, StrainResponse const& amplitude) const;
  // delay = 0 in the transform, turned on the lines instead, is faster and good while the delay is short against the
  // taper (1/20 of the stretch): see delayed().
  FringeColumns columns(Response const&, FringeShape const&, double ratio) const;
  FringeColumns delayed(FringeColumns const&, double seconds) const;

  // One-sided PSD on hz() from lines, mean over the 65 lines around each.
  std::vector<double> psd(FringeLines const&) const;
  // Lines as real numbers of unit variance, independent, in noise of this PSD (on hz()): their sum of squares is chi^2.
  Eigen::VectorXd whitened(FringeLines const&, std::vector<double> const& psd) const;
  // The same in the time domain: whitened, band-passed samples of the untapered middle.
  Eigen::VectorXd whitened_samples(FringeLines const&, std::vector<double> const& psd) const;
  double degrees() const;  // of chi^2 of pure noise

  double span(double ratio) const;  // m, largest less smallest u

 private:
  std::vector<double> motion(double ratio, double delay) const;

  FringeRecords const& records_;
  FringeFrame const& frame_;
  double start_ = 0, duration_ = 0, rate_ = 0;  // GPS s, s, Hz of the model
  std::size_t samples_ = 0, first_line_ = 0;
  double weight_ = 0, independent_ = 0;  // mean square of the taper; share of its lines that are independent
  std::vector<double> hz_, taper_;
  std::vector<std::vector<double>> witness_;  // without delay, at the model's samples
  FringeLines target_;
};

// Largest |du/dt| of u = x_1 - ratio x_2 between samples, m/s.
double fastest_motion(FringeRecords const&, double ratio);

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

// The records of a fit in SI units, and the motion that a fit finds in them. InputErrors name the options of
// `straytrace fit`.

TimeSeries as_strain(TimeSeries);  // a plain number
// Adds displacement [m] or angle [rad]: velocities and accelerations are integrated behind a high pass at `corner`, Hz.
// `option`: that names the record.
void add_witness(FringeRecords&, TimeSeries, std::optional<double> corner, std::string const& option);

// The witness is an angle: theta = W (4 pi/lambda) angle, so that multiplicities and factors are in m (per rad).
bool is_rotation(FringeRecords const&);
Dimension multiplicity_dimension(FringeRecords const&);
std::string multiplicity_unit(FringeRecords const&);  // "", or "m" for a rotation
// 0.5 to 6, as far as the sample rate holds the fringes (eq. 7.13); the result states the upper end.
SearchRange usual_multiplicity(FringeRecords const&, FringeFitSettings const&);

// Largest excursion of W (x_1 - ratio x_2) of a path from the middle of its range, m: a peak amplitude. Its error is
// that of W and ratio together.
Fitted effective_peak(FringeRecords const&, FringeFit const&, std::size_t path);
// rad rms of the phase of a path right below the corner, which the integrated witnesses do not show and the light
// feels: amplitudes come out low by exp(-phase^2/2). NaN where the record is too short to tell.
double unseen_phase(FringeRecords const&, FringeFit const&, double wavelength, std::size_t path);

}  // namespace straytrace::analysis
