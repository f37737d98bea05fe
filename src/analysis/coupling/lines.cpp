// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/lines.hpp"

#include <boost/math/tools/minima.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "base/units/quantity.hpp"
#include "spectra/curve.hpp"
#include "spectra/files/gps.hpp"
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
    out.flag = CouplingFlag::upper_limit;
    out.factor = std::sqrt(off_centre_of_chi_squared(2 * n, std::max(sum, 2 * n), 0.05) / weights);
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

void refuse_overlaps(std::vector<FoundStretch> const& all) {
  constexpr double surely_gps = 1e8;  // s; other files count from 0
  std::vector<InputError> errors;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      FoundStretch const &a = all[j], &b = all[i];
      double const from = std::max(a.from, b.from), to = std::min(a.to, b.to);
      if (to <= from || (a.file != b.file && from < surely_gps)) continue;
      errors.emplace_back(
          fmt::format("{} and {} share the time from {} to {}", a.name, b.name, gps_text(from), gps_text(to)),
          "name stretches that do not overlap");
    }
  throw_all(errors);
}

ToMetres to_metres(bool displacement, std::string const& unit) {
  if (!displacement) return {0, 1, unit};
  auto const known = parse_unit(unit);
  return {integrations_to_displacement(unit), known ? known->si : 1, "m"};
}

namespace {

double factor_at(ToMetres const& m, double hz) { return m.scale / std::pow(2 * pi * hz, m.times); }

CrossSpectra in_metres(ToMetres const& m, CrossSpectra s) {
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const f = s.hz[k] > 0 ? factor_at(m, s.hz[k]) : not_a_number;
    s.input[k] *= f * f;
    s.cross[k] *= f;  // its phase is not used
  }
  return s;
}

CrossSpectra pooled(std::vector<CrossSpectra> const& all) {
  CrossSpectra sum = all.front();
  for (std::size_t i = 1; i < all.size(); ++i) {
    for (std::size_t k = 0; k < sum.hz.size(); ++k) {
      double const a = sum.effective_averages, b = all[i].effective_averages;
      sum.input[k] = (a * sum.input[k] + b * all[i].input[k]) / (a + b);
      sum.output[k] = (a * sum.output[k] + b * all[i].output[k]) / (a + b);
      sum.cross[k] = (a * sum.cross[k] + b * all[i].cross[k]) / (a + b);
    }
    sum.effective_averages += all[i].effective_averages;
    sum.segments += all[i].segments;
  }
  return sum;
}

}  // namespace

void in_metres(ToMetres const& m, std::vector<LinePoint>& points) {
  for (LinePoint& p : points) {
    p.amplitude *= factor_at(m, p.hz);
    p.sigma *= factor_at(m, p.hz);
  }
}

void in_metres(ToMetres const& m, std::vector<RidgePoint>& ridge) {
  for (RidgePoint& p : ridge) {
    double const f = factor_at(m, p.coupling.hz);
    p.witness *= f;
    p.modulus /= f;
    p.sigma /= f;
    p.coupling.factor /= f;
    p.coupling.sigma /= f;
  }
}

std::size_t InjectionCoupling::line_at(double hz) const { return std::size_t(std::lround(hz / quiet.hz[1])); }

double InjectionCoupling::share(CouplingPoint const& p) const {
  std::size_t const k = line_at(p.hz);
  return p.factor * std::sqrt(quiet.input[k] / quiet.output[k]);
}

InjectionCoupling couple_injections(StretchSpectra const& quiet, std::span<StretchSpectra const> injections,
                                    bool displacement, CouplingThresholds const& thresholds, double low, double high) {
  ToMetres const metres = to_metres(displacement, quiet.witness_unit);
  InjectionCoupling out;
  out.quiet = in_metres(metres, quiet.cross);
  std::vector<CouplingFunction> each;
  std::vector<CrossSpectra> loud;
  for (StretchSpectra const& s : injections) {
    loud.push_back(in_metres(metres, s.cross));
    CouplingFunction c{s.witness, s.target, metres.unit, coupling_unit(s.target_unit, metres.unit), {}};
    for (CouplingPoint const& p : measure_coupling(loud.back(), out.quiet, thresholds))
      if (p.hz >= low && p.hz <= high) c.points.push_back(p);
    each.push_back(std::move(c));
  }
  out.coupling = combine(each);
  CrossSpectra const all = pooled(loud);
  out.linear = h1(all);
  auto const is_wrapped = [](CouplingPoint const& p) { return p.flag == CouplingFlag::not_linear; };
  if (std::any_of(out.coupling.points.begin(), out.coupling.points.end(), is_wrapped))
    out.whole = band_coupling(all, out.quiet, low, high, quiet.welch);
  return out;
}

