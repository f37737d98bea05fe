// SPDX-License-Identifier: BSD-3-Clause
// Search structure for coaxial surfaces along a line: walls, baffles, rims, end discs of a beam tube, sorted by height.
// Along a ray r^2(t) is a convex quadratic, so "inside the clear aperture" is one interval in t, known in closed form:
// a ray passes whole groups of baffles in one step, where a box tree tests every one of them, because the box of an
// annulus includes its hole (docs/develop/performance.md). A ray certainly misses a skipped surface, so the result
// equals brute force bit by bit: heights and radii are widened by more than all rounding errors.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math/simd.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "base/memory/storage.hpp"

namespace straytrace::world {

// A surface and its shape, packed: the result of a search.
struct SurfaceRef {
  static constexpr std::uint32_t most_shapes = 1u << 24;  // of one kind
  std::uint32_t surface = 0, packed = 0;
  STRAY_HD PoolRef shape() const { return {packed >> 24, packed & 0xffffffu}; }
  STRAY_HD static SurfaceRef of(std::uint32_t surface, PoolRef shape) {
    return {surface, shape.kind << 24 | shape.index};
  }
};

// Numbers of a disk or cylinder whose axis is exactly the z axis: its crossing is computed in place, by the operations
// of Disk::distance and Cylinder::distance without those that multiply by 0 or 1, so with the same bits.
struct TubePlain {
  double at;       // m, z of the centre or origin
  double a, b, c;  // disk: inner and outer radius squared, m^2; cylinder: radius squared, from, to
};

struct TubeItem {
  double low, high;       // m along the direction of travel, low < high
  double clear2, reach2;  // m^2; the surface lies between these two
  double skip2[3];        // least clear2 from here to the end of the group of 8, of 64, of the run
  double run_high;        // m, largest `high` of the rest of the run
  SurfaceRef ref;
  std::uint32_t run_end;  // run: items up to the next one that closes the aperture
  std::uint32_t plain_kind;
};

// Items in the order in which rays meet them: one list for rays up the axis, one for rays down (heights negated).
struct TubeSide {
  std::uint32_t first = 0, count = 0, first_start = 0;
  double z0 = 0, scale = 0, slots = 0;  // start number of height z: (z - z0) scale, below `slots`
};

struct TubeRecord {
  Vec3 origin, axis;                        // m, unit
  double bound[2][2] = {};                  // m, [up, down][least, largest] height along the direction of travel
  double reach2 = 0, far2 = 0;              // m^2: largest radius; distance beyond which rounding is unbounded
  bool along_z = false;                     // axis is exactly (0, 0, 1), origin on the z axis
  std::uint32_t sole_wall = 0xffffffffu;    // surface of the only long part, if that is a plain wall
  std::uint32_t first_wall = 0, walls = 0;  // long parts, if they are few
  TubeSide side[2][2];                      // [long parts if they are many, all others][up, down]
};

struct TubeProbe {
  double z, dz, slope;  // height and its change along the ray, in the direction of travel; slope = 1/dz
  double r2, b, a;      // r^2(t) = r2 + 2 b t + a t^2
  double shift = 0;     // m along the ray to t = 0
  // Whether the least distance from the axis lies between two points and is below the radius whose square is given.
  STRAY_HD bool dips(double near, double far, double inner2) const {
    return -b > a * near && -b < a * far && r2 * a - b * b <= a * inner2;
  }
  STRAY_HD double radius2(double t) const { return r2 + t * (2 * b + t * a); }
  // Where the ray leaves the radius whose square is given, or a little before; it is inside at some t >= 0. The smaller
  // of two forms, each exact for one sign of b: a branch on the sign would be mispredicted.
  STRAY_HD double leaves(double outer2) const {
    double const beyond = outer2 - r2, square = b * b + a * beyond, root = square > 0 ? std::sqrt(square) : 0;
    double const one = beyond / (b + root), two = (root - b) / a;
    return one < two ? one : two;
  }
};

struct TubeArrays {
  View<TubeRecord const> tubes;
  View<TubeItem const> items;
  View<TubePlain const> plain;       // by item
  View<double const> behind;         // m, by item: largest `high` of the items up to this one
  View<std::uint32_t const> starts;  // by side: first item to test

