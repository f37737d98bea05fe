// SPDX-License-Identifier: BSD-3-Clause
// The surfaces of one leaf, side by side, each in a ring about its own axis: between two heights and two radii. A box
// along x, y, z is much larger than a tilted disc or barrel; the ring fits closely, and the test of eight rings takes
// about as long as that of one shape. Floats are widened: the ray certainly misses a surface that the test rejects.
#pragma once

#include <cstdint>

#include "base/math/simd.hpp"
#include "base/memory/ids.hpp"
#include "geometry/mesh/bvh8.hpp"
#include "geometry/shape_types.hpp"
#include "world/search/tube.hpp"

namespace straytrace::world {

// Bounds of a surface: a box, and heights along its axis and distances from it that contain it.
struct SearchItem {
  SurfaceRef ref;
  Box box;
  Vec3 reference, axis{0, 0, 1};  // heights are measured from the reference point
  Extent extent;
  std::uint32_t plain_kind = 0;  // see TubePart
  TubePlain plain = {};
};

struct alignas(64) SurfacePack {
  float centre[3][simd::lanes], axis[3][simd::lanes];  // m from the origin of the tree
  float low[simd::lanes], high[simd::lanes];           // m along the axis
  float inner2[simd::lanes], outer2[simd::lanes];      // m^2
  SurfaceRef ref[simd::lanes];

  // `largest`: m, local coordinate of the tree. Rounding of the ray, of its direction over lengths up to four times
  // `largest` and of some forty operations moves a point by less than 2^-18 of the coordinates, if `widen` is 1.
  void set(int lane, SearchItem const&, Vec3 origin, double largest, double widen = 1);

  // Bit i: surface i may be hit before `limit`, m from the start of the probe.
  STRAY_INLINE unsigned may_be_hit(bvh8_detail::Probe const& probe, float limit) const;

 private:
  // For one lane or for all: F is a float or eight of them, M the result of comparing two F.
  template <class F, class M>
  STRAY_INLINE static void test(F const (&c)[3], F const (&n)[3], F const& low, F const& high, F const& inner2,
                                F const& outer2, bvh8_detail::Probe const& p, float limit, M& missed);
};
static_assert(sizeof(SurfacePack) == 384);

template <class F, class M>
STRAY_INLINE void SurfacePack::test(F const (&c)[3], F const (&n)[3], F const& low, F const& high, F const& inner2,
                                    F const& outer2, bvh8_detail::Probe const& p, float limit, M& missed) {
  F const ox = p.origin[0] - c[0], oy = p.origin[1] - c[1], oz = p.origin[2] - c[2];
  F const height = ox * n[0] + oy * n[1] + oz * n[2], slope = p.dir[0] * n[0] + p.dir[1] * n[1] + p.dir[2] * n[2];
  F const inverse = 1 / slope;  // zero: infinity with its sign
  F const a = (low - height) * inverse, b = (high - height) * inverse;
  F const first = inverse < 0 ? b : a, second = inverse < 0 ? a : b;
  F near = F{}, far = limit - F{};
  near = first > near ? first : near;  // NaN: no bound
  far = second < far ? second : far;
  // Squared distance from the axis, a convex function of the length.
  F const px = ox - height * n[0], py = oy - height * n[1], pz = oz - height * n[2];
  F const dx = p.dir[0] - slope * n[0], dy = p.dir[1] - slope * n[1], dz = p.dir[2] - slope * n[2];
  auto const radius2 = [&](F const& t, F& out) STRAY_INLINE_LAMBDA {
    F const x = px + t * dx, y = py + t * dy, z = pz + t * dz;
    out = x * x + y * y + z * z;
  };
  F lowest = (px * dx + py * dy + pz * dz) / -(dx * dx + dy * dy + dz * dz);
  lowest = lowest > near ? lowest : near;
  lowest = lowest < far ? lowest : far;
  F least, begin, end;
  radius2(lowest, least);
  radius2(near, begin);
  radius2(far, end);
  missed = (near > far * (1 + 6 * 0x1p-23f)) | (least > outer2) | ((begin < inner2) & (end < inner2));
}

STRAY_INLINE unsigned SurfacePack::may_be_hit(bvh8_detail::Probe const& probe, float limit) const {
#if STRAY_VECTORS
  using simd::loaded;
  simd::Floats const c[3] = {loaded(centre[0]), loaded(centre[1]), loaded(centre[2])};
  simd::Floats const n[3] = {loaded(axis[0]), loaded(axis[1]), loaded(axis[2])};
  simd::Ints missed;
  test(c, n, loaded(low), loaded(high), loaded(inner2), loaded(outer2), probe, limit, missed);
  return ~simd::bits_set(missed);
#else
  unsigned bits = 0;
  for (int i = 0; i < simd::lanes; ++i) {
    float const c[3] = {centre[0][i], centre[1][i], centre[2][i]}, n[3] = {axis[0][i], axis[1][i], axis[2][i]};
    bool missed;
    test(c, n, low[i], high[i], inner2[i], outer2[i], probe, limit, missed);
    bits |= unsigned(!missed) << i;
  }
  return bits;
#endif
}

// Properties of a shape for the search structure.

namespace search_item_detail {

inline bool is_z_axis(Vec3 at, Vec3 axis) {
  return at.x == 0 && at.y == 0 && axis.x == 0 && axis.y == 0 && std::fabs(axis.z) == 1;
}
inline void set_plain(Disk const& s, SearchItem& item) {
  if (!is_z_axis(s.centre, s.axis)) return;
  item.plain_kind = TubeArrays::plain_disk;
  item.plain = {s.centre.z, s.inner_radius * s.inner_radius, s.outer_radius * s.outer_radius, 0};
}
inline void set_plain(Cylinder const& s, SearchItem& item) {
  if (!is_z_axis(s.origin, s.axis) || s.axis.z < 0) return;
  item.plain_kind = TubeArrays::plain_wall;
  item.plain = {s.origin.z, s.radius * s.radius, s.from, s.to};
}

}  // namespace search_item_detail

// All but `ref`.
template <class Shape>
SearchItem search_item(Shape const& shape) {
  SearchItem item;
  item.box = shape.bounds();
  item.reference = shape.reference();
  item.axis = shape.axis;
  item.extent = shape.extent();
  using search_item_detail::set_plain;
  if constexpr (requires { set_plain(shape, item); }) set_plain(shape, item);
  return item;
}

}  // namespace straytrace::world
