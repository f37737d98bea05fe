// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/obstacle.hpp"

#include <algorithm>
#include <type_traits>

#include "beams/overlap.hpp"

namespace straytrace::world {

// rho^2 = (root x + b/root y)^2 + (rest y)^2 for Im Q = (a, b; b, c) lambda/pi.
BeamLines::BeamLines(Mode const& mode) : origin(mode.origin), travel(mode.travel) {
  double const k = pi / mode.wavelength, a = k * mode.q11.imag(), b = k * mode.q12.imag(), c = k * mode.q22.imag();
  double const root = std::sqrt(a), rest = std::sqrt(c - b * b / a);
  across_ = (1 / root) * mode.e1;
  up_ = (1 / rest) * (mode.e2 - (b / a) * mode.e1);
}

Vec3 BeamLines::towards(SinCos a) const { return a.cos * across_ + a.sin * up_; }

Stripes without(Stripes const& all, Stripes const& gone) {
  Stripes left;
  for (Stripe rest : all) {
    for (Stripe const& g : gone) {
      if (g.to <= rest.from || g.from >= rest.to) continue;
      if (g.from > rest.from) left.push_back({rest.from, g.from});
      rest.from = std::min(g.to, rest.to);
    }
    if (!rest.empty()) left.push_back(rest);
  }
  return left;
}

Stripes together(Stripes const& one, Stripes const& two) {
  Stripes all = one;
  for (Stripe const& s : without(two, one)) all.push_back(s);
  std::ranges::sort(all, [](Stripe const& a, Stripe const& b) { return a.from < b.from; });
  return all;
}

double share_of(Stripes const& all) {
  double sum = 0;
  for (Stripe const& s : all) sum += s.share();
  return sum;
}

namespace {

Stripe inside_ellipse(PlanePoint p, PlanePoint v) {  // of the unit circle
  double const a = v.x * v.x + v.y * v.y, b = p.x * v.x + p.y * v.y, c = p.x * p.x + p.y * p.y - 1;
  double const square = b * b - a * c;
  if (!(square > 0) || a == 0) return {0, a == 0 && c < 0 ? infinity : 0};
  double const q = -(b + std::copysign(std::sqrt(square), b)), one = q / a, two = c / q;
  return {std::max(0.0, std::min(one, two)), std::max(0.0, std::max(one, two))};
}
// Stays on the inner side of the line n.x = a.
void cut(Stripe& s, PlanePoint p, PlanePoint v, PlanePoint n, double a) {
  double const room = a - (n.x * p.x + n.y * p.y), speed = n.x * v.x + n.y * v.y;
  if (speed > 0) s.to = std::min(s.to, room / speed);
  if (speed < 0) s.from = std::max(s.from, room / speed);
  if (speed == 0 && room < 0) s.to = 0;
}

Outline circle(double radius) { return {radius, radius}; }
Outline outline_of(RegularOutline const& o) {
  return o.sides == 0 ? circle(o.radius) : Outline{o.radius, o.radius, o.sides, o.rotation, o.apothem};
}

FlatRim about(Vec3 centre, Vec3 axis, double inner, double outer) {
  Frame const f = Frame::around(axis);
  return {centre, f.e1, f.e2, axis, circle(outer), circle(inner), inner > 0};
}
FlatRim in_plane(PlaneFrame const& s, Outline const& outer, Outline const& inner, bool hole) {
  return {s.origin, s.e1, s.e2, s.axis, outer, inner, hole};
}

// The rims of round shapes, taken as flat at the height of this radius about the middle of the aperture.
FlatRim flat_at(Disk const& s, double) { return about(s.centre, s.axis, s.inner_radius, s.outer_radius); }
FlatRim flat_at(Cap const& s, double radius) {
  return about(s.vertex + (s.curvature * s.depth(radius)) * s.axis, s.axis, s.inner_radius, s.outer_radius);
}
FlatRim flat_at(Conic const& s, double radius) {
  double const rim = radius + s.decentre();
  return about(s.vertex + s.decentre_x * s.e1 + s.decentre_y * s.e2 + s.sag(rim * rim) * s.axis, s.axis, s.inner_radius,
               s.outer_radius);
}
template <class Shape>
concept RoundRim = requires(Shape const& s) {
  flat_at(s, 1.0);
};

template <class Shape>
std::vector<FlatRim> rim_of_shape(Shape const& s) {
  if constexpr (RoundRim<Shape>) return {flat_at(s, s.inner_radius > 0 ? s.inner_radius : s.outer_radius)};
  return {};
}
std::vector<FlatRim> rim_of_shape(Rectangle const& s) {
  return {in_plane(s, {s.width / 2, s.height / 2, 4, 0, 0, true}, {s.hole_width / 2, s.hole_height / 2, 4, 0, 0, true},
                   s.hole_width > 0 && s.hole_height > 0)};
}
std::vector<FlatRim> rim_of_shape(Ellipse const& s) {
  return {in_plane(s, {s.semi_x, s.semi_y}, {s.hole_x, s.hole_y}, s.hole_x > 0)};
}
std::vector<FlatRim> rim_of_shape(Polygon const& s) {
  return {in_plane(s, outline_of(s.outline()), outline_of(s.hole()), s.hole_radius > 0)};
}

std::vector<FlatRim> rim_of_shape(Cuboid const& s) {
  std::vector<FlatRim> faces;
  auto const add = [&](Vec3 n, Vec3 a, Vec3 b, double away, double width, double height) {
    for (double side : {-0.5, 0.5})
      faces.push_back({s.centre + (side * away) * n, a, b, n, {width / 2, height / 2, 4, 0, 0, true}, {}, false});
  };
  add(s.e1, s.e2, s.axis, s.width, s.height, s.depth);
  add(s.e2, s.axis, s.e1, s.height, s.depth, s.width);
  add(s.axis, s.e1, s.e2, s.depth, s.width, s.height);
  return faces;
}

}  // namespace

Stripe Outline::inside(PlanePoint p, PlanePoint v) const {
  if (sides == 0) return inside_ellipse({p.x / semi_x, p.y / semi_y}, {v.x / semi_x, v.y / semi_y});
  Stripe s;
  for (double k = 0; k < sides; ++k) {
    if (rectangle) {
      bool const x = k < 2;
      double const sign = int(k) % 2 == 0 ? 1 : -1;
      cut(s, p, v, {x ? sign : 0, x ? 0 : sign}, x ? semi_x : semi_y);
    } else {
      double const middle = rotation + 2 * pi * (k + 0.5) / sides;
      cut(s, p, v, {std::cos(middle), std::sin(middle)}, apothem);
    }
  }
  return s.empty() ? Stripe{0, 0} : s;
}

Stripes FlatRim::met(Vec3 start, Vec3 step, Vec3 travel) const {
  double const slope = dot(travel, axis);
  Vec3 const p = start - centre - (dot(start - centre, axis) / slope) * travel,
             v = step - (dot(step, axis) / slope) * travel;
  PlanePoint const at{dot(p, e1), dot(p, e2)}, by{dot(v, e1), dot(v, e2)};
  Stripe const within = outer.inside(at, by);
  if (within.empty()) return {};
  if (!hole) return {within};
  Stripe const open = inner.inside(at, by);
  return open.empty() ? Stripes{within} : without({within}, {open});
}

std::vector<FlatRim> flat_rims(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return rim_of_shape(s); });
}

