// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unistd.h>

#include "base/math/constants.hpp"
#include "wave/arm/arm_checks.hpp"

namespace straytrace::wave {
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

}  // namespace straytrace::wave
