// SPDX-License-Identifier: BSD-3-Clause
#include "step/write_cad.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <map>

namespace straytrace::step {
namespace {

using nlohmann::json;

json as_json(Face const& f) {
  json out{{"kind", kind_names[std::size_t(f.kind)]},
           {"origin", f.origin},
           {"x", f.x},
           {"z", f.z},
           {"radius", f.radius},
           {"second", f.second},
           {"flipped", f.flipped}};
  if (f.natural) {
    out["within"] = f.within;
    return out;
  }
  json& loops = out["loops"] = json::array();
  for (Loop const& loop : f.loops) {
    json numbers = json::array();
    for (Corner const& p : loop)
      for (double x : {p.x, p.y, p.bulge}) numbers.push_back(x);
    loops.push_back(std::move(numbers));
  }
  return out;
}

}  // namespace

std::string as_json(Model const& model, Settings const& settings, std::string const& made_by) {
  json out{{"straytrace_cad", format_version},
           {"made_by", made_by},
           {"schema", model.schema},
           {"unit", model.unit},
           {"unit_stated", model.unit_stated},
           {"tolerance", settings.tolerance},
           {"chord", settings.chord},
           {"lower", model.lower},
           {"upper", model.upper}};
  json& notes = out["notes"] = json::array();
  for (Note const& n : model.notes) notes.push_back({{"what", n.what}, {"suggestion", n.suggestion}});
  json& parts = out["parts"] = json::array();
  for (Part const& p : model.parts) {
    json part{{"name", p.name}, {"colour", p.colour}, {"faces", json::array()}};
    for (Face const& f : p.faces) part["faces"].push_back(as_json(f));
    if (!p.triangles.corners.empty())
      part["triangles"] = {
          {"faces", p.triangles.faces}, {"vertices", p.triangles.vertices}, {"corners", p.triangles.corners}};
    parts.push_back(std::move(part));
  }
  return out.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string summary(Model const& model, std::string const& name) {
  std::map<std::string, std::size_t> kinds;
  std::size_t triangles = 0;
  for (Part const& p : model.parts) {
    for (Face const& f : p.faces) ++kinds[kind_names[std::size_t(f.kind)]];
    if (p.triangles.faces) kinds["freeform"] += p.triangles.faces;
    triangles += p.triangles.corners.size();
  }
  std::string out = fmt::format("{}: {}, {} parts\nunit   ", name, model.schema, model.parts.size());
  out += !model.unit_stated ? "not in the file, taken as mm\n"
         : model.unit > 0   ? fmt::format("{:g} m\n", model.unit)
                            : "several\n";
  out += "faces ";
  for (auto const& [kind, n] : kinds) out += fmt::format(" {} {}", n, kind);
  if (triangles) out += fmt::format(" ({} triangles)", triangles);
  Triple const d = {model.upper[0] - model.lower[0], model.upper[1] - model.lower[1], model.upper[2] - model.lower[2]};
  out += fmt::format("\nsize   {:.6g} m x {:.6g} m x {:.6g} m\n", d[0], d[1], d[2]);
  for (Note const& n : model.notes) out += fmt::format("note   {}\n       {}\n", n.what, n.suggestion);
  return out;
}

}  // namespace straytrace::step
