// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/roughness.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "optics/lobes/lobe_prepare.hpp"

namespace straytrace::optics {
namespace {

// Tangential fields at one depth: the one that continues as `first`, and its partner.
struct Tangential {
  Complex first, second;
};

// From the lower to the upper face of a layer, where a wave downwards has second = admittance first.
Tangential lifted(Tangential at, Complex q, Complex admittance, double thickness_in_wavelengths) {
  Complex const turns = thickness_in_wavelengths * q, e = exp_turns(turns), back = exp_turns(-turns);
  Complex const cosine = 0.5 * (e + back), sine = 0.5 * (e - back);  // sine: i sin
  return {cosine * at.first - sine * (at.second / admittance), cosine * at.second - sine * (admittance * at.first)};
}

double largest(InterfaceField const& f) { return std::sqrt(std::max({norm(f.s), norm(f.along), norm(f.across)})); }

}  // namespace

Complex RoughStack::permittivity(std::size_t medium) const {
  if (medium == 0) return {1, 0};
  Complex const n = medium <= layers.size() ? layers[medium - 1].index : behind;
  return n * n;
}

std::vector<InterfaceField> RoughStack::fields(double cosine) const {
  std::size_t const count = layers.size() + 1;
  double const sin2 = (1 - cosine) * (1 + cosine);
  std::vector<InterfaceField> f(count);
  auto const root = [&](std::size_t medium) {
    Complex const q = upper_root(permittivity(medium) - Complex{sin2, 0});
    return norm(q) > 1e-24 ? q : Complex{1e-12, 0};
  };
  Complex const q_last = root(count);
  Tangential s{{1, 0}, q_last}, p{{1, 0}, q_last / permittivity(count)};  // E and H; H and E along the surface
  for (std::size_t j = count; j-- > 0;) {
    f[j] = {s.first, p.second, p.first};
    if (j == 0) break;
    Complex const q = root(j);
    double const turns = layers[j - 1].thickness / wavelength;
    s = lifted(s, q, q, turns);
    p = lifted(p, q, q / permittivity(j), turns);
    if (norm(s.first) + norm(p.first) < 1e200) continue;
    for (std::size_t k = j; k < count; ++k)  // an opaque layer: what lies below it stays dark
      f[k] = {1e-100 * f[k].s, 1e-100 * f[k].along, 1e-100 * f[k].across};
    s = {1e-100 * s.first, 1e-100 * s.second};
    p = {1e-100 * p.first, 1e-100 * p.second};
  }
  Complex const s_in = cosine * s.first + s.second, p_in = cosine * p.first + p.second;
  for (std::size_t j = 0; j < count; ++j) {
    Complex const above = permittivity(j), below = permittivity(j + 1), step = upper_root(below - above);
    f[j] = {step * f[j].s / s_in, step * f[j].along / p_in, step / upper_root(above * below) * f[j].across / p_in};
  }
  return f;
}

double RoughStack::factor(double cos_i, double cos_s, double cos_phi) const {
  double const sines = std::sqrt((1 - cos_i) * (1 + cos_i) * (1 - cos_s) * (1 + cos_s));
  auto const in = fields(cos_i), out = fields(cos_s);
  StackSum sum;
  for (std::size_t j = 0; j < in.size(); ++j) sum.add(in[j], out[j], sines);
  return sum.factor(cos_phi, common);
}

std::vector<InterfaceField> RoughStack::nodes(std::int64_t count) const {
  std::vector<InterfaceField> all;
  for (std::int64_t i = 0; i < count; ++i) {
    auto const here = fields(double(i) / double(count - 1));
    all.insert(all.end(), here.begin(), here.end());
  }
  return all;
}

StackFactor RoughStack::tabulated(Storage& storage) const {
  constexpr double tolerance = 1e-3;
  StackFactor f;
  f.interfaces = std::int64_t(layers.size()) + 1;
  f.common = common;
  for (f.nodes = 257;; f.nodes = 2 * f.nodes - 1) {
    auto table = nodes(f.nodes);
    f.table = {table.data(), table.size()};
    double error = 0, most = 0;
    for (std::int64_t i = 0; i + 1 < f.nodes && f.nodes < 8193; ++i) {
      double const cosine = (double(i) + 0.5) / double(f.nodes - 1);
      auto const exact = fields(cosine);
      StackFactor::Row const row(f, cosine);
      for (std::int64_t j = 0; j < f.interfaces; ++j) {
        InterfaceField const a = exact[std::size_t(j)], b = row.at(j);
        most = std::max(most, largest(a));
        error = std::max(error, largest({a.s - b.s, a.along - b.along, a.across - b.across}));
      }
    }
    if (error > tolerance * most) continue;
    f.table = storage.keep_large(std::move(table));
    return f;
  }
}

namespace {

// Spectrum of unit variance on radii evenly spaced in their logarithm; flat below, zero beyond rho = 2.
class RadialTable {
 public:
  RadialTable(double first, std::function<double(double)> const& f) : first_(first) {
    for (int i = 0; i < size; ++i) values_[i] = std::fmax(f(radius(i)), 1e-300);
  }
  double radius(int i) const { return first_ * power_positive(2 / first_, double(i) / (size - 1)); }
  double at(double rho) const {
    if (rho >= 2) return 0;
    double const x = rho > first_ ? (size - 1) * log_positive(rho / first_) / log_positive(2 / first_) : 0;
    int const i = std::min(int(x), size - 2);
    return values_[i] * power_positive(values_[i + 1] / values_[i], x - i);
  }
  static constexpr int size = Roughness::radii;

