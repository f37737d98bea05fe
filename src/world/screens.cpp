// SPDX-License-Identifier: BSD-3-Clause
#include "world/screens.hpp"

#include <algorithm>
#include <complex>

#include "beams/symmetric.hpp"

namespace straytrace {

// Upper bound of the square of the larger 1/e^2 radius at z >= 0: a + b z + c z^2, convex. With Q^-1 = A - iY at z = 0,
// (Im Q)^-1 = Y + (A + z) Y^-1 (A + z) there. Exact for round beams.
struct BeamWidth {
  double a = 0, b = 0, c = 0;
  explicit BeamWidth(Mode const& m) {
    std::complex<double> const det = m.q11 * m.q22 - m.q12 * m.q12;
    std::complex<double> const i11 = m.q22 / det, i12 = -m.q12 / det, i22 = m.q11 / det;
    double const a11 = i11.real(), a12 = i12.real(), a22 = i22.real();
    double const y11 = -i11.imag(), y12 = -i12.imag(), y22 = -i22.imag(), y = y11 * y22 - y12 * y12;
    double const u11 = y22 / y, u12 = -y12 / y, u22 = y11 / y;  // Y^-1
    double const p11 = a11 * u11 + a12 * u12, p12 = a11 * u12 + a12 * u22, p21 = a12 * u11 + a22 * u12,
                 p22 = a12 * u12 + a22 * u22;  // A Y^-1
    double const unit = m.wavelength / pi;
    a = unit * largest(p11 * a11 + p12 * a12 + y11, p11 * a12 + p12 * a22 + y12, p21 * a12 + p22 * a22 + y22);
    b = unit * largest(2 * p11, p12 + p21, 2 * p22);
    c = unit * largest(u11, u12, u22);
  }
  static double largest(double m11, double m12, double m22) {
    auto const e = eigenvalues(m11, m12, m22);
    return std::max(e[0], e[1]);
  }
  double at(double z) const { return std::sqrt(std::max(0.0, a + z * (b + z * c))); }
  double between(double low, double high) const { return std::max(at(low), at(high)); }
};

namespace {

// Change of the distance along the beam to a plane, per offset from the chief ray.
double steepness(Vec3 normal, Vec3 travel) {
  double const cosine = std::fabs(dot(normal, travel));
  return std::sqrt(std::max(0.0, 1 - cosine * cosine)) / std::max(cosine, 0.02);
}

}  // namespace

// The beam out to `reach` radii, from its start to where all of it has met the next surface.
struct Screens::Tube {
  Vec3 start, travel;
  BeamWidth width;
  double reach, end;
  SurfaceId from, contact, to;
  std::uint32_t volume;
  Tube(WorldView const& view, Flight const& f, double radii)
      : start(f.mode.origin),
        travel(f.mode.travel),
        width(f.mode),
        reach(radii),
        end(f.to.surface.valid() ? f.to.distance : infinity),
        from(f.from.surface),
        contact(f.from.contact),
        to(f.to.surface),
        volume(f.volume) {
    if (to.valid()) end += radii * width.at(end) * steepness(view.normal(to, start + end * travel, f.to.piece), travel);
  }
  bool own(SurfaceId id) const { return id == from || id == contact || id == to; }
  // Whether the ball is beside it; otherwise the stretch of the chief ray beside the ball.
  bool misses(Vec3 centre, double radius, double& low, double& high) const {
    Vec3 const o = centre - start;
    double const z = dot(o, travel);
    low = std::max(0.0, z - radius);
    high = std::min(end, z + radius);
    if (!(low <= high)) return true;
    double const beside = std::sqrt(std::max(0.0, length2(o) - z * z)) - radius;
    return beside > 0 && beside > reach * width.between(low, high);
  }
};

Screens::Screens(WorldView const& view) : view_(view) {
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id) {
    Surface const& s = view.surfaces[id];
    if (s.clear) continue;
    view.shapes.visit(s.shape, [&](auto const& shape) {
      Bounds b;
      Box const box = shape.bounds();
      b.surface.value = id;
      b.centre = 0.5 * (box.lower + box.upper);
      b.radius = 0.5 * length(box.upper - box.lower);
      b.reference = shape.reference();
      b.axis = shape.axis;
      b.volume = s.volume;
      shape.extent(b.low, b.high, b.r_min, b.r_max);
      bounds_.push_back(b);
    });
  }
  if (!bounds_.empty()) build(0, std::uint32_t(bounds_.size()));
}

