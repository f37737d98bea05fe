// SPDX-License-Identifier: BSD-3-Clause
// Heights on a grid from the amplitudes of their frequencies.
#include "wave/heights/defects.hpp"

#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "base/math/bessel.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "wave/heights/height_map.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {

// spectrum(column, row): the amplitude [m] of the frequency (column, row)/window along x and y, times the number of
// points of the grid; that of the opposite frequency is its conjugate, because heights are real. Frequencies up to
// `largest_frequency` [1/m].
template <class Spectrum>
std::vector<double> heights_from_spectrum(Grid const& grid, double largest_frequency, Spectrum const& spectrum) {
  int const n = grid.points;
  double const largest = periods_across(largest_frequency, grid);
  int const most = int(std::fmin(n / 2 - 1, largest));
  Field field(grid);
  // Half of the frequencies. The inverse transform divides by the number of points; signs put the axis into the middle
  // of the grid.
  for (int column = 0; column <= most; ++column)
    for (int row = column == 0 ? 0 : -most; row <= most; ++row) {
      if (std::hypot(row, column) > largest) continue;
      Complex const amplitude = spectrum(column, row), value = (row + column) % 2 == 0 ? amplitude : -amplitude;
      field((n - row) % n, (n - column) % n) = std::conj(value);
      field((row + n) % n, column) = value;
    }
  Transform(n, 0).inverse(field, 2 * most + 2, n);
  std::vector<double> heights;
  heights.reserve(grid.size());
  for (Complex const v : field.values) heights.push_back(v.real());
  return heights;
}

// Heights from a spectrum, and the light that they scatter.

namespace {

// Of mean square 1, of the frequency (row, column)/window.
Complex random_amplitude(std::uint64_t seed, std::uint32_t mirror, int row, int column) {
  std::uint64_t const frequency = std::uint64_t(std::uint32_t(row)) << 32 | std::uint32_t(column);
  Rng rng(seed, frequency, mirror, Stream::height);
  double const size = std::sqrt(-log_positive(rng.uniform()));
  return size * turned(rng.uniform());
}

}  // namespace

std::vector<double> synthesise(std::function<double(double)> const& spectrum, Grid const& grid,
                               double smallest_frequency, double largest_frequency, std::uint64_t seed,
                               std::uint32_t mirror) {
  double const fewest = periods_across(smallest_frequency, grid);
  return heights_from_spectrum(grid, largest_frequency, [&](int column, int row) -> Complex {
    double const periods = std::hypot(row, column);
    if (periods <= fewest) return 0;
    double const size = std::sqrt(spectrum(periods / grid.window)) / grid.window * double(grid.size());
    return size * random_amplitude(seed, mirror, row, column);
  });
}

double height_spectrum(double brdf, double wavelength) {
  double const square = wavelength * wavelength / (4 * pi);
  return brdf * square * square;
}

// The angle of scatter to a point is the vector x/l - rho (1/l - 1/RoC). Over the spot it is normally distributed about
// x/l along both axes, so that its size has the density of Rice.
double mean_irradiance(std::function<double(double)> const& brdf, double beam_radius, double curvature, double distance,
                       double off_axis, double smallest) {
  constexpr double deviations = 8.5;  // what lies beyond is 1e-15 of the spot
  double const centre = std::fabs(off_axis) / distance;
  double const deviation = beam_radius / 2 * std::fabs(1 / distance - curvature);
  if (deviation <= 1e-9 * centre) return centre < smallest ? 0 : brdf(centre) / (distance * distance);
  // Over deviations from the centre: quadrature over an angle of microradians takes its error for a million times as
  // large, and halves the interval until it may no longer.
  auto const scattered = [&](double from_centre) {
    double const angle = centre + from_centre * deviation, t = angle / deviation;
    return brdf(angle) * t * std::exp(-0.5 * from_centre * from_centre) * scaled_bessel(0, t * centre / deviation);
  };
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
  double const from = std::max((smallest - centre) / deviation, -deviations);
  if (!(from < deviations)) return 0;
  return Kronrod::integrate(scattered, from, deviations, 20, 1e-6) / (distance * distance);
}

