// SPDX-License-Identifier: BSD-3-Clause
#include "world/cad_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/lower_case.hpp"

namespace straytrace {
namespace {

using nlohmann::json;
constexpr int known_version = 1;

double number(json const& node) {
  double const x = node.get<double>();
  if (!std::isfinite(x)) throw std::runtime_error("a number is not finite");
  return x;
}
double positive(json const& node, char const* what) {
  double const x = number(node);
  if (!(x > 0)) throw std::runtime_error(fmt::format("the {} {:g} is not positive", what, x));
  return x;
}
Vec3 vector(json const& node) {
  if (node.size() != 3) throw std::runtime_error("a vector has not three numbers");
  return {number(node[0]), number(node[1]), number(node[2])};
}

Pose frame_of(json const& node) {
  Vec3 const x = vector(node.at("x")), z = vector(node.at("z"));
  if (std::fabs(length(x) - 1) > 1e-6 || std::fabs(length(z) - 1) > 1e-6 || std::fabs(dot(x, z)) > 1e-6)
    throw std::runtime_error("the axes of a face are not at right angles");
  Vec3 const e3 = unit(z), e1 = unit(x - dot(x, e3) * e3);
  return {vector(node.at("origin")), e1, cross(e3, e1), e3};
}

std::vector<ChartLoop> loops_of(json const& node) {
  std::vector<ChartLoop> loops;
  for (json const& numbers : node) {
    if (numbers.size() < 6 || numbers.size() % 3 != 0) throw std::runtime_error("a loop has less than two corners");
    ChartLoop& loop = loops.emplace_back();
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      ChartCorner const c{number(numbers[i]), number(numbers[i + 1]), number(numbers[i + 2])};
      if (std::fabs(c.bulge) > 1) throw std::runtime_error("an arc turns by more than half a circle");
      loop.push_back(c);
    }
  }
  if (loops.empty()) throw std::runtime_error("a face has no loop");
  return loops;
}

CadFileFace face_of(json const& node) {
  static constexpr std::array<std::string_view, 5> kinds = {"plane", "cylinder", "cone", "sphere", "torus"};
  std::string const kind = node.at("kind");
  auto const at = std::find(kinds.begin(), kinds.end(), kind);
  if (at == kinds.end()) throw std::runtime_error(fmt::format("'{}' is no kind of face", kind));
  CadFileFace f;
  f.carrier = Carrier(at - kinds.begin());
  f.frame = frame_of(node);
  f.flipped = node.at("flipped");
  if (f.carrier != Carrier::plane && f.carrier != Carrier::cone) f.radius = positive(node.at("radius"), "radius");
  if (f.carrier == Carrier::torus || f.carrier == Carrier::cone)
    f.second = positive(node.at("second"), "second number");
  if (f.carrier == Carrier::cone && !(f.second < pi / 2))
    throw std::runtime_error("a cone opens by 90 degrees or more");
  if (f.carrier == Carrier::torus && !(f.second < f.radius)) throw std::runtime_error("a torus crosses itself");
  f.natural = node.contains("within");
  if (!f.natural) {
    f.loops = loops_of(node.at("loops"));
    return f;
  }
  f.from = number(node.at("within").at(0));
  f.to = number(node.at("within").at(1));
  if (f.carrier != Carrier::torus && !(f.from < f.to)) throw std::runtime_error("a face has no width");
  return f;
}

void read_triangles(json const& node, CadFilePart& part) {
  part.freeform = node.at("faces");
  for (json const& v : node.at("vertices")) {
    Vec3 const p = vector(v);
    part.vertices.push_back({float(p.x), float(p.y), float(p.z)});
  }
  for (json const& t : node.at("corners")) {
    MeshTriangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corner[i] = t.at(i);
      if (triangle.corner[i] >= part.vertices.size()) throw std::runtime_error("a triangle names a missing corner");
    }
    part.triangles.push_back(triangle);
  }
}

void read(json const& all, CadFile& out) {
  out.made_by = all.at("made_by");
  out.schema = all.at("schema");
  out.unit = number(all.at("unit"));
  out.unit_stated = all.at("unit_stated");
  out.tolerance = number(all.at("tolerance"));
  out.chord = number(all.at("chord"));
  out.box = {vector(all.at("lower")), vector(all.at("upper"))};
  for (json const& n : all.at("notes")) out.notes.push_back({n.at("what"), n.at("suggestion")});
  for (json const& p : all.at("parts")) {
    CadFilePart& part = out.parts.emplace_back();
    part.name = p.at("name");
    part.colour = p.at("colour");
    for (json const& f : p.at("faces")) part.faces.push_back(face_of(f));
    if (p.contains("triangles")) read_triangles(p.at("triangles"), part);
  }
  if (out.parts.empty()) throw std::runtime_error("it holds no parts");
}

}  // namespace

Box CadFile::box_in_unit() const {
  double const u = unit > 0 ? unit : 1;
  return {(1 / u) * box.lower, (1 / u) * box.upper};
}

bool is_step(std::string const& name) {
  std::string const low = lower_case(name);
  return low.ends_with(".step") || low.ends_with(".stp") || low.ends_with(".p21");
}

bool is_converted(std::string const& name) { return lower_case(name).ends_with(".cad.json"); }

MeshFault read_cad_file(std::string const& text, CadFile& out) {
  std::string const fix = "convert it again: straytrace-step FILE.step";
  try {
    json const all = json::parse(text);
    if (!all.is_object() || !all.contains("straytrace_cad"))
      return {"this is not CAD geometry of straytrace: it has no 'straytrace_cad'", fix};
    if (int const version = all.at("straytrace_cad"); version != known_version)
      return {fmt::format("it has version {} of the format, this program reads version {}", version, known_version),
              fix};
    read(all, out);
  } catch (std::exception const& e) {
    return {fmt::format("the converted file is damaged: {}", e.what()), fix};
  }
  return {};
}

}  // namespace straytrace
