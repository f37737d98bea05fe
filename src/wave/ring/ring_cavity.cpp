// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_cavity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "beams/closed_axis.hpp"
#include "wave/ring/ring_grid.hpp"
#include "wave/ring/ring_heights.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

constexpr double most_twist = 1e-3;       // rad; 1e-6 of the power is in the other axis
constexpr double largest_rim_tilt = 0.1;  // rad: the opening across the beam is half a per cent narrower

std::vector<SurfaceId> mirrors_of(World const& world, std::uint32_t beam) {
  std::vector<SurfaceId> all;
  for (Footprint const& f : world.footprints())
    if (f.beam == beam) all.push_back(f.surface);
  return all;
}

struct ShapeOfMirror {
  SphericalMirror sphere;
  double radius = 0;
};
ShapeOfMirror shape_of(World const& world, SurfaceId id) {
  ShapeOfMirror found;
  world.view().shapes.visit(world.surfaces()[id.value].shape, [&](auto const& s) {
    using Shape = std::decay_t<decltype(s)>;
    if constexpr (std::is_same_v<Shape, Cap> || std::is_same_v<Shape, Disk>) {
      found = {{s.reference(), s.axis, 0}, s.outer_radius};
      if constexpr (std::is_same_v<Shape, Cap>) found.sphere.curvature = s.curvature;
    }
  });
  return found;
}

AxisBeam axis_beam(Mode const& mode, Vec3 across) {
  std::complex<double> const q = curvature_along(mode, across);
  return {std::sqrt(mode.wavelength / (pi * q.imag())), q.real()};
}
std::array<AxisBeam, 2> beams_of(Mode const& mode, CrossFrame const& frame) {
  return {axis_beam(mode, frame.x), axis_beam(mode, frame.y)};
}

// A rim about a leg.
struct LegRim {
  SurfaceId surface;
  double along = 0;
  RoundHole hole;
  double tilt = 0;
};

// The inner edges that a leg passes.
std::vector<LegRim> rims_about(World const& world, std::vector<SurfaceId> const& candidates, Vec3 from, double length,
                               CrossFrame const& frame) {
  std::vector<LegRim> rims;
  for (SurfaceId const id : candidates) {
    auto const rim = rim_of(world, id);
    if (!rim) continue;
    Vec3 const offset = rim->centre - from;
    double const along = dot(offset, frame.travel), radius = rim->radius + rim->tooth_depth / 2;
    double const x = dot(offset, frame.x), y = dot(offset, frame.y);
    if (!(along > 0 && along < length && std::hypot(x, y) < radius)) continue;
    rims.push_back({id, along, {radius, x, y}, std::acos(std::fmin(1.0, std::fabs(dot(rim->axis, frame.travel))))});
  }
  std::ranges::sort(rims, {}, &LegRim::along);
  return rims;
}

std::vector<SurfaceId> baffles_of(World const& world, WaveSettings const& settings) {
  std::vector<SurfaceId> all;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (std::ranges::find(settings.groups, world.name_of({id})) != settings.groups.end() && rim_of(world, {id}))
      all.push_back({id});
  return all;
}

// Walks once around the closed axis and notes what the light meets.
class Walk {
 public:
  Walk(World const& world, WaveSettings const& settings, RingCavity& ring)
      : world_(world), ring_(ring), baffles_(baffles_of(world, settings)), mirrors_(mirrors_of(world, settings.beam)) {
    std::vector<SphericalMirror> spheres;
    for (SurfaceId const id : mirrors_) {
      shapes_.push_back(shape_of(world, id));
      spheres.push_back(shapes_.back().sphere);
    }
    axis_ = closed_cavity(spheres, world.wavelength);
  }

  void around() {
    std::size_t const n = mirrors_.size();
    frame_ = {axis_.start.e1, axis_.start.e2, axis_.start.travel};
    CrossFrame const first = frame_;
    ring_.start = beams_of(axis_.start, frame_);
    ring_.gouy = axis_.gouy;
    double gap = 0;  // from the stop before
    for (std::size_t leg = 0; leg < n; ++leg) {
      std::size_t const next = (leg + 1) % n;
      Mode const& arriving = axis_.arriving[next];
      Vec3 const from = axis_.arriving[leg].origin;
      double const whole = length(arriving.origin - from);
      for (LegRim const& rim : rims_about(world_, baffles_, from, whole, frame_)) {
        Mode const there = propagated(arriving, rim.along - whole);
        add({rim.surface, false, leg, rim.along, 0, beams_of(there, frame_)}, rim.along - gap, rim.hole, {});
        if (rim.tilt > largest_rim_tilt) tilted_.push_back(rim.surface);
        gap = rim.along;
      }
      meet(leg, next, whole - gap, whole);
      gap = 0;
    }
    close(first);
  }

