// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_cavity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unistd.h>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "beams/eigenmode.hpp"
#include "optics/scatter/mixture.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/heights/defects.hpp"
#include "world/model/vertex.hpp"
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

namespace {

constexpr double most_widening = 4;  // of the mode between two mirrors on a grid of constant pitch

double mean_radius(RingStop const& stop) { return std::sqrt(stop.arriving[0].radius * stop.arriving[1].radius); }
std::size_t before(RingCavity const& ring, std::size_t i) { return (i + ring.stops.size() - 1) % ring.stops.size(); }

double reach(TripStop const& stop) { return stop.opening.radius + std::hypot(stop.opening.x, stop.opening.y); }

void choose_scales(RingCavity& ring) {
  std::vector<double> radii;
  for (RingStop const& stop : ring.stops)
    if (stop.mirror) radii.push_back(mean_radius(stop));
  for (std::size_t i = 0; i < radii.size(); ++i) {
    double const ratio = radii[i] / radii[(i + 1) % radii.size()];
    ring.scaled = ring.scaled || ratio > most_widening || ratio < 1 / most_widening;
  }
  if (!ring.scaled) return;
  for (std::size_t i = 0; i < ring.stops.size(); ++i)
    ring.trip.stops[i].scale = mean_radius(ring.stops[i]) / mean_radius(ring.stops.back());
}

// The window at the start in which light that reaches both ends of each leg, and `widths` of Fresnel diffraction
// beyond, does not wrap. m
double window_for(RingCavity const& ring, double widths) {
  double window = 0;
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    TripStop const &here = ring.trip.stops[i], &last = ring.trip.stops[before(ring, i)];
    double const both = reach(last) / last.scale + reach(here) / here.scale;
    double const fresnel = std::sqrt(ring.trip.wavelength * here.leg / (last.scale * here.scale));
    window = std::fmax(window, 2 * both + widths * fresnel);
  }
  return window;
}

// rad; the largest slope of the mode against the wave that the grid follows, before and behind a stop.
double slope_at(RingCavity const& ring, std::size_t i) {
  RingStop const& stop = ring.stops[i];
  TripStop const& plane = ring.trip.stops[i];
  double const power = plane.mirror ? 2 * plane.mirror->curvature : 0, cosine = plane.opening.cosine;
  double const from = followed_before(ring.trip, i), to = followed_behind(ring.trip, i);
  double slope = 0;
  for (std::size_t axis : {0, 1}) {
    AxisBeam const& beam = stop.arriving[axis];
    double const left = beam.curvature - power * (axis == 0 ? 1 / cosine : cosine);
    for (double const c : {beam.curvature - from, left - to})
      slope = std::fmax(slope, 2.5 * beam.radius * std::fabs(c));
  }
  return slope;
}

// The angle that the grid at the start must carry so that those at all stops carry the crossover angle, rad.
double wanted_angle(RingCavity const& ring) {
  double wanted = 0;
  for (std::size_t i = 0; i < ring.stops.size(); ++i)
    wanted = std::fmax(wanted, (ring.crossover + slope_at(ring, i)) / 0.6 * ring.trip.stops[i].scale);
  return wanted;
}

void check_ring_grid(RingCavity& ring, WaveSettings const& settings) {
  Grid const& grid = ring.trip.grid;
  if (double const least = window_for(ring, 1.2); grid.window < least)
    ring.problems.push_back({{"grid", "window"},
                             fmt::format("a window of {:.4g} m is too narrow: light would wrap around it", grid.window),
                             fmt::format("state 'window: {:.4g} m' or more in 'grid', or leave it out", 1.01 * least)});
  double const wanted = wanted_angle(ring), carried = grid.largest_angle(ring.trip.wavelength);
  if (carried < wanted) {
    int const points = allowed_points(int(std::ceil(2 * grid.window * wanted / ring.trip.wavelength)));
    ring.problems.push_back(
        {settings.points > 0 ? std::vector<std::string>{"grid", "points"} : std::vector<std::string>{"crossover"},
         fmt::format("a grid of {} points over {:.4g} m does not carry a crossover angle of {:.4g} urad", grid.points,
                     grid.window, 1e6 * ring.crossover),
         points ? fmt::format("state 'points: {}' in 'grid', or a smaller 'crossover'", points)
                : "choose a smaller 'crossover'"});
  }
  double const needed = needed_memory(ring), there = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  if (needed > 0.9 * there)
    ring.problems.push_back({{"grid", "points"},
                             fmt::format("a grid of {} points needs some {:.2g} GB of memory; this machine has {:.2g} "
                                         "GB",
                                         grid.points, 1e-9 * needed, 1e-9 * there),
                             "choose fewer points, with a smaller 'crossover' or 'window'"});
}

}  // namespace

