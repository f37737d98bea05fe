// SPDX-License-Identifier: BSD-3-Clause
#include "step/tessellate.hpp"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <utility>

#include "step/chart.hpp"

namespace straytrace::step {

void prepare_triangles(TopoDS_Shape const& shape, double chord) {
  constexpr double turn = 0.5;  // rad between neighbours at most, so that small fillets stay round
  BRepMesh_IncrementalMesh(shape, chord / mm, false, turn, false);
}

void add_triangles(TopoDS_Face const& face, Triangles& out) {
  TopLoc_Location place;
  Handle(Poly_Triangulation) const mesh = BRep_Tool::Triangulation(face, place);
  if (mesh.IsNull()) return;
  ++out.faces;
  auto const first = std::uint32_t(out.vertices.size());
  for (int i = 1; i <= mesh->NbNodes(); ++i) {
    gp_Pnt const p = mesh->Node(i).Transformed(place.Transformation());
    out.vertices.push_back({p.X() * mm, p.Y() * mm, p.Z() * mm});
  }
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
    out.corners.push_back({first + std::uint32_t(a - 1), first + std::uint32_t(b - 1), first + std::uint32_t(c - 1)});
  }
}

}  // namespace straytrace::step
