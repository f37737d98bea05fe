// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/obstacle.hpp"

#include <algorithm>

namespace straytrace {
namespace {

constexpr double edge_on = 1e-6;  // cosine below which a flat surface takes nothing

// For light of which shares below `least` are not wanted.
Fineness fineness(double least) { return least < 1e-8 ? Fineness{128, 1024, 32, 36} : Fineness{32, 128, 24, 12}; }

// Where a + b rho < 0.
Stripes negative(double a, double b) {
  double const root = -a / b;
  if (a < 0) return {{0, b > 0 ? root : infinity}};
  return b < 0 ? Stripes{{root, infinity}} : Stripes{};
}

}  // namespace

double reach_of(Flight const& f) { return std::sqrt(-0.5 * std::log(f.least)); }
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

Obstacle::Obstacle(WorldView const& view, SurfaceId id, Flight const& flight, double along, Stretch const& stretch)
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
  double last = 0, entered = 0;
  for (int i = 1; i <= rings_; ++i) {
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

}  // namespace straytrace
