// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <optional>
#include <utility>

#include "world/face_pairs.hpp"
#include "world/face_samples.hpp"

namespace straytrace {
namespace {

constexpr int most_samples = 250'000;  // of all surfaces together: each costs two searches
constexpr int halvings = 6;            // of a step that leads off the surface
constexpr double least_sine = 1e-3;    // of the angle between surfaces that cross

// The point of the surface straight above or below `near`, within `reach`, m.
std::optional<FaceSample> on_face(WorldView const& view, FaceSample const& from, Vec3 near, double reach) {
  Ray const probe{near + reach * from.normal, -from.normal, 2 * reach};
  Crossing const c = view.cross(from.surface.value, probe, {});
  if (!(c.distance < infinity)) return {};
  Vec3 const point = view.project(from.surface, probe.origin + c.distance * probe.dir, c.piece);
  return FaceSample{from.surface, c.piece, point, view.normal(from.surface, point, c.piece)};
}

// A point of the surface some way from `p` along the tangent `along`, at most `step` m: shorter near an edge.
std::optional<FaceSample> stepped(WorldView const& view, FaceSample const& p, Vec3 along, double step) {
  for (int i = 0; i < halvings; ++i, step /= 2)
    if (auto const q = on_face(view, p, p.point + step * along, step)) return q;
  return {};
}

Crossing between(WorldView const& view, Vec3 from, Vec3 to, std::uint32_t other) {
  double const far = length(to - from);
  return far > 0 ? view.cross(other, {from, (1 / far) * (to - from), far}, {}) : Crossing{};
}

// One point of both surfaces.
struct Meeting {
  FaceSample mine, its;
};

// Where the surface of `a` and `b` crosses `other` between these two points, to a billionth of their distance.
std::optional<Meeting> meeting(WorldView const& view, FaceSample a, FaceSample b, std::uint32_t other) {
  double const reach = length(b.point - a.point);
  for (int i = 0; i < 30; ++i) {
    auto const middle = on_face(view, a, 0.5 * (a.point + b.point), reach);
    if (!middle) return {};
    if (between(view, a.point, middle->point, other).distance < infinity)
      b = *middle;
    else if (between(view, middle->point, b.point, other).distance < infinity)
      a = *middle;
    else
      return {};
  }
  Crossing const c = between(view, a.point, b.point, other);
  if (!(c.distance < infinity)) return {};
  Vec3 const there = view.project({other}, a.point, c.piece);
  return Meeting{a, {{other}, c.piece, there, view.normal({other}, there, c.piece)}};
}

// How far the surface goes on from `p` along the tangent `along`, m, to 1 %, at most `most`; 0: less than `least`.
double extent_along(WorldView const& view, FaceSample const& p, Vec3 along, double least, double most) {
  auto const goes_on = [&](double d) { return on_face(view, p, p.point + d * along, d).has_value(); };
  double reached = 0, missed = least;
  while (missed <= most && goes_on(missed)) {
    reached = missed;
    missed *= 2;
  }
  while (reached > 0 && missed <= most && missed > 1.01 * reached) {
    double const middle = 0.5 * (reached + missed);
    (goes_on(middle) ? reached : missed) = middle;
  }
  return reached;
}

// How far both surfaces reach past each other, m; 0: one of them ends there, or they only touch.
double depth_of(WorldView const& view, Meeting const& m, double least, double most) {
  Vec3 const common = cross(m.mine.normal, m.its.normal);
  if (length(common) < least_sine) return 0;
  double depth = most;
  for (FaceSample const* face : {&m.mine, &m.its}) {
    Vec3 const along = unit(cross(common, face->normal));
    for (Vec3 const way : {along, -along}) depth = std::min(depth, extent_along(view, *face, way, least, most));
  }
  return depth;
}

}  // namespace

std::vector<FacePair> crossing_faces(World const& world, double least_depth) {
  WorldView const view = world.view();
  std::map<std::pair<std::uint32_t, std::uint32_t>, FacePair> pairs;
  int const count =
      std::min(samples_per_face(view.surfaces.size), std::max(16, int(most_samples / view.surfaces.size)));
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id) {
    if (view.surfaces[id].clear) continue;
    double const step =
        view.shapes.visit(view.surfaces[id].shape, [&](auto const& s) { return std::sqrt(s.area() / count); });
    for (FaceSample const& p : face_samples(view, id, count)) {
      Vec3 const e1 = any_normal(p.normal), e2 = cross(p.normal, e1);
      for (Vec3 const along : {e1, -e1, e2, -e2}) {
        auto const q = stepped(view, p, along, step);
        if (!q) continue;
        double const far = length(q->point - p.point);
        if (!(far > 0)) continue;
        for (auto const& found :
             surfaces_along(view, {p.point, (1 / far) * (q->point - p.point), far}, {p.surface, p.piece})) {
          auto const m = meeting(view, p, *q, found.surface);
          double const depth = m ? depth_of(view, *m, least_depth, step) : 0;
          if (!(depth > 0)) continue;
          std::pair const pair = std::minmax(id, found.surface);
          FacePair& known =
              pairs.try_emplace(pair, FacePair{{pair.first}, {pair.second}, m->mine.point, 0}).first->second;
          if (depth > known.depth) known = {known.first, known.second, m->mine.point, depth};
        }
      }
    }
  }
  std::vector<FacePair> all;
  for (auto const& [pair, found] : pairs) all.push_back(found);
  return all;
}

}  // namespace straytrace
