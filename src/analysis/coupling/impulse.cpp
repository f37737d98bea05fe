// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/impulse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::analysis {
namespace {

constexpr std::size_t noise_bins = 8;  // on each side over which noise is averaged: few stretches determine it poorly
constexpr double fewest_sigmas = 3;    // of Q; otherwise it is a noise fluctuation, not a mode
constexpr std::size_t most_bins = 40;  // on each side of a peak that are fitted

double median(std::vector<double> v) {
  auto const middle = v.begin() + std::ptrdiff_t(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

// Samples of a stretch less their mean before the impulse.
std::vector<double> stretch(TimeSeries const& s, std::size_t begin, std::size_t n, std::size_t silent) {
  std::vector<double> part(s.samples.begin() + std::ptrdiff_t(begin), s.samples.begin() + std::ptrdiff_t(begin + n));
  double mean = 0;
  for (std::size_t i = 0; i < silent; ++i) mean += part[i] / double(silent);
  for (double& v : part) v -= mean;
  return part;
}

struct ImpulseSums {
  std::vector<double> force, target;
  Complexes cross;
  std::size_t count = 0;
  std::vector<Complexes> answer;  // Y of each stretch
  std::vector<Complexes> single;  // F of each stretch
  std::vector<double> since;      // s since the start before it; infinity for the first
};

ImpulseSums sums_of(TimeSeries const& force, TimeSeries const& target, std::span<double const> starts, std::size_t n,
                    std::size_t silent) {
  ImpulseSums s{std::vector<double>(n / 2 + 1), std::vector<double>(n / 2 + 1), Complexes(n / 2 + 1), 0, {}, {}, {}};
  Fourier fourier;
  double before = -infinity;
  for (double const start : starts) {
    double const since = start - std::exchange(before, start);
    double const first = std::round((start - force.start) * force.rate) - double(silent);
    if (first < 0 || first + double(n) > double(force.samples.size())) continue;
    Complexes const x = fourier.forward(stretch(force, std::size_t(first), n, std::max<std::size_t>(silent, 1)));
    Complexes const y = fourier.forward(stretch(target, std::size_t(first), n, std::max<std::size_t>(silent, 1)));
    s.since.push_back(since);
    s.single.push_back(x);
    s.answer.push_back(y);
    for (std::size_t k = 0; k < x.size(); ++k) {
      s.force[k] += std::norm(x[k]);
      s.target[k] += std::norm(y[k]);
      s.cross[k] += std::conj(x[k]) * y[k];
    }
    ++s.count;
  }
  if (starts.empty())
    throw InputError("there is no impulse above the threshold in this stretch of time",
                     "choose another stretch with --gps, or a lower --threshold");
  if (s.count < 2)
    throw InputError(fmt::format("only {} of {} impulses have their whole stretch inside the data; two are needed",
                                 s.count, starts.size()),
                     "choose a lower --threshold or a shorter --length");
  return s;
}

// Ringing left by earlier impulses has the shape of the mode: it biases the amplitude, but neither frequency nor Q.
// With s = -1/tau + 2 pi i f and F_i the force of stretch i, R_i = exp(s T_i) (F_(i-1) + R_(i-1)) rings at its start
// beside F_i; the amplitude is that of sum conj(F_i) (F_i + R_i) instead of sum |F_i|^2.
// Returns F_i + R_i.
Complexes take_off_left_over(RingDown& mode, ImpulseSums const& s, std::size_t k) {
  Complexes with{s.single[0][k]};
  std::complex<double> left = 0, sum = 0;
  double error = 0;
  for (std::size_t i = 1; i < s.count; ++i) {
    double const since = s.since[i];
    left = std::polar(std::exp(-since / mode.tau), 2 * pi * mode.hz * since) * (s.single[i - 1][k] + left);
    std::complex<double> const part = std::conj(s.single[i][k]) * left;
    sum += part;
    with.push_back(s.single[i][k] + left);
    error +=
        std::abs(part) * std::hypot(2 * pi * mode.hz_sigma, mode.quality_sigma / (mode.quality * mode.tau)) * since;
  }
  double const factor = 1 / std::abs(1.0 + sum / s.force[k]);
  mode.amplitude *= factor;
  mode.amplitude_sigma = std::hypot(factor * mode.amplitude_sigma, mode.amplitude * error / s.force[k]);
  return with;
}

// Relative error of the amplitude from the spread of the impulses, which the fit of their mean does not contain.
double scatter_of_impulses(ImpulseSums const& s, Complexes const& force, std::size_t k) {
  std::complex<double> mean = 0;
  double weight = 0, scatter = 0;
  for (std::size_t i = 0; i < s.count; ++i) mean += std::conj(force[i]) * s.answer[i][k], weight += std::norm(force[i]);
  mean /= weight;
  for (std::size_t i = 0; i < s.count; ++i)
    scatter += std::pow(std::real(std::conj(force[i]) * s.answer[i][k] / mean) - std::norm(force[i]), 2);
  double const n = double(s.count);
  return std::sqrt(scatter * n / (n - 1)) / weight;
}

void to_time(ImpulseResponse& r, std::size_t n, double rate) {
  Complexes damped(r.response.size());
  double noise = 0;
  for (std::size_t k = 0; k < damped.size(); ++k) {
    damped[k] = r.coherence[k] * r.response[k];
    if (std::isfinite(r.sigma[k])) noise += 4 * std::pow(r.coherence[k] * r.sigma[k], 2);
  }
  r.value = Fourier().inverse(damped, n);
  for (double& v : r.value) v *= rate;
  r.value_sigma = std::sqrt(noise / 2) * rate / double(n);
  for (std::size_t i = 0; i < n; ++i) r.time.push_back(double(i) / rate);
}

// Ranges of bins around the strongest peaks of the damped response.
std::vector<std::pair<std::size_t, std::size_t>> peaks_of(ImpulseResponse const& r, ImpulseSettings const& s) {
  std::vector<std::pair<double, std::size_t>> tops;
  auto const level = [&](std::size_t k) { return r.coherence[k] * std::abs(r.response[k]); };
  for (std::size_t k = 3; k + 3 < r.hz.size(); ++k) {
    if (r.hz[k] < s.low || (s.high > 0 && r.hz[k] > s.high) || level(k) < 5 * r.sigma[k]) continue;
    bool top = true;
    for (std::size_t m = 1; m <= 3; ++m) top = top && level(k) > level(k - m) && level(k) >= level(k + m);
    if (top) tops.emplace_back(level(k), k);
  }
  std::sort(tops.rbegin(), tops.rend());
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  for (auto const& [height, k] : tops) {
    if (ranges.size() == std::size_t(s.modes)) break;
    std::size_t low = k, high = k;
    while (low > 1 && level(low) > height / 2 && level(low - 1) < 1.2 * level(low)) --low;
    while (high + 2 < r.hz.size() && level(high) > height / 2 && level(high + 1) < 1.2 * level(high)) ++high;
    std::size_t const wide = std::clamp<std::size_t>(2 * (high - low), 4, most_bins);
    auto const range = std::pair(k > wide + 1 ? k - wide : 1, std::min(k + wide, r.hz.size() - 2));
    if (std::none_of(ranges.begin(), ranges.end(),
                     [&, at = k](auto const& o) { return at >= o.first && at <= o.second; }))
      ranges.push_back(range);
  }
  return ranges;
}

}  // namespace

std::vector<double> find_taps(TimeSeries const& force, double threshold, double length) {
  double const middle = median(force.samples);
  std::vector<double> away;
  for (double const v : force.samples) away.push_back(std::fabs(v - middle));
  double const limit = threshold * 1.4826 * median(away);
  std::vector<double> taps;
  for (std::size_t i = 0; i < force.samples.size(); ++i)
    if (std::fabs(force.samples[i] - middle) > limit && (taps.empty() || force.time(i) >= taps.back() + length))
      taps.push_back(force.time(i));
  return taps;
}

std::vector<double> ImpulseResponse::ringing() const {
  std::vector<double> sum(time.size());
  for (RingDown const& m : modes)
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] += m.amplitude * std::exp(-time[i] / m.tau) * std::cos(2 * pi * m.hz * time[i] + m.phase);
  return sum;
}

ImpulseResponse impulse_response(TimeSeries const& force, TimeSeries const& target, std::span<double const> starts,
                                 ImpulseSettings const& s) {
  if (force.rate != target.rate || force.samples.size() != target.samples.size())
    throw InputError("force and target are not sampled at the same times",
                     "give both at one rate, over the same stretch");
  auto const n = std::size_t(std::lround(s.length * force.rate)),
             silent = std::size_t(std::lround(s.before * force.rate));
  if (n < 32 || n > force.samples.size() || silent * 2 > n)
    throw InputError(fmt::format("a stretch of {:g} s is outside the range for these data", s.length),
                     fmt::format("choose --length between {:g} and {:g} s", 32 / force.rate, force.duration()));
  std::vector<double> in_order(starts.begin(), starts.end());
  std::sort(in_order.begin(), in_order.end());
  ImpulseSums const sums = sums_of(force, target, in_order, n, silent);
  ImpulseResponse r;
  std::vector<double> left;  // |Y - H F|^2 of one stretch
  r.stretches = sums.count;
  for (std::size_t k = 0; k <= n / 2; ++k) {
    r.hz.push_back(double(k) * force.rate / double(n));
    r.response.push_back(sums.force[k] > 0 ? sums.cross[k] / sums.force[k] : 0);
    double const raw =
        sums.force[k] * sums.target[k] > 0 ? std::norm(sums.cross[k]) / (sums.force[k] * sums.target[k]) : 0;
    r.coherence.push_back(unbiased_coherence(std::min(raw, 1.0), double(sums.count)));
    left.push_back(std::max(0.0, sums.target[k] * (1 - raw)) / double(sums.count - 1));
  }
  for (std::size_t k = 0; k <= n / 2; ++k) {
    std::size_t const from = k > noise_bins ? k - noise_bins : 0, to = std::min(k + noise_bins, n / 2);
    double mean = 0;
    for (std::size_t i = from; i <= to; ++i) mean += left[i] / double(to - from + 1);
    r.sigma.push_back(sums.force[k] > 0 ? std::sqrt(mean / sums.force[k] / 2) : infinity);
  }
  to_time(r, n, force.rate);
  double const length = double(n - silent) / force.rate;
  for (auto const& [from, to] : peaks_of(r, s)) {
    RingDown mode = fit_ring_down(r, from, to, s.cut ? length : infinity);
    bool const rings = mode.tau > 0 && mode.quality > fewest_sigmas * mode.quality_sigma;
    if (!(rings && mode.hz > r.hz[from] && mode.hz < r.hz[to])) continue;
    auto const k = std::size_t(std::lround(mode.hz / r.hz[1]));
    Complexes drive;
    for (Complexes const& f : sums.single) drive.push_back(f[k]);
    if (s.cut) drive = take_off_left_over(mode, sums, k);
    mode.amplitude_sigma = std::max(mode.amplitude_sigma, mode.amplitude * scatter_of_impulses(sums, drive, k));
    r.modes.push_back(mode);
  }
  return r;
}

namespace {

using Complex = std::complex<double>;

// Of c exp(-gamma t + 2 pi i f t) + its conjugate, and a constant. Given frequency and damping rate, the real and
// imaginary parts of c and of the constant follow by linear least squares.
class Mode {
 public:
  Mode(ImpulseResponse const& r, std::size_t from, std::size_t to, double length)
      : length_(length), answer_(2 * Eigen::Index(to - from + 1)) {
    double floor = 0;
    for (std::size_t k = from; k <= to; ++k) floor = std::max(floor, 1e-9 * std::abs(r.response[k]));
    for (std::size_t k = from; k <= to; ++k) {
      hz_.push_back(r.hz[k]);
      weight_.push_back(1 / std::max(r.sigma[k], floor));
      put(answer_, k - from, r.response[k]);
    }
  }

