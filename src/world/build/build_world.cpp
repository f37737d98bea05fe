// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/words.hpp"
#include "base/units/media_presets.hpp"
#include "scene/library.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::world {

void read_trace_limits(Scene const& scene, World& world) {
  Node const t = scene.table("trace");
  if (!t) return;
  world.limits.max_order = std::uint32_t(t.whole("order_limit", world.limits.max_order, 1, 1e6));
  world.limits.roulette_below = t.number("roulette_below", dim::plain, world.limits.roulette_below, 0, 1);
  world.limits.route_vertices = std::uint32_t(t.whole("route_vertices", world.limits.route_vertices, 2, 8));
  world.limits.targets = t.flag("targets", true);
  world.limits.law_share = t.number("law_share", dim::plain, world.limits.law_share, 0.1, 1);
  world.limits.window = t.flag("window", true);
  world.limits.children = std::uint32_t(t.whole("children", world.limits.children, 1, 100000));
  world.reverse_routes = t.flag("reverse_routes", true);
  static constexpr std::string_view structures[] = {"axial", "none"};
  world.limits.brute_force = t.choice("structure", structures, "axial") == "none";
}

World build_world(Scene const& scene) { return build_world(scene, {}); }

World build_world(Scene const& scene, NetworkPowers const& powers) {
  World world;
  Registry names;
  world.notes = assumed_parameters(scene);
  read_media(scene, world, names);
  read_materials(scene, world, names);
  read_bodies(scene, world, names);
  read_surfaces(scene, world, names);
  world.settle_pivots();
  read_receivers(scene, world, names);
  read_beams(scene, world, names, powers);
  read_edges(scene, world, names);
  read_wave(scene, world, names);
  read_imperfections(scene, world, names);
  read_trace_limits(scene, world);
  if (scene.root().healthy()) {  // shapes with missing numbers cannot be searched
    world.finish();
    check_lays(scene, world);
    check_glass(scene, world, names);
    check_beams(scene, world);
    check_faces(scene, world);
  }
  return world;
}

// The table `media`: the filling of volumes. Also the wavelength, which indices and films need first.

namespace {

// A preset at the wavelength of the scene; empty after a problem, if the wavelength is out of range.
std::optional<Medium> from_preset(Node const& where, MediumPreset const& preset, double wavelength) {
  if (auto const index = index_of(preset, wavelength)) return Medium{*index, 0};
  where.problem(fmt::format("the index of '{}' is known from {:.0f} nm to {:.0f} nm only", preset.name,
                            preset.shortest * 1e9, preset.longest * 1e9),
                "give the index at the wavelength of the beams: 'media: {name: {index: 1.45}}'");
  return {};
}

MediumPreset const* find_preset(std::string_view name) {
  for (MediumPreset const& p : medium_presets())
    if (p.name == name) return &p;
  return nullptr;
}

}  // namespace

void read_media(Scene const& scene, World& world, Registry& names) {
  for (auto const& [name, beam] : scene.table("beams").items()) {
    double const wavelength = beam.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
    if (!std::isnan(wavelength)) world.wavelength = wavelength;
    break;  // one for all beams
  }
  for (auto const& [name, node] : scene.table("media").items()) {
    Medium medium;
    if (node.has("preset")) {
      if (node.has("index")) node.problem("'preset' and 'index' both set the index", "keep one of them");
      auto const found = find_medium(node["preset"], world, Registry{});
      if (found) medium = *found;
    } else {
      medium.index = node.number("index", dim::plain, required, 0.1, 10);
    }
    medium.absorption = node.number("absorption", dim::per_metre, 0, 0, 1e9);
    node.has("source");
    node.refuse_unknown(fmt::format("medium '{}'", name));
    names.media[name] = medium;
  }
}

bool is_medium(std::string_view name, Registry const& names) {
  return name == "vacuum" || find_preset(name) || names.media.contains(std::string(name));
}

std::optional<Medium> find_medium(Node const& where, World const& world, Registry const& names) {
  std::string const name = where.as_word();
  if (name.empty()) return {};
  if (auto const own = names.media.find(name); own != names.media.end()) return own->second;
  if (name == "vacuum") return Medium{};
  if (MediumPreset const* const preset = find_preset(name)) return from_preset(where, *preset, world.wavelength);
  std::vector<std::string> known{"vacuum"};
  for (MediumPreset const& p : medium_presets()) known.emplace_back(p.name);
  for (auto const& [own, medium] : names.media) known.push_back(own);
  std::string all;
  for (std::string const& k : known) all += (all.empty() ? "" : ", ") + k;
  where.problem(fmt::format("medium '{}' is not defined", name), did_you_mean(name, known, "known media: " + all));
  return {};
}

