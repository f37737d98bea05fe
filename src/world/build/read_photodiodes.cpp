// SPDX-License-Identifier: BSD-3-Clause
// The list `photodiodes` of the table `wave`: where light of the field is measured.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/input/document.hpp"
#include "io/delimited_text.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::world {
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