  struct Fit {
    Eigen::Vector4d linear;
    double chi;
  };
  Fit fit(double hz, double gamma) const {
    Eigen::MatrixXd const a = columns(hz, gamma);
    Eigen::Vector4d const x = solve_symmetric(a.transpose() * a, a.transpose() * answer_);
    return {x, (answer_ - a * x).squaredNorm()};
  }

  // Residual after the best amplitude and constant.
  Eigen::VectorXd residuals(double hz, double gamma) const {
    return answer_ - columns(hz, gamma) * fit(hz, gamma).linear;
  }

  // Of Re c, Im c, the constant, frequency and ln gamma.
  Eigen::MatrixXd covariance(double hz, double gamma, Eigen::Vector4d const& x) const {
    double const df = 1e-3 * gamma, dg = 1e-3;
    Eigen::MatrixXd slopes(answer_.size(), 6);
    slopes << columns(hz, gamma), (columns(hz + df, gamma) - columns(hz - df, gamma)) * x / (2 * df),
        (columns(hz, gamma * std::exp(dg)) - columns(hz, gamma * std::exp(-dg))) * x / (2 * dg);
    Eigen::VectorXd const scale = slopes.colwise().norm().cwiseInverse();
    Eigen::MatrixXd const unit = slopes * scale.asDiagonal();
    return scale.asDiagonal() * inverse(Eigen::MatrixXd(unit.transpose() * unit)) * scale.asDiagonal();
  }