std::uint32_t Screens::build(std::uint32_t first, std::uint32_t count) {
  constexpr std::uint32_t most = 4;
  auto const number = std::uint32_t(nodes_.size());
  nodes_.emplace_back();
  Box box;
  for (std::uint32_t i = first; i < first + count; ++i) box.add(bounds_[i].centre);
  Vec3 const centre = 0.5 * (box.lower + box.upper), size = box.upper - box.lower;
  double radius = 0;
  for (std::uint32_t i = first; i < first + count; ++i)
    radius = std::max(radius, length(bounds_[i].centre - centre) + bounds_[i].radius);
  Node node{centre, radius, first, count, 0};
  if (count > most) {
    Vec3 const along = size.x >= size.y && size.x >= size.z ? Vec3{1, 0, 0}
                       : size.y >= size.z                   ? Vec3{0, 1, 0}
                                                            : Vec3{0, 0, 1};
    std::uint32_t const half = count / 2;
    auto const from = bounds_.begin() + first;
    std::nth_element(from, from + half, from + count,
                     [along](Bounds const& a, Bounds const& b) { return dot(a.centre, along) < dot(b.centre, along); });
    build(first, half);
    node.right = build(first + half, count - half);
    node.count = 0;
  }
  nodes_[number] = node;
  return number;
}

void Screens::collect(Tube const& tube, std::uint32_t number, std::vector<SurfaceId>& found) const {
  Node const& node = nodes_[number];
  double low = 0, high = 0;
  if (tube.misses(node.centre, node.radius, low, high)) return;
  if (node.count == 0) {
    collect(tube, number + 1, found);
    collect(tube, node.right, found);
    return;
  }
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    Bounds const& b = bounds_[i];
    if (tube.own(b.surface) || (tube.volume != Surface::none && b.volume != tube.volume)) continue;
    if (!tube.misses(b.centre, b.radius, low, high) && !clear(tube, b, low, high)) found.push_back(b.surface);
  }
}

// Whether the beam certainly passes a surface by: within its hole, inside of it, or beside it. The surface lies between
// two heights along its axis and two distances from that.
bool Screens::clear(Tube const& tube, Bounds const& b, double low, double high) const {
  if (!(high < infinity)) high = low;  // never: balls are finite
  double const pad = tube.reach * tube.width.between(low, high);
  Vec3 const o = tube.start - b.reference;
  double const slope = dot(tube.travel, b.axis), height = dot(o, b.axis);
  double const side = pad * std::sqrt(std::max(0.0, 1 - slope * slope));
  if (std::fabs(slope) > 1e-9) {
    double const one = (b.low - side - height) / slope, two = (b.high + side - height) / slope;
    low = std::max(low, std::min(one, two));
    high = std::min(high, std::max(one, two));
  } else if (height + side < b.low || height - side > b.high) {
    return true;
  }
  if (low > high) return true;
  Vec3 const across = o - height * b.axis, step = tube.travel - slope * b.axis;
  auto const away = [&](double s) { return length(across + s * step); };
  double const farthest = std::max(away(low), away(high)), steps = length2(step);
  if (farthest + pad < b.r_min) return true;
  double const turn = steps > 0 ? std::clamp(-dot(across, step) / steps, low, high) : low;
  if (away(turn) - pad > b.r_max) return true;
  return view_.shapes.visit(view_.surfaces[b.surface.value].shape, [&](auto const& s) {
    using Shape = std::decay_t<decltype(s)>;
    Vec3 const p = tube.start + low * tube.travel, q = tube.start + high * tube.travel;
    if constexpr (std::is_base_of_v<Sphere, Shape>)
      return std::max(length(p - s.centre), length(q - s.centre)) + pad < s.radius;
    if constexpr (std::is_same_v<Shape, Cuboid>) {
      bool inside = true;
      for (auto const& [e, size] : {std::pair{s.e1, s.width}, {s.e2, s.height}, {s.axis, s.depth}}) {
        double const x = dot(p - s.centre, e), y = dot(q - s.centre, e), half = 0.5 * size;
        if (std::min(x, y) - pad > half || std::max(x, y) + pad < -half) return true;
        inside = inside && std::max(x, y) + pad < half && std::min(x, y) - pad > -half;
      }
      return inside;
    }
    return false;
  });
}

std::vector<SurfaceId> Screens::near(Flight const& flight, double reach) const {
  std::vector<SurfaceId> found;
  if (!nodes_.empty()) collect(Tube(view_, flight, reach), 0, found);
  return found;
}

}  // namespace straytrace