namespace {

template <class Shape>
std::optional<InnerRim> inner_rim_of(Shape const& s) {
  constexpr bool cone = std::is_base_of_v<Cone, Shape>, cap = std::is_same_v<Shape, Cap>;
  if constexpr (std::is_same_v<Shape, Disk> || cap || cone) {
    if (!(s.inner_radius > 0)) return {};
    Frame const f = Frame::around(s.axis);
    InnerRim rim{{}, s.reference(), s.axis, f.e1, f.e2, s.inner_radius, 0, 0, 0, 0};
    if constexpr (cap) rim.centre = rim.centre + s.curvature * s.depth(s.inner_radius) * s.axis;
    if constexpr (cone) rim.slope = s.cosine / s.sine;
    if constexpr (std::is_same_v<Shape, SerratedCone>) {
      rim.e1 = s.e1;
      rim.e2 = s.e2;
      rim.tooth_depth = s.tooth_depth;
      rim.teeth = s.teeth;
      rim.phase = s.phase;
    }
    return rim;
  } else {
    return {};
  }
}

}  // namespace

std::optional<InnerRim> rim_of(World const& world, SurfaceId id) {
  std::optional<InnerRim> rim =
      world.view().shapes.visit(world.surfaces()[id.value].shape, [](auto const& s) { return inner_rim_of(s); });
  if (rim) rim->surface = id;
  return rim;
}