namespace {

// ln x + E1(x), finite at zero.
double log_and_integral(double x) {
  if (x < 1e-9) return x - std::numbers::egamma;
  return std::log(x) + exponential_integral_1(x);
}

// Of the points of the mirror on which those of the grid lie (eq. W.55).
template <class Height>
std::vector<double> on_grid(Grid const& grid, LightOnMirror const& light, Height const& height) {
  std::vector<double> heights;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      heights.push_back(height(grid.at(column) / light.cosine + light.centre[0], grid.at(row) + light.centre[1]));
  return heights;
}

}  // namespace

double height_of_absorber(WaveSettings::Absorber const& a, double distance, double edge) {
  auto const part = [&](double r) { return log_and_integral(2 * r * r / (a.radius * a.radius)); };
  return a.rise / (4 * pi) * (part(edge) - part(distance));
}

// A wider spot, which the grid carries exactly, has the long range; the rest is short and has a spectrum (eq. W.32).
std::vector<double> heights_of_absorber(WaveSettings::Absorber const& a, Grid const& grid, double edge,
                                        double largest_frequency, LightOnMirror const& light) {
  WaveSettings::Absorber wide = a;
  // exp(-32) of its spectrum lies beyond
  wide.radius = std::fmax(a.radius, 8 / (pi * light.cosine * largest_frequency));
  std::vector<double> heights = on_grid(
      grid, light, [&](double x, double y) { return height_of_absorber(wide, std::hypot(x - a.x, y - a.y), edge); });
  if (!(wide.radius > a.radius)) return heights;
  double const area = grid.window * grid.window;
  double const at_x = light.cosine * (a.x - light.centre[0]), at_y = a.y - light.centre[1];  // across the light
  std::vector<double> const narrow = heights_from_spectrum(grid, largest_frequency, [&](int n, int m) {
    double const q = 2 * pi * std::hypot(n * light.cosine, m) / grid.window, u = q * q / 8;
    double const w2 = wide.radius * wide.radius, a2 = a.radius * a.radius;
    double const size = u * w2 < 1e-8 ? (w2 - a2) / 8 : (std::exp(-u * a2) - std::exp(-u * w2)) / (q * q);
    return double(grid.size()) * (light.cosine * a.rise / area * size) * turned(-(n * at_x + m * at_y) / grid.window);
  });
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += narrow[i];
  return heights;
}

// At an incidence the height changes the path by 2h cosine, an area across the light is that of the mirror times the
// cosine, and the frequency q across the light is (q_x cosine, q_y) on the mirror: cosine^4 under the integral of the
// squared spectrum, whose mean over the azimuths stays.
double scattered_by_absorber(WaveSettings::Absorber const& a, LightOnMirror const& light, double wavelength,
                             double angle) {
  double const x = light.cosine * (a.x - light.centre[0]) / light.radius[0],
               y = (a.y - light.centre[1]) / light.radius[1];
  double const irradiance = 2 / (pi * light.radius[0] * light.radius[1]) * std::exp(-2 * (x * x + y * y));
  double const q2 = std::pow(2 * pi * angle / wavelength, 2), b = a.radius * a.radius / 4;
  int const azimuths = light.cosine == 1 ? 1 : 256;
  double share = 0;
  for (int i = 0; i < azimuths; ++i) {
    SinCos const turn = sincos_turn((i + 0.5) / azimuths);
    double const on_mirror = std::pow(light.cosine * turn.cos, 2) + turn.sin * turn.sin, u = b * q2 * on_mirror;
    share += (std::exp(-u) - (b > 0 ? u * exponential_integral_1(u) : 0)) / (on_mirror * on_mirror * azimuths);
  }
  return irradiance * a.rise * a.rise / (pi * angle * angle) * std::pow(light.cosine, 4) * share;
}

std::vector<double> heights_of_ripple(WaveSettings::Ripple const& r, Grid const& grid, LightOnMirror const& light) {
  double const kx = 2 * pi / r.period * std::cos(r.direction), ky = 2 * pi / r.period * std::sin(r.direction);
  return on_grid(grid, light, [&](double x, double y) { return r.amplitude * std::cos(kx * x + ky * y); });
}

double angle_of_ripple(WaveSettings::Ripple const& r, double cosine, double wavelength) {
  return wavelength / r.period * std::hypot(std::cos(r.direction) / cosine, std::sin(r.direction));
}

}  // namespace straytrace::wave
