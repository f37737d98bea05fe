// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"

namespace straytrace {
namespace {

void check(std::size_t samples, double rate, WelchSettings const& s) {
  if (s.segment < 2 || s.segment > samples)
    throw InputError(fmt::format("a segment of {} samples does not fit a series of {}", s.segment, samples),
                     fmt::format("choose between 2 and {}", samples));
  if (!(s.overlap >= 0 && s.overlap < 1))
    throw InputError(fmt::format("an overlap of {:g} is not a share", s.overlap), "choose from 0 to below 1");
  if (!(rate > 0 && rate < infinity)) throw InputError(fmt::format("a sample rate of {:g} Hz", rate), "it is positive");
}

// Takes the mean, or the straight line of least squares, from the samples.
void remove_trend(std::vector<double>& x, Detrend detrend) {
  if (detrend == Detrend::none) return;
  double const n = double(x.size()), centre = (n - 1) / 2;
  double mean = 0, slope = 0;
  for (double const v : x) mean += v / n;
  for (std::size_t i = 0; detrend == Detrend::linear && i < x.size(); ++i)
    slope += (double(i) - centre) * (x[i] - mean);
  slope *= 12 / (n * (n * n - 1));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= mean + slope * (double(i) - centre);
}

}  // namespace

Segments::Segments(std::size_t samples, double rate, WelchSettings const& s) : settings_(s), rate_(rate) {
  check(samples, rate, s);
  // Whole samples of overlap, rounded down as int(share * segment) elsewhere.
  step_ = s.segment - std::size_t(std::floor(s.overlap * double(s.segment) + 1e-9));
  count_ = (samples - s.segment) / step_ + 1;
  weights_ = window_weights(s.window, s.window_parameter, s.segment);
  for (double const w : weights_) {
    sum_ += w;
    square_ += w * w;
  }
}

double Segments::density(std::size_t line) const { return (is_real_line(line) ? 1 : 2) / (rate_ * square_); }

double Segments::effective() const {
  double sum = 1;
  for (std::size_t m = 1; m < count_ && m * step_ < weights_.size(); ++m) {
    double shared = 0;
    for (std::size_t i = m * step_; i < weights_.size(); ++i) shared += weights_[i] * weights_[i - m * step_];
    sum += 2 * (1 - double(m) / double(count_)) * std::pow(shared / square_, 2);
  }
  return double(count_) / sum;
}

Complexes const& Segments::transform(std::span<double const> samples, std::size_t segment) {
  auto const from = samples.begin() + std::ptrdiff_t(begin(segment));
  part_.assign(from, from + std::ptrdiff_t(settings_.segment));
  remove_trend(part_, settings_.detrend);
  for (std::size_t i = 0; i < part_.size(); ++i) part_[i] *= weights_[i];
  return fourier_.forward(part_);
}

}  // namespace straytrace
