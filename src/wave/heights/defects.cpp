// SPDX-License-Identifier: BSD-3-Clause
#include "wave/heights/defects.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/expint.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "wave/heights/from_spectrum.hpp"

namespace straytrace::wave {
namespace {

// ln x + E1(x), finite at zero.
double log_and_integral(double x) {
  if (x < 1e-9) return x - boost::math::constants::euler<double>();
  return std::log(x) + boost::math::expint(1, x);
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
    share += (std::exp(-u) - (b > 0 ? u * boost::math::expint(1, u) : 0)) / (on_mirror * on_mirror * azimuths);
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
