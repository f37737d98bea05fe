// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/lit_surfaces.hpp"

#include <algorithm>
#include <cmath>

#include "world/ghosts/obstacle.hpp"
#include "world/model/body.hpp"

namespace straytrace::world {
namespace {

bool scatters(World const& world, SurfaceId surface, bool front) {
  Surface const& s = world.surfaces()[surface.value];
  return world.view().optics[front ? s.front : s.back].laws > 0;
}

// Share of lines beside the surface, out of lines_tried^2.
constexpr int lines_tried = 64;
double beside(WorldView const& view, Footprint const& f) {
  int missed = 0;
  for (int i = 0; i < lines_tried; ++i)
    for (int k = 0; k < lines_tried; ++k) {
      Ray const line = f.sample((i + 0.5) / lines_tried, (k + 0.5) / lines_tried);
      if (!(view.cross(f.surface.value, line, {}).distance < infinity)) ++missed;
    }
  return double(missed) / (lines_tried * lines_tried);
}

}  // namespace

Polarisation polarisation_of(BeamField const& field) {
  Polarisation mean{field.axis, 0, 0, 0};
  double power = 0;
  for (int i = 0; i < field.states; ++i) {
    double const share = norm(field.state[i].a) + norm(field.state[i].b);
    if (!(share > 0)) continue;
    Polarisation const one = stokes(field.state[i], field.axis);
    mean.q += share * one.q;
    mean.u += share * one.u;
    mean.v += share * one.v;
    power += share;
  }
  if (power > 0)
    for (double* x : {&mean.q, &mean.u, &mean.v}) *x /= power;
  return mean;
}

Footprint footprint_of(Mode const& mode, double index) {
  Footprint f;
  f.centre = mode.origin;
  f.travel = mode.travel;
  f.index = index;
  Spot const e = spot(mode);
  Vec3 const one = e.axis, two = cross(mode.travel, e.axis);
  auto const curvature = [&](Vec3 a, Vec3 b) {
    double const ax = dot(a, mode.e1), ay = dot(a, mode.e2), bx = dot(b, mode.e1), by = dot(b, mode.e2);
    return ax * bx * mode.q11.real() + (ax * by + ay * bx) * mode.q12.real() + ay * by * mode.q22.real();
  };
  Astigmatism const a{one, two, e.major, e.minor, curvature(one, one), curvature(one, two), curvature(two, two)};
  // Slopes at the rim of the spot that are below 1e-9 of the divergence of the mode make no difference.
  double const least = 1e-9 * mode.wavelength / (pi * a.w1 * a.w1);
  if (a.w1 - a.w2 > 1e-9 * a.w1 || std::fabs(a.c11 - a.c22) > least + 1e-12 * std::fabs(a.c11) ||
      std::fabs(a.c12) > least) {
    f.profile = Profile::astigmatic;
    f.astigmatism = a;
    return f;
  }
  f.radius = a.w1;
  f.curvature = a.c11;
  return f;
}

std::vector<PhaseSensitivity> phase_sensitivities_of_way(World const& world, std::span<BeamStep const> way, double k) {
  std::vector<PhaseSensitivity> phase_sensitivities;
  for (BeamStep const& s : way)
    add_hit(phase_sensitivities, world, s.surface, s.point, k * (s.n_in * s.in - s.n_out * s.out),
            s.path_length / speed_of_light);
  return phase_sensitivities;
}

void add_lit_surface(World& world, std::uint32_t beam, double share, std::uint32_t mirror, BeamSpot const& spot,
                     std::span<BeamStep const> way) {
  Footprint f = footprint_of(spot.mode, spot.index);
  f.surface = spot.surface;
  double const alone = beside_rim(world.view(), spot.surface, spot.mode);  // of lines that screens had taken, too
  f.share = share * spot.power * (alone < 1 ? (1 - spot.clipped) / (1 - alone) : 1);
  f.polarisation = polarisation_of(spot.field);
  f.beam = beam;
  f.emits = scatters(world, spot.surface, spot.front);
  f.receives = false;
  world.add_footprint(f, {true, spot.path_length, phase_sensitivities_of_way(world, way), mirror, spot.order, alone});
}

void add_lit_screen(World& world, std::uint32_t beam, double share, std::uint32_t mirror, ScreenSpot const& spot,
                    std::span<BeamStep const> way) {
  constexpr double closer = 0.95;  // edges of stripes lie between azimuths too
  Screened const& screen = spot.screen;
  double const nearest = closer * screen.nearest;
  Footprint f = footprint_of(screen.mode, spot.index);
  f.surface = screen.surface;
  f.hollow = std::exp(-2 * nearest * nearest);
  f.share = share * spot.power * f.hollow * screen.share / screen.alone;
  f.backoff = screen.along;
  f.polarisation = polarisation_of(spot.field);
  f.beam = beam;
  f.emits = scatters(world, screen.surface, spot.front);
  f.receives = false;
  double const missed = std::max(0.0, 1 - screen.alone / f.hollow);
  world.add_footprint(f, {true, spot.path_length, phase_sensitivities_of_way(world, way), mirror, spot.order, missed});
}

std::vector<LitRow> lit_rows(World const& world) {
  WorldView const view = world.view();
  std::vector<LitRow> rows;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    bool const launched = std::ranges::find(world.spans, i, &NetworkSpan::footprint) != world.spans.end();
    if (f.free || launched) continue;
    Feed const& feed = world.feeds()[i];
    LitRow row{i, f.radius, f.radius};
    if (f.profile == Profile::astigmatic) {
      row.major = f.astigmatism.w1;
      row.minor = f.astigmatism.w2;
    }
    Crossing const met = view.cross(f.surface.value, {f.centre - f.backoff * f.travel, f.travel}, {});
    Vec3 const p = met.distance < infinity ? f.centre + (met.distance - f.backoff) * f.travel
                                           : view.project(f.surface, f.centre, met.piece);
    Vec3 const normal = view.normal(f.surface, p, met.piece);
    bool const known = met.distance < infinity || flat_rims(view, f.surface).size() == 1;
    row.incidence = known ? angle_between(dot(normal, f.travel) < 0 ? -f.travel : f.travel, normal) : not_a_number;
    row.scatters = scatters(world, f.surface, dot(normal, f.travel) < 0);
    bool const round = f.profile == Profile::gaussian;
    row.resolution = feed.propagated || round ? 1e-15 : 1.0 / (lines_tried * lines_tried);
    row.clipped = feed.propagated ? feed.clipped
                  : round
                      ? beside_rim(view, f.surface, circular_mode(p, f.travel, f.radius, f.curvature, world.wavelength))
                      : beside(view, f);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace straytrace::world
