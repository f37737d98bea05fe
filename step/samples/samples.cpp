// SPDX-License-Identifier: BSD-3-Clause
#include "step/samples/samples.hpp"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepLib.hxx>
#include <BRepOffsetAPI_MakePipeShell.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <Geom2d_Line.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Lin2d.hxx>
#include <numbers>

namespace straytrace::step {
namespace {

TopoDS_Shape moved(TopoDS_Shape const& shape, gp_Trsf const& where) {
  return BRepBuilderAPI_Transform(shape, where, true).Shape();
}
TopoDS_Shape rod(gp_Pnt from, gp_Dir along, double radius, double length) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(from, along), radius, length).Shape();
}
TopoDS_Shape block(double x, double y, double z) {  // about the origin, on z = 0
  return BRepPrimAPI_MakeBox(gp_Pnt(-x / 2, -y / 2, 0), x, y, z).Shape();
}
TopoDS_Shape cut(TopoDS_Shape const& from, TopoDS_Shape const& what) { return BRepAlgoAPI_Cut(from, what).Shape(); }

// A disc of 50 mm radius about x, hollow towards +x with the radius of curvature; its vertex is the origin.
TopoDS_Shape hollow_disc(double curvature_radius, double half_width) {
  TopoDS_Shape const disc = rod({-20, 0, 0}, {1, 0, 0}, half_width, 30);
  return cut(disc, BRepPrimAPI_MakeSphere(gp_Pnt(curvature_radius, 0, 0), curvature_radius).Shape());
}

}  // namespace

void add_solids(StepBuilder& b) {
  b.part("box", block(40, 30, 20), "#ff0000");
  b.part("rod", rod({100, 0, 0}, {0, 0, 1}, 10, 50), "#00ff00");
  b.part("cone", BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(200, 0, 0), gp_Dir(0, 0, 1)), 20, 5, 30).Shape(), "#0000ff");
  b.part("ball", BRepPrimAPI_MakeSphere(gp_Pnt(300, 0, 0), 15).Shape(), "#202020");
  b.part("ring", BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(400, 0, 0), gp_Dir(0, 0, 1)), 20, 5).Shape(), "#808080");
}

void add_nested(StepBuilder& b) {
  TDF_Label const dump = b.part("dump", block(10, 20, 30), "#202020");
  TDF_Label const tower = b.assembly("tower"), bench = b.assembly("bench");
  b.place(tower, dump, at(50, 0, 0));
  b.place(tower, dump, turned(0, 0, 100, 90, {0, 0, 1}));
  b.place(bench, tower, turned(1000, 0, 0, 90, {0, 0, 1}), "left tower");
  b.place(bench, b.part("plate", block(400, 300, 10)), at(0, 0, -10));
}

void add_mirror(StepBuilder& b) {
  TopoDS_Shape const mirror = hollow_disc(400, 50);
  b.part("mirror", mirror, "#c0c0c0");
}

void add_crossing(StepBuilder& b) {
  TopoDS_Shape body = block(100, 80, 60);
  body = cut(body, rod({0, 0, -10}, {0, 0, 1}, 12, 100));
  body = cut(body, rod({-80, 5, 20}, {1, 0.1, 0.2}, 8, 200));
  body = cut(body, BRepPrimAPI_MakeSphere(gp_Pnt(30, 30, 60), 25).Shape());
  body = cut(body, BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(-30, -20, 61), gp_Dir(0, 0.2, -1)), 15, 2, 30).Shape());
  body =
      BRepAlgoAPI_Fuse(body, BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(50, 0, 30), gp_Dir(1, 0, 0)), 15, 4).Shape()).Shape();
  b.part("block", body, "#808080");
  for (TopExp_Explorer f(body, TopAbs_FACE); f.More(); f.Next()) {
    b.paint(f.Current(), "#102030");
    break;
  }
}

void add_sheet(StepBuilder& b) {
  TColgp_Array2OfPnt points(1, 6, 1, 6);
  for (int i = 1; i <= 6; ++i)
    for (int k = 1; k <= 6; ++k)
      points.SetValue(i, k, gp_Pnt(20.0 * i - 70, 20.0 * k - 70, 40 + 5 * std::sin(1.1 * i) * std::cos(0.9 * k)));
  Handle(Geom_BSplineSurface) const wave = GeomAPI_PointsToBSplineSurface(points).Surface();
  TopoDS_Shape const tool =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wave, 1e-6).Face(), gp_Vec(0, 0, 100)).Shape();
  b.part("wavy", cut(block(60, 60, 80), tool), "#405060");
}

