// SPDX-License-Identifier: BSD-3-Clause
// The same part as triangles: bench_faces_to_stl STEP STL CHORD, chord and the numbers of the file in mm. How an
// engineer exports a mesh from CAD, by the mesher of OpenCASCADE.
#include <BRepMesh_IncrementalMesh.hxx>
#include <STEPControl_Reader.hxx>
#include <StlAPI_Writer.hxx>
#include <TopoDS_Shape.hxx>
#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: bench_faces_to_stl STEP STL CHORD_MM\n"), 2;
  STEPControl_Reader reader;
  if (reader.ReadFile(argv[1]) != IFSelect_RetDone) return std::fprintf(stderr, "cannot read %s\n", argv[1]), 1;
  reader.TransferRoots();
  TopoDS_Shape const shape = reader.OneShape();
  constexpr double angle = 0.5;  // rad, between neighbours; the default of CAD programs
  BRepMesh_IncrementalMesh(shape, std::atof(argv[3]), false, angle);
  StlAPI_Writer writer;
  writer.ASCIIMode() = false;
  if (!writer.Write(shape, argv[2])) return std::fprintf(stderr, "cannot write %s\n", argv[2]), 1;
}
