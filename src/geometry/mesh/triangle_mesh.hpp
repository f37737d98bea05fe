// SPDX-License-Identifier: BSD-3-Clause
// Triangles of one named part of a mesh file. Corners are floats as in the file; rays are moved into the frame and the
// unit of the file in double, so instances share all arrays and parts of one file see the same corners: no ray passes
// between them. Page: docs/reference/shapes/mesh.md.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/storage.hpp"
#include "geometry/mesh/bvh8.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

// One triangle and one ray, without cracks: the sheared-ray test (Woop, Benthin, Wald, JCGT 2(1), 2013) in double.
// A ray becomes the z axis by a shear; a corner is sheared by the same operations in every triangle that has it, and
// the edge function of two corners changes exactly its sign with their order. Rounded products keep their order, so a
// computed edge function is never of the wrong sign, only zero too often; then its sign is computed exactly. Hence of
// two triangles at an edge at least one is hit by a ray through that edge, and a closed mesh has no leak.

struct MeshVertex {
  float x = 0, y = 0, z = 0;  // as in the file, in its unit
  bool operator==(MeshVertex const&) const = default;
};
struct MeshTriangle {
  std::uint32_t corner[3] = {};  // counter-clockwise seen from the front
};
STRAY_HD Vec3 exact(MeshVertex v) { return {v.x, v.y, v.z}; }

STRAY_HD double component(Vec3 const& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// The ray that becomes the z axis; lengths in the unit of the corners.
struct ShearedRay {
  int x = 0, y = 1, z = 2;                    // axes; z: the one along which the ray moves most
  double at[3] = {};                          // origin, in the order of these axes
  double slope_x = 0, slope_y = 0, step = 1;  // per unit of z; length along the ray per unit of z

  STRAY_HD ShearedRay(Vec3 origin, Vec3 dir) {
    double const ax = std::fabs(dir.x), ay = std::fabs(dir.y), az = std::fabs(dir.z);
    z = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    x = z == 2 ? 0 : z + 1;
    y = x == 2 ? 0 : x + 1;
    at[0] = component(origin, x);
    at[1] = component(origin, y);
    at[2] = component(origin, z);
    double const along = component(dir, z);
    slope_x = component(dir, x) / along;
    slope_y = component(dir, y) / along;
    step = 1 / along;
  }
  STRAY_HD Vec3 sheared(Vec3 corner) const {
    double const dz = component(corner, z) - at[2];
    return {(component(corner, x) - at[0]) - slope_x * dz, (component(corner, y) - at[1]) - slope_y * dz, dz};
  }
};

// Rounding error of a * b (Dekker 1971, splitting by Veltkamp): a * b = fl(a * b) + this, exactly.
STRAY_HD double product_error(double a, double b) {
  double const p = a * b, sa = 134217729 * a, sb = 134217729 * b;
  double const ah = sa - (sa - a), bh = sb - (sb - b), al = a - ah, bl = b - bh;
  return al * bl - (((p - ah * bh) - al * bh) - ah * bl);
}
// Twice the signed area of (axis of the ray, p, q): its sign gives the side of the edge on which the ray passes.
STRAY_HD double edge_function(Vec3 const& p, Vec3 const& q) { return p.x * q.y - p.y * q.x; }
STRAY_HD double exact_edge_function(Vec3 const& p, Vec3 const& q) {  // for fl(edge function) = 0
  return product_error(p.x, q.y) - product_error(p.y, q.x);
}

// Where the line of the ray meets the triangle, edges and corners included: length along the ray, negative behind the
// origin; infinity: nowhere. A triangle seen exactly edge-on is not met: its neighbours are.
STRAY_HD double line_meets(ShearedRay const& ray, Vec3 corner_a, Vec3 corner_b, Vec3 corner_c) {
  Vec3 const a = ray.sheared(corner_a), b = ray.sheared(corner_b), c = ray.sheared(corner_c);
  double u = edge_function(c, b), v = edge_function(a, c), w = edge_function(b, a);
  if (u == 0 || v == 0 || w == 0) {
    if (u == 0) u = exact_edge_function(c, b);
    if (v == 0) v = exact_edge_function(a, c);
    if (w == 0) w = exact_edge_function(b, a);
  }
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return infinity;
  double const sum = u + v + w;
  return sum != 0 ? (u * a.z + v * b.z + w * c.z) / sum * ray.step : infinity;
}

// Normal by the order of the corners, length twice the area; no zero vector for corners in one line (any direction
// across them), so that nothing downstream divides by zero.
STRAY_HD Vec3 facet_normal(Vec3 a, Vec3 b, Vec3 c) {
  Vec3 const n = cross(b - a, c - a);
  if (length2(n) > 0) return n;
  Vec3 const ab = b - a, ac = c - a, along = length2(ab) > length2(ac) ? ab : ac;
  return length2(along) > 0 ? any_normal(unit(along)) : Vec3{0, 0, 1};
}

// The point p moved into the plane and, where it is nearer than `margin` to an edge, that far inside (at most an
// eighth of a height): a path never starts on an edge, where the next ray could begin on the wrong side of a corner.
STRAY_HD Vec3 put_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c, double margin) {
  Vec3 const n = facet_normal(a, b, c);
  double const n2 = length2(n);
  Vec3 const q = p - (dot(n, p - a) / n2) * n;
  double share[3] = {dot(n, cross(c - b, q - b)) / n2, dot(n, cross(a - c, q - c)) / n2,
                     dot(n, cross(b - a, q - a)) / n2};
  // Height over an edge = n / edge.
  double const scale = margin / std::sqrt(n2);
  double const least[3] = {std::fmin(scale * length(c - b), 0.125), std::fmin(scale * length(a - c), 0.125),
                           std::fmin(scale * length(b - a), 0.125)};
  if (share[0] >= least[0] && share[1] >= least[1] && share[2] >= least[2]) return q;
  double room = 1, over = 0;
  for (int i = 0; i < 3; ++i) {
    share[i] = share[i] > least[i] ? share[i] - least[i] : 0;
    room -= least[i];
    over += share[i];
  }
  for (int i = 0; i < 3; ++i) share[i] = least[i] + (over > 0 ? share[i] / over : 1.0 / 3) * room;
  return share[0] * a + share[1] * b + share[2] * c;
}

