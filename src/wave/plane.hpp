// SPDX-License-Identifier: BSD-3-Clause
// What a field meets on its way: openings, mirrors and the free space between planes (docs/theory/wave.md, eq. W.1 to
// W.7).
#pragma once

#include <vector>

#include "wave/field.hpp"
#include "wave/lines/line_kernels.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {

struct RoundHole {
  double radius = 0;    // m
  double x = 0, y = 0;  // of its centre, m
  double cosine = 1;    // of the angle by which its plane is turned about y: seen along the axis, its half axis along x
                        // is radius * cosine
  bool operator==(RoundHole const&) const = default;
};

// Transmission of amplitude of an opening: its Fourier series, cut at Nyquist's frequency, so that it overshoots by a
// few percent next to the rim (eq. W.7).
class Mask {
 public:
  Mask(RoundHole const&, Grid const&, Transform const&);
  // Sum of |values|^2 beyond the rim, exact for a field below Nyquist's frequency over sqrt(2): the power on the
  // screen, without the ripple of the series.
  double clipped(Field const&) const;
  std::vector<double> const& values() const { return values_; }
  // Rows and columns about the axis beyond which nothing passes: the opening and the reach of the ripple, which changes
  // losses by less than 1e-6 of themselves.
  int rows() const { return rows_; }
  int columns() const { return columns_; }

 private:
  std::vector<double> values_;
  int rows_, columns_;
};

// A mirror, seen by the light that falls on it. Left out: its reflectivity, which multiplies the eigenvalue.
struct WaveMirror {
  double curvature = 0;           // 1/RoC, positive when concave. 1/m
  RoundHole outline;              // clear aperture; its cosine is that of the angle of incidence (eq. W.55)
  double tilt_x = 0, tilt_y = 0;  // turns the reflected beam by twice this towards +x, +y. rad
  std::vector<double> height;     // towards the light, without the curvature, on the grid across it; empty: none. m
  double scattered = 0;           // power that it scatters beyond the crossover angle (eq. W.2)
  double lit = 0;                 // m, distance from the axis up to which light around it is wanted
};
// eq. W.1, W.55: its factor on the grid. `wavefront`: curvature of the wave that the grid follows to it less that of
// the wave from it (eq. W.54), 1/m.
Field reflection(WaveMirror const&, Mask const& outline, double wavelength, Grid const&, double wavefront = 0);

// Free space with a smooth limit of angles: 1 below `keep`, 0 from `cut` on (eq. W.3 to W.6). The limit lies some
// widths sqrt(lambda/length) of Fresnel diffraction beyond the largest angle between points that matter at both ends.
class Leg {
 public:
  // `reach`: sum of the radii of the two planes up to which light matters, m. InputError if the window is too
  // narrow for it.
  Leg(double length, double reach, double wavelength, Grid const&);

  double length() const { return length_; }
  double cut() const { return cut_; }       // rad
  int columns() const { return columns_; }  // for Transform: all frequencies below `cut`
  LegTables tables() const;                 // as long as the leg exists
  void apply(Field& spectrum, int threads = 1) const;

 private:
  double length_, keep_, cut_;
  double angle_step_;  // rad per element of the spectrum
  double quartic_;     // of the exponent beyond the paraxial one, per rad^4; 0 where it does not matter
  int columns_;
  std::vector<double> paraxial_;  // cos, sin by frequency
  std::vector<double> taper_;     // w_j of eq. W.4, of the angle squared between keep^2 and cut^2
};

}  // namespace straytrace::wave
