// SPDX-License-Identifier: BSD-3-Clause
// Shapes of elastic modes as tables of points, from a finite-element program or a tapping test.
#pragma once

#include "world/mode_shapes.hpp"

namespace straytrace {

struct ModePoint {
  Vec3 place, displacement;  // m; per unit of the coordinate
};

// A plane through the nearest `neighbours` points, weighted by 1/(distance^2 + (1e-6 of the farthest)^2): fields that
// are linear in the place come back exactly, wherever the points span the directions in which they are asked for.
std::shared_ptr<ModeShape const> mode_of_points(std::vector<ModePoint> points, std::size_t neighbours = 12);

// {points: FILE, unit: m}: rows x, y, z, psi_x, psi_y, psi_z. What was read is added to `description`.
std::shared_ptr<ModeShape const> read_mode_points(Node const& shape, std::string& description);

}  // namespace straytrace