// A ray leaves a triangle. A length near zero is pure rounding, so the positions of the triangles decide which
// hits close to the start are real:
//   1. the triangle itself is never hit;
//   2. one that reaches nowhere above the plane of the start, on the side the ray leaves to, is never hit: coplanar and
//      convex neighbours;
//   3. one that shares an edge and rises on that side is hit if and only if the ray moves towards its plane and its
//      line meets it, also where rounding puts the start behind it: concave corners.
// Everything else is hit at a positive length.
class LeavingRule {
 public:
  // Corners of the start, its vertex numbers, direction of the ray.
  STRAY_HD LeavingRule(Vec3 a, Vec3 b, Vec3 c, MeshTriangle const& numbers, Vec3 dir) : start_{a, b, c}, dir_(dir) {
    for (int i = 0; i < 3; ++i) number_[i] = numbers.corner[i];
    up_ = facet_normal(a, b, c);
    if (dot(up_, dir) < 0) up_ = -up_;
    double const ab = length(b - a), ac = length(c - a);
    near_ = reach(ab, ac);
    rounding_ = 0x1p-50 * ab * ac;
  }
  // Where the rule ends, for two edges of the start.
  STRAY_HD static double reach(double ab, double ac) { return 0x1p-10 * (ab + ac); }
  STRAY_HD bool asks(double t) const { return std::fabs(t) < near_; }
  // The length at which another triangle is hit whose line meets it at t; infinity: not hit.
  STRAY_HD double judged(double t, Vec3 const (&other)[3], MeshTriangle const& numbers) const {
    int shared = 0, spare = 3;  // spare: sum of the places of the shared corners taken from 0 + 1 + 2
    bool above = false;
    Vec3 common;
    for (int i = 0; i < 3; ++i) {
      int same = -1;
      for (int k = 0; k < 3; ++k)
        if (numbers.corner[i] == number_[k]) same = k;
      if (same >= 0) {
        ++shared;
        spare -= same;
        common = other[i];
      } else if (rises(other[i])) {
        above = true;
      }
    }
    if (!above) return infinity;
    if (shared != 2) return t > 0 ? t : infinity;
    Vec3 const n = facet_normal(other[0], other[1], other[2]);
    if (!(dot(n, start_[spare] - common) * dot(n, dir_) < 0)) return infinity;
    return t > 0 ? t : 0x1p-1000;
  }