  // Calls `query` for every surface of the tube that may be hit before `limit` (m):
  //   cross(ref, limit)         test this surface
  //   offer(surface, t, limit)  it is crossed at t, or not at all (infinity)
  //   leaves(surface)           whether the ray starts on it
  //   end()                     m, end of the ray itself
  // The first two may lower the limit and return true to end the search; so does this function.
  template <class Query>
  STRAY_INLINE bool traverse(TubeRecord const& tube, Ray const& ray, double& limit, Query&& query) const;

  // For a ray that starts on tube.sole_wall: m to the next hit on that wall if nothing lies in between, as for most
  // rays of a diffuse walk. Infinity: the ray may hit something else.
  STRAY_INLINE double along_wall(TubeRecord const& tube, Ray const& ray) const {
    TubeProbe p;
    across_z(tube, ray.origin, ray.dir, p);
    double const t = wall_distance(plain[tube.first_wall], ray, p, true, ray.t_max), sign = std::copysign(1.0, p.dz);
    TubeSide const& side = tube.side[1][p.dz < 0];
    std::uint32_t const k = item_at(side, sign * p.z);
    return k < side.count && !(items[side.first + k].low > sign * (p.z + t * p.dz)) ? infinity : t;
  }
  // traverse in two steps, for a ray that starts inside; `both`: there may be many long parts.
  STRAY_INLINE static bool starts_inside(TubeRecord const& tube, Ray const& ray, TubeProbe& p) {
    across(tube, ray.origin, ray.dir, p);
    return p.r2 <= tube.reach2 && p.r2 + p.z * p.z < tube.far2 && tube.side[0][0].count == 0;
  }
  template <bool both, class Query>
  STRAY_INLINE bool follow(TubeRecord const& tube, Ray const& ray, TubeProbe& p, double& limit, Query&& query) const;

