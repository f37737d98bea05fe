// SPDX-License-Identifier: BSD-3-Clause
// Light of the mirrors at round rims that the grid does not hold (docs/theory/wave.md, eq. W.22 and W.28).
#pragma once

#include <array>
#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/cavity.hpp"
#include "wave/round_trip.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {

// A field on a circle and its derivative along the radius, by harmonics exp(i m phi) of the azimuth:
// value[m + most], |m| <= most. Empty: none. sqrt(W)/m, sqrt(W)/m^2
struct RingField {
  std::vector<Complex> value, slope;

  int most() const { return value.empty() ? -1 : int(value.size() / 2); }
  Complex at(int m) const { return value[std::size_t(m + most())]; }
  Complex slope_at(int m) const { return slope[std::size_t(m + most())]; }
  double irradiance() const;  // mean around the circle
};

// eq. W.63: of a field on a circle about `centre`, for harmonics up to `most`, beyond which it has none.
RingField field_on_ring(Sampler const&, Vec3 centre, double radius, int most);
// What leaves a mirror on its outline, without its heights: of the field that arrives there. `count` points resolve it.
RingField leaving_outline(Sampler const& arriving, WaveMirror const&, double wavelength, int count);

// An edge that light passes on its way from a mirror to a rim.
struct PassedEdge {
  double distance = 0, radius = 0;  // from the mirror; of its opening, m
};
// eq. W.30: the field at the rim of radius a at a distance l, of light from a point of the mirror at `off_axis` on the
// side of the rim (< 0: on the other side), over that without the edges. Each is a straight half-plane.
Complex passed(std::vector<PassedEdge> const&, double wavelength, double off_axis, double a, double l);
// Of the irradiance of speckle from a spot of 1/e^2 radius w, in the mean.
double share_passed(std::vector<PassedEdge> const&, double wavelength, double w, double a, double l);

// eq. W.28: the wave that the outline of a mirror, of radius `outline` [m], sends to a circle of radius a at a distance
// l. Harmonics for which k a outline/l is not large are left out.
RingField diffracted(RingField const& leaving, double outline, double wavelength, double a, double l,
                     std::vector<PassedEdge> const& = {});

// eq. W.22: means over speckle of a round rim between two mirrors that scatter, and whose outlines diffract light. The
// offset d of the rim from the line between the spots plays no part while k a d (1/distance1 + 1/distance2) is small
// against sqrt(kappa). Lights of the two mirrors have random phases relative to each other in each harmonic.
struct SpeckledRim {
  double wavelength = 0, radius = 0;    // m
  double distance1 = 0, distance2 = 0;  // to the mirrors, m
  double spot1 = 0, spot2 = 0;          // 1/e^2 radii on the mirrors, m
  double brdf1 = 0, brdf2 = 0;          // 1/sr, at the angle of the rim
  RingField edge1{}, edge2{};           // waves at the rim: of the outlines, or all light that the grid holds
  double kappa() const;                 // 1; its root is the number of patches of speckle, up to sqrt(2 pi)
};
struct SpeckleMeans {
  double field = 0;         // <|s|^2>
  double transverse = 0;    // <|A_x|^2> = <|A_y|^2>, 1/m^2
  double longitudinal = 0;  // <|A_z|^2>, 1/m^2; with the slopes of speckle, which remain where distances are equal
};
SpeckleMeans speckle_means(SpeckledRim const&);

// Levers of edges whose light the grid does not hold, in the mean over random mirrors (docs/theory/wave.md, eq. W.22
// and W.28).

// Of one draw of the heights, what the grid holds of the light of mirrors 1 and 2 that meets edges beyond it.
struct LightOfMirrors {
  std::array<RingField, 2> outlines;              // leaving them on their outlines
  std::vector<std::array<RingField, 2>> at_rims;  // as arm.rims: on the rim (eq. W.63); empty: not held
};

// Collects it from the arrivals of one round trip.
class LightMeter {
 public:
  LightMeter(ArmCavity const&, WaveCavity const&);
  void operator()(Arrival const&);
  LightOfMirrors result() && { return std::move(light_); }

 private:
  ArmCavity const& arm_;
  WaveCavity const& cavity_;
  LightOfMirrors light_;
};

class ExpectedLevers {
 public:
  ExpectedLevers(World const&, ArmCavity const&);
  // Where the grid holds the light of one of the mirrors at the edge, and nothing of the mode itself is in it, with its
  // field there: it contains the waves of outlines and baffles and their shadows.
  SpeckleMeans operator()(std::size_t rim, LightOfMirrors const&) const;
  // The mean over draws of the heights.
  SpeckleMeans operator()(std::size_t rim, std::vector<LightOfMirrors> const&) const;

 private:
  SpeckledRim lit(std::size_t rim, LightOfMirrors const&) const;

  ArmCavity const& arm_;
  std::vector<MirrorBrdf> brdf_;
};

}  // namespace straytrace::wave
