// SPDX-License-Identifier: BSD-3-Clause
// Cavities of three mirrors or more: rings and folded ones. Their axis is the ray that closes on itself, their mode the
// eigenmode of its ray matrix (docs/theory/beams.md, Eigenmodes of cavities).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "beams/closed_axis.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/lit_surfaces.hpp"

namespace straytrace::world {
namespace {

constexpr std::size_t most_mirrors = 24;
constexpr double off_vertex = 1e-9;  // m; nearer is rounding of what the scene states

using Mirrors = std::vector<CavityMirror>;

std::string place_text(Vec3 p) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}] m", p.x, p.y, p.z); }
CavityMirror const& before(Mirrors const& all, std::size_t i) { return all[(i + all.size() - 1) % all.size()]; }
CavityMirror const& after(Mirrors const& all, std::size_t i) { return all[(i + 1) % all.size()]; }

// From vertex to vertex: the first mirror that sends the light past the next one.
struct Stray {
  std::size_t mirror = 0;
  double miss = 0;
  Vec3 facing;
};
std::optional<Stray> first_stray(Mirrors const& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    CavityMirror const& m = all[i];
    Vec3 const in = unit(m.vertex - before(all, i).vertex), way = after(all, i).vertex - m.vertex;
    Vec3 const out = in - 2 * dot(in, m.axis) * m.axis;
    double const along = dot(way, out), miss = along > 0 ? length(way - along * out) : length(way);
    if (miss > after(all, i).radius) return Stray{i, miss, unit(unit(way) - in)};
  }
  return {};
}

void explain(Node const& cavity, std::string const& reason, Mirrors const& all, World const& world) {
  auto const name = [&](CavityMirror const& m) { return world.name_of(m.id); };
  if (auto const stray = first_stray(all)) {
    CavityMirror const &here = all[stray->mirror], &next = after(all, stray->mirror);
    return cavity.problem(
        fmt::format("{}: '{}' at {} sends the light of '{}' past '{}' at {}, by {:.3g} m", reason, name(here),
                    place_text(here.vertex), name(before(all, stray->mirror)), name(next), place_text(next.vertex),
                    stray->miss),
        fmt::format("turn it: 'facing: [{:.9g}, {:.9g}, {:.9g}]', or list the mirrors in the order of the light",
                    stray->facing.x, stray->facing.y, stray->facing.z));
  }
  cavity.problem(reason, "change the curvatures, the places or the directions of the mirrors");
}

// The mirrors that the light does not meet on their fronts, or beside their clear apertures.
bool meets_fronts(Node const& cavity, Mirrors const& all, ClosedCavity const& found, World const& world) {
  bool good = true;
  for (std::size_t i = 0; i < all.size() && good; ++i) {
    CavityMirror const& m = all[i];
    Mode const& arriving = found.arriving[i];
    if (double const off = length(arriving.origin - m.vertex); off > m.radius) {
      explain(cavity,
              fmt::format("the axis meets '{}' at {}, {:.3g} m from its vertex, outside its radius of {:g} m",
                          world.name_of(m.id), place_text(arriving.origin), off, m.radius),
              all, world);
      good = false;
    } else if (!(dot(arriving.travel, m.axis) < 0)) {
      cavity.problem(fmt::format("the light meets the back of '{}'", world.name_of(m.id)), "turn its 'facing' around");
      good = false;
    }
  }
  return good;
}

std::string radii_text(Mode const& mode) {
  Spot const s = spot(mode);
  return s.major - s.minor < 5e-4 * s.major ? fmt::format("{:.4g} mm", 1e3 * s.major)
                                            : fmt::format("{:.4g} x {:.4g} mm", 1e3 * s.major, 1e3 * s.minor);
}

