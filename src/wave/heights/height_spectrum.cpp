// SPDX-License-Identifier: BSD-3-Clause
// Heights from a spectrum, and the light that they scatter.
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/bessel.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "wave/heights/from_spectrum.hpp"

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

}  // namespace straytrace::wave