  int degrees() const { return int(answer_.size()) - 6; }

 private:
  // Transform of exp(-gamma t + 2 pi i f t) from 0 to the end of the stretch, `away` from f.
  Complex ring(double away, double gamma) const {
    Complex const s(gamma, 2 * pi * away);
    return (1.0 - (std::isfinite(length_) ? std::exp(-s * length_) : Complex(0))) / s;
  }

  Eigen::MatrixXd columns(double hz, double gamma) const {
    Eigen::MatrixXd a(answer_.size(), 4);
    for (std::size_t k = 0; k < hz_.size(); ++k) {
      Complex const above = ring(hz_[k] - hz, gamma), below = ring(hz_[k] + hz, gamma);
      put(a.col(0), k, above + below);
      put(a.col(1), k, Complex(0, 1) * (above - below));
      put(a.col(2), k, 1);
      put(a.col(3), k, Complex(0, 1));
    }
    return a;
  }

  template <class Column>
  void put(Column&& column, std::size_t k, Complex value) const {
    column[2 * Eigen::Index(k)] = weight_[k] * value.real();
    column[2 * Eigen::Index(k) + 1] = weight_[k] * value.imag();
  }

  double length_;
  std::vector<double> hz_, weight_;  // 1/sigma
  Eigen::VectorXd answer_;           // real and imaginary parts over sigma
};

}  // namespace

RingDown fit_ring_down(ImpulseResponse const& r, std::size_t from, std::size_t to, double length) {
  Mode const mode(r, from, to, length);
  double const bin = r.hz[1];
  // Coarse: frequencies around the highest bin and all damping rates that the bins can show, then least squares in
  // both.
  std::size_t top = from;
  for (std::size_t k = from; k <= to; ++k)
    if (std::abs(r.response[k]) > std::abs(r.response[top])) top = k;
  double hz = 0, rate = 0, best = infinity;
  for (std::size_t k = 4 * top - 4; k <= 4 * top + 4; ++k)
    for (double g = 0.1 * bin; g < 4 * pi * bin * double(to - from); g *= 1.6)
      if (double const c = mode.fit(double(k) * bin / 4, g).chi; c < best) best = c, hz = double(k) * bin / 4, rate = g;
  // In bins from the coarse place, and ln of the rate.
  LeastSquaresProblem const problem{
      2, 2 * Eigen::Index(to - from + 1),
      [&](Eigen::VectorXd const& p, Eigen::VectorXd& out) { out = mode.residuals(hz + p[0] * bin, std::exp(p[1])); }};
  Eigen::VectorXd const offset = minimise(problem, Eigen::Vector2d(0, std::log(rate))).at;
  Eigen::Vector2d const at(hz + offset[0] * bin, offset[1]);
  Mode::Fit const best_fit = mode.fit(at[0], std::exp(at[1]));
  RingDown out;
  out.chi_square = best_fit.chi;
  out.degrees = mode.degrees();
  // The scatter of the bins around the fitted mode is their error. Ringing of an earlier impulse or another mode can
  // make it larger than the noise.
  Eigen::MatrixXd const covariance =
      mode.covariance(at[0], std::exp(at[1]), best_fit.linear) * out.chi_square / out.degrees;
  out.hz = at[0];
  out.hz_sigma = std::sqrt(covariance(4, 4));
  out.tau = std::exp(-at[1]);
  out.quality = pi * out.hz * out.tau;
  out.quality_sigma = out.quality * std::sqrt(covariance(5, 5));
  // a cos(..) holds half of a at positive frequencies.
  Eigen::Vector2d const c = best_fit.linear.head<2>(), along = c.normalized();
  out.amplitude = 2 * c.norm();
  out.phase = std::atan2(c[1], c[0]);
  out.amplitude_sigma = 2 * std::sqrt(along.dot(covariance.topLeftCorner<2, 2>() * along));
  return out;
}

namespace {

std::size_t stretch_samples(EventSettings const& s) {
  double const step = double(s.welch.segment) * (1 - s.welch.overlap);
  return s.welch.segment + std::size_t(std::lround(double(s.averages - 1) * step));
}

// One stretch against the quiet spectrum.
LoudStretch compared(WelchSpectrum const& loud, WelchSpectrum const& quiet, EventSettings const& s, double least) {
  LoudStretch e;
  for (std::size_t k = 1; k + 1 < loud.hz.size(); ++k) {
    if (loud.hz[k] < s.low || loud.hz[k] > s.high || !(quiet.psd[k] > 0)) continue;
    double const sure =
        excess_significance({loud.psd[k], loud.effective_averages}, {quiet.psd[k], quiet.effective_averages});
    if (sure < least) continue;
    ++e.bins;
    if (sure <= e.significance) continue;
    e.significance = sure;
    e.hz = loud.hz[k];
    e.ratio = std::sqrt(loud.psd[k] / quiet.psd[k]);
  }
  return e;
}

}  // namespace

std::vector<LoudStretch> find_events(TimeSeries const& record, TimeSeries const& quiet, EventSettings const& s) {
  std::size_t const n = stretch_samples(s), stretches = record.samples.size() / n;
  if (stretches == 0)
    throw InputError(fmt::format("'{}' is shorter than {} averages, which take {:g} s", record.name, s.averages,
                                 double(n) / record.rate),
                     "choose fewer --averages or a shorter --segment");
  WelchSpectrum const still = welch(quiet.samples, quiet.rate, s.welch);
  auto const in_band = [&](double f) { return f >= s.low && f <= s.high; };
  double const looks = double(stretches) * double(std::max<std::ptrdiff_t>(
                                               1, std::count_if(still.hz.begin() + 1, still.hz.end(), in_band)));
  double const least = sigmas_of_probability(probability_of_sigmas(s.overall_significance) / looks);
  std::vector<LoudStretch> events;
  bool going_on = false;
  for (std::size_t i = 0; i < stretches; ++i) {
    std::span<double const> const part = std::span(record.samples).subspan(i * n, n);
    LoudStretch e = compared(welch(part, record.rate, s.welch), still, s, least);
    e.from = record.time(i * n);
    e.to = record.time((i + 1) * n);
    e.overall = sigmas_of_probability(std::min(1.0, probability_of_sigmas(e.significance) * looks));
    bool const passes = e.bins > 0;
    if (passes && going_on) {
      LoudStretch const before = events.back();
      if (before.significance >= e.significance) events.back().to = e.to;
      if (before.significance < e.significance) events.back() = e;
      events.back().from = before.from;
      events.back().bins = std::max(before.bins, e.bins);
    } else if (passes) {
      events.push_back(e);
    }
    going_on = passes;
  }
  return events;
}

}  // namespace straytrace::analysis