double rim_radius(InnerRim const& rim, double azimuth) {
  if (rim.tooth_depth == 0) return rim.radius;
  double const x = (azimuth - rim.phase) / (2 * pi) * rim.teeth;
  return rim.radius + rim.tooth_depth * (1 - std::fabs(1 - 2 * (x - std::floor(x))));
}

Vec3 rim_point(InnerRim const& rim, double azimuth) {
  double const r = rim_radius(rim, azimuth);
  return rim.centre + (r - rim.radius) * rim.slope * rim.axis + r * std::cos(azimuth) * rim.e1 +
         r * std::sin(azimuth) * rim.e2;
}

namespace {

constexpr double reach = BeamLines::farthest;
constexpr double flat_rim_cosine = 0.02;  // of incidence; below it a rim does not count as flat

// Largest 1/e^2 radius, m.
double widest(Mode const& m) {
  auto const size = eigenvalues(m.q11.imag(), m.q12.imag(), m.q22.imag());
  return std::sqrt(m.wavelength / (pi * std::min(size[0], size[1])));
}

double beside_round(FlatRim const& rim, Mode const& mode) {
  double const outer = rim.outer.semi_x, inner = rim.inner.semi_x;
  double const cosine = std::fabs(dot(mode.travel, rim.axis)), far = reach * widest(mode) / cosine;
  Vec3 const o = mode.origin + (dot(rim.centre - mode.origin, rim.axis) / dot(mode.travel, rim.axis)) * mode.travel;
  double const off = length(o - rim.centre);
  double share = off + far < outer ? 0 : clipped_share(Aperture{rim.centre, rim.axis, outer}, mode);
  if (inner > 0 && off - far < inner)
    share += std::max(0.0, 1 - clipped_share(Aperture{rim.centre, rim.axis, inner}, mode));
  return std::min(share, 1.0);
}

// Where `meets(rho)` changes, from its value at rho = 0: steps of farthest/per_farthest, then bisection.
template <class Meets>
std::vector<double> edges(int steps, int per_farthest, int halvings, bool before, Meets const& meets) {
  std::vector<double> all;
  double last = 0;
  for (int i = 1; i <= steps; ++i) {
    double const rho = BeamLines::farthest * i / per_farthest;
    if (bool const now = meets(rho); now != before) {
      double low = last, high = rho;
      for (int h = 0; h < halvings; ++h) {
        double const middle = 0.5 * (low + high);
        (meets(middle) == before ? low : high) = middle;
      }
      all.push_back(high);
      before = now;
    }
    last = rho;
  }
  return all;
}

// Any shape: the lines parallel to the chief ray that miss it.
class Scan {
 public:
  Scan(WorldView const& world, SurfaceId surface, Mode const& mode) : world_(world), surface_(surface), lines_(mode) {
    Box const box = bounds_of(world, surface);
    back_ = diagonal(box) + length(mode.origin - box.lower);
  }
  double beside() const {
    if (all_meet()) return 0;
    double sum = 0;
    for (int i = 0; i < azimuths; ++i) sum += along((i + 0.5) / azimuths);
    return sum / azimuths;
  }

