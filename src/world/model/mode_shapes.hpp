// SPDX-License-Identifier: BSD-3-Clause
// Elastic modes of bodies: how far each point goes, and where, per metre of the coordinate (docs/theory/motion.md,
// eq. 2.1).
#pragma once

#include <memory>
#include <string>

#include "base/input/table.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"

namespace straytrace {

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
  std::string description;  // all that decides the shape
};

// `shape` of a mode; its keys stand in docs/reference/scene.md. Problems go to the document; then nothing.
ElasticMode read_elastic_mode(Node const& shape);

// Shapes of elastic modes as tables of points, from a finite-element program or a tapping test.

struct ModePoint {
  Vec3 place, displacement;  // m; per unit of the coordinate
};

// A plane through the nearest `neighbours` points, weighted by 1/(distance^2 + (1e-6 of the farthest)^2): fields that
// are linear in the place come back exactly, wherever the points span the directions in which they are asked for.
std::shared_ptr<ModeShape const> mode_of_points(std::vector<ModePoint> points, std::size_t neighbours = 12);

// {points: FILE, unit: m}: rows x, y, z, psi_x, psi_y, psi_z. What was read is added to `description`.
std::shared_ptr<ModeShape const> read_mode_points(Node const& shape, std::string& description);

}  // namespace straytrace
