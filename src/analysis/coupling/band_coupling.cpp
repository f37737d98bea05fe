// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/band_coupling.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::analysis {
namespace {

// Sums of PSDs over lines, and the variance of their difference: each level varies by S/sqrt(n).
struct Sums {
  double loud = 0, quiet = 0, loud_squares = 0, quiet_squares = 0;
  void add(double injection, double still) {
    loud += injection;
    quiet += still;
    loud_squares += injection * injection;
    quiet_squares += still * still;
  }
  double gained() const { return loud - quiet; }
  double variance(double shared, double n_loud, double n_quiet) const {
    return shared * (loud_squares / n_loud + quiet_squares / n_quiet);
  }
};

// Sum over m of the squared correlation of lines m apart: N sum w^4/(sum w^2)^2, 35/18 for a Hann window.
double lines_shared(WelchSettings const& s) {
  double two = 0, four = 0;
  for (double const w : window_weights(s.window, s.window_parameter, s.segment)) {
    two += w * w;
    four += w * w * w * w;
  }
  return double(s.segment) * four / (two * two);
}

}  // namespace

BandCoupling band_coupling(CrossSpectra const& injection, CrossSpectra const& quiet, double low, double high,
                           WelchSettings const& settings) {
  constexpr double clear = 3, low_density = 0.1;  // standard errors; of the mean density over the band
  std::vector<std::size_t> lines;
  for (std::size_t k = 1; k < injection.hz.size(); ++k)
    if (injection.hz[k] >= low && injection.hz[k] <= high) lines.push_back(k);
  BandCoupling out;
  if (lines.empty()) return out;
  double const shared = lines_shared(settings), n = injection.effective_averages, m = quiet.effective_averages;
  Sums x, y, first, last;
  std::size_t const end = lines.size() / 10;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::size_t const k = lines[i];
    x.add(injection.input[k], quiet.input[k]);
    y.add(injection.output[k], quiet.output[k]);
    if (i < end) first.add(injection.output[k], quiet.output[k]);
    if (i + end >= lines.size()) last.add(injection.output[k], quiet.output[k]);
  }
  out.witness_ratio = std::sqrt(x.loud / x.quiet);
  out.target_ratio = std::sqrt(y.loud / y.quiet);
  double const vx = x.variance(shared, n, m), vy = y.variance(shared, n, m);
  if (!(x.gained() > clear * std::sqrt(vx) && y.gained() > clear * std::sqrt(vy))) return out;
  double const square = y.gained() / x.gained();
  out.factor = std::sqrt(square);
  out.sigma = out.factor / 2 * std::sqrt(vx / (x.gained() * x.gained()) + vy / (y.gained() * y.gained()));
  out.share = square * x.quiet / y.quiet;
  auto const rises = [&](Sums const& s) {
    return s.gained() > clear * std::sqrt(s.variance(shared, n, m)) &&
           s.gained() / double(end) > low_density * y.gained() / double(lines.size());
  };
  out.rises_at_low = end > 0 && rises(first);
  out.rises_at_high = end > 0 && rises(last);
  return out;
}

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

}  // namespace straytrace::analysis
