// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/lines.hpp"

#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/tools/minima.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "analysis/coupling/band_coupling.hpp"
#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {
namespace {

constexpr int nearest_noise = 3, farthest_noise = 10;  // resolutions beside a line; a Hann line is 2 wide

std::size_t window_samples(TimeSeries const& s, double window) {
  auto const n = std::size_t(std::lround(window * s.rate));
  if (!(window > 0) || n < 16 || n > s.samples.size())
    throw InputError(fmt::format("a window of {:g} s is outside the range for '{}', which has {:g} s at {:g} Hz",
                                 window, s.name, s.duration(), s.rate),
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
    throw InputError(fmt::format("cannot track a line between {:g} and {:g} Hz in '{}', which is sampled at {:g} Hz",
                                 b.low, b.high, s.name, s.rate),
                     fmt::format("choose a band between 0 and {:g} Hz", s.rate / 2));
  std::size_t const n = window_samples(s, b.window);
  if (b.window * b.low < fewest_periods)
    throw InputError(fmt::format("a window of {:g} s holds {:.1f} periods of a line at {:g} Hz, and {:g} are needed to "
                                 "separate noise from harmonics",
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

namespace {

constexpr double foot = 1e-3;       // of the highest power: where the ridge ends
constexpr std::size_t beside = 10;  // bins on each side that show the noise
// Noise of neighbouring lines under a Hann window is correlated: transform of w^2 over its sum.
constexpr double hann_correlation[] = {1, -2.0 / 3, 1.0 / 6};

struct Ridge {
  std::size_t low, high;  // lines, both within
};

// Within the band, `high` excluded: a drive outside it is not part of the ridge.
Ridge ridge_of(Complexes const& x, std::size_t low, std::size_t high) {
  auto const louder = [](auto const& a, auto const& b) { return std::norm(a) < std::norm(b); };
  auto const top = std::size_t(
      std::max_element(x.begin() + std::ptrdiff_t(low), x.begin() + std::ptrdiff_t(high), louder) - x.begin());
  Ridge r{top, top};
  double const least = foot * std::norm(x[top]);
  while (r.low > low && std::norm(x[r.low - 1]) > least) --r.low;
  while (r.high + 1 < high && std::norm(x[r.high + 1]) > least) ++r.high;
  return r;
}

struct Level {
  double mean = 0;   // |line|^2
  double lines = 0;  // independent ones
};

// Beside the ridge.
Level level_beside(Complexes const& lines, Ridge const& r) {
  constexpr double shared = 1 + 2 * (4.0 / 9 + 1.0 / 36);  // of neighbouring lines
  double sum = 0;
  int count = 0;
  for (std::size_t k = 2; k < beside + 2; ++k) {
    if (r.low > k) sum += std::norm(lines[r.low - k]), ++count;
    if (r.high + k + 1 < lines.size()) sum += std::norm(lines[r.high + k]), ++count;
  }
  return count > 0 ? Level{sum / count, count / shared} : Level{not_a_number, 0};
}

// Mean of the ratios and of the coherence.
void add_means(CouplingPoint& out, std::vector<RidgePoint> const& windows) {
  double const n = double(windows.size());
  out.witness_ratio = out.target_ratio = out.coherence = 0;
  for (RidgePoint const& w : windows) {
    out.witness_ratio += w.coupling.witness_ratio / n;
    out.target_ratio += w.coupling.target_ratio / n;
    out.coherence += w.coupling.coherence / n;
  }
}

// All windows of a bin together (C.12): sum of |H|^2/sigma^2 is chi-square of two degrees for each, off centre by
// H^2/sigma^2. The noise is the mean over the windows. Phases may differ, as behind a delay.
CouplingPoint judged(std::vector<RidgePoint> const& windows, double significance) {
  double const n = double(windows.size());
  CouplingPoint out;
  add_means(out, windows);
  double level = 0, lines = 0, sum = 0, weights = 0, scatter = 0;
  for (RidgePoint const& w : windows) level += w.level / n, lines += w.lines;
  auto const variance = [&](RidgePoint const& w) { return squared(w.sigma) * level / w.level; };
  for (RidgePoint const& w : windows) sum += squared(w.modulus) / variance(w), weights += 1 / variance(w);
  out.significance = excess_significance({sum / (2 * n), n}, {1, lines});
  if (!(out.significance >= significance)) {
    boost::math::non_central_chi_squared const any(2 * n, 0);
    out.flag = CouplingFlag::upper_limit;
    out.factor = std::sqrt(decltype(any)::find_non_centrality(2 * n, std::max(sum, 2 * n), 0.05) / weights);
    return out;
  }
  out.flag = CouplingFlag::measured;
  out.factor = std::sqrt((sum - 2 * n) / weights);
  for (RidgePoint const& w : windows) scatter += squared(w.modulus - out.factor) / variance(w);
  double const disagree = n > 1 ? std::max(1.0, scatter / (n - 1)) : 1;
  out.sigma = std::sqrt(disagree * (1 + n / (sum - 2 * n)) / weights);
  return out;
}

RidgePoint coupling_at(Complexes const& x, Complexes const& y, Ridge const& r, RidgeSettings const& s) {
  std::complex<double> cross = 0;
  double power = 0, answer = 0, noise = 0;
  for (std::size_t k = r.low; k <= r.high; ++k) {
    cross += std::conj(x[k]) * y[k];
    power += std::norm(x[k]);
    answer += std::norm(y[k]);
    for (std::size_t m = 0; m < 3 && k + m <= r.high; ++m)
      noise += (m == 0 ? 1 : 2) * hann_correlation[m] * std::real(std::conj(x[k]) * x[k + m]);
  }
  Level const beside_y = level_beside(y, r);
  double const level = beside_y.mean, top = power / double(r.high - r.low + 1);
  RidgePoint out;
  CouplingPoint& p = out.coupling;
  p.witness_ratio = std::sqrt(top / level_beside(x, r).mean);
  p.target_ratio = std::sqrt(answer / double(r.high - r.low + 1) / level);
  p.coherence = std::norm(cross) / (power * answer);
  p.flag = CouplingFlag::below_thresholds;
  if (!(p.witness_ratio >= s.witness_ratio)) return out;
  out.modulus = std::abs(cross) / power;
  out.sigma = std::sqrt(level * noise / 2) / power;
  out.level = level;
  out.lines = beside_y.lines;
  p = judged({out}, s.significance);
  return out;
}

}  // namespace

std::vector<RidgePoint> ridge_coupling(TimeSeries const& witness, TimeSeries const& target, RidgeSettings const& s) {
  if (witness.rate != target.rate || witness.samples.size() != target.samples.size())
    throw InputError("witness and target are not sampled at the same times",
                     "give both at one rate, over the same stretch");
  if (!(s.low > 0 && s.low < s.high && s.high <= witness.rate / 2))
    throw InputError(fmt::format("a sweep between {:g} and {:g} Hz is not visible at a sample rate of {:g} Hz", s.low,
                                 s.high, witness.rate),
                     fmt::format("choose --band between 0 and {:g} Hz", witness.rate / 2));
  WelchSettings const settings{.segment = std::size_t(std::lround(s.window * witness.rate))};
  Segments of_x(witness.samples.size(), witness.rate, settings), of_y(target.samples.size(), target.rate, settings);
  auto const low = std::size_t(std::max(1.0, std::floor(s.low * s.window)));
  auto const high = std::min(std::size_t(std::ceil(s.high * s.window)) + 1, of_x.lines() - 1);
  std::vector<RidgePoint> out;
  for (std::size_t i = 0; i < of_x.count(); ++i) {
    Complexes const x = of_x.transform(witness.samples, i), y = of_y.transform(target.samples, i);
    Ridge const r = ridge_of(x, low, high);
    RidgePoint p = coupling_at(x, y, r, s);
    p.time = witness.time(of_x.begin(i)) + s.window / 2;
    double power = 0, mean = 0;
    for (std::size_t k = r.low; k <= r.high; ++k) {
      power += std::norm(x[k]);
      mean += std::norm(x[k]) * of_x.hz(k);
    }
    p.coupling.hz = mean / power;
    p.witness = std::sqrt(power * of_x.density(r.low) * of_x.hz(1));
    out.push_back(p);
  }
  return out;
}

CouplingFunction coupling_of_ridge(std::vector<RidgePoint> const& ridge, TimeSeries const& witness,
                                   TimeSeries const& target, double resolution, double significance) {
  CouplingFunction out{witness.name, target.name, witness.unit, coupling_unit(target.unit, witness.unit), {}};
  std::map<long, std::vector<RidgePoint>> bins;
  for (RidgePoint const& p : ridge) bins[std::lround(p.coupling.hz / resolution)].push_back(p);
  for (auto& [bin, windows] : bins) {
    CouplingPoint point = windows.front().coupling;
    std::erase_if(windows, [](RidgePoint const& p) { return p.coupling.flag == CouplingFlag::below_thresholds; });
    if (!windows.empty()) point = judged(windows, significance);
    point.hz = double(bin) * resolution;
    out.points.push_back(point);
  }
  return out;
}

}  // namespace straytrace::analysis
