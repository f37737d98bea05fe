// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/input/document.hpp"
#include "geometry/shape_types.hpp"
#include "world/build/read_files.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world {
namespace {

// Reads one shape from its table and adds the surface.
template <class Shape>
SurfaceId add_shape(Node const& keys, Surface const& as, Pose const& pose, World& world) {
  if constexpr (std::is_same_v<Shape, TriangleMesh> || std::is_same_v<Shape, CadFace>) {
    keys.problem(fmt::format("shape {} comes from a file", Shape::key),
                 "write 'file: bench.obj, units: mm' or 'file: bench.step, units: from_file' in place of 'shape'");
    return {};
  } else {
    Shape shape;
    auto const numbers = Shape::keys();
    read_keys(keys, numbers, shape);
    if (keys.data())
      for (auto const& k : numbers) keys.data()->describe(k.name, k.doc);
    keys.refuse_unknown(fmt::format("shape '{}'", Shape::key));
    bool const whole = std::ranges::all_of(numbers, [&](auto const& k) { return std::isfinite(shape.*(k.member)); });
    auto const complaint = whole ? impossible(shape) : ShapeComplaint{};  // a number that is not there is reported
    if (!complaint.what.empty()) keys.problem(complaint.what, complaint.suggestion);
    shape.place(pose);
    return world.add_surface(shape, as);
  }
}

using Adder = SurfaceId (*)(Node const&, Surface const&, Pose const&, World&);

template <std::size_t... I>
SurfaceId add_by_name(Node const& shape, Surface const& as, Pose const& pose, World& world, std::index_sequence<I...>) {
  static constexpr std::string_view names[] = {std::tuple_element_t<I, ShapeTypes>::key...};
  static constexpr Adder adders[] = {add_shape<std::tuple_element_t<I, ShapeTypes>>...};
  auto const items = shape.items();
  for (auto const& [name, keys] : items)
    for (std::size_t i = 0; i < sizeof...(I); ++i)
      if (items.size() == 1 && name == names[i]) return adders[i](keys, as, pose, world);
  std::string const given = items.size() == 1 ? items[0].first : "";
  std::vector<std::string> const known(std::begin(names), std::end(names));
  shape.problem(given.empty() ? "a shape is a table with one name" : fmt::format("unknown shape '{}'", given),
                did_you_mean(given, known, fmt::format("known shapes: {}", fmt::join(known, ", "))));
  return {};
}

// A value given at the face, otherwise at the placed entry.
Node given(Scene::Instance const& instance, std::string_view key) {
  Node const at_face = instance.node[key], at_entry = instance.placement[key];
  return at_face ? at_face : at_entry;
}

template <class Map>
auto find_named(Node const& node, Map const& map, std::string_view what) -> typename Map::mapped_type {
  if (!node) return {};
  std::string const name = node.as_word();
  if (node.kind() != Node::Kind::scalar) return {};  // reported already
  auto const found = map.find(name);
  if (found != map.end()) return found->second;
  std::vector<std::string> known;
  known.reserve(map.size());
  for (auto const& entry : map) known.push_back(entry.first);
  std::string const all = known.empty() ? "none is defined" : fmt::format("defined: {}", fmt::join(known, ", "));
  node.problem(fmt::format("{} '{}' is not defined", what, name), did_you_mean(name, known, all));
  return {};
}

// The material of a face: from `surfaces` of the entry, otherwise of the face, otherwise of the entry. Faces are
// named there without the name of the entry: "barrel", "lens/barrel".
Node material_of(Scene::Instance const& instance) {
  Node const usual = given(instance, "material");  // known, even where every face has its own
  std::size_t const slash = instance.name.find('/');
  if (Node const by_face = instance.placement["surfaces"]; by_face && slash != std::string::npos) {
    if (by_face.kind() != Node::Kind::table)
      by_face.problem("'surfaces' names a material for each face", "write {barrel: NAME, back: NAME}");
    else if (Node const own = by_face[instance.name.substr(slash + 1)])
      return own;
  }
  return usual;
}

// Data shared by several instances, by name.
struct Shared {
  std::set<std::string> complained;
  std::map<std::string, std::uint32_t> volumes;                         // by part that it fills and medium
  std::map<std::uint32_t, std::pair<Node, std::string>> volume_places;  // and the part
  std::set<std::string> clear;                                          // parts with a face that lets light in
  FileLibrary files;
};

std::string part_of(Scene::Instance const& instance) { return instance.name.substr(0, instance.name.rfind('/')); }

// Faces of one placed part that name the same medium enclose one volume; `none`: the face encloses nothing.
std::uint32_t volume_of(Node const& node, std::string const& part, World& world, Registry const& names,
                        Shared& shared) {
  if (!node || node.as_word() == "none") return Surface::none;
  std::string const key = part + '/' + node.as_word();
  if (auto const known = shared.volumes.find(key); known != shared.volumes.end()) return known->second;
  auto const medium = find_medium(node, world, names);
  if (!medium) return Surface::none;
  std::uint32_t const id = world.add_volume(*medium);
  shared.volume_places[id] = {node, part};
  return shared.volumes[key] = id;
}

std::string entry_of(Scene::Instance const& instance) {
  return instance.group.substr(0, instance.group.find_first_of("/["));
}

// Parts that their usual medium fills, since one of their faces lets light in.
std::set<std::string> clear_parts(Scene const& scene, World const& world, Registry const& names) {
  std::set<std::string> parts;
  for (Scene::Instance const& instance : scene.instances()) {
    if (!instance.usual_medium || given(instance, "medium")) continue;
    Node const material = material_of(instance);
    auto const optic = names.materials.find(material ? material.text() : "");
    if (optic != names.materials.end() && lets_light_in(world, optic->second)) parts.insert(part_of(instance));
  }
  return parts;
}

bool is_entry(Scene::Instance const& instance) { return instance.node.data() == instance.placement.data(); }

// Of entries whose part has a material for each of its faces.
void warn_of_idle_materials(Scene const& scene, Registry const& names) {
  struct Stated {
    Node node;
    std::string entry;
    bool idle = true;
  };
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, Stated> all;  // by place
  for (Scene::Instance const& instance : scene.instances()) {
    Node const stated = instance.placement["material"];
    if (!stated || instance.refused || is_entry(instance) || given(instance, "file")) continue;
    auto const [file, line, column] = stated.place();
    Stated& found = all.try_emplace({file, line, column}, Stated{stated, entry_of(instance)}).first->second;
    found.idle = found.idle && material_of(instance).data() != stated.data();
  }
  for (auto const& [place, stated] : all) {
    if (!stated.idle) continue;
    find_named(stated.node, names.materials, "material");
    stated.node.warning(
        fmt::format("this material of '{}' has no effect: each face of its part names its own", stated.entry),
        "change it at the faces of the part, or remove it there or here");
  }
}

std::size_t errors_of(Scene const& scene) {
  Document const* const document = scene.root().document();
  return document ? document->errors() : 0;
}

// Its name counts as defined: messages about its users would only repeat its own problem.
void refuse(Scene::Instance const& instance, Registry& names) { names.refused.insert(entry_of(instance)); }

// Names in an entry with problems are still looked up.
void check_named(Scene::Instance const& instance, World const& world, Registry& names) {
  refuse(instance, names);
  if (is_entry(instance)) {
    Node const by_face = instance.placement["surfaces"];
    if (by_face.kind() == Node::Kind::table)
      for (auto const& [face, node] : by_face.items()) find_named(node, names.materials, "material");
  }
  find_named(material_of(instance), names.materials, "material");
  find_named(given(instance, "body"), names.bodies, "body");
  Node const medium = given(instance, "medium");
  if (medium && medium.kind() != Node::Kind::table && medium.as_word() != "none") find_medium(medium, world, names);
  for (char const* key : {"shape", "side", "file", "units"}) given(instance, key);
  for (char const* key : {"smooth", "imperfections"}) instance.placement.has(key);
  for (Node const& frame : instance.frames) read_pose(frame);
}

void add_instance(Scene::Instance const& instance, World& world, Registry& names, Shared& shared) {
  if (instance.refused) return check_named(instance, world, names);
  Pose pose;
  if (instance.repeat_axis >= 0) (&pose.origin.x)[instance.repeat_axis] = instance.offset;
  for (Node const& frame : instance.frames) pose = nested(pose, read_pose(frame));
  Node const shape = given(instance, "shape"), file = given(instance, "file"), body = given(instance, "body");
  Node const material = file ? Node() : material_of(instance);
  Node const side_node = given(instance, "side");
  instance.placement.has("imperfections");  // read when all beams are known
  bool const first_time = shared.complained.insert(instance.group).second;
  auto const demand = [&](Node const& node, std::string const& key, std::string const& example) {
    if (!node && first_time)
      instance.placement.problem(fmt::format("'{}' has no '{}'", instance.group, key),
                                 fmt::format("write {}", example));
  };
  if (!file) {
    demand(shape, "shape", "shape: {disk: {outer_radius: 10 cm}}");
    demand(material, "material", "material: NAME, one of 'materials'");
  }
  demand(body, "body", "body: NAME, one of 'bodies', with which it moves");
  std::uint32_t const optic = find_named(material, names.materials, "material");
  BodyId const body_id = find_named(body, names.bodies, "body");
  static constexpr std::array<std::string_view, 5> sides = {"both", "front", "back", "outer", "inner"};
  Node const& owner = instance.node.has("side") ? instance.node : instance.placement;
  std::string const side = side_node ? owner.choice("side", sides) : "both";
  if (!shape && !file) return refuse(instance, names);
  Surface as;
  set_sides(as, side, optic, names.black);
  as.body = body_id;
  Node medium = given(instance, "medium");
  if (!medium && instance.usual_medium && shared.clear.contains(part_of(instance))) {
    medium = instance.usual_medium;
    if (shared.complained.insert("filling of " + entry_of(instance)).second)
      world.notes.push_back(
          fmt::format("'{}' is filled with {}, the default medium of its part", part_of(instance), medium.as_word()));
  }
  bool const by_part = file && medium && medium.kind() == Node::Kind::table;
  if (!by_part) as.volume = volume_of(medium, part_of(instance), world, names, shared);
  FillPart const fill = [&](Node const& chosen, std::string const& part) {
    return volume_of(chosen, instance.name + '/' + part, world, names, shared);
  };
  if (file) return add_file({instance, file, pose, as, side, fill, first_time}, world, names, shared.files);
  as.group = world.add_group(instance.group);
  SurfaceId const id = add_by_name(shape, as, pose, world, std::make_index_sequence<std::tuple_size_v<ShapeTypes>>());
  if (!id.valid()) return refuse(instance, names);
  names.frames[id.value] = pose;
  names.surfaces[instance.name] = id;
  names.surfaces.try_emplace(instance.group, id);
}

}  // namespace

