// SPDX-License-Identifier: BSD-3-Clause
// Couplings from driven lines and from stretches with an injection, and a measured coupling over a predicted one.
#pragma once

#include <cmath>
#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/coupling/coupling.hpp"
#include "spectra/series.hpp"

namespace straytrace::analysis {

// Lines driven by a shaker or loudspeaker: frequency, amplitude and phase over time, with errors (R6.03).

// A stretch under a Hann window. Line: x = Re[a exp(2 pi i f (t - middle))], |a| its PEAK amplitude.
class LineWindow {
 public:
  LineWindow(std::span<double const> samples, double rate);

  std::complex<double> at(double hz) const;  // a
  // Standard error of each quadrature of `at` from the noise beside the line: sqrt(S ENBW), S the mean one-sided PSD 3
  // to 10 resolutions away on both sides, and not within 3 of the next harmonics, which are `spacing` away.
  double sigma(double hz, double spacing) const;
  // Where |a| is largest within the band [Hz]; `sigma`: standard error for a line of this amplitude in that noise.
  double peak(double low_hz, double high_hz) const;
  double peak_sigma(double amplitude, double sigma) const;
  double resolution() const { return rate_ / double(samples_.size()); }  // Hz

 private:
  std::vector<double> samples_;  // under the window, without their mean
  double rate_, sum_ = 0;
};

struct LinePoint {
  double time = 0;  // GPS s, middle of the window
  double hz = 0, hz_sigma = 0;
  std::complex<double> amplitude;  // peak
  double sigma = 0;                // of each quadrature, and of |amplitude| where it is well above
};

struct LineBand {
  double low = 0, high = 0;  // Hz
  double window = 4;         // s
};
// Noise is seen between harmonics: windows hold at least `fewest_periods` of the line.
constexpr double fewest_periods = 8;
// One point for each half-overlapping window, whether the line is significant or not. Throws InputError for a band
// outside (0, rate/2) or a window longer than the series or too short for the line.
std::vector<LinePoint> track_line(TimeSeries const&, LineBand const&);
// Amplitudes of another channel at harmonic n of the tracked frequencies, on the same samples.
std::vector<LinePoint> follow_line(TimeSeries const&, std::span<LinePoint const> track, double window,
                                   int harmonic = 1);

// Mean of a few values with known errors.
struct WeightedMean {
  double value = 0, sigma = 0;  // standard error, larger by sqrt(chi^2/dof) where the values disagree
};
inline WeightedMean weighted_mean(std::span<double const> y, std::span<double const> sigma) {
  double weight = 0, sum = 0, chi = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    weight += 1 / (sigma[i] * sigma[i]);
    sum += y[i] / (sigma[i] * sigma[i]);
  }
  for (std::size_t i = 0; i < y.size(); ++i) chi += std::pow((y[i] - sum / weight) / sigma[i], 2);
  double const spread = y.size() > 1 ? chi / double(y.size() - 1) : 0;
  return {sum / weight, std::sqrt((spread > 1 ? spread : 1) / weight)};
}

// Coupling along the ridge of a sweep (R6.03).

struct RidgePoint {
  double time = 0;                // GPS s, middle of the window
  double witness = 0;             // rms of the witness along the ridge in this window, its unit
  double modulus = 0, sigma = 0;  // |H| and the error of each quadrature, for any flag
  double level = 0, lines = 0;    // |line|^2 of the target beside the ridge, and of how many independent lines
  CouplingPoint coupling;         // hz: centre of the ridge; coherence: share of the target's power there
};

struct RidgeSettings {
  double low = 0, high = 0;   // Hz, search range of the drive
  double window = 2;          // s
  double witness_ratio = 10;  // amplitude of the ridge over the witness beside it; below: thresholds not met
  double significance = 3;    // of the target; below: an upper limit
};

