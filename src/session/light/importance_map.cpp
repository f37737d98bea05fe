// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/importance_map.hpp"

#include "trace/importance/importance.hpp"

namespace straytrace::session {

ImportanceMap importance_map(World const& world) {
  SteeringTables const& tables = world.steering();
  WorldView const view = world.view();
  ImportanceMap map;
  for (Strip const& s : tables.strips) {
    Box const box = bounds_of(view, s);
    std::uint32_t const group = world.surfaces()[s.surface.value].group.value;
    map.strips.push_back({group, s.patch, box.lower.z, box.upper.z, s.area});
  }
  for (PatchSide const& side : tables.sides) {
    map.adjoint.push_back(side.adjoint);
    map.law_share.push_back(side.alpha);
  }
  return map;
}

bool show_importance(World& world, ImportanceMap const& map) {
  SteeringTables tables = make_strips(world);
  if (tables.strips.size() != map.strips.size()) return false;
  for (std::size_t i = 0; i < map.strips.size(); ++i) tables.strips[i].patch = map.strips[i].patch;
  tables.patches.clear();  // nothing is drawn from them
  tables.members.clear();
  tables.sides.resize(map.adjoint.size());
  for (std::size_t i = 0; i < map.adjoint.size(); ++i) tables.sides[i].adjoint = map.adjoint[i];
  world.steer(std::move(tables));
  return true;
}

}  // namespace straytrace::session
