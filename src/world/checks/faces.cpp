// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that share space: coincident faces, where rounding decides which one light meets, and intersecting faces,
// which are rarely intended.
#include "world/checks/faces.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <utility>

#include "world/build/read_parts.hpp"

namespace straytrace::world {
namespace {

constexpr double least_depth = 1e-5;  // m: shallower crossings count as inaccurate drawing

struct SharedSpace {
  int pairs = 0;
  FacePair deepest;
};

// By the two groups, so that a hundred baffles in one tube give one message.
std::map<std::pair<std::string, std::string>, SharedSpace> by_group(World const& world,
                                                                    std::vector<FacePair> const& pairs) {
  std::map<std::pair<std::string, std::string>, SharedSpace> all;
  auto const group = [&](SurfaceId id) { return world.name_of(id); };
  for (FacePair const& p : pairs) {
    SharedSpace& s = all[std::minmax(group(p.first), group(p.second))];
    if (s.pairs++ == 0 || p.depth > s.deepest.depth) s.deepest = p;
  }
  return all;
}

std::string place_of(SharedSpace const& s) {
  auto const to_a_tenth_of_a_millimetre = [](double x) { return std::round(1e4 * x) / 1e4 + 0.0; };
  Vec3 const at = s.deepest.at;
  std::string const more = s.pairs == 2  ? ", and in one more place"
                           : s.pairs > 2 ? fmt::format(", and in {} more places", s.pairs - 1)
                                         : "";
  return fmt::format("at [{:.10g}, {:.10g}, {:.10g}] m{}", to_a_tenth_of_a_millimetre(at.x),
                     to_a_tenth_of_a_millimetre(at.y), to_a_tenth_of_a_millimetre(at.z), more);
}

// The entry of the scene that the later one of the two comes from.
Node entry_of(Scene const& scene, World const& world, SharedSpace const& shared) {
  std::string const& group = world.name_of(shared.deepest.second);
  for (Scene::Instance const& instance : scene.instances())
    if (group == instance.group || group.rfind(instance.group + '/', 0) == 0) return instance.placement;
  return scene.root()["scene"];
}

}  // namespace

void check_faces(Scene const& scene, World const& world) {
  for (auto const& [names, shared] : by_group(world, coincident_faces(world)))
    entry_of(scene, world, shared)
        .problem(fmt::format("faces of '{}' and '{}' coincide {}: rounding decides which of them light meets",
                             names.first, names.second, place_of(shared)),
                 "keep one of them, or move one by more than a nanometre: a wider gap counts as drawn");
  for (auto const& [names, shared] : by_group(world, crossing_faces(world, least_depth))) {
    bool const one_entry =
        names.first.substr(0, names.first.find('/')) == names.second.substr(0, names.second.find('/'));
    if (one_entry && names.first != names.second)
      continue;  // plates recessed into the box of a dump: as drawn by its author
    entry_of(scene, world, shared)
        .warning(fmt::format("'{}' and '{}' pass through each other, {:.2g} mm deep, {}", names.first, names.second,
                             1e3 * shared.deepest.depth, place_of(shared)),
                 "light meets whichever comes first; change a length if they should only touch");
  }
}

namespace {

// Where a surface is: its box, and a ring about its axis.
struct Placed {
  std::uint32_t id;
  SearchItem at;
};
// Whether two intervals are further apart than `gap`, m; negative: reach into each other by no more than this.
bool apart(double low_a, double high_a, double low_b, double high_b, double gap) {
  return low_a > high_b + gap || low_b > high_a + gap;
}
// The same of heights and radii, where both surfaces have one axis.
bool rings_apart(SearchItem const& a, SearchItem const& b, double gap) {
  constexpr double parallel = 1e-14, same = 1e-11;  // rad, m
  Vec3 const offset = b.reference - a.reference;
  double const height = dot(offset, a.axis), turned = dot(a.axis, b.axis) > 0 ? 1 : -1;
  if (length(cross(a.axis, b.axis)) > parallel || length(offset - height * a.axis) > same) return false;
  double const low = turned > 0 ? b.extent.low : -b.extent.high, high = turned > 0 ? b.extent.high : -b.extent.low;
  return apart(a.extent.low, a.extent.high, height + low, height + high, gap) ||
         apart(a.extent.r_min, a.extent.r_max, b.extent.r_min, b.extent.r_max, gap);
}
bool apart(SearchItem const& a, SearchItem const& b, double gap) {
  for (int k = 0; k < 3; ++k)
    if (apart(component(a.box.lower, k), component(a.box.upper, k), component(b.box.lower, k),
              component(b.box.upper, k), gap))
      return true;
  return rings_apart(a, b, gap);
}
int longest_axis(std::vector<Placed> const& all) {
  Box whole;
  for (Placed const& b : all) whole.add(b.at.box);
  Vec3 const size = whole.upper - whole.lower;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}
// Which surfaces may be within `gap` of another one, by their bounds; found by a sweep along the longest axis.
std::vector<bool> may_meet(WorldView const& view, double gap) {
  std::vector<Placed> all;
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id)
    all.push_back({id, view.shapes.visit(view.surfaces[id].shape, [](auto const& s) { return search_item(s); })});
  int const axis = longest_axis(all);
  auto const start = [&](Placed const& b) { return component(b.at.box.lower, axis); };
  std::ranges::sort(all, [&](Placed const& a, Placed const& b) { return start(a) < start(b); });
  std::vector<bool> may(all.size(), false);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && start(all[j]) <= component(all[i].at.box.upper, axis) + gap; ++j)
      if (!apart(all[i].at, all[j].at, gap)) may[all[i].id] = may[all[j].id] = true;
  return may;
}

