// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/body.hpp"

#include <algorithm>

#include "world/model/world.hpp"

namespace straytrace::world {

PhaseSensitivity& phase_sensitivity_of(std::vector<PhaseSensitivity>& phase_sensitivities, BodyId body) {
  auto const at = std::find_if(phase_sensitivities.begin(), phase_sensitivities.end(),
                               [&](PhaseSensitivity const& l) { return l.body == body; });
  return at == phase_sensitivities.end() ? phase_sensitivities.emplace_back(PhaseSensitivity{body, {}}) : *at;
}

void add_hit(std::vector<PhaseSensitivity>& phase_sensitivities, World const& world, SurfaceId surface, Vec3 point,
             Vec3 kappa) {
  BodyId const id = world.surfaces()[surface.value].body;
  if (!id.valid()) return;
  Body const& body = world.bodies()[id.value];
  Vec3 const turn = cross(point - body.pivot, kappa);
  double const rigid[6] = {kappa.x, kappa.y, kappa.z, turn.x, turn.y, turn.z};
  PhaseSensitivity& phase_sensitivity = phase_sensitivity_of(phase_sensitivities, id);
  for (int i = 0; i < 6; ++i) phase_sensitivity.d[i] += rigid[i];
  for (ElasticMode const& mode : body.modes)
    phase_sensitivity_of(phase_sensitivities, mode.id).d[0] +=
        dot(kappa, mode.shape->at(point - (mode.origin_given ? mode.origin : body.pivot)));
}

}  // namespace straytrace::world