std::vector<std::size_t> peaks_of(std::span<double const> heights) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (heights[i] > 0 && (i == 0 || heights[i] >= heights[i - 1]) &&
        (i + 1 == heights.size() || heights[i] > heights[i + 1]))
      all.push_back(i);
  return all;
}

namespace {

// The number of bins where none holds it.
std::size_t bin_of(std::vector<double> const& edges, double hz) {
  auto const edge = std::upper_bound(edges.begin(), edges.end(), hz);
  return edge == edges.begin() || edge == edges.end() ? edges.size() - 1 : std::size_t(edge - edges.begin()) - 1;
}

double scale_to(CouplingFunction const& c, std::string const& unit) {
  auto const have = parse_unit(c.unit), want = parse_unit(unit);
  if (!have || !want || !(have->dimension == want->dimension))
    throw InputError(fmt::format("--measured: the coupling is in {}, the prediction in {}", c.unit, unit),
                     "measure strain against displacement: couple noise --displacement");
  return have->si / want->si;
}

OverlayPoint compared(CouplingPoint const& m, PredictedCurve const& predicted, std::size_t bin) {
  double const factor = predicted.factor[bin], sigma = predicted.sigma[bin];
  OverlayPoint p{m, factor, sigma, m.factor / factor, 0, 0, bin};
  bool const measured = m.flag == CouplingFlag::measured;
  if (!measured || std::isfinite(m.sigma)) p.error = std::hypot(measured ? m.sigma / m.factor : 0, sigma / factor);
  double const log = std::log(p.ratio);
  p.significance = p.error > 0 ? log / p.error : not_a_number;
  if (!measured) p.significance = log < 0 && p.error > 0 ? -log / p.error : 0;
  return p;
}

bool counts(OverlayPoint const& p) { return p.measured.flag == CouplingFlag::measured && p.error > 0; }

}  // namespace

Overlay overlay_of(CouplingFunction const& c, PredictedCurve const& p) {
  double const scale = scale_to(c, p.unit);
  Overlay out;
  out.unit = p.unit;
  double weight = 0;
  for (CouplingPoint m : c.points) {
    std::size_t const i = bin_of(p.edges, m.hz);
    if (i == p.factor.size() || !m.has_factor() || !(p.factor[i] > 0)) continue;
    m.factor *= scale;
    m.sigma *= scale;
    OverlayPoint const point = compared(m, p, i);
    out.points.push_back(point);
    bool const bounded = i < p.at_most.size() && p.at_most[i];
    out.above_limit += m.flag == CouplingFlag::upper_limit && !bounded && point.significance > 3;
    if (!counts(point)) continue;
    weight += 1 / (point.error * point.error);
    out.mean_ratio += std::log(point.ratio) / (point.error * point.error);
    ++out.measured;
  }
  if (out.points.empty())
    throw InputError("--measured: no measured factor or limit is inside the band of the prediction", "choose --band");
  if (out.measured > 0) out.mean_ratio /= weight;
  for (OverlayPoint const& q : out.points)
    if (counts(q)) out.chi_square += std::pow((std::log(q.ratio) - out.mean_ratio) / q.error, 2);
  double const spread = out.measured > 1 ? std::max(1.0, out.chi_square / double(out.measured - 1)) : 1;
  out.mean_sigma = out.measured > 0 ? std::sqrt(spread / weight) : not_a_number;
  return out;
}

std::vector<OverlayPoint const*> points_by_bin(Overlay const& o, std::size_t bins) {
  auto const rank = [](OverlayPoint const* p) {
    if (p == nullptr) return -1.0;
    if (p->measured.flag != CouplingFlag::measured) return 0.0;
    return 1 + (std::isfinite(p->measured.sigma) ? p->measured.factor / p->measured.sigma : 0);
  };
  std::vector<OverlayPoint const*> out(bins);
  for (OverlayPoint const& p : o.points)
    if (rank(&p) > rank(out[p.bin])) out[p.bin] = &p;
  return out;
}

}  // namespace straytrace::analysis
