// SPDX-License-Identifier: BSD-3-Clause
// The motion is made periodic with period 1/spacing: exact power in every line, hence no leakage and no need for
// the motion to decay. Motion slower than half a spacing is a static phase.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <math.h>
#include <numeric>

#include "base/math/constants.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::noise {
namespace {

constexpr std::size_t fewest = std::size_t{1} << 14, usual_most = std::size_t{1} << 20;

// Frequency beyond which the spectrum is below 1e-17: Gaussian tail of the fringe rate (8.9 sigma), products of the
// motion with itself, Bessel tails of the tones.
double reach(SlowPhase const& p) {
  double hz = 9 * p.fringe_rate + 3 * p.highest;
  for (PhaseTone const& t : p.tones) hz += t.frequency * (t.peak + 8 * std::cbrt(t.peak) + 10);
  return hz;
}

// The coarsest spacing up to `limit` on whose lines all tones fall; with several tones the best of a few hundred.
double spacing_for(std::vector<PhaseTone> const& tones, double limit) {
  if (tones.empty()) return limit;
  auto const strongest = std::ranges::max_element(
      tones, [](PhaseTone const& a, PhaseTone const& b) { return a.peak * a.frequency < b.peak * b.frequency; });
  double const first = std::ceil(strongest->frequency / limit);
  double best = strongest->frequency / first, best_miss = infinity;
  for (double n = first; n < 2 * first + 200 && best_miss > 1e-9; ++n) {
    double const spacing = strongest->frequency / n;
    double miss = 0;  // relative error of the worst tone
    for (PhaseTone const& t : tones)
      miss = std::max(miss, std::fabs(std::round(t.frequency / spacing) * spacing / t.frequency - 1));
    if (miss < 0.7 * best_miss) {
      best_miss = miss;
      best = spacing;
    }
  }
  return best;
}

// The least of 2^a {1, 5/4, 3/2} that is not below n: few plans, and fast ones.
std::size_t quick_size(double n) {
  std::size_t const below = std::bit_floor(static_cast<std::size_t>(std::min(n, 1e9)));
  for (std::size_t quarters : {4, 5, 6})
    if (static_cast<double>(below / 4 * quarters) >= n) return below / 4 * quarters;
  return 2 * below;
}

// Factors of a tone over one of its periods: on the lags it repeats exactly.
std::vector<double> factors_of(PhaseTone const& t, LagGrid const& lags) {
  std::vector<double> factors(std::min(lags.period(t.frequency), lags.size()));
  for (std::size_t i = 0; i < factors.size(); ++i)
    factors[i] = ::j0(2 * t.peak * std::sin(pi * lags.turns(t.frequency, i)));
  return factors;
}

constexpr double digits_lost = 1e-6;  // below this fall, over R(0), each line is summed

// R(0) - R(tau) from the lines, without cancellation.
double fall_of(std::vector<double> const& lines, LagGrid const& lags, std::size_t lag) {
  double const turn = pi * static_cast<double>(2 * lag + 1) / static_cast<double>(2 * lags.samples);
  double sum = 0;
  for (std::size_t k = 1; k < lines.size(); ++k)
    if (lines[k] != 0) sum += 2 * lines[k] * std::pow(std::sin(turn * static_cast<double>(k)), 2);
  return sum;
}

// exp(-(R(0) - R(tau))) times one Bessel factor per tone (eq. 7.11), minus its constant part.
std::vector<double> correlation(SlowPhase const& p, Covariance const& r, LagGrid const& lags, double constant) {
  std::vector<double> c = r.at;
  if (p.tones.empty() && r.at_zero < 600) {
    for (double& x : c) x = constant * std::expm1(x);  // no cancellation, however small the motion
    return c;
  }
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = std::exp(i < r.fall.size() ? -r.fall[i] : c[i] - r.at_zero);
  for (PhaseTone const& t : p.tones) {
    std::vector<double> const factors = factors_of(t, lags);
    for (std::size_t first = 0; first < c.size(); first += factors.size())
      for (std::size_t i = 0; i < std::min(factors.size(), c.size() - first); ++i) c[first + i] *= factors[i];
  }
  for (double& x : c) x -= constant;
  return c;
}

// Over a whole period.
double norm1(std::vector<double> const& v) {
  double sum = 0;
  for (double x : v) sum += std::fabs(x);
  return 2 * sum;
}

}  // namespace

// Exact until the last division: hundreds of turns in double leave 1e-13 of one, which a tone of z = 100 shows.
double LagGrid::turns(double hz, std::size_t n) const {
  std::uint64_t const turn = 2 * std::uint64_t{samples}, line = std::uint64_t(std::round(hz / spacing));
  return static_cast<double>(line % turn * (2 * n + 1) % turn) / static_cast<double>(turn);
}

