// SPDX-License-Identifier: BSD-3-Clause
// How surely one averaged spectrum lies above another (requirements.md R6.01). A PSD averaged over n independent
// segments of Gaussian noise is chi-square with 2 n degrees of freedom; the ratio of two of them follows Fisher's F.
#pragma once

namespace straytrace {

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

// Factor on an averaged PSD that the truth stays below with this probability: 2 n / quantile of chi-square.
double upper_factor(double averages, double confidence);

}  // namespace straytrace