void add_lens(StepBuilder& b) {
  double const radius = 250, half = 4.5;
  TopoDS_Shape glass = rod({-20, 0, 0}, {1, 0, 0}, 25.4, 40);
  for (double const side : {-1.0, 1.0})
    glass =
        BRepAlgoAPI_Common(glass, BRepPrimAPI_MakeSphere(gp_Pnt(side * (radius - half), 0, 0), radius).Shape()).Shape();
  TDF_Label const stage = b.assembly("stage");
  b.place(stage, b.part("L1", glass, "#a0d0ff"), at(0, 0, 0));
  TopoDS_Shape const ring = cut(rod({-8, 0, 0}, {1, 0, 0}, 35, 16), rod({-20, 0, 0}, {1, 0, 0}, 25.5, 40));
  b.place(stage, b.part("holder", ring, "#202020"), at(0, 0, 0));
}

void add_thread(StepBuilder& b) {
  double const radius = 3, pitch = 1;
  int const turns = 8;
  Handle(Geom_CylindricalSurface) const wall = new Geom_CylindricalSurface(gp_Ax3(), radius);
  gp_Lin2d const line(gp_Pnt2d(0, 0), gp_Dir2d(2 * std::numbers::pi, pitch));
  double const length = turns * std::hypot(2 * std::numbers::pi, pitch);
  TopoDS_Edge helix = BRepBuilderAPI_MakeEdge(new Geom2d_Line(line), wall, 0, length).Edge();
  BRepLib::BuildCurves3d(helix);
  BRepBuilderAPI_MakePolygon tooth(gp_Pnt(radius - 0.1, 0, -0.4), gp_Pnt(radius - 0.1, 0, 0.4),
                                   gp_Pnt(radius + 0.55, 0, 0), true);
  BRepOffsetAPI_MakePipeShell sweep(BRepBuilderAPI_MakeWire(helix).Wire());
  sweep.SetMode(true);
  sweep.Add(tooth.Wire());
  sweep.Build();
  sweep.MakeSolid();
  TopoDS_Shape const bored =
      cut(moved(block(14, 40, 40), at(0, 0, -20)), rod({0, 0, 0}, {0, 0, 1}, radius, turns * pitch));
  b.part("nut", cut(bored, sweep.Shape()));
}

void add_wire(StepBuilder& b) {
  BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(10, 0, 0)).Edge());
  b.part("sketch", wire.Wire());
}

TDF_Label add_breadboard(StepBuilder& b, int columns, int rows) {
  double const pitch = 50;
  TopoDS_Compound holes;
  BRep_Builder().MakeCompound(holes);
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k) {
      double const x = (i - 0.5 * (columns - 1)) * pitch, y = (k - 0.5 * (rows - 1)) * pitch;
      BRep_Builder().Add(holes, rod({x, y, -13}, {0, 0, 1}, 3, 14));
    }
  return b.part("breadboard", cut(moved(block(columns * pitch, rows * pitch, 12.7), at(0, 0, -12.7)), holes),
                "#303030");
}

void add_bench(StepBuilder& b) {
  TDF_Label const board = add_breadboard(b, 8, 6);
  TopoDS_Shape const post = rod({0, 0, 0}, {0, 0, 1}, 12.7, 65);
  TopoDS_Shape const ring = cut(rod({-6, 0, 100}, {1, 0, 0}, 35, 18), rod({-10, 0, 100}, {1, 0, 0}, 25.5, 30));
  TopoDS_Shape const mount = BRepAlgoAPI_Fuse(post, ring).Shape();
  TopoDS_Shape const optic = moved(hollow_disc(600, 25.4), at(0, 0, 100));
  TopoDS_Shape dump = moved(block(60, 60, 60), at(0, 0, 70));
  dump = cut(dump, BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(-31, 0, 100), gp_Dir(1, 0, 0)), 25, 1, 55).Shape());
  TDF_Label const mirror = b.part("mirror", optic, "#c0c8d0"), holder = b.part("mount", mount, "#b08040");
  TDF_Label const black = b.part("dump", dump, "#202020"), foot = b.part("post", post, "#a0a0a0");
  TDF_Label const stage = b.assembly("telescope"), beam_end = b.assembly("end");
  b.place(stage, holder, at(0, 0, 0));
  b.place(stage, mirror, at(0, 0, 0));
  b.place(beam_end, foot, at(0, 0, 0));
  b.place(beam_end, black, at(0, 0, 0));
  TDF_Label const bench = b.assembly("bench");
  b.place(bench, board, at(0, 0, 0));
  b.place(bench, stage, turned(-175, 0, 0, 8, {0, 0, 1}), "M1");
  b.place(bench, stage, turned(150, 75, 0, 184.1, {0, 0, 1}), "M2");
  b.place(bench, beam_end, turned(150, -75, 0, 10, {0, 0, 1}), "dump_1");
  b.place(bench, beam_end, turned(-150, 100, 0, 190, {0, 0, 1}), "dump_2");
}

}  // namespace straytrace::step