void note_mode(Mirrors const& all, ClosedCavity const& found, bool folded, std::string const& beam, World& world) {
  std::vector<std::string> spots, shifts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    spots.push_back(fmt::format("{} on {}", radii_text(found.arriving[i]), world.name_of(all[i].id)));
    Vec3 const off = found.arriving[i].origin - all[i].vertex;
    if (length(off) > off_vertex + 1e-12 * found.length)
      shifts.push_back(fmt::format("{:.3g} mm on {}", 1e3 * length(off), world.name_of(all[i].id)));
  }
  world.notes.push_back(
      fmt::format("beam {}: {} cavity of {:.6g} m per round trip; radius {}; each order in the plane of incidence adds "
                  "{:.5f}, across "
                  "it {:.5f} of the free spectral range",
                  beam, folded ? "folded" : "ring", found.length, fmt::join(spots, ", "), found.gouy[0] / (2 * pi),
                  found.gouy[1] / (2 * pi)));
  if (!shifts.empty())
    world.notes.push_back(
        fmt::format("beam {}: its axis passes the vertices of mirrors at {}", beam, fmt::join(shifts, ", ")));
}

void add_spots(Mirrors const& all, ClosedCavity const& found, Lighting const& light, World& world) {
  double path = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0) path += length(found.arriving[i].origin - found.arriving[i - 1].origin);
    BeamSpot spot;
    spot.surface = all[i].id;
    spot.normal = all[i].axis;
    spot.mode = found.arriving[i];
    spot.power = 1;
    spot.path_length = path;
    add_lit_surface(world, light.number, light.power, Feed::none, spot, {});
  }
}

bool read_mirrors(Node const& cavity, Registry const& names, World const& world, Mirrors& all) {
  bool good = true;
  std::vector<Node> const nodes = cavity.as_list();
  if (nodes.size() > most_mirrors) {
    cavity.problem(fmt::format("a cavity of {} reflections per round trip", nodes.size()),
                   fmt::format("the limit is {}", most_mirrors));
    return false;
  }
  for (Node const& node : nodes) good = read_mirror(node, names, world, all.emplace_back()) && good;
  for (std::size_t i = 0; good && i < all.size(); ++i) {
    if (!std::isfinite(length(all[i].vertex) + all[i].curvature)) return false;  // a missing number, reported
    if (all[i].id != after(all, i).id) continue;
    nodes[i].problem(fmt::format("the light goes from '{}' to itself", nodes[i].text()),
                     "list the mirrors of one round trip, each next to those before and behind it");
    good = false;
  }
  return good;
}

}  // namespace

bool turns_back(std::vector<Node> const& mirrors) {
  std::size_t const n = mirrors.size();
  if (n < 3) return true;
  for (std::size_t first = 0; first < n; ++first) {
    bool same = true;
    for (std::size_t i = 1; i < n && same; ++i)
      same = mirrors[(first + i) % n].text() == mirrors[(first + n - i) % n].text();
    if (same) return true;
  }
  return false;
}

void read_ring_cavity(Node const& beam, Node const& cavity, Registry const& names, World& world,
                      Lighting const& light) {
  if (read_lit(beam, names).wanted)
    beam["lit"].problem("the light that leaves a cavity of three mirrors or more is not followed",
                        "launch a beam 'from' behind the mirror, and remove 'lit'");
  Mirrors all;
  if (!read_mirrors(cavity, names, world, all)) return;
  std::vector<SphericalMirror> mirrors;
  for (CavityMirror const& m : all) mirrors.push_back({m.vertex, m.axis, m.curvature});
  bool const folded = turns_back(cavity.as_list());
  try {
    ClosedCavity const found = closed_cavity(mirrors, world.wavelength);
    if (!meets_fronts(cavity, all, found, world)) return;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (auto const id = obstacle(world, all[i], found.arriving[i].origin, after(all, i),
                                   found.arriving[(i + 1) % all.size()].origin))
        return beam.problem(fmt::format("'{}' obstructs the beam '{}' between '{}' and '{}'", world.name_of(*id),
                                        light.name, world.name_of(all[i].id), world.name_of(after(all, i).id)),
                            "give it a hole or move it");
    add_spots(all, found, light, world);
    note_mode(all, found, folded, light.name, world);
  } catch (NumericalError const& e) {
    explain(cavity, e.what(), all, world);
  }
}

}  // namespace straytrace::world
