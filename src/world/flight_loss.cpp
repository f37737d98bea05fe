// SPDX-License-Identifier: BSD-3-Clause
// Shares that screens take off a beam on one flight, line by line.
#include <algorithm>
#include <array>
#include <optional>

#include "base/functions.hpp"
#include "world/beam_tree.hpp"
#include "world/flat_rim.hpp"
#include "world/screens.hpp"

namespace straytrace {
namespace {

constexpr double grazing = 0.02;  // cosine below which the surface left or met is taken as across the beam
constexpr double edge_on = 1e-6;  // cosine below which a flat surface takes nothing

// How closely the lines lie, and how closely the edges of stripes are found where they are searched for: for light of
// which shares below `least` are not wanted.
struct Fineness {
  int azimuths, most_azimuths, rings, halvings;
};
Fineness fineness(double least) { return least < 1e-8 ? Fineness{128, 1024, 32, 36} : Fineness{32, 128, 24, 12}; }

// Where lines start and end: distance along the travel from the start of the flight over the offset, m.
struct Slant {
  double at = 0;
  Vec3 slope;
  double over(Vec3 offset) const { return at + dot(slope, offset); }
};
Slant plane(double at, Vec3 normal, Vec3 travel) {
  double const along = dot(normal, travel);
  if (std::fabs(along) < grazing) return {at, {}};
  return {at, (-1 / along) * (normal - along * travel)};
}
Box bounds_of(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return s.bounds(); });
}
double diagonal(Box const& box) { return length(box.upper - box.lower); }

// Least and largest distance of it along the lines, from the plane across the beam in which they are given.
std::array<double, 2> heights(WorldView const& view, SurfaceId id, BeamLines const& lines) {
  Box const box = bounds_of(view, id);
  Vec3 const half = 0.5 * (box.upper - box.lower), t = lines.travel;
  double const middle = dot(box.lower + half - lines.origin, t);
  double const size = std::fabs(half.x * t.x) + std::fabs(half.y * t.y) + std::fabs(half.z * t.z);
  return {middle - size, middle + size};
}

struct Stretch {
  Slant from, to;
};

// One surface in the way of the lines of a beam.
class Obstacle {
 public:
  Obstacle(WorldView const& view, SurfaceId id, Flight const& flight, double along, Stretch const& stretch)
      : view_(&view),
        id_(id),
        along_(along),
        lines_(propagated(flight.mode, along)),
        stretch_(&stretch),
        fine_(fineness(flight.least)),
        rims_(flat_rims(view, id)) {
    Box const box = bounds_of(view, id);
    Vec3 const o = 0.5 * (box.lower + box.upper) - lines_.origin;
    aside_ = o - dot(o, lines_.travel) * lines_.travel;
    size_ = 0.5 * diagonal(box);
  }
  SurfaceId id() const { return id_; }
  double along() const { return along_; }  // m, of the plane across the beam in which offsets are taken

  // Whether lines to `reach` may meet it on the stretch at all.
  bool possible(double reach) const {
    auto const [low, high] = heights(*view_, id_, lines_);
    double const wide = reach * widest();
    return high > stretch_->from.at - along_ - wide * length(stretch_->from.slope) &&
           low < stretch_->to.at - along_ + wide * length(stretch_->to.slope) && any(reach);
  }
  // Lines that meet it on the stretch.
  Stripes met(double turn) const {
    Vec3 const direction = lines_.towards(turn);
    if (passes(direction)) return {};
    if (rims_.empty()) return searched(direction);
    Stripes all;
    for (FlatRim const& rim : rims_) {
      if (std::fabs(dot(rim.axis, lines_.travel)) < edge_on) continue;
      Stripes const met = without(rim.met(lines_.origin, direction, lines_.travel), off_stretch(rim, direction));
      all = all.empty() ? met : together(all, met);
    }
    return all;
  }
  bool any(double reach) const {
    if (!rims_.empty()) return true;
    for (int i = 0; i < 16; ++i)
      for (int k = 1; k <= 4; ++k)
        if (crossing((0.25 * k * reach) * lines_.towards(i / 16.0)).distance < infinity) return true;
    return false;
  }
  // From the plane in which the line starts.
  Crossing crossing(Vec3 offset) const {
    double const from = stretch_->from.over(offset), to = stretch_->to.over(offset);
    if (!(from < to)) return {};
    return view_->cross(id_.value, {start_of(offset), lines_.travel, to - from}, {});
  }
  Vec3 start_of(Vec3 offset) const {
    return lines_.origin + offset + (stretch_->from.over(offset) - along_) * lines_.travel;
  }
  Vec3 towards(double turn) const { return lines_.towards(turn); }
  // Enough for what is small and beside the chief ray.
  int azimuths() const {
    if (!(length(aside_) > size_)) return fine_.azimuths;
    return std::clamp(int(0.4 * fine_.azimuths * length(aside_) / size_), fine_.azimuths, fine_.most_azimuths);
  }

