// SPDX-License-Identifier: BSD-3-Clause
#include "world/import/geometry_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <variant>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "world/build/read_files.hpp"
#include "world/import/cad_file.hpp"
#include "world/import/mesh_doctor.hpp"

namespace straytrace::world {

bool is_geometry(std::string const& file) {
  static constexpr std::array<std::string_view, 5> meshes = {".stl", ".obj", ".ply", ".gltf", ".glb"};
  std::string const ending = lower_case(std::filesystem::path(file).extension().string());
  return is_step(file) || is_converted(file) || std::find(meshes.begin(), meshes.end(), ending) != meshes.end();
}

namespace {

namespace fs = std::filesystem;

std::string contents(fs::path const& file) {
  FileBytes read = bytes_of_file(file);
  if (!read.why.empty())
    throw InputError(fmt::format("cannot read '{}': {}", file.string(), read.why), remedy_for_unreadable(file));
  return std::move(read.bytes);
}

void refuse_mesh(std::string const& name, MeshFault const& fault) {
  if (fault.what.empty()) return;
  Problem const problem{{}, fault.what, fault.suggestion};
  throw InputError({problem}, placed_message(problem, name) + "\n1 error. Nothing was run.\n", {name});
}

double metres_in(std::string const& units) {
  auto const unit = parse_unit(units);
  if (!unit || unit->dimension != dim::length)
    throw InputError(fmt::format("'{}' is not a unit of length", units), "write for example --units mm");
  return unit->si;
}

// The picture distinguishes objects by the first piece of a group's name.
GroupId group_of(World& world, std::string const& part) { return world.add_group(part.substr(part.rfind('/') + 1)); }

void add_cad_part(CadFilePart const& p, double scale, std::uint32_t optic, BodyId body, GeometryFile& out) {
  static constexpr std::array<char const*, 5> kinds = {"plane", "cylinder", "cone", "sphere", "torus"};
  GeometryPart& row = out.parts.emplace_back();
  row.name = p.name;
  row.colour = p.colour;
  GroupId const group = group_of(out.world, p.name);
  for (CadFileFace const& f : p.faces) {
    ++row.faces[kinds[std::size_t(f.carrier)]];
    PlacedCadShape const placed = cad_shape(f, scale, out.world.storage);
    std::visit(
        [&](auto shape) {
          shape.place(placed.frame);
          row.area += shape.area();
          out.world.add_surface(shape, optic, optic, body, group);
        },
        placed.shape);
  }
  if (p.triangles.empty()) return;
  row.faces["freeform"] = p.freeform;
  TriangleMesh mesh;
  mesh.unit = scale;
  mesh.content = prepare_mesh(p.vertices, p.triangles, out.world.storage);
  row.area += mesh.area();
  out.world.add_surface(mesh, optic, optic, body, group);
}

void note(GeometryFile& out, MeshAdvice const& a) {
  if (!a.what.empty()) out.notes.push_back({a.what, a.suggestion});
}

void read_cad(fs::path const& path, std::string const& bytes, std::string const& units, GeometryFile& out) {
  std::string text = bytes;
  if (std::string const name = path.filename().string(); is_step(name)) {
    StepConversion made = convert_step(name, bytes);
    refuse_mesh(path.string(), made.fault);
    text = std::move(made.text);
  }
  CadFile file;
  refuse_mesh(path.string(), read_cad_file(text, file));
  out.format = fmt::format("{}, converted by {}", file.schema, file.made_by);
  out.unit = !file.unit_stated ? "not in the file, shown as mm"
             : file.unit > 0   ? fmt::format("the file states {:g} m", file.unit)
                               : "the file uses several";
  out.unit_known = file.unit_stated || !units.empty();
  if (!units.empty() && file.unit > 0) {
    out.scale = metres_in(units) / file.unit;
    out.unit += ", read as " + units;
  }
  out.notes = file.notes;
  std::uint32_t const optic = out.world.add_optic({});
  BodyId const body = out.world.add_body("bench", {});
  std::size_t freeform = 0, faces = 0;
  for (CadFilePart const& p : file.parts) {
    add_cad_part(p, out.scale, optic, body, out);
    freeform += p.freeform;
    faces += p.faces.size() + p.freeform;
  }
  out.box = {out.scale * file.box.lower, out.scale * file.box.upper};
  note(out, scale_advice(file.box, out.scale));
  if (freeform > 0)
    out.notes.push_back({fmt::format("{} of {} faces are free-form surfaces, represented by triangles within {:g} m",
                                     freeform, faces, file.chord),
                         "scatter from them is accurate; specular reflection from them goes in wrong directions"});
}

void add_mesh_part(MeshPart& p, MeshHealth::Part const& health, std::size_t number, double scale, std::uint32_t optic,
                   BodyId body, GeometryFile& out) {
  GeometryPart& row = out.parts.emplace_back();
  row.name = !p.name.empty() ? p.name : !p.material.empty() ? p.material : fmt::format("part_{}", number);
  row.material = p.material;
  row.colour = p.colour;
  row.faces["triangle"] = p.triangles.size();
  row.closed = health.closed ? "closed" : fmt::format("not closed, {} open edges", health.open_edges);
  TriangleMesh mesh;
  mesh.unit = scale;
  mesh.content = prepare_mesh(std::move(p.vertices), std::move(p.triangles), out.world.storage);
  row.area = mesh.area();
  out.world.add_surface(mesh, optic, optic, body, group_of(out.world, row.name));
}

void read_mesh(fs::path const& path, std::string const& bytes, std::string const& units, GeometryFile& out) {
  MeshFile file;
  file.name = path.filename().string();
  auto const beside = [&](std::string const& other) {
    std::error_code missing;
    return fs::is_regular_file(path.parent_path() / other, missing) ? contents(path.parent_path() / other) : "";
  };
  refuse_mesh(path.string(), read_mesh_file(bytes, beside, file));
  fs::path library = path;
  if (std::string const text = beside(library.replace_extension(".mtl").filename().string()); !text.empty())
    set_library_colours(text, file);
  out.format = "mesh";
  out.unit_known = file.stated_unit > 0 || !units.empty();
  out.scale = !units.empty() ? metres_in(units) : file.stated_unit > 0 ? file.stated_unit : 1;
  out.unit = !units.empty()         ? "read as " + units
             : file.stated_unit > 0 ? "its format says m"
                                    : fmt::format("not in the file: {} as mm, {} as m", size_text(file.box(), 1e-3),
                                                  size_text(file.box(), 1));
  MeshHealth const health = examine(file);
  refuse_mesh(path.string(), without_area(health));
  for (MeshAdvice const& a : advice(file, health)) note(out, a);
  Box const box = file.box();
  out.box = {out.scale * box.lower, out.scale * box.upper};
  if (out.unit_known) note(out, scale_advice(box, out.scale));
  std::uint32_t const optic = out.world.add_optic({});
  BodyId const body = out.world.add_body("bench", {});
  for (std::size_t i = 0; i < file.parts.size(); ++i)
    add_mesh_part(file.parts[i], health.parts[i], i + 1, out.scale, optic, body, out);
}

}  // namespace

GeometryFile read_geometry(std::string const& file, std::string const& units) {
  GeometryFile out;
  std::string const bytes = contents(file), name = fs::path(file).filename().string();
  if (is_step(name) || is_converted(name))
    read_cad(file, bytes, units, out);
  else
    read_mesh(file, bytes, units, out);
  out.world.finish();
  return out;
}

}  // namespace straytrace::world
