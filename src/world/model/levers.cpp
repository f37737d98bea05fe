// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/levers.hpp"

#include <algorithm>

namespace straytrace {

Lever& lever_of(std::vector<Lever>& levers, BodyId body) {
  auto const at = std::find_if(levers.begin(), levers.end(), [&](Lever const& l) { return l.body == body; });
  return at == levers.end() ? levers.emplace_back(Lever{body, {}}) : *at;
}

void add_hit(std::vector<Lever>& levers, World const& world, SurfaceId surface, Vec3 point, Vec3 kappa) {
  BodyId const id = world.surfaces()[surface.value].body;
  if (!id.valid()) return;
  Body const& body = world.bodies()[id.value];
  Vec3 const turn = cross(point - body.pivot, kappa);
  double const rigid[6] = {kappa.x, kappa.y, kappa.z, turn.x, turn.y, turn.z};
  Lever& lever = lever_of(levers, id);
  for (int i = 0; i < 6; ++i) lever.d[i] += rigid[i];
  for (ElasticMode const& mode : body.modes)
    lever_of(levers, mode.id).d[0] +=
        dot(kappa, mode.shape->at(point - (mode.origin_given ? mode.origin : body.pivot)));
}

}  // namespace straytrace
