// SPDX-License-Identifier: BSD-3-Clause
// Coupling of a whole band, from the total excess power in it (docs/theory/commissioning.md, eq. C.13).
#pragma once

#include "base/math/constants.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {

// H^2 = (sum of y_inj - y_quiet)/(sum of x_inj - x_quiet) over the lines of low to high, Hz; PSDs of target y and
// witness x. Slow motion of the same surface spreads what fast small motion makes over neighbouring lines without
// changing its power, so H is the coupling of small motion where that of single lines is not.
struct BandCoupling {
  double factor = not_a_number,
         sigma = not_a_number;                 // target unit per witness unit; one standard error of the averages
  double witness_ratio = 0, target_ratio = 0;  // injection over quiet, of amplitudes in the whole band
  double share = not_a_number;  // of the power of the quiet target that the quiet witness explains, 1 for all
  bool rises_at_low = false, rises_at_high = false;  // the target rises at this end too: the band is too narrow
};

// `settings`: of both spectra; how much neighbouring lines share follows from the window. NaN factor where witness or
// target rise by less than three standard errors.
BandCoupling band_coupling(CrossSpectra const& injection, CrossSpectra const& quiet, double low, double high,
                           WelchSettings const& settings);

// Significance with which one averaged spectrum lies above another (R6.01). A PSD averaged over n independent
// segments of Gaussian noise is chi-square with 2 n degrees of freedom; the ratio of two of them follows Fisher's F.

struct AveragedPsd {
  double psd = 0;       // x^2/Hz
  double averages = 0;  // independent ones; infinity: known exactly
};

constexpr double largest_significance = 37;  // standard deviations; beyond, a double cannot hold the probability

// Standard deviations of a normal distribution with the same one-sided probability that noise of equal level shows
// such a ratio. Negative below the quiet level; at most `largest_significance`; NaN when a level is not positive.
double excess_significance(AveragedPsd const& loud, AveragedPsd const& quiet);
double sigmas_of_probability(double one_sided);     // 1.35e-3 -> 3
double probability_of_sigmas(double significance);  // 3 -> 1.35e-3

// Factor on an averaged PSD that bounds the true PSD with this probability: 2 n / quantile of chi-square.
double upper_factor(double averages, double confidence);

}  // namespace straytrace::analysis
