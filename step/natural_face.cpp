// SPDX-License-Identifier: BSD-3-Clause
#include "step/natural_face.hpp"

#include <BRepAdaptor_Curve.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Circ.hxx>
#include <optional>

#include "base/math/constants.hpp"

namespace straytrace::step {
namespace {

constexpr double same = 1e-7;  // mm and rad: circles as near as this are one

struct Circle {
  gp_Pnt centre;
  gp_Vec axis;
  double radius, angle;  // mm, rad: of all arcs
};

// The full circles that bound a face; nothing when it has other edges.
std::optional<std::vector<Circle>> circles_of(TopoDS_Face const& face) {
  std::vector<Circle> all;
  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
    TopoDS_Edge const edge = TopoDS::Edge(e.Current());
    if (BRep_Tool::Degenerated(edge) || BRep_Tool::IsClosed(edge, face)) continue;
    BRepAdaptor_Curve const curve(edge);
    if (curve.GetType() != GeomAbs_Circle) return {};
    gp_Circ const c = curve.Circle();
    double const angle = std::fabs(curve.LastParameter() - curve.FirstParameter());
    auto const known = std::find_if(all.begin(), all.end(), [&](Circle const& k) {
      return k.centre.Distance(c.Location()) < same && std::fabs(k.radius - c.Radius()) < same;
    });
    if (known == all.end())
      all.push_back({c.Location(), gp_Vec(c.Axis().Direction()), c.Radius(), angle});
    else
      known->angle += angle;
  }
  for (Circle const& c : all)
    if (std::fabs(c.angle - 2 * pi) > same) return {};
  return all;
}

bool coaxial(std::vector<Circle> const& circles, gp_Pnt const& origin, gp_Vec const& axis) {
  return std::all_of(circles.begin(), circles.end(), [&](Circle const& c) {
    return c.axis.Crossed(axis).Magnitude() < 1e-9 && gp_Vec(origin, c.centre).Crossed(axis).Magnitude() < same;
  });
}

void set_frame(Face& f, gp_Pnt const& origin, gp_Vec const& z) {
  gp_Vec const other = std::fabs(z.X()) < 0.5 ? gp_Vec(1, 0, 0) : gp_Vec(0, 1, 0);
  gp_Vec const x = (other - z * other.Dot(z)).Normalized();
  f.origin = {origin.X() * mm, origin.Y() * mm, origin.Z() * mm};
  f.x = {x.X(), x.Y(), x.Z()};
  f.z = {z.X(), z.Y(), z.Z()};
}

bool set_sphere(TopoDS_Face const& face, Chart const& chart, std::vector<Circle> const& circles, Face& f) {
  double const r = chart.radius();
  f.within = {-r * mm, r * mm};
  if (circles.empty()) return true;
  gp_Vec const z = circles[0].axis;
  if (circles.size() > 2 || !coaxial(circles, chart.origin(), z)) return false;
  set_frame(f, chart.origin(), z);
  auto const height = [&](Circle const& c) { return gp_Vec(chart.origin(), c.centre).Dot(z) * mm; };
  if (circles.size() == 2) {
    f.within = {std::min(height(circles[0]), height(circles[1])), std::max(height(circles[0]), height(circles[1]))};
    return true;
  }
  GProp_GProps mass;  // on which side of the circle: the centre of mass of a cap lies half way to its pole
  BRepGProp::SurfaceProperties(face, mass);
  double const middle = gp_Vec(chart.origin(), mass.CentreOfMass()).Dot(z) * mm, edge = height(circles[0]);
  f.within = middle > edge ? std::array{edge, r * mm} : std::array{-r * mm, edge};
  return true;
}

}  // namespace

bool set_natural(TopoDS_Face const& face, Chart const& chart, Face& f) {
  auto const found = circles_of(face);
  if (!found) return false;
  std::vector<Circle> const& circles = *found;
  if (chart.kind() == Kind::sphere) return set_sphere(face, chart, circles, f);
  if (chart.kind() == Kind::torus) return circles.empty();
  if (circles.empty() || circles.size() > 2) return false;
  std::array<double, 2> radii = {0, circles[0].radius * mm};
  if (circles.size() == 2) radii[0] = circles[1].radius * mm;
  std::sort(radii.begin(), radii.end());
  if (chart.kind() == Kind::plane) {
    if (!coaxial(circles, circles[0].centre, chart.z())) return false;
    set_frame(f, circles[0].centre, chart.z());
    f.within = radii;
    return true;
  }
  if (!coaxial(circles, chart.origin(), chart.z())) return false;
  if (chart.kind() == Kind::cone) {
    f.within = radii;
    return true;
  }
  if (circles.size() != 2) return false;
  double const one = gp_Vec(chart.origin(), circles[0].centre).Dot(chart.z()) * mm;
  double const two = gp_Vec(chart.origin(), circles[1].centre).Dot(chart.z()) * mm;
  f.within = {std::min(one, two), std::max(one, two)};
  return true;
}

}  // namespace straytrace::step