 private:
  STRAY_INLINE static void across_z(TubeRecord const& tube, Vec3 origin, Vec3 dir, TubeProbe& p) {
    p.z = origin.z - tube.origin.z;
    p.dz = dir.z;
    p.r2 = origin.x * origin.x + origin.y * origin.y;
    p.b = origin.x * dir.x + origin.y * dir.y;
    p.a = dir.x * dir.x + dir.y * dir.y;
  }
  STRAY_INLINE static void across(TubeRecord const& tube, Vec3 origin, Vec3 dir, TubeProbe& p) {
    if (tube.along_z) return across_z(tube, origin, dir, p);
    Vec3 const o = origin - tube.origin;
    p.z = dot(o, tube.axis);
    p.dz = dot(dir, tube.axis);
    Vec3 const op = o - p.z * tube.axis, dp = dir - p.dz * tube.axis;
    p.r2 = length2(op);
    p.b = dot(op, dp);
    p.a = length2(dp);
  }
  // The first item that does not end before height z, or one a little before it.
  STRAY_INLINE std::uint32_t item_at(TubeSide const& side, double z) const {
    double const place = (z - side.z0) * side.scale;
    if (!(place < side.slots)) return side.count;
    std::uint32_t const slot = side.first_start + std::uint32_t(std::int32_t(place > 0 ? place : 0));
    std::uint32_t k = starts[slot], end = starts[slot + 1];
    double const* const high = behind.data + side.first;
    while (end - k > 1) {
      std::uint32_t const middle = (k + end) / 2;
      if (high[middle] < z)
        k = middle + 1;
      else
        end = middle;
    }
    return k + std::uint32_t(high[k] < z);  // k < count: the last slot begins before the last item ends
  }
  template <class Query>
  STRAY_INLINE bool test_all(TubeRecord const& tube, double& limit, Query&& query) const {
    for (std::uint32_t i = 0; i < tube.walls; ++i)
      if (query.cross(items[tube.first_wall + i].ref, limit)) return true;
    for (int kind = 0; kind < 2; ++kind)
      for (std::uint32_t i = 0; i < tube.side[kind][0].count; ++i)
        if (query.cross(items[tube.side[kind][0].first + i].ref, limit)) return true;
    return false;
  }
  // Moves item k to the first one that the ray may meet after it leaves the radius whose square is given; false: k
  // itself.
  STRAY_INLINE bool jump(TubeSide const& side, TubeProbe const& p, double outer2, std::uint32_t past,
                         std::uint32_t& k) const {
    std::uint32_t const next = item_at(side, p.z + p.leaves(outer2) * p.dz);
    if (STRAY_UNLIKELY(next <= k)) return false;
    if (STRAY_UNLIKELY(next >= past))
      k = past;
    else
      k = next;
    return true;
  }
  // Disk::distance along z, for a ray that does not start on it.
  STRAY_INLINE static double disk_distance(TubePlain const& disk, Ray const& r, double end) {
    double const oz = r.origin.z - disk.at, t = -oz / r.dir.z;
    if (!(t > 0 && t < end)) return infinity;
    double const x = r.origin.x + t * r.dir.x, y = r.origin.y + t * r.dir.y, z = oz + t * r.dir.z;
    double const rho2 = x * x + y * y + z * z - z * z;
    return rho2 >= disk.a && rho2 <= disk.b ? t : infinity;
  }
  // Cylinder::distance along z; the ray starts within two radii, and `p` is measured from its origin.
  STRAY_INLINE static double wall_distance(TubePlain const& wall, Ray const& r, TubeProbe const& p, bool leaving,
                                           double end) {
    double const oz = r.origin.z - wall.at;
    auto const accept = [&](double t) STRAY_INLINE_LAMBDA {
      double const z = oz + t * r.dir.z;
      return t > 0 && t < end && z >= wall.b && z <= wall.c ? t : infinity;
    };
    if (p.a == 0) return infinity;
    if (leaving) return accept(-2 * p.b / p.a);
    double const c = p.r2 - wall.a, square = p.b * p.b - p.a * c;
    if (square < 0) return infinity;
    double const q = -(p.b + std::copysign(std::sqrt(square), p.b));
    double const one = q / p.a, two = c / q;
    if (c < 0) return accept(one < two ? two : one);  // inside: the other root is negative
    double const first = accept(one < two ? one : two);
    return first < infinity ? first : accept(one < two ? two : one);
  }
  template <class Query>
  STRAY_INLINE bool ask(std::uint32_t number, Ray const& ray, TubeProbe const& p, double& limit, Query&& query) const {
    TubeItem const& item = items[number];
    if (item.plain_kind == plain_disk) {
      if (query.leaves(item.ref.surface)) return false;
      return query.offer(item.ref.surface, disk_distance(plain[number], ray, query.end()), limit);
    }
    if (item.plain_kind == plain_wall && p.shift == 0 && p.r2 <= 4 * plain[number].a)
      return query.offer(item.ref.surface,
                         wall_distance(plain[number], ray, p, query.leaves(item.ref.surface), query.end()), limit);
    return query.cross(item.ref, limit);
  }
  template <class Query>
  STRAY_INLINE bool walk(TubeSide const& side, Ray const& ray, TubeProbe const& p, double reach2, double& limit,
                         Query&& query) const;

