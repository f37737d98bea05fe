// SPDX-License-Identifier: BSD-3-Clause
// Beams of the scene, as the beam tree starts with them.
#include <cmath>

#include "world/beam_tree.hpp"

namespace straytrace {
namespace {

Mode mode_of(Footprint const& f, double wavelength) {
  if (f.profile == Profile::gaussian) return circular_mode(f.centre, f.travel, f.radius, f.curvature, wavelength);
  Astigmatism const& a = f.astigmatism;
  double const side = dot(cross(a.e1, a.e2), f.travel) < 0 ? -1 : 1;  // e1, e2 and the travel are right-handed
  Mode m;
  m.origin = f.centre;
  m.travel = f.travel;
  m.e1 = a.e1;
  m.e2 = side * a.e2;
  m.wavelength = wavelength;
  m.q11 = {a.c11, wavelength / (pi * a.w1 * a.w1)};
  m.q12 = side * a.c12;
  m.q22 = {a.c22, wavelength / (pi * a.w2 * a.w2)};
  return m;
}

// A state of the scene is linear; without one the light is unpolarised: two states at right angles.
BeamField field_of(Footprint const& f, bool polarised) {
  BeamField field;
  field.axis = any_normal(f.travel);
  Polarisation const& p = f.polarisation;
  if (polarised && p.q * p.q + p.u * p.u + p.v * p.v > 0.5) {
    field.axis = p.axis;
    double const half = std::sqrt(0.5 * (1 + p.q));  // of q: |a|^2 = (1 + q)/2, 2 conj(a) b = u + i v
    field.state[0] = half > 0 ? Jones{{half, 0}, {0.5 * p.u / half, 0.5 * p.v / half}} : Jones{{0, 0}, {1, 0}};
    return field;
  }
  field.states = 2;
  field.state[1] = {{0, 0}, {1, 0}};
  return field;
}

// What goes on from the mirror of the launch: a tree of no step.
double passed_at_launch(World const& world, BeamLaunch const& launch) {
  BeamSink nobody;
  return grow_tree(world, launch, {0, 0, 0}, nobody).longest;
}

}  // namespace

std::vector<BeamLaunch> launches(World const& world) {
  WorldView const view = world.view();
  std::vector<BeamLaunch> all;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (world.feeds()[i].propagated) continue;
    if (f.profile != Profile::gaussian && f.profile != Profile::astigmatic) continue;
    BeamLaunch launch;
    launch.footprint = i;
    launch.beam = f.beam;
    launch.mode = mode_of(f, world.wavelength / f.index);
    launch.field = field_of(f, world.polarised);
    if (f.free) {
      launch.name = world.groups()[f.origin.value];
    } else {
      Crossing const met = view.cross(f.surface.value, {f.centre - f.backoff * f.travel, f.travel}, {});
      if (!(met.distance < infinity)) continue;  // the chief ray misses its own surface
      launch.arrives_at = f.surface;
      launch.piece = met.piece;
      launch.mode = propagated(launch.mode, met.distance - f.backoff);
      launch.name = world.groups()[world.surfaces()[f.surface.value].group.value];
      if (f.standing)
        for (Footprint const& other : world.footprints())
          if (other.standing && other.beam == f.beam) launch.cavity.push_back(other.surface);
      if (!launch.cavity.empty()) launch.passes = passed_at_launch(world, launch);
    }
    all.push_back(std::move(launch));
  }
  return all;
}

}  // namespace straytrace
