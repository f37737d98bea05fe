// SPDX-License-Identifier: BSD-3-Clause
// Elastic modes of bodies: how far each point goes, and where, per metre of the coordinate (physics.md eq. 2.1).
#pragma once

#include <memory>
#include <string>

#include "base/ids.hpp"
#include "base/table.hpp"
#include "base/vec3.hpp"

namespace straytrace {

// psi(r), without unit: displacement of a point per displacement of the mode's coordinate q.
class ModeShape {
 public:
  virtual ~ModeShape() = default;
  virtual Vec3 at(Vec3 point) const = 0;  // relative to the origin of the shape, m, along the world axes
};

struct ElasticMode {
  BodyId id;  // the coordinate counts as a body of its own, with d[0] of its levers
  Vec3 origin;
  bool origin_given = false;  // otherwise the pivot of the body
  std::shared_ptr<ModeShape const> shape;
  std::string description;  // all that decides the shape
};

// `shape` of a mode; its keys stand in docs/reference/scene.md. Problems go to the document; then nothing.
ElasticMode read_elastic_mode(Node const& shape);

}  // namespace straytrace
