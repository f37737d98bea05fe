// SPDX-License-Identifier: BSD-3-Clause
// The table `edges`: rims that diffract light from one mirror of a cavity to the other (docs/theory/diffraction.md).
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "world/build/file_parts.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace {
namespace {

std::vector<std::string> groups_with_rims(World const& world) {
  std::vector<std::string> found;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    std::string const& group = world.groups()[world.surfaces()[id].group.value];
    bool const known = std::find(found.begin(), found.end(), group) != found.end();
    if (!known && rim_of(world, {id})) found.push_back(group);
  }
  return found;
}

void read_group(Node const& node, World& world, std::vector<std::string> const& with_rims) {
  std::string const pattern = node.as_word();
  std::vector<std::string>& chosen = world.edges.groups;
  bool any = false;
  for (std::string const& group : with_rims) {
    if (!matches(pattern, group)) continue;
    any = true;
    if (std::find(chosen.begin(), chosen.end(), group) == chosen.end()) chosen.push_back(group);
  }
  if (any) return;
  auto const& all = world.groups();
  bool const solid = std::any_of(all.begin(), all.end(), [&](auto const& group) { return matches(pattern, group); });
  std::string const near = nearest_word(pattern, with_rims);
  node.problem(
      solid ? fmt::format("'{}' has no inner rim", pattern) : fmt::format("'{}' is not an entry of 'scene'", pattern),
      !near.empty() && !solid
          ? fmt::format("did you mean '{}'?", near)
          : (with_rims.empty() ? std::string("rims are those of disks, caps and cones with an inner radius")
                               : fmt::format("entries with inner rims: {}", fmt::join(with_rims, ", "))));
}

// Of the smallest rim that is chosen, m.
double smallest_rim(World const& world) {
  double radius = infinity;
  auto const& chosen = world.edges.groups;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (auto const rim = rim_of(world, {id}))
      if (std::find(chosen.begin(), chosen.end(), world.groups()[world.surfaces()[id].group.value]) != chosen.end())
        radius = std::min(radius, rim->radius);
  return radius;
}

// Teeth and offsets that the smallest rim has no room for.
void check_sizes(Node const& table, World const& world) {
  double const radius = smallest_rim(world);
  if (!(radius < infinity)) return;
  EdgeSettings const& edges = world.edges;
  auto const refuse = [&](std::string_view key, double size, double most, char const* of) {
    if (!table.has(key) || !(size >= most)) return;
    table[key].problem(fmt::format("{} of {:.4g} m does not fit a rim of radius {:.4g} m", key, size, radius),
                       fmt::format("take less than {:.4g} m, {} of the smallest rim in 'surfaces'", most, of));
  };
  refuse("offset", length(edges.offset), radius, "the radius");
  refuse("tooth_height", edges.tooth_height, radius, "the radius");
  refuse("tooth_width", edges.tooth_width, 2 * pi * radius, "the circumference");
}

bool has_cavity(World const& world) {
  return std::any_of(world.footprints().begin(), world.footprints().end(), [](auto const& f) { return f.standing; });
}

}  // namespace

void read_edges(Scene const& scene, World& world) {
  Node const table = scene.table("edges");
  if (!table) return;
  EdgeSettings& edges = world.edges;
  std::vector<std::string> const with_rims = groups_with_rims(world);
  std::vector<Node> const surfaces = table.list("surfaces");
  if (surfaces.empty())
    table.problem("'edges' names no surfaces", "add 'surfaces: \"baffles*\"', entries of 'scene' with inner rims");
  for (Node const& node : surfaces) read_group(node, world, with_rims);
  if (table.has("offset")) edges.offset = read_vector(table["offset"], dim::length);
  edges.tooth_height = table.number("tooth_height", dim::length, 0, 0, 1);
  if (table.has("tooth_width") && !table.has("tooth_height"))
    table["tooth_width"].problem("'tooth_width' without 'tooth_height'", "give both, or neither");
  if (table.has("tooth_height")) edges.tooth_width = table.number("tooth_width", dim::length, required, 1e-5, 1);
  check_sizes(table, world);
  static constexpr std::array<std::string_view, 3> sums = {"independent", "geometric", "in-phase"};
  std::string const sum = table.choice("sum", sums, "independent");
  edges.sum = EdgeSettings::Sum(std::find(sums.begin(), sums.end(), sum) - sums.begin());
  if (!has_cavity(world) && table.healthy())
    table.problem("no beam is the mode of a cavity, between whose mirrors rims could diffract",
                  "add 'beams: {arm: {cavity: [ITM, ETM]}}', or leave 'edges' out");
  table.refuse_unknown("'edges'");
}

}  // namespace straytrace
