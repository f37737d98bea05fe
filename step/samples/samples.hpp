// SPDX-License-Identifier: BSD-3-Clause
// Small STEP files, built with OpenCASCADE: for tests, and the bench of examples/.
#pragma once

#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>
#include <string>

namespace straytrace::step {

class StepBuilder {
 public:
  StepBuilder();
  // A part of the file, or of an assembly once it is placed; colour "#rrggbb", empty: none.
  TDF_Label part(std::string const& name, TopoDS_Shape const&, std::string const& colour = "");
  void paint(TopoDS_Shape const& face, std::string const& colour);  // of a part that is there
  TDF_Label assembly(std::string const& name);
  TDF_Label place(TDF_Label assembly, TDF_Label part, gp_Trsf const& where, std::string const& name = "");
  // Unit: "MM", "INCH", "M"; schema: "AP203", "AP214IS", "AP242DIS".
  bool write(std::string const& file, std::string const& unit = "MM", std::string const& schema = "AP214IS");

 private:
  Handle(TDocStd_Document) document_;
};

gp_Trsf at(double x, double y, double z);                                    // mm
gp_Trsf turned(double x, double y, double z, double degrees, gp_Dir about);  // turned, then moved

void add_solids(StepBuilder&);    // box, rod, cone, ball, ring, in five colours
void add_nested(StepBuilder&);    // an assembly in an assembly, a part used twice
void add_mirror(StepBuilder&);    // hollow sphere of 400 mm cut into a disc, optical axis x
void add_crossing(StepBuilder&);  // a closed block with oblique and crossing holes, painted on one face
void add_sheet(StepBuilder&);     // a B-spline sheet that closes a box of planes
void add_lens(StepBuilder&);      // R = 250 mm on both sides, 9 mm thick, about x at the origin, in a holder
void add_thread(StepBuilder&);    // a block whose bore has a cut thread: helical free surfaces
void add_wire(StepBuilder&);      // no face
void add_bench(StepBuilder&);     // the bench of examples/cad_bench.yaml
TDF_Label add_breadboard(StepBuilder&, int columns, int rows);  // holes 50 mm apart

}  // namespace straytrace::step
