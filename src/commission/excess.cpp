// SPDX-License-Identifier: BSD-3-Clause
#include "commission/excess.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace straytrace {
namespace {

using boost::math::complement;
constexpr double as_good_as_known = 1e7;  // averages; above, F is chi-square to the precision of its quantiles

// Probability of a ratio beyond `ratio`, above or below.
double tail(double ratio, double loud, double quiet, bool above) {
  double const n = 2 * std::min(loud, as_good_as_known);
  if (quiet >= as_good_as_known) {
    boost::math::chi_squared const chi(n);
    return above ? cdf(complement(chi, n * ratio)) : cdf(chi, n * ratio);
  }
  boost::math::fisher_f const f(n, 2 * quiet);
  return above ? cdf(complement(f, ratio)) : cdf(f, ratio);
}

}  // namespace

double sigmas_of_probability(double p) {
  if (!(p > probability_of_sigmas(largest_significance))) return largest_significance;
  if (p >= 1) return -largest_significance;
  return quantile(complement(boost::math::normal(), p));
}

double probability_of_sigmas(double s) { return std::erfc(s / std::sqrt(2)) / 2; }

double excess_significance(AveragedPsd const& loud, AveragedPsd const& quiet) {
  if (!(loud.psd > 0 && quiet.psd > 0 && loud.averages > 0 && quiet.averages > 0)) return not_a_number;
  double const ratio = loud.psd / quiet.psd, above = tail(ratio, loud.averages, quiet.averages, true);
  if (above < 0.5) return sigmas_of_probability(above);
  return -sigmas_of_probability(tail(ratio, loud.averages, quiet.averages, false));
}

double upper_factor(double averages, double confidence) {
  double const n = 2 * averages;
  return n / quantile(boost::math::chi_squared(n), 1 - confidence);
}

}  // namespace straytrace
