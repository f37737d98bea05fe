// SPDX-License-Identifier: BSD-3-Clause
// THE list of shapes. A new shape is one header, its keys, its page and its name here.
#pragma once

#include <tuple>

#include "geometry/cap.hpp"
#include "geometry/cone.hpp"
#include "geometry/cylinder.hpp"
#include "geometry/disk.hpp"
#include "geometry/sphere.hpp"

namespace straytrace {

using ShapeTypes = std::tuple<Disk, Cap, Cylinder, Cone, Sphere>;

}  // namespace straytrace