double followed_behind(Trip const& trip, std::size_t i) {
  TripStop const& next = trip.stops[(i + 1) % trip.stops.size()];
  return (next.scale / trip.stops[i].scale - 1) / next.leg;
}
double followed_before(Trip const& trip, std::size_t i) {
  TripStop const& last = trip.stops[(i + trip.stops.size() - 1) % trip.stops.size()];
  return (1 - last.scale / trip.stops[i].scale) / trip.stops[i].leg;
}

double needed_memory(RingCavity const& ring) {
  return 16 * double(ring.trip.grid.size()) * (22 + 0.4 * 30 + 3 * double(ring.stops.size()));
}

void choose_ring_grid(RingCavity& ring, WaveSettings const& settings) {
  double widest = 0, narrowest = infinity;
  for (RingStop const& stop : ring.stops)
    if (stop.mirror)
      for (AxisBeam const& beam : stop.arriving) {
        widest = std::fmax(widest, beam.radius);
        narrowest = std::fmin(narrowest, beam.radius);
      }
  double const divergence = ring.trip.wavelength / pi;
  ring.crossover = settings.crossover.value_or(20 * divergence / widest);
  choose_scales(ring);
  Grid& grid = ring.trip.grid;
  grid.window = settings.window > 0 ? settings.window : window_for(ring, 5);
  grid.points = int(settings.points);
  if (settings.points == 0) {
    int const needed = int(std::ceil(2 * grid.window * wanted_angle(ring) / ring.trip.wavelength));
    grid.points = 64;
    while (grid.points < needed && grid.points < most_points) grid.points *= 2;
  }
  check_ring_grid(ring, settings);
  if (ring.crossover < 3 * divergence / narrowest)
    ring.problems.push_back(
        {{"crossover"},
         fmt::format("the crossover angle of {:.3g} urad is next to the divergence of the mode, {:.3g} urad",
                     1e6 * ring.crossover, 1e6 * divergence / narrowest),
         fmt::format("choose {:.4g} urad or more", 3e6 * divergence / narrowest),
         Severity::warning});
}

namespace {

// The BSDF of a mirror about the specular direction.
class NearSpecular {
 public:
  NearSpecular(World const& world, SurfaceId surface, MirrorFrame const& at)
      : view_(world.view()),
        vertex_(make_vertex(view_, surface, at.point, at.frame.travel)),
        out_(at.frame.behind(at.normal)) {}

  // 1/sr, times the cosine of the angle of scatter; at slopes along x and y from the specular direction.
  double operator()(double x, double y) const { return towards(unit(out_.travel + x * out_.x + y * out_.y)); }
  double towards(Vec3 direction) const {
    Vec3 const wo = vertex_.frame.to_local(direction);
    return wo.z > 0 ? scatter_eval(view_.laws, *vertex_.optic, vertex_.wi, wo, vertex_.n_in, vertex_.n_out) * wo.z : 0;
  }
  // eq. W.2, in steps of a factor 1.2 of the angle, to all directions in front of the mirror.
  double beyond(double angle) const {
    constexpr int azimuths = 32;
    GaussPoints const gauss(8);
    double sum = 0;
    for (double from = angle; from < pi;) {
      double const to = std::fmin(1.2 * from, pi);
      for (std::size_t i = 0; i < gauss.at.size(); ++i) {
        double const a = from + (to - from) * gauss.at[i];
        double ring = 0;
        for (int k = 0; k < azimuths; ++k) {
          SinCos const turn = sincos_turn((k + 0.5) / azimuths);
          Vec3 const across = turn.cos * out_.x + turn.sin * out_.y;
          ring += towards(std::cos(a) * out_.travel + std::sin(a) * across) / azimuths;
        }
        sum += (to - from) * gauss.weight[i] * ring * 2 * pi * std::sin(a);
      }
      from = to;
    }
    return sum;
  }

