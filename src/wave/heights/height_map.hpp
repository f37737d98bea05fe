// SPDX-License-Identifier: BSD-3-Clause
// Heights of mirror surfaces: measured, synthesised from a spectrum, and both together on a grid
// (docs/theory/wave.md, eq. W.17, W.18, W.20, W.55).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "wave/field.hpp"
#include "world/model/wave_settings.hpp"

namespace straytrace::wave {

// Heights towards the light that falls on the mirror, without its radius of curvature, on a rectangular array; NaN
// where nothing was measured. Both pitches are above zero.
struct HeightMap {
  std::vector<double> x, y;    // m, equidistant and ascending
  std::vector<double> height;  // m, [row of y * size of x + column]

  double pitch_x() const { return (x.back() - x.front()) / double(x.size() - 1); }  // m
  double pitch_y() const { return (y.back() - y.front()) / double(y.size() - 1); }  // m
  double nyquist(double cosine = 1) const;  // of the larger pitch across light that comes at this cosine, 1/m
};

// The mode where it falls on a mirror, which takes the point (x, y) across the beam for (x/cosine, y) beside `centre`
// (eq. W.55).
struct LightOnMirror {
  std::array<double, 2> radius{};  // 1/e^2 radii across the beam, along x, in the plane of incidence, and y; m
  double cosine = 1;               // of the angle of incidence
  std::array<double, 2> centre{};  // of the spot in the axes of the heights, m

  std::array<double, 2> on_mirror() const { return {radius[0] / cosine, radius[1]}; }  // radii there, m
};

// The map in the bytes of a file; errors name `file` and the place. Three kinds of files:
//   HDF5 with the lists `x` and `y` and the heights `A` or `height` [y][x]; in m without the attribute `unit`;
//   a text with the columns x, y and height and their units, in any order of the rows: "x [mm], y [mm], height [nm]";
//   a text of a matrix below "# pixel: 0.4 mm" and "# unit: nm", its first row at the largest y, the axis in its
//   middle.
HeightMap height_map_of(std::string const& bytes, std::string const& file);

// The largest disc about the middle of the measured points that they span.
struct MeasuredDisc {
  double x = 0, y = 0, radius = 0;  // m
};
MeasuredDisc measured_disc(HeightMap const&);

// The best fit in the measure of a beam, weight |u|^2 = exp(-2 r^2/w^2), about the centre of its spot.
struct LowOrders {
  double piston = 0;              // m
  double tilt_x = 0, tilt_y = 0;  // rad, slope of the surface
  double curvature = 0;           // 1/m, to add to 1/RoC of the scene when kept. Concave towards the light > 0
  double astigmatism0 = 0, astigmatism45 = 0;  // 1/m, half the difference of the curvatures
};
struct RemovedOrders {
  bool piston = true, tilt = true, curvature = false, astigmatism = false;
};
LowOrders fit_low_orders(HeightMap const&, LightOnMirror const&);
inline LowOrders fit_low_orders(HeightMap const& map, double beam_radius) {
  return fit_low_orders(map, LightOnMirror{{beam_radius, beam_radius}});
}
void remove(HeightMap&, LowOrders const&, RemovedOrders const&, std::array<double, 2> centre = {});

// Throws InputError if holes make up more than 10 % of the measured disc.
void refuse_large_holes(HeightMap const&);
// Fills holes inside the measured disc by iterated band-limited continuation and returns their share of it.
double fill_holes(HeightMap&);

// The map of a mirror that states a file, without the low orders that the scene removes. InputError where it cannot be
// used: of the file, or without one, of the mirror.
HeightMap measured_map(WaveSettings::Mirror const&, LightOnMirror const&, double wavelength);

// The content of a map without holes up to `largest_frequency` [1/m] or its own Nyquist frequency, on the grid across
// the light; of that, only cosine and centre matter. The heights taper to zero over the outer 5 % of the measured disc.
std::vector<double> resample(HeightMap const&, Grid const&, double largest_frequency, LightOnMirror const& = {});

// The periods of a frequency [1/m] across the window, and rounding: where one band of frequencies of the grid ends and
// the next begins.
inline double periods_across(double frequency, Grid const& grid) { return frequency * grid.window * (1 + 1e-12); }

// Heights with the two-sided spectrum S2(f) [m^4] above one frequency and up to another [1/m]. Random numbers are
// addressed by seed, mirror and frequency, so that a finer grid of the same window keeps the coarse map.
std::vector<double> synthesise(std::function<double(double)> const& spectrum, Grid const&, double smallest_frequency,
                               double largest_frequency, std::uint64_t seed, std::uint32_t mirror);

// Moves heights on a grid, of which none or all are there, by a distance along x and y [m]; around the window.
void shift(std::vector<double>& heights, Grid const&, std::array<double, 2> distance);

// eq. W.20 and 3.8: the spectrum of heights that scatters with the BRDF at a small angle, S2 = brdf lambda^4/(16 pi^2).
double height_spectrum(double brdf, double wavelength);

// eq. W.17: mean of |psi|^2 [1/m^2] at a distance from the axis after scattering by one mirror with a spot of 1/e^2
// radius w and a wavefront of curvature 1/RoC, to 1e-6; brdf(theta >= 0) [1/sr]. Without the beam itself, and of the
// light at angles from `smallest` on.
double mean_irradiance(std::function<double(double)> const& brdf, double beam_radius, double curvature, double distance,
                       double off_axis, double smallest = 0);

}  // namespace straytrace::wave