SurfaceId read_shape(Node const& shape, Surface const& as, Pose const& pose, World& world) {
  return add_by_name(shape, as, pose, world, std::make_index_sequence<std::tuple_size_v<ShapeTypes>>());
}

void read_bodies(Scene const& scene, World& world, Registry& names) {
  for (auto const& [name, node] : scene.table("bodies").items()) {
    Vec3 pivot{not_a_number, not_a_number, not_a_number};  // position of its first surface, unless given
    if (node.kind() == Node::Kind::table)
      if (Node const p = node["pivot"]) pivot = read_vector(p, dim::length);
    names.bodies[name] = world.add_body(name, pivot);
  }
  for (auto const& [name, node] : scene.table("bodies").items()) {  // after all bodies, whose numbers stay
    if (node.kind() != Node::Kind::table || !node.has("modes")) continue;
    for (auto const& [mode, spec] : node.table("modes").items()) {
      if (spec.kind() != Node::Kind::table || !spec.has("shape")) {
        spec.problem("a mode has a shape", "write {shape: {beam: ...}, motion: {...}}");
        continue;
      }
      ElasticMode elastic = read_elastic_mode(spec["shape"]);
      if (elastic.shape) world.add_mode(names.bodies[name], name + "/" + mode, std::move(elastic));
    }
  }
}

