// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/screens.hpp"

#include <algorithm>
#include <complex>
#include <optional>

#include "world/ghosts/beam_tree.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::world {

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
  Tube(WorldView const& view, BeamFlight const& f, double radii)
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
      b.extent = shape.extent();
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

// Whether the beam certainly misses a surface: through its hole, inside it, or beside it. The surface lies between
// two heights along its axis and two distances from that.
bool Screens::clear(Tube const& tube, Bounds const& b, double low, double high) const {
  if (!(high < infinity)) high = low;  // never: balls are finite
  double const pad = tube.reach * tube.width.between(low, high);
  Vec3 const o = tube.start - b.reference;
  double const slope = dot(tube.travel, b.axis), height = dot(o, b.axis);
  double const side = pad * std::sqrt(std::max(0.0, 1 - slope * slope));
  if (std::fabs(slope) > 1e-9) {
    double const one = (b.extent.low - side - height) / slope, two = (b.extent.high + side - height) / slope;
    low = std::max(low, std::min(one, two));
    high = std::min(high, std::max(one, two));
  } else if (height + side < b.extent.low || height - side > b.extent.high) {
    return true;
  }
  if (low > high) return true;
  Vec3 const across = o - height * b.axis, step = tube.travel - slope * b.axis;
  auto const away = [&](double s) { return length(across + s * step); };
  double const farthest = std::max(away(low), away(high)), steps = length2(step);
  if (farthest + pad < b.extent.r_min) return true;
  double const turn = steps > 0 ? std::clamp(-dot(across, step) / steps, low, high) : low;
  if (away(turn) - pad > b.extent.r_max) return true;
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

std::vector<SurfaceId> Screens::near(BeamFlight const& flight, double reach) const {
  std::vector<SurfaceId> found;
  if (!nodes_.empty()) collect(Tube(view_, flight, reach), 0, found);
  return found;
}

// Shares that screens remove from a beam on one flight, line by line.

namespace {

constexpr double grazing = 0.02;  // cosine below which the surface left or met is taken as across the beam

Slant plane(double at, Vec3 normal, Vec3 travel) {
  double const along = dot(normal, travel);
  if (std::fabs(along) < grazing) return {at, {}};
  return {at, (-1 / along) * (normal - along * travel)};
}

// Of the line that meets it nearest to the chief ray.
void keep_nearest(Screened& s, Obstacle const& o, Fan const& fan, Stripes const& met) {
  if (met.empty() || met.front().from >= s.nearest) return;
  s.nearest = met.front().from;
  Stripe const& first = met.front();
  Obstacle::Meeting const hit = o.meeting(fan, first.from + std::min(0.1, 0.5 * (first.to - first.from)));
  if (!(hit.along < infinity)) return;
  s.point = hit.point;
  s.piece = hit.piece;
}

// Of lines that meet two screens, those that meet the other one first.
Stripes behind(Obstacle const& own, Fan const& fan, Stripes const& met, Obstacle const& other, Fan const& others,
               Stripes const& met_by_other) {
  Stripes gone;
  for (Stripe const& both : without(met, without(met, met_by_other))) {
    double const rho = both.from + std::min(0.1, 0.5 * (both.to - both.from));
    double const mine = own.meeting(fan, rho).along, first = other.meeting(others, rho).along;
    if (first < mine || (first == mine && other.id() < own.id())) gone.push_back(both);
  }
  return gone;
}

// Assigns each line to the first screen that it meets.
class Sharing {
 public:
  Sharing(std::vector<Obstacle> const& screens, std::vector<Screened>& found)
      : screens_(screens), found_(found), fans_(screens.size()), met_(screens.size()) {}

  // Adds the lines of one azimuth of `count`, but for the dark ones; all that meet a screen.
  Stripes add(SinCos azimuth, int count, Stripes const& dark) {
    Stripes taken = dark;
    for (std::size_t i = 0; i < screens_.size(); ++i) {
      fans_[i] = screens_[i].fan(azimuth);
      met_[i] = screens_[i].met(fans_[i]);
      found_[i].alone += share_of(met_[i]) / count;
      keep_nearest(found_[i], screens_[i], fans_[i], met_[i]);
    }
    for (std::size_t i = 0; i < screens_.size(); ++i) {
      Stripes own = dark.empty() ? met_[i] : without(met_[i], dark);
      for (std::size_t j = 0; j < screens_.size() && !own.empty(); ++j)
        if (j != i && !met_[j].empty())
          own = without(own, behind(screens_[i], fans_[i], own, screens_[j], fans_[j], met_[j]));
      found_[i].share += share_of(own);
      if (!own.empty()) taken = together(taken, own);
    }
    return taken;
  }

 private:
  std::vector<Obstacle> const& screens_;
  std::vector<Screened>& found_;
  std::vector<Fan> fans_;
  std::vector<Stripes> met_;
};

// Distributes the lines over the screens; the others meet `last` or pass beside it. Lines that miss `first`, the
// surface that the beam leaves, are dark from the start; shares are of the other lines. Returns the share that passes
// beside.
double share_out(std::vector<Obstacle> const& screens, Obstacle const* first, Obstacle const* last,
                 std::vector<Screened>& found) {
  int count = first || last ? (first ? first : last)->azimuths() : 1;
  for (Obstacle const& o : screens) count = std::max(count, o.azimuths());
  double beside = 0, lit = 0;
  Stripes const all{Stripe{}};
  Sharing sharing(screens, found);
  for (int k = 0; k < count; ++k) {
    SinCos const azimuth = sincos_turn((k + 0.5) / count);
    Stripes const dark = first ? without(all, first->met(first->fan(azimuth))) : Stripes{};
    lit += 1 - share_of(dark);
    Stripes const taken = sharing.add(azimuth, count, dark);
    if (last) beside += share_of(without(without(all, last->met(last->fan(azimuth))), taken));
  }
  lit = std::max(lit, 1e-300);
  for (Screened& s : found) s.share /= lit;
  return beside / lit;
}

// Between the surface left and the next one.
Stretch stretch_of(WorldView const& view, BeamFlight const& f) {
  Vec3 const travel = f.mode.travel;
  Stretch s{{contact_distance, {}}, {infinity, {}}};
  if (f.from.surface.valid())
    s.from = plane(contact_distance, view.normal(f.from.surface, f.mode.origin, f.from.piece), travel);
  if (f.to.surface.valid())
    s.to = plane(f.to.distance - contact_distance,
                 view.normal(f.to.surface, f.mode.origin + f.to.distance * travel, f.to.piece), travel);
  return s;
}

// All of a surface met by the chief ray.
Stretch about(WorldView const& view, SurfaceId id, double along) {
  double const size = id.valid() ? diagonal(bounds_of(view, id)) : 0;
  return {{along - size, {}}, {along + size, {}}};
}

// Where the chief ray crosses the plane of a flat surface beside it, or passes the middle of another.
double along_of(WorldView const& view, SurfaceId id, Mode const& start, double end) {
  auto const [low, high] = heights(view, id, BeamLines(start));
  std::vector<FlatRim> const rims = flat_rims(view, id);
  double along = 0.5 * (low + high);
  if (rims.size() == 1) {
    FlatRim const& rim = rims.front();
    double const crossed = dot(rim.centre - start.origin, rim.axis) / dot(start.travel, rim.axis);
    if (low <= crossed && crossed <= high) along = crossed;
  }
  return std::clamp(along, 0.0, end);
}

std::vector<Obstacle> obstacles(WorldView const& view, BeamFlight const& flight,
                                std::vector<SurfaceId> const& candidates, Stretch const& stretch, double reach) {
  double const end = flight.to.surface.valid() ? flight.to.distance : infinity;
  std::vector<Obstacle> all;
  for (SurfaceId const id : candidates) {
    Obstacle o(view, id, flight, along_of(view, id, flight.mode, end), stretch);
    if (o.possible(reach)) all.push_back(o);
  }
  std::ranges::sort(all, [](Obstacle const& a, Obstacle const& b) {
    return a.along() != b.along() ? a.along() < b.along() : a.id() < b.id();
  });
  return all;
}

}  // namespace

FlightLoss Screens::loss(BeamFlight const& flight) const {
  FlightLoss loss;
  SurfaceId const from = flight.from.surface, to = flight.to.surface;
  double const reach = reach_of(flight), end = to.valid() ? flight.to.distance : 0;
  if (to.valid()) loss.beside = beside_rim(view_, to, propagated(flight.mode, end));
  bool const rim = loss.beside > flight.least;
  std::vector<SurfaceId> const candidates = near(flight, reach);
  if (candidates.empty() && !rim) return loss;
  Stretch const stretch = stretch_of(view_, flight);
  std::vector<Obstacle> const screens = obstacles(view_, flight, candidates, stretch, reach);
  bool const shadow = (rim || !screens.empty()) && from.valid() && beside_rim(view_, from, flight.mode) > flight.least;
  if (screens.empty() && !(rim && shadow)) return loss;
  for (Obstacle const& o : screens) {
    loss.screens.emplace_back();
    loss.screens.back().surface = o.id();
    loss.screens.back().nearest = infinity;
    loss.screens.back().along = o.along();
    loss.screens.back().mode = propagated(flight.mode, o.along());
  }
  std::optional<Obstacle> first, last;
  Stretch const about_start = about(view_, from, 0), about_end = about(view_, to, end);
  if (shadow) first.emplace(view_, from, flight, 0, about_start);
  if (rim) last.emplace(view_, to, flight, end, about_end);
  double const left_over = share_out(screens, first ? &*first : nullptr, last ? &*last : nullptr, loss.screens);
  if (rim) loss.beside = std::min(1.0, left_over / std::max(1 - loss.taken(), 1e-300));
  std::erase_if(loss.screens, [&](Screened const& s) { return s.share < flight.least; });
  return loss;
}

}  // namespace straytrace::world
