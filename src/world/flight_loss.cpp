// SPDX-License-Identifier: BSD-3-Clause
// Shares that screens take off a beam on one flight, line by line.
#include <algorithm>
#include <optional>

#include "world/beam_tree.hpp"
#include "world/obstacle.hpp"

namespace straytrace {
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

// Gives each line to the first screen that it meets.
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

// What no screen takes passes beside `last`, or meets it. Lines that miss `first`, the surface left, are dark from the
// start; shares are of the light that is not. Gives what passes beside.
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

}  // namespace straytrace
