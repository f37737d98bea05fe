// SPDX-License-Identifier: BSD-3-Clause
// The light of a cavity at angles below the crossover on the surfaces between its mirrors, as the tables of a source of
// paths (world/model/halo.hpp; docs/theory/wave.md, "Elsewhere").
#pragma once

#include "trace/deterministic/halo_light.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {

// Without sources where the table `wave` names no baffles, or no light meets a surface.
HaloTables halo_source(World const&, ArmCavity const&, PlaneIrradiance const&);

}  // namespace straytrace::trace
