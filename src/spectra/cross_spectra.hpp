// SPDX-License-Identifier: BSD-3-Clause
// Cross spectra, coherence and transfer functions of two records (Bendat and Piersol, Random Data; R6.05).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace {

// One-sided averages over segments of an input x and an output y. Phases are those of instruments, exp(+2 pi i f t):
// an output that comes tau later has cross = x^2 exp(-2 pi i f tau) (scipy.signal.csd(x, y)).
struct CrossSpectra {
  std::vector<double> hz;
  std::vector<double> input, output;        // S_xx, x^2/Hz; S_yy, y^2/Hz
  std::vector<std::complex<double>> cross;  // S_xy = <conj(X) Y>, x y/Hz
  std::size_t segments = 0;
  double effective_averages = 0;  // independent ones
  double noise_bandwidth = 0;     // ENBW, Hz
};

// Mean over the segments; settings.average must be the mean, since a median of complex numbers is no estimate of their
// mean. Throws InputError as welch() does, and when the records differ in length.
CrossSpectra cross_spectra(std::span<double const> x, std::span<double const> y, double sample_rate,
                           WelchSettings const&);
// Of the stretch that both cover, on the rate of the slower one: aligned() first.
CrossSpectra cross_spectra(TimeSeries const& x, TimeSeries const& y, WelchSettings const&);

// |S_xy|^2/(S_xx S_yy), 0 to 1; NaN where one of the two is zero. Of independent records its mean is 1/averages.
std::vector<double> coherence(CrossSpectra const&);
// Coherence that independent Gaussian records exceed with this probability: 1 - p^(1/(n - 1)). 1 for n <= 1.
double coherence_level(double effective_averages, double probability = 0.05);
// Radius, over |H|, of the circle around an estimate of H that holds the truth: r^2 = (p^(-1/(n - 1)) - 1) (1 - c)/c,
// p = 1 - probability (Bendat and Piersol, Random Data, with the quantile of F of 2 and 2 n - 2 degrees of freedom).
// Below 1 just where c is above coherence_level(n, p).
double confidence_radius(double coherence, double effective_averages, double probability = 0.95);
// Interval of the coherence: atanh of its root has variance 1/(2 (n - 1)). 0 to 1 where n <= 1.
Interval coherence_interval(std::span<double const> coherence, double effective_averages, double probability = 0.95);

// y = H x. Errors are one sigma, of the estimate from a finite number of averages: |H| and phase (rad) have the
// relative error sqrt((1 - c)/(2 c n)), c the coherence. Where it is not below 1 the phase is unknown, and sigma says
// so.
struct TransferEstimate {
  std::vector<double> hz;
  std::vector<std::complex<double>> value;  // y/x
  std::vector<double> modulus_sigma;        // y/x
  std::vector<double> phase_sigma;          // rad, at most pi/sqrt(3): that of any phase
  std::vector<double> coherence;
  double effective_averages = 0;
};
TransferEstimate h1(CrossSpectra const&);  // S_xy/S_xx: right when noise is in y only, too small by noise in x
TransferEstimate h2(CrossSpectra const&);  // S_yy/S_yx: right when noise is in x only, too large by noise in y

}  // namespace straytrace