 private:
  static constexpr int azimuths = 64, rings = 32, halvings = 40;
  bool meets(Vec3 direction, double rho) const {
    Ray const line{lines_.origin + rho * direction - back_ * lines_.travel, lines_.travel};
    return world_.cross(surface_.value, line, {}).distance < infinity;
  }
  Vec3 towards(double turn) const { return lines_.towards(sincos_turn(turn)); }
  bool all_meet() const {
    for (int i = 0; i < 16; ++i)
      for (double rho : {reach, 0.5 * reach})
        if (!meets(towards(i / 16.0), rho)) return false;
    return true;
  }
  static double beyond(double rho) { return std::exp(-2 * rho * rho); }
  double along(double turn) const {
    Vec3 const direction = towards(turn);
    double missed = 0;
    bool before = true;  // the chief ray meets it
    for (double const edge : edges(rings, rings, halvings, before, [&](double rho) { return meets(direction, rho); })) {
      missed += (before ? 1 : -1) * beyond(edge);
      before = !before;
    }
    return missed;
  }

  WorldView const& world_;
  SurfaceId surface_;
  BeamLines lines_;
  double back_ = 0;
};

}  // namespace

double beside_rim(WorldView const& world, SurfaceId surface, Mode const& mode) {
  std::optional<FlatRim> const rim =
      world.shapes.visit(world.surfaces[surface.value].shape, [](auto const& s) -> std::optional<FlatRim> {
        if constexpr (RoundRim<std::decay_t<decltype(s)>>) return flat_at(s, s.outer_radius);
        return {};
      });
  if (rim && std::fabs(dot(mode.travel, rim->axis)) > flat_rim_cosine) return beside_round(*rim, mode);
  return Scan(world, surface, mode).beside();
}

namespace {

constexpr double edge_on = 1e-6;  // cosine below which a flat surface takes nothing

// For light whose shares below `least` do not matter.
Fineness fineness(double least) { return least < 1e-8 ? Fineness{128, 1024, 32, 36} : Fineness{32, 128, 24, 12}; }

// Where a + b rho < 0.
Stripes negative(double a, double b) {
  double const root = -a / b;
  if (a < 0) return {{0, b > 0 ? root : infinity}};
  return b < 0 ? Stripes{{root, infinity}} : Stripes{};
}

}  // namespace

double reach_of(BeamFlight const& f) { return std::sqrt(-0.5 * std::log(f.least)); }
Box bounds_of(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return s.bounds(); });
}
double diagonal(Box const& box) { return length(box.upper - box.lower); }

std::array<double, 2> heights(WorldView const& view, SurfaceId id, BeamLines const& lines) {
  Box const box = bounds_of(view, id);
  Vec3 const half = 0.5 * (box.upper - box.lower), t = lines.travel;
  double const middle = dot(box.lower + half - lines.origin, t);
  double const size = std::fabs(half.x * t.x) + std::fabs(half.y * t.y) + std::fabs(half.z * t.z);
  return {middle - size, middle + size};
}

Obstacle::Obstacle(WorldView const& view, SurfaceId id, BeamFlight const& flight, double along, Stretch const& stretch)
    : view_(&view),
      id_(id),
      along_(along),
      lines_(propagated(flight.mode, along)),
      stretch_(&stretch),
      fine_(fineness(flight.least)),
      rings_(int(std::ceil(fine_.rings * reach_of(flight) / BeamLines::farthest))),
      rims_(flat_rims(view, id)),
      low_(lines_),
      high_(lines_) {
  auto const [low, high] = heights(view, id, lines_);
  double const end = flight.to.surface.valid() ? flight.to.distance : infinity;
  from_ = std::clamp(along + low, 0.0, end);
  to_ = std::clamp(along + high, 0.0, end);
  if (spreads()) {
    low_ = BeamLines(propagated(flight.mode, from_));
    high_ = BeamLines(propagated(flight.mode, to_));
  }
  Box const box = bounds_of(view, id);
  Vec3 const o = 0.5 * (box.lower + box.upper) - lines_.origin;
  aside_ = o - dot(o, lines_.travel) * lines_.travel;
  size_ = 0.5 * diagonal(box);
}

