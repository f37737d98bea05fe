// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/math/constants.hpp"

namespace straytrace::spectra {
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