 private:
  void add(RingStop stop, double leg, RoundHole const& hole, std::optional<WaveMirror> mirror) {
    ring_.stops.push_back(std::move(stop));
    ring_.trip.stops.push_back({leg, hole, std::move(mirror)});
  }
  void meet(std::size_t leg, std::size_t mirror, double gap, double whole) {
    Mode const& arriving = axis_.arriving[mirror];
    ShapeOfMirror const& shape = shapes_[mirror];
    Vec3 const onwards = axis_.arriving[(mirror + 1) % mirrors_.size()].origin - arriving.origin;
    Vec3 const normal = unit(unit(onwards) - frame_.travel);
    double cosine = -dot(frame_.travel, normal);
    if (1 - cosine < 1e-12) cosine = 1;
    Vec3 const centre = shape.sphere.vertex - arriving.origin;
    WaveMirror wave{
        shape.sphere.curvature, {shape.radius, dot(centre, frame_.x), dot(centre, frame_.y), cosine}, 0, 0, {}, 0};
    RoundHole const outline = wave.outline;
    add({mirrors_[mirror], true, leg, whole, std::acos(cosine), beams_of(arriving, frame_)}, gap, outline, wave);
    ring_.frames.push_back({arriving.origin, frame_, normal, axis_.normal});
    frame_ = frame_.behind(normal);
  }

  void close(CrossFrame const& first) {
    ring_.trip.mirrored = dot(frame_.x, first.x) < 0;
    double const turn = std::fmax(length(cross(frame_.x, first.x)), length(cross(frame_.y, first.y)));
    if (axis_.out_of_plane > most_twist || turn > most_twist || dot(frame_.y, first.y) < 0)
      ring_.problems.push_back(
          {{"beam"},
           fmt::format(
               "the cavity is not plane: its legs leave a plane by {:.3g} rad, and a round trip turns the image",
               std::fmax(axis_.out_of_plane, turn)),
           "put all mirrors into one plane; other cavities are not computed"});
    if (!tilted_.empty())
      ring_.problems.push_back({{"baffles"},
                                fmt::format("the inner edge of '{}' is tilted by more than {:.3g} deg against the beam",
                                            world_.name_of(tilted_.front()), largest_rim_tilt * 180 / pi),
                                "remove it from 'baffles'"});
    std::size_t met = 0;
    for (SurfaceId const id : baffles_)
      if (std::ranges::find(ring_.stops, id, &RingStop::surface) != ring_.stops.end()) ++met;
    if (met < baffles_.size())
      ring_.problems.push_back(
          {{"baffles"},
           fmt::format("the light does not pass through {} of the {} inner edges in 'baffles'; they are left out",
                       baffles_.size() - met, baffles_.size()),
           "name the baffles about the beam",
           Severity::warning});
  }

  World const& world_;
  RingCavity& ring_;
  std::vector<SurfaceId> baffles_, mirrors_, tilted_;
  std::vector<ShapeOfMirror> shapes_;
  ClosedCavity axis_;
  CrossFrame frame_;
};

}  // namespace

double RingCavity::length() const {
  double sum = 0;
  for (TripStop const& stop : trip.stops) sum += stop.leg;
  return sum;
}

MirrorFrame const& RingCavity::frame_at(std::size_t stop) const {
  return frames[std::size_t(
      std::count_if(stops.begin(), stops.begin() + std::ptrdiff_t(stop), [](RingStop const& s) { return s.mirror; }))];
}

CrossFrame CrossFrame::behind(Vec3 normal) const {
  auto const image = [&](Vec3 v) { return v - 2 * dot(v, normal) * normal; };
  return {image(x), image(y), image(travel)};
}

RingCavity planned_ring(World const& world, WaveSettings const& settings) {
  RingCavity ring;
  ring.trip.wavelength = world.wavelength;
  Walk(world, settings, ring).around();
  choose_ring_grid(ring, settings);
  plan_ring_heights(ring, world, settings);
  return ring;
}

}  // namespace straytrace::wave