void read_surfaces(Scene const& scene, World& world, Registry& names) {
  Shared shared;
  shared.clear = clear_parts(scene, world, names);
  for (Scene::Instance const& instance : scene.instances()) {
    std::size_t const before = errors_of(scene);
    add_instance(instance, world, names, shared);
    if (errors_of(scene) > before) refuse(instance, names);
    if (is_entry(instance)) continue;  // its keys are those of the entry, below
    if (shared.complained.insert("keys of " + instance.group).second)
      instance.node.refuse_unknown(fmt::format("'{}'", instance.group));
  }
  for (Scene::Instance const& instance : scene.instances()) {  // all faces have read what they share
    std::string const entry = entry_of(instance), role = fmt::format("scene entry '{}'", entry);
    if (instance.refused && is_entry(instance)) {  // without its part, not all keys are known
      instance.placement.refuse_misspelt(role);
      continue;
    }
    if (shared.complained.insert("entry keys of " + entry).second) instance.placement.refuse_unknown(role);
    if (shared.complained.insert("surfaces of " + instance.group.substr(0, instance.group.find('/'))).second)
      if (Node const by_face = instance.placement["surfaces"]; by_face.kind() == Node::Kind::table)
        by_face.refuse_unknown("'surfaces'");
  }
  warn_of_idle_materials(scene, names);
  auto const faces = faces_of_volumes(world);
  for (auto const& [id, place] : shared.volume_places) {
    auto const& [node, part] = place;
    if (!node.healthy()) break;
    std::string const fault = id < faces.size() ? volume_fault(world, faces[id]) : "";
    if (!fault.empty())
      node.problem(fmt::format("{}: {}", part, fault),
                   "a medium needs closed faces with outward normals: cap, disk, rectangle, ellipse, conic "
                   "along 'facing', cylinder away from its axis, sphere and box outwards");
  }
}