bool Obstacle::possible(double reach) const {
  auto const [low, high] = heights(*view_, id_, lines_);
  // The root of the sum of two squares is a little more than the widest of them.
  double const wide = reach * std::sqrt(length2(lines_.towards({0, 1})) + length2(lines_.towards({1, 0})));
  return high > stretch_->from.at - along_ - wide * length(stretch_->from.slope) &&
         low < stretch_->to.at - along_ + wide * length(stretch_->to.slope);
}

Fan Obstacle::fan(SinCos azimuth) const {
  Vec3 const middle = lines_.towards(azimuth);
  if (!rims_.empty()) return {middle, middle, middle};
  return {middle, low_.towards(azimuth), high_.towards(azimuth)};
}

Stripes Obstacle::met(Fan const& fan) const {
  if (passes(fan.middle)) return {};
  if (rims_.empty()) return searched(fan);
  Stripes all;
  for (FlatRim const& rim : rims_) {
    if (std::fabs(dot(rim.axis, lines_.travel)) < edge_on) continue;
    Stripes const met = without(rim.met(lines_.origin, fan.middle, lines_.travel), off_stretch(rim, fan.middle));
    all = all.empty() ? met : together(all, met);
  }
  return all;
}

Obstacle::Meeting Obstacle::meeting(Fan const& fan, double rho) const {
  double const from = stretch_->from.over(rho * fan.middle), to = stretch_->to.over(rho * fan.middle);
  if (!(from < to)) return {};
  Vec3 const spread = rho * (fan.high - fan.low), step = lines_.travel + (spreads() ? 1 / (to_ - from_) : 0) * spread;
  Vec3 const start = low_.origin + rho * fan.low + (from - (spreads() ? from_ : along_)) * step;
  double const stretched = length(step);
  Crossing const hit = view_->cross(id_.value, {start, (1 / stretched) * step, (to - from) * stretched}, {});
  if (!(hit.distance < infinity)) return {};
  return {start + (hit.distance / stretched) * step, from + hit.distance / stretched, hit.piece};
}

int Obstacle::azimuths() const {
  if (!(length(aside_) > size_)) return fine_.azimuths;
  return std::clamp(int(0.4 * fine_.azimuths * length(aside_) / size_), fine_.azimuths, fine_.most_azimuths);
}

// Lines that cross the plane of a rim before the start of the stretch, or behind its end.
Stripes Obstacle::off_stretch(FlatRim const& rim, Vec3 direction) const {
  double const slope = dot(rim.axis, lines_.travel);
  double const at = along_ + dot(rim.centre - lines_.origin, rim.axis) / slope,
               per_rho = -dot(direction, rim.axis) / slope;
  Stripes off = negative(at - stretch_->from.at, per_rho - dot(direction, stretch_->from.slope));
  if (stretch_->to.at < infinity)
    off = together(off, negative(stretch_->to.at - at, dot(direction, stretch_->to.slope) - per_rho));
  return off;
}

// Whether no line of this azimuth comes near the ball around it.
bool Obstacle::passes(Vec3 direction) const {
  if (!(length2(aside_) > size_ * size_)) return false;
  Vec3 const u = unit(direction);
  double const ahead = dot(aside_, u);
  return ahead < 0 || length2(aside_) - ahead * ahead > size_ * size_;
}

Stripes Obstacle::searched(Fan const& fan) const {
  Stripes all;
  auto const meets = [&](double rho) { return meeting(fan, rho).along < infinity; };
  bool before = meets(0);
  double entered = 0;
  for (double const edge : edges(rings_, fine_.rings, fine_.halvings, before, meets)) {
    if (before) all.push_back({entered, edge});
    entered = edge;
    before = !before;
  }
  if (before) all.push_back({entered, infinity});
  return all;
}

}  // namespace straytrace::world
