// SPDX-License-Identifier: BSD-3-Clause
#include "world/spot_place.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "world/read_parts.hpp"

namespace straytrace {
namespace {

struct Met {
  double at;   // m along the travel, from the plane across it through the centre
  bool front;  // on the side the normal points to
  std::uint32_t piece;
};

// All crossings of a line from `before` m before its start, in their order.
std::vector<Met> crossings(WorldView const& view, SurfaceId id, Ray line, double before) {
  constexpr std::size_t most = 64;
  std::vector<Met> all;
  Departure from;
  double at = -before;
  line.origin = line.origin - before * line.dir;
  while (all.size() < most) {
    Crossing const next = view.cross(id.value, line, from);
    if (!(next.distance < infinity)) break;
    at += next.distance;
    line.origin = view.project(id, line.origin + next.distance * line.dir, next.piece);
    all.push_back({at, dot(view.normal(id, line.origin, next.piece), line.dir) < 0, next.piece});
    from = {id, next.piece};
  }
  return all;
}

// Which of them is lit.
std::size_t lit_one(std::vector<Met> const& all, double radius, auto const& alive) {
  constexpr double least = 1e-3;  // m, to which a place is stated
  std::size_t nearest = 0, first = all.size();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::fabs(all[i].at) < std::fabs(all[nearest].at)) nearest = i;
    if (first == all.size() && alive(all[i])) first = i;
  }
  if (std::fabs(all[nearest].at) <= std::fmax(radius, least)) return nearest;
  return first < all.size() ? first : 0;
}

}  // namespace

void place_spot(World const& world, Footprint& f) {
  constexpr int across = 8;  // lines tried in radius, and in azimuth
  WorldView const view = world.view();
  Surface const& surface = world.surfaces()[f.surface.value];
  double low = 0, high = 0, r_min = 0, r_max = 0;
  Vec3 reference;
  view.shapes.visit(surface.shape, [&](auto const& shape) {
    shape.extent(low, high, r_min, r_max);
    reference = shape.reference();
  });
  double const before = 2 * (r_max + std::fmax(std::fabs(low), std::fabs(high))) + length(f.centre - reference);
  std::vector<Met> const chief = crossings(view, f.surface, {f.centre, f.travel}, before);
  if (chief.size() < 2) return;
  auto const alive = [&](Met const& m) { return !only_absorbs(view.optics[m.front ? surface.front : surface.back]); };
  std::size_t const lit = lit_one(chief, f.radius, alive);
  double const place = chief[lit].at;
  double start = lit > 0 ? chief[lit - 1].at : -infinity, end = place;
  for (int i = 0; i < across; ++i)
    for (int k = 0; k < across; ++k) {
      std::vector<Met> const line =
          crossings(view, f.surface, f.sample((i + 0.5) / across, (k + 0.5) / across), before);
      std::size_t same = line.size();
      for (std::size_t j = 0; j < line.size(); ++j)
        if (line[j].front == chief[lit].front &&
            (same == line.size() || std::fabs(line[j].at - place) < std::fabs(line[same].at - place)))
          same = j;
      if (same == line.size()) continue;
      end = std::min(end, line[same].at);
      if (same > 0) start = std::max(start, line[same - 1].at);
    }
  if (!(start > -infinity)) return;
  f.centre = f.centre + place * f.travel;
  f.backoff = place - 0.5 * (start + end);
}

}  // namespace straytrace
