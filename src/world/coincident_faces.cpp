// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <utility>

#include "world/face_pairs.hpp"
#include "world/face_samples.hpp"
#include "world/read_parts.hpp"

namespace straytrace {
namespace {

constexpr double parallel = 1e-3;          // rad between the normals of surfaces that lie on each other
constexpr double neighbour_step = 1e-6;    // m: a second point at which they must touch
constexpr double closed_tolerance = 0.03;  // of integrals over a body; one with a side left open is off by more
constexpr int directions = 32;             // tried from each side of a contact

// What light meets that travels along `dir`.
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
  // By the divergence theorem, integral x_i n_j dA = V delta_ij for normals out of a closed body. Which way is out is
  // not asked of the normals, as faces of a part may have theirs either way, but of a line that leaves the point.
  bool closes(std::vector<std::uint32_t> const& faces) const {
    double moment[3][3] = {}, size = 0;
    Vec3 const origin = face_samples(view_, faces[0], 1)[0].point;
    int const count = std::clamp(4096 / int(faces.size()), 8, 512);
    for (std::uint32_t const id : faces) {
      double const share =
          view_.shapes.visit(view_.surfaces[id].shape, [&](auto const& f) { return f.area() / count; });
      int number = 0;
      for (FaceSample const& p : face_samples(view_, id, count)) {
        Ray const out{p.point + 4 * contact_distance * p.normal, spread_direction(p.normal, number++ % directions)};
        Vec3 const n = met_by(faces, out) % 2 == 0 ? p.normal : -p.normal, x = p.point - origin;
        double const at[3] = {x.x, x.y, x.z}, along[3] = {n.x, n.y, n.z};
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) moment[i][j] += share * at[i] * along[j];
        size += share * length(x);
      }
    }
    double const volume = (moment[0][0] + moment[1][1] + moment[2][2]) / 3;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (std::fabs(moment[i][j] - (i == j ? volume : 0)) > closed_tolerance * size) return false;
    return volume > closed_tolerance * size / 3;
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
  std::string const& group = world.groups()[world.surfaces()[surface].group.value];
  return group.substr(0, group.find('/'));
}

// Whether light can come to the contact from the side that `axis` points to: along some line there is a surface that
// sends light on, or nothing at all, as light may come from outside. Faces of one entry of the scene may stand on each
// other where that entry alone is around them, as the motors of a mount.
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

// Whether it matters on the side that `axis` points to which of the two the light meets.
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
  int const count = samples_per_face(view.surfaces.size);
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id) {
    if (view.surfaces[id].clear) continue;
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

}  // namespace straytrace
