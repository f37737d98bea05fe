// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_record.hpp"

#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

// Of all stops at a surface.
double lost_at(SurfaceId surface, RingCavity const& ring, TripLosses const& losses) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.stops.size(); ++i)
    if (ring.stops[i].surface == surface) sum += losses.taken[i];
  return sum;
}

}  // namespace

RingRecord record_of(World const& world, RingWaves const& waves, double power) {
  RingCavity const& ring = waves.ring;
  RingRecord record;
  record.beam = world.wave.beam_name;
  record.power = power;
  record.wavelength = ring.trip.wavelength;
  record.length = ring.length();
  record.grid = ring.trip.grid;
  record.crossover = ring.crossover;
  record.eigenvalue = waves.mode.eigenvalue;
  record.reverse_eigenvalue = waves.levers.eigenvalue;
  record.residual = waves.mode.residual;
  record.beyond_band = waves.losses.beyond_band;
  record.modes = waves.modes;
  for (SurfaceLevers const& s : waves.levers.surfaces) {
    BodyId const body = world.surfaces()[s.surface.value].body;
    record.surfaces.push_back({world.name_of(s.surface), body.valid() ? world.bodies()[body.value].name : "", s.mirror,
                               s.reference, lost_at(s.surface, ring, waves.losses), s.levers, s.widening});
  }
  if (waves.grid_check) {
    RingGridCheck& check = record.grid_check.emplace(*waves.grid_check);
    check.losses.taken.clear();
    for (SurfaceLevers const& s : waves.levers.surfaces)
      check.losses.taken.push_back(lost_at(s.surface, ring, waves.grid_check->losses));
  }
  record.warnings = ring.warnings;
  return record;
}

}  // namespace straytrace::wave
