// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_record.hpp"

#include "world/model/world.hpp"

namespace straytrace::wave {

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
    RingSurfaceRecord surface{world.name_of(s.surface),
                              body.valid() ? world.bodies()[body.value].name : "",
                              s.mirror,
                              s.reference,
                              0,
                              s.levers,
                              s.widening};
    for (std::size_t i = 0; i < ring.stops.size(); ++i)
      if (ring.stops[i].surface == s.surface) surface.lost += waves.losses.taken[i];
    record.surfaces.push_back(std::move(surface));
  }
  record.warnings = ring.warnings;
  return record;
}

}  // namespace straytrace::wave
