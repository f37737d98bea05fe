// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/math/constants.hpp"

namespace straytrace::spectra {
namespace {

// Integral of f^n from a to b, divided by a^n: exact for every n, smooth through n = -1.
double power_law_integral(double a, double b, double n) {
  double const span = std::log(b / a), x = (n + 1) * span;
  return a * span * (std::fabs(x) < 1e-8 ? 1 + x / 2 : std::expm1(x) / x);
}

std::size_t interval_of(std::vector<double> const& knots, double hz) {
  auto const after = std::ranges::upper_bound(knots, hz) - knots.begin();
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - 1, 0, std::ssize(knots) - 2));
}

}  // namespace

Spectrum::Spectrum(std::vector<double> hz, std::vector<double> psd) {
  if (hz.size() < 2) return;
  Table t{std::move(hz), std::move(psd), {}};
  t.slope.resize(t.hz.size() - 1);
  for (std::size_t i = 0; i < t.slope.size(); ++i) {
    bool const positive = t.psd[i] > 0 && t.psd[i + 1] > 0;
    t.slope[i] = positive ? std::log(t.psd[i + 1] / t.psd[i]) / std::log(t.hz[i + 1] / t.hz[i]) : not_a_number;
  }
  tables_.push_back(std::move(t));
}

double Spectrum::at(Table const& t, double hz) {
  if (!(hz >= t.hz.front() && hz <= t.hz.back())) return 0;
  std::size_t const i = interval_of(t.hz, hz);
  if (!std::isnan(t.slope[i])) return t.psd[i] * std::pow(hz / t.hz[i], t.slope[i]);
  return t.psd[i] + (t.psd[i + 1] - t.psd[i]) * (hz - t.hz[i]) / (t.hz[i + 1] - t.hz[i]);
}

double Spectrum::moment(Table const& t, double low, double high, int order) {
  low = std::max(low, t.hz.front());
  high = std::min(high, t.hz.back());
  double sum = 0;
  if (!(low < high)) return sum;
  for (std::size_t i = interval_of(t.hz, low); i < t.slope.size() && t.hz[i] < high; ++i) {
    double const a = std::max(low, t.hz[i]), b = std::min(high, t.hz[i + 1]);
    if (!(a < b)) continue;
    double const n = t.slope[i];
    if (!std::isnan(n)) {
      double const s = t.psd[i] * std::pow(a / t.hz[i], n) * std::pow(a, order);
      sum += s * power_law_integral(a, b, n + order);
      continue;
    }
    auto const value = [&](double f) {
      return std::pow(f, order) * (t.psd[i] + (t.psd[i + 1] - t.psd[i]) * (f - t.hz[i]) / (t.hz[i + 1] - t.hz[i]));
    };
    sum += (b - a) / 6 * (value(a) + 4 * value((a + b) / 2) + value(b));  // Simpson: exact up to cubic, order <= 2
  }
  return sum;
}

double Spectrum::at(double hz) const {
  double sum = 0;
  for (Table const& t : tables_) sum += at(t, hz);
  return sum;
}

double Spectrum::power(double low, double high) const {
  double sum = 0;
  for (Table const& t : tables_) sum += moment(t, low, high, 0);
  return sum;
}

double Spectrum::total() const { return power(0, infinity); }

double Spectrum::lowest() const {
  double f = tables_.empty() ? 0 : infinity;
  for (Table const& t : tables_) f = std::min(f, t.hz.front());
  return f;
}

double Spectrum::highest() const {
  double f = 0;
  for (Table const& t : tables_) f = std::max(f, t.hz.back());
  return f;
}

double Spectrum::rate_power(double high) const {
  double sum = 0;
  for (Table const& t : tables_) sum += moment(t, 0, high, 2);
  return 4 * pi * pi * sum;
}

Spectrum Spectrum::scaled(double factor) const {
  Spectrum s = *this;
  for (Table& t : s.tables_)
    for (double& p : t.psd) p *= factor;
  return s;
}

