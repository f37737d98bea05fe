// SPDX-License-Identifier: BSD-3-Clause
// Table `receivers` -> where light is counted in watts. Page: docs/reference/receivers.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/input/document.hpp"
#include "base/text/words.hpp"
#include "io/delimited_text.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/obstacle.hpp"
#include "world/model/receiver.hpp"

namespace straytrace::world {
namespace {

constexpr double most_pixels = 4096, most_cells = 1 << 20;

// Frame of a map: centre and turn are given in the frame of the surface.
Pose read_frame(Node const& table, Pose const& surface) {
  double x = 0, y = 0;
  if (Node const centre = table["centre"]) {
    auto const v = centre.as_numbers(dim::length, 2);
    if (v.size() == 2) {
      x = v[0];
      y = v[1];
    }
  }
  Pose frame = turned_about_normal(surface, table.number("turn", dim::angle, 0, -2 * pi, 2 * pi));
  frame.origin = surface.point({x, y, 0});
  return frame;
}

// All of the surface; rectangles are charted by their own sides.
void chart_surface(Node const& map, World const& world, Receiver& r) {
  for (char const* key : {"height", "centre"})
    if (Node const value = map[key])
      value.problem(fmt::format("'{}' is for a map with a 'width'", key),
                    "give 'width', or remove it: the map then covers the whole surface");
  if (!r.surface.valid()) return;
  WorldView const view = world.view();
  auto const [chart, whole] = chart_of(view, std::span(&r.surface, 1));
  r.chart = chart;
  r.whole = whole;
  view.shapes.visit(view.surfaces[r.surface.value].shape, [&](auto const& s) {
    if constexpr (std::is_same_v<std::decay_t<decltype(s)>, Rectangle>)
      r.whole = {-0.5 * s.width, 0.5 * s.width, -0.5 * s.height, 0.5 * s.height};
    if (dot(s.axis, r.frame.e3) < 1 - 1e-12) r.frame = facing_along(s.reference(), s.axis);
    r.frame.origin = s.reference();
  });
}

// Adaptive cells: of the whole surface, or of a stated part.
void read_map_by_light(Node const& map, Pose const& surface, World const& world, Receiver& r) {
  r.by_light = true;
  if (map.has("width")) {
    r.half_width = 0.5 * map.number("width", dim::length, required, 1e-9, 1e6);
    r.half_height = 0.5 * map.number("height", dim::length, 2 * r.half_width, 1e-9, 1e6);
    r.whole = {-r.half_width, r.half_width, -r.half_height, r.half_height};
    r.frame = read_frame(map, surface);
  } else {
    r.frame = turned_about_normal(surface, map.number("turn", dim::angle, 0, -2 * pi, 2 * pi));
    chart_surface(map, world, r);
  }
  map.refuse_unknown("'map'");
}

void read_map(Node const& map, Pose const& surface, World const& world, Receiver& r) {
  if (!map) return;
  Node const pixels = map["pixels"];
  if (!pixels) return read_map_by_light(map, surface, world, r);
  auto const count = pixels.as_numbers(dim::plain, 2);
  bool sound = count.size() == 2;
  for (double const n : count) sound = sound && n >= 1 && n <= most_pixels && n == std::floor(n);
  if (count.size() == 2 && !sound && pixels.healthy())
    pixels.problem("the number of pixels is not a whole number",
                   fmt::format("write two whole numbers from 1 to {:g}", most_pixels));
  r.half_width = 0.5 * map.number("width", dim::length, required, 1e-9, 1e6);
  double const square = sound ? 2 * r.half_width * count[1] / count[0] : 1;
  r.half_height = 0.5 * map.number("height", dim::length, square > 0 ? square : 1, 1e-9, 1e6);
  r.frame = read_frame(map, surface);
  map.refuse_unknown("'map'");
  if (sound && count[0] * count[1] > most_cells) {
    pixels.problem("the map has more than a million pixels", "write for example pixels: [512, 512]");
    sound = false;
  }
  if (!sound) return;
  r.columns = std::uint32_t(count[0]);
  r.rows = std::uint32_t(count[1]);
}

void read_angles(Node const& angles, Receiver& r) {
  if (!angles) return;
  r.angle_bins = std::uint32_t(angles.whole("bins", 32, 1, 1024));
  r.half_angle_sine = std::sin(angles.number("half_angle", dim::angle, 0.5 * pi, 1e-9, 0.5 * pi));
  angles.refuse_unknown("'angles'");
}

void read_quadrants(Node const& quadrants, Pose const& surface, Receiver& r) {
  if (!quadrants) return;
  r.quadrants = true;
  r.gap = quadrants.number("gap", dim::length, 0, 0, 1e3);
  r.quadrant_frame = read_frame(quadrants, surface);
  quadrants.refuse_unknown("'quadrants'");
}

// A separate plane: light passes, or ends on it.
bool read_own(std::string const& name, Node const& node, World& world, Registry const& names, Pose& frame,
              Receiver& r) {
  frame = read_pose(node);
  if (std::ranges::find(world.groups(), name) != world.groups().end())
    node.problem(fmt::format("an entry of 'scene' is already called '{}'", name), "choose another name");
  r.clear = node.flag("passes", true);
  Surface as;
  as.front = as.back = names.black;
  as.group = world.add_group(name);
  r.surface = read_shape(node["shape"], as, frame, world);
  if (!r.surface.valid()) return false;
  bool const flat = world.view().shapes.visit(world.surfaces()[r.surface.value].shape, [](auto const& s) {
    using Shape = std::decay_t<decltype(s)>;
    return std::is_base_of_v<PlaneFrame, Shape> || std::is_same_v<Shape, Disk>;
  });
  if (r.clear && !flat) {
    node["shape"].problem("a measuring plane must be flat",
                          "use shape disk, rectangle, ellipse or polygon, or passes: no");
    return false;
  }
  return true;
}

bool read_place(std::string const& name, Node const& node, World& world, Registry const& names, Pose& frame,
                Receiver& r) {
  Node const on = node["on"];
  if (on && node.has("shape")) {
    node.problem("'on' and 'shape' are both given", "name a surface of the scene, or describe a plane: not both");
    return false;
  }
  if (node.has("shape")) return read_own(name, node, world, names, frame, r);
  if (!on) {
    node.problem(fmt::format("receiver '{}' has no place", name),
                 "give 'on: SURFACE', or 'shape: {disk: {outer_radius: 5 cm}}' with 'at' and 'facing'");
    return false;
  }
  r.surface = find_surface(on, names);
  if (!r.surface.valid()) return false;
  auto const known = names.frames.find(r.surface.value);
  frame = known != names.frames.end()
              ? known->second
              : world.view().shapes.visit(world.surfaces()[r.surface.value].shape,
                                          [](auto const& s) { return facing_along(s.reference(), s.axis); });
  for (char const* key : {"passes", "at", "facing", "rotate"})
    if (Node const value = node[key])
      value.problem(fmt::format("'{}' is only for a separate plane", key),
                    "the scene places the surface, and its material determines transmission");
  return true;
}

bool name_allowed(std::string const& name) {
  return !name.empty() && name.find_first_of("*:,<>|\"'\\ \t") == name.npos && name[0] != '.';
}

void read_receiver(std::string const& name, Node const& node, World& world, Registry const& names) {
  if (node.kind() != Node::Kind::table) {
    node.problem(fmt::format("receiver '{}' is a table of keys", name), "write {on: SURFACE}");
    return;
  }
  if (!name_allowed(name))
    node.problem(fmt::format("'{}' cannot name a receiver", name), "use letters, digits, '_', '-' and '/'");
  static constexpr std::array<std::string_view, 3> sides = {"both", "front", "back"};
  Receiver r;
  Pose frame;
  bool const placed = read_place(name, node, world, names, frame, r);
  std::string const side = node.choice("side", sides, "both");
  r.front = side != "back";
  r.back = side != "front";
  r.frame = frame;
  r.behind_glass = node.flag("behind_glass", false);
  read_map(node.table("map"), frame, world, r);
  read_angles(node.table("angles"), r);
  read_quadrants(node.table("quadrants"), frame, r);
  node.refuse_unknown(fmt::format("receiver '{}'", name));
  if (placed) world.add_receiver(name, r);
}

}  // namespace

Pose turned_about_normal(Pose const& p, double angle) {
  double const c = std::cos(angle), s = std::sin(angle);
  return {p.origin, c * p.e1 + s * p.e2, c * p.e2 - s * p.e1, p.e3};
}

bool is_refused(std::string const& pattern, Registry const& names) {
  return std::ranges::any_of(names.refused, [&](std::string const& entry) {
    return matches(pattern, entry) || pattern.starts_with(entry + "/") || pattern.starts_with(entry + "[");
  });
}

SurfaceId find_surface(Node const& node, Registry const& names) {
  std::string const name = node.as_word();
  if (is_refused(name, names)) return {};
  auto const found = names.surfaces.find(name);
  if (found != names.surfaces.end()) return found->second;
  std::vector<std::string> known, faces;
  for (auto const& [n, id] : names.surfaces) {
    known.push_back(n);
    if (n.starts_with(name + "/")) faces.push_back(n);
  }
  if (!faces.empty()) {
    node.problem(
        fmt::format("'{}' has several faces", name),
        fmt::format("name one: {}{}", fmt::join(std::span(faces).first(std::min<std::size_t>(4, faces.size())), ", "),
                    faces.size() > 4 ? ", ..." : ""));
    return {};
  }
  node.problem(fmt::format("'{}' is not a surface of the scene", name),
               did_you_mean(name, known, "name an entry of 'scene'"));
  return {};
}

void read_receivers(Scene const& scene, World& world, Registry const& names) {
  for (auto const& [name, node] : scene.table("receivers").items()) read_receiver(name, node, world, names);
}

// The list `photodiodes` of the table `wave`: where light of the field is measured.

namespace {

constexpr std::size_t most_diodes = 2000;  // of all sets: their covariance is a matrix

using Set = WaveSettings::Photodiodes;

// The screen on which diodes sit, as far as it is known.
struct Annulus {
  double inner = 0, outer = infinity;  // m
};

// A baffle of the field, or one of the mirrors. Invalid after a problem.
SurfaceId read_screen(Node const& set, World const& world, Registry const& names, Annulus& annulus) {
  Node const on = set["on"];
  if (!on) {
    set.lack("on", "the photodiodes have no place: 'on' is missing", "name a baffle of 'baffles', or a mirror");
    return {};
  }
  SurfaceId const surface = find_surface(on, names);
  if (!surface.valid()) return {};
  auto const extent =
      world.view().shapes.visit(world.surfaces()[surface.value].shape, [](auto const& s) { return s.extent(); });
  WaveSettings const& wave = world.wave;
  if (std::ranges::any_of(wave.mirrors, [&](auto const& m) { return m.surface == surface; })) {
    annulus.inner = extent.r_max;
    return surface;
  }
  auto const rim = rim_of(world, surface);
  if (!rim || std::ranges::find(wave.groups, world.name_of(surface)) == wave.groups.end()) {
    on.problem(fmt::format("'{}' is not a screen of the field", on.text()),
               "name a baffle that is in 'baffles', or a mirror of the cavity");
    return {};
  }
  annulus = {rim->radius + rim->tooth_depth, extent.r_max};
  return surface;
}

void read_towards(Node const& table, World const& world, Registry const& names, Set& set) {
  if (!table.has("towards")) {
    table.lack("towards", "'towards' is missing: the mirror to which the light travels that meets the photodiodes",
               "name one of the two mirrors");
    return;
  }
  Node const towards = table["towards"];
  SurfaceId const mirror = find_surface(towards, names);
  auto const& mirrors = world.wave.mirrors;
  if (!mirror.valid() || !mirrors[0].surface.valid() || world.wave.ring) return;  // the problem is reported
  auto const at = std::ranges::find(mirrors, mirror, &WaveSettings::Mirror::surface);
  if (at == mirrors.end()) {
    towards.problem(
        fmt::format("'{}' is not a mirror of the cavity", towards.text()),
        fmt::format("its mirrors: {}, {}", world.name_of(mirrors[0].surface), world.name_of(mirrors[1].surface)));
    return;
  }
  set.towards = std::size_t(at - mirrors.begin());
  bool const on_other = set.on.valid() && set.on == mirrors[1 - set.towards].surface;
  if (on_other)
    towards.problem("light around a mirror travels towards it", fmt::format("write 'towards: {}'", table["on"].text()));
}

void read_ring(Node const& table, Set& set) {
  double const radius = table.number("radius", dim::length, required, 1e-6, 100);
  std::size_t const count = table.whole("count", required, 1, most_diodes);
  double const first = table.number("azimuth", dim::angle, 0, -2 * pi, 2 * pi);
  for (std::size_t i = 0; i < count; ++i) set.places.push_back({radius, first + 2 * pi * double(i) / double(count)});
  if (count < 2 || set.shape == Set::Shape::sector || std::isnan(radius) || std::isnan(set.size)) return;
  // Neighbours share the line half way between them.
  double const half = std::tan(pi / double(std::max(count, std::size_t{3})));
  double const most =
      set.shape == Set::Shape::round ? 2 * radius * std::sin(pi / double(count)) : 2 * radius * half / (1 + half);
  if (set.size > most)
    table["count"].problem(
        fmt::format("{} photodiodes of {:.4g} m overlap on a ring of radius {:.4g} m", count, set.size, radius),
        fmt::format("a size of at most {:.4g} m fits", most));
}

void read_points(Node const& table, Set& set) {
  Node const file = table["file"];
  std::string const name = file.as_word();
  for (char const* key : {"radius", "count", "azimuth"})
    if (table.has(key))
      table[key].problem(fmt::format("'{}' is for a ring, and 'file' has the places", key),
                         fmt::format("remove '{}'", key));
  if (set.shape == Set::Shape::sector)
    table["shape"].problem("sectors make a ring, and 'file' has places of single photodiodes",
                           "write 'shape: square' or 'shape: round'");
  if (name.empty()) return;
  CsvTable const points = read_csv_table(file, name, Comments::anywhere, "x [mm], y [mm]");
  if (!points.whole) return;
  int const x = points.find("x"), y = points.find("y");
  for (auto const& [column, title] : {std::pair{x, "x"}, std::pair{y, "y"}}) {
    if (column < 0)
      file.file_problem(name, 1, 1, fmt::format("no column '{}'", title), "write the header 'x [mm], y [mm]'");
    else if (auto const& c = points.columns[std::size_t(column)]; c.unit.dimension != dim::length)
      file.file_problem(name, c.line, c.at, wrong_unit(c, dim::length), fmt::format("write '{} [mm]'", title));
    else
      continue;
    return;
  }
  for (CsvTable::Row const& row : points.rows) {
    double const px = row.values[std::size_t(x)], py = row.values[std::size_t(y)];
    set.places.push_back({std::hypot(px, py), std::atan2(py, px)});
  }
  if (set.places.empty()) file.file_problem(name, 0, 0, "it has no photodiode", "write a row for each");
}

// Between the opening and the outer edge of the screen.
void check_places(Node const& table, Annulus const& annulus, Set const& set) {
  for (std::size_t i = 0; i < set.places.size(); ++i) {
    double const r = set.places[i].radius, half = set.size / 2;
    double const out = set.shape == Set::Shape::square ? std::hypot(r + half, half) : r + half;
    if (std::isnan(r) || std::isnan(half) || (r - half >= annulus.inner && out <= annulus.outer)) continue;
    std::string const within = annulus.outer < infinity
                                   ? fmt::format("from {:.4g} m to {:.4g} m", annulus.inner, annulus.outer)
                                   : fmt::format("beyond {:.4g} m", annulus.inner);
    table.problem(fmt::format("photodiode {} of '{}' reaches from {:.4g} m to {:.4g} m, while '{}' lies {}", i + 1,
                              set.name, r - half, out, table["on"].text(), within),
                  "move it onto the screen, or make it smaller");
    return;  // one of each set
  }
}

Set read_set(Node const& table, World const& world, Registry const& names) {
  static constexpr std::array<std::string_view, 3> shapes = {"square", "round", "sector"};
  Set set;
  set.name = table.word("name");
  Annulus annulus;
  set.on = read_screen(table, world, names, annulus);
  read_towards(table, world, names, set);
  set.size = table.number("size", dim::length, required, 1e-6, 10);
  set.shape = Set::Shape(std::ranges::find(shapes, table.choice("shape", shapes, "square")) - shapes.begin());
  if (table.has("file"))
    read_points(table, set);
  else
    read_ring(table, set);
  if (set.on.valid()) check_places(table, annulus, set);
  table.refuse_unknown("a set of photodiodes");
  return set;
}

}  // namespace

void read_photodiodes(Node const& wave, World& world, Registry const& names) {
  std::size_t count = 0;
  for (Node const& table : wave.list("photodiodes")) {
    if (table.kind() != Node::Kind::table) {
      if (table)
        table.problem("a set of photodiodes is a table",
                      "write {name: ring, on: baffle, towards: ETM, radius: 10 cm, count: 16, size: 7 mm}");
      continue;
    }
    Set set = read_set(table, world, names);
    if (std::ranges::find(world.wave.photodiodes, set.name, &Set::name) != world.wave.photodiodes.end())
      table["name"].problem(fmt::format("two sets of photodiodes are called '{}'", set.name), "choose another name");
    count += set.places.size();
    world.wave.photodiodes.push_back(std::move(set));
  }
  if (count > most_diodes)
    wave["photodiodes"].problem(fmt::format("{} photodiodes are too many", count),
                                fmt::format("{} are the most", most_diodes));
}

}  // namespace straytrace::world