 private:
  STRAY_HD bool rises(Vec3 p) const {
    Vec3 const w = p - start_[0];
    return dot(up_, w) > rounding_ * length(w);
  }
  Vec3 start_[3], dir_, up_;
  std::uint32_t number_[3] = {};
  double near_ = 0, rounding_ = 0;  // rounding_: of a height over the plane, times twice the area, per distance
};

// Eight triangles side by side: [corner][axis][lane].
struct alignas(64) TrianglePack {
  float corner[3][3][8];
  std::uint32_t triangle[8];
};
static_assert(sizeof(TrianglePack) == 320);

// One row of an alias table (Walker 1977): the row itself below `keep`, otherwise `other`.
struct AliasRow {
  double keep = 1;
  std::uint32_t other = 0, unused = 0;
};

// Shared by all instances. Lengths in the unit of the file.
struct MeshContent {
  View<MeshVertex const> vertices;
  View<MeshTriangle const> triangles;
  View<MeshVertex const> normals;  // unit, at the corners of each triangle in order; none: flat facets
  View<TrianglePack const> packs;  // leaves of the tree name packs
  View<AliasRow const> by_area;
  View<std::uint32_t const> in_order;  // triangles as the leaves of the tree list them: neighbours side by side
  View<std::uint32_t const> place;     // of each triangle in that order
  View<double const> area_before;      // of the triangles before place i, unit^2; one more than there are triangles
  Bvh8::View tree;
  Box box;
  std::uint64_t digest[2] = {};  // of vertices and triangles: arrays with other content have another one
  double area = 0;               // unit^2
  double close = 0;              // hits nearer than this may need the rule for leaving a triangle (LeavingRule::asks)
  double low = 0, high = 0, near = 0, far = 0;  // heights along z, distances from the z axis
};
// Triangles must name existing vertices.
MeshContent prepare_mesh(std::vector<MeshVertex> vertices, std::vector<MeshTriangle> triangles, Storage& storage);

struct TriangleMesh {
  static constexpr char const* key = "mesh";
  static constexpr bool has_pieces = true;
  Drawing drawing() const;

  Pose pose;
  Vec3 axis{0, 0, 1};
  double unit = 1;  // m
  MeshContent content;

  STRAY_HD void place(Pose const& where) {
    pose = where;
    axis = where.e3;
  }
  // The nearest triangle, ties to the lower number. `leaving`: the triangle that the ray starts on, or no_piece.
#if STRAY_VECTORS
  Crossing crossing(Ray const& ray, std::uint32_t leaving) const;
#else
  STRAY_HD Crossing crossing(Ray const& ray, std::uint32_t leaving) const { return crossing_with<1>(ray, leaving); }
#endif

  STRAY_HD Vec3 normal(Vec3, std::uint32_t piece) const {
    return straytrace::unit(pose.direction(facet_normal(corner(piece, 0), corner(piece, 1), corner(piece, 2))));
  }
  // Between the normals at the corners.
  STRAY_HD Vec3 smooth_normal(Vec3 p, std::uint32_t piece) const {
    if (content.normals.size == 0) return normal(p, piece);
    Vec3 const a = corner(piece, 0), b = corner(piece, 1), c = corner(piece, 2), n = facet_normal(a, b, c);
    Vec3 const q = to_file(p);
    double const share[3] = {dot(n, cross(c - b, q - b)), dot(n, cross(a - c, q - c)), dot(n, cross(b - a, q - a))};
    Vec3 sum;
    for (int i = 0; i < 3; ++i)
      sum = sum + std::fmax(share[i], 0.0) * exact(content.normals[3 * std::size_t(piece) + i]);
    return length2(sum) > 0 ? straytrace::unit(pose.direction(sum)) : normal(p, piece);
  }
  STRAY_HD Vec3 project(Vec3 p, std::uint32_t piece) const { return put(to_file(p), piece); }
  STRAY_HD double area() const { return content.area * unit * unit; }
  STRAY_HD SurfacePoint sample(double u, double v) const {
    double const rows = double(content.by_area.size), x = u * rows, row = std::fmin(std::floor(x), rows - 1);
    AliasRow const alias = content.by_area[std::size_t(row)];
    bool const kept = x - row < alias.keep;
    std::uint32_t const piece = kept ? std::uint32_t(row) : alias.other;
    double const rest = kept ? (x - row) / alias.keep : (x - row - alias.keep) / (1 - alias.keep);
    return {on_triangle(piece, rest, v), piece};
  }
  // The same density, but u runs over the area in the order of the tree: close numbers are close places.
  STRAY_HD SurfacePoint sample_in_order(double u, double v) const {
    double const x = u * content.area_before[content.in_order.size];
    std::size_t low = 0, high = content.in_order.size;
    while (high - low > 1) {
      std::size_t const mid = low + (high - low) / 2;
      (content.area_before[mid] <= x ? low : high) = mid;
    }
    double const before = content.area_before[low], area = content.area_before[low + 1] - before;
    std::uint32_t const piece = content.in_order[low];
    return {on_triangle(piece, area > 0 ? std::fmin((x - before) / area, 1) : 0.5, v), piece};
  }
  // The number u at the middle of a triangle.
  STRAY_HD double order_coordinate(std::uint32_t piece) const {
    std::size_t const i = content.place[piece];
    return 0.5 * (content.area_before[i] + content.area_before[i + 1]) / content.area_before[content.in_order.size];
  }
  // Heights along e3 and radii about it, from the origin of the part, that contain the surface.
  STRAY_HD Extent extent() const {
    return {unit * content.low, unit * content.high, unit * content.near, unit * content.far};
  }
  STRAY_HD Vec3 reference() const { return pose.origin; }
  STRAY_HD Box bounds() const;