constexpr double parallel = 1e-3;          // rad between the normals of surfaces that lie on each other
constexpr double neighbour_step = 1e-6;    // m: a second point at which they must touch
constexpr double closed_tolerance = 0.03;  // of integrals over a body; one with a side left open is off by more
constexpr int directions = 32;             // tried from each side of a contact

// The first surface along `dir`.
Optic const& optic_met(WorldView const& view, std::uint32_t id, Vec3 point, std::uint32_t piece, Vec3 dir) {
  Surface const& s = view.surfaces[id];
  return view.optics[dot(view.normal({id}, point, piece), dir) < 0 ? s.front : s.back];
}

bool touches(WorldView const& view, FaceSample const& p, std::uint32_t other) {
  Ray const probe{p.point - contact_distance * p.normal, p.normal, 2 * contact_distance};
  for (auto const& found : surfaces_along(view, probe, {p.surface, p.piece}))
    if (found.surface == other) {
      Vec3 const there = view.normal({other}, p.point, found.crossing.piece);
      return length(cross(there, p.normal)) < parallel;
    }
  return false;
}

// The same at a point nearby on the same piece: a sphere may touch a plane in a point.
bool touches_beside(WorldView const& view, FaceSample const& p, std::uint32_t other) {
  Vec3 const e1 = any_normal(p.normal), e2 = cross(p.normal, e1);
  for (Vec3 const step : {e1, -e1, e2, -e2}) {
    FaceSample next = p;
    next.point = view.project(p.surface, p.point + neighbour_step * step, p.piece);
    next.normal = view.normal(p.surface, next.point, p.piece);
    if (touches(view, next, other)) return true;
  }
  return false;
}

// Directions spread evenly over the half space about `axis`.
Vec3 spread_direction(Vec3 axis, int i) {
  Frame const f = Frame::around(axis);
  double const z = (i + 0.5) / directions, across = std::sqrt(1 - z * z), turns = i * 0.6180339887498949;
  SinCos const a = sincos_turn(turns - std::floor(turns));
  return f.to_world({across * a.cos, across * a.sin, z});
}

// Whether `start` lies inside the closed body that a surface belongs to: every line out of it meets the faces of the
// body an odd number of times. Bodies are known as closed when they are a surface alone or a part of a file or library.
class ClosedBodies {
 public:
  explicit ClosedBodies(World const& world) : world_(world), view_(world.view()) {}

  bool hold(std::uint32_t id, Vec3 start, Vec3 axis) {
    for (std::vector<std::uint32_t> const& faces : {std::vector{id}, part_of(id)})
      if (closed(faces) && inside(faces, start, axis)) return true;
    return false;
  }

 private:
  std::vector<std::uint32_t> part_of(std::uint32_t id) const {
    auto const part = [&](std::uint32_t surface) {
      std::string const& group = world_.groups()[view_.surfaces[surface].group.value];
      return group.substr(0, group.rfind('/'));
    };
    std::vector<std::uint32_t> faces;
    for (std::uint32_t i = 0; i < view_.surfaces.size; ++i)
      if (view_.surfaces[i].body == view_.surfaces[id].body && part(i) == part(id)) faces.push_back(i);
    return faces;
  }
  bool closed(std::vector<std::uint32_t> const& faces) {
    auto const [known, is_new] = closed_.try_emplace(faces);
    if (is_new) known->second = closes(faces);
    return known->second;
  }
  // A line that leaves the point tells which way is out, since the normals of the faces of a part may point either way.
  bool closes(std::vector<std::uint32_t> const& faces) const {
    BodyIntegrals sums;
    Vec3 const origin = face_samples(view_, faces[0], 1)[0].point;
    int const count = std::clamp(4096 / int(faces.size()), 8, 512);
    for (std::uint32_t const id : faces) {
      double const share =
          view_.shapes.visit(view_.surfaces[id].shape, [&](auto const& f) { return f.area() / count; });
      int number = 0;
      for (FaceSample const& p : face_samples(view_, id, count)) {
        Ray const out{p.point + 4 * contact_distance * p.normal, spread_direction(p.normal, number++ % directions)};
        sums.add(p.point - origin, met_by(faces, out) % 2 == 0 ? p.normal : -p.normal, share);
      }
    }
    return sums.closed(closed_tolerance) && sums.enclosed() > 0;
  }
  bool inside(std::vector<std::uint32_t> const& faces, Vec3 start, Vec3 axis) const {
    for (int i = 0; i < directions; ++i) {
      if (met_by(faces, {start, spread_direction(axis, i)}) % 2 == 0) return false;
    }
    return true;
  }
  int met_by(std::vector<std::uint32_t> const& faces, Ray const& ray) const {
    int met = 0;
    for (std::uint32_t const id : faces) met += crossings(id, ray);
    return met;
  }
  int crossings(std::uint32_t id, Ray ray) const {
    int met = 0;
    for (Crossing c = view_.cross(id, ray, {}); c.distance < infinity; ++met) {
      ray.origin = view_.project({id}, ray.origin + c.distance * ray.dir, c.piece);
      c = view_.cross(id, ray, {{id}, c.piece});
    }
    return met;
  }

