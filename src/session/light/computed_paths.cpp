// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/computed_paths.hpp"

#include <algorithm>

#include "world/ghosts/obstacle.hpp"

namespace straytrace::session {
namespace {

Footprint const* standing_on(World const& world, GroupId group) {
  for (Footprint const& f : world.footprints())
    if (f.standing && f.surface.valid() && world.surfaces()[f.surface.value].group == group) return &f;
  return nullptr;
}

PathPoint on_surface(World const& world, SurfaceId id, Vec3 point, Event event) {
  Surface const& s = world.surfaces()[id.value];
  return {point, event, s.group, s.body, id};
}

std::vector<DrawnPath> by_rims(World const& world, CouplingClass const& c, std::size_t most) {
  std::vector<DrawnPath> all;
  if (c.steps.size() != 3) return all;
  Footprint const *const from = standing_on(world, c.steps.front().group), *const to =
                                                                               standing_on(world, c.steps.back().group);
  std::vector<InnerRim> rims;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (world.surfaces()[id].group == c.steps[1].group)
      if (auto const rim = rim_of(world, {id})) rims.push_back(*rim);
  if (!from || !to || rims.empty()) return all;
  for (std::size_t i = 0; i < most; ++i) {
    InnerRim const& rim = rims[i * rims.size() / most];
    DrawnPath path;
    path.route = c.hash;
    path.computed = true;
    path.weight = c.coupling.mean / double(most);
    Vec3 const edge = rim_point(rim, 2 * pi * 0.381966 * double(i));  // golden angle: evenly around
    path.points = {on_surface(world, from->surface, from->centre, Event::emit),
                   on_surface(world, rim.surface, edge, c.steps[1].event),
                   on_surface(world, to->surface, to->centre, Event::couple)};
    path.path_length = length(edge - from->centre) + length(to->centre - edge);
    all.push_back(std::move(path));
  }
  return all;
}

// Whether a ghost comes into line with the main beam along the first steps of the route.
bool goes_so(GhostRow const& row, CouplingClass const& c) {
  Recoupling const& r = row.ghost.standing.recoupled;
  if (row.ghost.order == 0 || !r.any || !r.against || r.steps > row.steps.size() || r.steps > c.steps.size())
    return false;
  return std::equal(row.steps.begin(), row.steps.begin() + std::ptrdiff_t(r.steps), c.steps.begin());
}

std::vector<DrawnPath> by_ghosts(CouplingClass const& c, std::vector<GhostReport> const& reports, std::size_t most) {
  std::vector<DrawnPath> all;
  for (GhostReport const& report : reports)
    for (GhostRow const& row : report.rows) {
      if (all.size() == most || !goes_so(row, c)) continue;
      DrawnPath path;
      path.route = c.hash;
      path.computed = true;
      path.weight = row.ghost.standing.recoupled.share();
      path.path_length = row.ghost.path_length;
      for (std::size_t i = 0; i < row.points.size(); ++i) {  // from the launch, where no surface is passed
        std::size_t const step = i + row.steps.size() - row.points.size();
        bool const known = i + row.steps.size() >= row.points.size();
        path.points.push_back({row.points[i],
                               known ? row.steps[step].event : Event::start,
                               known ? row.steps[step].group : c.steps.front().group,
                               {},
                               {}});
      }
      path.points.push_back({row.ghost.point, Event::couple, row.ghost.where, {}, {}});
      all.push_back(std::move(path));
    }
  return all;
}

}  // namespace

std::vector<DrawnPath> computed_paths(World const& world, CouplingClass const& c,
                                      std::vector<GhostReport> const& ghosts, std::size_t most) {
  if (c.kind == ClassKind::scattered) return {};
  return c.kind == ClassKind::ghost ? by_ghosts(c, ghosts, most) : by_rims(world, c, most);
}

}  // namespace straytrace::session