  STRAY_HD Vec3 corner(std::uint32_t piece, int i) const {
    return exact(content.vertices[content.triangles[piece].corner[i]]);
  }
  template <int Width>
  STRAY_INLINE Crossing crossing_with(Ray const& ray, std::uint32_t leaving) const;
  // In the frame and the unit of the file; t_max is left as it is.
  STRAY_HD Ray in_file(Ray const& ray) const { return {to_file(ray.origin), pose.local_direction(ray.dir), ray.t_max}; }
  struct Search;

 private:
  STRAY_HD Vec3 to_file(Vec3 p) const {
    Vec3 const q = pose.local_point(p);
    return {q.x / unit, q.y / unit, q.z / unit};
  }
  STRAY_HD Vec3 on_triangle(std::uint32_t piece, double u, double v) const {  // even over its area
    Vec3 const a = corner(piece, 0), b = corner(piece, 1), c = corner(piece, 2);
    double const root = std::sqrt(u);
    return put(a + (root * (1 - v)) * (b - a) + (root * v) * (c - a), piece);
  }
  STRAY_HD Vec3 put(Vec3 p, std::uint32_t piece) const {
    double const rounding = 0x1p-40 * (length(pose.origin) / unit + length(p));  // 4096 times that of a coordinate
    return pose.point(unit * put_on_triangle(p, corner(piece, 0), corner(piece, 1), corner(piece, 2), rounding));
  }
};

// One ray in one mesh: the best hit so far.
struct TriangleMesh::Search {
  TriangleMesh const* mesh;
  ShearedRay sheared;
  Vec3 dir;
  double t_max;  // m
  std::uint32_t leaving;
  Crossing best{infinity, no_piece};  // distance and limit in the unit of the file
  double limit;                       // rounded up

  STRAY_INLINE Search(TriangleMesh const& m, Vec3 origin, Vec3 d, double end, std::uint32_t from)
      : mesh(&m), sheared(origin, d), dir(d), t_max(end), leaving(from), limit(end / m.unit * (1 + 0x1p-50)) {}
  STRAY_HD void try_triangle(std::uint32_t id, Vec3 a, Vec3 b, Vec3 c) {
    if (id == leaving) return;
    double t = line_meets(sheared, a, b, c);
    if (leaving != no_piece && std::fabs(t) < mesh->content.close) t = judged(t, id);
    if (!(t > 0 && t <= limit)) return;
    if (!(t * mesh->unit < t_max) || (t == best.distance && id > best.piece)) return;
    best = {t, id};
    limit = t;
  }
  template <int Width>
  STRAY_INLINE void try_pack(std::uint32_t number, std::uint32_t count);
  STRAY_HD double judged(double t, std::uint32_t id) const {  // rare, so the start is looked up only here
    auto const at = [this](std::uint32_t piece, int i) { return mesh->corner(piece, i); };
    LeavingRule const rule(at(leaving, 0), at(leaving, 1), at(leaving, 2), mesh->content.triangles[leaving], dir);
    if (!rule.asks(t)) return t;
    return rule.judged(t, {at(id, 0), at(id, 1), at(id, 2)}, mesh->content.triangles[id]);
  }
  STRAY_HD Crossing result() const { return {best.distance * mesh->unit, best.piece}; }
};

