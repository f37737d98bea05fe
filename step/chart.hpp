// SPDX-License-Identifier: BSD-3-Clause
// The carrier of a face in OpenCASCADE's millimetres, and its equal-area chart (src/geometry/cad/cad_face.hpp) in
// metres.
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <optional>

#include "step/cad_model.hpp"

namespace straytrace::step {

constexpr double mm = 1e-3;

class Chart {
 public:
  // Nothing for surfaces that are not planes, cylinders, cones, spheres or ring tori.
  static std::optional<Chart> of(BRepAdaptor_Surface const&);

  ChartPoint of_parameters(double u, double v) const;
  // The place of a point, in the turn that is nearest to `near`.
  ChartPoint of_point(gp_Pnt const&, ChartPoint near) const;
  gp_Vec normal(gp_Pnt const&) const;  // away from the axis, out of sphere or tube, z of a plane; not of unit length
  // Metres per unit of x and of y at a place.
  ChartPoint metric(ChartPoint) const;
  double area_per_unit() const;  // m^2
  Face face() const;             // the carrier alone

  Kind kind() const { return kind_; }
  gp_Pnt origin() const { return origin_; }
  gp_Vec z() const { return z_; }
  double radius() const { return radius_; }  // mm
  double second() const { return second_; }  // mm or rad

 private:
  void frame(gp_Ax3 const&, bool reversed);
  double tube_share(double w) const;  // turns around the tube to shares of its area, and back
  double tube_turn(double share) const;

  Kind kind_ = Kind::plane;
  gp_Pnt origin_;
  gp_Vec x_, y_, z_;
  double turning_ = 1;  // of u against the azimuth
  double radius_ = 0, second_ = 0, reference_ = 0, slope_ = 0;
};

}  // namespace straytrace::step
