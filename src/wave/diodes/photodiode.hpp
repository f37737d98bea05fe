// SPDX-License-Identifier: BSD-3-Clause
// Photodiodes on the screens around the openings of a cavity: the light of the mode that each receives.
#pragma once

#include <Eigen/Core>

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "wave/cavity.hpp"

namespace straytrace::wave {

enum class DiodeShape {
  square,  // one side towards the centre of its ring
  round,
  sector  // of a ring
};

struct Photodiode {
  std::string name;
  int plane = 0;  // as Arrival
  Travel travel = Travel::towards_mirror2;
  double x = 0, y = 0;             // centre of its ring, m from the axis
  double radius = 0, azimuth = 0;  // of its middle, from the centre of the ring; m, rad from x towards y
  DiodeShape shape = DiodeShape::square;
  double size = 0;   // side, diameter, or extent along the radius. m
  double width = 0;  // of a sector: extent in azimuth, rad

  double area() const;      // m^2
  double farthest() const;  // from the axis, m
};

// Points and weights [m^2] for integrals over the sensitive area. `finest`: length over which the integrand varies, m.
struct DiodePoint {
  double x = 0, y = 0, weight = 0;
};
std::vector<DiodePoint> points_of(Photodiode const&, double finest);

// The field on a diode, at the points of its area.
struct DiodeLight {
  std::vector<DiodePoint> points;
  std::vector<Complex> field;  // 1/m, over the root of the power of the mode
  double power() const;        // over that of the mode
};
// Collects the light of the diodes from the arrivals of one round trip; call for each arrival.
class DiodeMeter {
 public:
  // `finest`: length over which the field varies, m; 0: that of the grid.
  DiodeMeter(CavityWaves const&, std::vector<Photodiode> const&, double finest = 0);
  void operator()(Arrival const&);
  std::vector<DiodeLight> const& light() const { return light_; }  // in the order of the diodes

 private:
  std::vector<Photodiode> const& diodes_;
  std::vector<DiodeLight> light_;
};

// Light on photodiodes that mirrors with unknown heights scatter: its mean over the heights and its covariance
// (docs/theory/wave.md, eq. W.17, W.40 to W.43).

// A mirror as a source: the light of the mode on it, and the part of its BRDF whose heights are not known.
struct HaloMirror {
  double spot = 0;                     // 1/e^2 radius of the mode, m
  std::function<double(double)> brdf;  // 1/sr, at an angle from the specular direction
};

// The axis of the mode in a plane, and the field there.
struct ModeAxis {
  double x = 0, y = 0;              // m
  double slope_x = 0, slope_y = 0;  // rad
  Complex field;                    // 1/m
};
ModeAxis axis_of(CavityWaves const&, Arrival const&);

// A way of light from the mirror that scattered it to a plane, about the axis of the mode: x' = a x + b theta.
struct HaloPath {
  int mirror = 0;  // 0: mirror 1, 1: mirror 2
  double a = 1, b = 0, d = 1;
  // What it passes before: an opening of this radius, where it is at a x + b theta.
  struct Opening {
    double radius, a, b;
  };
  std::vector<Opening> openings;
};
// Those that reach a point at this distance from the axis, with up to ten reflections on the way.
std::vector<HaloPath> halo_paths(WaveCavity const&, int plane, Travel, double distance);

struct HaloStatistics {
  Eigen::VectorXd mean;        // over the power of the mode
  Eigen::MatrixXd covariance;  // of the power on the diodes, with that of the light that is not scattered
};
enum class HaloMoments : bool { mean, mean_and_covariance };
// `smooth`: the cavity with the known heights alone, and its mode. Diodes of different planes count as independent.
HaloStatistics halo_on(CavityWaves const& smooth, WaveMode const&, std::array<HaloMirror, 2> const&,
                       std::vector<Photodiode> const&, HaloMoments = HaloMoments::mean_and_covariance);

}  // namespace straytrace::wave
