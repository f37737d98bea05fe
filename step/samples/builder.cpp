// SPDX-License-Identifier: BSD-3-Clause
#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Ax1.hxx>
#include <numbers>

#include "step/samples/samples.hpp"

namespace straytrace::step {
namespace {

Quantity_Color colour_in(std::string const& text) {
  auto const byte = [&](std::size_t at) { return std::stoi(text.substr(at, 2), nullptr, 16) / 255.0; };
  return {byte(1), byte(3), byte(5), Quantity_TOC_sRGB};
}

}  // namespace

StepBuilder::StepBuilder() {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document_);
}

TDF_Label StepBuilder::part(std::string const& name, TopoDS_Shape const& shape, std::string const& colour) {
  TDF_Label const label = XCAFDoc_DocumentTool::ShapeTool(document_->Main())->AddShape(shape, false);
  TDataStd_Name::Set(label, name.c_str());
  if (!colour.empty())
    XCAFDoc_DocumentTool::ColorTool(document_->Main())->SetColor(label, colour_in(colour), XCAFDoc_ColorGen);
  return label;
}

void StepBuilder::paint(TopoDS_Shape const& face, std::string const& colour) {
  XCAFDoc_DocumentTool::ColorTool(document_->Main())->SetColor(face, colour_in(colour), XCAFDoc_ColorSurf);
}

TDF_Label StepBuilder::assembly(std::string const& name) {
  TDF_Label const label = XCAFDoc_DocumentTool::ShapeTool(document_->Main())->NewShape();
  TDataStd_Name::Set(label, name.c_str());
  return label;
}

TDF_Label StepBuilder::place(TDF_Label assembly, TDF_Label part, gp_Trsf const& where, std::string const& name) {
  TDF_Label const label =
      XCAFDoc_DocumentTool::ShapeTool(document_->Main())->AddComponent(assembly, part, TopLoc_Location(where));
  if (!name.empty()) TDataStd_Name::Set(label, name.c_str());
  return label;
}

bool StepBuilder::write(std::string const& file, std::string const& unit, std::string const& schema) {
  XCAFDoc_DocumentTool::ShapeTool(document_->Main())->UpdateAssemblies();
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", unit.c_str());
  Interface_Static::SetCVal("write.step.schema", schema.c_str());
  STEPCAFControl_Writer writer;
  if (!writer.Transfer(document_, STEPControl_AsIs)) return false;
  APIHeaderSection_MakeHeader header(writer.ChangeWriter().Model());
  header.SetTimeStamp(new TCollection_HAsciiString("2026-01-01T00:00:00"));  // the same bytes every time
  header.SetName(new TCollection_HAsciiString("sample"));
  return writer.Write(file.c_str()) == IFSelect_RetDone;
}

gp_Trsf at(double x, double y, double z) {
  gp_Trsf t;
  t.SetTranslation(gp_Vec(x, y, z));
  return t;
}

gp_Trsf turned(double x, double y, double z, double degrees, gp_Dir about) {
  gp_Trsf t;
  t.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), about), degrees * std::numbers::pi / 180);
  return at(x, y, z) * t;
}

}  // namespace straytrace::step
