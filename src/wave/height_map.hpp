// SPDX-License-Identifier: BSD-3-Clause
// Heights of mirror surfaces: measured, synthesised from a spectrum, and both together on a grid
// (docs/theory/wave.md, eq. W.17, W.18, W.20).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "wave/field.hpp"

namespace straytrace::wave {

// Heights towards the light that falls on the mirror, without its radius of curvature, on a rectangular array; NaN
// where nothing was measured.
struct HeightMap {
  std::vector<double> x, y;    // m, equidistant and ascending
  std::vector<double> height;  // m, [row of y * size of x + column]
};

// HDF5 with `x`, `y` and the height `A` or `height` [m], or a text matrix; errors name the file and the place.
HeightMap read_height_map(std::string const& path);

// Removed in the measure of the beam, weight |u|^2 = exp(-2 r^2/w^2).
struct LowOrders {
  double piston = 0;              // m
  double tilt_x = 0, tilt_y = 0;  // rad, slope of the surface
  double curvature = 0;           // 1/m, to add to 1/RoC of the scene when kept. Concave towards the light > 0
  double astigmatism0 = 0, astigmatism45 = 0;  // 1/m, half the difference of the curvatures
};
struct RemovedOrders {
  bool piston = true, tilt = true, curvature = false, astigmatism = false;
};
LowOrders fit_low_orders(HeightMap const&, double beam_radius);
void remove(HeightMap&, LowOrders const&, RemovedOrders const&);

// Fills holes inside the measured disc by iterated band-limited continuation; throws beyond 10 % of its area.
void fill_holes(HeightMap&);

// The content of the map below `largest_frequency` [1/m] on the grid; the edge beyond the measured disc tapers to zero
// over 5 %.
std::vector<double> resample(HeightMap const&, Grid const&, double largest_frequency);

// Heights with the two-sided spectrum S2(f) [m^4] between two frequencies [1/m]. Random numbers are addressed by seed
// and frequency, so that a finer grid of the same window keeps the coarse map.
std::vector<double> synthesise(std::function<double(double)> const& spectrum, Grid const&, double smallest_frequency,
                               double largest_frequency, std::uint64_t seed);

// eq. W.20 and 3.8: the spectrum of heights that scatters with the BRDF at a small angle, S2 = brdf lambda^4/(16 pi^2).
double height_spectrum(double brdf, double wavelength);

// eq. W.17: mean of |psi|^2 [1/m^2] at a distance from the axis after scattering by one mirror with a spot of 1/e^2
// radius w and a wavefront of radius of curvature `roc`; brdf(theta) [1/sr].
double mean_irradiance(std::function<double(double)> const& brdf, double beam_radius, double curvature, double distance,
                       double off_axis);

}  // namespace straytrace::wave
