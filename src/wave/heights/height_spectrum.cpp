// SPDX-License-Identifier: BSD-3-Clause
// Heights from a spectrum, and the light that they scatter.
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/bessel.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "wave/heights/height_map.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {
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
  int const n = grid.points;
  double const fewest = periods_across(smallest_frequency, grid), largest = periods_across(largest_frequency, grid);
  int const most = int(std::fmin(n / 2 - 1, largest));
  Field field(grid);
  // Half of the frequencies; the others are their conjugates, because heights are real. The inverse transform divides
  // by the number of points; signs put the axis into the middle of the grid.
  for (int column = 0; column <= most; ++column)
    for (int row = column == 0 ? 1 : -most; row <= most; ++row) {
      double const periods = std::hypot(row, column);
      if (periods <= fewest || periods > largest) continue;
      double const size = std::sqrt(spectrum(periods / grid.window)) / grid.window * double(grid.size());
      Complex const value = ((row + column) % 2 == 0 ? size : -size) * random_amplitude(seed, mirror, row, column);
      field((row + n) % n, column) = value;
      field((n - row) % n, (n - column) % n) = std::conj(value);
    }
  Transform(n, 0).inverse(field, 2 * most + 2, n);
  std::vector<double> out;
  out.reserve(grid.size());
  for (Complex const v : field.values) out.push_back(v.real());
  return out;
}

double height_spectrum(double brdf, double wavelength) {
  double const square = wavelength * wavelength / (4 * pi);
  return brdf * square * square;
}

// The angle of scatter to a point is the vector x/l - rho (1/l - 1/RoC). Over the spot it is normally distributed about
// x/l along both axes, so that its size has the density of Rice.
double mean_irradiance(std::function<double(double)> const& brdf, double beam_radius, double curvature, double distance,
                       double off_axis) {
  constexpr double deviations = 8.5;  // what lies beyond is 1e-15 of the spot
  double const centre = std::fabs(off_axis) / distance;
  double const deviation = beam_radius / 2 * std::fabs(1 / distance - curvature);
  if (deviation <= 1e-9 * centre) return brdf(centre) / (distance * distance);
  auto const scattered = [&](double angle) {
    double const t = angle / deviation, from_centre = (angle - centre) / deviation;
    return brdf(angle) * t / deviation * std::exp(-0.5 * from_centre * from_centre) *
           scaled_bessel(0, t * centre / deviation);
  };
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
  double const from = std::max(0.0, centre - deviations * deviation), to = centre + deviations * deviation;
  return Kronrod::integrate(scattered, from, to, 20, 1e-8) / (distance * distance);
}

}  // namespace straytrace::wave