  World const& world_;
  WorldView const view_;
  std::map<std::vector<std::uint32_t>, bool> closed_;
};

// The entry of the scene that a surface comes from.
std::string entry_of(World const& world, std::uint32_t surface) {
  std::string const& group = world.name_of({surface});
  return group.substr(0, group.find('/'));
}

// Whether light can come to the contact from the side that `axis` points to: along some line there is a surface that
// sends light on, or nothing at all, as light may come from outside. Faces of one entry of the scene may coincide
// where only that entry is around them, as the motors of a mount.
bool light_comes(World const& world, ClosedBodies& bodies, FaceSample const& p, std::uint32_t other, Vec3 axis) {
  WorldView const view = world.view();
  Vec3 const start = p.point + 4 * contact_distance * axis;
  if (bodies.hold(p.surface.value, start, axis) || bodies.hold(other, start, axis)) return false;
  std::string const entry = entry_of(world, p.surface.value);
  bool comes = false, among_themselves = entry_of(world, other) == entry;
  for (int i = 0; i < directions; ++i) {
    Ray const ray{start, spread_direction(axis, i)};
    Hit const hit = view.closest(ray, {});
    if (!hit.surface.valid()) return true;
    Vec3 const there = ray.origin + hit.distance * ray.dir;
    comes = comes || !only_absorbs(optic_met(view, hit.surface.value, there, hit.piece, ray.dir));
    among_themselves = among_themselves && entry_of(world, hit.surface.value) == entry;
  }
  return comes && !among_themselves;
}

// Whether the order of the two surfaces matters on the side that `axis` points to.
bool disputed(World const& world, ClosedBodies& bodies, FaceSample const& p, std::uint32_t other, Vec3 axis) {
  WorldView const view = world.view();
  Crossing const c = view.cross(other, {p.point + contact_distance * axis, -axis, 2 * contact_distance}, {});
  bool const black = only_absorbs(optic_met(view, p.surface.value, p.point, p.piece, -axis)) &&
                     only_absorbs(optic_met(view, other, p.point, c.piece, -axis));
  return !black && light_comes(world, bodies, p, other, axis);
}

bool both_filled(WorldView const& view, std::uint32_t a, std::uint32_t b) {
  return view.surfaces[a].volume != Surface::none && view.surfaces[b].volume != Surface::none;
}

}  // namespace

std::vector<FacePair> coincident_faces(World const& world) {
  WorldView const view = world.view();
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> pairs;
  ClosedBodies bodies(world);
  std::vector<bool> const near = may_meet(view, 2 * contact_distance);
  int const count = samples_per_face(view.surfaces.size);
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id) {
    if (view.surfaces[id].clear || !near[id]) continue;
    for (FaceSample const& p : face_samples(view, id, count)) {
      Ray const probe{p.point - contact_distance * p.normal, p.normal, 2 * contact_distance};
      for (auto const& found : surfaces_along(view, probe, {p.surface, p.piece})) {
        std::pair const pair = std::minmax(id, found.surface);
        if (pairs.count(pair) || both_filled(view, id, found.surface)) continue;
        if (!touches(view, p, found.surface) || !touches_beside(view, p, found.surface)) continue;
        if (disputed(world, bodies, p, found.surface, p.normal) || disputed(world, bodies, p, found.surface, -p.normal))
          pairs.emplace(pair, p.point);
      }
    }
  }
  std::vector<FacePair> all;
  for (auto const& [pair, at] : pairs) all.push_back({{pair.first}, {pair.second}, at, 0});
  return all;
}

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

// Extent of the surface from `p` along the tangent `along`, m, to 1 %, at most `most`; 0: less than `least`.
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

// Depth of the intersection, m; 0: one of them ends there, or they only touch.
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
  std::vector<bool> const overlap = may_meet(view, -2 * contact_distance);  // those that only touch end there
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id) {
    if (view.surfaces[id].clear || !overlap[id]) continue;
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

}  // namespace straytrace::world