namespace mesh_detail {

#if STRAY_VECTORS
template <int Width>
struct VectorOf;
#define STRAY_VECTOR_OF(width)                                          \
  template <>                                                           \
  struct VectorOf<width> {                                              \
    typedef double Doubles __attribute__((vector_size(8 * width)));     \
    typedef float Floats __attribute__((vector_size(4 * width)));       \
    typedef std::int64_t Longs __attribute__((vector_size(8 * width))); \
    typedef std::int32_t Ints __attribute__((vector_size(4 * width)));  \
  };
STRAY_VECTOR_OF(2)
STRAY_VECTOR_OF(4)
STRAY_VECTOR_OF(8)
#undef STRAY_VECTOR_OF

// Bit i is set where low < 0 < high in lane i. Only what every x86-64 has: the same source serves all widths. Eight are
// compared as two times four: g++ 12 would compare 512 bits one number at a time.
template <int Width>
STRAY_INLINE unsigned of_both_signs(typename VectorOf<Width>::Doubles const& low,
                                    typename VectorOf<Width>::Doubles const& high) {
  typedef float Four __attribute__((vector_size(16)));
  if constexpr (Width == 8) {
    union Halves {
      typename VectorOf<8>::Doubles all;
      typename VectorOf<4>::Doubles half[2];
    };
    Halves const l{low}, h{high};
    return of_both_signs<4>(l.half[0], h.half[0]) | of_both_signs<4>(l.half[1], h.half[1]) << 4;
  } else {
    typename VectorOf<Width>::Doubles const zero{};
    typename VectorOf<Width>::Longs const both = (low < zero) & (high > zero);
    union {
      typename VectorOf<Width>::Ints all;
      Four floats;
    } narrow;
    narrow.floats = Four{};
    narrow.all = __builtin_convertvector(both, typename VectorOf<Width>::Ints);
    return unsigned(__builtin_ia32_movmskps(narrow.floats));
  }
}

template <int Width>
STRAY_INLINE void shear(ShearedRay const& r, float const (&corner)[3][8], int first,
                        typename VectorOf<Width>::Doubles& x, typename VectorOf<Width>::Doubles& y) {
  using Doubles = typename VectorOf<Width>::Doubles;
  using Floats = typename VectorOf<Width>::Floats;
  Floats const fx = *reinterpret_cast<Floats const*>(&corner[r.x][first]);
  Floats const fy = *reinterpret_cast<Floats const*>(&corner[r.y][first]);
  Floats const fz = *reinterpret_cast<Floats const*>(&corner[r.z][first]);
  Doubles const dz = __builtin_convertvector(fz, Doubles) - r.at[2];
  x = (__builtin_convertvector(fx, Doubles) - r.at[0]) - r.slope_x * dz;
  y = (__builtin_convertvector(fy, Doubles) - r.at[1]) - r.slope_y * dz;
}

// Bit i is set unless the line of the ray passes triangle i of the pack for certain.
template <int Width>
STRAY_INLINE unsigned may_meet(ShearedRay const& r, TrianglePack const& pack) {
  using Doubles = typename VectorOf<Width>::Doubles;
  unsigned apart = 0;
  for (int first = 0; first < 8; first += Width) {
    Doubles ax, ay, bx, by, cx, cy;
    shear<Width>(r, pack.corner[0], first, ax, ay);
    shear<Width>(r, pack.corner[1], first, bx, by);
    shear<Width>(r, pack.corner[2], first, cx, cy);
    Doubles const u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    Doubles low = u < v ? u : v, high = u > v ? u : v;
    low = low < w ? low : w;
    high = high > w ? high : w;
    apart |= of_both_signs<Width>(low, high) << first;
  }
  return ~apart;
}
#else
template <int Width>
STRAY_INLINE unsigned may_meet(ShearedRay const&, TrianglePack const&) {
  return 0xff;
}
#endif

}  // namespace mesh_detail

template <int Width>
STRAY_INLINE void TriangleMesh::Search::try_pack(std::uint32_t number, std::uint32_t count) {
  TrianglePack const& pack = mesh->content.packs[number];
  unsigned lanes = mesh_detail::may_meet<Width>(sheared, pack) & ((1u << count) - 1);
  while (lanes != 0) {
    int const i = simd::lowest(lanes);
    lanes &= lanes - 1;
    auto const at = [&](int k) { return Vec3{pack.corner[k][0][i], pack.corner[k][1][i], pack.corner[k][2][i]}; };
    try_triangle(pack.triangle[i], at(0), at(1), at(2));
  }
}

