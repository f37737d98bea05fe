// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/welch.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/filters.hpp"
#include "spectra/segments.hpp"

namespace straytrace {
namespace {

std::vector<double> mean_periodogram(std::span<double const> samples, Segments& segments) {
  std::vector<double> sum(segments.lines(), 0);
  for (std::size_t s = 0; s < segments.count(); ++s) {
    Complexes const& lines = segments.transform(samples, s);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += std::norm(lines[k]);
  }
  for (double& v : sum) v /= double(segments.count());
  return sum;
}

std::vector<double> median_periodogram(std::span<double const> samples, Segments& segments) {
  std::size_t const n = segments.count();
  std::vector<std::vector<double>> all(segments.lines(), std::vector<double>(n));
  for (std::size_t s = 0; s < n; ++s) {
    Complexes const& lines = segments.transform(samples, s);
    for (std::size_t k = 0; k < all.size(); ++k) all[k][s] = std::norm(lines[k]);
  }
  std::vector<double> median;
  for (std::vector<double>& values : all) {
    std::sort(values.begin(), values.end());
    median.push_back((values[n / 2] + values[(n - 1) / 2]) / 2 / median_bias(n));
  }
  return median;
}

// Variance of the mean over that of the median, both relative, of n independent periodograms. The order statistics of
// exponential variables are sums of independent ones with means 1/n, 1/(n-1), ... (Renyi).
double median_efficiency(std::size_t n) {
  std::size_t const low = (n + 1) / 2;  // the lower of the two in the middle
  double mean = 0, variance = 0;
  for (std::size_t i = 0; i < low; ++i) {
    double const step = 1 / double(n - i);
    mean += step;
    variance += step * step;
  }
  if (n % 2 == 0) {
    double const half = 0.5 / double(n - low);
    mean += half;
    variance += half * half;
  }
  return mean * mean / (double(n) * variance);
}

}  // namespace

double median_bias(std::size_t n) {  // scipy.signal.welch has the same; exact for even n too
  double bias = 1;
  for (std::size_t i = 2; i <= n - 1; i += 2) bias += 1 / double(i + 1) - 1 / double(i);
  return bias;
}

WelchSpectrum welch(std::span<double const> samples, double rate, WelchSettings const& s) {
  Segments segments(samples.size(), rate, s);
  bool const median = s.average == Average::median;
  WelchSpectrum out;
  out.even = s.segment % 2 == 0;
  out.segments = segments.count();
  out.noise_bandwidth = segments.noise_bandwidth();
  out.effective_averages = segments.effective() * (median ? median_efficiency(segments.count()) : 1);
  out.psd = median ? median_periodogram(samples, segments) : mean_periodogram(samples, segments);
  for (std::size_t k = 0; k < out.psd.size(); ++k) {
    out.hz.push_back(segments.hz(k));
    out.psd[k] *= segments.density(k);
    out.sigma.push_back(out.psd[k] * std::sqrt((segments.is_real_line(k) ? 2 : 1) / out.effective_averages));
  }
  return out;
}

Interval confidence(WelchSpectrum const& s, double probability) {
  if (!(probability > 0 && probability < 1))
    throw InputError(fmt::format("a confidence of {:g} is not between 0 and 1", probability), "write for example 0.95");
  Interval out;
  double low[2], high[2];
  for (int real = 0; real < 2; ++real) {
    double const freedom = (real != 0 ? 1 : 2) * s.effective_averages;
    boost::math::chi_squared const law(freedom);
    low[real] = freedom / quantile(law, (1 + probability) / 2);
    high[real] = freedom / quantile(law, (1 - probability) / 2);
  }
  for (std::size_t k = 0; k < s.psd.size(); ++k) {
    int const real = s.is_real_line(k) ? 1 : 0;
    out.low.push_back(s.psd[k] * low[real]);
    out.high.push_back(s.psd[k] * high[real]);
  }
  return out;
}

BandPower band_power(WelchSpectrum const& s, WelchSettings const& settings, double low, double high) {
  double const step = s.hz[1] - s.hz[0];
  if (!(low < high && high > 0 && low <= s.hz.back()))
    throw InputError(
        fmt::format("a band of {:g} Hz to {:g} Hz, where the spectrum has 0 to {:g} Hz", low, high, s.hz.back()),
        "choose it inside");
  BandPower out;
  double variance = 0;
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const from = std::max(0.0, s.hz[k] - step / 2),
                 to = s.is_real_line(k) && k > 0 ? s.hz[k] : s.hz[k] + step / 2;
    double const share = std::max(0.0, std::min(to, high) - std::max(from, low)) / (to - from);
    out.power += share * step * s.psd[k];
    variance += std::pow(share * step * s.sigma[k], 2);
  }
  double fourth = 0, second = 0;
  for (double const w : window_weights(settings.window, settings.window_parameter, settings.segment)) {
    second += w * w;
    fourth += w * w * w * w;
  }
  // Sum of the squared correlations between lines: the transform of w^2, by Parseval.
  double const shared = double(settings.segment) * fourth / (second * second);
  out.sigma = std::sqrt(variance * shared);
  return out;
}

double rms(std::span<double const> samples) {
  double sum = 0;
  for (double const x : samples) sum += x * x / double(samples.size());
  return std::sqrt(sum);
}

RmsTrend rms_trend(TimeSeries const& s, double low, double high, double stride) {
  auto const step = std::size_t(std::max(0.0, std::round(stride * s.rate)));
  if (step < 2 || step > s.samples.size())
    throw InputError(
        fmt::format("strides of {:g} s for '{}' of {:g} s at {:g} Hz", stride, s.name, s.duration(), s.rate),
        "choose them between two samples and the record");
  TimeSeries const band = band_passed(s, low, high);
  RmsTrend out;
  for (std::size_t i = 0; i + step <= band.samples.size(); i += step) {
    out.time.push_back(s.time(i) + double(step) / s.rate / 2);
    out.rms.push_back(rms(std::span(band.samples).subspan(i, step)));
    out.sigma.push_back(out.rms.back() / (2 * std::sqrt((high - low) * double(step) / s.rate)));
  }
  return out;
}

}  // namespace straytrace
