// SPDX-License-Identifier: BSD-3-Clause
// Bodies and their elastic modes, and the contribution of one hit on a body to the phase of a path
// (docs/theory/motion.md, eq. 2.1, 2.3).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"

namespace straytrace::world {

class World;

// psi(r), without unit: displacement of a point per displacement of the mode's coordinate q.
class ModeShape {
 public:
  virtual ~ModeShape() = default;
  virtual Vec3 at(Vec3 point) const = 0;  // relative to the origin of the shape, m, along the world axes
};

struct ElasticMode {
  BodyId id;  // the coordinate counts as a body of its own, with d[0] of its phase sensitivities
  Vec3 origin;
  bool origin_given = false;  // otherwise the pivot of the body
  std::shared_ptr<ModeShape const> shape;
  std::string description;  // all parameters of the shape
};

struct Body {
  std::string name;
  Vec3 pivot;               // m, rotations are about it
  bool pivot_given = true;  // NaN given: the place of the body's first surface
  std::vector<ElasticMode> modes = {};
};

// The entry of a body; adds one where there is none.
PhaseSensitivity& phase_sensitivity_of(std::vector<PhaseSensitivity>&, BodyId);

// Adds kappa [rad/m], its moment about the pivot of the body, and kappa . psi for each elastic mode of it. A surface
// without a body (a measuring plane) adds nothing. `delay` [s]: weighs the part of PhaseSensitivity::moment.
void add_hit(std::vector<PhaseSensitivity>&, World const&, SurfaceId, Vec3 point, Vec3 kappa, double delay = 0);

}  // namespace straytrace::world
