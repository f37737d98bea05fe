// SPDX-License-Identifier: BSD-3-Clause
#include "world/import/geometry_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>
#include <tuple>
#include <variant>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "world/build/read_files.hpp"
#include "world/import/cad_file.hpp"

namespace straytrace::world {
namespace {

// One side of one triangle; `low` and `high` number its corners over all parts.
struct Side {
  std::uint32_t low, high, part;
  bool forward;
  auto ends() const { return std::tie(low, high); }
};

// Corners of all parts, equal positions under one number.
std::vector<std::vector<std::uint32_t>> joint_numbers(MeshFile const& file) {
  std::vector<std::tuple<float, float, float, std::uint32_t, std::uint32_t>> all;
  std::vector<std::vector<std::uint32_t>> number;
  for (std::uint32_t p = 0; p < file.parts.size(); ++p) {
    auto const& vertices = file.parts[p].vertices;
    number.emplace_back(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
      all.emplace_back(vertices[i].x, vertices[i].y, vertices[i].z, p, i);
  }
  std::ranges::sort(all);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto const& [x, y, z, part, vertex] = all[i];
    if (i > 0 &&
        std::tie(x, y, z) != std::tie(std::get<0>(all[i - 1]), std::get<1>(all[i - 1]), std::get<2>(all[i - 1])))
      ++next;
    number[part][vertex] = next;
  }
  return number;
}

bool collapsed(MeshTriangle const& t) {
  return t.corner[0] == t.corner[1] || t.corner[1] == t.corner[2] || t.corner[2] == t.corner[0];
}

// Parts that share edges form one body.
class Bodies {
 public:
  explicit Bodies(std::size_t parts) : of_(parts) { std::iota(of_.begin(), of_.end(), 0u); }
  std::uint32_t find(std::uint32_t p) {
    while (of_[p] != p) p = of_[p] = of_[of_[p]];
    return p;
  }
  void join(std::uint32_t a, std::uint32_t b) { of_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> of_;
};

class Examination {
 public:
  explicit Examination(MeshFile const& file)
      : file_(file), bodies_(file.parts.size()), sound_(file.parts.size(), 1), volume_(file.parts.size(), 0) {
    health_.parts.resize(file.parts.size());
  }
  MeshHealth run() {
    collect();
    count_doubled();
    look_at_edges();
    for (std::uint32_t p = 0; p < file_.parts.size(); ++p) {
      volume_[bodies_.find(p)] += health_.parts[p].volume;
      if (!sound_[p]) sound_[bodies_.find(p)] = 0;
    }
    for (std::uint32_t p = 0; p < file_.parts.size(); ++p) {
      MeshHealth::Part& part = health_.parts[p];
      part.closed = sound_[bodies_.find(p)];
      part.volume = part.closed ? volume_[bodies_.find(p)] : 0;
      if (part.closed && part.volume < 0) health_.inverted.push_back(file_.parts[p].name);
    }
    return std::move(health_);
  }

 private:
  void collect() {
    auto const number = joint_numbers(file_);
    Box const box = file_.box();
    Vec3 const about = 0.5 * (box.lower + box.upper);  // volumes are summed about it, for precision
    for (std::uint32_t p = 0; p < file_.parts.size(); ++p)
      for (MeshTriangle const& t : file_.parts[p].triangles) {
        Vec3 corner[3];
        std::array<std::uint32_t, 3> n;
        for (std::size_t k = 0; k < 3; ++k) {
          corner[k] = exact(file_.parts[p].vertices[t.corner[k]]) - about;
          n[k] = number[p][t.corner[k]];
        }
        Vec3 const across = cross(corner[1] - corner[0], corner[2] - corner[0]);
        health_.flat += !(length2(across) > 0);
        if (collapsed(t)) continue;
        health_.parts[p].area += 0.5 * length(across);
        health_.parts[p].volume += dot(corner[0], cross(corner[1], corner[2])) / 6;
        for (std::size_t k = 0; k < 3; ++k) {
          std::uint32_t const from = n[k], to = n[(k + 1) % 3];
          sides_.push_back({std::min(from, to), std::max(from, to), p, from < to});
          if (sides_.size() % 3 == 1) places_.push_back(corner[0] + about);
        }
        std::ranges::sort(n);
        faces_.push_back(n);
      }
  }
  void count_doubled() {
    std::ranges::sort(faces_);
    for (std::size_t i = 1; i < faces_.size(); ++i) health_.doubled += faces_[i] == faces_[i - 1];
  }
  void look_at_edges() {
    std::vector<std::uint32_t> order(sides_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(sides_[a].low, sides_[a].high, a) < std::tuple(sides_[b].low, sides_[b].high, b);
    });
    for (std::size_t i = 0, end; i < order.size(); i = end) {
      long balance = 0;
      Side const& first = sides_[order[i]];
      for (end = i; end < order.size() && sides_[order[end]].ends() == first.ends(); ++end) {
        balance += sides_[order[end]].forward ? 1 : -1;
        bodies_.join(first.part, sides_[order[end]].part);
      }
      std::size_t const count = end - i;
      if (balance != 0) sound_[first.part] = 0;
      if (count == 1) {
        if (health_.open_edges++ == 0) health_.first_open = places_[order[i] / 3];
        ++health_.parts[first.part].open_edges;
      }
      health_.crowded_edges += count > 2;
      health_.opposed_edges += count == 2 && balance != 0;
    }
  }