std::size_t LagGrid::period(double hz) const {
  std::uint64_t const turn = 2 * std::uint64_t{samples}, line = std::uint64_t(std::round(hz / spacing)) % turn;
  return std::size_t(turn / std::gcd(2 * line, turn));
}

Covariance covariance(std::vector<double> lines, LagGrid const& lags) {
  lines.resize(std::min(lines.size(), lags.size()));
  Covariance r;
  r.at_zero = std::accumulate(lines.begin(), lines.end(), 0.0);
  CosineTransform::of(lags.size()).values(lines, r.at);
  while (r.fall.size() < r.at.size() && r.at_zero - r.at[r.fall.size()] < digits_lost * r.at_zero)
    r.fall.push_back(fall_of(lines, lags, r.fall.size()));
  return r;
}

bool transform_lags(std::vector<double> const& c, LagGrid const& lags, double rounding, WrappedSpectrum& low) {
  std::size_t const n = lags.size();
  double const floor = 2.2e-16 * rounding / (static_cast<double>(lags.samples) * lags.spacing);
  low.spacing = lags.spacing;
  low.samples = lags.samples;
  CosineTransform::of(n).amplitudes(c, low.density);
  low.density[0] *= 2;
  double strongest = 0;
  for (double& s : low.density) strongest = std::max(strongest, std::fabs(s /= 2 * lags.spacing));
  bool clean = true;
  for (std::size_t k = 0; k < n; ++k) {
    double& s = low.density[k];
    bool const end = k >= 3 * n / 4;  // where the rounding of strong slow lines returns, mirrored
    if (!(std::fabs(s) > floor + (end ? 16 * 2.2e-16 * strongest : 0)))
      s = 0;
    else  // negative only in sums of pairs and between nodes
      clean = clean && !end;
  }
  auto const last = std::find_if(low.density.rbegin(), low.density.rend(), [](double d) { return d != 0; });
  low.density.resize(std::max<std::ptrdiff_t>(1, low.density.rend() - last));
  return clean;
}

double rounding_of(SlowPhase const& p, std::vector<double> const& c, Covariance const& r, double constant) {
  // Rounding of R enters C relative to R(0), or to its fall where that is known, and at random, like that of the
  // transform; that of the tones repeats with their period and adds up; the constant part leaves its own.
  double squares = 0, peaks = 0;
  for (std::size_t i = 0; i < c.size(); ++i)
    squares += std::pow(c[i] * (1 + (i < r.fall.size() ? r.fall[i] : r.at_zero)), 2);
  double rounding = 64 * std::sqrt(2 * squares);
  for (PhaseTone const& t : p.tones) peaks += 1 + t.peak;
  if (peaks > 0) rounding += 8 * peaks * (norm1(c) + constant * std::sqrt(2 * static_cast<double>(c.size())));
  return rounding;
}

WrappedSpectrum transform(SlowPhase const& p, std::function<Covariance(LagGrid const&)> const& gaussian,
                          double resolution) {
  WrappedSpectrum low;
  LagGrid lags = lags_for(p, resolution);
  for (; lags.samples <= most_samples; lags.samples = more_samples(lags.samples)) {
    Covariance const r = gaussian(lags);
    double unmoved = std::exp(-r.at_zero);
    for (PhaseTone const& t : p.tones) unmoved *= std::pow(::j0(t.peak), 2);
    std::vector<double> const c = correlation(p, r, lags, unmoved);
    low.constant = unmoved / 2;
    if (transform_lags(c, lags, rounding_of(p, c, r, unmoved), low)) return low;
  }
  throw too_strong(p, lags);
}

NumericalError too_strong(SlowPhase const& p, LagGrid const& lags) {
  return NumericalError(
      fmt::format("the motion is too strong: fringes up to {:.3g} Hz at a resolution of {:.3g} Hz need more than 2^24 "
                  "samples; check the unit of the motion",
                  reach(p), lags.spacing));
}

std::size_t more_samples(std::size_t n) { return n < most_samples ? std::min(2 * n, most_samples) : 2 * n; }

LagGrid lags_for(SlowPhase const& p, double resolution) {
  double spacing = spacing_for(p.tones, resolution);
  double const rate = 2 * reach(p);
  std::size_t n = quick_size(std::max(static_cast<double>(fewest), rate / spacing));
  if (n > usual_most && p.tones.empty()) {
    n = usual_most;
    spacing = std::min(rate / static_cast<double>(n), 4 * spacing);
    n = quick_size(rate / spacing);
  }
  return {spacing, n};
}

