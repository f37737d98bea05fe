// SPDX-License-Identifier: BSD-3-Clause
#include "signal/segment_transforms.hpp"

#include <fmt/format.h>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"

namespace straytrace {
namespace {

std::vector<std::complex<double>> transform(std::vector<double> const& part) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> lines;
  fft.fwd(lines, part);
  return lines;
}

}  // namespace

SegmentTransforms::SegmentTransforms(TimeSeries const& series, WelchSettings const& s)
    : series_(&series), settings_(s) {
  check_welch(series.samples.size(), series.rate, s);
  std::size_t const n = s.segment;
  step_ = welch_step(s);
  segments_ = (series.samples.size() - n) / step_ + 1;
  window_ = window_weights(s.window, n);
  double sum = 0;
  for (double const v : window_) {
    sum += v;
    square_ += v * v;
  }
  noise_bandwidth_ = series.rate * square_ / (sum * sum);
  averages_ = 1 / variance_of_mean(window_, step_, segments_);
  for (std::size_t k = 0; k <= n / 2; ++k) hz_.push_back(double(k) * series.rate / double(n));
}

double SegmentTransforms::time(std::size_t segment) const {
  return series_->time(segment * step_) + double(settings_.segment) / (2 * series_->rate);
}

std::vector<std::complex<double>> SegmentTransforms::operator[](std::size_t segment) const {
  std::size_t const n = settings_.segment, begin = segment * step_;
  std::vector<double> part(n);
  double level = 0;
  for (std::size_t i = 0; settings_.detrend && i < n; ++i) level += series_->samples[begin + i] / double(n);
  for (std::size_t i = 0; i < n; ++i) part[i] = window_[i] * (series_->samples[begin + i] - level);
  std::vector<std::complex<double>> lines = transform(part);
  double const doubled = std::sqrt(2 / (series_->rate * square_));
  for (std::size_t k = 0; k < lines.size(); ++k) lines[k] *= k == 0 || 2 * k == n ? doubled / std::sqrt(2) : doubled;
  return lines;
}

double PairSpectra::raw_coherence(std::size_t k) const {
  double const both = x[k] * y[k];
  return both > 0 ? std::min(1.0, std::norm(xy[k]) / both) : 0;
}

double PairSpectra::coherence(std::size_t k) const {
  double const chance = 1 / std::max(averages, 1.0);
  return chance < 1 ? std::max(0.0, (raw_coherence(k) - chance) / (1 - chance)) : 0;
}

PairSpectra pair_spectra(TimeSeries const& x, TimeSeries const& y, WelchSettings const& s) {
  if (x.rate != y.rate || x.samples.size() != y.samples.size())
    throw InputError(fmt::format("error: '{}' and '{}' do not share their samples ({} at {:g} Hz, {} at {:g} Hz)",
                                 x.name, y.name, x.samples.size(), x.rate, y.samples.size(), y.rate));
  SegmentTransforms const a(x, s), b(y, s);
  std::size_t const bins = a.hz().size();
  PairSpectra out{a.hz(), std::vector<double>(bins), std::vector<double>(bins), std::vector<std::complex<double>>(bins),
                  a.averages()};
  double const share = 1 / double(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::vector<std::complex<double>> const left = a[i], right = b[i];
    for (std::size_t k = 0; k < bins; ++k) {
      out.x[k] += share * std::norm(left[k]);
      out.y[k] += share * std::norm(right[k]);
      out.xy[k] += share * std::conj(left[k]) * right[k];
    }
  }
  return out;
}

}  // namespace straytrace