  MeshFile const& file_;
  MeshHealth health_;
  Bodies bodies_;
  std::vector<char> sound_;  // closed, every edge passed as often in one direction as in the other
  std::vector<double> volume_;
  std::vector<Side> sides_;
  std::vector<Vec3> places_;  // a corner of each triangle
  std::vector<std::array<std::uint32_t, 3>> faces_;
};

std::string length_text(double metres) {
  if (metres >= 1000) return fmt::format("{:.3g} km", metres / 1000);
  if (metres >= 1) return fmt::format("{:.3g} m", metres);
  if (metres >= 1e-3 || metres == 0) return fmt::format("{:.3g} mm", metres * 1e3);
  return fmt::format("{:.3g} um", metres * 1e6);
}

std::string shown(std::string const& name) { return name.empty() ? "(unnamed)" : "'" + name + "'"; }

std::string some(std::vector<std::string> const& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < 3; ++i) out += (i ? ", " : "") + shown(names[i]);
  return names.size() > 3 ? out + fmt::format(" and {} more", names.size() - 3) : out;
}

}  // namespace

MeshHealth examine(MeshFile const& file) { return Examination(file).run(); }

MeshFault without_area(MeshHealth const& health) {
  auto const has_area = [](MeshHealth::Part const& p) { return p.area > 0; };
  if (std::ranges::any_of(health.parts, has_area)) return {};
  return {"no triangle of the file has an area: each has two equal corners, or three in one line",
          "export the faces of the parts again"};
}

bool repair(MeshFile& file, MeshHealth const& health) {
  bool done = false;
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    auto& [name, material, colour, vertices, triangles, normals] = file.parts[p];
    std::vector<MeshVertex> kept;
    for (std::size_t t = 0; 3 * t < normals.size(); ++t)
      if (!collapsed(triangles[t])) kept.insert(kept.end(), &normals[3 * t], &normals[3 * t] + 3);
    normals = std::move(kept);
    done |= std::erase_if(triangles, collapsed) > 0;
    if (!health.parts[p].closed || !(health.parts[p].volume < 0)) continue;
    for (MeshTriangle& t : triangles) std::swap(t.corner[1], t.corner[2]);
    for (std::size_t k = 0; k < normals.size(); k += 3) std::swap(normals[k + 1], normals[k + 2]);
    done = true;
  }
  std::erase_if(file.parts, [](MeshPart const& p) { return p.triangles.empty(); });
  return done;
}

std::vector<MeshAdvice> advice(MeshFile const& file, MeshHealth const& health) {
  std::vector<MeshAdvice> out;
  auto const add = [&](bool when, std::string what, std::string suggestion) {
    if (when) out.push_back({std::move(what), std::move(suggestion)});
  };
  std::size_t open_parts = 0;
  for (MeshHealth::Part const& p : health.parts) open_parts += p.open_edges > 0;
  Vec3 const at = health.first_open;
  add(health.open_edges > 0,
      fmt::format("{} in {} of {} {} to one triangle only, {}near ({:.6g}, {:.6g}, {:.6g}) in "
                  "the unit of the file: light passes there",
                  counted(health.open_edges, "edge"), open_parts, counted(file.parts.size(), "part"),
                  health.open_edges == 1 ? "belongs" : "belong", health.open_edges == 1 ? "" : "one of them ", at.x,
                  at.y, at.z),
      "close the holes where the part should be solid; an open sheet may stay as it is");
  add(health.crowded_edges > 0,
      counted(health.crowded_edges, "edge", "belongs", "belong") + " to more than two triangles",
      "take away inner walls, or export touching parts under different names");
  add(health.opposed_edges > 0,
      counted(health.opposed_edges, "edge", "joins", "join") +
          " triangles that show different sides: some normals are flipped",
      "make the normals of the part consistent before the export; 'side' and 'medium' rely on them");
  add(health.doubled > 0, counted(health.doubled, "triangle", "lies", "lie") + " on the corners of another one",
      "export each face once; of two equal faces the first in the file is hit");
  add(health.flat > 0, counted(health.flat, "triangle", "has", "have") + " no area",
      "they do no harm; a coarser export avoids them");
  add(!health.inverted.empty(),
      fmt::format("the normals of closed parts look inwards: {}; they were turned outwards", some(health.inverted)),
      "flip the faces where the file is made");
  add(file.left_out > 0,
      counted(file.left_out, "face", "is a point or line and was", "are points or lines and were") + " left out",
      "export triangles or polygons only");
  return out;
}

std::string size_text(Box const& box, double unit) {
  Vec3 const d = unit * (box.upper - box.lower);
  return fmt::format("{} x {} x {}", length_text(d.x), length_text(d.y), length_text(d.z));
}

MeshAdvice scale_advice(Box const& box, double unit) {
  Vec3 const d = unit * (box.upper - box.lower);
  double const longest = std::max({d.x, d.y, d.z});
  if (longest > 100)
    return {fmt::format("bounding box {}; was it exported in mm and read as m?", size_text(box, unit)), "set 'units'"};
  if (longest < 1e-4)
    return {fmt::format("bounding box {}; was it exported in m and read as mm?", size_text(box, unit)), "set 'units'"};
  return {};
}

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