WrappedSpectrum drifting(WrappedSpectrum const& low, double hz) {
  double const lines = std::round(hz / low.spacing);
  if (lines == 0) return low;
  if (!(lines < static_cast<double>(most_samples)))
    throw NumericalError(
        fmt::format("the drift is too fast: {:.3g} fringes per second at a resolution of {:.3g} Hz; check its unit", hz,
                    low.spacing));
  auto const shift = static_cast<std::size_t>(lines), size = low.density.size();
  WrappedSpectrum out{low.spacing, std::vector<double>(size + shift), 0, low.samples};
  for (std::size_t k = 0; k < size; ++k) {  // one-sided densities: the two-sided one is half of it, even
    out.density[k + shift] += low.density[k] / 2;
    if (k > 0) out.density[k < shift ? shift - k : k - shift] += low.density[k] / 2;
    if (k == shift && k > 0) out.density[0] += low.density[k] / 2;
  }
  out.density[shift] += low.constant / low.spacing;
  return out;
}

double total(WrappedSpectrum const& low) {
  double sum = low.constant + low.density[0] * low.spacing / 2;
  for (std::size_t k = 1; k < low.density.size(); ++k) sum += low.density[k] * low.spacing;
  return sum;
}

struct CosineTransform::Plan {
  std::size_t m;
  Fourier fourier;
  std::vector<double> cosine, sine;  // of pi k/(2m), k <= m/2
  std::vector<double> shuffled;      // even points forwards, then odd points backwards
  Complexes lines;                   // of them, m/2 + 1
};

CosineTransform::CosineTransform(std::size_t m) : plan_(std::make_unique<Plan>()) {
  Plan& p = *plan_;
  p.m = m;
  p.shuffled.resize(m);
  p.lines.resize(m / 2 + 1);
  for (std::size_t k = 0; k <= m / 2; ++k) {
    double const angle = pi * static_cast<double>(k) / static_cast<double>(2 * m);
    p.cosine.push_back(std::cos(angle));
    p.sine.push_back(std::sin(angle));
  }
}

CosineTransform::~CosineTransform() = default;

CosineTransform const& CosineTransform::of(std::size_t m) {
  thread_local std::map<std::size_t, CosineTransform> kept;
  return kept.try_emplace(m, m).first->second;
}

void CosineTransform::values(std::vector<double> const& a, std::vector<double>& x) const {
  Plan& p = *plan_;
  auto const at = [&](std::size_t k) { return k < a.size() ? a[k] : 0; };
  auto const half = 0.5 * static_cast<double>(p.m);
  p.lines[0] = 2 * half * at(0);
  for (std::size_t k = 1; k <= p.m / 2; ++k) {  // (c + i s) (a_k - i a_(m-k))
    double const c = p.cosine[k], s = p.sine[k], re = half * at(k), im = -half * at(p.m - k);
    p.lines[k] = {c * re - s * im, c * im + s * re};
  }
  p.fourier.inverse(p.lines, p.shuffled, p.m);
  x.resize(p.m);
  for (std::size_t i = 0; i < p.m / 2; ++i) {
    x[2 * i] = p.shuffled[i];
    x[2 * i + 1] = p.shuffled[p.m - 1 - i];
  }
}

void CosineTransform::amplitudes(std::vector<double> const& x, std::vector<double>& a) const {
  Plan& p = *plan_;
  for (std::size_t i = 0; i < p.m / 2; ++i) {
    p.shuffled[i] = x[2 * i];
    p.shuffled[p.m - 1 - i] = x[2 * i + 1];
  }
  p.fourier.forward(p.shuffled, p.lines);
  double const step = 2 / static_cast<double>(p.m);
  a.resize(p.m);
  a[0] = step / 2 * p.lines[0].real();
  for (std::size_t k = 1; k <= p.m / 2; ++k) {
    double const c = p.cosine[k], s = p.sine[k], re = p.lines[k].real(), im = p.lines[k].imag();
    a[k] = step * (c * re + s * im);
    a[p.m - k] = step * (s * re - c * im);
  }
}

namespace {

// Integral of the steps over intervals whose lower ends come in increasing order.
class Sweep {
 public:
  explicit Sweep(Steps const& steps) : edges_(steps.edges), psd_(steps.psd) {}
  double operator()(double low, double high) {
    if (fresh_) at_ = static_cast<std::size_t>(std::ranges::upper_bound(edges_, low) - edges_.begin());
    if (fresh_ && at_ > 0) --at_;
    fresh_ = false;
    while (at_ < psd_.size() && edges_[at_ + 1] <= low) ++at_;
    double sum = 0;
    for (std::size_t j = at_; j < psd_.size() && edges_[j] < high; ++j)
      sum += psd_[j] * (std::min(high, edges_[j + 1]) - std::max(low, edges_[j]));
    return sum;
  }