Spectrum Spectrum::multiplied(std::function<double(double)> const& factor, std::span<double const> extra) const {
  Spectrum product;
  for (Table const& t : tables_) {
    std::vector<double> hz = t.hz;
    for (double f : extra)
      if (f > t.hz.front() && f < t.hz.back()) hz.push_back(f);
    std::ranges::sort(hz);
    hz.erase(std::unique(hz.begin(), hz.end()), hz.end());
    std::vector<double> psd;
    for (double f : hz) psd.push_back(at(t, f) * factor(f));
    product = product + Spectrum(std::move(hz), std::move(psd));
  }
  return product;
}

std::vector<double> Spectrum::hz() const {
  std::vector<double> knots;
  for (Table const& t : tables_) knots.insert(knots.end(), t.hz.begin(), t.hz.end());
  std::ranges::sort(knots);
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  return knots;
}

std::vector<double> Spectrum::psd() const {
  std::vector<double> values = hz();
  for (double& v : values) v = at(v);
  return values;
}

Spectrum operator+(Spectrum const& a, Spectrum const& b) {
  Spectrum sum = a;
  sum.tables_.insert(sum.tables_.end(), b.tables_.begin(), b.tables_.end());
  return sum;
}

bool same_shape(Spectrum const& a, Spectrum const& b) {
  constexpr double tolerance = 1e-6;
  auto const near = [](double x, double y) { return std::fabs(x - y) <= tolerance * std::max(x, y); };
  if (!near(a.lowest(), b.lowest()) || !near(a.highest(), b.highest())) return false;
  double const ratio = a.total() / b.total();
  auto const agree = [&](std::vector<double> const& knots) {  // ends apart: they may differ in the last digit
    for (std::size_t i = 1; i + 1 < knots.size(); ++i)
      if (!near(a.at(knots[i]), ratio * b.at(knots[i]))) return false;
    return true;
  };
  double const middle = std::sqrt(a.lowest() * a.highest());
  return near(a.at(middle), ratio * b.at(middle)) && agree(a.hz()) && agree(b.hz());
}

namespace {

std::vector<double> logarithmic_knots(double from, double to, double per_decade) {
  auto const n = static_cast<std::size_t>(std::ceil(std::log10(to / from) * per_decade)) + 1;
  std::vector<double> hz(n + 1);
  for (std::size_t i = 0; i <= n; ++i)
    hz[i] = from * std::pow(to / from, static_cast<double>(i) / static_cast<double>(n));
  hz.back() = to;
  return hz;
}

using Function = std::function<double(double)>;

struct Knot {
  double hz, value;
};

// Sets knots between two until the curve is followed.
void refine(Function const& curve, Function const& scale, Knot a, Knot b, std::vector<double>& knots) {
  constexpr double tolerance = 1e-5, negligible = 1e-12, narrowest = 1e-6;
  if (b.hz < a.hz * (1 + narrowest)) return;
  double const middle = std::sqrt(a.hz * b.hz), line = std::sqrt(a.value * b.value);
  Knot const m{middle, curve(middle)};
  if (!(std::fabs(m.value - line) > tolerance * m.value + negligible * scale(middle))) return;
  refine(curve, scale, a, m, knots);
  knots.push_back(middle);
  refine(curve, scale, m, b, knots);
}

}  // namespace

Spectrum power_law_asd(double asd, double at_hz, double exponent, double from_hz, double to_hz) {
  auto const psd = [&](double f) { return asd * asd * std::pow(f / at_hz, 2 * exponent); };
  return Spectrum({from_hz, to_hz}, {psd(from_hz), psd(to_hz)});
}

Spectrum gaussian_line(double centre, double width, double rms) {
  constexpr double reach = 8, step = 0.02;  // standard deviations; beyond 8 the density is 1e-14 of the peak
  double const first = std::max(centre - reach * width, step * width);
  std::vector<double> hz, psd;
  for (double f = first; f <= centre + reach * width; f += step * width) {
    double const x = (f - centre) / width;
    hz.push_back(f);
    psd.push_back(std::exp(-x * x / 2));
  }
  Spectrum const shape(std::move(hz), std::move(psd));
  return shape.scaled(rms * rms / shape.total());
}

Spectrum peterson(GroundModel model, double from_hz, double to_hz) {
  std::vector<double> const hz = logarithmic_knots(from_hz, to_hz, 400);
  std::vector<double> psd;
  for (double f : hz) psd.push_back(std::pow(peterson_asd(model, f), 2));
  return Spectrum(hz, psd);
}

