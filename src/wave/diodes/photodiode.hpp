// SPDX-License-Identifier: BSD-3-Clause
// Photodiodes on the screens around the openings of a cavity: the light of the mode that each receives.
#pragma once

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

}  // namespace straytrace::wave
