// SPDX-License-Identifier: BSD-3-Clause
// Beams without effect: they meet only absorbing sides, or no surface at all.
#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include "world/build/read_parts.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::world {
namespace {

constexpr int across = 64;  // lines tried in radius, and in azimuth

// Whether `found` holds for the chief line or any other of the beam.
template <class Found>
bool any_line(Footprint const& f, Found const& found) {
  if (found(Ray{f.centre - f.backoff * f.travel, f.travel})) return true;
  for (int i = 0; i < across; ++i)
    for (int k = 0; k < across; ++k)
      if (found(f.sample((i + 0.5) / across, (k + 0.5) / across))) return true;
  return false;
}

bool meets_plane(World const& world, Ray const& ray) {  // a measuring plane
  WorldView const view = world.view();
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id)
    if (view.surfaces[id].clear && view.cross(id, ray, {}).distance < infinity) return true;
  return false;
}

void check_free(Node const& beam, std::string const& name, Footprint const& f, World const& world) {
  WorldView const view = world.view();
  bool const met = any_line(f, [&](Ray line) {
    line.dir = f.direction(line.origin);
    return view.closest(line, {}).surface.valid() || meets_plane(world, line);
  });
  if (!met) beam.warning(fmt::format("beam '{}' meets no surface", name), "turn 'facing', or move 'from'");
}

std::string opposite(Vec3 v) { return fmt::format("[{:g}, {:g}, {:g}]", 0 - v.x, 0 - v.y, 0 - v.z); }

void check_spot(Node const& beam, std::string const& name, Footprint const& f, World const& world) {
  WorldView const view = world.view();
  Surface const& surface = world.surfaces()[f.surface.value];
  std::string const& lit = world.groups()[surface.group.value];
  bool met = false, front = false;
  bool const alive = any_line(f, [&](Ray const& line) {
    Crossing const c = view.cross(f.surface.value, line, {});
    if (!(c.distance < infinity)) return false;
    met = true;
    front = dot(view.normal(f.surface, line.origin + c.distance * line.dir, c.piece), line.dir) < 0;
    return !only_absorbs(view.optics[front ? surface.front : surface.back]);
  });
  if (alive) return;
  if (!met)
    return beam.warning(fmt::format("beam '{}' does not meet '{}'", name, lit),
                        "change 'travel', 'centre' or 'radius'");
  bool const other = !only_absorbs(view.optics[front ? surface.back : surface.front]);
  beam.problem(fmt::format("beam '{}' lights the side of '{}' that only absorbs: no light starts there", name, lit),
               other
                   ? fmt::format("its light travels along {}: write 'travel: {}', or change 'side' or 'facing' of '{}'",
                                 opposite(-f.travel), opposite(f.travel), lit)
                   : fmt::format("give the material of '{}' a 'scatter', or 'specular'", lit));
}

// Light of one beam by propagation and of another by statement is probably the same light. A ghost is that of another
// beam only where the scene states it, with about its power.
bool same_light(World const& world, std::uint32_t followed, std::uint32_t other) {
  Footprint const &f = world.footprints()[followed], &g = world.footprints()[other];
  if (g.free || f.beam == g.beam || f.surface != g.surface || !f.emits || !g.emits) return false;
  if (world.feeds()[followed].order > 0 || world.feeds()[other].order > 0) {
    bool const alike = f.share < 3 * g.share && g.share < 3 * f.share;
    if (world.feeds()[other].propagated || !alike) return false;
  }
  return dot(f.travel, g.travel) > 0.99 && f.intensity(g.centre) > 0.1 * f.intensity(f.centre);
}
void warn_of_light_counted_twice(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  auto const count = std::uint32_t(world.footprints().size());
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t j = 0; world.feeds()[i].propagated && j < count; ++j)
      if (same_light(world, i, j))
        return beams[world.beams[world.footprints()[i].beam].entry].second.warning(
            fmt::format("'{}' is lit by beam '{}' too, along the same way",
                        world.groups()[world.surfaces()[world.footprints()[i].surface.value].group.value],
                        world.beams[world.footprints()[j].beam].name),
            "if it is the same light, keep one of them: it is counted twice");
}

// A beam that loses much power at a rim is no longer Gaussian behind it. read_lit.cpp reports the losses beside
// surfaces for beams with `lit`.
void warn_of_clipping(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  std::set<std::pair<std::uint32_t, std::uint32_t>> said;
  for (MainLoss const& loss : main_losses(world)) {
    GroupId const group = world.surfaces()[loss.surface.value].group;
    auto const& [name, entry, network, share] = world.beams.at(loss.beam);
    Node const node = beams.at(entry).second;
    bool const lit = node.has("lit");
    if ((loss.beside && lit) || !said.insert({loss.beam, group.value}).second) continue;
    node.warning(fmt::format("beam '{}' loses {:.2g} % {} '{}'", name, 100 * loss.share, loss.beside ? "beside" : "on",
                             world.groups()[group.value]),
                 "behind it the beam is still taken as Gaussian: widen the aperture or centre it on the beam");
  }
}

// Sub-paths behind glass do not follow polarisation.
void warn_of_glass_in_polarised_light(Scene const& scene, World const& world) {
  if (!world.polarised) return;
  for (auto const& [name, node] : scene.table("receivers").items())
    if (node.flag("behind_glass", false))
      node["behind_glass"].warning("'behind_glass' does nothing where a beam states its polarisation",
                                   "light by way of glass is then found by the walk alone, slowly");
}

}  // namespace

void check_beams(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.emits || f.standing || world.feeds()[i].propagated || f.beam >= beams.size()) continue;
    auto const& [name, node] = beams[f.beam];
    if (f.free)
      check_free(node, name, f, world);
    else
      check_spot(node, name, f, world);
  }
  warn_of_light_counted_twice(scene, world);
  if (scene.root().healthy()) warn_of_clipping(scene, world);
  warn_of_glass_in_polarised_light(scene, world);
}

}  // namespace straytrace::world