 private:
  double first_, values_[size];
};

// Convolution of two radial functions in the plane: each point belongs to the nearer of the two centres, about which
// the rings lie.
double convolved(RadialTable const& f, RadialTable const& g, double rho) {
  constexpr int turns = 12;
  double sum = 0, low = 0;
  for (int i = 0; i < RadialTable::size; ++i) {
    double const high = f.radius(i), r = i ? std::sqrt(low * high) : 0.5 * high;
    double const reach = r > rho / 2 ? 2 * atan_positive(std::sqrt((2 * r - rho) / (2 * r + rho)))
                                     : 0;  // nearer to the other centre within this azimuth
    double ring = 0;
    for (int j = 0; j < turns; ++j) {
      double const phi = reach + (j + 0.5) / turns * (pi - reach);
      double const other = std::sqrt(r * r + rho * rho - 2 * r * rho * sincos_turn(phi / (2 * pi)).cos);
      ring += f.at(r) * g.at(other) + g.at(r) * f.at(other);
    }
    double const area = i ? r * r * log_positive(high / low) : 0.5 * high * high;
    sum += ring / turns * 2 * (pi - reach) * area;
    low = high;
  }
  return sum;
}

}  // namespace

double Roughness::variance(double low, double high) const {
  constexpr int steps = 4000;  // midpoints, even in log(rho)
  double const start = std::fmax(low, b > 0 ? std::fmin(1e-4 / b, 1e-4) : 1e-3 * first),
               ratio = log_positive(high / start) / steps;
  double sum = low < start ? 0.5 * start * start * spectrum(start) : 0;
  for (int i = 0; i < steps; ++i) {
    double const rho = start * exp_number((i + 0.5) * ratio);
    sum += spectrum(rho) * rho * rho * ratio;
  }
  return 2 * pi * sum;
}

void Roughness::prepare() {
  double const knee = b > 0 ? std::fmin(1 / b, 1) : first;
  orders = 1;
  phase_variance = 0;
  if (harvey_shack) {
    double const rms2 = variance(0, 1), most = 16 * pi * pi * rms2;
    phase_variance = 4 * pi * pi * rms2;
    first_radius = std::fmin(0.02 * knee, 0.02);
    RadialTable const one(first_radius, [&](double rho) { return rho <= 1 ? spectrum(rho) / rms2 : 0; });
    RadialTable latest = one;
    double weight = most, factorial = 1;
    for (int n = 2; n <= most_orders; ++n) {
      weight *= most / n;
      factorial *= n;
      if (most < 1e-5 || (weight < 1e-6 * most && n > most)) break;
      latest = RadialTable(first_radius, [&](double rho) { return convolved(one, latest, rho); });
      for (int i = 0; i < radii; ++i) higher[n][i] = latest.at(latest.radius(i) * (1 - 1e-12)) / factorial;
      orders = n;
    }
  }
  lobe.prepare(*this, knee);
}

namespace {

// Segment that holds f; the first and the last extend beyond the ends.
std::size_t segment(HeightSpectrum const& s, double f) {
  std::size_t low = 0, high = s.size() - 1;
  while (high - low > 1) {
    std::size_t const mid = (low + high) / 2;
    (s[mid].f <= f ? low : high) = mid;
  }
  return low;
}
double slope(HeightSpectrum const& s, std::size_t i) {
  return log_positive(s[i + 1].value / s[i].value) / log_positive(s[i + 1].f / s[i].f);
}

// Integral of value f^power from low to high, by midpoints even in ln(f), exact for power laws within a step.
double integral(HeightSpectrum const& s, double power, double low, double high) {
  constexpr int steps = 20000;
  double const ratio = log_positive(high / low) / steps;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    double const f = low * exp_number((i + 0.5) * ratio), m = slope(s, segment(s, f)) + power + 1, x = m * ratio / 2;
    double const within = x * x < 1e-12 ? 1 : (exp_number(x) - exp_number(-x)) / (2 * x);
    sum += spectrum_at(s, f) * power_positive(f, power + 1) * within;
  }
  return sum * ratio;
}

}  // namespace

double spectrum_at(HeightSpectrum const& s, double f) {
  std::size_t const i = segment(s, f);
  return s[i].value * power_positive(f / s[i].f, slope(s, i));
}

double variance_1d(HeightSpectrum const& s, double low, double high) { return 2 * integral(s, 0, low, high); }
double variance_2d(HeightSpectrum const& s, double low, double high) { return 2 * pi * integral(s, 1, low, high); }

HeightSpectrum surface_of_profile(HeightSpectrum const& profile) {
  // S2(f) = -(1/pi) int_f^inf S'(t)/sqrt(t^2 - f^2) dt with t = f cosh u
  constexpr int steps = 4000;
  constexpr double last = 14.5;  // t = 1e6 f
  HeightSpectrum surface;
  for (SpectrumPoint const& p : profile) {
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
      double const e = exp_number((k + 0.5) * last / steps), t = p.f * 0.5 * (e + 1 / e);
      sum -= slope(profile, segment(profile, t)) * spectrum_at(profile, t) / t;
    }
    surface.push_back({p.f, sum * last / steps / pi});
  }
  return surface;
}

double tis_smooth(double rms, double cos_i, double wavelength) {
  double const phase = 4 * pi * rms * cos_i / wavelength;
  return phase * phase;
}

}  // namespace straytrace::optics