 private:
  WorldView view_;
  Vertex vertex_;
  CrossFrame out_;
};

// x to -x. The column of the largest -x has no partner.
void turn_around(std::vector<double>& heights, int points) {
  for (auto line = heights.begin(); line != heights.end(); line += points) std::reverse(line + 1, line + points);
}

// The axes of the heights of a mirror: y along the normal of the plane of incidence, x to the right of who looks at the
// mirror from the side of the light, from its vertex. 1 where the coordinate x of the light grows along that x, else
// -1.
double sense_of(MirrorFrame const& at) { return dot(at.frame.x, cross(at.across, at.normal)) < 0 ? -1 : 1; }

LightOnMirror light_on(RingCavity const& ring, std::size_t i) {
  RoundHole const& outline = ring.trip.stops[i].opening;
  auto const& [x, y] = ring.stops[i].arriving;
  return {{x.radius, y.radius}, outline.cosine, {-sense_of(ring.frame_at(i)) * outline.x / outline.cosine, -outline.y}};
}

std::size_t number_of(WaveSettings const& settings, SurfaceId surface) {
  return std::size_t(std::ranges::find(settings.mirrors, surface, &WaveSettings::Mirror::surface) -
                     settings.mirrors.begin());
}

// eq. W.20, W.55: what the light that comes at this incidence takes for heights with the spectrum
// S2 = (BRDF cos theta_s) lambda^4/(16 pi^2 cos^2 theta) of the frequencies across it.
std::vector<double> heights_across(NearSpecular const& bsdf, double cosine, double wavelength, Grid const& grid,
                                   double lowest, double highest, WaveSettings::Mirror const& mirror,
                                   std::uint32_t number) {
  int const N = grid.points;
  std::vector<double> const white = synthesise([](double) { return 1.0; }, grid, lowest, highest, mirror.seed, number);
  Transform const transform(N, 0);
  Field field(grid);
  std::ranges::copy(white, field.values.begin());
  transform.forward(field, N, N);
  for (int row = 0; row < N; ++row)
    for (int column = 0; column < N; ++column) {
      if (field(row, column) == Complex{}) continue;
      double const x = grid.frequency(column) * wavelength, y = grid.frequency(row) * wavelength;
      double const both = 0.5 * (bsdf(x, y) + bsdf(-x, -y));  // heights are real
      field(row, column) *= std::sqrt(height_spectrum(both, wavelength)) / cosine;
    }
  transform.inverse(field, N, N);
  std::vector<double> heights;
  for (Complex const z : field.values) heights.push_back(z.real());
  return heights;
}

void put_on(std::vector<double>& heights, std::vector<double> const& more) {
  if (heights.empty()) heights.resize(more.size());
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += more[i];
}

// On the grid across the light, x as that of the mirror; empty: none.
std::vector<double> heights_of(RingCavity const& ring, std::size_t i, World const& world,
                               WaveSettings const& settings) {
  double const wavelength = ring.trip.wavelength, highest = ring.crossover / wavelength;
  TripStop const& stop = ring.trip.stops[i];
  Grid const grid{ring.trip.grid.points, ring.trip.grid.window * stop.scale};
  std::size_t const number = number_of(settings, ring.stops[i].surface);
  WaveSettings::Mirror const& mirror = settings.mirrors[number];
  LightOnMirror const light = light_on(ring, i);
  std::vector<double> heights;
  std::optional<HeightMap> map = ring.maps[number];
  if (mirror.heights != WaveSettings::Heights::none)
    heights = heights_across(NearSpecular(world, ring.stops[i].surface, ring.frame_at(i)), light.cosine, wavelength,
                             grid, map ? map->nyquist(light.cosine) : 0, highest, mirror, std::uint32_t(number));
  if (map) {
    fill_holes(*map);
    put_on(heights, resample(*map, grid, highest, light));
  }
  for (WaveSettings::Absorber const& a : mirror.absorbers)
    put_on(heights, heights_of_absorber(a, grid, stop.opening.radius, highest, light));
  for (WaveSettings::Ripple const& r : mirror.ripples) put_on(heights, heights_of_ripple(r, grid, light));
  return heights;
}

}  // namespace

void plan_ring_heights(RingCavity& ring, World const& world, WaveSettings const& settings) {
  ring.maps.assign(settings.mirrors.size(), {});
  std::vector<bool> checked(settings.mirrors.size());
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    RingStop& stop = ring.stops[i];
    if (!stop.mirror) continue;
    LightOnMirror const light = light_on(ring, i);
    std::size_t const number = number_of(settings, stop.surface);
    WaveSettings::Mirror const& mirror = settings.mirrors[number];
    double const wavelength = ring.trip.wavelength;
    stop.scattered = NearSpecular(world, stop.surface, ring.frame_at(i)).beyond(ring.crossover);
    for (WaveSettings::Absorber const& a : mirror.absorbers)
      stop.scattered += scattered_by_absorber(a, light, wavelength, ring.crossover);
    ring.trip.stops[i].mirror->scattered = stop.scattered;
    if (checked[number]) continue;  // by light that meets it before
    checked[number] = true;
    check_defects(mirror, {ring.trip.stops[i].opening.radius, light.cosine, wavelength, ring.crossover}, ring.problems);
    if (mirror.heights == WaveSettings::Heights::file)
      ring.maps[number] = checked_map(mirror, light, wavelength, ring.problems);
  }
}

void add_ring_heights(RingCavity& ring, World const& world, WaveSettings const& settings) {
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    if (!ring.stops[i].mirror) continue;
    std::vector<double> heights = heights_of(ring, i, world, settings);
    if (heights.empty()) continue;
    // The heights belong to the mirror: light that meets it twice sees them the same way around.
    if (sense_of(ring.frame_at(i)) < 0) turn_around(heights, ring.trip.grid.points);
    ring.stops[i].roughness = height_rms(heights);
    ring.trip.stops[i].mirror->height = std::move(heights);
  }
}

}  // namespace straytrace::wave