 public:
  static constexpr std::uint32_t plain_disk = 1, plain_wall = 2;
};

template <class Query>
STRAY_INLINE bool TubeArrays::walk(TubeSide const& side, Ray const& ray, TubeProbe const& p, double reach2,
                                   double& limit, Query&& query) const {
  TubeItem const* const list = items.data + side.first;
  double last = limit - p.shift, end = p.dz > 0 ? p.z + last * p.dz : p.z;
  for (std::uint32_t k = item_at(side, p.z); k < side.count;) {
    TubeItem const& item = list[k];
    if (item.low > end) return false;
    double near = (item.low - p.z) * p.slope;
    if (!(near > 0)) near = 0;
    double const r2 = p.radius2(near);
    if (r2 > reach2 && p.b + near * p.a > 0) return false;  // outside for good
    // Branches instead of selections: branch prediction fetches the next item before the numbers are known.
    if (STRAY_LIKELY(r2 < item.skip2[2])) {
      if (p.radius2((item.run_high - p.z) * p.slope) < item.skip2[2]) {
        k = item.run_end;
        continue;
      }
      if (jump(side, p, item.skip2[2], item.run_end, k)) continue;
    } else if (r2 < item.skip2[1]) {
      if (jump(side, p, item.skip2[1], (k | 63u) + 1, k)) continue;
    } else if (r2 < item.skip2[0]) {
      if (jump(side, p, item.skip2[0], (k | 7u) + 1, k)) continue;
    }
    if (item.plain_kind == 0) {
      double far = (item.high - p.z) * p.slope;
      if (!(far < last)) far = last;
      double const r2_far = p.radius2(far);
      bool const inside = r2 < item.clear2 && r2_far < item.clear2;
      if (inside || (r2 > item.reach2 && r2_far > item.reach2 && !p.dips(near, far, item.reach2))) {
        ++k;
        continue;
      }
    }
    double const before = limit;
    if (ask(side.first + k, ray, p, limit, query)) return true;
    if (limit < before) {
      last = limit - p.shift;
      end = p.dz > 0 ? p.z + last * p.dz : p.z;
    }
    ++k;
  }
  return false;
}

template <bool both, class Query>
STRAY_INLINE bool TubeArrays::follow(TubeRecord const& tube, Ray const& ray, TubeProbe& p, double& limit,
                                     Query&& query) const {
  double const sign = std::copysign(1.0, p.dz);
  int const down = sign < 0;
  p.z *= sign;
  p.dz = std::fabs(p.dz);
  p.slope = 1 / p.dz;
  if (p.z > tube.bound[down][1]) return false;
  // The wall that the ray starts on bounds the search cheaply; other walls come last and are rarely tested.
  std::uint32_t const first = tube.walls > 0 && query.leaves(items[tube.first_wall].ref.surface);
  if (first && ask(tube.first_wall, ray, p, limit, query)) return true;
  if (walk(tube.side[1][down], ray, p, tube.reach2, limit, query)) return true;
  if (both && walk(tube.side[0][down], ray, p, tube.reach2, limit, query)) return true;
  for (std::uint32_t i = first; i < tube.walls; ++i) {
    TubeItem const& wall = items[tube.first_wall + i];
    if (p.r2 < wall.clear2 && p.radius2(limit - p.shift) < wall.clear2) continue;
    if (ask(tube.first_wall + i, ray, p, limit, query)) return true;
  }
  return false;
}

template <class Query>
STRAY_INLINE bool TubeArrays::traverse(TubeRecord const& tube, Ray const& ray, double& limit, Query&& query) const {
  TubeProbe p;
  across(tube, ray.origin, ray.dir, p);
  if (STRAY_UNLIKELY(!(p.r2 + p.z * p.z < tube.far2))) return test_all(tube, limit, query);  // rounding has no bound
  if (STRAY_UNLIKELY(p.r2 > tube.reach2)) {
    if (!(p.b < 0)) return false;
    double const wide2 = 2.25 * tube.reach2;
    if (p.r2 > 2 * wide2) {  // from farther outside: start near the tube, for the digits
      double const square = p.b * p.b - p.a * (p.r2 - wide2);
      if (!(square > 0)) return false;
      p.shift = (p.r2 - wide2) / (std::sqrt(square) - p.b);
      if (p.shift > limit) return false;
      across(tube, ray.origin + p.shift * ray.dir, ray.dir, p);
    }
    if (p.r2 * p.a - p.b * p.b > p.a * tube.reach2) return false;
  }
  return follow<true>(tube, ray, p, limit, query);
}

// Bounds of a surface: heights along the axis of the tube, least and largest distance from it, m.
struct TubePart {
  double low = 0, high = 0, clear = 0, reach = 0;
  SurfaceRef ref;
  std::uint32_t plain_kind = 0;  // TubeArrays::plain_disk or plain_wall
  TubePlain plain = {};
};

struct TubeData {
  std::vector<TubeRecord> tubes;
  std::vector<TubeItem> items;
  std::vector<TubePlain> plain;
  std::vector<double> behind;
  std::vector<std::uint32_t> starts;

  // Heights of the parts are measured from `origin`; `deviation`: m, of their own axes from this one.
  void add(Vec3 origin, Vec3 axis, double deviation, std::vector<TubePart> const& parts);
  TubeArrays view() const;

 private:
  TubeSide add_side(std::vector<TubePart> parts, bool down, double slack);
  void find_skips(TubeSide const&);
  void find_starts(TubeSide&);
};

}  // namespace straytrace::world
