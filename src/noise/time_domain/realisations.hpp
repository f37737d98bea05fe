// SPDX-License-Identifier: BSD-3-Clause
// Levels of h of realisations in time with their errors, next to the mean by spectra, and the effects that the
// projection neglects.
#pragma once

#include <string>
#include <vector>

#include "noise/noise.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "spectra/welch.hpp"

namespace straytrace::noise {

// Welch spectra of one realisation after the other.
class Realisations {
 public:
  void add(WelchSpectrum const&);
  std::size_t size() const { return psd_.size(); }
  std::vector<double> const& hz() const { return last_.hz; }
  // Means over lines from..to (both included) of each realisation.
  std::vector<double> band(std::size_t from, std::size_t to) const;
  WelchSpectrum const& last() const { return last_; }

 private:
  WelchSpectrum last_;
  std::vector<std::vector<double>> psd_;
};

// Spectrum in one band of h.
struct BandLevel {
  double hz = 0, low = 0, high = 0;  // Hz; the averaged band
  double asd = 0, sigma = 0;         // 1/sqrt(Hz), root of the mean PSD; NaN outside the resolution of the record
  double below = 0, median = 0, above = 0;  // percentiles 5, 50, 95 of the realisations; NaN for fewer than 5
  double exact = 0;                         // mean by spectra, NaN outside the band of the run
};

// Result of a projection in time for the chosen routes.
struct TimeDomainSummary {
  SampleTimes times;
  std::uint64_t seed = 0;
  std::size_t realisations = 0, routes = 0, paths = 0;
  double rms_phase = 0;  // rad, of the route below
  std::string rms_phase_route;
  SamplingRule rule;
  FastestFringe fastest;
  std::string fastest_route;
  double delay = 0, second_order = 0;  // s; rad
  double ray_tilt = 0;                 // rad, magnitude; 0: no specular reflection, or no body on the route rotates
  double delay_error = 0;              // of h at 100 Hz, relative, at most (eq. 2.6)
  bool retarded = false, delay_by_hit = false, recorded = false;
  double band_low = 0, band_high = 0;
  std::vector<BandLevel> levels;            // at 10, 30, 100 Hz, +- 10 %
  std::vector<BandLevel> spectrum;          // line by line
  double segment = 0, noise_bandwidth = 0;  // s, Hz: of the Welch spectra
  std::size_t segments = 0;
};

// Of the routes in the settings. `exact`: projected with spectra of the same motion; `light`: the first realisation.
TimeDomainSummary summarise(CouplingTable const&, MotionSet const&, NoiseBudget const& exact, TimeDomainSettings const&,
                            StrayLight const& light, Realisations const&);

TimeSeries strain_series(StrayLight const&);
// "tube z": every coordinate that moves.
std::vector<TimeSeries> motion_channels(MotionSeries const&, MotionSet const&);

}  // namespace straytrace::noise
