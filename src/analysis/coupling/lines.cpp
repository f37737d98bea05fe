// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/lines.hpp"

#include <boost/math/tools/minima.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/window.hpp"

namespace straytrace {
namespace {

constexpr int nearest_noise = 3, farthest_noise = 10;  // resolutions beside a line; a Hann line is 2 wide

std::size_t window_samples(TimeSeries const& s, double window) {
  auto const n = std::size_t(std::lround(window * s.rate));
  if (!(window > 0) || n < 16 || n > s.samples.size())
    throw InputError(fmt::format("a window of {:g} s does not fit '{}', which has {:g} s at {:g} Hz", window, s.name,
                                 s.duration(), s.rate),
                     fmt::format("choose --window between {:g} s and {:g} s", 16 / s.rate, s.duration()));
  return n;
}

}  // namespace

LineWindow::LineWindow(std::span<double const> samples, double rate) : rate_(rate) {
  std::vector<double> const w = window_weights(Window::hann, 0, samples.size());
  double mean = 0;
  for (double const v : samples) mean += v / double(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples_.push_back(w[i] * (samples[i] - mean));
    sum_ += w[i];
  }
}

std::complex<double> LineWindow::at(double hz) const {
  double const turn = -2 * pi * hz / rate_, middle = double(samples_.size()) / 2, c = std::cos(turn),
               s = std::sin(turn);
  double re = 0, im = 0;
  for (std::size_t begin = 0; begin < samples_.size(); begin += 1024) {  // rounding of the steps stays below 1e-12
    double const start = std::fmod(turn * (double(begin) - middle), 2 * pi);
    double x = std::cos(start), y = std::sin(start);
    for (std::size_t i = begin; i < std::min(begin + 1024, samples_.size()); ++i) {
      re += samples_[i] * x;
      im += samples_[i] * y;
      double const turned = c * x - s * y;
      y = s * x + c * y;
      x = turned;
    }
  }
  return {2 * re / sum_, 2 * im / sum_};
}

double LineWindow::sigma(double hz, double spacing) const {
  double power = 0;
  int count = 0;
  for (int k = nearest_noise; k <= farthest_noise && (k + nearest_noise) * resolution() <= spacing * 1.001; ++k)
    for (double const f : {hz - k * resolution(), hz + k * resolution()})
      if (f > resolution() && f < rate_ / 2 - resolution()) {
        power += std::norm(at(f)) / 2;  // |a|^2 of noise has twice the variance of a quadrature
        ++count;
      }
  return count > 0 ? std::sqrt(power / count) : not_a_number;
}

double LineWindow::peak(double low, double high) const {
  double best = low, most = -1;
  int const steps = std::max(2, int(std::ceil(2 * (high - low) / resolution())));
  for (int i = 0; i <= steps; ++i) {
    double const f = low + (high - low) * i / steps, a = std::norm(at(f));
    if (a > most) std::tie(best, most) = std::pair(f, a);
  }
  double const step = (high - low) / steps;
  auto const less = [this](double f) { return -std::norm(at(f)); };
  return boost::math::tools::brent_find_minima(less, std::max(low, best - step), std::min(high, best + step), 40).first;
}

// Of the maximum of |a(f)|^2: noise of its derivative over its curvature.
double LineWindow::peak_sigma(double amplitude, double sigma) const {
  std::vector<double> const w = window_weights(Window::hann, 0, samples_.size());
  double square = 0, moved = 0, moment = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    double const t = (double(i) - double(w.size()) / 2) / rate_;
    square += w[i] * w[i];
    moved += w[i] * w[i] * t * t;
    moment += w[i] * t * t;
  }
  return sigma / amplitude * sum_ * std::sqrt(moved / square) / (2 * pi * moment);
}

std::vector<LinePoint> track_line(TimeSeries const& s, LineBand const& b) {
  if (!(b.low > 0 && b.low < b.high && b.high < s.rate / 2))
    throw InputError(fmt::format("a line between {:g} and {:g} Hz cannot be followed in '{}', which has {:g} Hz", b.low,
                                 b.high, s.name, s.rate),
                     fmt::format("choose a band between 0 and {:g} Hz", s.rate / 2));
  std::size_t const n = window_samples(s, b.window);
  if (b.window * b.low < fewest_periods)
    throw InputError(fmt::format("a window of {:g} s holds {:.1f} periods of a line at {:g} Hz, and {:g} are needed to "
                                 "tell noise from harmonics",
                                 b.window, b.window * b.low, b.low, fewest_periods),
                     fmt::format("choose --window {:g} s or more", std::ceil(10 * fewest_periods / b.low) / 10));
  std::vector<LinePoint> track;
  for (std::size_t begin = 0; begin + n <= s.samples.size(); begin += n / 2) {
    LineWindow const w(std::span(s.samples).subspan(begin, n), s.rate);
    LinePoint p;
    p.time = s.time(begin) + double(n) / (2 * s.rate);
    p.hz = w.peak(b.low, b.high);
    p.amplitude = w.at(p.hz);
    p.sigma = w.sigma(p.hz, p.hz);
    p.hz_sigma = w.peak_sigma(std::abs(p.amplitude), p.sigma);
    track.push_back(p);
  }
  return track;
}

std::vector<LinePoint> follow_line(TimeSeries const& s, std::span<LinePoint const> track, double window, int harmonic) {
  std::size_t const n = window_samples(s, window);
  std::vector<LinePoint> out;
  for (LinePoint const& t : track) {
    double const first = std::round((t.time - window / 2 - s.start) * s.rate);
    if (first < 0 || std::size_t(first) + n > s.samples.size())
      throw InputError(fmt::format("'{}' does not cover the stretch of the drive", s.name), "give both the same --gps");
    LineWindow const w(std::span(s.samples).subspan(std::size_t(first), n), s.rate);
    LinePoint p = t;
    p.hz = harmonic * t.hz;
    p.hz_sigma = harmonic * t.hz_sigma;
    p.amplitude = w.at(p.hz);
    p.sigma = w.sigma(p.hz, t.hz);
    out.push_back(p);
  }
  return out;
}

}  // namespace straytrace
