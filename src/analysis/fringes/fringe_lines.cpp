// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/fringe_lines.hpp"

#include <boost/math/tools/minima.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/math/distributions.hpp"

namespace straytrace::analysis {
namespace {

constexpr int steps_per_radian = 16;
constexpr double smallest_z = 1e-3;
constexpr std::size_t neighbours = 8;  // windows on each side that share their noise

// Noise of half-overlapping Hann windows is correlated by 1/6: of means of amplitudes and of noise powers.
constexpr double shared_amplitude = 1 + 2.0 / 6, shared_power = 1 + 2.0 / 36;

Harmonic harmonic_of(std::vector<LinePoint> const& windows, int order) {
  Harmonic h;
  h.order = order;
  double noise = 0;
  for (LinePoint const& p : windows) {
    h.power += (std::norm(p.amplitude) - 2 * squared(p.sigma)) / double(windows.size());
    noise += squared(p.sigma) / double(windows.size());
  }
  double const n = double(windows.size());
  // A line of power P in noise: variance 4 P s^2 + 4 s^4 of one window.
  h.sigma = std::sqrt((4 * std::max(0.0, h.power) * noise * shared_amplitude + 4 * squared(noise) * shared_power) / n);
  h.seen = h.power > 3 * 2 * noise * std::sqrt(shared_power / n);
  h.limit = std::sqrt(std::max(0.0, h.power) + 1.645 * h.sigma);
  return h;
}

// Coefficient of shape_n for the harmonics of one parity, by least squares; and the residual.
struct Part {
  double factor = 0, chi = 0;
};
Part fit_part(std::vector<Harmonic> const& all, int parity, double z) {
  double top = 0, bottom = 0, norm = 0;
  for (Harmonic const& h : all)
    if (h.order % 2 == parity) norm = std::max(norm, squared(bessel_j(h.order, z)));
  if (norm == 0) norm = 1;
  for (Harmonic const& h : all) {
    if (h.order % 2 != parity) continue;
    double const shape = squared(bessel_j(h.order, z)) / norm, w = 1 / squared(h.sigma);
    top += w * shape * h.power;
    bottom += w * shape * shape;
  }
  Part p{bottom > 0 ? std::max(0.0, top / bottom) : 0, 0};
  for (Harmonic const& h : all)
    if (h.order % 2 == parity) p.chi += squared((h.power - p.factor * squared(bessel_j(h.order, z)) / norm) / h.sigma);
  p.factor /= norm;
  return p;
}

// Lines of the target against the amplitudes of the drive.
class Steps {
 public:
  struct Fit {
    double factor, chi, sigma;  // target per drive at small drive; its error
  };

  Steps(std::span<LinePoint const> drive, std::span<LinePoint const> target) {
    for (std::size_t i = 0; i < drive.size(); ++i) {
      double const noise = level_around(target, i);
      drive_.push_back(std::abs(drive[i].amplitude));
      target_.push_back(target[i].amplitude * std::polar(1.0, -std::arg(drive[i].amplitude)));
      sigma_.push_back(std::max(std::sqrt(noise * shared_amplitude), 1e-12 * std::abs(target_.back())));
      largest_ = std::max(largest_, drive_.back());
    }
  }

  Fit fit(double z) const {  // 2 J_1(x)/x -> 1
    std::complex<double> top = 0;
    double bottom = 0, chi = 0;
    std::vector<double> shape;
    for (std::size_t i = 0; i < drive_.size(); ++i) {
      double const x = z * drive_[i] / largest_;
      shape.push_back(x > 1e-9 ? drive_[i] * 2 * bessel_j(1, x) / x : drive_[i]);
      top += shape[i] * target_[i] / squared(sigma_[i]);
      bottom += squared(shape[i] / sigma_[i]);
    }
    for (std::size_t i = 0; i < drive_.size(); ++i)
      chi += std::norm(target_[i] - top / bottom * shape[i]) / squared(sigma_[i]);
    return {std::abs(top) / bottom, chi, 1 / std::sqrt(bottom)};
  }