// Position of a part: the keys at, facing and rotate.

namespace {

// Turns by `angle` about the unit vector `axis` (Rodrigues).
Vec3 turned(Vec3 v, Vec3 axis, double cosine, double sine) {
  return cosine * v + sine * cross(axis, v) + ((1 - cosine) * dot(axis, v)) * axis;
}

Pose rotated(Vec3 origin, Vec3 axis, double cosine, double sine) {
  return {origin, turned({1, 0, 0}, axis, cosine, sine), turned({0, 1, 0}, axis, cosine, sine),
          turned({0, 0, 1}, axis, cosine, sine)};
}

// The smallest turn that takes z to `to`; half a turn about x for -z.
Pose facing(Vec3 origin, Vec3 to) {
  Vec3 const across = cross({0, 0, 1}, to);
  double const sine = length(across);
  if (sine == 0) return {origin, {1, 0, 0}, {0, std::copysign(1.0, to.z), 0}, {0, 0, std::copysign(1.0, to.z)}};
  return rotated(origin, (1 / sine) * across, to.z, sine);
}

}  // namespace

Pose read_pose(Node const& table) {
  Pose pose;
  if (Node const at = table["at"]) pose.origin = read_vector(at, dim::length);
  Node const face = table["facing"], rotate = table["rotate"];
  if (face && rotate) table.problem("'facing' and 'rotate' both turn the part", "keep one of them");
  if (face)
    if (auto const to = read_direction(face)) return facing(pose.origin, *to);
  if (rotate) {
    if (!rotate.has("axis")) rotate.problem("'axis' is missing", "write {axis: [1, 0, 0], angle: 30 deg}");
    auto const axis = read_direction(rotate["axis"]);
    double const angle = rotate.number("angle", dim::angle, required, -2 * pi, 2 * pi);
    rotate.refuse_unknown("'rotate'");
    if (axis) return rotated(pose.origin, *axis, std::cos(angle), std::sin(angle));
  }
  return pose;
}

// Vectors and directions of a scene. A value that is not a number is reported once, at its place.

Vec3 read_vector(Node const& list, Dimension dimension) {
  auto const v = list.as_numbers(dimension, 3);
  return v.size() == 3 ? Vec3{v[0], v[1], v[2]} : Vec3{not_a_number, not_a_number, not_a_number};
}

bool some_missing(std::vector<double> const& numbers) {
  return std::ranges::any_of(numbers, [](double x) { return std::isnan(x); });
}

std::optional<Vec3> read_direction(Node const& list) {
  Vec3 const v = read_vector(list, dim::plain);
  double const size = length(v);
  if (std::isnan(size)) return {};  // a number that is not there is reported
  if (size > 0 && size < infinity) return unit(v);
  list.problem(size > 0 ? "a direction too long to compute with" : "a direction of length zero",
               "write for example [0, 0, 1]");
  return {};
}

}  // namespace straytrace::world
