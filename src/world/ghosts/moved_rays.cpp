// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/moved_rays.hpp"

#include <algorithm>

#include "geometry/common/shape.hpp"
#include "world/model/body.hpp"

namespace straytrace::world {
namespace {

RayShift operator+(RayShift const& a, RayShift const& b) { return {a.shift + b.shift, a.turn + b.turn}; }

Vec3 part_across(Vec3 v, Vec3 direction) { return v - dot(v, direction) * direction; }

// What a surface does to rays near the chief ray.
class Bend {
 public:
  Bend(World const& world, BeamStep const& step) : step_(step) {
    WorldView const view = world.view();
    normal_ = view.normal(step.surface, step.point, step.piece);
    curvature_ = view.shapes.visit(view.surfaces[step.surface.value].shape,
                                   [&](auto const& s) { return curvature_of(s, step.point, step.piece); });
    Vec3 const change = step.n_in * step.in - step.n_out * step.out;
    along_normal_ = dot(change, normal_);
    grating_ = change - along_normal_ * normal_;
  }

  // `moved`, `turned`: of the surface at the point of the chief ray.
  RayShift passed(RayShift const& in, Vec3 moved, Vec3 turned) const {
    double const ahead = dot(normal_, moved - in.shift) / dot(normal_, step_.in);
    Vec3 const meets = in.shift + ahead * step_.in;
    Vec3 const normal = cross(turned, normal_) - bent(meets - moved);  // its change
    Vec3 const change = step_.n_in * in.turn - along_normal_ * normal - cross(turned, grating_);
    double const longer = dot(change, step_.out) / dot(normal_, step_.out);
    return {part_across(meets, step_.out), (1 / step_.n_out) * (change - longer * normal_)};
  }

 private:
  Vec3 bent(Vec3 v) const {  // K v
    SurfaceCurvature const& c = curvature_;
    double const a = dot(v, c.a), b = dot(v, c.b);
    return (c.aa * a + c.ab * b) * c.a + (c.ab * a + c.bb * b) * c.b;
  }

  BeamStep const& step_;
  Vec3 normal_, grating_;  // grating_: the part of n_in a - n_out b along the surface
  SurfaceCurvature curvature_;
  double along_normal_ = 0;
};

// Displacement and rotation of a surface point by a coordinate of its body (eq. 2.1).
struct SurfaceMotion {
  Vec3 moved, turned;
};
SurfaceMotion motion_by(int coordinate, Vec3 from_pivot) {
  Vec3 const axis{double(coordinate % 3 == 0), double(coordinate % 3 == 1), double(coordinate % 3 == 2)};
  return coordinate < 3 ? SurfaceMotion{axis, {}} : SurfaceMotion{cross(axis, from_pivot), axis};
}

MovedRay& ray_of(std::vector<MovedRay>& rays, BodyId body) {
  auto const at = std::ranges::find(rays, body, &MovedRay::body);
  return at != rays.end() ? *at : rays.emplace_back(MovedRay{body});
}

void fly(std::vector<MovedRay>& rays, double distance) {
  for (MovedRay& r : rays)
    for (RayShift& s : r.by) s.shift = s.shift + distance * s.turn;
}

}  // namespace

std::vector<MovedRay> moved_rays(World const& world, std::span<BeamStep const> way, Vec3 at) {
  std::vector<MovedRay> rays;
  for (std::size_t i = 0; i < way.size(); ++i) {
    BeamStep const& step = way[i];
    if (i > 0) fly(rays, dot(step.point - way[i - 1].point, step.in));
    Bend const bend(world, step);
    for (MovedRay& r : rays)
      for (RayShift& s : r.by) s = bend.passed(s, {}, {});
    BodyId const body = world.surfaces()[step.surface.value].body;
    if (!body.valid()) continue;
    MovedRay& own = ray_of(rays, body);
    for (int q = 0; q < 6; ++q) {
      SurfaceMotion const m = motion_by(q, step.point - world.bodies()[body.value].pivot);
      own.by[std::size_t(q)] = own.by[std::size_t(q)] + bend.passed({}, m.moved, m.turned);
    }
  }
  if (!way.empty()) fly(rays, dot(at - way.back().point, way.back().out));
  return rays;
}

}  // namespace straytrace::world
