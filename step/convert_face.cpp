// SPDX-License-Identifier: BSD-3-Clause
#include "step/convert_face.hpp"

#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>

#include "step/face_loops.hpp"
#include "step/natural_face.hpp"

namespace straytrace::step {
namespace {

// Whether the side outside the solid is against the normal of the carrier.
bool is_flipped(TopoDS_Face const& face, BRepAdaptor_Surface const& surface, Chart const& chart) {
  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
    TopoDS_Edge const edge = TopoDS::Edge(e.Current());
    double from = 0, to = 0;
    Handle(Geom2d_Curve) const flat = BRep_Tool::CurveOnSurface(edge, face, from, to);
    if (flat.IsNull() || BRep_Tool::Degenerated(edge)) continue;
    gp_Pnt2d const uv = flat->Value(0.5 * (from + to));
    gp_Pnt p;
    gp_Vec du, dv;
    surface.D1(uv.X(), uv.Y(), p, du, dv);
    double const along = du.Crossed(dv).Dot(chart.normal(p));
    if (along != 0) return (along < 0) != (face.Orientation() == TopAbs_REVERSED);
  }
  return face.Orientation() == TopAbs_REVERSED;
}

double area_in_metres(TopoDS_Face const& face) {
  GProp_GProps mass;
  BRepGProp::SurfaceProperties(face, mass);
  return std::fabs(mass.Mass()) * mm * mm;
}

}  // namespace

bool has_carrier(TopoDS_Face const& face) { return Chart::of(BRepAdaptor_Surface(face, false)).has_value(); }

std::optional<Face> convert_face(TopoDS_Face const& face, double tolerance,
                                 std::function<double(TopoDS_Edge const&)> const& room) {
  BRepAdaptor_Surface const surface(face, false);
  auto const chart = Chart::of(surface);
  if (!chart) return {};
  Face out = chart->face();
  out.flipped = is_flipped(face, surface, *chart);
  out.natural = set_natural(face, *chart, out);
  if (out.natural) return out;
  auto loops = loops_of(face, *chart, tolerance, room);
  if (!loops) return {};
  double const area = area_of(*loops) * chart->area_per_unit(), expected = area_in_metres(face);
  double const slack = 0.01 * expected + 1e-3 * tolerance;  // loops that do not surround the face
  if (!(std::fabs(area - expected) <= slack + 20 * tolerance * std::sqrt(expected))) return {};
  out.loops = std::move(*loops);
  return out;
}

}  // namespace straytrace::step
