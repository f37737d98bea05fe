// SPDX-License-Identifier: BSD-3-Clause
#include "step/read_step.hpp"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <map>

#include "base/files/read_write.hpp"
#include "step/assembly.hpp"
#include "step/chart.hpp"
#include "step/convert_face.hpp"
#include "step/tessellate.hpp"

namespace straytrace::step {
namespace {

// The schema that the header names.
std::string look_at_text(std::string const& file) {
  auto const [text, why] = bytes_of_file(file);
  std::string const again = "export it again as STEP AP203, AP214 or AP242 (ISO 10303-21, not packed)";
  if (!why.empty()) throw Refused{fmt::format("the file cannot be read: {}", why), "check the name and the folder"};
  std::size_t const start = text.find("ISO-10303-21");
  if (start == text.npos || start > 4096)
    throw Refused{"this is not a STEP file: it does not begin with ISO-10303-21", again};
  if (text.find("END-ISO-10303-21", start + 1) == text.npos)
    throw Refused{"the file is cut off: its last line 'END-ISO-10303-21;' is missing", "copy or export it again"};
  std::size_t const schema = text.find("FILE_SCHEMA"), open = text.find('\'', schema);
  if (schema == text.npos || open == text.npos) throw Refused{"the header names no FILE_SCHEMA", again};
  std::string name = text.substr(open + 1, std::min(text.find_first_of("' {", open + 1) - open - 1, std::size_t{60}));
  for (char const* known : {"CONFIG_CONTROL_DESIGN", "AUTOMOTIVE_DESIGN", "AP203", "AP214", "AP242"})
    if (name.find(known) != name.npos) return name;
  throw Refused{fmt::format("the schema of the file is '{}'", name), again};
}

double metres_of(std::string name) {
  static std::map<std::string, double> const known = {
      {"millimetre", 1e-3}, {"metre", 1},          {"centimetre", 1e-2}, {"decimetre", 0.1}, {"micrometre", 1e-6},
      {"kilometre", 1e3},   {"inch", 0.0254},      {"foot", 0.3048},     {"mile", 1609.344}, {"nanometre", 1e-9},
      {"millimeter", 1e-3}, {"meter", 1},          {"centimeter", 1e-2}, {"mm", 1e-3},       {"m", 1},
      {"cm", 1e-2},         {"in", 0.0254},        {"ft", 0.3048},       {"yard", 0.9144},   {"mil", 2.54e-5},
      {"thou", 2.54e-5},    {"microinch", 25.4e-9}};
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  auto const hit = known.find(name);
  return hit == known.end() ? 0 : hit->second;
}

void read_units(STEPControl_Reader& reader, Model& model) {
  TColStd_SequenceOfAsciiString lengths, angles, solid;
  reader.FileUnits(lengths, angles, solid);
  model.unit_stated = !lengths.IsEmpty();
  model.unit = model.unit_stated ? metres_of(lengths.First().ToCString()) : 1e-3;
  for (TCollection_AsciiString const& name : lengths)
    if (metres_of(name.ToCString()) != model.unit) model.unit = 0;
}

void note_errors(Handle(Interface_InterfaceModel) const& entities, Model& model) {
  std::size_t bad = 0;
  std::string first;
  for (int i = 1; i <= entities->NbEntities(); ++i) {
    if (!entities->IsErrorEntity(i) && !entities->IsUnknownEntity(i)) continue;
    if (bad++ == 0) first = entities->StringLabel(entities->Value(i))->ToCString();
  }
  if (bad > 0)
    model.notes.push_back({fmt::format("{} entities of the file cannot be read, the first is {}", bad, first),
                           "look whether parts are missing; if so, export it again"});
}

class Converter {
 public:
  Converter(Settings const& settings, Model& model) : settings_(settings), model_(model) {}

  void add(PlacedFaces const& placed) {
    TopTools_IndexedDataMapOfShapeListOfShape faces_at;
    TopExp::MapShapesAndAncestors(placed.shape, TopAbs_EDGE, TopAbs_FACE, faces_at);
    auto const room = [&](TopoDS_Edge const& edge) {  // beyond it lie triangles, whose edges are chords
      if (!faces_at.Contains(edge)) return 0.0;
      for (TopoDS_Shape const& face : faces_at.FindFromKey(edge))
        if (!has_carrier(TopoDS::Face(face))) return settings_.chord;
      return 0.0;
    };
    bool meshed = false;
    for (std::size_t i = 0; i < placed.faces.size(); ++i) {
      TopoDS_Face const face = TopoDS::Face(placed.faces[i]);
      Part& part = part_of(placed.name, placed.colours[i]);
      if (auto exact = convert_face(face, settings_.tolerance, room)) {
        part.faces.push_back(std::move(*exact));
        continue;
      }
      odd_ += has_carrier(face);
      if (!meshed) prepare_triangles(placed.shape, settings_.chord);
      meshed = true;
      add_triangles(face, part.triangles);
    }
    BRepBndLib::AddOptimal(placed.shape, box_, false, false);
  }
  void finish() {
    std::erase_if(model_.parts, [](Part const& p) { return p.faces.empty() && p.triangles.corners.empty(); });
    if (model_.parts.empty())
      throw Refused{"the file holds no faces", "export solids or surfaces, not only sketches, wires or notes"};
    double a[6] = {};
    box_.Get(a[0], a[1], a[2], a[3], a[4], a[5]);
    for (std::size_t i = 0; i < 3; ++i) {
      model_.lower[i] = a[i] * mm;
      model_.upper[i] = a[3 + i] * mm;
    }
    if (odd_ > 0)
      model_.notes.push_back({fmt::format("the edges of {} plane, cylinder, cone, sphere or torus faces do not join to "
                                          "loops around them: they became triangles",
                                          odd_),
                              "repair these faces in the CAD program where mirrors are among them"});
  }

 private:
  Part& part_of(std::string const& name, std::string const& colour) {
    auto const [slot, fresh] = number_.try_emplace({name, colour}, model_.parts.size());
    if (fresh) model_.parts.push_back({name, colour, {}, {}});
    return model_.parts[slot->second];
  }
  Settings settings_;
  Model& model_;
  Bnd_Box box_;
  std::size_t odd_ = 0;
  std::map<std::pair<std::string, std::string>, std::size_t> number_;
};

}  // namespace

Model read_step(std::string const& file, Settings const& settings) {
  Model model;
  model.schema = look_at_text(file);
  Message::DefaultMessenger()->ChangePrinters().Clear();  // OpenCASCADE talks on the standard output
  try {
    STEPCAFControl_Reader reader;
    if (reader.ReadFile(file.c_str()) != IFSelect_RetDone)
      throw Refused{"the file is damaged: its entities cannot be read", "copy or export it again"};
    read_units(reader.ChangeReader(), model);
    note_errors(reader.Reader().WS()->Model(), model);
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    if (!reader.Transfer(document)) throw Refused{"no shape of the file can be made", "copy or export it again"};
    Converter converter(settings, model);
    for_each_part(document, [&](PlacedFaces const& part) { converter.add(part); });
    converter.finish();
  } catch (Standard_Failure const& failure) {
    throw Refused{fmt::format("the geometry cannot be understood ({})", failure.GetMessageString()),
                  "check the parts in the CAD program and export them again"};
  }
  return model;
}

}  // namespace straytrace::step