std::vector<KnownMedium> known_media() {
  std::vector<KnownMedium> all;
  for (MediumPreset const& p : medium_presets())
    for (double const wavelength : {1064e-9, 1550e-9})
      if (auto const index = index_of(p, wavelength)) {
        all.push_back({std::string(p.name), std::string(p.source), *index, wavelength});
        break;
      }
  return all;
}

// The table `edges`: rims that diffract light from one mirror of a cavity to the other (docs/theory/diffraction.md).

std::vector<std::string> groups_with_rims(World const& world) {
  std::vector<std::string> found;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    std::string const& group = world.name_of({id});
    bool const known = std::ranges::find(found, group) != found.end();
    if (!known && rim_of(world, {id})) found.push_back(group);
  }
  return found;
}

void choose_rims(Node const& node, World const& world, Registry const& names, std::vector<std::string> const& with_rims,
                 std::vector<std::string>& chosen) {
  std::string const pattern = node.as_word();
  bool any = false;
  for (std::string const& group : with_rims) {
    if (!matches(pattern, group)) continue;
    any = true;
    if (std::ranges::find(chosen, group) == chosen.end()) chosen.push_back(group);
  }
  if (any || is_refused(pattern, names)) return;
  auto const& all = world.groups();
  bool const solid = std::ranges::any_of(all, [&](auto const& group) { return matches(pattern, group); });
  std::string const near = nearest_word(pattern, with_rims);
  node.problem(
      solid ? fmt::format("'{}' has no inner edge", pattern) : fmt::format("'{}' is not an entry of 'scene'", pattern),
      !near.empty() && !solid
          ? fmt::format("did you mean '{}'?", near)
          : (with_rims.empty() ? std::string("inner edges are those of disks, caps and cones with an inner radius")
                               : fmt::format("entries with inner edges: {}", fmt::join(with_rims, ", "))));
}

namespace {

// Of the smallest rim that is chosen, m.
double smallest_rim(World const& world) {
  double radius = infinity;
  auto const& chosen = world.edges.groups;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (auto const rim = rim_of(world, {id}))
      if (std::ranges::find(chosen, world.name_of({id})) != chosen.end()) radius = std::min(radius, rim->radius);
  return radius;
}

// Teeth and offsets that are too large for the smallest rim.
void check_sizes(Node const& table, World const& world) {
  double const radius = smallest_rim(world);
  if (!(radius < infinity)) return;
  EdgeSettings const& edges = world.edges;
  auto const refuse = [&](std::string_view key, double size, double most, char const* of) {
    if (!table.has(key) || !(size >= most)) return;
    table[key].problem(fmt::format("{} of {:.4g} m is too large for an edge of radius {:.4g} m", key, size, radius),
                       fmt::format("choose less than {:.4g} m, {} of the smallest edge in 'surfaces'", most, of));
  };
  refuse("offset", length(edges.offset), radius, "the radius");
  refuse("tooth_height", edges.tooth_height, radius, "the radius");
  refuse("tooth_width", edges.tooth_width, 2 * pi * radius, "the circumference");
}

bool has_cavity(World const& world) {
  return std::ranges::any_of(world.footprints(), [](auto const& f) { return f.standing; });
}

}  // namespace

void read_edges(Scene const& scene, World& world, Registry const& names) {
  Node const table = scene.table("edges");
  if (!table) return;
  EdgeSettings& edges = world.edges;
  std::vector<std::string> const with_rims = groups_with_rims(world);
  std::vector<Node> const surfaces = table.list("surfaces");
  if (surfaces.empty())
    table.problem("'edges' names no surfaces", "add 'surfaces: \"baffles*\"', entries of 'scene' with inner edges");
  for (Node const& node : surfaces) choose_rims(node, world, names, with_rims, edges.groups);
  if (table.has("offset")) edges.offset = read_vector(table["offset"], dim::length);
  edges.tooth_height = table.number("tooth_height", dim::length, 0, 0, 1);
  if (table.has("tooth_width") && !table.has("tooth_height"))
    table["tooth_width"].problem("'tooth_width' without 'tooth_height'", "give both, or neither");
  if (table.has("tooth_height")) edges.tooth_width = table.number("tooth_width", dim::length, required, 1e-5, 1);
  check_sizes(table, world);
  static constexpr std::array<std::string_view, 3> sums = {"independent", "geometric", "in-phase"};
  std::string const sum = table.choice("sum", sums, "independent");
  edges.sum = EdgeSettings::Sum(std::ranges::find(sums, sum) - sums.begin());
  if (!has_cavity(world) && table.healthy())
    table.problem("no beam is the mode of a cavity, so no edge can diffract between its mirrors",
                  "add 'beams: {arm: {cavity: [ITM, ETM]}}', or remove 'edges'");
  table.refuse_unknown("'edges'");
}

}  // namespace straytrace::world