// Each half-overlapping window: the strongest line of the witness and its width by chirp; there H = <conj(x)
// y>/<|x|^2>. |H| with its error from the target beside the ridge; upper limits at 95 %. Both series on equal samples.
std::vector<RidgePoint> ridge_coupling(TimeSeries const& witness, TimeSeries const& target, RidgeSettings const&);

// One coupling function from all windows: those of a bin of `resolution` Hz are evaluated together (C.12), not
// flag by flag. Upper limits at 95 %.
CouplingFunction coupling_of_ridge(std::vector<RidgePoint> const&, TimeSeries const& witness, TimeSeries const& target,
                                   double resolution, double significance);

// A coupling function from stretches with an injection and one without: their spectra, the witness in metres, all
// injections together (R6.01).

// A stretch as found in a record. Two stretches must not overlap: quiet data would contain the injection, or one
// injection would count twice. Records of different files share their time only where that is GPS.
struct FoundStretch {
  std::string name, file;   // "--quiet 0..24"
  double from = 0, to = 0;  // GPS s
};
void refuse_overlaps(std::vector<FoundStretch> const&);

// Conversion of a witness to metres: divide by (2 pi f)^times.
struct ToMetres {
  int times = 0;
  double scale = 1;  // of its unit to SI
  std::string unit;  // "m", or the original unit
};
ToMetres to_metres(bool displacement, std::string const& unit);
void in_metres(ToMetres const&, std::vector<LinePoint>&);
void in_metres(ToMetres const&, std::vector<RidgePoint>&);

// Cross spectra of witness and target in one stretch.
struct StretchSpectra {
  CrossSpectra cross;
  std::string witness, target, witness_unit, target_unit;
  WelchSettings welch;
};

// One witness over all injections.
struct InjectionCoupling {
  CouplingFunction coupling;
  CrossSpectra quiet;                 // witness in the unit of the coupling
  TransferEstimate linear;            // H1 of all injections
  std::optional<BandCoupling> whole;  // where single lines are not linear

  std::size_t line_at(double hz) const;
  // Contribution of the quiet witness to the quiet target, as a share of amplitudes.
  double share(CouplingPoint const&) const;
};
// On the lines from low to high, Hz. `displacement`: the witness becomes metres.
InjectionCoupling couple_injections(StretchSpectra const& quiet, std::span<StretchSpectra const> injections,
                                    bool displacement, CouplingThresholds const&, double low, double high);

// Positions of values above zero that no neighbour exceeds.
std::vector<std::size_t> peaks_of(std::span<double const> heights);

// A measured coupling over a predicted one.

struct OverlayPoint {
  CouplingPoint measured;  // factor and error in the unit of the prediction
  double predicted = 0, predicted_sigma = 0;
  double ratio = 0;         // measured over predicted; of a limit: limit over predicted
  double error = 0;         // standard error of ln(ratio); 0 where none is known
  double significance = 0;  // of ln(ratio), standard deviations; of a limit: how far the prediction lies above it, or 0
  std::size_t bin = 0;      // of the prediction
};
struct Overlay {
  std::string unit;
  std::vector<OverlayPoint> points;                       // measured and limits within the band of the prediction
  double mean_ratio = 0, mean_sigma = 0, chi_square = 0;  // of ln(ratio), weighted; of the measured points against it
  std::size_t measured = 0,
              above_limit = 0;  // limits that the prediction, no upper bound, exceeds by 3 standard deviations
};

// The coupling predicted in bins: value and one standard error; zero where nothing couples.
struct PredictedCurve {
  std::vector<double> const &edges, &factor, &sigma;  // Hz; of each bin
  std::string unit;
  std::vector<bool> at_most = {};  // of each bin: upper bounds make a part of its factor; empty: of none
};
// Throws InputError for another dimension or a coupling that is fringe wrapped all over the band.
Overlay overlay_of(CouplingFunction const&, PredictedCurve const&);
// The most significant point in each bin of the prediction, a measured one before a limit; null: none.
std::vector<OverlayPoint const*> points_by_bin(Overlay const&, std::size_t bins);

}  // namespace straytrace::analysis
