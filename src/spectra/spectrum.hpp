// SPDX-License-Identifier: BSD-3-Clause
// One-sided power spectral densities as functions of frequency with EXACT integrals over bins, so that rms values
// survive any choice of grid (docs/theory/conventions.md).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::spectra {

// One-sided PSD [x^2/Hz]: tables interpolated in log-log (a power law between knots, integrated in closed form; a
// straight line where one of two neighbours is zero), zero outside their range. A sum keeps its terms, so it is exact.
class Spectrum {
 public:
  Spectrum() = default;                                       // zero everywhere
  Spectrum(std::vector<double> hz, std::vector<double> psd);  // strictly increasing hz > 0; psd >= 0

  double at(double hz) const;                         // x^2/Hz
  double power(double low_hz, double high_hz) const;  // integral over the band, x^2
  double total() const;                               // variance, x^2
  double lowest() const;                              // Hz; first and last knot; 0 when zero everywhere
  double highest() const;
  // Integral of (2 pi f)^2 S over [0, high_hz]: variance of the rate, (x/s)^2.
  double rate_power(double high_hz) const;
  Spectrum scaled(double factor) const;  // PSD times factor
  // PSD times a smooth function of frequency, resolved by the existing knots and by `extra` ones [Hz].
  Spectrum multiplied(std::function<double(double)> const& factor, std::span<double const> extra) const;
  std::vector<double> hz() const;   // all knots, increasing
  std::vector<double> psd() const;  // at these knots
  friend Spectrum operator+(Spectrum const&, Spectrum const&);

 private:
  struct Table {
    std::vector<double> hz, psd, slope;  // slope: exponent of each interval, NaN for a straight line
  };
  static double at(Table const&, double hz);
  static double moment(Table const&, double low_hz, double high_hz, int order);  // integral of f^order S

  std::vector<Table> tables_;
};

// Equal up to a factor: normalised PSDs agree within 1e-6 at all knots of both. Only for spectra of non-zero power.
bool same_shape(Spectrum const&, Spectrum const&);

// Band of frequencies, Hz.
struct Band {
  double low = 10, high = 100;
  double clamped(double hz) const { return hz < low ? low : hz > high ? high : hz; }
};

// Spectra by formula: power laws, ground models, lines, resonances.

// ASD = asd (f / at_hz)^exponent between from_hz and to_hz.
Spectrum power_law_asd(double asd, double at_hz, double exponent, double from_hz, double to_hz);

// PSD proportional to exp(-(f - centre)^2 / (2 width^2)) at f > 0, with variance rms^2 (case A5 of docs/theory).
Spectrum gaussian_line(double centre_hz, double width_hz, double rms);

// Ground displacement [m^2/Hz] of Peterson's noise models, docs/theory/environment.md, eq. 11.1; beyond 10 Hz, where
// they end, the ASD continues as 1/f^2. `typical`: geometric mean of the ASDs of the two.
enum class GroundModel { low, high, typical };
Spectrum peterson(GroundModel, double from_hz, double to_hz);
double peterson_asd(GroundModel, double hz);  // m/sqrt(Hz)

// PSD times a function of frequency. Adds knots until straight lines in log-log deviate by less than 1e-5 half way
// between them, or by 1e-12 of `scale`, a larger reference, if given. `features`: frequencies [Hz] of peaks and bends
// between the knots of the spectrum.
Spectrum filtered(Spectrum const&, std::function<double(double)> const& factor, std::span<double const> features,
                  std::function<double(double)> const& scale = {});

// |T|^2 of a mode of a tube, baffle or mount on its carrier, docs/theory/environment.md, eq. 11.2.
double transmissibility(double hz, double resonance_hz, double quality);
Spectrum through_resonance(Spectrum const&, double resonance_hz, double quality);

}  // namespace straytrace::spectra
