// SPDX-License-Identifier: BSD-3-Clause
// The pieces of build_world: each reads one table of the scene and records its problems there.
#pragma once

#include <map>
#include <string>

#include "world/world.hpp"

namespace straytrace {

// What later readers need to find by name.
struct Registry {
  std::map<std::string, std::uint32_t> materials;  // optic index
  std::map<std::string, BodyId> bodies;
  std::map<std::string, SurfaceId> surfaces;  // by instance name, and by entry name when there is only one
  std::uint32_t black = 0;                    // optic that absorbs everything
};

void read_materials(Scene const&, World&, Registry&);
void read_bodies(Scene const&, World&, Registry&);
void read_surfaces(Scene const&, World&, Registry&);
void read_beams(Scene const&, World&, Registry const&);
void read_trace_limits(Scene const&, World&);

Pose read_pose(Node const& table);  // keys at, facing or rotate
Vec3 read_vector(Node const& list, Dimension);

}  // namespace straytrace
