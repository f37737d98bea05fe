// SPDX-License-Identifier: BSD-3-Clause
#include "wave/heights/defects.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/expint.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "wave/heights/from_spectrum.hpp"

namespace straytrace::wave {
namespace {

// ln x + E1(x), finite at zero.
double log_and_integral(double x) {
  if (x < 1e-9) return x - boost::math::constants::euler<double>();
  return std::log(x) + boost::math::expint(1, x);
}

template <class Height>
std::vector<double> on_grid(Grid const& grid, Height const& height) {
  std::vector<double> heights;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      heights.push_back(height((column - grid.points / 2) * grid.pitch(), (row - grid.points / 2) * grid.pitch()));
  return heights;
}

}  // namespace

double height_of_absorber(WaveSettings::Absorber const& a, double distance, double edge) {
  auto const part = [&](double r) { return log_and_integral(2 * r * r / (a.radius * a.radius)); };
  return a.rise / (4 * pi) * (part(edge) - part(distance));
}

// A wider spot, which the grid carries exactly, has the long range; the rest is short and has a spectrum (eq. W.32).
std::vector<double> heights_of_absorber(WaveSettings::Absorber const& a, Grid const& grid, double edge,
                                        double largest_frequency) {
  WaveSettings::Absorber wide = a;
  wide.radius = std::fmax(a.radius, 8 / (pi * largest_frequency));  // exp(-32) of its spectrum lies beyond
  std::vector<double> heights =
      on_grid(grid, [&](double x, double y) { return height_of_absorber(wide, std::hypot(x - a.x, y - a.y), edge); });
  if (!(wide.radius > a.radius)) return heights;
  double const area = grid.window * grid.window;
  std::vector<double> const narrow = heights_from_spectrum(grid, largest_frequency, [&](int n, int m) {
    double const q = 2 * pi * std::hypot(n, m) / grid.window, u = q * q / 8;
    double const w2 = wide.radius * wide.radius, a2 = a.radius * a.radius;
    double const size = u * w2 < 1e-8 ? (w2 - a2) / 8 : (std::exp(-u * a2) - std::exp(-u * w2)) / (q * q);
    return double(grid.size()) * (a.rise / area * size) * turned(-(n * a.x + m * a.y) / grid.window);
  });
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += narrow[i];
  return heights;
}

double scattered_by_absorber(WaveSettings::Absorber const& a, double beam_radius, double wavelength, double angle) {
  double const w2 = beam_radius * beam_radius;
  double const irradiance = 2 / (pi * w2) * std::exp(-2 * (a.x * a.x + a.y * a.y) / w2);
  double const q2 = std::pow(2 * pi * angle / wavelength, 2), b = a.radius * a.radius / 4;
  double const share = std::exp(-b * q2) - (b > 0 ? b * q2 * boost::math::expint(1, b * q2) : 0);
  return irradiance * a.rise * a.rise / (pi * angle * angle) * share;
}

std::vector<double> heights_of_ripple(WaveSettings::Ripple const& r, Grid const& grid) {
  double const kx = 2 * pi / r.period * std::cos(r.direction), ky = 2 * pi / r.period * std::sin(r.direction);
  return on_grid(grid, [&](double x, double y) { return r.amplitude * std::cos(kx * x + ky * y); });
}

}  // namespace straytrace::wave