Spectrum filtered(Spectrum const& s, Function const& factor, std::span<double const> features, Function const& scale) {
  if (!(s.highest() > s.lowest())) return s;
  std::vector<double> knots = s.hz(), coarse = logarithmic_knots(s.lowest(), s.highest(), 16), extra;
  knots.insert(knots.end(), coarse.begin(), coarse.end());
  for (double const f : features)
    if (f > s.lowest() && f < s.highest()) knots.push_back(f);
  std::ranges::sort(knots);
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  std::vector<double> values;
  for (double const f : knots) values.push_back(factor(f));
  Function const& beside = scale ? scale : factor;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    refine(factor, beside, {knots[i], values[i]}, {knots[i + 1], values[i + 1]}, extra);
  extra.insert(extra.end(), knots.begin(), knots.end());
  return s.multiplied(factor, extra);
}

double transmissibility(double hz, double resonance_hz, double quality) {
  double const x = hz / resonance_hz, damping = x / quality, stiff = 1 - x * x;
  return (1 + damping * damping) / (stiff * stiff + damping * damping);
}

Spectrum through_resonance(Spectrum const& s, double resonance_hz, double quality) {
  std::vector<double> extra = {resonance_hz};
  if (s.highest() > s.lowest()) extra = logarithmic_knots(s.lowest(), s.highest(), 100);
  for (double offset = 0.02 / quality; offset < 0.5; offset *= 1.05)
    for (double sign : {-1.0, 1.0}) extra.push_back(resonance_hz * (1 + sign * offset));
  extra.push_back(resonance_hz);
  return s.multiplied([&](double f) { return transmissibility(f, resonance_hz, quality); }, extra);
}

namespace {

// From `period` [s] to the next line: acceleration PSD in dB relative to 1 (m/s^2)^2/Hz = a + b log10(period).
struct Piece {
  double period, a, b;
};
constexpr Piece low_noise[] = {{0.10, -162.36, 5.64},   {0.17, -166.70, 0},      {0.40, -170.00, -8.30},
                               {0.80, -166.40, 28.90},  {1.24, -168.60, 52.48},  {2.40, -159.98, 29.81},
                               {4.30, -141.10, 0},      {5.00, -71.36, -99.77},  {6.00, -97.26, -66.49},
                               {10.0, -132.18, -31.57}, {12.0, -205.27, 36.16},  {15.6, -37.65, -104.33},
                               {21.9, -114.37, -47.10}, {31.6, -160.58, -16.28}, {45.0, -187.50, 0},
                               {70.0, -216.47, 15.70},  {101, -185.00, 0},       {154, -168.34, -7.61},
                               {328, -217.43, 11.90},   {600, -258.28, 26.60},   {10000, -346.88, 48.75}};
constexpr Piece high_noise[] = {{0.10, -108.73, -17.23}, {0.22, -150.34, -80.50}, {0.32, -122.31, -23.87},
                                {0.80, -116.85, 32.51},  {3.80, -108.48, 18.08},  {4.60, -74.66, -32.95},
                                {6.30, 0.66, -127.18},   {7.90, -93.37, -22.42},  {15.4, 73.54, -162.98},
                                {20.0, -151.52, 10.01},  {354.8, -206.66, 31.63}};
constexpr double end_hz = 10;  // of the models

double displacement(std::span<Piece const> model, double hz) {
  if (hz > end_hz) return displacement(model, end_hz) * std::pow(end_hz / hz, 2);
  double const period = 1 / hz;
  Piece const* piece = &model.front();
  for (Piece const& p : model)
    if (p.period <= period) piece = &p;
  return std::pow(10, (piece->a + piece->b * std::log10(period)) / 20) / std::pow(2 * pi * hz, 2);
}

}  // namespace

double peterson_asd(GroundModel model, double hz) {
  if (model == GroundModel::low) return displacement(low_noise, hz);
  if (model == GroundModel::high) return displacement(high_noise, hz);
  return std::sqrt(displacement(low_noise, hz) * displacement(high_noise, hz));
}

}  // namespace straytrace::spectra