template <int Width>
STRAY_INLINE Crossing TriangleMesh::crossing_with(Ray const& ray, std::uint32_t leaving) const {
  Ray const local = in_file(ray);
  Search search(*this, local.origin, local.dir, ray.t_max, leaving);
  auto const leaf = [&](std::uint32_t first, std::uint32_t count, double&) STRAY_INLINE_LAMBDA {
    search.try_pack<Width>(first, count);
    return false;
  };
  content.tree.traverse(local, search.limit, leaf, [&](std::uint32_t first) STRAY_INLINE_LAMBDA {
    bvh8_detail::fetch_early<sizeof(TrianglePack)>(&content.packs[first]);
  });
  return search.result();
}

STRAY_HD Box TriangleMesh::bounds() const {
  Box box;
  for (int i = 0; i < 8; ++i) {
    Vec3 const at{(i & 1 ? content.box.upper : content.box.lower).x, (i & 2 ? content.box.upper : content.box.lower).y,
                  (i & 4 ? content.box.upper : content.box.lower).z};
    box.add(pose.point(unit * at));
  }
  double const r = 0x1p-48 * (length(pose.origin) + length(box.upper - box.lower) + unit * content.far);  // of rounding
  Vec3 const pad{r, r, r};
  return {box.lower - pad, box.upper + pad};
}

// Rays in large meshes take turns: a mesh does not fit into the cache, and while one ray waits for a node or a pack of
// triangles, the others advance. Every ray does the operations of TriangleMesh::crossing, so the bits are the same.
template <int Width>
class MeshTurn {
 public:
  // False: the ray misses the mesh.
  STRAY_INLINE bool begin(TriangleMesh const& mesh, Ray const& ray, std::uint32_t leaving) {
    Ray const local = mesh.in_file(ray);
    search_.emplace(mesh, local.origin, local.dir, ray.t_max, leaving);
    Bvh8::View const& tree = mesh.content.tree;
    probe_.shift = 0;
    if (tree.nodes.size == 0 || !probe_.set(tree, local, search_->limit)) return false;
    walk_.begin(search_->limit - probe_.shift);
    return true;
  }
  // Visits one node or one pack and prefetches the next; false: the search of this ray is complete.
  STRAY_INLINE bool turn() {
    MeshContent const& mesh = search_->mesh->content;
    if (walk_.at_leaf()) {
      double const before = search_->limit;
      search_->template try_pack<Width>(walk_.leaf_first(), walk_.leaf_count());
      if (search_->limit < before) walk_.shorten(search_->limit - probe_.shift);
      if (!walk_.back()) return false;
    } else {
      bvh8_detail::Slabs const slabs(probe_);
      bool const down = walk_.down(mesh.tree.nodes[walk_.next], slabs, probe_.near_row, [](std::uint32_t) {});
      if (!down && !walk_.back()) return false;
    }
    if (walk_.at_leaf())
      bvh8_detail::fetch_early<sizeof(TrianglePack)>(&mesh.packs[walk_.leaf_first()]);
    else
      bvh8_detail::fetch_early<sizeof(Bvh8::Node)>(mesh.tree.nodes.data + walk_.next);
    return true;
  }
  STRAY_INLINE Crossing result() const { return search_->result(); }

 private:
  std::optional<TriangleMesh::Search> search_;
  bvh8_detail::Probe probe_;
  bvh8_detail::Walk walk_;
};

// Normals at the corners of the triangles of a mesh, for reflection, refraction and scatter. Which side of a triangle
// light meets, where it meets it, and areas remain those of the flat facet. Page: docs/reference/shapes/mesh.md.

// The mesh with normals of its own: at each corner the mean of the normals of those triangles at the vertex that differ
// by at most `angle` [rad] from the triangle, weighted by their angles there.
MeshContent smoothed(MeshContent, double angle, Storage&);
// The same with stated normals, three per triangle in the frame of the file, of any length. One of length 0, and one at
// a right angle to its triangle or beyond, is replaced by the normal of the facet or turned to its side.
MeshContent smoothed(MeshContent, std::vector<MeshVertex> normals, Storage&);

}  // namespace straytrace::geometry