 private:
  // One window determines its noise from few frequencies. Noisy weights make a mean worse than its stated error, so the
  // noise is averaged over neighbouring windows.
  static double level_around(std::span<LinePoint const> target, std::size_t i) {
    std::size_t const from = i > neighbours ? i - neighbours : 0, to = std::min(i + neighbours + 1, target.size());
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += squared(target[k].sigma) / double(to - from);
    return sum;
  }

  // Complex, phase counted from the drive: moduli of noise would add up to a line.
  std::vector<std::complex<double>> target_;
  std::vector<double> drive_, sigma_;
  double largest_ = 0;
};

}  // namespace

HarmonicFit fit_harmonics(std::span<std::vector<LinePoint> const> windows, double z_max) {
  HarmonicFit f;
  for (std::size_t i = 0; i < windows.size(); ++i) f.harmonics.push_back(harmonic_of(windows[i], int(i) + 1));
  if (f.harmonics.size() < 3)
    throw InputError("harmonics up to the third are needed to identify a fringe", "choose --harmonics 3 or more");
  auto const chi = [&](double z) { return fit_part(f.harmonics, 1, z).chi + fit_part(f.harmonics, 0, z).chi; };
  ScanResult const r = scan_minimum(chi, smallest_z, z_max, int(z_max * steps_per_radian));
  f.z = r.best;
  f.z_low = r.low;
  f.z_high = r.high;
  f.z_limit = r.limit;
  f.open = r.open;
  f.others = r.others;
  f.chi_square = r.chi_square;
  f.degrees = int(f.harmonics.size()) - 3;
  f.significance = std::sqrt(std::max(0.0, chi(smallest_z) - r.chi_square));
  f.limit_only = f.significance < 3;
  f.odd = std::sqrt(fit_part(f.harmonics, 1, r.best).factor) / 2;
  f.even = f.limit_only ? not_a_number : std::sqrt(fit_part(f.harmonics, 0, r.best).factor) / 2;
  return f;
}

double motion_of_phase(double z, double wavelength, double multiplicity) {
  return z * wavelength / (4 * pi * multiplicity);
}

RampFit fit_ramp(std::span<LinePoint const> drive, std::span<LinePoint const> target, double threshold, double z_max) {
  if (drive.size() != target.size() || drive.size() < 4)
    throw InputError(fmt::format("a ramp of {} windows is too short", drive.size()),
                     "at least 4 are needed: choose a shorter --window");
  Steps const steps(drive, target);
  ScanResult const r =
      scan_minimum([&](double z) { return steps.fit(z).chi; }, 0, z_max, int(z_max * steps_per_radian));
  Steps::Fit const line = steps.fit(0), fringe = steps.fit(r.best);
  RampFit out;
  out.degrees_linear = 2 * int(drive.size()) - 2;
  out.degrees_fringe = out.degrees_linear - 1;
  out.slope = line.factor;
  out.slope_sigma = line.sigma;
  out.chi_linear = line.chi;
  out.chi_fringe = fringe.chi;
  out.small_slope = fringe.factor;
  out.significance = std::sqrt(std::max(0.0, line.chi - fringe.chi));
  out.z = r.best;
  out.z_low = r.low;
  out.z_high = r.high;
  out.z_limit = r.limit;
  out.open = r.open;
  auto const misses = [&](double chi, int degrees) { return chi_squared_tail(degrees, chi) < 1e-3; };
  bool const wraps = out.significance > threshold;
  out.verdict = wraps                             ? RampFit::Verdict::fringe
                : out.slope < 3 * out.slope_sigma ? RampFit::Verdict::unseen
                                                  : RampFit::Verdict::linear;
  if (wraps ? misses(fringe.chi, out.degrees_fringe) : misses(line.chi, out.degrees_linear))
    out.verdict = RampFit::Verdict::neither;
  return out;
}

namespace {

constexpr int bits = 26;  // of the place of a minimum: half of a double

struct Minimum {
  double at, value;
};

// Where the function first reaches `level` going from `start` towards `end` in steps; `end` when it does not.
double crossing(std::function<double(double)> const& f, double level, double start, double end, double step,
                bool* open) {
  double const sign = end > start ? 1 : -1;
  for (double a = start; sign * (end - a) > 0;) {
    double const b = sign > 0 ? std::min(end, a + step) : std::max(end, a - step);
    if (f(b) >= level) {
      double inside = a, outside = b;
      for (int i = 0; i < 50; ++i) (f((inside + outside) / 2) >= level ? outside : inside) = (inside + outside) / 2;
      return (inside + outside) / 2;
    }
    a = b;
  }
  if (open) *open = true;
  return end;
}

}  // namespace

ScanResult scan_minimum(std::function<double(double)> const& f, double from, double to, int steps) {
  double const step = (to - from) / steps;
  std::vector<double> value;
  for (int i = 0; i <= steps; ++i) value.push_back(f(from + step * i));
  std::vector<Minimum> minima;
  for (int i = 0; i <= steps; ++i) {
    bool const left = i == 0 || value[std::size_t(i)] <= value[std::size_t(i) - 1];
    bool const right = i == steps || value[std::size_t(i)] < value[std::size_t(i) + 1];
    if (!left || !right) continue;
    auto const [at, v] = boost::math::tools::brent_find_minima(f, from + step * std::max(0, i - 1),
                                                               from + step * std::min(steps, i + 1), bits);
    minima.push_back(v <= value[std::size_t(i)] ? Minimum{at, v} : Minimum{from + step * i, value[std::size_t(i)]});
  }
  std::stable_sort(minima.begin(), minima.end(), [](Minimum const& a, Minimum const& b) { return a.value < b.value; });
  ScanResult r;
  r.best = minima.front().at;
  r.chi_square = minima.front().value;
  r.low = crossing(f, r.chi_square + 1, r.best, from, step / 4, nullptr);
  r.high = crossing(f, r.chi_square + 1, r.best, to, step / 4, nullptr);
  r.limit = crossing(f, r.chi_square + 2.71, r.best, to, step / 4, &r.open);
  for (std::size_t i = 1; i < minima.size(); ++i)
    if (minima[i].value < r.chi_square + 4) r.others.push_back(minima[i].at);
  return r;
}

HarmonicFit fit_harmonics(TimeSeries const& target, std::span<LinePoint const> drive, double window, int orders,
                          double z_max) {
  double hz = 0;
  for (LinePoint const& p : drive) hz += p.hz / double(drive.size());
  int const most = std::min(orders, int(std::floor(0.49 * target.rate / hz)));
  if (most < 3)
    throw InputError(fmt::format("at {:g} Hz the target has no third harmonic of {:.4g} Hz", target.rate, hz),
                     "give a higher sample rate");
  std::vector<std::vector<LinePoint>> harmonics;
  for (int n = 1; n <= most; ++n) harmonics.push_back(follow_line(target, drive, window, n));
  return fit_harmonics(harmonics, z_max);
}

LineAmplitude amplitude_of(Harmonic const& h) {
  if (!h.seen) return {h.limit, not_a_number, true};
  double const a = std::sqrt(h.power);
  return {a, h.sigma / (2 * a)};
}

LineAmplitude over(LineAmplitude const& a, LineAmplitude const& b) {
  double const ratio = a.value / b.value;
  return {ratio, a.limit ? not_a_number : ratio * std::hypot(a.sigma / a.value, b.sigma / b.value), a.limit};
}

LineAmplitude mean_amplitude(std::span<LinePoint const> points) {
  double const n = double(points.size());
  double mean = 0, square = 0;
  for (LinePoint const& p : points) mean += std::abs(p.amplitude) / n;
  for (LinePoint const& p : points) square += std::pow(std::abs(p.amplitude) - mean, 2) / n;
  return {mean, std::sqrt(square / std::max(1.0, n - 1))};
}

CouplingPoint coupling_at(RampFit const& r, double hz) {
  CouplingPoint p;
  p.hz = hz;
  p.significance = r.slope / r.slope_sigma;
  if (r.verdict == RampFit::Verdict::unseen) {
    p.flag = CouplingFlag::upper_limit;
    p.factor = r.limit();
    return p;
  }
  bool const linear = r.verdict == RampFit::Verdict::linear;
  p.factor = linear ? r.slope : r.small_slope;
  p.sigma = linear ? r.slope_sigma : not_a_number;
  p.flag = linear ? CouplingFlag::measured : CouplingFlag::not_linear;
  return p;
}

}  // namespace straytrace::analysis
