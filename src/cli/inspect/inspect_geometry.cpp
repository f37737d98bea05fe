// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <set>
#include <variant>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "cli/inspect/inspect.hpp"
#include "report/scene_picture.hpp"
#include "results/text/image.hpp"
#include "world/build/read_files.hpp"
#include "world/import/cad_file.hpp"
#include "world/import/mesh_doctor.hpp"

namespace straytrace::cli {
namespace {

std::string last_piece(std::string const& name) { return name.substr(name.rfind('/') + 1); }

std::string faces_text(GeometryPart const& p) {
  std::string out;
  for (auto const& [kind, n] : p.faces) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", n, kind);
  return out;
}

// "dump_1" and "dump_2" are one rule, "dump*".
std::vector<std::string> patterns_of(std::vector<GeometryPart> const& parts) {
  std::map<std::string, std::set<std::string>> by_stem;
  std::vector<std::string> order;
  for (GeometryPart const& p : parts) {
    std::string const name = last_piece(p.name);
    std::string stem = name;
    while (!stem.empty() && (std::isdigit(static_cast<unsigned char>(stem.back())) || stem.back() == '_'))
      stem.pop_back();
    if (stem.empty()) stem = name;
    if (by_stem[stem].empty()) order.push_back(stem);
    by_stem[stem].insert(name);
  }
  std::vector<std::string> patterns;
  for (std::string const& stem : order)
    patterns.push_back(by_stem[stem].size() > 1 ? stem + "*" : *by_stem[stem].begin());
  return patterns;
}

std::string quoted(std::string const& text) { return nlohmann::json(text).dump(); }

// Ready to paste into a scene.
std::string entry(std::string const& file, GeometryFile const& g, std::string const& units) {
  std::string const unit = !units.empty() ? units : g.unit_known ? "from_file" : "mm";
  std::string out = fmt::format(
      "scene:\n  - name: NAME\n    file: {}\n    units: {}\n    at: [0 m, 0 m, 0 m]\n    body: BODY\n    surfaces:\n",
      quoted(file), unit);
  for (std::string const& p : patterns_of(g.parts)) out += fmt::format("      {}: MATERIAL\n", quoted(p));
  std::set<std::string> colours;
  for (GeometryPart const& p : g.parts)
    if (!p.colour.empty()) colours.insert(p.colour);
  for (std::string const& c : colours) out += fmt::format("      # or by colour: \"color {}\": MATERIAL\n", c);
  return out + "      default: MATERIAL\n    # lenses and windows: medium: {\"PART\": fused_silica}\n";
}

void print_text(std::string const& file, GeometryFile const& g, std::string const& units) {
  std::cout << fmt::format(
      "{}: {}\nunit   {}\nsize   {}, from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) {}\n", file, g.format,
      g.unit, g.unit_known ? size_text(g.box, 1) : "see unit", g.box.lower.x, g.box.lower.y, g.box.lower.z,
      g.box.upper.x, g.box.upper.y, g.box.upper.z, g.unit_known ? "m" : "in the unit of the file");
  std::size_t width = 30;
  for (GeometryPart const& p : g.parts) width = std::max(width, p.name.size());
  std::cout << fmt::format("\n{:<{}}  {:<9}{:>12}  faces\n", "part", width, "colour",
                           g.unit_known ? "area [m2]" : "area");
  for (GeometryPart const& p : g.parts)
    std::cout << fmt::format("{:<{}}  {:<9}{:>12.6g}  {}{}{}\n", p.name, width, p.colour.empty() ? "-" : p.colour,
                             p.area, faces_text(p), p.material.empty() ? "" : ", material '" + p.material + "'",
                             p.closed.empty() ? "" : ", " + p.closed);
  for (MeshFault const& n : g.notes) std::cout << fmt::format("\nnote: {}\n      {}\n", n.what, n.suggestion);
  std::cout << "\nIntersections of parts are not checked. For a scene:\n\n" << entry(file, g, units);
}

void print_json(std::string const& file, GeometryFile const& g, std::string const& units) {
  auto const triple = [](Vec3 v) { return nlohmann::json{v.x, v.y, v.z}; };
  nlohmann::json parts = nlohmann::json::array(), notes = nlohmann::json::array();
  for (GeometryPart const& p : g.parts)
    parts.push_back({{"name", p.name},
                     {"material", p.material},
                     {"colour", p.colour},
                     {"faces", p.faces},
                     {"area", p.area},
                     {"closed", p.closed}});
  for (MeshFault const& n : g.notes) notes.push_back({{"what", n.what}, {"suggestion", n.suggestion}});
  std::cout << nlohmann::json{{"file", file},
                              {"format", g.format},
                              {"unit", g.unit},
                              {"unit_known", g.unit_known},
                              {"lower", triple(g.box.lower)},
                              {"upper", triple(g.box.upper)},
                              {"parts", parts},
                              {"notes", notes},
                              {"entry", entry(file, g, units)}}
                   .dump()
            << '\n';
}

// From above and in front, z up as in CAD programs.
void draw(GeometryFile const& g, std::string const& plot, PrintOptions const& options) {
  constexpr double field = pi / 6;
  Vec3 const middle = 0.5 * (g.box.lower + g.box.upper);
  double const reach = 0.5 * length(g.box.upper - g.box.lower) / std::sin(field / 2);
  Camera const camera = looking_at(middle + reach * unit({0.5, -0.8, 0.6}), middle, {0, 0, 1}, field, 1000, 750);
  LookSettings settings{{}, looks_of(g.world.view()), 0};
  std::fill(settings.looks.begin(), settings.looks.end(), Look::solid);
  Drawn const drawn = draw_shaded(g.world, camera, settings);
  write_png(plot, {camera.columns, camera.rows, drawn.rgb});
  if (options.json()) return;
  std::cout << "\npicture: " << plot << '\n';
  for (LegendEntry const& e : drawn.legend) std::cout << fmt::format("  {} {:7} {}\n", e.colour, e.name, e.what);
}

}  // namespace

bool is_geometry(std::string const& file) {
  static constexpr std::array<std::string_view, 5> meshes = {".stl", ".obj", ".ply", ".gltf", ".glb"};
  std::string const ending = lower_case(std::filesystem::path(file).extension().string());
  return is_step(file) || is_converted(file) || std::find(meshes.begin(), meshes.end(), ending) != meshes.end();
}

int inspect_geometry(std::string const& file, std::string const& units, std::string const& plot,
                     PrintOptions const& options) {
  GeometryFile const g = read_geometry(file, units == "from_file" ? "" : units);
  std::string const name = std::filesystem::path(file).filename().string();
  if (options.json())
    print_json(name, g, units);
  else
    print_text(name, g, units);
  if (!plot.empty()) draw(g, plot, options);
  return done;
}

namespace {

namespace fs = std::filesystem;

std::string contents(fs::path const& file) {
  FileBytes read = bytes_of_file(file);
  if (!read.why.empty())
    throw InputError(fmt::format("cannot read '{}': {}", file.string(), read.why),
                     "check the name and the folder, and that it is a file");
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

void read_cad(std::string const& name, std::string const& bytes, std::string const& units, GeometryFile& out) {
  std::string text = bytes;
  if (is_step(name)) {
    StepConversion made = convert_step(name, bytes);
    refuse_mesh(name, made.fault);
    text = std::move(made.text);
  }
  CadFile file;
  refuse_mesh(name, read_cad_file(text, file));
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
  refuse_mesh(file.name, read_mesh_file(bytes, beside, file));
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
    read_cad(name, bytes, units, out);
  else
    read_mesh(file, bytes, units, out);
  out.world.finish();
  return out;
}

}  // namespace straytrace::cli
