// SPDX-License-Identifier: BSD-3-Clause
#include "step/assembly.hpp"

#include <fmt/format.h>

#include <BRepTools_History.hxx>
#include <BRep_Builder.hxx>
#include <Quantity_Color.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "step/convert_face.hpp"

namespace straytrace::step {
namespace {

struct SameShape {
  std::size_t operator()(TopoDS_Shape const& s) const { return std::size_t(s.HashCode(INT_MAX)); }
  bool operator()(TopoDS_Shape const& a, TopoDS_Shape const& b) const { return a.IsSame(b); }
};
using FaceColours = std::unordered_map<TopoDS_Shape, std::string, SameShape, SameShape>;

std::string name_of(TDF_Label const& label) {
  Handle(TDataStd_Name) given;
  if (!label.FindAttribute(TDataStd_Name::GetID(), given)) return "";
  TCollection_ExtendedString const& text = given->Get();
  std::string out(std::size_t(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter to = out.data();
  out.resize(std::size_t(text.ToUTF8CString(to)));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '/') c = '_';
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

// Names that a translator made up for an occurrence: "NAUO12", "12", "=>[0:1:1:2]".
bool made_up(std::string const& name) {
  std::string_view rest = name;
  if (rest.starts_with("NAUO")) rest.remove_prefix(4);
  return rest.starts_with("=>[") || rest.find_first_not_of("0123456789") == rest.npos;
}

std::string colour_of(Handle(XCAFDoc_ColorTool) const& colours, TDF_Label const& label) {
  Quantity_Color colour;
  for (XCAFDoc_ColorType const type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
    if (colours->GetColor(label, type, colour)) {
      double r = 0, g = 0, b = 0;
      colour.Values(r, g, b, Quantity_TOC_sRGB);
      auto const byte = [](double x) { return int(std::lround(255 * std::clamp(x, 0.0, 1.0))); };
      return fmt::format("#{:02x}{:02x}{:02x}", byte(r), byte(g), byte(b));
    }
  return "";
}

// A shape as the file defines it once, before it is placed.
struct Product {
  TopoDS_Shape shape;
  std::vector<TopoDS_Shape> faces;
  std::vector<std::string> colours;  // of faces that have their own
  std::string colour;                // of the rest
};

using FacesAtEdge = TopTools_IndexedDataMapOfShapeListOfShape;

// Faces that are free surfaces, or share an edge with one.
TopTools_MapOfShape beside_free_surfaces(FacesAtEdge const& faces_at) {
  TopTools_MapOfShape out;
  for (int i = 1; i <= faces_at.Extent(); ++i) {
    auto const& faces = faces_at(i);
    bool const exact = std::all_of(faces.begin(), faces.end(),
                                   [](TopoDS_Shape const& face) { return has_carrier(TopoDS::Face(face)); });
    if (!exact)
      for (TopoDS_Shape const& face : faces) out.Add(face);
  }
  return out;
}

TopoDS_Compound compound(std::vector<TopoDS_Shape> const& shapes) {
  TopoDS_Compound out;
  BRep_Builder const build;
  build.MakeCompound(out);
  for (TopoDS_Shape const& shape : shapes) build.Add(out, shape);
  return out;
}

// Joins faces that lie on one surface and have one colour: a cylinder in two halves becomes one. Faces next to free
// surfaces stay as they are, because OpenCASCADE does not come to an end with those of a thread.
void join_faces(Product& p, FaceColours& own) {
  FacesAtEdge faces_at;
  TopExp::MapShapesAndAncestors(p.shape, TopAbs_EDGE, TopAbs_FACE, faces_at);
  TopTools_MapOfShape const apart = beside_free_surfaces(faces_at);
  std::vector<TopoDS_Shape> joinable, rest;
  for (TopExp_Explorer f(p.shape, TopAbs_FACE); f.More(); f.Next())
    (apart.Contains(f.Current()) ? rest : joinable).push_back(f.Current());
  TopTools_MapOfShape keep;
  for (int i = 1; i <= faces_at.Extent(); ++i) {
    std::set<std::string> seen;
    bool border = false;
    for (TopoDS_Shape const& face : faces_at(i)) {
      seen.insert(own.contains(face) ? own[face] : "");
      border = border || apart.Contains(face);
    }
    if (border || seen.size() > 1) keep.Add(faces_at.FindKey(i));
  }
  ShapeUpgrade_UnifySameDomain unify(rest.empty() ? p.shape : compound(joinable), true, true, false);
  unify.KeepShapes(keep);
  unify.Build();
  FaceColours joined;
  for (auto const& [face, colour] : own) {
    TopTools_ListOfShape const& now = unify.History()->Modified(face);
    if (now.IsEmpty()) joined[face] = colour;
    for (TopoDS_Shape const& f : now) joined[f] = colour;
  }
  own = std::move(joined);
  rest.push_back(unify.Shape());
  p.shape = rest.size() == 1 ? rest.front() : compound(rest);
}

class Walk {
 public:
  Walk(Handle(TDocStd_Document) const& document, std::function<void(PlacedFaces const&)> const& use)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colours_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        use_(use) {}

  void run() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    std::map<std::string, int> taken;
    for (TDF_Label const& root : roots) {
      bool const alone = roots.Length() == 1 && XCAFDoc_ShapeTool::IsAssembly(root);
      visit(root, root, {}, "", alone ? "" : unique(taken, name_of(root)), "");
    }
  }

 private:
  static std::string unique(std::map<std::string, int>& taken, std::string name) {
    if (name.empty()) name = "part";
    int const n = ++taken[name];
    if (n == 1) return name;
    std::string const other = fmt::format("{}_{}", name, n);
    return taken.contains(other) ? unique(taken, other) : other;
  }

  void visit(TDF_Label const& label, TDF_Label const& occurrence, TopLoc_Location const& above, std::string const& path,
             std::string const& name, std::string const& inherited) {
    std::string const own = colour_of(colours_, occurrence);
    std::string const colour = !own.empty() ? own : inherited;
    std::string const full = path.empty() || name.empty() ? path + name : path + "/" + name;
    if (!XCAFDoc_ShapeTool::IsAssembly(label)) return emit(product(label), above, full, colour);
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(label, components);
    std::map<std::string, int> taken;
    for (TDF_Label const& component : components) {
      TDF_Label target;
      if (!XCAFDoc_ShapeTool::GetReferredShape(component, target)) continue;
      std::string given = name_of(component);
      if (made_up(given)) given = name_of(target);
      std::string const whole = colour_of(colours_, label);
      visit(target, component, above * XCAFDoc_ShapeTool::GetLocation(component), full, unique(taken, given),
            !colour.empty() ? colour : whole);
    }
  }

  Product const& product(TDF_Label const& label) {
    auto const [slot, fresh] = products_.try_emplace(label.Tag());
    Product& p = slot->second;
    if (!fresh) return p;
    p.shape = XCAFDoc_ShapeTool::GetShape(label);
    p.colour = colour_of(colours_, label);
    FaceColours own;
    TDF_LabelSequence inner;
    XCAFDoc_ShapeTool::GetSubShapes(label, inner);
    for (bool const faces : {false, true})  // a face has the last word over its solid
      for (TDF_Label const& sub : inner) {
        TopoDS_Shape const shape = XCAFDoc_ShapeTool::GetShape(sub);
        std::string const colour = colour_of(colours_, sub);
        if (colour.empty() || (shape.ShapeType() == TopAbs_FACE) != faces) continue;
        for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) own[f.Current()] = colour;
      }
    join_faces(p, own);
    for (TopExp_Explorer f(p.shape, TopAbs_FACE); f.More(); f.Next()) {
      p.faces.push_back(f.Current());
      p.colours.push_back(own.contains(f.Current()) ? own[f.Current()] : "");
    }
    return p;
  }

  void emit(Product const& p, TopLoc_Location const& at, std::string const& name, std::string const& colour) {
    PlacedFaces out{name, p.shape.Moved(at), {}, {}};
    for (std::size_t i = 0; i < p.faces.size(); ++i) {
      out.faces.push_back(p.faces[i].Moved(at));
      out.colours.push_back(!p.colours[i].empty() ? p.colours[i] : !colour.empty() ? colour : p.colour);
    }
    use_(out);
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  std::function<void(PlacedFaces const&)> const& use_;
  std::map<int, Product> products_;  // by tag: all are children of one label
};

}  // namespace

void for_each_part(Handle(TDocStd_Document) const& document, std::function<void(PlacedFaces const&)> const& use) {
  Walk(document, use).run();
}

}  // namespace straytrace::step