 private:
  // Lines that cross the plane of a rim before the start of the stretch, or behind its end.
  Stripes off_stretch(FlatRim const& rim, Vec3 direction) const {
    double const slope = dot(rim.axis, lines_.travel);
    double const at = along_ + dot(rim.centre - lines_.origin, rim.axis) / slope,
                 per_rho = -dot(direction, rim.axis) / slope;
    Stripes off = negative(at - stretch_->from.at, per_rho - dot(direction, stretch_->from.slope));
    if (stretch_->to.at < infinity)
      off = together(off, negative(stretch_->to.at - at, dot(direction, stretch_->to.slope) - per_rho));
    return off;
  }
  // Where a + b rho < 0.
  static Stripes negative(double a, double b) {
    double const root = -a / b;
    if (a < 0) return {{0, b > 0 ? root : infinity}};
    return b < 0 ? Stripes{{root, infinity}} : Stripes{};
  }
  // Whether no line of this azimuth comes near the ball around it.
  bool passes(Vec3 direction) const {
    if (!(length2(aside_) > size_ * size_)) return false;
    Vec3 const u = unit(direction);
    double const ahead = dot(aside_, u);
    return ahead < 0 || length2(aside_) - ahead * ahead > size_ * size_;
  }
  double widest() const {
    return std::sqrt(length2(lines_.towards(0)) + length2(lines_.towards(0.25)));  // and a little more
  }
  Stripes searched(Vec3 direction) const {
    Stripes all;
    auto const meets = [&](double rho) { return crossing(rho * direction).distance < infinity; };
    bool before = meets(0);
    double last = 0, entered = 0;
    for (int i = 1; i <= fine_.rings; ++i) {
      double const rho = BeamLines::farthest * i / fine_.rings;
      if (bool const now = meets(rho); now != before) {
        double low = last, high = rho;
        for (int h = 0; h < fine_.halvings; ++h) {
          double const middle = 0.5 * (low + high);
          (meets(middle) == before ? low : high) = middle;
        }
        if (before) all.push_back({entered, high});
        entered = high;
        before = now;
      }
      last = rho;
    }
    if (before) all.push_back({entered, infinity});
    return all;
  }

  WorldView const* view_;
  SurfaceId id_;
  double along_;
  BeamLines lines_;
  Stretch const* stretch_;
  Fineness fine_;
  std::vector<FlatRim> rims_;  // empty: it is not flat
  Vec3 aside_;                 // m, of the ball around it from the chief ray
  double size_ = 0;            // m, its radius
};

// Of the line that meets it nearest to the chief ray.
void keep_nearest(Screened& s, Obstacle const& o, Stripes const& met, double turn) {
  if (met.empty() || met.front().from >= s.nearest) return;
  s.nearest = met.front().from;
  Stripe const& first = met.front();
  Vec3 const offset = (first.from + std::min(0.1, 0.5 * (first.to - first.from))) * o.towards(turn);
  Crossing const hit = o.crossing(offset);
  if (!(hit.distance < infinity)) return;
  s.point = o.start_of(offset) + hit.distance * s.mode.travel;
  s.piece = hit.piece;
}

// Each line is taken by the first screen that it meets; what is left over passes beside `last`, or meets it. Lines that
// miss `first`, the surface left, are dark from the start. Shares are of the light that is not.
double share_out(std::vector<Obstacle> const& screens, Obstacle const* first, Obstacle const* last,
                 std::vector<Screened>& found) {
  int count = first || last ? (first ? first : last)->azimuths() : 1;
  for (Obstacle const& o : screens) count = std::max(count, o.azimuths());
  double beside = 0, lit = 0;
  Stripes const all{Stripe{}};
  for (int k = 0; k < count; ++k) {
    double const turn = (k + 0.5) / count;
    Stripes taken = first ? without(all, first->met(turn)) : Stripes{};
    lit += 1 - share_of(taken);
    for (std::size_t i = 0; i < screens.size(); ++i) {
      Stripes const met = screens[i].met(turn);
      found[i].alone += share_of(met) / count;
      found[i].share += taken.empty() ? share_of(met) : share_of(without(met, taken));
      keep_nearest(found[i], screens[i], met, turn);
      if (screens.size() > 1 || last || first) taken = together(taken, met);
    }
    if (last) beside += share_of(without(without(all, last->met(turn)), taken));
  }
  lit = std::max(lit, 1e-300);
  for (Screened& s : found) s.share /= lit;
  return beside / lit;
}

// Between the surface left and the next one.
Stretch stretch_of(WorldView const& view, Flight const& f) {
  Vec3 const travel = f.mode.travel;
  Stretch s{{contact_distance, {}}, {infinity, {}}};
  if (f.from.surface.valid())
    s.from = plane(contact_distance, view.normal(f.from.surface, f.mode.origin, f.from.piece), travel);
  if (f.to.surface.valid())
    s.to = plane(f.to.distance - contact_distance,
                 view.normal(f.to.surface, f.mode.origin + f.to.distance * travel, f.to.piece), travel);
  return s;
}

// All of a surface that the chief ray meets there.
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

std::vector<Obstacle> obstacles(WorldView const& view, Flight const& flight, std::vector<SurfaceId> const& candidates,
                                Stretch const& stretch, double reach) {
  double const end = flight.to.surface.valid() ? flight.to.distance : infinity;
  std::vector<Obstacle> all;
  for (SurfaceId const id : candidates) {
    Obstacle o(view, id, flight, along_of(view, id, flight.mode, end), stretch);
    if (o.possible(reach)) all.push_back(o);
  }
  std::sort(all.begin(), all.end(), [](Obstacle const& a, Obstacle const& b) {
    return a.along() != b.along() ? a.along() < b.along() : a.id() < b.id();
  });
  return all;
}

}  // namespace

FlightLoss Screens::loss(Flight const& flight) const {
  FlightLoss loss;
  SurfaceId const from = flight.from.surface, to = flight.to.surface;
  double const reach = std::sqrt(-0.5 * std::log(flight.least)), end = to.valid() ? flight.to.distance : 0;
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

}  // namespace straytrace