 private:
  std::vector<double> const &edges_, &psd_;
  std::size_t at_ = 0;
  bool fresh_ = true;
};

// Neighbouring bins of nearly equal width.
struct Octave {
  double high, narrowest;
  // Required resolution of the wrapped spectrum at a frequency that reaches these bins: a quarter of a bin, or half a
  // step of the modulation (1.1 % of its frequency) where that comes from far above.
  double step(double hz) const { return std::max(narrowest / 4, 0.0055 * (hz - high)); }
};

// The wrapped spectrum as lines at their centres of power, and the part that counts as unshifted.
struct Condensed {
  Kernel lines;
  double at_zero;
};

Condensed condensed(WrappedSpectrum const& low, Octave const& octave) {
  Condensed out{{}, low.constant + low.density[0] * low.spacing / 2};
  std::size_t k = 1;
  auto const hz = [&](std::size_t i) { return static_cast<double>(i) * low.spacing; };
  for (; k < low.density.size() && hz(k) < octave.step(0) / 2; ++k) out.at_zero += low.density[k] * low.spacing;
  while (k < low.density.size()) {
    double const first = hz(k), end = first + octave.step(first);
    double power = 0, moment = 0;
    for (; k < low.density.size() && hz(k) < end; ++k) {
      power += low.density[k];
      moment += low.density[k] * hz(k);
    }
    if (power == 0) continue;
    out.lines.hz.push_back(std::clamp(moment / power, first, end));
    out.lines.power.push_back(power * low.spacing);
  }
  return out;
}

}  // namespace

void add_sidebands(Kernel const& kernel, Steps const& steps, std::span<double const> e, std::span<double> bin_power) {
  if (steps.psd.empty()) return;
  for (std::size_t line = 0; line < kernel.hz.size(); ++line) {
    double const g = kernel.hz[line], half = kernel.power[line] / 2;
    if (e.back() + g <= steps.edges.front() || g - e.back() >= steps.edges.back()) continue;
    Sweep upper(steps), lower(steps), folded(steps);
    for (std::size_t i = 0; i < bin_power.size(); ++i) {
      bin_power[i] += half * upper(e[i] + g, e[i + 1] + g);
      if (e[i + 1] > g) bin_power[i] += half * lower(std::max(e[i] - g, 0.0), e[i + 1] - g);
    }
    for (std::size_t i = bin_power.size(); i-- > 0;)  // frequencies below the line: |f - g| grows downwards
      if (e[i] < g) bin_power[i] += half * folded(std::max(g - e[i + 1], 0.0), g - e[i]);
  }
}

void add_lines(WrappedSpectrum const& low, std::span<double const> edges, std::span<double> bin_power) {
  std::size_t bin = 0;
  for (std::size_t k = 0; k < low.density.size(); ++k) {
    double const from = (static_cast<double>(k) - 0.5) * low.spacing, to = from + low.spacing;
    while (bin < bin_power.size() && edges[bin + 1] <= from) ++bin;
    for (std::size_t i = bin; i < bin_power.size() && edges[i] < to; ++i)
      bin_power[i] += low.density[k] * (std::min(to, edges[i + 1]) - std::max(from, edges[i]));
  }
}

void modulate(WrappedSpectrum const& low, Steps const& fast, std::span<double const> unshifted,
              std::span<double const> edges, std::span<double> bin_power) {
  auto const width = [&](std::size_t i) { return edges[i + 1] - edges[i]; };
  for (std::size_t first = 0, next = 0; first < bin_power.size(); first = next) {
    double narrowest = width(first);
    for (; next < bin_power.size() && width(next) < 2 * width(first) && width(next) > 0.5 * width(first); ++next)
      narrowest = std::min(narrowest, width(next));
    Condensed const c = condensed(low, {edges[next], narrowest});
    for (std::size_t i = first; i < next; ++i) bin_power[i] += c.at_zero * unshifted[i];
    add_sidebands(c.lines, fast, edges.subspan(first, next - first + 1), bin_power.subspan(first, next - first));
  }
}

Steps as_steps(WrappedSpectrum const& low) {
  Steps steps{{0}, low.density};
  for (std::size_t k = 0; k < low.density.size(); ++k)
    steps.edges.push_back((static_cast<double>(k) + 0.5) * low.spacing);
  return steps;
}

}  // namespace straytrace::noise
