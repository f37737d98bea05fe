// SPDX-License-Identifier: BSD-3-Clause
#include "step/chart.hpp"

#include <algorithm>
#include <cmath>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

#include "base/math/constants.hpp"

namespace straytrace::step {
namespace {

double nearest_turn(double x, double near) { return x + std::round(near - x); }
Triple triple(gp_Vec const& v) { return {v.X(), v.Y(), v.Z()}; }

}  // namespace

void Chart::frame(gp_Ax3 const& axes, bool reversed) {
  origin_ = axes.Location();
  x_ = gp_Vec(axes.XDirection());
  z_ = gp_Vec(axes.Direction()) * (reversed ? -1 : 1);
  y_ = z_.Crossed(x_);
  turning_ = axes.Direct() != reversed ? 1 : -1;
}

double Chart::tube_share(double w) const { return w + second_ / radius_ * std::sin(2 * pi * w) / (2 * pi); }

double Chart::tube_turn(double share) const {  // bisection: the share rises with w
  double low = share - 0.2, high = share + 0.2;
  for (int i = 0; i < 50; ++i) {
    double const middle = 0.5 * (low + high);
    (tube_share(middle) < share ? low : high) = middle;
  }
  return low;
}

std::optional<Chart> Chart::of(BRepAdaptor_Surface const& surface) {
  Chart c;
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      c.frame(surface.Plane().Position(), false);
      return c;
    case GeomAbs_Cylinder:
      c.kind_ = Kind::cylinder;
      c.frame(surface.Cylinder().Position(), false);
      c.radius_ = surface.Cylinder().Radius();
      return c;
    case GeomAbs_Cone: {
      gp_Cone const cone = surface.Cone();
      c.kind_ = Kind::cone;
      c.frame(cone.Position(), cone.SemiAngle() < 0);
      c.origin_ = cone.Apex();
      c.second_ = std::fabs(cone.SemiAngle());
      c.reference_ = cone.RefRadius();
      c.slope_ = std::sin(cone.SemiAngle());
      return c;
    }
    case GeomAbs_Sphere:
      c.kind_ = Kind::sphere;
      c.frame(surface.Sphere().Position(), false);
      c.radius_ = surface.Sphere().Radius();
      return c;
    case GeomAbs_Torus:
      c.kind_ = Kind::torus;
      c.frame(surface.Torus().Position(), false);
      c.radius_ = surface.Torus().MajorRadius();
      c.second_ = surface.Torus().MinorRadius();
      if (!(c.second_ < c.radius_)) return {};
      return c;
    default:
      return {};
  }
}

ChartPoint Chart::of_parameters(double u, double v) const {
  double const turns = turning_ * u / (2 * pi);
  switch (kind_) {
    case Kind::plane:
      return {u * mm, turning_ * v * mm};
    case Kind::cylinder:
      return {turns, v * mm};
    case Kind::cone:
      return {turns, std::pow((reference_ + v * slope_) * mm, 2)};
    case Kind::sphere:
      return {turns, radius_ * std::sin(v) * mm};
    case Kind::torus:
      return {turns, tube_share(v / (2 * pi))};
  }
  return {};
}

ChartPoint Chart::of_point(gp_Pnt const& p, ChartPoint near) const {
  gp_Vec const o(origin_, p);
  double const x = o.Dot(x_), y = o.Dot(y_), z = o.Dot(z_), rho = std::hypot(x, y);
  if (kind_ == Kind::plane) return {x * mm, y * mm};
  double const scale = std::max(rho, std::fabs(z));
  double const turns = rho > 1e-9 * scale ? nearest_turn(std::atan2(y, x) / (2 * pi), near.x) : near.x;
  switch (kind_) {
    case Kind::cylinder:
      return {turns, z * mm};
    case Kind::cone:
      return {turns, rho * rho * mm * mm};
    case Kind::torus:
      return {turns, nearest_turn(tube_share(std::atan2(z, rho - radius_) / (2 * pi)), near.y)};
    default:
      return {turns, radius_ * z / std::hypot(rho, z) * mm};
  }
}

gp_Vec Chart::normal(gp_Pnt const& p) const {
  gp_Vec const o(origin_, p), across = o - z_ * o.Dot(z_);
  switch (kind_) {
    case Kind::plane:
      return z_;
    case Kind::cylinder:
      return across;
    case Kind::cone:
      return across.Normalized() * std::cos(second_) - z_ * std::sin(second_);
    case Kind::sphere:
      return o;
    case Kind::torus:
      return o - across.Normalized() * radius_;
  }
  return z_;
}

ChartPoint Chart::metric(ChartPoint p) const {
  double const r = radius_ * mm;
  switch (kind_) {
    case Kind::plane:
      return {1, 1};
    case Kind::cylinder:
      return {2 * pi * r, 1};
    case Kind::cone: {
      double const rho = std::sqrt(std::max(p.y, 1e-16));
      return {2 * pi * rho, 1 / (2 * rho * std::sin(second_))};
    }
    case Kind::sphere: {
      double const rho = std::sqrt(std::max((r - p.y) * (r + p.y), 1e-12 * r * r));
      return {2 * pi * rho, r / rho};
    }
    case Kind::torus: {
      double const tube = second_ * mm, cosine = std::cos(2 * pi * tube_turn(p.y));
      return {2 * pi * (r + tube * cosine), 2 * pi * tube / (1 + second_ / radius_ * cosine)};
    }
  }
  return {1, 1};
}

double Chart::area_per_unit() const {
  double const r = radius_ * mm;
  switch (kind_) {
    case Kind::plane:
      return 1;
    case Kind::cone:
      return pi / std::sin(second_);
    case Kind::torus:
      return 4 * pi * pi * r * second_ * mm;
    default:
      return 2 * pi * r;
  }
}

Face Chart::face() const {
  Face f;
  f.kind = kind_;
  f.origin = {origin_.X() * mm, origin_.Y() * mm, origin_.Z() * mm};
  f.x = triple(x_);
  f.z = triple(z_);
  f.radius = radius_ * mm;
  f.second = kind_ == Kind::cone ? second_ : second_ * mm;
  return f;
}

}  // namespace straytrace::step
